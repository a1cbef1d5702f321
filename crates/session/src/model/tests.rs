use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec2, DVec3};
use render::view::space::SpaceView;
use scene::{ObjectId, Rerun, Scene};

use super::{Animation, Choices, Model, Step, advanced};
use crate::Compiled;
use crate::motion::Motion;
use crate::reader::{Reader, SourceText};
use crate::{ChartCamera, InsideCamera, SpaceCamera};

fn compiled(text: &str) -> Compiled {
    read(&mut Reader::default(), text)
}

fn read(reader: &mut Reader, text: &str) -> Compiled {
    read_as("a.gtr", reader, text)
}

fn read_as(path: &str, reader: &mut Reader, text: &str) -> Compiled {
    let read = reader.read(&SourceText {
        language: &**ide::Languages::standard().for_path(path.as_ref()),
        text,
        changes: None,
    });
    read.compiled(1, text.into())
}

fn model(text: &str) -> Model {
    let mut model = Model::default();
    model.take(compiled(text));
    model
}

#[test]
fn a_param_keeps_its_value_by_name_through_compiles_within_its_interval() {
    let mut model = model("param a : [0, 4]; point p = (a, 0, 0);");
    model.change(Step::new("Move a", "a"), |choices| {
        choices.choose("a", 0, Some(3.0));
    });
    let value = |model: &mut Model| {
        let param_values = model.param_values().expect("a scene");
        let scene = model.scene.clone().expect("a scene");
        param_values
            .param(&scene.params[scene.params.len() - 1])
            .to_vec()
    };
    assert_eq!(value(&mut model), [3.0]);
    model.take(compiled(
        "param b : [7, 9]; param a : [0, 2]; point p = (a, b, 0);",
    ));
    assert_eq!(value(&mut model), [2.0]);
    model.take(compiled("param a : [0, 4]; point p = (a, 0, 0);"));
    assert_eq!(value(&mut model), [3.0]);
}

#[test]
fn a_value_that_the_text_gives_anew_takes_the_place_of_the_sliders() {
    let mut model = model("param a = 1 : [0, 4]; point p = (a, 0, 0);");
    model.adjust(|choices| {
        choices.choose("a", 0, Some(3.0));
    });
    model.take(compiled("param a = 1 : [0, 4]; point p = (a, 1, 0);"));
    assert_eq!(model.choices.params["a"], [Some(3.0)]);
    model.take(compiled("param a = 2 : [0, 4]; point p = (a, 1, 0);"));
    let param_values = model.param_values().expect("a scene");
    assert_eq!(param_values.uniforms(), [2.0]);
}

#[test]
fn what_is_hidden_is_known_by_its_place_in_the_scene_also_where_a_geodesic_lies_on_it() {
    let mut model = model(
        "point p = (1,1,1); surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];
         geodesic g(t) : s = (1,0) @ (0.5,0.5), t : [0, 0.2];",
    );
    let hide = |model: &mut Model, name: &str| {
        model.adjust(|choices| choices.looks.entry(name.into()).or_default().hidden = true);
        model
            .hidden()
            .iter()
            .map(|id| id.index())
            .collect::<Vec<_>>()
    };
    assert_eq!(hide(&mut model, "s"), [1]);
    assert_eq!(hide(&mut model, "p"), [0, 1]);
    assert_eq!(hide(&mut model, "another"), [0, 1]);
    assert_eq!(hide(&mut model, "g"), [0, 1, 2]);
}

#[test]
fn steps_of_one_gesture_are_undone_together_and_done_again() {
    let mut model = model("param a : [0, 4]; point p = (a, 0, 0);");
    let set = |model: &mut Model, value: f64| {
        model.change(Step::new("Move a", "a"), |choices| {
            choices.choose("a", 0, Some(value));
        });
    };
    set(&mut model, 1.0);
    set(&mut model, 2.0);
    model.history.settle();
    set(&mut model, 3.0);
    assert_eq!(model.undo(), Some("Move a"));
    assert_eq!(model.choices.params["a"], [Some(2.0)]);
    assert_eq!(model.undo(), Some("Move a"));
    assert!(model.choices.params.is_empty());
    assert_eq!(model.undo(), None);
    model.redo();
    model.redo();
    assert_eq!(model.choices.params["a"], [Some(3.0)]);
    assert_eq!(model.redo(), None);
}

const SURFACE: &str = "param a : [0, 4]; surface s(u,v) = (u, v, a), u : [0,1], v : [0,1];
    surface t(u,v) = (u, v, 0), u : [0,1], v : [0,1];";

fn inside(at: [f64; 2]) -> InsideCamera {
    InsideCamera::Chart(chart(at))
}

fn chart(at: [f64; 2]) -> ChartCamera {
    ChartCamera {
        at,
        x: [1.0, 0.0],
        y: [0.0, 1.0],
        pole: None,
        zoom: 1.0,
        moved: true,
    }
}

fn set(model: &mut Model, name: &str, value: f64) {
    model.change(Step::new("Move a param", name), |choices| {
        choices.choose(name, 0, Some(value));
    });
    model.history.settle();
}

#[test]
fn a_step_takes_back_what_it_has_changed_and_nothing_else() {
    let mut model = model(SURFACE);
    model.change(Step::new("Move the 3D camera", "keys"), |choices| {
        choices.space = Some(camera().moved([1.0, 0.0, 0.0]));
    });
    // No step: a pane is closed, a param moves by itself, a geodesic camera walks.
    model.adjust(|choices| {
        choices.closed.insert("s".into());
        choices.choose("a", 0, Some(3.0));
        choices.inside.insert("s".into(), inside([0.5, 0.5]));
    });
    let others = model.choices.clone();
    assert_eq!(model.undo(), Some("Move the 3D camera"));
    assert_eq!(
        model.choices,
        Choices {
            space: None,
            ..others.clone()
        }
    );
    assert_eq!(model.redo(), Some("Move the 3D camera"));
    assert_eq!(model.choices, others);
}

#[test]
fn what_the_text_gives_anew_no_step_brings_back() {
    let mut model = model("param a = 1 : [0, 4]; param b : [0, 9]; point p = (a, b, 0);");
    set(&mut model, "a", 2.0);
    set(&mut model, "a", 3.0);
    set(&mut model, "b", 5.0);
    assert_eq!(model.undo(), Some("Move a param"));
    model.take(compiled(
        "param a = 3 : [0, 4]; param b : [0, 9]; point p = (a, b, 0);",
    ));
    assert!(
        model.choices.params.is_empty(),
        "{:?}",
        model.choices.params
    );
    assert_eq!(model.history.last(), None, "there is nothing to undo of a");
    assert_eq!(model.undo(), None);
    assert_eq!(model.redo(), Some("Move a param"));
    assert_eq!(model.choices.params["b"], [Some(5.0)]);
    assert!(!model.choices.params.contains_key("a"));
}

#[test]
fn a_step_that_changes_nothing_any_more_is_passed_by() {
    let mut model = model(SURFACE);
    set(&mut model, "a", 2.0);
    model.change(Step::new("Show or hide", "s"), |choices| {
        choices.looks.entry("s".into()).or_default().hidden = true;
    });
    model.adjust(|choices| {
        choices.looks.remove("s");
    });
    assert_eq!(model.undo(), Some("Move a param"));
}

#[test]
fn a_value_is_known_with_what_the_text_said_when_it_was_chosen() {
    let mut before =
        model("param a = 1 : [0, 4]; param b : [0, 2], [0, 2]; point p = (a, b_1, b_2);");
    set(&mut before, "a", 3.0);
    before.change(Step::new("Move a param", "b_2"), |choices| {
        choices.choose("b", 1, Some(1.5));
    });
    let text = serde_json::to_string(&before.choices).expect("data");
    // Meanwhile the file was edited: another value of a, another interval of b.
    let again = |file: &str| {
        let mut after = Model::default();
        after.turn_to(serde_json::from_str::<Choices>(&text).expect("data").sane());
        assert_eq!(after.choices, before.choices);
        after.take(compiled(file));
        after.param_values().expect("a scene").uniforms().to_vec()
    };
    assert_eq!(
        again("param a = 1 : [0, 4]; param b : [0, 2], [0, 2]; point p = (a, b_1, b_2);"),
        [3.0, 0.0, 1.5]
    );
    assert_eq!(
        again("param a = 2 : [0, 4]; param b : [1, 2], [1, 2]; point p = (a, b_1, b_2);"),
        [2.0, 1.0, 1.5]
    );
    assert_eq!(
        again("param a = 2 : [1, 5]; param b = (1, 1) : [0, 2], [0, 2]; point p = (a, b_1, b_2);"),
        [2.0, 1.0, 1.0]
    );
}

/// Walks on a surface, and returns the length of the camera's path.
fn walk(model: &mut Model, surface: &str) -> f64 {
    model.move_camera(surface, Motion::Walk([0.1, 0.0]));
    model.paths[surface].trail.length
}

#[test]
fn a_path_ends_where_its_camera_is_put_elsewhere_and_nowhere_else() {
    let mut model = model(SURFACE);
    model.adjust(|choices| choices.preferences.marks.trail = true);
    let lengths = ["s", "t"].map(|name| walk(&mut model, name));
    assert!(lengths.iter().all(|length| *length > 0.0));
    let paths = |model: &Model| ["s", "t"].map(|name| model.paths.contains_key(name));
    set(&mut model, "a", 2.0);
    model.undo();
    model.redo();
    assert_eq!(paths(&model), [true, true], "a param is no camera");
    model.place("s", inside([0.5, 0.5]));
    assert_eq!(paths(&model), [false, true]);
    walk(&mut model, "s");
    assert_eq!(model.undo(), Some("Move the geodesic camera"));
    assert_eq!(model.choices.inside["s"].place(), [0.5, 0.5]);
    assert_eq!(paths(&model), [false, true], "the walk is taken back");
    model.reset("t");
    assert_eq!(paths(&model), [false, false]);
    assert!(!model.choices.inside.contains_key("t"));
    walk(&mut model, "t");
    model.clear_trails();
    assert_eq!(paths(&model), [false, false]);
}

#[test]
fn a_motion_that_cannot_be_made_is_no_step() {
    let mut model = model(SURFACE);
    let at_edge = inside([1.0, 0.5]);
    model.adjust(|choices| {
        choices.inside.insert("s".into(), at_edge);
    });
    model.move_camera("s", Motion::Walk([0.5, 0.0]));
    assert_eq!(model.choices.inside["s"], at_edge);
    assert_eq!(model.undo(), None);
}

#[test]
fn a_path_is_on_its_surface_also_where_that_has_another_number_than_when_it_was_walked() {
    let mut model = model(SURFACE);
    model.adjust(|choices| choices.preferences.marks.trail = true);
    walk(&mut model, "s");
    let before = Arc::clone(&model.paths["s"].trail);
    model.take(compiled(SURFACE));
    assert!(
        Arc::ptr_eq(&model.paths["s"].trail, &before),
        "one that has the right number is not copied"
    );
    model.take(compiled(&format!("point p = (0,0,1); {SURFACE}")));
    let path = &model.paths["s"];
    assert_eq!(path.trail.surface, ObjectId::new(1));
    assert_eq!(path.trail.points, before.points);
}

#[test]
fn a_placing_that_is_withdrawn_leaves_no_trace() {
    let mut model = model(SURFACE);
    model.adjust(|choices| {
        choices.inside.insert("s".into(), inside([0.25, 0.25]));
    });
    set(&mut model, "a", 2.0);
    model.undo();
    let before = model.choices.clone();
    model.place("s", inside([0.5, 0.5]));
    assert_eq!(
        model.choices.inside["s"].place(),
        [0.5, 0.5],
        "it is there at once"
    );
    model.withdraw_placement();
    assert_eq!(model.choices, before);
    assert_eq!(model.history.last(), None);
    assert_eq!(model.redo(), Some("Move a param"));
    // One that is kept is a step of its own.
    model.place("s", inside([0.5, 0.5]));
    model.keep_placement();
    model.withdraw_placement();
    assert_eq!(model.choices.inside["s"].place(), [0.5, 0.5]);
    assert_eq!(model.undo(), Some("Place the geodesic camera"));
    assert_eq!(model.choices.inside["s"].place(), [0.25, 0.25]);
}

#[test]
fn another_program_has_its_own_view_and_no_steps_of_the_one_before() {
    let mut model = model(SURFACE);
    model.adjust(|choices| {
        choices.inside.insert("s".into(), inside([0.25, 0.25]));
    });
    set(&mut model, "a", 2.0);
    model.place("s", inside([0.5, 0.5]));
    let mut other = Choices::default();
    other.inside.insert("s".into(), inside([0.75, 0.75]));
    model.turn_to(other.clone());
    assert_eq!(model.undo(), None);
    assert_eq!(model.choices, other);
}

#[test]
fn a_camera_that_nobody_had_moved_is_put_anew_where_its_scene_is_another_one() {
    let mut model = model(SURFACE);
    let unmoved = InsideCamera::Chart(ChartCamera {
        moved: false,
        ..chart([0.25, 0.25])
    });
    model.adjust(|choices| {
        choices.inside.insert("s".into(), unmoved);
        choices.space = Some(camera());
    });
    model.place("s", inside([0.5, 0.5]));
    let moved = SpaceCamera {
        moved: true,
        ..camera().moved([1.0, 0.0, 0.0])
    };
    model.change(Step::new("Move the 3D camera", "keys"), |choices| {
        choices.space = Some(moved);
    });
    model.take(compiled(
        "surface s(u,v) = (u, v, 7), u : [5,6], v : [5,6];",
    ));
    model.reframe();
    assert_eq!(model.choices.space, Some(moved), "what was moved stays");
    assert_eq!(model.undo(), Some("Move the 3D camera"));
    assert_eq!(model.choices.space, None);
    assert_eq!(model.undo(), Some("Place the geodesic camera"));
    assert!(!model.choices.inside.contains_key("s"));
}

#[test]
fn what_is_animated_grows_by_its_speed_and_begins_anew_at_its_least() {
    assert_eq!(advanced(0.25, 0.5, 0.0, 1.0), 0.75);
    assert_eq!(advanced(0.75, 0.5, 0.0, 1.0), 0.25);
    assert_eq!(advanced(2.0, 10.0, 2.0, 5.0), 3.0);
    assert_eq!(advanced(-0.5, -1.0, -1.0, 1.0), 0.5);
    let mut model = model("param a : [0, 1], [0, 8]; point p = (a_1, a_2, 0);");
    assert!(!model.animate(1.0));
    model.adjust(|choices| {
        let on = Animation {
            on: vec![false, true],
            speed: 1.0,
        };
        choices.animations.insert("a".into(), on);
    });
    assert!(model.is_animated() && model.animate(0.5));
    assert_eq!(model.choices.params["a"], [None, Some(0.5)]);
}

#[test]
fn the_status_counts_and_the_faults_name_line_column_and_sentence() {
    let model = model("point p = (1,2,3);\npoint q = (1,2);");
    assert_eq!(model.status(), "1 error");
    let error = model.faults.errors().next().expect("one");
    assert_eq!((error.line, error.column), (2, 11));
    assert!(!error.message.is_empty());
    assert!(Model::default().status().contains("reading"));
}

fn camera() -> SpaceCamera {
    SpaceCamera {
        eye: [3.0, -4.0, 2.0],
        target: [0.0, 0.0, 0.0],
        radius: 2.0,
        moved: false,
        tangent: 0.3,
        roll: 0.0,
    }
}

#[test]
fn a_declared_camera_that_is_followed_is_not_forgotten() {
    let mut model =
        model("camera eye = (0, 1, 0) @ (0, -3, 0); camera other = (1, 0, 0) @ (0, 0, 0);");
    model.take_first_camera(camera());
    model.reset_space();
    assert_eq!(model.choices.space, Some(camera()));
    model.look_through("eye");
    assert_eq!(model.choices.space, Some(camera()));
    model.look_through("other");
    assert_eq!(model.choices.space, None);
}

#[test]
fn a_rolled_camera_moves_and_shows_its_axes_as_the_picture_is_turned() {
    let level = camera();
    let rolled = SpaceCamera {
        roll: std::f64::consts::FRAC_PI_2,
        ..level
    };
    let [right, up, back] = level.axes();
    let turned = rolled.axes();
    for (found, expected) in turned.into_iter().zip([up, -right, back]) {
        assert!(found.distance(expected) < 1e-12, "{found}");
    }
    // To the right in the rolled picture is up in the level one.
    let by = |camera: SpaceCamera, x: f64, y: f64| {
        let moved = camera.panned(DVec2::new(x, y));
        DVec3::from(moved.target) - DVec3::from(camera.target)
    };
    assert!(by(rolled, 0.2, 0.0).distance(by(level, 0.0, 0.2)) < 1e-12);
    assert!(by(rolled, 0.0, 0.2).distance(by(level, -0.2, 0.0)) < 1e-12);
}

#[test]
fn the_space_camera_keeps_its_distance_while_it_turns_orbits_and_moves() {
    let distance = |camera: SpaceCamera| {
        let square = |k: usize| (camera.eye[k] - camera.target[k]).powi(2);
        (square(0) + square(1) + square(2)).sqrt()
    };
    let old = distance(camera());
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} and {b}");
    let turned = camera().turned(0.3, -0.2);
    close(distance(turned), old);
    assert_eq!(turned.eye, camera().eye);
    let orbited = camera().orbited(0.3, 5.0);
    close(distance(orbited), old);
    assert_eq!(orbited.target, camera().target);
    let up = camera().moved([0.0, 0.0, 1.0]);
    close(up.eye[2], 4.0);
    close(up.target[2], 2.0);
    close(distance(camera().neared(0.5, DVec2::ZERO)), 0.5 * old);
    close(
        distance(camera().neared(0.5, DVec2::new(0.2, 0.1))),
        0.5 * old,
    );
    // Forwards and back, right and left.
    let there_and_back = camera().moved([1.0, 1.0, 0.0]).moved([-1.0, -1.0, 0.0]);
    for k in 0..3 {
        close(there_and_back.eye[k], camera().eye[k]);
    }
}

/// The marks of geodesic views, and that of the 3D view, after texts one behind the other.
fn marks(texts: &[&str], surfaces: [&str; 2]) -> (bool, [bool; 2]) {
    let (mut reader, mut model) = (Reader::default(), Model::default());
    for text in texts {
        model.take(read(&mut reader, text));
    }
    model.faults.show_latest();
    let inside = surfaces.map(|name| model.is_stale_on(name));
    (model.is_stale_in(&SpaceView), inside)
}

#[test]
fn only_views_that_show_what_is_stood_in_for_are_marked() {
    let good = "param a = 1 : [0, 4]; function f(x) = a x;
        surface s(u,v) = (u, v, f(u)), u : [0,1], v : [0,1];
        surface t(u,v) = (u, v, 2), u : [0,1], v : [0,1];
        metric m(u,v) = (1, 0, 1 + u^2), u : [0,1], v : [0,1];
        geodesic g(l) : t = (1, 0) @ (0.5, 0.5), l : [0, 0.2];
        curve c(x) = (x, 1, 1), x : [0, 1];";
    let st = |broken: &str| marks(&[good, broken], ["s", "t"]);
    let mt = |broken: &str| marks(&[good, broken], ["m", "t"]);
    assert_eq!(st(good), (false, [false, false]));
    let curve = good.replace("(x, 1, 1)", "(x, 1, ");
    assert_eq!(st(&curve), (true, [false, false]), "a curve is in space");
    let function = good.replace("= a x", "= a +");
    assert_eq!(st(&function), (true, [true, false]), "s reads f");
    let param = good.replace("a = 1 :", "a = :");
    assert_eq!(st(&param), (true, [true, false]), "f reads a");
    let geodesic = good.replace("(0.5, 0.5)", "(0.5");
    assert_eq!(st(&geodesic), (true, [false, true]), "g lies on t");
    let metric = good.replace("1 + u^2", "1 + ");
    assert_eq!(mt(&metric), (false, [true, false]), "m is nowhere in space");
    // A declaration that is not complete yet changes nothing of what is shown.
    let new = format!("{good} point p = (1, ");
    assert_eq!(st(&new), (false, [false, false]));
    // What is mended is not marked, nor what was never there.
    assert_eq!(
        marks(&[good, &new, good], ["s", "t"]),
        (false, [false, false])
    );
    assert!(!st("point p = (1, 2, 3);").0);
}

#[test]
fn what_is_hidden_marks_no_view() {
    let (mut reader, mut model) = (Reader::default(), Model::default());
    let good = "point p = (1, 2, 3); point q = (1, 1, 1);";
    model.take(read(&mut reader, good));
    model.adjust(|choices| choices.looks.entry("p".into()).or_default().hidden = true);
    model.take(read(&mut reader, &good.replace("2, 3)", "2, ")));
    model.faults.show_latest();
    assert!(model.is_stale() && !model.is_stale_in(&SpaceView));
}

#[test]
fn a_declaration_is_all_from_its_word_to_its_end() {
    let text = "# of a sphere; and more
surface
  s(u,v) = (u, # one; two
    v, 0), u : [0,1], v : [0,1];point p = (1, 2, 3);
param a : [0, 1];";
    let mut model = model(text);
    let at = |model: &Model, what: &str| {
        let offset = text.find(what).expect("there") as u32;
        model.declared_at(offset).map(str::to_owned)
    };
    assert_eq!(at(&model, "# of"), None, "a comment above it is none of it");
    assert_eq!(at(&model, "surface").as_deref(), Some("s"));
    assert_eq!(at(&model, "# one").as_deref(), Some("s"));
    assert_eq!(at(&model, "v, 0)").as_deref(), Some("s"));
    assert_eq!(at(&model, "point").as_deref(), Some("p"));
    assert_eq!(at(&model, "3);").as_deref(), Some("p"));
    assert_eq!(at(&model, "param"), None, "a param is no object");
    let place = |model: &Model, name: &str| model.place_of(name).map(|it| it.start as usize);
    assert_eq!(place(&model, "s"), text.find("s(u,v)"));
    assert_eq!(place(&model, "a"), text.find("a : ["));
    // Of a text of which nothing can be shown, the places are its own all the same.
    let moved = format!("\n\n{text}");
    let compiled = Compiled {
        scene: None,
        ..compiled(&moved)
    };
    model.take(compiled);
    assert_eq!(place(&model, "s"), moved.find("s(u,v)"));
    assert_eq!(place(&model, "gone"), None);
}

#[test]
fn a_view_from_a_file_is_brought_to_its_senses() {
    let text = r#"{"space":{"eye":[0,0,0],"target":[0,0,0],"radius":1},"unknown":7,
        "preferences":{"cameraSpeed":1e9,"scale":0},"inside":{"s":{"at":[0,0],"x":[1,0],"y":[0,1],"zoom":-1}}}"#;
    let choices: Choices = serde_json::from_str::<Choices>(text)
        .expect("tolerant")
        .sane();
    assert_eq!(choices.space, None);
    assert!(choices.inside.is_empty());
    assert_eq!(choices.preferences.camera_speed, 100.0);
    assert_eq!(choices.preferences.scale, 0.5);
}

#[test]
fn a_trail_comes_back_with_its_camera() {
    let mut model = model(SURFACE);
    model.adjust(|choices| choices.preferences.marks.trail = true);
    let first = walk(&mut model, "s");
    model.history.settle();
    let walked = walk(&mut model, "s");
    assert!(walked > first && first > 0.0);
    let length = |model: &Model| model.paths.get("s").map(|path| path.trail.length);
    let at = model.choices.inside["s"];
    model.place("s", inside([0.5, 0.5]));
    assert_eq!(length(&model), None);
    assert_eq!(model.undo(), Some("Place the geodesic camera"));
    assert_eq!(
        (length(&model), model.choices.inside["s"]),
        (Some(walked), at)
    );
    assert_eq!(model.redo(), Some("Place the geodesic camera"));
    assert_eq!(length(&model), None);
    model.undo();
    model.reset("s");
    assert_eq!(model.undo(), Some("Reset the geodesic camera"));
    assert_eq!(length(&model), Some(walked));
    model.clear_trails();
    assert_eq!(length(&model), None);
    assert_eq!(model.undo(), Some("Clear the trail"));
    assert_eq!(length(&model), Some(walked));
    assert_eq!(model.undo(), Some("Move the geodesic camera"));
    assert_eq!(length(&model), Some(first));
    assert_eq!(model.redo(), Some("Move the geodesic camera"));
    assert_eq!(length(&model), Some(walked));
    // On another surface, or of another text, it would be another path.
    model.place("s", inside([0.5, 0.5]));
    model.keep_placement();
    model.adjust(|choices| choices.choose("a", 0, Some(2.0)));
    model.undo();
    assert_eq!(length(&model), None);
    model.adjust(|choices| choices.choose("a", 0, None));
    let walked = walk(&mut model, "s");
    model.place("s", inside([0.5, 0.5]));
    model.keep_placement();
    model.take(compiled(SURFACE));
    model.undo();
    assert_eq!(length(&model), None, "not {walked}");
}

#[test]
fn a_mirrored_geodesic_camera_has_its_up_where_its_down_was() {
    let mut model = model(SURFACE);
    model.settle_camera("s", true);
    let before = model.choices.inside["s"];
    model.mirror("s");
    let after = model.choices.inside["s"];
    let [Some(before), Some(after)] = [before.chart(), after.chart()] else {
        panic!("cameras on a surface");
    };
    assert_eq!((after.at, after.x), (before.at, before.x));
    assert_eq!(after.y, before.y.map(|part| -part));
    let (before, after) = (*before, *after);
    assert_ne!(before, after);
    model.undo();
    assert_eq!(model.choices.inside["s"].chart(), Some(&before));
}

#[test]
fn a_new_camera_has_a_name_that_is_free() {
    assert_eq!(model("point p = (1, 0, 0);").free_camera_name(), "eye");
    let taken = model(
        "param eye : [0, 1]; param lens : [0, 1]; param observer : [0, 1]; param eye2 : [0, 1];",
    );
    assert_eq!(taken.free_camera_name(), "eye3");
}

#[test]
fn a_script_is_not_run_again_where_t_moves() {
    let script = read_as(
        "a.crt",
        &mut Reader::default(),
        "Scene { Sphere { center -> vec3(t, 0, 0) radius -> 1 } }",
    );
    let mut scene = Scene::clone(&script.scene.clone().expect("a scene"));
    let runs = Arc::new(AtomicU32::new(0));
    let (counter, made) = (runs.clone(), scene.clone());
    scene.rerun = Some(Rerun::new(vec![0.0], move |_| {
        counter.fetch_add(1, Ordering::Relaxed);
        made.clone()
    }));
    let mut model = Model::default();
    model.take(Compiled {
        scene: Some(Arc::new(scene)),
        ..script
    });
    for value in [1.0, 2.0, 3.0] {
        set(&mut model, "t", value);
        let shown = model.param_values().expect("a scene");
        assert_eq!(shown.uniforms(), [0.0], "those of the scene");
        assert_eq!(model.chosen_values().expect("a scene").uniforms(), [value]);
        assert!(model.awaits_rerun());
    }
    assert_eq!(runs.load(Ordering::Relaxed), 0);
    model.rerun();
    let shown = model.param_values().expect("a scene");
    assert_eq!(shown.uniforms(), [3.0]);
    assert!(!model.awaits_rerun());
    assert_eq!(runs.load(Ordering::Relaxed), 1);
}

#[test]
fn the_scene_of_a_script_is_that_of_its_params() {
    let text = "Scene {
        if (t > 5) { Box { cornerA -> vec3(-4, -1, 7) cornerB -> vec3(-2, 1, 9) } }
        Sphere { center -> vec3(2, 0, 8) radius -> 1 }
    }";
    let mut model = Model::default();
    model.take(read_as("a.crt", &mut Reader::default(), text));
    let hide = |choices: &mut Choices| choices.looks.entry("3:9".into()).or_default().hidden = true;
    model.adjust(hide);
    let names = |model: &Model| -> Vec<String> {
        let scene = model.scene.as_ref().expect("a scene");
        scene
            .objects
            .iter()
            .map(|object| object.name.clone())
            .collect()
    };
    let hidden = |model: &Model| {
        model
            .hidden()
            .into_iter()
            .map(|id| id.index())
            .collect::<Vec<_>>()
    };
    assert_eq!(
        (names(&model), hidden(&model)),
        (vec!["3:9".to_owned()], vec![0])
    );
    set(&mut model, "t", 7.0);
    model.rerun();
    assert_eq!(
        (names(&model), hidden(&model)),
        (vec!["2:22".to_owned(), "3:9".to_owned()], vec![1])
    );
    model.undo();
    model.rerun();
    assert_eq!(
        (names(&model), hidden(&model)),
        (vec!["3:9".to_owned()], vec![0])
    );
}

#[test]
fn the_findings_of_a_script_are_those_of_its_params() {
    let text = "Scene { Sphere { center -> vec3(2, 0, 8) radius -> 2 - t } }";
    let mut reader = Reader::default();
    let mut model = Model::default();
    model.take(read_as("a.crt", &mut reader, text));
    let errors = |model: &Model| -> Vec<String> {
        let errors = model.faults.errors();
        errors.map(|it| it.message.clone()).collect()
    };
    assert!(errors(&model).is_empty());
    set(&mut model, "t", 2.0);
    model.rerun();
    let message = "`radius` must be > 0, but this is 0 (at t = 2)";
    assert_eq!(errors(&model), [message]);
    // The scene of a text that cannot be read is that of the one before.
    model.take(read_as("a.crt", &mut reader, "Scene {"));
    model.faults.show_latest();
    let of_reading = errors(&model);
    set(&mut model, "t", 3.0);
    model.rerun();
    assert_eq!(errors(&model), of_reading);
}
