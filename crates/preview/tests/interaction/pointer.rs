//! The pointer on the 3D view: what is under it goes with it.

use egui::{Event, Modifiers, MouseWheelSource, PointerButton, Vec2, accesskit::Role, vec2};
use glam::{DVec3, dvec3};

use crate::hand::{Hand, SPHERE};

/// Eye and target.
type Camera = [DVec3; 2];

fn camera(hand: &Hand) -> Camera {
    let (eye, target) = hand.eye();
    [eye.into(), target.into()]
}

/// Right, up and forward of a camera.
fn axes([eye, target]: Camera) -> [DVec3; 3] {
    let ahead = (target - eye).normalize();
    let right = ahead.cross(DVec3::Z).normalize();
    [right, right.cross(ahead), ahead]
}

/// The points of a picture that a length of 1 has at the distance 1.
fn scale(hand: &Hand) -> f64 {
    let size = hand.space().size();
    f64::from(size.x.min(size.y)) / (2.0 * (0.5 * render::style::FIELD_OF_VIEW).tan())
}

/// Where a place is in the picture: points from its middle, to the right and down.
fn seen(hand: &Hand, place: DVec3) -> Vec2 {
    let [eye, target] = camera(hand);
    let [right, up, ahead] = axes([eye, target]);
    let way = place - eye;
    let to = [way.dot(right), -way.dot(up)].map(|x| x / way.dot(ahead) * scale(hand));
    vec2(to[0] as f32, to[1] as f32)
}

/// The place that is seen at so many points from the middle, in the plane of the target.
fn under(hand: &Hand, at: Vec2) -> DVec3 {
    let [eye, target] = camera(hand);
    let [right, up, _] = axes([eye, target]);
    let share = (target - eye).length() / scale(hand);
    target + (right * f64::from(at.x) - up * f64::from(at.y)) * share
}

/// The drags of the test, by button and modifiers.
const LEFT: (PointerButton, Modifiers) = (PointerButton::Primary, Modifiers::NONE);
const ALT: (PointerButton, Modifiers) = (PointerButton::Primary, Modifiers::ALT);
const PANS: [(PointerButton, Modifiers); 3] = [
    (PointerButton::Secondary, Modifiers::NONE),
    (PointerButton::Middle, Modifiers::NONE),
    (PointerButton::Primary, Modifiers::SHIFT),
];

/// The ways of a drag: right, left, down, up.
const WAYS: [Vec2; 4] = [
    vec2(60.0, 0.0),
    vec2(-60.0, 0.0),
    vec2(0.0, 40.0),
    vec2(0.0, -40.0),
];

/// Drags from the middle.
fn drag(hand: &mut Hand, way: Vec2, (button, modifiers): (PointerButton, Modifiers)) {
    let middle = hand.space().center();
    hand.drag(middle, way, button, modifiers);
}

/// A drag turns the camera about its target, and what is in front goes with the pointer.
fn orbits(hand: &mut Hand, by: (PointerButton, Modifiers)) {
    for way in WAYS {
        let before = camera(hand);
        let [right, up, ahead] = axes(before);
        // On the side of the sphere that is seen, in the middle.
        let front = before[1] - ahead;
        drag(hand, way, by);
        let after = camera(hand);
        assert_eq!(after[1], before[1], "{way}: the target stays");
        let distances = [before, after].map(|[eye, target]| (eye - target).length());
        assert!((distances[0] - distances[1]).abs() < 1e-9, "{distances:?}");
        let moved = seen(hand, front);
        assert!(
            moved.dot(way) > 0.0,
            "{way}: what is in front goes by {moved}"
        );
        let step = after[0] - before[0];
        let against = right * -f64::from(way.x) + up * f64::from(way.y);
        assert!(step.dot(against) > 0.0, "{way}: the eye goes by {step}");
    }
}

/// A drag turns the camera where it stands: it looks where the pointer goes.
fn turns_the_head(hand: &mut Hand, by: (PointerButton, Modifiers)) {
    for way in WAYS {
        let before = camera(hand);
        let [right, up, _] = axes(before);
        drag(hand, way, by);
        let after = camera(hand);
        assert_eq!(after[0], before[0], "{way}: the eye stays");
        let along = right * f64::from(way.x) - up * f64::from(way.y);
        assert!((after[1] - before[1]).dot(along) > 0.0, "{way}");
    }
}

#[test]
fn a_drag_turns_the_picture_about_its_target() {
    let mut hand = Hand::on(SPHERE);
    orbits(&mut hand, LEFT);
    // The shorter side is half a turn. What comes before it is known for a drag is no part of it.
    let size = hand.space().size();
    let quarter = 0.5 * size.x.min(size.y);
    let azimuth = |[eye, target]: Camera| (eye.y - target.y).atan2(eye.x - target.x);
    let before = azimuth(camera(&hand));
    drag(&mut hand, vec2(quarter, 0.0), LEFT);
    let full = std::f64::consts::TAU;
    let turned = (before - azimuth(camera(&hand))).rem_euclid(full);
    let expected = 0.25 * full;
    assert!(
        (0.8..1.001).contains(&(turned / expected)),
        "{turned} of {expected}"
    );
}

#[test]
fn a_drag_by_another_button_or_with_shift_carries_the_picture() {
    let mut hand = Hand::on(SPHERE);
    for by in PANS {
        for way in [vec2(60.0, 20.0), vec2(-40.0, 30.0)] {
            let before = camera(&hand);
            let place = under(&hand, vec2(10.0, -15.0));
            let from = seen(&hand, place);
            drag(&mut hand, way, by);
            let after = camera(&hand);
            let step = after[0] - before[0];
            assert!(
                (after[1] - before[1] - step).length() < 1e-9,
                "all of it moves"
            );
            let carried = seen(&hand, place) - from;
            let share = carried.dot(way) / way.length_sq();
            assert!((0.8..1.001).contains(&share), "{by:?}: {carried} of {way}");
            assert!(
                (carried - share * way).length() < 0.01,
                "{by:?}: {carried} of {way}"
            );
        }
    }
}

#[test]
fn a_drag_turns_the_head_with_alt_or_where_one_flies() {
    let mut hand = Hand::on(SPHERE);
    turns_the_head(&mut hand, ALT);
    hand.click("View");
    hand.click_on(Role::CheckBox, "Fly");
    hand.press(Modifiers::NONE, egui::Key::Escape);
    hand.settle();
    assert!(hand.window().model().choices.preferences.fly);
    turns_the_head(&mut hand, LEFT);
    orbits(&mut hand, ALT);
    for by in PANS {
        let before = camera(&hand);
        drag(&mut hand, vec2(40.0, 0.0), by);
        let step = camera(&hand)[0] - before[0];
        assert!(
            step.dot(axes(before)[0]) < 0.0,
            "{by:?} carries the picture"
        );
    }
    // It is remembered.
    assert!(hand.again().window().model().choices.preferences.fly);
}

/// The wheel, or fingers that part, over a place off the middle: what is under the pointer stays there.
fn nears(hand: &mut Hand, turn: impl Fn(&mut Hand, egui::Pos2, bool)) {
    let start = camera(hand);
    let distance = |hand: &Hand| (camera(hand)[1] - camera(hand)[0]).length();
    for at in [vec2(0.0, 0.0), vec2(90.0, -60.0), vec2(-70.0, 110.0)] {
        let (place, far) = (under(hand, at), distance(hand));
        let pointer = hand.space().center() + at;
        turn(hand, pointer, true);
        assert!(distance(hand) < 0.95 * far, "{} of {far}", distance(hand));
        let off = seen(hand, place) - at;
        assert!(off.length() < 0.05, "{at}: what is there goes by {off}");
        turn(hand, pointer, false);
        let off = seen(hand, place) - at;
        assert!(off.length() < 0.05, "{at}: what is there goes by {off}");
        assert!((distance(hand) / far - 1.0).abs() < 1e-3);
    }
    let back = camera(hand);
    assert!((back[0] - start[0]).length() < 1e-2 && (back[1] - start[1]).length() < 1e-2);
}

/// Events over a place, and frames until nothing moves.
fn send(hand: &mut Hand, at: egui::Pos2, event: Event) {
    hand.harness.hover_at(at);
    hand.harness.step();
    hand.harness.event(event);
    hand.harness.run_steps(40);
    hand.settle();
}

#[test]
fn the_wheel_and_a_pinch_near_what_is_under_the_pointer() {
    let mut hand = Hand::on(SPHERE);
    nears(&mut hand, |hand, at, near| {
        hand.wheel(at, if near { 60.0 } else { -60.0 })
    });
    nears(&mut hand, |hand, at, near| {
        send(hand, at, Event::Zoom(if near { 1.25 } else { 0.8 }));
    });
}

#[test]
fn two_fingers_carry_the_picture() {
    // It leans: straight from above the test knows no right.
    let plane = "surface s(u,v) = (u, v, 0.5u), u : [-9, 9], v : [-9, 9];\n";
    let mut hand = Hand::on(plane);
    let way = vec2(24.0, 15.0);
    let fingers = |source| Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: way,
        phase: egui::TouchPhase::Move,
        source,
        modifiers: Modifiers::NONE,
    };
    // A platform that does not say counts points for a touchpad.
    for source in [MouseWheelSource::Trackpad, MouseWheelSource::Unknown] {
        let before = camera(&hand);
        let middle = hand.space().center();
        send(&mut hand, middle, fingers(source));
        let carried = seen(&hand, before[1]);
        assert!((carried - way).length() < 0.05, "{carried} of {way}");

        // The plane goes with the fingers, so the camera goes against them: to the left, and up in the picture.
        let before = hand.camera("s");
        let middle = hand.inside("s").center();
        send(&mut hand, middle, fingers(source));
        let after = hand.camera("s");
        assert_eq!(after.zoom, before.zoom);
        let step = DVec3::from([after.at[0] - before.at[0], after.at[1] - before.at[1], 0.0]);
        let [x, y] = [before.x, before.y].map(|axis| dvec3(axis[0], axis[1], 0.0));
        assert!(step.dot(x) < 0.0 && step.dot(y) > 0.0, "{step}");
    }
}
