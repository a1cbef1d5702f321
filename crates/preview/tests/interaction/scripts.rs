//! CRT scripts in the window: `t`, the settings, and the camera written back.

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::hand::Hand;

const SCRIPT: &str = "\
Settings {
    gamma -> 1.5
    camera -> Camera {
        position -> vec3(0, 1, -6)
        pointing -> vec3(0, 0, 0)
        fov -> 50
    }
    lights -> [PointLight { origin -> vec3(-3, 4, -5)  color -> rgb(1, 1, 1)  ambient -> 0.2 }]
}
Scene {
    Sphere { center -> vec3(t / 50.0, 0, 0)  radius -> 1 }
}
";

fn script() -> Hand {
    let mut hand = Hand::script(SCRIPT);
    hand.settle();
    hand
}

fn text(hand: &Hand) -> String {
    hand.window().text().expect("its own").to_owned()
}

#[test]
fn t_is_a_slider_that_runs_the_script_anew_and_compiles_nothing() {
    let mut hand = script();
    let before = hand.window().counters().clone();
    let field = hand.harness.get_by_role_and_label(Role::Slider, "t");
    field.set_value_accesskit(100.0);
    hand.settle();
    let after = hand.window().counters().clone();
    assert_eq!(after.compiled, before.compiled, "the text is as it was");
    assert_eq!(after.pipelines, before.pipelines);
    assert!(after.pictures > before.pictures);
    assert_eq!(text(&hand), SCRIPT);
    // Another text is run for the same value.
    let is_run_for_t = |hand: &Hand| {
        let scene = hand.window().model().scene.clone().expect("a scene");
        scene.made_for() == hand.window().model().chosen_values()
    };
    assert!(is_run_for_t(&hand));
    hand.window_mut().set_text(SCRIPT.replace("50.0", "60.0"));
    hand.settle();
    assert!(is_run_for_t(&hand));
}

#[test]
fn the_camera_is_written_back_as_position_and_pointing() {
    let mut hand = script();
    let at = hand.space().center();
    hand.click_at(at);
    hand.press(Modifiers::NONE, Key::Num7);
    hand.settle();
    hand.click("View");
    hand.click("Write camera");
    hand.settle();
    let written = text(&hand);
    let [position, pointing] = ["position", "pointing"].map(|word| {
        let line = written.lines().find(|line| line.contains(word));
        let line = line.expect("stated").trim();
        let numbers = line.split(['(', ')']).nth(1).expect("numbers");
        let numbers = numbers.split(", ").map(|it| it.parse().expect("a number"));
        numbers.collect::<Vec<f64>>()
    });
    // From above, in the script's coordinates: y is up.
    assert!(position[1] > 3.0 && position[1] > pointing[1], "{written}");
    assert!(position[2].abs() < 1.0, "{written}");
    assert_eq!(written.lines().count(), SCRIPT.lines().count(), "{written}");
    let eye = hand.eye().0;
    let stated = [eye[0], eye[2], eye[1]];
    for (a, b) in stated.iter().zip(&position) {
        assert!((a - b).abs() < 1e-3, "{stated:?} {position:?}");
    }
    // The window says where it stands in the script's coordinates too.
    let [x, y, z] = stated;
    assert!(hand.shows(&format!("seen from ({x:.2}, {y:.2}, {z:.2})")));
}

#[test]
fn a_number_of_the_settings_is_changed_in_the_text() {
    let mut hand = script();
    hand.click_on(Role::Button, "Params");
    let field = hand
        .harness
        .get_by_role_and_label(Role::SpinButton, "gamma");
    assert_eq!(field.value().as_deref(), Some("1.50"));
    field.set_value_accesskit(2.2);
    hand.settle();
    assert!(
        text(&hand).contains("    gamma -> 2.2\n"),
        "{}",
        text(&hand)
    );
    let field = hand
        .harness
        .get_by_role_and_label(Role::SpinButton, "recursiondepth");
    field.set_value_accesskit(5.0);
    hand.settle();
    assert!(
        text(&hand).contains("Settings {\n    recursiondepth -> 5\n"),
        "{}",
        text(&hand)
    );
    let scene = hand.window().model().scene.clone().expect("a scene");
    let picture = scene.picture.as_ref().expect("stated");
    assert_eq!((picture.gamma, picture.bounces), (2.2, 5));
}
