//! `geotrace trace` on surfaces whose geodesics are known in closed form, through the binary's JSON.

use std::f64::consts::PI;

use serde_json::Value;
use testing::binary::geotrace;
use testing::close::{assert_close, assert_near};

/// Where a geodesic ended.
#[derive(Debug)]
struct End {
    uv: [f64; 2],
    position: Vec<f64>,
    direction: [f64; 2],
    length: f64,
    speed_drift: f64,
    error_estimate: f64,
    evaluations: u64,
    status: String,
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().map(Vec::as_slice).unwrap_or_default();
    list.iter()
        .map(|number| number.as_f64().unwrap_or(f64::NAN))
        .collect()
}

/// The JSON of a trace along the first parameter with `--conjugate`.
#[track_caller]
fn field_along(file: &str, from: &str, way: [&str; 2], length: &str) -> Value {
    let run = geotrace([
        "trace",
        "-",
        "--from",
        from,
        way[0],
        way[1],
        "--length",
        length,
        "--conjugate",
        "--format",
        "json",
    ]);
    run.input(file).run().expect_status(0).json()
}

#[test]
fn conjugate_points_and_the_jacobi_field_are_those_of_constant_curvature() {
    // Along the outer equator of a torus K = 1/(r(R + r)) is constant: m = sin(√K s)/√K, which is 0 at multiples of π/√K.
    let torus =
        "surface s(u,v) = ((2 + cos v)cos u, (2 + cos v)sin u, sin v), u : [0, 2pi], v : [0, 2pi];";
    let found = field_along(torus, "0,0", ["--direction", "1,0"], "12");
    let root = 1.0 / 3.0_f64.sqrt();
    let conjugates = numbers(&found["conjugates"]);
    assert_eq!(conjugates.len(), 2, "{found}");
    for (n, length) in (1..).zip(conjugates) {
        assert_close("the field", length, f64::from(n) * PI / root, 1e-8);
    }
    let [m, slope] = numbers(&found["jacobi"])[..] else {
        panic!("{found}");
    };
    assert_close("the field", m, (12.0 * root).sin() / root, 1e-7);
    assert_close("the field", slope, (12.0 * root).cos(), 1e-7);
    // A ball as a solid, and a plane, which has none.
    let ball = "solid q(x, y, z) = x^2 + y^2 + z^2 - 4;";
    let found = field_along(ball, "2,0,0", ["--direction", "0,1,0.5"], "7");
    let conjugates = numbers(&found["conjugates"]);
    assert_eq!(conjugates.len(), 1, "{found}");
    assert_close("the field", conjugates[0], 2.0 * PI, 1e-8);
    let plane = "surface s(u,v) = (u, v, 0), u : [-9, 9], v : [-9, 9];";
    let found = field_along(plane, "0,0", ["--heading", "30"], "5");
    assert_eq!(numbers(&found["conjugates"]), [0.0; 0], "{found}");
    assert_close("the field", numbers(&found["jacobi"])[0], 5.0, 1e-9);
    // Without the option the document is as it was.
    let run = geotrace([
        "trace",
        "-",
        "--from",
        "0,0",
        "--heading",
        "0",
        "--length",
        "1",
        "--format",
        "json",
    ]);
    let json = run.input(plane).run().expect_status(0).json();
    assert!(
        json.get("conjugates").is_none() && json.get("jacobi").is_none(),
        "{json}"
    );
}

#[test]
fn a_solid_of_a_script_is_that_at_the_time_that_is_set() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "s = Sphere { center -> vec3(0, 0, 0) radius -> 1 + t / 10.0 } Scene { s }";
    std::fs::write(folder.path().join("a.crt"), script).expect("written");
    let end = |time: &str| {
        let run = geotrace([
            "trace",
            "a.crt",
            "--from",
            "1.9,0,0",
            "--direction",
            "0,1,0",
        ]);
        let run = run.arguments(&["--length", "1", "--format", "json", "--set", time]);
        let json = run.folder(folder.path()).run().expect_status(0).json();
        let [x, y, z] = numbers(&json["position"])[..] else {
            panic!("{json}");
        };
        x.hypot(y).hypot(z)
    };
    assert_close("the radius", end("t=0"), 1.0, 1e-9);
    assert_close("the radius", end("t=10"), 2.0, 1e-9);
}

/// Traces on the surface `s` of a program.
#[track_caller]
fn trace(program: &str, from: [f64; 2], direction: [f64; 2], length: f64) -> End {
    trace_with(
        program,
        from,
        &[
            "--direction".to_owned(),
            format!("{:?},{:?}", direction[0], direction[1]),
        ],
        length,
    )
}

#[track_caller]
fn trace_with(program: &str, from: [f64; 2], more: &[String], length: f64) -> End {
    let mut arguments: Vec<String> = ["trace", "-", "--surface", "s", "--format", "json", "--from"]
        .map(str::to_owned)
        .to_vec();
    arguments.push(format!("{:?},{:?}", from[0], from[1]));
    arguments.extend(["--length".to_owned(), format!("{length:?}")]);
    arguments.extend(more.iter().cloned());
    let run = geotrace(&arguments).input(program).run();
    let json = run.expect_status(0).json();
    let number = |key: &str| {
        json[key]
            .as_f64()
            .unwrap_or_else(|| panic!("no number `{key}` in {json}"))
    };
    let direction = numbers(&json["direction"]);
    End {
        uv: [number("u"), number("v")],
        position: numbers(&json["position"]),
        direction: [direction[0], direction[1]],
        length: number("length"),
        speed_drift: number("speed_drift"),
        error_estimate: number("error_estimate"),
        evaluations: number("evaluations") as u64,
        status: json["status"].as_str().unwrap_or("none").to_owned(),
    }
}

const SPHERE: &str =
    "surface s(u,v) = (cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];";
const CYLINDER: &str = "surface s(u,v) = (2cos u, 2sin u, v), u : [0, 2pi], v : [-100, 100];";
/// Half the opening angle has the sine 1/√2: unrolled, the full turn is a wedge of 2π/√2.
const CONE: &str = "surface s(u,v) = (v cos u, v sin u, v), u : [0, 2pi], v : [0, 100];";
const TORUS: &str = "surface s(u,v) = ((1 + 0.4cos v) cos u, (1 + 0.4cos v) sin u, 0.4sin v), u : [0, 2pi], v : [0, 2pi];";
const PSEUDOSPHERE: &str =
    "surface s(u,v) = (cos u/cosh v, sin u/cosh v, v - tanh v), u : [0, 2pi], v : [0.01, 20];";

/// A point of the unit sphere, and the unit tangent with these chart components.
fn sphere(uv: [f64; 2], direction: [f64; 2]) -> ([f64; 3], [f64; 3]) {
    let ((su, cu), (sv, cv)) = (uv[0].sin_cos(), uv[1].sin_cos());
    let [a, b] = direction;
    let tangent = [
        -a * cv * su - b * sv * cu,
        a * cv * cu - b * sv * su,
        b * cv,
    ];
    let length = tangent.iter().map(|x| x * x).sum::<f64>().sqrt();
    ([cv * cu, cv * su, sv], tangent.map(|x| x / length))
}

#[test]
fn geodesics_of_a_sphere_are_great_circles() {
    let starts = [
        ([0.3, 0.2], [1.0, 0.5], 2.0),
        ([1.0, -0.7], [0.3, -1.0], 6.0),
        ([5.0, 0.0], [1.0, 0.0], PI),
        ([2.0, 0.5], [-1.0, 2.0], 20.0),
        ([6.0, 1.2], [3.0, 0.1], 1.0),
    ];
    for (from, direction, length) in starts {
        let end = trace(SPHERE, from, direction, length);
        let (p, t) = sphere(from, direction);
        let (sin, cos) = length.sin_cos();
        let expected: Vec<f64> = (0..3).map(|k| p[k] * cos + t[k] * sin).collect();
        assert_eq!(end.status, "complete");
        assert_near("end", &end.position, &expected, 1e-8);
        let (on_surface, tangent) = sphere(end.uv, end.direction);
        assert_near("(u,v)", &on_surface, &expected, 1e-8);
        let velocity: Vec<f64> = (0..3).map(|k| t[k] * cos - p[k] * sin).collect();
        assert_near("direction", &tangent, &velocity, 1e-7);
        assert_close("length", end.length, length, 1e-12);
        assert!(end.speed_drift.abs() < 1e-8, "{end:?}");
        let error = testing::close::distance(&end.position, &expected);
        assert!(
            error <= 3.0 * end.error_estimate + 2e-15,
            "the error {error:e} was estimated as {:e}",
            end.error_estimate
        );
        assert!((0.0..=2.0 * PI).contains(&end.uv[0]), "{end:?}");
        assert!((-PI / 2.0..=PI / 2.0).contains(&end.uv[1]), "{end:?}");
    }
}

#[test]
fn a_sphere_is_traced_through_and_past_its_poles() {
    // Exactly through the pole: the meridian goes on half a turn further.
    let end = trace(SPHERE, [0.5, 1.0], [0.0, 1.0], 2.0);
    assert_eq!(end.status, "complete");
    assert_near("through", &end.uv, &[0.5 + PI, PI - 3.0], 1e-9);
    for miss in [1e-1, 1e-2, 1e-4, 1e-6, 1e-8_f64] {
        // A great circle whose nearest point to the pole is `miss` away: start on it where it is 1 away.
        let from = [0.0, PI / 2.0 - 1.0];
        // Clairaut: cos(v)·sin(angle to the meridian) is constant, and is sin(miss) at the nearest point.
        let sine = miss.sin() / 1.0_f64.sin();
        let direction = [sine / from[1].cos(), (1.0 - sine * sine).sqrt()];
        let end = trace(SPHERE, from, direction, 2.5);
        let (p, t) = sphere(from, direction);
        let (sin, cos) = 2.5_f64.sin_cos();
        let expected: Vec<f64> = (0..3).map(|k| p[k] * cos + t[k] * sin).collect();
        assert_eq!(end.status, "complete", "missing the pole by {miss:e}");
        assert_near(
            &format!("missing the pole by {miss:e}"),
            &end.position,
            &expected,
            1e-8,
        );
        assert!(end.evaluations < 20_000, "{end:?}");
    }
}

#[test]
fn a_line_from_a_pole_or_a_hair_beside_it_goes_where_it_is_headed() {
    // In units of turns from the pole, as in the gallery's sphere: the north pole at v = 0, the south pole at 1.
    let program = "surface s(u,v) = (sin(pi v)cos(2pi u), sin(pi v)sin(2pi u), cos(pi v)), \
                   u : [0, 1], v : [0, 1];";
    for v in [0.0, 1e-12, 1e-9, 1e-6, 1e-3, 0.999, 1.0 - 1e-9, 1.0] {
        for degrees in [30.0_f64, -100.0, 90.0] {
            let (from, length) = ([0.2, v], 2.0_f64);
            let end = trace_with(
                program,
                from,
                &["--heading".to_owned(), format!("{degrees}")],
                length,
            );
            assert_eq!(end.status, "complete", "{v} {degrees}");
            let ((su, cu), (s, c)) = (
                (2.0 * PI * from[0]).sin_cos(),
                degrees.to_radians().sin_cos(),
            );
            // The sine of a small angle from the south pole keeps its digits this way.
            let (sine, cosine) = ((PI * v.min(1.0 - v)).sin(), (PI * v).cos());
            let (at, goes) = (length.cos(), length.sin());
            let expected = [
                sine * cu * at + (cosine * cu * s - su * c) * goes,
                sine * su * at + (cosine * su * s + cu * c) * goes,
                cosine * at - sine * s * goes,
            ];
            let error = testing::close::distance(&end.position, &expected);
            assert!(
                error <= 3.0 * end.error_estimate + 2e-15 && end.error_estimate < 1e-9,
                "{v} {degrees}: {error:e} {end:?}"
            );
            assert!(end.speed_drift.abs() < 1e-10, "{end:?}");
        }
    }
}

#[test]
fn geodesics_of_a_cylinder_are_helices() {
    for (from, direction, length) in [
        ([0.0, 0.0], [1.0, 1.0], 10.0),
        ([3.0, -2.0], [-1.0, 0.25], 50.0),
        ([1.0, 1.0], [0.0, -1.0], 3.0),
    ] {
        let end = trace(CYLINDER, from, direction, length);
        let speed = (4.0 * direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        let (u, v) = (
            from[0] + direction[0] * length / speed,
            from[1] + direction[1] * length / speed,
        );
        assert_eq!(end.status, "complete");
        assert_near(
            "end",
            &end.position,
            &[2.0 * u.cos(), 2.0 * u.sin(), v],
            1e-8,
        );
        assert_near("u", &[end.uv[0]], &[u.rem_euclid(2.0 * PI)], 1e-8);
        assert_near(
            "direction",
            &end.direction,
            &direction.map(|x| x / speed),
            1e-9,
        );
    }
}

#[test]
fn geodesics_of_a_cone_are_straight_when_it_is_unrolled() {
    // Polar coordinates of the plane: radius v√2, angle u/√2.
    let unroll = |uv: [f64; 2]| {
        let (radius, angle) = (uv[1] * 2.0_f64.sqrt(), uv[0] / 2.0_f64.sqrt());
        [radius * angle.cos(), radius * angle.sin()]
    };
    for (from, direction, length) in [
        ([1.0, 5.0], [0.1, 1.0], 3.0),
        ([1.0, 5.0], [1.0, -2.0], 8.0),
        ([3.0, 1.0], [0.7, 0.2], 20.0),
    ] {
        let end = trace(CONE, from, direction, length);
        assert_eq!(end.status, "complete");
        let speed = (from[1] * from[1] * direction[0] * direction[0]
            + 2.0 * direction[1] * direction[1])
            .sqrt();
        let start = unroll(from);
        let (angle, root) = (from[0] / 2.0_f64.sqrt(), 2.0_f64.sqrt());
        let radial = direction[1] * root / speed;
        let around = from[1] * direction[0] / speed;
        let expected = [
            start[0] + length * (radial * angle.cos() - around * angle.sin()),
            start[1] + length * (radial * angle.sin() + around * angle.cos()),
        ];
        // The end's u is known up to whole turns only.
        let turns =
            (-4..=4).map(|turn| unroll([end.uv[0] + 2.0 * PI * f64::from(turn), end.uv[1]]));
        let nearest = turns
            .min_by(|a, b| {
                let of = |p: &[f64; 2]| testing::close::distance(p, &expected);
                of(a).total_cmp(&of(b))
            })
            .unwrap_or_default();
        assert_near("end", &nearest, &expected, 1e-8);
    }
}

#[test]
fn a_line_into_the_tip_of_a_cone_ends_there() {
    let end = trace(CONE, [1.0, 2.0], [0.0, -1.0], 10.0);
    assert_eq!(end.status, "cone_point");
    assert_close("length", end.length, 2.0 * 2.0_f64.sqrt(), 1e-6);
}

#[test]
fn a_line_over_a_true_edge_ends_there() {
    let end = trace(CYLINDER, [1.0, 95.0], [0.0, 1.0], 10.0);
    assert_eq!(end.status, "left_domain");
    assert_close("length", end.length, 5.0, 1e-8);
    assert_near("end", &end.uv, &[1.0, 100.0], 1e-7);
}

/// The distance to the axis times the sine of the angle to the meridian.
fn clairaut_of_torus(uv: [f64; 2], direction: [f64; 2]) -> f64 {
    let radius = 1.0 + 0.4 * uv[1].cos();
    let (a, b) = (radius * direction[0], 0.4 * direction[1]);
    radius * a / a.hypot(b)
}

#[test]
fn clairauts_relation_holds_on_a_torus() {
    for (from, direction, length) in [
        ([0.0, 0.0], [1.0, 1.0], 50.0),
        ([1.0, 2.0], [0.2, 1.0], 50.0),
        ([1.0, PI], [1.0, 0.01], 5.0),
    ] {
        let end = trace(TORUS, from, direction, length);
        assert_eq!(end.status, "complete");
        let (before, after) = (
            clairaut_of_torus(from, direction),
            clairaut_of_torus(end.uv, end.direction),
        );
        assert_close("Clairaut", after, before, 1e-9);
    }
    // The outer equator is a geodesic: a whole turn returns.
    let end = trace(TORUS, [1.0, 0.0], [1.0, 0.0], 2.0 * PI * 1.4);
    assert_near(
        "equator",
        &end.position,
        &[1.4 * 1.0_f64.cos(), 1.4 * 1.0_f64.sin(), 0.0],
        1e-8,
    );
}

#[test]
fn the_pseudosphere_is_hyperbolic() {
    // In the half-plane x = u, y = cosh v lines are circles about the axis: (x − c)² + y² is constant.
    let (from, direction) = ([1.0, 1.0_f64], [0.3, 1.0_f64]);
    let end = trace(PSEUDOSPHERE, from, direction, 1.5);
    assert_eq!(end.status, "complete");
    let plane = |uv: [f64; 2], d: [f64; 2]| ([uv[0], uv[1].cosh()], [d[0], d[1] * uv[1].sinh()]);
    let centre = |p: [f64; 2], t: [f64; 2]| p[0] + p[1] * t[1] / t[0];
    let (p, t) = plane(from, direction);
    let (q, s) = plane(end.uv, end.direction);
    assert_close("centre", centre(q, s), centre(p, t), 1e-8);
    let square = |p: [f64; 2]| (p[0] - centre(plane(from, direction).0, t)).powi(2) + p[1] * p[1];
    assert_close("radius", square(q), square(p), 1e-8);
    // The distance between the ends in the half-plane is the length.
    let chord = ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)) / (2.0 * p[1] * q[1]);
    assert_close("distance", (1.0 + chord).acosh(), 1.5, 1e-8);
    // Two lines that start at a small angle run apart like sinh.
    let other = trace(PSEUDOSPHERE, from, [0.3 + 1e-5, 1.0], 1.5);
    let apart = testing::close::distance(&other.position, &end.position);
    let speed = |d: [f64; 2]| {
        let e = d[0] / from[1].cosh();
        let g = d[1] * from[1].tanh();
        (e, g)
    };
    let ((a, b), (c, d)) = (speed(direction), speed([0.3 + 1e-5, 1.0]));
    let angle = (d.atan2(c) - b.atan2(a)).abs();
    assert_close("growth", apart / angle, 1.5_f64.sinh(), 1e-3);
}

#[test]
fn tracing_back_returns() {
    for (program, from, direction, length) in [
        (SPHERE, [1.0, 0.3], [1.0, 0.4], 5.0),
        (CYLINDER, [1.0, 0.3], [1.0, 0.4], 20.0),
        (CONE, [1.0, 5.0], [0.3, -1.0], 12.0),
        (TORUS, [1.0, 0.3], [1.0, 0.4], 10.0),
        (PSEUDOSPHERE, [3.0, 1.0], [1.0, 0.4], 1.0),
    ] {
        let there = trace(program, from, direction, length);
        assert_eq!(there.status, "complete", "{program}");
        let back = trace(program, there.uv, there.direction.map(|x| -x), length);
        assert_eq!(back.status, "complete", "{program}");
        assert_near(program, &back.uv, &from, 1e-7);
    }
}

#[test]
fn a_heading_is_an_angle_in_the_tangent_plane() {
    // On the torus σu and σv are orthogonal: heading 90° is straight along v.
    let by_heading = |degrees: &str| {
        trace_with(
            TORUS,
            [1.0, 0.5],
            &["--heading".to_owned(), degrees.to_owned()],
            0.3,
        )
    };
    let along_v = trace(TORUS, [1.0, 0.5], [0.0, 1.0], 0.3);
    assert_near("90", &by_heading("90").uv, &along_v.uv, 1e-9);
    let against_u = trace(TORUS, [1.0, 0.5], [-1.0, 0.0], 0.3);
    assert_near("180", &by_heading("180").uv, &against_u.uv, 1e-9);
    assert_near("-180", &by_heading("-180").uv, &against_u.uv, 1e-9);
    let radius = 1.0 + 0.4 * 0.5_f64.cos();
    let diagonal = trace(TORUS, [1.0, 0.5], [1.0 / radius, 1.0 / 0.4], 0.3);
    assert_near("45", &by_heading("45").uv, &diagonal.uv, 1e-9);
}

#[test]
fn a_moebius_strip_is_passed_through_its_seam_turned_over() {
    let strip = |domain: &str| {
        format!(
            "surface s(u,v) = ((1 + v cos(u/2)) cos u, (1 + v cos(u/2)) sin u, v sin(u/2)), \
             u : {domain}, v : [-0.8, 0.8];"
        )
    };
    // One chart has its seam at u = 0, the other has none there.
    let (seam, plain) = (strip("[0, 2pi]"), strip("[-pi, pi]"));
    for (from, direction) in [([0.5, 0.1], [-1.0, 0.1]), ([0.3, -0.2], [-1.0, -0.3])] {
        let through = trace(&seam, from, direction, 1.0);
        let beside = trace(&plain, from, direction, 1.0);
        assert_eq!(through.status, "complete");
        assert_eq!(beside.status, "complete");
        assert_near("position", &through.position, &beside.position, 1e-8);
        let [u, v] = beside.uv;
        assert!(u < -0.1, "{beside:?} does not cross the seam");
        assert_near("(u,v)", &through.uv, &[u + 2.0 * PI, -v], 1e-8);
        let [a, b] = beside.direction;
        assert_near("direction", &through.direction, &[a, -b], 1e-8);
    }
}

#[test]
fn a_surface_of_any_size_is_traced_alike() {
    for size in [1e-6, 1.0, 1e6] {
        let program = format!(
            "define R = {size:e}; surface s(u,v) = R(cos v cos u, cos v sin u, sin v), \
             u : [0, 2pi], v : [-pi/2, pi/2];"
        );
        let end = trace(&program, [0.3, 0.2], [1.0, 0.5], 2.0 * size);
        let unit = trace(SPHERE, [0.3, 0.2], [1.0, 0.5], 2.0);
        assert_near("(u,v)", &end.uv, &unit.uv, 1e-8);
    }
}

#[test]
fn a_metric_without_a_shape_has_no_position() {
    let plane = "metric h(x,y) = (1, 0, 1)/y^2, x : [-2, 2], y : [0.5, 8];";
    let arguments = "trace - --from 0,1 --direction 0,1 --length 1 --format json";
    let run = geotrace(arguments.split(' ')).input(plane).run();
    let json = run.expect_status(0).json();
    assert!(json["position"].is_null(), "{json}");
    // Straight up, the distance is the logarithm of the height.
    let height = json["v"].as_f64().unwrap_or(f64::NAN);
    assert_close("height", height, 1_f64.exp(), 1e-8);
}

/// Lines that take more than the evaluations of a picture's pixel.
#[test]
fn a_single_geodesic_may_take_what_it_needs() {
    let lines = [
        (
            "(cos v cos u, cos v sin u, 0.01sin v), u : [0, 2pi], v : [-pi/2, pi/2]",
            "--from 0.3,0.2 --direction 0.05,1 --length 20",
        ),
        (
            "(u, v, 0.01sin(400pi u)), u : [0, 1], v : [0, 1]",
            "--from 0.01,0.2 --direction 1,0.1 --length 7",
        ),
        (
            "((1 + 0.9999cos v)cos u, (1 + 0.9999cos v)sin u, 0.9999sin v), u : [0, 2pi], v : [0, 2pi]",
            "--from 0,0 --direction 0.3,1 --length 200",
        ),
    ];
    for (surface, line) in lines {
        let program = format!("surface s(u, v) = {surface};");
        let trace = |more: &str| {
            let arguments = format!("trace - {line} --tolerance 1e-13 --format json {more}");
            geotrace(arguments.trim().split(' '))
                .input(program.as_str())
                .run()
        };
        let json = trace("").expect_status(0).json();
        assert_eq!(json["status"], "complete", "{line}: {json}");
        assert!(json["evaluations"].as_u64() > Some(20_000), "{json}");
        let json = trace("--max-evaluations 20000").expect_status(0).json();
        assert_eq!(json["status"], "work_limit", "{line}: {json}");
        assert!(json["evaluations"].as_u64() <= Some(20_000), "{json}");
    }
}

#[test]
fn a_line_on_which_a_parameter_stands_still_is_named() {
    let program = "surface s(u, v) = (u^3, v, u^6), u : [-1, 1], v : [-1, 1];";
    let arguments = "trace - --from 0.5,0 --direction -1,0.3 --length 0.5";
    let run = geotrace(arguments.split(' ')).input(program).run();
    run.expect_status(0)
        .expect_text("σu is 0 on the line u ≈ 0;")
        .expect_text("another parametrisation leads across");
    // The pole of a sphere inside of the domain, of which the first parameter goes around.
    let program =
        "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [0, 2pi], v : [-pi, pi];
        metric m(u, v) = (cos^2 v, 0, 1), u : [0, 2pi], v : [-pi, pi];";
    for (name, vanishing) in [("s", "σu"), ("m", "E")] {
        let arguments =
            format!("trace - --surface {name} --from 1,0.7 --direction 1e-6,1 --length 2");
        let run = geotrace(arguments.split(' ')).input(program).run();
        let expected = format!("{vanishing} is 0 on the line v ≈ 1.5707963");
        run.expect_status(0).expect_text(&expected);
    }
}

#[test]
fn the_end_of_what_is_no_metric_is_named() {
    for (metric, reason) in [
        ("1, 0, u", "G is 0 on the line u ≈ 0;"),
        ("1, 2 - 3u, 1", "the metric is not positive definite there"),
    ] {
        let program = format!("metric m(u, v) = ({metric}), u : [-1, 1], v : [0, 1];");
        let arguments = "trace - --from 0.6,0.5 --direction -1,0 --length 1.5";
        let run = geotrace(arguments.split(' ')).input(program).run();
        run.expect_status(0).expect_text(reason);
    }
}

#[test]
fn methods_of_whole_pictures_are_refused_for_one_geodesic() {
    for method in ["fan", "fan-linear"] {
        let arguments = format!("trace - --from 0,0 --heading 0 --length 1 --method {method}");
        let run = geotrace(arguments.split(' ')).input(TORUS).run();
        run.expect_status(2).expect_text("shares its rays");
    }
}
