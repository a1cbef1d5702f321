//! Views along the axes: by the gizmo, the menu and keys; the projection.

use egui::{Key, Modifiers, Pos2, Rect};
use glam::DVec3;

use crate::hand::{Hand, SPHERE};

/// The unit vector from the target to the eye.
fn back(hand: &Hand) -> DVec3 {
    let (eye, target) = hand.eye();
    (DVec3::from(eye) - DVec3::from(target)).normalize()
}

/// Waits for a turn to end.
fn turn(hand: &mut Hand) {
    hand.harness.run_steps(30);
    hand.settle();
}

fn assert_seen_from(hand: &Hand, from: DVec3, how: &str) {
    let off = back(hand).distance(from);
    assert!(off < 1e-9, "{how}: seen from {} and not {from}", back(hand));
}

/// The place of an end of the gizmo.
fn end(hand: &Hand, name: &str) -> Pos2 {
    let rects: Vec<Rect> = hand.rects(name);
    assert_eq!(rects.len(), 1, "{name}: {rects:?}");
    rects[0].center()
}

#[test]
fn a_click_on_an_end_of_the_gizmo_looks_from_there_and_undo_goes_back() {
    let mut hand = Hand::on(SPHERE);
    let first = hand.eye();
    for (name, from) in [
        ("Look from +z", DVec3::Z),
        ("Look from +x", DVec3::X),
        ("Look from +y", DVec3::Y),
    ] {
        let (eye, target) = hand.eye();
        let distance = DVec3::from(eye).distance(DVec3::from(target));
        let at = end(&hand, name);
        hand.click_at(at);
        turn(&mut hand);
        assert_seen_from(&hand, from, name);
        let (eye, now) = hand.eye();
        assert_eq!(now, target, "{name}: the target stays");
        let after = DVec3::from(eye).distance(DVec3::from(now));
        assert!(
            (after - distance).abs() < 1e-9,
            "{name}: so does the distance"
        );
    }
    // The end that faces the eye leads to the other side.
    let at = end(&hand, "Look from +y");
    hand.click_at(at);
    turn(&mut hand);
    assert_seen_from(&hand, DVec3::NEG_Y, "the same end once more");
    for _ in 0..4 {
        hand.press(Modifiers::COMMAND, Key::Z);
    }
    hand.settle();
    assert_eq!(hand.eye(), first, "each click is one step");
}

#[test]
fn keys_look_along_the_axes() {
    let mut hand = Hand::on(SPHERE);
    for (modifiers, key, from) in [
        (Modifiers::NONE, Key::Num1, DVec3::NEG_Y),
        (Modifiers::COMMAND, Key::Num1, DVec3::Y),
        (Modifiers::NONE, Key::Num3, DVec3::X),
        (Modifiers::COMMAND, Key::Num3, DVec3::NEG_X),
        (Modifiers::NONE, Key::Num7, DVec3::Z),
        (Modifiers::COMMAND, Key::Num7, DVec3::NEG_Z),
    ] {
        hand.press(modifiers, key);
        turn(&mut hand);
        assert_seen_from(&hand, from, &format!("{modifiers:?} {key:?}"));
    }
}

#[test]
fn a_drag_takes_a_turning_camera_over() {
    let mut hand = Hand::on(SPHERE);
    hand.press(Modifiers::NONE, Key::Num7);
    hand.harness.run_steps(3);
    let middle = hand.space().center();
    hand.drag(
        middle,
        egui::vec2(40.0, 0.0),
        egui::PointerButton::Primary,
        Modifiers::NONE,
    );
    let dragged = hand.eye();
    turn(&mut hand);
    assert_eq!(hand.eye(), dragged, "the turn does not go on");
}

#[test]
fn five_changes_the_projection_and_the_picture_and_going_forward_comes_nearer() {
    let mut hand = Hand::on(SPHERE);
    let orthographic = |hand: &Hand| hand.window().model().choices.preferences.orthographic;
    assert!(!orthographic(&hand));
    let drawn = hand.window().counters().pictures;
    hand.press(Modifiers::NONE, Key::Num5);
    hand.settle();
    assert!(orthographic(&hand));
    assert!(hand.window().counters().pictures > drawn, "another picture");
    let distance = |hand: &Hand| {
        let (eye, target) = hand.eye();
        DVec3::from(eye).distance(DVec3::from(target))
    };
    let before = distance(&hand);
    hand.hold(Key::W, 10);
    assert!(
        distance(&hand) < 0.95 * before,
        "{} of {before}",
        distance(&hand)
    );
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert!(!orthographic(&hand), "undone");
}

#[test]
fn the_menu_has_the_views_and_the_projection() {
    let mut hand = Hand::on(SPHERE);
    hand.click("View");
    hand.click("Orthographic");
    hand.settle();
    assert!(hand.window().model().choices.preferences.orthographic);
    hand.click("View");
    hand.click_like("Axis views");
    hand.click_like("Top");
    turn(&mut hand);
    assert_seen_from(&hand, DVec3::Z, "Top");
}
