//! Solids, lights, cameras, backgrounds and attributes: what programs with them mean.

use std::fmt::Write as _;

use scene::geotrace::compile;
use scene::{
    AttributeValue, Object, Outcome, ParamValues, Scene, Shape, Solid, SolidLeaf, SolidStep, Value,
};

fn scene(source: &str) -> Scene {
    let compilation = compile(source);
    assert!(
        !compilation.has_errors(),
        "{source}\n{:#?}",
        compilation.diagnostics
    );
    compilation.scene.expect("no errors")
}

fn object<'s>(scene: &'s Scene, name: &str) -> &'s Object {
    let staged = scene.parts.iter().chain(&scene.stage);
    let mut all = scene.objects.iter().chain(staged);
    all.find(|object| object.name == name).expect("an object")
}

fn solid<'s>(scene: &'s Scene, name: &str) -> &'s Solid {
    object(scene, name).shape.solid().expect("a solid")
}

fn names(objects: &[Object]) -> Vec<&str> {
    objects.iter().map(|object| &*object.name).collect()
}

fn words(object: &Object) -> Vec<&str> {
    object.attributes.iter().map(|it| it.word).collect()
}

fn attributes(leaf: &SolidLeaf) -> Vec<&str> {
    leaf.attributes.iter().map(|it| it.word).collect()
}

/// The value of an expression at the initial values of the params.
fn value(source: &str, expression: &str) -> Vec<f64> {
    let compilation = compile(source);
    let scene = compilation.scene.as_ref().expect("no errors");
    let params = ParamValues::initial(scene);
    let found = compilation.evaluate(expression, &params);
    match found.expect("a value").outcome {
        Outcome::Single(Value::Number(number)) => vec![number.expect("defined")],
        Outcome::Single(Value::Vector(numbers)) => {
            let numbers = numbers.into_iter();
            numbers.map(|number| number.expect("defined")).collect()
        }
        other => panic!("{other:?}"),
    }
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-13, "{found:?} {expected:?}");
    }
}

const EXAMPLES: [&str; 6] = [
    "function square(x,y) = max(abs x, abs y) - 1;
    function circle(x,y) = x^2 + y^2 - 0.8^2;
    solid plate = square \\ circle, z : [0, 0.3];
    solid same(x,y,z) = max(square(x,y), -circle(x,y)), z : [1, 1.3];",
    "param r = 0.65 : [0.5, 0.8];
    solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2, mirror : 0.1;
    solid ball(x,y,z) = x^2 + y^2 + z^2 - r^2, color : (sin^2(9x),0.2,0.3);
    solid die = cube \\ ball;",
    "param a : [0, pi];
    grid k : [0, 11pi/6, 12];
    function lean(x,y,z) = (x + 0.4z, y, z);
    solid rod(x,y,z) = max(x^2 + y^2 - 0.1, abs z - 2);
    solid ring = rod @ scale 0.2 @ lean @ (1,0,0) @ rotate (0,0,k + a);",
    "function ball(x,y,z) = x^2 + y^2 + z^2 - 1;
    solid lens = ball @ (0.8,0,0) & ball @ (-0.8,0,0), glass : 0.95;
    solid ground(x,y,z) = z + 1, color : 0.6 + 0.3sin(4x)sin(4y);
    light lamp = @ (2,-2,4), falloff : 5;
    light sun = (1,2,-3), ambient : 0.2;
    light beam = (0,1,-1) @ (0,-3,3), angle : pi/8;
    camera eye = (0,4,-1) @ (0,-4,1), aperture : 0.05, bokeh : star;
    background sky(x,y,z) = (1 - z)(0.8,0.9,1) + z(0.1,0.3,0.6);",
    "solid g(x,y,z) = sin x cos y + sin y cos z + sin z cos x, x : [-3,3], y : [-3,3], z : [-3,3];
    surface bowl(u,v) = (5u cos v, 5u sin v, 4u^2 - 5), u : [0,1], v : [0,2pi], mirror : 0.8;",
    "solid q(x,y,z) = x^4 + y^4 + z^4 - 1, bump : 0.01sin(40z);
    define p = (0.5,0.5,0.96717);
    vector n = (q_x(p),q_y(p),q_z(p)) @ p;",
];

#[test]
fn the_examples_of_the_language_compile() {
    for source in EXAMPLES {
        scene(source);
    }
}

#[test]
fn a_solid_that_a_set_names_is_a_part_and_its_copy_is_drawn() {
    let scene_of_die = scene(EXAMPLES[1]);
    assert_eq!(names(&scene_of_die.objects), ["die"]);
    assert_eq!(names(&scene_of_die.parts), ["cube", "ball"]);
    let die = solid(&scene_of_die, "die");
    let expected = [
        SolidStep::Leaf(0),
        SolidStep::Leaf(1),
        SolidStep::Difference,
    ];
    assert_eq!(die.steps, expected);
    assert_eq!(attributes(&die.leaves[0]), ["mirror"]);
    assert_eq!(attributes(&die.leaves[1]), ["color"]);
    assert_eq!(
        [&*die.leaves[0].name, &*die.leaves[1].name],
        ["cube", "ball"]
    );
    let copied = scene(
        "solid ball(x,y,z) = x; solid half = ball; curve c(t) = (ball(t,0,0),0,0), t : [0,1];",
    );
    assert_eq!(names(&copied.objects), ["half", "c"]);
    // Used as a function, a solid is drawn all the same.
    let used = scene("solid ball(x,y,z) = x; define a = ball(1,2,3);");
    assert_eq!(names(&used.objects), ["ball"]);
}

#[test]
fn geodesics_find_their_surfaces_when_solids_are_put_aside() {
    let scene = scene(
        "solid a(x,y,z) = x; surface s(u,v) = (u,v,0), u : [0,1], v : [0,1]; solid b = a;
        surface w(u,v) = (u,v,1), u : [0,1], v : [0,1]; geodesic g(t) : w = (1,0) @ (0,0), t : [0,1];",
    );
    let (surface, _) = object(&scene, "g").shape.geodesic().expect("a geodesic");
    assert_eq!(scene.get(surface).expect("a surface").name, "w");
}

#[test]
fn sets_bind_as_they_are_written() {
    let functions = "function a(x,y,z) = x; function b(x,y,z) = y; function c(x,y) = x + y;";
    let steps = |set: &str| {
        let scene = scene(&format!("{functions} solid s = {set};"));
        let steps = solid(&scene, "s").steps.iter();
        let shown = steps.map(|step| match step {
            SolidStep::Leaf(leaf) => leaf.to_string(),
            SolidStep::Union => "|".to_owned(),
            SolidStep::Intersection => "&".to_owned(),
            SolidStep::Difference => "\\".to_owned(),
            SolidStep::Instances(grids) => format!("{grids:?}"),
        });
        shown.collect::<String>()
    };
    assert_eq!(steps("a | b & c"), "012&|");
    assert_eq!(steps("a \\ b | c"), "01\\2|");
    assert_eq!(steps("a & b & c"), "01&2&");
    assert_eq!(steps("a & (b | c)"), "012|&");
    assert_eq!(
        steps("[a \\ {b}] @ (1,0,0) | c @ scale 2 @ (0,0,1)"),
        "01\\2|"
    );
}

#[test]
fn solids_are_functions_without_their_cuts_under_their_maps() {
    let source = "function lean(x,y,z) = (x + 0.5z, y, z);
        solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, x : [0, 1];
        solid moved = ball @ scale (2,1,1) @ (1,0,0), z : [0, 9];
        solid turned = ball @ (1,0,0) @ rotate (0,0,pi/2);
        solid leaning = ball @ lean;
        solid both = moved | turned;
        solid less = moved \\ turned;
        solid meet = moved & turned;
        solid disk(x,y) = x^2 + y^2 - 4;";
    let f = |x: f64, y: f64, z: f64| x * x + y * y + z * z - 1.0;
    let (x, y, z) = (0.75, -0.5, 0.25);
    let at = "(0.75, -0.5, 0.25)";
    let moved = f((x - 1.0) / 2.0, y, z);
    let turned = f(x, y - 1.0, z);
    let found = |name: &str| value(source, &format!("{name}{at}"));
    close(&found("ball"), &[f(x, y, z)]);
    close(&found("moved"), &[moved]);
    close(&found("turned"), &[turned]);
    close(&found("leaning"), &[f(x - 0.5 * z, y, z)]);
    close(&found("both"), &[moved.min(turned)]);
    close(&found("less"), &[moved.max(-turned)]);
    close(&found("meet"), &[moved.max(turned)]);
    close(&value(source, "disk(1, 2)"), &[1.0]);
    // Derivatives by the parameters, x, y and z of a set.
    close(&value(source, &format!("ball_y{at}")), &[2.0 * y]);
    close(&value(source, &format!("moved_x{at}")), &[(x - 1.0) / 2.0]);
    close(&value(source, &format!("turned_z_z{at}")), &[2.0]);
    close(&value(source, "disk_x(3, 0)"), &[6.0]);
}

#[test]
fn grids_close_at_a_solid() {
    let source = "grid k : [0, 2, 3]; param a = 0.5 : [0, 1];
        solid balls(x,y,z) = (x - k)^2 + y^2 + z^2 - a;
        solid moved = balls @ (0, 0, 1);
        point p = (balls(1.5, 0, 0), 0, 0);
        point q = (k, 0, 0);";
    let scene = scene(source);
    for name in ["balls", "moved", "p"] {
        assert!(object(&scene, name).grids.is_empty(), "{name}");
        assert_eq!(object(&scene, name).params.len(), 1, "{name}");
    }
    assert_eq!(object(&scene, "q").grids.len(), 1);
    let steps = &solid(&scene, "moved").steps;
    assert!(matches!(
        steps[..],
        [SolidStep::Leaf(0), SolidStep::Instances(_)]
    ));
    // As a function it is the least of its instances.
    close(&value(source, "balls(1.25, 0, 0)"), &[0.0625 - 0.5]);
    close(&value(source, "moved(1.25, 0, 2)"), &[1.0625 - 0.5]);
    close(&value(source, "balls_x(1.25, 0, 0)"), &[0.5]);
}

#[test]
fn a_grid_that_is_read_inside_and_outside_of_a_union_has_uniforms_for_both() {
    let source = "grid k : [0, 2, 3];
        solid row(x,y,z) = (x - k)^2 + y^2 + z^2 - 0.1, color : (k / 2, 0, 0);
        solid field = row @ (0, k, 0);
        solid cube = field @ (0, 0, k), mirror : k / 3;
        solid again = row;";
    let scene = scene(source);
    let bound = |name: &str| -> Vec<u32> {
        let steps = solid(&scene, name).steps.iter();
        let bound = steps.filter_map(|step| match step {
            SolidStep::Instances(grids) => Some(grids[0].first_uniform),
            _ => None,
        });
        bound.collect()
    };
    let own = scene.grids[0].first_uniform;
    assert_eq!(bound("row"), [own]);
    assert_eq!(bound("again"), [own]);
    let field = bound("field");
    assert!(field.len() == 2 && field[0] != own && field[1] == own);
    let cube = bound("cube");
    assert!(cube.len() == 3 && cube[2] == own);
    assert!(cube[0] != cube[1] && cube[0] != own && cube[1] != own);
    // Every combination is there: 3 times 3 times 3 balls.
    for [x, y, z] in [[0, 1, 2], [2, 0, 1], [1, 1, 1]] {
        let at = format!("cube({x}, {y}, {z})");
        close(&value(source, &at), &[-0.1]);
    }
    close(&value(source, "field(2, 1, 0.5)"), &[0.15]);
}

#[test]
fn an_attribute_on_a_set_replaces_those_of_its_parts() {
    let scene = scene(
        "solid a(x,y,z) = x, color : x, mirror : 0.5;
        solid b(x,y,z) = y, bump : z;
        solid s = (a @ (1,0,0)) | b, mirror : y, image : wood;
        solid t = s @ scale 2;",
    );
    let leaves = &solid(&scene, "t").leaves;
    assert_eq!(attributes(&leaves[0]), ["color", "mirror", "image"]);
    assert_eq!(attributes(&leaves[1]), ["bump", "mirror", "image"]);
    // Each is stated in the coordinates of the solid that states it.
    let maps = |leaf: usize| leaves[leaf].attributes.iter().map(|it| it.map);
    let maps: Vec<_> = maps(0).chain(maps(1)).collect();
    assert_eq!(maps[0], Some(leaves[0].map));
    assert_eq!(maps[1], maps[4]);
    assert_eq!(maps[1], Some(leaves[1].map));
    assert_ne!(maps[0], maps[1]);
    let own = &object(&scene, "s").attributes;
    assert_eq!(own[1].value, AttributeValue::Word("wood".to_owned()));
    assert_eq!(own[0].map, None);
}

#[test]
fn intervals_cut_solids_and_sets() {
    let scene = scene(
        "function a(x,y,z) = x; solid s(x,y,z) = x, y : [0, 1, 30];
        solid t = a | s, z : [2, 3], x : [-1, 1];",
    );
    let cut = solid(&scene, "s").leaves[0].cuts;
    assert!(cut[0].is_none() && cut[2].is_none());
    assert_eq!(
        cut[1].map(|cut| (cut.range.max, cut.cells)),
        Some((1.0, Some(30)))
    );
    let set = solid(&scene, "t");
    assert_eq!(set.leaves.len(), 3);
    assert_eq!(set.steps.last(), Some(&SolidStep::Intersection));
    let cuts = set.leaves[2].cuts;
    assert!(cuts[0].is_some() && cuts[1].is_none());
    assert_eq!(cuts[2].map(|cut| cut.cells), Some(None));
    assert_eq!(scene.graph.value(set.leaves[2].field), Some(-1.0));
    assert_eq!(&*set.leaves[2].name, "t");
}

#[test]
fn lights_cameras_and_backgrounds_stand_on_the_stage_and_for_their_places() {
    let source = EXAMPLES[3];
    let scene = scene(source);
    assert_eq!(names(&scene.stage), ["lamp", "sun", "beam", "eye", "sky"]);
    assert_eq!(names(&scene.objects), ["lens", "ground"]);
    let parts = |name: &str| match &object(&scene, name).shape {
        Shape::Light(light) => (light.direction.is_some(), light.position.is_some()),
        _ => panic!("no light"),
    };
    assert_eq!(parts("lamp"), (false, true));
    assert_eq!(parts("sun"), (true, false));
    assert_eq!(parts("beam"), (true, true));
    close(&value(source, "lamp"), &[2.0, -2.0, 4.0]);
    close(&value(source, "sun"), &[1.0, 2.0, -3.0]);
    close(&value(source, "beam"), &[0.0, -3.0, 3.0]);
    close(&value(source, "eye"), &[0.0, -4.0, 1.0]);
    close(&value(source, "sky(0,0,1)"), &[0.1, 0.3, 0.6]);
    assert_eq!(words(object(&scene, "eye")), ["aperture", "bokeh"]);
    close(
        &value("background b = (0.1, 0.2, 0.3);", "b"),
        &[0.1, 0.2, 0.3],
    );
    close(&value("background b = 0.5;", "2b"), &[1.0]);
}

#[test]
fn a_param_that_only_an_attribute_of_a_solid_reads_does_not_change_what_reads_its_function() {
    let scene = scene(
        "param s : [0.5, 1];
        solid d(x,y,z) = x^2 + y^2 + z^2 - 1, color : (s, 0, 0);
        solid h = d | d @ (0, 0, 1);
        curve c(t) = (t, d(t, 0, 0), h(t, 0, 0)), t : [0, 1];
        geodesic g(t) : d = (0, 1, 0) @ (1, 0, 0), t : [0, 1];",
    );
    let params = |name| object(&scene, name).params.len();
    assert_eq!(["d", "h", "c", "g"].map(params), [1, 1, 0, 0]);
}

#[test]
fn what_is_drawn_states_attributes_over_its_parameters() {
    let scene = scene(
        "param r : [0, 1]; grid k : [0, 1, 3];
        point p = (1,2,3), color : (1,0,0), radius : 0.1 + r;
        vector v = (1,0,0) @ p, mirror : 0.5, color : k;
        curve c(t) = (t,0,0), t : [0,1], radius : 0.01t, specular : 2;
        surface s(u,v1) = (u,v1,0), glass : 0.5 u, u : [0,1], v1 : [0,1], uv : (u, v1), image : earth;
        metric m(u,w) = (1,0,1), u : [0,1], color : (u, w, 0), w : [0,1];
        geodesic g(q) : s = (1,0) @ (0,0), q : [0,1], color : q;",
    );
    assert_eq!(words(object(&scene, "p")), ["color", "radius"]);
    assert_eq!(object(&scene, "p").params.len(), 1);
    assert_eq!(object(&scene, "v").grids.len(), 1);
    assert_eq!(words(object(&scene, "c")), ["radius", "specular"]);
    assert_eq!(words(object(&scene, "s")), ["glass", "uv", "image"]);
    assert_eq!(words(object(&scene, "m")), ["color"]);
    assert_eq!(words(object(&scene, "g")), ["color"]);
}

#[test]
fn the_words_of_solids_are_free_names_elsewhere() {
    let source =
        "define light = 2; define camera = 3 light; function solid(background) = background^2;
        curve scale(color) = (color, solid(color), camera), color : [0, 1];
        define image = light camera; define rotate = scale' image; point mirror = rotate;";
    close(&value(source, "light + camera + image"), &[20.0]);
    // A declaration behind a missing `;` is seen by its word, unless that is defined.
    let found = compile("define a = 1\nsolid s(x,y,z) = x;").diagnostics;
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].code.0, "missing-semicolon");
    let maps = "define scale = (0,0,1); solid a(x,y,z) = x; solid b = a @ scale;";
    scene(maps);
    let x = "define x = 0.5; solid a(u,v,w) = u; solid b = a, color : x, mirror : y;";
    let scene = scene(x);
    let colour = &object(&scene, "b").attributes[0].value;
    let AttributeValue::Numbers(nodes) = colour else {
        panic!("no number");
    };
    assert_eq!(scene.graph.value(nodes[0]), Some(0.5));
}

#[test]
fn solids_that_double_and_long_chains_of_them_end_in_a_sentence_or_compile() {
    // Each solid has twice the leaves of the one above.
    let mut doubling = String::from("solid s0(x,y,z) = x^2 + y^2 + z^2 - 1;\n");
    for k in 1..40 {
        let _ = writeln!(
            doubling,
            "solid s{k} = s{} | s{} @ ({k}, 0, 0);",
            k - 1,
            k - 1
        );
    }
    let found = compile(&doubling).diagnostics;
    assert!(["too-many-leaves", "expression-too-large"].contains(&found[0].code.0));
    // A chain is no deeper than one solid.
    let mut chain = String::from("solid s0(x,y,z) = x;\n");
    for k in 1..3_000 {
        let _ = writeln!(chain, "solid s{k} = s{} @ (1, 0, 0);", k - 1);
    }
    let _ = writeln!(chain, "define a = s2999(2998, 0, 0);");
    close(&value(&chain, "a"), &[-1.0]);
    let nested = |depth: usize| {
        let (open, shut) = ("(".repeat(depth), ")".repeat(depth));
        format!("solid a(x,y,z) = x; solid b = {open}a{shut};")
    };
    scene(&nested(200));
    let found = compile(&nested(100_000)).diagnostics;
    assert_eq!(found[0].code.0, "too-deep");
}

#[test]
fn an_opening_that_is_too_wide_is_told_by_the_projection() {
    for (states, expected) in [
        (
            "fov : 75",
            "the `fov` of a camera that is not spherical is below pi, but this is 75",
        ),
        (
            "fov : 4, projection : pinhole",
            "the `fov` of a camera that is not spherical is below pi, but this is 4",
        ),
        (
            "projection : spherical, fov : 7",
            "`fov` is > 0 and ≤ 2pi, but this is 7",
        ),
        (
            "fov : 200, projection : cylindrical",
            "the `fov` of a camera that is not spherical is below pi, but this is 200",
        ),
        ("fov : -1", "`fov` is > 0 and ≤ 2pi, but this is -1"),
    ] {
        let compilation = compile(&format!("camera c = (1,0,0) @ (-3,0,0), {states};"));
        let messages: Vec<&str> = compilation
            .diagnostics
            .iter()
            .map(|it| &*it.message)
            .collect();
        assert_eq!(messages, [expected], "{states}");
    }
    scene("camera c = (1,0,0) @ (-3,0,0), projection : spherical, fov : 2pi;");
}

#[test]
fn a_background_whose_numbers_are_bytes_has_a_warning() {
    for (colour, numbers) in [
        ("(135, 206, 235)", Some("(135, 206, 235)")),
        ("(0, 0, 64)", Some("(0, 0, 64)")),
        ("(2, 2, 3)", Some("(2, 2, 3)")),
        ("200", Some("(200, 200, 200)")),
        ("(0.8, 0.9, 1)", None),
        ("(1, 1, 8)", None),
        ("(1, 0.5, 16)", None),
        ("(1000, 1000, 1000)", None),
        ("(135, 206, 235)/255", None),
    ] {
        let compilation = compile(&format!("background sky = {colour};"));
        let found: Vec<String> = compilation
            .diagnostics
            .iter()
            .map(|it| format!("{}: {}", it.message, it.hint.as_deref().unwrap_or_default()))
            .collect();
        let expected = numbers.map(|numbers| {
            format!(
                "`sky` is far brighter than white: {numbers}: components of colours are 0…1: divide by 255"
            )
        });
        assert_eq!(found, Vec::from_iter(expected), "{colour}");
        assert!(compilation.scene.is_some(), "{colour}");
    }
}
