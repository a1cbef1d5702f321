//! The trail that a geodesic camera leaves: only where it is asked for, as long as the walk, and gone where it is no
//! longer true.

use egui::{Key, Modifiers};

use crate::hand::{Hand, SPHERE};

/// Switches the trail on, and gives the keys to the geodesic view.
fn with_trail() -> Hand {
    with_trail_on(SPHERE)
}

/// The same, in another program that has a surface s whose geodesic view is in front.
fn with_trail_on(text: &str) -> Hand {
    let mut hand = Hand::on(text);
    hand.leave_trail("s");
    hand
}

/// The length of the trail on the sphere.
fn length(hand: &Hand) -> f64 {
    hand.window().model().paths["s"].trail.length
}

#[test]
fn no_trail_is_kept_until_it_is_asked_for() {
    let mut hand = Hand::on(SPHERE);
    let at = hand.inside("s").center();
    hand.click_at(at);
    hand.hold(Key::W, 6);
    assert!(hand.window().model().paths.is_empty());
    assert!(!hand.shows("trail of length"));
}

#[test]
fn a_trail_is_as_long_as_the_arc_that_was_walked() {
    let mut hand = with_trail();
    let place = |hand: &Hand| {
        let [u, v] = hand.camera("s").at;
        [v.cos() * u.cos(), v.cos() * u.sin(), v.sin()]
    };
    let from = place(&hand);
    hand.hold(Key::W, 8);
    let to = place(&hand);
    // A great circle of the unit sphere: its length is the angle between its ends.
    let cos: f64 = (0..3).map(|k| from[k] * to[k]).sum();
    let walked = length(&hand);
    assert!(walked > 0.01, "{walked}");
    assert!(
        (walked - cos.acos()).abs() < 1e-6,
        "{walked} is not {}",
        cos.acos()
    );
    assert!(hand.shows(&format!("trail of length {walked:.4}")));
    // Turning and zooming is no way; going back is.
    hand.hold(Key::Q, 4);
    hand.hold(Key::Z, 4);
    assert_eq!(length(&hand), walked);
    hand.hold(Key::S, 4);
    assert!(length(&hand) > walked);
}

#[test]
fn a_trail_is_cleared_reset_and_switched_off() {
    let mut hand = with_trail();
    hand.hold(Key::W, 5);
    assert!(length(&hand) > 0.0);
    let camera = hand.camera("s");
    hand.click("Overlays");
    hand.click("Clear the trail");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert_eq!(length(&hand), 0.0);
    assert_eq!(hand.camera("s"), camera, "the camera stays where it is");
    hand.hold(Key::W, 5);
    assert!(length(&hand) > 0.0);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    assert_eq!(length(&hand), 0.0);
    hand.hold(Key::W, 5);
    hand.click("Overlays");
    hand.click("Trail of the walk");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(hand.window().model().paths.is_empty());
    assert!(!hand.shows("trail of length"));
}

#[test]
fn a_trail_stays_through_edits_elsewhere_and_goes_with_its_surface() {
    let mut hand = with_trail();
    hand.hold(Key::W, 5);
    let walked = length(&hand);
    hand.window_mut()
        .set_text(format!("point q = (1, 1, 1);\n{SPHERE}"));
    hand.until("it is compiled", |hand| {
        hand.window().model().object("q").is_some()
    });
    hand.settle();
    assert_eq!(length(&hand), walked);
    hand.hold(Key::W, 5);
    let longer = length(&hand);
    assert!(longer > walked);
    // A larger sphere: the same (u, v) are another path there.
    hand.slide("r", 50.0);
    assert_eq!(length(&hand), 0.0);
}

#[test]
fn a_trail_stays_through_what_is_undone_placed_and_reset_elsewhere() {
    let text = "param h : [1, 3];
surface t(u,v) = (u, v, h), u : [-1, 1], v : [-1, 1];
surface s(u,v) = (cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];
";
    let mut hand = Hand::on(text);
    hand.click("Geodesic view – s");
    hand.settle();
    hand.leave_trail("s");
    hand.hold(Key::W, 6);
    let walked = length(&hand);
    assert!(walked > 0.0);
    hand.slide("h", 50.0);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert!(hand.shows("Undone: Move a param"), "{:?}", hand.names());
    assert_eq!(length(&hand), walked, "undone");
    hand.press(Modifiers::COMMAND, Key::Y);
    hand.settle();
    assert_eq!(length(&hand), walked, "done again");
    hand.click("Geodesic view – t");
    hand.settle();
    let at = hand.inside("t").center();
    hand.click_at(at);
    hand.hold(Key::D, 6);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    assert_eq!(length(&hand), walked, "another camera is reset");
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert!(hand.camera("t").moved, "the reset is undone");
    assert_eq!(length(&hand), walked, "another camera is brought back");
    // Its own camera elsewhere: the trail is no way to there.
    hand.click("Geodesic view – s");
    hand.settle();
    let at = hand.inside("s").center();
    hand.click_at(at);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    assert_eq!(length(&hand), 0.0);
}
