//! The traced view: coarse while anything moves, refined at rest, given up when something changes.

use egui::{Key, Modifiers};

use crate::hand::{Hand, SPHERE};

/// The window on a program, whose pixels are refined to so many samples when it is traced.
fn refined_to(samples: u32, text: &str) -> Hand {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("program.gtr");
    let beside = folder.path().join(".program.gtr.geotrace.json");
    std::fs::write(&path, text).expect("written");
    let view = serde_json::json!({ "preferences": { "samples": samples, "spaceSize": 24 } });
    let known = serde_json::json!({ "format": 1, "view": view });
    std::fs::write(&beside, known.to_string()).expect("written");
    Hand::opened(path, folder)
}

fn samples(hand: &Hand) -> Option<u32> {
    hand.window().counters().samples.get("3d").copied()
}

/// Gives the keys to the 3D view, and presses one there.
fn press_in_space(hand: &mut Hand, key: Key) {
    let at = hand.space().left_bottom() + egui::vec2(12.0, -40.0);
    hand.click_at(at);
    hand.press(Modifiers::NONE, key);
}

#[test]
fn t_traces_the_3d_view_refines_it_at_rest_and_goes_back() {
    let mut hand = refined_to(6, SPHERE);
    assert_eq!(samples(&hand), None);
    press_in_space(&mut hand, Key::T);
    hand.until("it is refined", |hand| samples(hand) == Some(6));
    hand.settle();
    assert!(hand.shows("traced, 6 of 6 samples"), "{:?}", hand.names());
    let counters = hand.window().counters().clone();
    assert_eq!(counters.worlds, 1);
    // A picture at rest is drawn no more.
    hand.harness.run_steps(30);
    assert_eq!(hand.window().counters().traced, counters.traced);
    assert_eq!(hand.window().counters().pictures, counters.pictures);
    hand.press(Modifiers::NONE, Key::T);
    hand.settle();
    assert_eq!(samples(&hand), None);
    assert!(!hand.shows("samples"));
}

#[test]
fn a_traced_picture_is_coarse_while_a_slider_moves_and_refined_anew() {
    let mut hand = refined_to(5, SPHERE);
    press_in_space(&mut hand, Key::T);
    hand.until("it is refined", |hand| samples(hand) == Some(5));
    hand.settle();
    let before = hand.window().counters().clone();
    hand.slide("r", 40.0);
    hand.until("it is refined anew", |hand| samples(hand) == Some(5));
    hand.settle();
    let after = hand.window().counters().clone();
    assert!(after.worlds > before.worlds, "the scene is another one");
    assert!(after.traced > before.traced);
    // The camera moves without another scene.
    hand.hold(Key::D, 6);
    hand.until("it is refined anew", |hand| samples(hand) == Some(5));
    hand.settle();
    assert_eq!(hand.window().counters().worlds, after.worlds);
    assert_eq!(hand.window().counters().pipelines, before.pipelines);
}

#[test]
fn refining_is_given_up_at_once_for_what_changes() {
    let mut hand = refined_to(4000, SPHERE);
    press_in_space(&mut hand, Key::T);
    hand.until("it is refined a little", |hand| samples(hand) > Some(4));
    assert!(hand.shows("of 4000 samples"), "{:?}", hand.names());
    hand.window_mut()
        .set_text(SPHERE.replace("[1, 3]", "[2, 3]"));
    hand.until("the new one is there", |hand| {
        let scene = hand.window().model().scene.clone();
        let range = scene.expect("a scene").params[0].ranges[0];
        range.min == 2.0 && samples(hand) < Some(400)
    });
    hand.press(Modifiers::NONE, Key::T);
    hand.settle();
    assert_eq!(samples(&hand), None);
}

#[test]
fn a_click_on_a_traced_picture_finds_what_is_there() {
    let mut hand = refined_to(2, SPHERE);
    press_in_space(&mut hand, Key::T);
    hand.settle();
    let at = hand.space().center();
    hand.click_at(at);
    hand.until("it is found", |hand| hand.shows("s at (u, v)"));
}
