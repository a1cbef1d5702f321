//! What outlives a compile, a name at a time, and what outlives the window.

use egui::{Key, Modifiers, PointerButton, vec2};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;

use crate::hand::{Hand, SPHERE};

#[test]
fn what_was_chosen_stays_by_name_when_the_text_changes() {
    let mut hand = Hand::on(SPHERE);
    let slider = hand.harness.get_by_role_and_label(Role::Slider, "r").rect();
    hand.drag(
        slider.left_center() + vec2(6.0, 0.0),
        vec2(50.0, 0.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    hand.click("Show p");
    hand.hold(Key::W, 6);
    let (value, eye) = (hand.param("r"), hand.eye());
    assert!(value > 1.1);
    // Another order, another object, another interval that holds the value.
    let text = format!(
        "point q = (1, 1, 1);\nparam a : [0, 1];\n{}",
        SPHERE.replace("[1, 3]", "[0, 4]")
    );
    hand.window_mut().set_text(text);
    hand.until("it is compiled", |hand| {
        hand.window().model().object("q").is_some()
    });
    hand.settle();
    assert_eq!(hand.param("r"), value);
    assert!(hand.window().model().view.look("p").hidden);
    assert!(!hand.window().model().view.look("q").hidden);
    assert_eq!(hand.eye(), eye);
    // Gone and back.
    hand.window_mut()
        .set_text("point q = (1, 1, 1);\n".to_owned());
    hand.until("it is compiled", |hand| {
        hand.window().model().object("p").is_none()
    });
    hand.window_mut().set_text(SPHERE.to_owned());
    hand.until("it is compiled", |hand| {
        hand.window().model().object("p").is_some()
    });
    hand.settle();
    assert_eq!(hand.param("r"), value);
    assert!(hand.window().model().view.look("p").hidden);
}

#[test]
fn what_was_chosen_is_there_again_when_the_window_is_opened_again() {
    let mut hand = Hand::on(SPHERE);
    let slider = hand.harness.get_by_role_and_label(Role::Slider, "r").rect();
    hand.drag(
        slider.left_center() + vec2(6.0, 0.0),
        vec2(50.0, 0.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    hand.click("Show p");
    hand.hold(Key::D, 6);
    let middle = hand.inside("s").center();
    hand.drag(
        middle,
        vec2(30.0, 10.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    let (value, eye, camera) = (hand.param("r"), hand.eye(), hand.camera("s"));
    let mut hand = hand.again();
    assert!((hand.param("r") - value).abs() < 1e-12);
    for k in 0..3 {
        assert!(
            (hand.eye().0[k] - eye.0[k]).abs() < 1e-12,
            "{:?} is not {eye:?}",
            hand.eye()
        );
    }
    assert!(hand.window().model().view.look("p").hidden);
    let again = hand.camera("s");
    for k in 0..2 {
        assert!(
            (again.at[k] - camera.at[k]).abs() < 1e-12,
            "{again:?} is not {camera:?}"
        );
        assert!(
            (again.x[k] - camera.x[k]).abs() < 1e-9,
            "{again:?} is not {camera:?}"
        );
    }
}
