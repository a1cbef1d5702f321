use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Animation, Model, SpaceCamera, Step, View, advanced};
use crate::compiler::{Compiled, findings};

fn compiled(text: &str) -> Compiled {
    let compilation = scene::compile(text);
    Compiled {
        version: 1,
        ok: !compilation.has_errors(),
        findings: findings(text, &compilation.diagnostics),
        scene: compilation.scene.map(Arc::new),
        stale: Vec::new(),
        text: text.into(),
        arrived: Instant::now(),
        took: Duration::ZERO,
    }
}

fn model(text: &str) -> Model {
    let mut model = Model::default();
    model.take(compiled(text));
    model
}

#[test]
fn a_param_keeps_its_value_by_name_through_compiles_within_its_interval() {
    let mut model = model("param a : [0, 4]; point p = (a, 0, 0);");
    model.change(Step::new("Move a", "a"), |view| {
        view.params.insert("a".into(), vec![3.0]);
    });
    let value = |model: &mut Model| {
        let settings = model.settings().expect("a scene");
        let scene = model.scene.clone().expect("a scene");
        settings
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
    model.adjust(|view| {
        view.params.insert("a".into(), vec![3.0]);
    });
    model.take(compiled("param a = 1 : [0, 4]; point p = (a, 1, 0);"));
    assert_eq!(model.view.params["a"], [3.0]);
    model.take(compiled("param a = 2 : [0, 4]; point p = (a, 1, 0);"));
    let settings = model.settings().expect("a scene");
    assert_eq!(settings.uniforms(), [2.0]);
}

#[test]
fn what_is_hidden_is_known_by_its_place_in_the_scene_also_where_a_geodesic_lies_on_it() {
    let mut model = model(
        "point p = (1,1,1); surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];
         geodesic g(t) : s = (1,0) @ (0.5,0.5), t : [0, 0.2];",
    );
    let hide = |model: &mut Model, name: &str| {
        model.adjust(|view| view.looks.entry(name.into()).or_default().hidden = true);
        model.hidden().iter().map(|id| id.0).collect::<Vec<_>>()
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
        model.change(Step::new("Move a", "a"), |view| {
            view.params.insert("a".into(), vec![value]);
        });
    };
    set(&mut model, 1.0);
    set(&mut model, 2.0);
    model.history.settle();
    set(&mut model, 3.0);
    assert_eq!(model.undo(), Some("Move a"));
    assert_eq!(model.view.params["a"], [2.0]);
    assert_eq!(model.undo(), Some("Move a"));
    assert!(model.view.params.is_empty());
    assert_eq!(model.undo(), None);
    model.redo();
    model.redo();
    assert_eq!(model.view.params["a"], [3.0]);
    assert_eq!(model.redo(), None);
}

#[test]
fn what_is_animated_grows_by_its_speed_and_begins_anew_at_its_least() {
    assert_eq!(advanced(0.25, 0.5, 0.0, 1.0), 0.75);
    assert_eq!(advanced(0.75, 0.5, 0.0, 1.0), 0.25);
    assert_eq!(advanced(2.0, 10.0, 2.0, 5.0), 3.0);
    assert_eq!(advanced(-0.5, -1.0, -1.0, 1.0), 0.5);
    let mut model = model("param a : [0, 1], [0, 8]; point p = (a_1, a_2, 0);");
    assert!(!model.animate(1.0));
    model.adjust(|view| {
        let on = Animation {
            on: vec![false, true],
            speed: 1.0,
        };
        view.animations.insert("a".into(), on);
    });
    assert!(model.is_animated() && model.animate(0.5));
    assert_eq!(model.view.params["a"], [0.0, 0.5]);
}

#[test]
fn the_status_names_line_column_and_sentence() {
    let model = model("point p = (1,2,3);\npoint q = (1,2);");
    assert!(
        model.status().starts_with("Status: line 2, column 11: "),
        "{}",
        model.status()
    );
    assert!(Model::default().status().contains("reading"));
}

fn camera() -> SpaceCamera {
    SpaceCamera {
        eye: [3.0, -4.0, 2.0],
        target: [0.0, 0.0, 0.0],
        radius: 2.0,
        moved: false,
    }
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
    close(distance(camera().neared(0.5)), 0.5 * old);
    // Forwards and back, right and left.
    let there_and_back = camera().moved([1.0, 1.0, 0.0]).moved([-1.0, -1.0, 0.0]);
    for k in 0..3 {
        close(there_and_back.eye[k], camera().eye[k]);
    }
}

#[test]
fn a_view_from_a_file_is_brought_to_its_senses() {
    let text = r#"{"space":{"eye":[0,0,0],"target":[0,0,0],"radius":1},"unknown":7,
        "preferences":{"cameraSpeed":1e9,"scale":0},"inside":{"s":{"at":[0,0],"x":[1,0],"y":[0,1],"zoom":-1}}}"#;
    let view: View = serde_json::from_str::<View>(text).expect("tolerant").sane();
    assert_eq!(view.space, None);
    assert!(view.inside.is_empty());
    assert_eq!(view.preferences.camera_speed, 100.0);
    assert_eq!(view.preferences.scale, 0.5);
}
