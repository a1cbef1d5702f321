//! What the pointer does is done by keys too: cameras, places, panes, the menus' entries.

use egui::{Event, Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable;

use crate::hand::{Hand, SPHERE};

type Vector = [f64; 3];

fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn length(a: Vector) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The part of `step` to the right of a camera, which is level.
fn to_the_right(step: Vector, (eye, target): (Vector, Vector)) -> f64 {
    let ahead = minus(target, eye);
    let level = ahead[0].hypot(ahead[1]);
    (step[0] * ahead[1] - step[1] * ahead[0]) / level
}

/// Holds a key with modifiers for some frames.
fn hold(hand: &mut Hand, modifiers: Modifiers, key: Key) {
    hand.harness.event(Event::ModifiersChanged(modifiers));
    hand.harness.step();
    hand.hold(key, 8);
    hand.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    hand.settle();
}

#[test]
fn arrows_turn_orbit_and_pan_the_3d_camera_and_plus_and_minus_bring_it_nearer_and_farther() {
    let mut hand = Hand::on(SPHERE);
    let start = hand.eye();
    for (key, opposite, sign) in [
        (Key::ArrowRight, Key::ArrowLeft, 1.0),
        (Key::ArrowLeft, Key::ArrowRight, -1.0),
    ] {
        hold(&mut hand, Modifiers::NONE, key);
        let now = hand.eye();
        let moved = length(minus(now.0, start.0));
        assert!(moved < 1e-12, "{key:?}: it turns where it stands");
        assert!(sign * to_the_right(minus(now.1, start.1), start) > 0.01);
        hold(&mut hand, Modifiers::NONE, opposite);

        hold(&mut hand, Modifiers::ALT, key);
        let now = hand.eye();
        assert!(
            length(minus(now.1, start.1)) < 1e-9,
            "an orbit keeps its target"
        );
        let distance = |(eye, target): (Vector, Vector)| length(minus(eye, target));
        assert!((distance(now) - distance(start)).abs() < 1e-9);
        assert!(sign * to_the_right(minus(now.0, start.0), start) > 0.01);
        hold(&mut hand, Modifiers::ALT, opposite);

        hold(&mut hand, Modifiers::SHIFT, key);
        let now = hand.eye();
        let step = minus(now.0, start.0);
        assert!(
            length(minus(minus(now.1, start.1), step)) < 1e-9,
            "all of it moves"
        );
        assert!(sign * to_the_right(step, start) > 0.01);
        hold(&mut hand, Modifiers::SHIFT, opposite);
        assert!(length(minus(hand.eye().0, start.0)) < 1e-9);
    }
    for (modifiers, key, sign) in [
        (Modifiers::NONE, Key::ArrowUp, 1.0),
        (Modifiers::NONE, Key::ArrowDown, -1.0),
    ] {
        let before = hand.eye();
        hold(&mut hand, modifiers, key);
        assert!(sign * (hand.eye().1[2] - before.1[2]) > 0.01, "{key:?}");
    }
    for (key, opposite, sign) in [
        (Key::Plus, Key::Minus, -1.0),
        (Key::Equals, Key::Minus, -1.0),
        (Key::Minus, Key::Plus, 1.0),
    ] {
        let before = hand.eye();
        hold(&mut hand, Modifiers::NONE, key);
        let now = hand.eye();
        let change = length(minus(now.0, now.1)) - length(minus(before.0, before.1));
        assert!(
            sign * change > 0.01 && now.1 == before.1,
            "{key:?}: {change}"
        );
        hold(&mut hand, Modifiers::NONE, opposite);
    }
}

#[test]
fn arrows_walk_and_plus_and_minus_zoom_from_inside() {
    let mut hand = Hand::on("surface s(u,v) = (2u, 3v, 0), u : [-9, 9], v : [-9, 9];\n");
    hand.tab_to("Geodesic view of s");
    for (arrow, letter) in [
        (Key::ArrowUp, Key::W),
        (Key::ArrowDown, Key::S),
        (Key::ArrowLeft, Key::A),
        (Key::ArrowRight, Key::D),
        (Key::Plus, Key::Z),
        (Key::Minus, Key::X),
    ] {
        let step = |hand: &mut Hand, key| {
            hand.press(Modifiers::NONE, Key::R);
            hand.settle();
            hand.hold(key, 8);
            let camera = hand.camera("s");
            (camera.at, camera.zoom)
        };
        // Steps that wait for a picture are made as one: the same but for rounding.
        let (at, zoom) = step(&mut hand, letter);
        let (place, size) = step(&mut hand, arrow);
        let off = (at[0] - place[0]).hypot(at[1] - place[1]) + (zoom - size).abs();
        assert!(
            off < 1e-9,
            "{arrow:?} is not {letter:?}: {place:?} and {at:?}"
        );
    }
}

#[test]
fn keys_move_the_view_over_which_the_pointer_was_moved_last() {
    let mut hand = Hand::on(SPHERE);
    let state = |hand: &Hand| (hand.eye(), hand.camera("s").at);
    let (space, inside) = (hand.space().center(), hand.inside("s").center());
    hand.harness.hover_at(inside);
    hand.settle();
    let before = state(&hand);
    hand.hold(Key::W, 4);
    hand.settle();
    let walked = state(&hand);
    assert!(walked.0 == before.0 && walked.1 != before.1, "it walks");
    hand.harness.hover_at(space);
    hand.settle();
    hand.hold(Key::W, 4);
    hand.settle();
    let neared = state(&hand);
    assert!(
        neared.0 != walked.0 && neared.1 == walked.1,
        "it comes nearer"
    );
    // A pointer that rests chooses nothing any more: F6 does.
    hand.press(Modifiers::NONE, Key::F6);
    hand.settle();
    hand.hold(Key::W, 4);
    hand.settle();
    let last = state(&hand);
    assert!(last.0 == neared.0 && last.1 != neared.1, "it walks again");
}

#[test]
fn arrows_belong_to_the_control_that_has_the_focus() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.eye();
    hand.harness
        .get_by_role_and_label(Role::Slider, "r")
        .focus();
    hand.settle();
    hand.hold(Key::ArrowRight, 4);
    assert!(hand.param("r") > 1.0);
    assert_eq!(hand.eye(), before);
    // And to a picture that has it: they do not lead away.
    hand.tab_to("3D view of");
    hand.hold(Key::ArrowRight, 4);
    assert_ne!(hand.eye(), before);
    let focused = |hand: &Hand| hand.like("3D view of ").is_focused();
    assert!(focused(&hand));
}

#[test]
fn enter_puts_the_geodesic_camera_to_the_middle_and_with_ctrl_shows_the_declaration() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.camera("s");
    hand.tab_to("3D view of");
    hand.press(Modifiers::NONE, Key::Enter);
    hand.until("the camera is placed", |hand| {
        hand.camera("s").at != before.at
    });
    hand.settle();
    let placed = hand.camera("s");
    // As a click there does.
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    let middle = hand.space().center();
    hand.click_at(middle);
    hand.until("the camera is placed", |hand| {
        hand.camera("s").at != before.at
    });
    let clicked = hand.camera("s");
    assert!(
        (placed.at[0] - clicked.at[0]).abs() < 0.02,
        "{placed:?} {clicked:?}"
    );
    assert!(
        (placed.at[1] - clicked.at[1]).abs() < 0.02,
        "{placed:?} {clicked:?}"
    );

    for view in ["3D view of", "Geodesic view of s"] {
        hand.settle();
        hand.tab_to(view);
        hand.press(Modifiers::COMMAND, Key::Enter);
        hand.until("the text has the keys", |hand| {
            let text = hand.harness.get_by_role(Role::MultilineTextInput);
            text.is_focused()
        });
        // Tab is a letter in a text.
        hand.press(Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn f6_goes_from_view_to_view() {
    let two = format!("{SPHERE}surface t(u,v) = (u, v, 0), u : [-1, 1], v : [-1, 1];\n");
    let mut hand = Hand::on(&two);
    let mut seen = Vec::new();
    for back in [false, false, false, true] {
        let modifiers = if back {
            Modifiers::SHIFT
        } else {
            Modifiers::NONE
        };
        hand.press(modifiers, Key::F6);
        hand.settle();
        let (_, label) = hand.focused().expect("a view has the focus");
        seen.push(label.split(" from").next().unwrap_or_default().to_owned());
    }
    assert_eq!(
        seen,
        [
            "Geodesic view of s",
            "Geodesic view of t",
            "3D view of 3 objects, seen",
            "Geodesic view of t"
        ]
    );
    hand.hold(Key::W, 4);
    assert!(hand.camera("t").moved && !hand.camera("s").moved);
}

#[test]
fn panes_are_set_out_and_sized_by_keys() {
    let mut hand = Hand::on(SPHERE);
    let wide = |hand: &Hand| hand.space().width();
    let first = wide(&hand);
    hand.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::ArrowRight);
    hand.settle();
    assert!(wide(&hand) > first + 10.0);
    hand.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::ArrowLeft);
    hand.settle();
    assert!((wide(&hand) - first).abs() < 1.0);
    let set_out = |hand: &mut Hand, how: &str| {
        hand.click("View");
        hand.click("Layout");
        hand.click(how);
        hand.press(Modifiers::NONE, Key::Escape);
        hand.settle();
    };
    set_out(&mut hand, "Views one above the other");
    assert!(hand.space().bottom() < hand.inside("s").top());
    assert!(wide(&hand) > 1.5 * first);
    set_out(&mut hand, "Views side by side");
    assert!(hand.space().right() < hand.inside("s").left());
    set_out(&mut hand, "Views as tabs");
    assert!(hand.shows("3D view of") && !hand.shows("Geodesic view of s from"));
    assert!(
        hand.shows("Status: no errors"),
        "what is written is there still"
    );
    set_out(&mut hand, "As at first");
    assert!((wide(&hand) - first).abs() < 1.0, "{} {first}", wide(&hand));
}

#[test]
fn entries_of_the_menus_have_keys() {
    let mut hand = Hand::on(SPHERE);
    for (key, title) in [
        (Key::E, "Save picture"),
        (Key::R, "Record"),
        (Key::M, "Export mesh"),
    ] {
        hand.press(Modifiers::COMMAND, key);
        hand.harness.run_steps(3);
        assert!(
            hand.harness.query_all_by_label(title).next().is_some(),
            "{key:?}"
        );
        hand.press(Modifiers::NONE, Key::Escape);
        hand.settle();
        assert!(
            hand.harness.query_all_by_label(title).next().is_none(),
            "{title}"
        );
    }
    hand.harness.event(Event::Copy);
    hand.until("the picture is copied", |hand| hand.shows("was copied"));
    hand.harness.run_steps(300);
    assert!(hand.shows("was copied"));
    hand.harness.run_steps(320);
    assert!(!hand.shows("was copied"), "it is old");
}

#[test]
fn the_keys_that_size_controls_are_the_setting() {
    let mut hand = Hand::on(SPHERE);
    let scale = |hand: &Hand| hand.window().model().choices.preferences.scale;
    for (key, expected) in [
        (Key::Plus, 1.25),
        (Key::Equals, 1.5),
        (Key::Minus, 1.25),
        (Key::Num0, 1.0),
        (Key::Minus, 0.8),
        (Key::Minus, 0.8),
    ] {
        hand.press(Modifiers::COMMAND, key);
        hand.settle();
        assert_eq!(scale(&hand), expected, "{key:?}");
        assert_eq!(hand.harness.ctx.zoom_factor(), expected);
    }
}

#[test]
fn a_value_that_keys_have_found_is_written_when_they_are_let_go() {
    let mut hand = Hand::on(SPHERE);
    hand.settings("Preferences");
    hand.click("Update the program when a slider is released");
    hand.settings("Params");
    hand.harness
        .get_by_role_and_label(Role::Slider, "r")
        .focus();
    hand.settle();
    let text = |hand: &Hand| hand.window().text().unwrap_or_default().to_owned();
    hand.harness.key_down(Key::ArrowRight);
    hand.harness.run_steps(3);
    assert!(hand.param("r") > 1.0);
    assert_eq!(text(&hand), SPHERE, "not while it is held");
    hand.harness.key_up(Key::ArrowRight);
    hand.settle();
    let value = hand.param("r");
    assert!(
        text(&hand).starts_with(&format!("param r = {value}")),
        "{}",
        text(&hand)
    );
}

#[test]
fn the_list_of_keys_comes_and_goes_by_keys_and_fits_a_small_window() {
    for size in [[1200.0, 800.0], [800.0, 600.0], [480.0, 320.0]] {
        let mut hand = Hand::with(SPHERE, |builder| builder.with_size(size));
        for closes in [Key::F1, Key::Escape] {
            hand.press(Modifiers::NONE, Key::F1);
            hand.settle();
            assert!(hand.shows("frame everything"), "{size:?}");
            let list = hand.rects("Keyboard and mouse")[0];
            let screen = hand.harness.ctx.content_rect();
            assert!(screen.contains_rect(list), "{list} is not on {screen}");
            // Unless the window is small, all of it is seen at once.
            for part in ["W S", "forward, back", "turn anticlockwise", "views alone"] {
                let at = hand.rects(part)[0];
                assert!(
                    size[0] < 800.0 || list.contains_rect(at),
                    "{part} at {at} of {list}"
                );
            }
            hand.press(Modifiers::NONE, closes);
            hand.settle();
            assert!(!hand.shows("frame everything"), "{closes:?}");
        }
    }
}

/// A key of a place on the keyboard goes down or comes up under a name.
fn strike(hand: &mut Hand, key: Key, place: Key, pressed: bool) {
    hand.harness.event(Event::Key {
        key,
        physical_key: Some(place),
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    });
    hand.harness.run_steps(2);
}

/// The names under which a key goes down and comes up, where Shift goes down or is let go in between, and its place.
const STRIKES: [(Key, Key, Key); 6] = [
    (Key::Plus, Key::Equals, Key::Equals),
    (Key::Equals, Key::Plus, Key::Equals),
    (Key::Plus, Key::Plus, Key::Equals),
    (Key::Equals, Key::Equals, Key::Equals),
    (Key::Minus, Key::Minus, Key::Minus),
    // A layout on which − is written with Shift.
    (Key::Minus, Key::Slash, Key::Slash),
];

/// The camera stands where it is, frame by frame: not only in the end, where there is a limit.
fn rests(hand: &mut Hand, after: &str) {
    hand.harness.run_steps(2);
    let eye = hand.eye();
    hand.harness.run_steps(5);
    assert_eq!(hand.eye(), eye, "the camera moves after {after}");
}

#[test]
fn a_key_that_comes_up_under_another_name_is_let_go() {
    let mut hand = Hand::on(SPHERE);
    for (down, up, place) in STRIKES {
        let before = hand.eye();
        strike(&mut hand, down, place, true);
        assert_ne!(hand.eye(), before, "{down:?} moves the camera");
        strike(&mut hand, up, place, false);
        rests(&mut hand, &format!("{down:?}, {up:?}"));
    }
}

#[test]
fn what_is_typed_in_the_program_moves_no_camera_whatever_has_the_keys_then() {
    let mut hand = Hand::on(SPHERE);
    let (start, inside) = (hand.eye(), hand.camera("s"));
    let editor = |hand: &mut Hand| {
        hand.harness.get_by_role(Role::MultilineTextInput).focus();
        hand.harness.run_steps(2);
    };
    let letters = [(Key::W, Key::W, Key::W), (Key::Z, Key::Z, Key::Y)];
    for (down, up, place) in STRIKES.into_iter().chain(letters) {
        for view in ["3D view of ", "Geodesic view of s from"] {
            // The key comes up in the text, or in the view.
            for in_view in [false, true] {
                editor(&mut hand);
                strike(&mut hand, down, place, true);
                if !in_view {
                    strike(&mut hand, up, place, false);
                }
                hand.like(view).focus();
                hand.harness.run_steps(2);
                // A key that is held repeats itself.
                if in_view {
                    strike(&mut hand, down, place, true);
                    strike(&mut hand, up, place, false);
                }
                hand.harness.run_steps(5);
                assert_eq!(hand.eye(), start, "{down:?} in the text, then {view}");
                assert_eq!(
                    hand.camera("s"),
                    inside,
                    "{down:?} in the text, then {view}"
                );
            }
        }
    }
    // What a view has is let go where the text gets the keys.
    hand.harness.get_by_label_contains("3D view of ").focus();
    hand.harness.run_steps(2);
    strike(&mut hand, Key::W, Key::W, true);
    assert_ne!(hand.eye(), start);
    editor(&mut hand);
    rests(&mut hand, "the text has the keys");
    hand.harness.get_by_label_contains("3D view of ").focus();
    rests(&mut hand, "the view has them again");
}

#[test]
fn a_window_that_another_one_covers_lets_its_keys_go() {
    let mut hand = Hand::on(SPHERE);
    let start = hand.eye();
    strike(&mut hand, Key::W, Key::W, true);
    assert_ne!(hand.eye(), start);
    hand.harness.event(Event::WindowFocused(false));
    rests(&mut hand, "the window has lost the keys");
    hand.harness.event(Event::WindowFocused(true));
    rests(&mut hand, "it has them again");
}
