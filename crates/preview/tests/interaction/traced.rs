//! The traced view: coarse while anything moves, refined at rest, given up when something changes.

use egui::{Key, Modifiers};

use crate::hand::{Hand, SPHERE};

/// A cube without a ball, and a camera that a param moves.
const DIE: &str = "param r = 0.65 : [0.6, 0.7];
solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2;
solid ball(x,y,z) = x^2 + y^2 + z^2 - r^2, color : (0.8,0.2,0.3);
solid die = cube \\ ball;
solid ground(x,y,z) = z + 0.5, color : 0.5 + 0.2sin(9x)sin(9y);
light lamp = @ (2, -3, 4);
camera front = (0, 1, 0) @ (0, -4 - r, 0);
camera above = (0, 1, -1) @ (0, -3, 3);
";

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

#[test]
fn both_views_open_in_the_first_declared_camera_which_params_move_until_the_user_does() {
    let mut hand = refined_to(2, DIE);
    assert_eq!(hand.eye().0, [0.0, -4.65, 0.0]);
    hand.slide("r", 60.0);
    let r = hand.param("r");
    assert!((0.6..0.649).contains(&r), "{r}");
    assert_eq!(hand.eye().0, [0.0, -4.0 - r, 0.0]);
    press_in_space(&mut hand, Key::T);
    hand.until("it is refined", |hand| samples(hand) == Some(2));
    assert_eq!(hand.eye().0, [0.0, -4.0 - r, 0.0]);
    // The user's camera is left where it is.
    hand.hold(Key::D, 6);
    let moved = hand.eye();
    assert!(moved.0[0] > 0.01, "{moved:?}");
    hand.slide("r", -60.0);
    assert_eq!(hand.eye(), moved);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    let r = hand.param("r");
    assert_eq!(hand.eye().0, [0.0, -4.0 - r, 0.0]);
    hand.click("View");
    hand.click("Look through");
    hand.click("above");
    hand.settle();
    assert_eq!(hand.eye().0, [0.0, -3.0, 3.0]);
}

#[test]
fn a_click_on_a_solid_shows_the_leaf_within_its_set_in_both_views() {
    let mut hand = refined_to(1, DIE);
    for traced in [false, true] {
        if traced {
            press_in_space(&mut hand, Key::T);
            hand.settle();
        }
        hand.keep(&format!("die-{traced}"));
        // The corner of the front of the cube: 4.15 before the eye, whose lens both views have.
        let rect = hand.space();
        let tangent = std::f32::consts::FRAC_PI_8.tan();
        let off = 0.42 * 0.5 * rect.height() / (4.15 * tangent);
        hand.click_at(rect.center() + egui::vec2(off, -off));
        hand.until("its leaf is named", |hand| hand.shows("die: cube"));
        hand.click_at(rect.center() + egui::vec2(off, 0.9 * off + 30.0));
        hand.settle();
    }
}

#[test]
fn the_camera_is_written_into_its_declaration_or_as_a_new_one() {
    let mut hand = refined_to(1, DIE);
    press_in_space(&mut hand, Key::Num7);
    hand.settle();
    hand.click("View");
    hand.click("Write camera");
    hand.settle();
    let text = hand.window().text().expect("its own").to_owned();
    let line = text.lines().find(|line| line.starts_with("camera front"));
    let line = line.expect("declared");
    assert!(!line.contains("- r"), "{line}");
    assert!(text.contains("camera above = (0, 1, -1) @ (0, -3, 3);"));
    let eye = hand.eye().0;
    assert!(eye[2] > 1.0, "{eye:?}");
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    let written = hand.eye().0;
    assert!(
        (0..3).all(|k| (written[k] - eye[k]).abs() < 0.01),
        "{written:?}"
    );

    let mut hand = refined_to(1, SPHERE);
    press_in_space(&mut hand, Key::D);
    hand.settle();
    hand.click("View");
    hand.click("Write camera");
    hand.settle();
    let text = hand.window().text().expect("its own").to_owned();
    assert!(text.starts_with(SPHERE), "{text}");
    assert!(text.contains("camera eye = ("), "{text}");
    assert!(!hand.window().model().is_stale());
}

#[test]
fn the_picture_stays_when_its_camera_is_written_as_a_new_one() {
    for (size, is_portrait) in [([1200.0, 800.0], true), ([1200.0, 500.0], false)] {
        let mut hand = Hand::with(SPHERE, |builder| builder.with_size(size));
        let room = hand.space().size();
        assert_eq!(room.y > room.x, is_portrait, "{room}");
        let space = |hand: &Hand| hand.window().model().choices.space.expect("a camera");
        let before = space(&hand);
        hand.click("View");
        hand.click("Write camera");
        hand.settle();
        let text = hand.window().text().expect("its own");
        assert!(text.contains(", fov : 0."), "{text}");
        let after = space(&hand);
        assert!(
            (after.tangent - before.tangent).abs() < 1e-4,
            "{before:?} {after:?}"
        );
        assert!((0..3).all(|k| (after.eye[k] - before.eye[k]).abs() < 1e-3));
    }
}
