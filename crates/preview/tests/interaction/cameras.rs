//! Every key, button and wheel of both cameras.

use egui::{Event, Key, Modifiers, PointerButton, accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::hand::{Hand, SPHERE};

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Right, forward, and up in the world, of a camera.
fn axes((eye, target): ([f64; 3], [f64; 3])) -> [[f64; 3]; 3] {
    let ahead = minus(target, eye);
    let ahead = ahead.map(|x| x / length(ahead));
    let level = ahead[0].hypot(ahead[1]);
    [
        [ahead[1] / level, -ahead[0] / level, 0.0],
        ahead,
        [0.0, 0.0, 1.0],
    ]
}

#[test]
fn each_key_of_the_3d_camera_moves_it_along_its_axis_and_its_opposite_brings_it_back() {
    let mut hand = Hand::on(SPHERE);
    let pairs = [
        (Key::W, Key::S, 1, 1.0),
        (Key::S, Key::W, 1, -1.0),
        (Key::D, Key::A, 0, 1.0),
        (Key::A, Key::D, 0, -1.0),
        (Key::Q, Key::E, 2, 1.0),
        (Key::E, Key::Q, 2, -1.0),
    ];
    for (key, opposite, axis, sign) in pairs {
        let before = hand.eye();
        let pictures = hand.window().counters().pictures;
        hand.hold(key, 8);
        let after = hand.eye();
        let step = minus(after.0, before.0);
        let along = sign * dot(step, axes(before)[axis]);
        assert!(along > 0.01, "{key:?} moves by {step:?}");
        assert!(
            (along - length(step)).abs() < 1e-9 * along,
            "{key:?} moves by {step:?}"
        );
        let target = minus(after.1, before.1);
        assert!(
            length(minus(target, step)) < 1e-9,
            "{key:?} turns the camera"
        );
        assert!(
            hand.window().counters().pictures > pictures,
            "{key:?}: no new picture"
        );
        hand.hold(opposite, 8);
        let back = minus(hand.eye().0, before.0);
        assert!(
            length(back) < 1e-9,
            "{opposite:?} does not undo {key:?}: {back:?}"
        );
    }
}

/// A ball of radius 1, and a camera that looks at it through a narrow lens.
const LENS: &str = "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;
camera eye = (0, 9, 0) @ (0, -9, 0), fov : 0.3;";

#[test]
fn a_declared_camera_that_is_reset_twice_can_still_be_moved() {
    let mut hand = Hand::on(LENS);
    let at = hand.space().center();
    let first = hand.eye();
    for _ in 0..2 {
        hand.harness.hover_at(at);
        hand.press(Modifiers::NONE, Key::R);
        hand.settle();
        assert_eq!(hand.eye(), first);
    }
    hand.hold(Key::W, 8);
    assert_ne!(hand.eye(), first);
}

#[test]
fn all_is_framed_through_the_lens_of_the_declared_camera() {
    let mut hand = Hand::on(LENS);
    hand.hold(Key::W, 8);
    let at = hand.space().center();
    hand.harness.hover_at(at);
    hand.press(Modifiers::NONE, Key::F);
    hand.settle();
    let (eye, _) = hand.eye();
    // At this distance the ball's outline touches the upper and lower sides.
    let least = 1.0 / 0.15_f64.sin();
    let distance = length(eye);
    assert!(
        (least..1.5 * least).contains(&distance),
        "{distance} of {least}"
    );
}

#[test]
fn f_frames_everything_and_r_and_home_reset_the_3d_camera() {
    let mut hand = Hand::on(SPHERE);
    let first = hand.eye();
    hand.hold(Key::W, 10);
    hand.hold(Key::D, 10);
    let ahead = axes(hand.eye())[1];
    let before = hand.eye();
    hand.press(Modifiers::NONE, Key::F);
    hand.until("everything is framed", |hand| hand.eye() != before);
    hand.settle();
    let framed = hand.eye();
    assert!(length(minus(framed.1, first.1)) < 1e-9, "{framed:?}");
    assert!((length(minus(framed.0, framed.1)) - length(minus(first.0, first.1))).abs() < 1e-9);
    assert!(
        dot(axes(framed)[1], ahead) > 1.0 - 1e-12,
        "its direction stays"
    );
    for key in [Key::R, Key::Home] {
        hand.hold(Key::A, 10);
        assert!(length(minus(hand.eye().0, first.0)) > 0.01);
        hand.press(Modifiers::NONE, key);
        hand.settle();
        assert_eq!(hand.eye(), first, "{key:?}");
    }
}

/// A step in (u, v) in the basis X, Y.
fn in_basis(step: [f64; 2], x: [f64; 2], y: [f64; 2]) -> [f64; 2] {
    let area = x[0] * y[1] - x[1] * y[0];
    [
        (step[0] * y[1] - step[1] * y[0]) / area,
        (x[0] * step[1] - x[1] * step[0]) / area,
    ]
}

#[test]
fn each_key_of_the_geodesic_camera_walks_turns_or_zooms() {
    // In the plane with its own metric, parallel transport changes nothing, so each step is exact.
    let plane = "surface s(u,v) = (2u, 3v, 0), u : [-9, 9], v : [-9, 9];\n";
    let mut hand = Hand::on(plane);
    let first = hand.camera("s");
    let middle = hand.inside("s").center();
    hand.harness.hover_at(middle);
    hand.harness.drag_at(middle);
    hand.harness.step();
    hand.harness.drop_at(middle);
    hand.settle();
    let walks = [
        (Key::W, Key::S, [0.0, 1.0]),
        (Key::S, Key::W, [0.0, -1.0]),
        (Key::D, Key::A, [1.0, 0.0]),
        (Key::A, Key::D, [-1.0, 0.0]),
    ];
    for (key, opposite, way) in walks {
        let before = hand.camera("s");
        hand.hold(key, 8);
        let after = hand.camera("s");
        let step = [after.at[0] - before.at[0], after.at[1] - before.at[1]];
        let [a, b] = in_basis(step, before.x, before.y);
        let along = a * way[0] + b * way[1];
        let aside = a * way[1] - b * way[0];
        assert!(along > 1e-3 && aside.abs() < 1e-7, "{key:?}: {a} X + {b} Y");
        assert!((after.x[0] - before.x[0]).abs() < 1e-7 && (after.y[1] - before.y[1]).abs() < 1e-7);
        hand.hold(opposite, 8);
        let back = hand.camera("s");
        assert!(
            (back.at[0] - before.at[0]).abs() < 1e-6,
            "{back:?} is not {before:?}"
        );
    }
    for (key, opposite, sign) in [(Key::Q, Key::E, 1.0), (Key::E, Key::Q, -1.0)] {
        let before = hand.camera("s");
        hand.hold(key, 8);
        let after = hand.camera("s");
        let [a, b] = in_basis(after.x, before.x, before.y);
        let angle = b.atan2(a) * sign;
        assert!(angle > 0.01 && angle < 1.0, "{key:?} turns X by {angle}");
        assert!((a.hypot(b) - 1.0).abs() < 1e-9, "X keeps its length");
        assert_eq!(after.at, before.at);
        hand.hold(opposite, 8);
    }
    for (key, opposite, sign) in [(Key::Z, Key::X, -1.0), (Key::X, Key::Z, 1.0)] {
        let before = hand.camera("s");
        hand.hold(key, 8);
        let after = hand.camera("s");
        let factor = (after.zoom / before.zoom).ln() * sign;
        assert!(factor > 0.01, "{key:?} zooms by {factor}");
        assert!((after.x[0] / before.x[0] - after.zoom / before.zoom).abs() < 1e-9);
        hand.hold(opposite, 8);
    }
    hand.hold(Key::W, 8);
    hand.hold(Key::Q, 8);
    hand.hold(Key::Z, 8);
    assert_ne!(hand.camera("s"), first);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    assert_eq!(hand.camera("s"), first, "R puts it at its first place");
}

#[test]
fn a_drag_carries_what_is_under_the_pointer_and_the_wheel_zooms() {
    let plane = "surface s(u,v) = (u, v, 0), u : [-9, 9], v : [-9, 9];\n";
    let mut hand = Hand::on(plane);
    let middle = hand.inside("s").center();
    let before = hand.camera("s");
    hand.drag(
        middle,
        vec2(40.0, 0.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    let after = hand.camera("s");
    let step = [after.at[0] - before.at[0], after.at[1] - before.at[1]];
    let [a, b] = in_basis(step, before.x, before.y);
    assert!(
        a < -1e-3 && b.abs() < 1e-7,
        "the camera goes against the pointer: {a} X + {b} Y"
    );
    // A drag by half the shorter side is a walk by X. What comes before it is known for a drag is no part of it.
    let rect = hand.inside("s");
    let half = f64::from(0.5 * rect.width().min(rect.height()));
    assert!((33.0..=40.0).contains(&(-a * half)), "{a} of {half}");
    // The wheel zooms about the observer, wherever the pointer is.
    hand.wheel(middle + vec2(50.0, 30.0), 60.0);
    let near = hand.camera("s").zoom;
    assert_eq!(hand.camera("s").at, after.at);
    assert!(near < 0.95 * after.zoom, "{near} of {}", after.zoom);
    hand.wheel(middle, -60.0);
    assert!((hand.camera("s").zoom / after.zoom - 1.0).abs() < 1e-3);
}

#[test]
fn a_click_on_a_surface_puts_its_geodesic_camera_there() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.camera("s");
    let at = hand.space().center() + vec2(30.0, -20.0);
    hand.drag(at, vec2(0.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    hand.until("the camera is placed", |hand| {
        hand.camera("s").at != before.at
    });
    assert!(hand.shows("s at (u, v) = ("));
    let [u, v] = hand.camera("s").at;
    // What is under the pointer is said with fewer digits.
    let clicked = format!("s at (u, v) = ({u:.4}, {v:.4})");
    assert!(hand.shows(&clicked), "{:?}", hand.names());
    // Elsewhere it says nothing of where the camera was.
    let inside = hand.inside("s").center();
    hand.harness.hover_at(inside);
    hand.press(Modifiers::NONE, egui::Key::F6);
    hand.hold(egui::Key::W, 6);
    assert!(!hand.shows(&clicked), "{:?}", hand.names());
}

#[test]
fn keys_in_a_text_are_text_and_shortcuts_are_no_motions() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.eye();
    hand.harness
        .event(Event::ModifiersChanged(Modifiers::COMMAND));
    hand.harness.key_down(Key::D);
    hand.harness.run_steps(8);
    hand.harness.key_up(Key::D);
    hand.harness.event(Event::ModifiersChanged(Modifiers::NONE));
    hand.settle();
    assert_eq!(hand.eye(), before);
    hand.harness.get_by_role(Role::MultilineTextInput).focus();
    hand.harness.run_steps(2);
    hand.hold(Key::W, 8);
    assert_eq!(hand.eye(), before, "W in the text does not move the camera");
}

#[test]
fn a_turn_of_the_wheel_is_one_step_whatever_it_is_over_and_each_drag_is_another() {
    let mut hand = Hand::on(SPHERE);
    let (middle, before) = (hand.space().center(), hand.eye());
    hand.wheel(middle, 60.0);
    assert_ne!(hand.eye(), before);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.eye(), before, "all of it is undone at once");
    assert_eq!(hand.window().model().history.last(), None);

    let (middle, before) = (hand.inside("s").center(), hand.camera("s"));
    hand.wheel(middle, 60.0);
    assert_ne!(hand.camera("s"), before);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.camera("s"), before, "all of it is undone at once");
    assert_eq!(hand.window().model().history.last(), None);

    // Nothing but a button that is pressed anew tells two drags apart that follow at once.
    let drag = |hand: &mut Hand| {
        let from = hand.space().center();
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        hand.harness.hover_at(from);
        hand.harness.event(button(from, true));
        hand.harness.step();
        for step in 1..=4 {
            hand.harness.hover_at(from + vec2(10.0 * step as f32, 0.0));
            hand.harness.step();
        }
        let to = from + vec2(40.0, 0.0);
        hand.harness.event(button(to, false));
        hand.harness.step();
        hand.eye()
    };
    let first = drag(&mut hand);
    assert_ne!(drag(&mut hand), first);
    hand.settle();
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.eye(), first, "the second drag is undone alone");
}

#[test]
fn a_double_click_moves_no_camera_and_leaves_no_step_and_no_trace_of_its_first_half() {
    let mut hand = Hand::on(SPHERE);
    hand.leave_trail("s");
    hand.hold(Key::W, 6);
    hand.click("View");
    hand.click_on(Role::CheckBox, "Geodesic view of s");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    let before = hand.window().model().choices.clone();
    let trail = hand.window().model().paths["s"].trail.length;
    assert!(before.closed.contains("geodesic:s") && trail > 0.0);
    let last = hand.window().model().history.last();
    let at = hand.space().center() + vec2(30.0, -20.0);
    for times in [2, 3] {
        hand.clicks_at(at, times);
        hand.settle();
        assert_eq!(hand.window().model().choices, before, "{times} clicks");
        assert_eq!(hand.window().model().history.last(), last);
        assert_eq!(hand.window().model().paths["s"].trail.length, trail);
        // The text has the declaration, and the keys: they go back.
        hand.until("the declaration is shown", |hand| {
            hand.window().model().highlighted.as_deref() == Some("s")
        });
        hand.harness.run_steps(60);
    }
    // A click alone is heeded, and the view opens when it can be no double click any more.
    hand.clicks_at(at, 1);
    hand.until("the camera is placed", |hand| {
        hand.camera("s").at != before.inside["s"].place()
    });
    assert!(hand.window().model().choices.closed.contains("geodesic:s"));
    hand.settle();
    assert!(!hand.window().model().choices.closed.contains("geodesic:s"));
    assert_eq!(
        hand.window().model().history.last(),
        Some("Place the geodesic camera")
    );
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.camera("s").at, before.inside["s"].place());
}

#[test]
fn a_double_click_right_behind_a_click_elsewhere_is_one() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.camera("s");
    let at = hand.space().center() + vec2(30.0, -20.0);
    hand.clicks_at(hand.inside("s").center(), 1);
    hand.clicks_at(at, 2);
    hand.settle();
    assert_eq!(hand.camera("s"), before);
    hand.until("the declaration is shown", |hand| {
        hand.window().model().highlighted.as_deref() == Some("s")
    });
}

/// A sphere and a plane, whose views are two tabs.
const TWO: &str =
    "surface s(u,v) = (cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];
surface t(u,v) = (u, v, 2), u : [-1, 1], v : [-1, 1];
";

/// Where the cameras of both stand, and the 3D camera.
fn places(hand: &Hand) -> ([[f64; 2]; 2], [f64; 3]) {
    let inside = ["s", "t"].map(|name| {
        let all = &hand.window().model().choices.inside;
        let camera = all.get(name).and_then(|camera| camera.chart());
        camera.map_or([0.0; 2], |camera| camera.at)
    });
    (inside, hand.eye().0)
}

/// Opens or closes a view.
fn toggle(hand: &mut Hand, title: &str) {
    hand.click("View");
    hand.click_on(Role::CheckBox, title);
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
}

#[test]
fn a_tab_that_is_clicked_on_has_the_keys_and_what_is_behind_it_stays() {
    let mut hand = Hand::on(TWO);
    let tab = |name: &str| format!("Geodesic view – {name}");
    for name in ["s", "t", "s"] {
        hand.click(&tab(name));
        hand.settle();
    }
    let middle = hand.inside("s").center();
    hand.click_at(middle);
    let before = places(&hand);
    // By the pointer, and no click on the picture.
    let at = hand.rects(&tab("t"))[0].center();
    hand.click_at(at);
    hand.hold(Key::W, 6);
    let after = places(&hand);
    assert_ne!(after.0[1], before.0[1], "t walks");
    assert_eq!((after.0[0], after.1), (before.0[0], before.1));
    hand.click(&tab("s"));
    hand.settle();
    assert_eq!(places(&hand), after, "no motion has waited for s");
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    hand.click(&tab("t"));
    hand.settle();
    assert_eq!(places(&hand), before);
    assert_eq!(hand.window().model().history.last(), None);
}

#[test]
fn a_view_that_is_closed_or_covered_loses_the_keys_to_one_that_can_be_seen() {
    let mut hand = Hand::on(TWO);
    hand.click("Geodesic view – s");
    hand.settle();
    let before = places(&hand);
    toggle(&mut hand, "Geodesic view of s");
    toggle(&mut hand, "Geodesic view of t");
    hand.hold(Key::W, 6);
    let after = places(&hand);
    assert_eq!(after.0, before.0, "no unseen camera walks");
    assert_ne!(after.1, before.1, "the 3D view has the keys");
    toggle(&mut hand, "Geodesic view of t");
    toggle(&mut hand, "3D view");
    hand.hold(Key::D, 6);
    let last = places(&hand);
    assert_eq!(last.1, after.1, "the unseen 3D camera stays");
    assert_ne!(last.0[1], after.0[1], "t walks");
    // What is saved is what can be seen.
    hand.click("File");
    let save = hand.harness.get_by_label("Save picture…");
    assert!(!save.accesskit_node().is_disabled());
    hand.press(Modifiers::NONE, Key::Escape);
    toggle(&mut hand, "Geodesic view of t");
    hand.hold(Key::D, 6);
    assert_eq!(
        places(&hand),
        last,
        "where no view is open, no key moves one"
    );
}

/// A point in the middle of the 3D view.
const POINT: &str = "point p = (0, 0, 0);
curve c(t) = (cos t, sin t, 0), t : [0, 2pi];
";

#[test]
fn a_click_on_what_has_no_camera_shows_its_declaration_and_types_nothing() {
    let mut hand = Hand::on(POINT);
    let choices = hand.window().model().choices.clone();
    let at = hand.space().center();
    hand.clicks_at(at, 1);
    hand.until("its declaration is shown", |hand| {
        hand.window().model().highlighted.as_deref() == Some("p")
    });
    hand.settle();
    assert_eq!(hand.window().model().choices, choices, "no camera is moved");
    hand.harness.event(Event::Text("w".to_owned()));
    hand.hold(Key::W, 4);
    assert_eq!(hand.window().text(), Some(POINT));
    assert_ne!(
        hand.eye().0,
        choices.space.expect("a camera").eye,
        "the view has the keys"
    );
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    // A double click asks for the text itself.
    hand.clicks_at(at, 2);
    hand.until("the text has the keys", |hand| {
        hand.harness
            .get_by_role_and_label(Role::MultilineTextInput, "Program text")
            .is_focused()
    });
    hand.harness.event(Event::Text("o".to_owned()));
    hand.settle();
    assert_eq!(
        hand.window().text(),
        Some(POINT.replace("point p", "point o").as_str())
    );
}

#[test]
fn a_window_in_which_something_is_yet_to_come_wakes_for_it_whatever_comes_first() {
    let mut hand = Hand::on(SPHERE);
    let sleeps = |hand: &Hand| {
        let output = &hand.harness.output().viewport_output[&egui::ViewportId::ROOT];
        output.repaint_delay == std::time::Duration::MAX
    };
    hand.until("it is at rest", sleeps);
    let at = hand.space().center() + vec2(30.0, -20.0);
    hand.clicks_at(at, 1);
    // Frames are drawn in which nothing is asked for: pictures have come.
    for _ in 0..20 {
        assert!(!sleeps(&hand), "the click has not come to its end");
        assert!(!hand.window().is_settled());
        hand.harness.step();
    }
    hand.settle();
    hand.until("it is at rest", sleeps);
    hand.harness.hover_at(at);
    hand.harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 4.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..9 {
        hand.harness.step();
        assert!(!sleeps(&hand), "the view still counts as moving");
    }
    hand.until("it is at rest", sleeps);
}

#[test]
fn what_the_text_or_another_hand_has_replaced_no_undo_brings_back() {
    let mut hand = Hand::on(SPHERE);
    hand.slide("r", 50.0);
    assert!(hand.param("r") > 1.0);
    hand.hold(Key::W, 6);
    let moved = hand.eye();
    toggle(&mut hand, "Geodesic view of s");
    let text = SPHERE.replace("param r :", "param r = 2 :");
    hand.window_mut().set_text(text);
    hand.until("it is compiled", |hand| {
        hand.window().text().is_some() && hand.window().model().choices.params.is_empty()
    });
    hand.settle();
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert!(hand.shows("Undone: Move the 3D camera"));
    assert_ne!(hand.eye(), moved);
    assert!(
        hand.window().model().choices.params.is_empty(),
        "r is what the text says"
    );
    assert!(hand.window().model().choices.closed.contains("geodesic:s"));
    assert!(
        !hand.shows("Geodesic view of s from"),
        "what was closed stays closed"
    );
    let choices = hand.window().model().choices.clone();
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(
        hand.window().model().choices,
        choices,
        "of r nothing is left to undo"
    );
    hand.press(Modifiers::COMMAND, Key::Y);
    hand.settle();
    assert_eq!(hand.eye(), moved);
}

#[test]
fn a_click_that_is_undone_at_once_opens_nothing_and_can_be_made_again() {
    let mut hand = Hand::on(SPHERE);
    toggle(&mut hand, "Geodesic view of s");
    let before = hand.camera("s");
    let at = hand.space().center() + vec2(30.0, -20.0);
    hand.clicks_at(at, 1);
    hand.until("the camera is placed", |hand| {
        hand.camera("s").at != before.at
    });
    let placed = hand.camera("s").at;
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    hand.harness.run_steps(60);
    assert_eq!(hand.camera("s").at, before.at);
    assert!(hand.window().model().choices.closed.contains("geodesic:s"));
    hand.press(Modifiers::COMMAND, Key::Y);
    hand.settle();
    assert_eq!(hand.camera("s").at, placed);
}

#[test]
fn a_double_click_on_another_surface_leaves_the_one_in_use() {
    let mut hand = Hand::on(TWO);
    hand.click("Geodesic view – t");
    hand.settle();
    hand.click("Overlays");
    hand.click("Trail of the walk");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    hand.hold(Key::W, 6);
    let length = hand.window().model().paths["t"].trail.length;
    let trail = format!("trail of length {length:.4}");
    assert!(length > 0.0 && hand.shows(&trail));
    // The sphere is below the middle, and the plane above it.
    let at = hand.space().center() + vec2(0.0, 60.0);
    let before = hand.camera("s");
    hand.clicks_at(at, 1);
    // The first click is heeded before the second one comes, in fewer frames than would part them.
    let mut frames = 0;
    while hand.camera("s") == before {
        std::thread::sleep(std::time::Duration::from_millis(40));
        hand.harness.step();
        frames += 1;
        assert!(frames < 20, "no camera is placed");
    }
    hand.clicks_at(at, 1);
    assert_eq!(hand.camera("s"), before);
    hand.until("the declaration of s is shown", |hand| {
        hand.window().model().highlighted.as_deref() == Some("s")
    });
    hand.settle();
    assert!(hand.shows(&trail), "{:?}", hand.names());
}
