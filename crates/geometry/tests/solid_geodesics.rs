//! Declared geodesics on solids, and the surfaces of solids for cameras.

use std::f64::consts::PI;

use geodesic::trace::{Options, Status};
use geometry::{ManifoldError, SolidSurface, follow_declared, lies_in_space};
use scene::{ParamValues, Scene};

const PROGRAM: &str = "\
param r : [2, 3];
grid k : [0, 1, 2];
solid ball(x,y,z) = x^2 + y^2 + z^2 - r^2;
solid dome(x,y,z) = x^2 + y^2 + z^2 - r^2, z : [0, 5];
geodesic g(t) : ball = (0, 1, k) @ (5, 0, 0), t : [-1, 2, 4];
geodesic h(t) : dome = (0, 0, -1) @ (2, 0, 1.2), t : [0, 3, 31];
geodesic none(t) : ball = (1, 0, 0) @ (r, 0, 0), t : [0, 1, 3];
solid balls(x,y,z) = (x - 3k)^2 + y^2 + z^2 - 1;
solid row = balls;
solid ring(x,y,z) = (sqrt(x^2 + y^2) - 2)^2 + z^2 - 1/4;
solid empty(x,y,z) = x^2 + y^2 + z^2 + 1;
solid pipe(x,y) = x^2 + y^2 - 1;
point p = (0, 0, 0);
";

fn scene() -> Scene {
    let compilation = scene::geotrace::compile(PROGRAM);
    compilation
        .scene
        .unwrap_or_else(|| panic!("{:?}", compilation.diagnostics))
}

fn solid(scene: &Scene, name: &str) -> Result<SolidSurface, ManifoldError> {
    let (id, _) = scene.object(name).expect("an object");
    SolidSurface::new(scene, &ParamValues::initial(scene), id)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    square.sqrt()
}

#[test]
fn a_declared_geodesic_on_a_solid_has_a_line_for_each_instance() {
    let scene = scene();
    let (id, object) = scene.object("g").expect("a geodesic");
    assert!(lies_in_space(&scene, id) && scene.is_in_space(object));
    let mut params = ParamValues::initial(&scene);
    for radius in [2.0, 2.5] {
        params.set(&scene, "r", &[radius]).expect("in range");
        let followed = follow_declared(&scene, &params, id);
        assert!(followed.notes.is_empty(), "{:?}", followed.notes);
        assert_eq!((followed.count, followed.lines.len()), (4, 2));
        for (k, line) in followed.lines.iter().enumerate() {
            let (b, c) = if k == 0 {
                (1.0, 0.0)
            } else {
                (0.5_f64.sqrt(), 0.5_f64.sqrt())
            };
            for (n, knot) in line.iter().enumerate() {
                let t = n as f64 - 1.0;
                let (sin, cos) = (t / radius).sin_cos();
                let truth = [cos, b * sin, c * sin].map(|x| radius * x);
                let at = knot.and_then(|knot| knot.position).expect("a knot");
                assert!(apart(at, truth) < 1e-8, "{t}: {at:?}");
            }
        }
    }
}

#[test]
fn a_line_ends_at_the_cut_of_its_solid() {
    let scene = scene();
    let (id, _) = scene.object("h").expect("a geodesic");
    let followed = follow_declared(&scene, &ParamValues::initial(&scene), id);
    let line = &followed.lines[0];
    let last = line.iter().flatten().last().and_then(|knot| knot.position);
    let [x, _, z] = last.expect("a knot");
    assert!(z.abs() < 1e-9 && (x - 2.0).abs() < 1e-9, "{x} {z}");
    assert!(line.last().is_some_and(Option::is_none));
}

#[test]
fn a_geodesic_that_cannot_start_says_why() {
    let scene = scene();
    let (id, _) = scene.object("none").expect("a geodesic");
    let followed = follow_declared(&scene, &ParamValues::initial(&scene), id);
    assert!(followed.lines.iter().flatten().all(Option::is_none));
    let note = followed.notes.first().expect("a note");
    assert!(
        note.contains("`none`") && note.contains("normal to the surface"),
        "{note}"
    );
}

#[test]
fn a_camera_stands_where_the_ray_along_x_leaves() {
    let scene = scene();
    for (name, place, within) in [
        ("ball", [2.0, 0.0, 0.0], 1e-8),
        // Through the hole, and out on its other side. Its box is a little wider than the ring.
        ("ring", [2.5, 0.0, 0.0], 0.02),
        ("pipe", [1.0, 0.0, 0.0], 1e-12),
    ] {
        let found = solid(&scene, name).expect("a solid").first_place();
        let found = found.expect("a place");
        assert!(apart(found, place) < within, "{name} {found:?}");
    }
    let name = "empty".to_owned();
    let refused = solid(&scene, &name).expect_err("no surface");
    assert_eq!(refused, ManifoldError::Empty { name });
    assert!(solid(&scene, "pipe").expect("a solid").bounds().is_none());
    let refused = solid(&scene, "p").expect_err("a point");
    assert_eq!(
        refused,
        ManifoldError::NoSurface {
            name: Some("p".into())
        }
    );
}

#[test]
fn a_camera_stands_on_what_no_ray_along_an_axis_meets() {
    let text = "
        function cube(x, y, z) = max(abs x, abs y, abs z) - 1/2;
        function ball(x, y, z) = x^2 + y^2 + z^2 - 0.65^2;
        solid die = cube \\ ball;
        solid ground(x, y, z) = z;
    ";
    let scene = scene::geotrace::compile(text).scene.expect("a scene");
    let place = |name: &str| solid(&scene, name).expect("a solid").first_place();
    // Beside a corner, and not on an edge. Its box is a little wider.
    let on_die = place("die").expect("a place");
    assert!((on_die[0] - 0.5).abs() < 1e-12, "{on_die:?}");
    assert!(apart(on_die, [0.5, 0.4, 0.3]) < 1e-2, "{on_die:?}");
    let on_ground = place("ground").expect("a place");
    assert!(apart(on_ground, [1.0, 0.8, 0.0]) < 1e-12, "{on_ground:?}");
}

#[test]
fn a_camera_stands_on_the_largest_face_and_not_on_a_narrow_cut() {
    let text = "solid shell(x, y, z) = abs(sin z - sinh x sinh y) - 0.05, x : [-2, 2], y : [-2, 2], z : [-6, 6];";
    let scene = scene::geotrace::compile(text).scene.expect("a scene");
    let found = solid(&scene, "shell").expect("a solid").first_place();
    let [x, y, z] = found.expect("a place");
    let level = (z.sin() - x.sinh() * y.sinh()).abs();
    assert!((level - 0.05).abs() < 1e-6, "{found:?} is on a cut");
}

#[test]
fn a_camera_stands_where_geodesics_go_far_and_not_at_a_double_point() {
    let text = std::fs::read_to_string("../../examples/sextic.gtr").expect("an example");
    let scene = scene::geotrace::compile(&text).scene.expect("a scene");
    let solid = solid(&scene, "sextic").expect("a solid");
    let place = solid.first_place().expect("a place");
    let reach = |direction: [f64; 3]| {
        let options = Options::default();
        let trace = solid.surface().trace(place, direction, 1.0, &options);
        trace.map_or(0.0, |trace| trace.length)
    };
    let directions = [[1.0, 0.2, 0.3], [-0.3, 1.0, 0.2], [0.2, -0.3, 1.0]];
    let both = directions.map(|way| reach(way) + reach(way.map(|x| -x)));
    assert!(both.iter().sum::<f64>() > 1.0, "{place:?} {both:?}");
}

#[test]
fn a_solid_that_a_param_flattens_has_no_surface() {
    let text = "param c : [0, 1]; solid ball(x, y, z) = x^2 + y^2 + z^2 - 1; solid s = ball | ball @ scale (1, 1, c);";
    let scene = scene::geotrace::compile(text).scene.expect("a scene");
    let refused = solid(&scene, "s").expect_err("flat").to_string();
    assert_eq!(refused, "`s` has no surface: the map of `ball` is singular");
    let (id, _) = scene.object("s").expect("a solid");
    let mut params = ParamValues::initial(&scene);
    params.set(&scene, "c", &[0.5]).expect("in range");
    SolidSurface::new(&scene, &params, id).expect("a solid");
}

#[test]
fn a_solid_is_the_union_over_its_grids_unless_they_have_a_value() {
    let scene = scene();
    let (id, _) = scene.object("row").expect("a solid");
    let mut params = ParamValues::initial(&scene);
    let both = SolidSurface::new(&scene, &params, id).expect("a solid");
    // About each ball once around.
    for middle in [0.0, 3.0] {
        let from = [middle, 0.0, 1.0];
        let end = both
            .surface()
            .trace(from, [1.0, 0.0, 0.0], PI, &Options::default());
        let end = end.expect("a start");
        assert_eq!(end.status, Status::Complete);
        assert!(apart(end.position, [middle, 0.0, -1.0]) < 1e-8, "{end:?}");
    }
    params.set(&scene, "k", &[1.0]).expect("in range");
    let one = SolidSurface::new(&scene, &params, id).expect("a solid");
    let place = one.first_place().expect("a place");
    assert!(apart(place, [4.0, 0.0, 0.0]) < 1e-8, "{place:?}");
    let [lower, _] = one.bounds().expect("a box");
    assert!(apart(lower, [2.0, -1.0, -1.0]) < 1e-8, "{lower:?}");
}
