//! `geotrace cast` against closed forms, and against the membership of points, through the binary's JSON.

use glam::{DMat3, DVec3};
use serde_json::Value;
use testing::binary::geotrace;

/// Casts one ray and returns the document.
#[track_caller]
fn cast(program: &str, from: [f64; 3], direction: [f64; 3], more: &[&str]) -> Value {
    let list = |v: [f64; 3]| format!("{:?},{:?},{:?}", v[0], v[1], v[2]);
    let mut words: Vec<String> = ["cast", "-", "--format", "json"].map(str::to_owned).into();
    words.extend(["--from".to_owned(), list(from)]);
    words.extend(["--direction".to_owned(), list(direction)]);
    words.extend(more.iter().map(|word| (*word).to_owned()));
    geotrace(&words)
        .input(program)
        .run()
        .expect_status(0)
        .json()
}

/// Casts the rays of a file into the solid `all` and returns the documents.
fn cast_all(program: &str, rays: &[[DVec3; 2]]) -> Vec<Value> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rays");
    let lines = rays.iter().map(|[from, direction]| {
        let [x, y, z] = from.to_array();
        let [a, b, c] = direction.to_array();
        format!("{x:?} {y:?} {z:?} {a:?} {b:?} {c:?}\n")
    });
    std::fs::write(&path, lines.collect::<String>()).expect("written");
    let path = path.display().to_string();
    let words = [
        "cast", "-", "--format", "json", "--solid", "all", "--rays", &path,
    ];
    let run = geotrace(words).input(program).run();
    let run = run.expect_status(0);
    let documents = run.stdout.lines();
    documents
        .map(|line| serde_json::from_str(line).expect("a document for each ray"))
        .collect()
}

fn vector(value: &Value) -> DVec3 {
    let number = |k: usize| value[k].as_f64().expect("a number");
    DVec3::new(number(0), number(1), number(2))
}

fn list(document: &Value) -> &[Value] {
    document["crossings"].as_array().expect("a list")
}

fn times(document: &Value) -> Vec<f64> {
    let all = list(document).iter();
    all.map(|one| one["t"].as_f64().expect("a number"))
        .collect()
}

#[track_caller]
fn assert_times(document: &Value, expected: &[f64]) {
    let found = times(document);
    let close = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-10 * (1.0 + b);
    assert!(
        found.len() == expected.len() && found.iter().zip(expected).all(close),
        "{found:?}, not {expected:?}"
    );
}

const DIE: &str = "
param r = 0.65 : [0.5, 0.8];
solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2, mirror : 0.1;
solid ball(x,y,z) = x^2 + y^2 + z^2 - r^2, color : (sin^2(9x),0.2,0.3);
solid die = cube \\ ball;
";

#[test]
fn a_ray_enters_and_leaves_what_is_left_of_a_cube() {
    let found = cast(DIE, [3.0, 0.45, 0.45], [-2.0, 0.0, 0.0], &[]);
    let half = (0.65f64.powi(2) - 2.0 * 0.45f64.powi(2)).sqrt();
    assert_times(&found, &[2.5, 3.0 - half, 3.0 + half, 3.5]);
    let crossings = list(&found);
    let of = |key: &str| -> Vec<&Value> { crossings.iter().map(|one| &one[key]).collect() };
    assert_eq!(of("leaf"), ["cube", "ball", "ball", "cube"]);
    assert_eq!(of("solid"), ["die"; 4]);
    assert_eq!(of("entering"), [true, false, true, false]);
    assert_eq!(vector(&crossings[0]["normal"]), DVec3::X);
    // The normal leads out of the die: into the ball.
    let inner = vector(&crossings[1]["normal"]);
    let expected = -DVec3::new(half, 0.45, 0.45) / 0.65;
    assert!(inner.distance(expected) < 1e-12, "{inner}");
    assert_eq!(found["first"]["object"], "die");
    assert_eq!(found["first"]["kind"], "solid");
    assert_eq!(found["first"]["leaf"], "cube");
    assert_eq!(found["inside"], serde_json::json!([]));
    assert_eq!(found["notes"], serde_json::json!([]));

    let wider = ["--set", "r=0.8"];
    let found = cast(DIE, [3.0, 0.45, 0.45], [-1.0, 0.0, 0.0], &wider);
    let half = (0.64 - 2.0 * 0.45f64.powi(2)).sqrt();
    assert_times(&found, &[2.5, 3.0 - half, 3.0 + half, 3.5]);
    let within = cast(DIE, [0.49, 0.45, 0.45], [1.0, 0.0, 0.0], &[]);
    assert_eq!(within["inside"], serde_json::json!(["die"]));
    assert_times(&within, &[0.01]);
}

#[test]
fn an_opaque_face_is_met_before_glass_that_lies_on_it() {
    const TABLE: &str = "
        solid pane(x, y, z) = max(abs x, abs y, abs z) - 1, glass : 1;
        solid table(x, y, z) = max(abs x - 0.5, abs y - 0.5, abs z - 1);
        surface sheet(u, v) = (u, v, 1), u : [-0.25, 0.25], v : [-0.25, 0.25], glass : 0.9;
    ";
    // The table is flush with the pane, and farther inside with the sheet; at the rim there is the pane alone.
    for (x, object) in [(0.4, "table"), (0.1, "table"), (0.8, "pane")] {
        let found = cast(TABLE, [x, 0.1, 5.0], [0.0, 0.0, -1.0], &[]);
        assert_eq!(found["first"]["object"], object, "{x}");
    }
}

#[test]
fn a_part_is_cast_alone() {
    let found = cast(DIE, [3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], &["--solid", "ball"]);
    assert_times(&found, &[2.35, 3.65]);
    assert_eq!(found["crossings"][0]["solid"], "ball");
    let all = cast(DIE, [3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], &[]);
    assert_times(&all, &[]);
    assert_eq!(all["first"], Value::Null);
}

#[test]
fn a_ball_is_entered_and_left_from_however_far_it_is_seen() {
    const BALL: &str = "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;";
    const SMALL: &str = "function f(x, y, z) = x^2 + y^2 + z^2 - 1; solid ball = f @ scale 1e-6;";
    for (program, radius) in [(BALL, 1.0), (SMALL, 1e-6)] {
        for away in [30.0, 1.6e7, 2e7, 1e8, 3e9, 1e12] {
            let away: f64 = radius * away;
            for [x, y, z] in [[away, 0.0, 0.0], [0.0, 0.0, away], [0.0, -away, 0.0]] {
                let ray = cast(program, [x, y, z], [-x / away, -y / away, -z / away], &[]);
                let entering = list(&ray).iter().map(|one| one["entering"].as_bool());
                let entering: Vec<_> = entering.collect();
                assert_eq!(entering, [Some(true), Some(false)], "{ray}");
                for (t, side) in times(&ray).into_iter().zip([-1.0, 1.0]) {
                    let off = (t - (away + side * radius)).abs();
                    assert!(off <= 4.0 * f64::EPSILON * away, "{ray}");
                }
            }
        }
    }
}

#[test]
fn instances_say_which_they_are() {
    let program = "
grid k : [0, 11pi/6, 12];
solid rod(x,y,z) = max(x^2 + y^2 - 0.01, abs z - 2);
solid ring = rod @ (1,0,0) @ rotate (0,0,k);
";
    let found = cast(program, [0.0, -5.0, 0.0], [0.0, 1.0, 0.0], &[]);
    assert_times(&found, &[3.9, 4.1, 5.9, 6.1]);
    let place = |k: usize| {
        found["crossings"][k]["grids"]["k"]
            .as_f64()
            .expect("a value")
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!((place(0) - 3.0 * quarter).abs() < 1e-12 && (place(2) - quarter).abs() < 1e-12);
    let one = cast(
        program,
        [0.0, -5.0, 0.0],
        [0.0, 1.0, 0.0],
        &["--set", "k=pi/2"],
    );
    assert_times(&one, &[5.9, 6.1]);
    assert!(one["crossings"][0].get("grids").is_none());
}

#[test]
fn what_else_is_drawn_is_met_too() {
    let program = "
surface s(u,v) = (u,v,1), u : [-2,2], v : [-2,2];
point p = (0,0,3);
solid ball(x,y,z) = x^2 + y^2 + z^2 - 1/4;
";
    let down = |from: [f64; 3], way: f64| cast(program, from, [0.0, 0.0, way], &[]);
    let from_above = down([0.1, 0.0, 2.0], -1.0);
    assert_eq!(from_above["first"]["object"], "s");
    assert_eq!(from_above["first"]["kind"], "surface");
    assert_eq!(from_above["first"]["leaf"], Value::Null);
    assert_eq!(vector(&from_above["first"]["normal"]), DVec3::Z);
    // The normal of a surface leads back to the start.
    let from_below = down([1.0, 0.0, 0.0], 1.0);
    assert_eq!(vector(&from_below["first"]["normal"]), DVec3::NEG_Z);
    assert_eq!(list(&from_below).len(), 0);
    let point = down([0.0, 0.0, 5.0], -1.0);
    assert_eq!(point["first"]["kind"], "point");
    assert_eq!(list(&point).len(), 2, "points are no solids");
}

#[test]
fn a_map_that_params_make_singular_is_noted() {
    let program = "
param a = 1 : [0, 1];
solid ball(x,y,z) = x^2 + y^2 + z^2 - 1;
solid disc = ball @ scale (1,1,a);
";
    let whole = cast(program, [0.0, 0.0, 5.0], [0.0, 0.0, -1.0], &[]);
    assert_times(&whole, &[4.0, 6.0]);
    let flat = cast(
        program,
        [0.0, 0.0, 5.0],
        [0.0, 0.0, -1.0],
        &["--set", "a=0"],
    );
    assert_times(&flat, &[]);
    let note = "`disc` is not drawn: the map of `ball` is singular";
    assert_eq!(flat["notes"], serde_json::json!([note]));
}

#[test]
fn wrong_rays_and_names_are_refused_with_what_to_do() {
    let run = |words: &[&str]| {
        let words = [&["cast", "-"], words].concat();
        geotrace(&words).input(DIE).run()
    };
    run(&["--from", "0,0,0", "--direction", "0,0,0"])
        .expect_status(2)
        .expect_text("the direction of a ray must not be zero");
    run(&["--from", "0,0,0", "--direction", "1,0,0", "--solid", "bal"])
        .expect_status(2)
        .expect_text("declares no solid `bal`")
        .expect_text("its solids are `die`, `cube`, `ball`");
    run(&["--from", "0,0,0"]).expect_status(2);
    run(&["--rays", "no-such-file"]).expect_status(2);
    run(&["--rays", "-"])
        .expect_status(2)
        .expect_text("can be read only once");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rays");
    std::fs::write(&path, "0 0 0 1 0 0\n\n1 2 3 4 5\n").expect("written");
    run(&["--rays", &path.display().to_string()])
        .expect_status(1)
        .expect_text("rays:3: expected six numbers, found 5")
        .expect_text("a line is `x y z a b c`");
}

#[test]
fn human_output_is_in_sentences() {
    let words = [
        "cast",
        "-",
        "--from",
        "3,0.45,0.45",
        "--direction",
        "-1,0,0",
    ];
    let run = geotrace(words).input(DIE).run();
    run.expect_status(0)
        .expect_text("it first meets the solid `die`, face of `cube`: t = 2.5")
        .expect_text("enters `die` through `cube`")
        .expect_text("leaves `die` through `ball`");
}

/// Numbers without an order (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        // Few digits: the program has the same number.
        let share = (self.next() >> 44) as f64 / f64::from(1 << 20);
        let number = low + (high - low) * share;
        (number * 1e4).round() / 1e4
    }

    fn vector(&mut self, reach: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-reach, reach)))
    }
}

/// A set as a text and as the membership of points; the number says how near a point is to a leaf's surface.
enum Set {
    Leaf(usize, DMat3, DVec3),
    Join(usize, Box<Set>, Box<Set>),
}

const LEAVES: &str = "
solid ball(x,y,z) = x^2 + y^2 + z^2 - 1;
function cube(x,y,z) = max(abs x, abs y, abs z) - 0.8;
function rod(x,y,z) = max(x^2 + y^2 - 0.3, abs z - 1.2);
function ring(x,y,z) = (x^2 + y^2 + z^2 + 0.6)^2 - 3.2(x^2 + y^2);
function waves(x,y,z) = max(z - 0.2sin(4x)cos(3y), abs x - 1, abs y - 1, -1 - z);
";
const NAMES: [&str; 5] = ["ball", "cube", "rod", "ring", "waves"];

fn leaf(kind: usize, at: DVec3) -> f64 {
    let DVec3 { x, y, z } = at;
    match kind {
        0 => at.length_squared() - 1.0,
        1 => at.abs().max_element() - 0.8,
        2 => (x * x + y * y - 0.3).max(z.abs() - 1.2),
        3 => (at.length_squared() + 0.6).powi(2) - 3.2 * (x * x + y * y),
        _ => (z - 0.2 * (4.0 * x).sin() * (3.0 * y).cos())
            .max(x.abs() - 1.0)
            .max(y.abs() - 1.0)
            .max(-1.0 - z),
    }
}

impl Set {
    fn random(random: &mut Random, leaves: u64, text: &mut String) -> Self {
        if leaves == 1 {
            let kind = (random.next() % 5) as usize;
            let scale = DVec3::from_array([0; 3].map(|_| random.between(0.5, 1.5)));
            let (axis, place) = (random.vector(1.5), random.vector(1.2));
            let shear = random.between(-0.5, 0.5);
            let [DVec3 { x, y, z }, a, b] = [scale, axis, place];
            *text += &format!(
                "({} @ scale ({x},{y},{z}) @ rotate ({},{},{}) @ lean({shear}) @ ({},{},{}))",
                NAMES[kind], a.x, a.y, a.z, b.x, b.y, b.z
            );
            let turn = DMat3::from_axis_angle(axis.normalize(), axis.length());
            let lean = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(shear, 0.0, 1.0));
            return Self::Leaf(kind, lean * turn * DMat3::from_diagonal(scale), place);
        }
        let first = 1 + random.next() % (leaves - 1);
        let way = (random.next() % 3) as usize;
        text.push('(');
        let a = Self::random(random, first, text);
        *text += [" | ", " & ", " \\ "][way];
        let b = Self::random(random, leaves - first, text);
        text.push(')');
        Self::Join(way, a.into(), b.into())
    }

    fn contains(&self, at: DVec3) -> bool {
        match self {
            Self::Leaf(kind, map, place) => leaf(*kind, map.inverse() * (at - place)) <= 0.0,
            Self::Join(0, a, b) => a.contains(at) || b.contains(at),
            Self::Join(1, a, b) => a.contains(at) && b.contains(at),
            Self::Join(_, a, b) => a.contains(at) && !b.contains(at),
        }
    }

    /// The shears that the text names.
    fn shears(&self, into: &mut Vec<f64>) {
        match self {
            Self::Leaf(_, map, _) => into.push(map.determinant()),
            Self::Join(_, a, b) => {
                a.shears(into);
                b.shears(into);
            }
        }
    }
}

#[test]
fn crossings_of_random_sets_are_where_points_change_sides() {
    let mut random = Random(14);
    let (mut met, mut between, mut wrong) = (0, 0, 0);
    for round in 0..24 {
        let mut set_text = String::new();
        let set = Set::random(&mut random, 1 + round % 12, &mut set_text);
        let mut volumes = Vec::new();
        set.shears(&mut volumes);
        assert!(volumes.iter().all(|volume| *volume > 0.05));
        // The maps of the leaves are functions of their own.
        let (mut declared, mut number) = (String::new(), 0);
        while let Some(start) = set_text.find("lean(") {
            let end = start + set_text[start..].find(')').expect("a bracket");
            let shear = set_text[start + 5..end].to_owned();
            declared += &format!("function lean{number}(x,y,z) = (x + ({shear})z, y, z);\n");
            set_text.replace_range(start..=end, &format!("lean{number}"));
            number += 1;
        }
        let program = format!("{LEAVES}{declared}solid all = {set_text};\n");
        let rays: Vec<[DVec3; 2]> = (0..60)
            .map(|_| {
                let direction = random.vector(1.0);
                [random.vector(1.0) - 6.0 * direction.normalize(), direction]
            })
            .collect();
        let documents = cast_all(&program, &rays);
        assert_eq!(documents.len(), rays.len());
        for ([from, direction], document) in rays.iter().zip(&documents) {
            let direction = direction.normalize();
            let mut edges = vec![0.0];
            edges.extend(times(document));
            edges.push(40.0);
            met += edges.len() - 2;
            let mut inside = set.contains(*from);
            for pair in edges.windows(2) {
                // Where the ray grazes a surface the places are too near each other to tell.
                if pair[1] - pair[0] > 1e-5 {
                    for share in [0.01, 0.3, 0.62, 0.99] {
                        let t = pair[0] + share * (pair[1] - pair[0]);
                        between += 1;
                        wrong += usize::from(set.contains(*from + t * direction) != inside);
                    }
                }
                inside = !inside;
            }
        }
    }
    assert_eq!(wrong, 0);
    assert!(met > 500 && between > 5000, "{met}, {between}");
}

#[test]
fn a_ray_that_is_cut_short_says_so() {
    // Infinitely many crossings at two poles.
    let program = "\
        solid a(x, y, z) = sin(max(max(x^2 + y^2 + z^2 - 1, 1.5x + 0.5), (0.5y + 0.5)/(-(x^2 + y^2 + z^2 - 1))));\n\
        solid big(x, y, z) = x^2 + y^2 + z^2 - 30;\n\
        solid s = a & big;";
    let from = [
        3.084_533_753_707_055_4,
        -2.051_005_610_326_426_8,
        0.239_115_534_461_954_38,
    ];
    let along = [
        -1.797_496_216_801_824_3,
        1.444_515_131_763_430_8,
        -0.666_369_423_554_541_7,
    ];
    let found = cast(program, from, along, &["--solid", "s"]);
    let notes = found["notes"].as_array().expect("a list");
    let note = "the ray exceeds the work limit: crossings may be missing";
    assert!(notes.iter().any(|found| found == note), "{notes:?}");
    let short = cast(program, from, [0.0, 0.0, 1.0], &["--solid", "s"]);
    assert_eq!(short["notes"].as_array().map(Vec::len), Some(0));
}
