//! What is measured in the window, on a sphere against spherical trigonometry.

use std::f64::consts::{PI, TAU};
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, Vec2};
use egui_kittest::kittest::Queryable;

use crate::hand::{Hand, SPHERE};

/// Opens the window *Measure* on the sphere of radius 1, with a tool.
fn measuring(tool: &str) -> Hand {
    let mut hand = Hand::on(SPHERE);
    open(&mut hand);
    hand.click(tool);
    hand
}

pub(crate) fn open(hand: &mut Hand) {
    hand.click("View");
    hand.click_on(Role::CheckBox, "Measure");
    hand.press(Modifiers::NONE, Key::Escape);
}

/// The row of a name: its value as it is shown, once it is there.
pub(crate) fn text(hand: &mut Hand, name: &str) -> String {
    let value = |hand: &Hand| {
        // A label is its own value.
        let mut names = hand.names();
        names.dedup();
        let mut pairs = names.windows(2);
        let found = pairs.find(|pair| pair[0] == name);
        found.map(|pair| pair[1].clone())
    };
    hand.until(name, |hand| value(hand).is_some());
    value(hand).expect("it was there")
}

/// The number with which a row begins.
pub(crate) fn number(hand: &mut Hand, name: &str) -> f64 {
    let text = text(hand, name);
    let end = text.find([' ', ';']).unwrap_or(text.len());
    text[..end].parse().expect("a number")
}

/// Where the picture of a geodesic view has a place (x, y): its shorter side goes from −1 to 1.
pub(crate) fn at(hand: &Hand, surface: &str, [x, y]: [f32; 2]) -> Pos2 {
    let rect = hand.inside(surface);
    let half = 0.5 * rect.width().min(rect.height());
    rect.center() + Vec2::new(x * half, -y * half)
}

fn click(hand: &mut Hand, place: [f32; 2]) {
    click_inside(hand, "s", place);
}

pub(crate) fn click_inside(hand: &mut Hand, surface: &str, place: [f32; 2]) {
    let at = at(hand, surface, place);
    hand.click_at(at);
    hand.settle();
}

/// Pictures have pixels, and a click is in the middle of one at best.
#[track_caller]
pub(crate) fn near(shown: f64, wanted: f64) {
    assert!((shown - wanted).abs() < 1e-2, "{shown} is not {wanted}");
}

#[track_caller]
pub(crate) fn equal(shown: f64, wanted: f64) {
    let size = wanted.abs().max(1.0);
    assert!(
        (shown - wanted).abs() < 1e-6 * size,
        "{shown} is not {wanted}"
    );
}

#[test]
fn a_place_has_its_curvatures_and_the_camera_stays() {
    let mut hand = measuring("Place");
    let camera = hand.camera("s");
    click(&mut hand, [0.4, 0.1]);
    equal(number(&mut hand, "K"), 1.0);
    equal(number(&mut hand, "H").abs(), 1.0);
    let space = hand.space().center();
    hand.click_at(space);
    hand.settle();
    assert_eq!(hand.camera("s"), camera, "clicks measure");
    // A larger sphere is measured anew by itself.
    hand.slide("r", 400.0);
    let r = hand.param("r");
    assert!(r > 1.5);
    hand.until("K of the larger sphere", |hand| {
        let shown = format!("{:.5}", 1.0 / (r * r));
        hand.names().iter().any(|name| name.starts_with(&shown))
    });
    // Closed, clicks move the camera again.
    hand.press(Modifiers::NONE, Key::M);
    assert!(!hand.shows("principal"));
    assert!(!hand.shows("directions"));
    hand.click_at(space);
    hand.settle();
    assert_ne!(hand.camera("s"), camera);
}

#[test]
fn the_pointer_has_its_distance_and_direction_from_the_camera() {
    let mut hand = measuring("Place");
    let zoom = hand.camera("s").zoom;
    let place = at(&hand, "s", [-0.3, 0.4]);
    hand.harness.hover_at(place);
    near(number(&mut hand, "length of the geodesic seen"), 0.5 * zoom);
    near(number(&mut hand, "direction"), f64::atan2(0.4, -0.3));
    equal(number(&mut hand, "K"), 1.0);
}

#[test]
fn a_resting_pointer_has_its_place_in_the_status_line_and_its_curvature_follows_the_params() {
    let mut hand = Hand::on(SPHERE);
    let place = at(&hand, "s", [-0.3, 0.4]);
    hand.harness.hover_at(place);
    hand.until("the place is in the status line", |hand| {
        hand.shows("s at (u, v) = (")
            && hand.shows("), K = 1, ")
            && hand.shows(" from the geodesic camera")
    });
    let space = hand.space();
    hand.harness
        .hover_at(space.left_top() + Vec2::new(2.0, 120.0));
    hand.until("beside the sphere there is none", |hand| {
        !hand.shows("K = 1")
    });
    // With the window open, the last place is measured anew where a param changes.
    open(&mut hand);
    hand.harness.hover_at(place);
    equal(number(&mut hand, "K"), 1.0);
    hand.slide("r", 60.0);
    let r = hand.param("r");
    assert!(r > 1.1, "{r}");
    let wanted = 1.0 / (r * r);
    hand.until("K of the larger sphere", |hand| {
        let names = hand.names();
        let mut shown = names.iter().filter_map(|name| name.parse::<f64>().ok());
        shown.any(|k| (k - wanted).abs() < 1e-6)
    });
}

#[test]
fn the_place_where_one_stands_is_at_no_distance() {
    let mut hand = Hand::on(SPHERE);
    let place = hand.space().center();
    hand.click_at(place);
    hand.harness.hover_at(place);
    hand.until("its distance is shown", |hand| {
        hand.shows(", 0 from the geodesic camera")
    });
}

#[test]
fn a_resting_pointer_names_what_is_no_surface() {
    let mut hand = Hand::on("curve c(t) = (4t, 0, 0), t : [-1, 1];\npoint p = (0, 0, 9);\n");
    let space = hand.space();
    // The middle of the curve lies below the point, in the middle column of the picture, near its bottom.
    let named = (0..150_u8).rev().find(|step| {
        let share = f32::from(*step) / 150.0;
        let below = Vec2::new(0.5 * space.width(), share * space.height());
        hand.harness.hover_at(space.left_top() + below);
        hand.settle();
        // A window that rests does not wait for what is under the pointer: a loaded machine tells it later.
        (0..8).any(|_| {
            std::thread::sleep(Duration::from_millis(5));
            hand.harness.step();
            hand.shows("c at t = ")
        })
    });
    assert!(named.is_some(), "the pointer rests on the curve");
    hand.harness
        .hover_at(space.left_top() + Vec2::new(2.0, 120.0));
    // The answer comes with a later frame.
    hand.until("there is nothing there", |hand| !hand.shows("c at t = "));
}

#[test]
fn the_places_of_a_figure_can_be_entered() {
    let mut hand = measuring("Distance");
    click(&mut hand, [-0.3, 0.0]);
    click(&mut hand, [0.5, 0.0]);
    for (name, value) in [
        ("u of A", "0"),
        ("v of A", "0"),
        ("u of B", "0"),
        ("v of B", "1"),
    ] {
        hand.type_number(Role::SpinButton, name, value);
    }
    hand.until("the distance of the places", |hand| {
        let names = hand.names();
        names
            .windows(2)
            .any(|pair| pair[0] == "distance" && pair[1] == "1")
    });
    equal(number(&mut hand, "distance"), 1.0);
}

#[test]
fn places_take_expressions_and_what_is_no_number_keeps_the_old_value() {
    let mut hand = measuring("Distance");
    click(&mut hand, [-0.3, 0.0]);
    click(&mut hand, [0.5, 0.0]);
    for (name, text) in [
        ("u of A", "pi/2"),
        ("v of A", "0"),
        ("u of B", "pi/2 + sqrt 2 - 1"),
        ("v of B", "0"),
    ] {
        hand.type_number(Role::SpinButton, name, text);
    }
    hand.until("the distance of the places", |hand| {
        hand.shows("0.41421356")
    });
    hand.type_number(Role::SpinButton, "u of A", "2pi/x");
    assert!(
        hand.shows("`2pi/x` is not a number: "),
        "{:?}",
        hand.names()
    );
    let field = (Role::SpinButton, "u of A");
    let field = hand.harness.get_by_role_and_label(field.0, field.1);
    assert_eq!(field.value().as_deref(), Some("u = 1.570796"));
    hand.type_number(Role::SpinButton, "u of A", "0");
    assert!(!hand.shows("is not a number"));
}

#[test]
fn the_window_keeps_its_size_and_its_place_while_the_pointer_moves() {
    let mut hand = measuring("Place");
    let place = |hand: &Hand| {
        let window = (Role::Window, "Measure");
        hand.harness
            .get_by_role_and_label(window.0, window.1)
            .rect()
    };
    // In one picture the length of the geodesic seen has more words than the distance in the other.
    let inside = [[0.4, 0.1], [-0.3, 0.4], [0.0, 0.0], [0.123, -0.456]];
    let inside = inside.map(|share| at(&hand, "s", share));
    let space = hand.space();
    let others = [0.35, 0.5].map(|share| space.lerp_inside(Vec2::new(0.5, share)));
    let beside = space.left_top() + Vec2::new(2.0, 120.0);
    let before = place(&hand);
    hand.keep("measure-before");
    for pointer in inside.into_iter().chain(others).chain([beside]) {
        hand.harness.hover_at(pointer);
        hand.settle();
        for _ in 0..8 {
            std::thread::sleep(Duration::from_millis(5));
            hand.harness.step();
        }
        assert_eq!(place(&hand), before, "{pointer}");
    }
    assert!(hand.shows("The pointer is on no surface."));
    hand.keep("measure-after");
}

#[test]
fn the_window_covers_a_view_and_neither_the_settings_nor_the_program() {
    for size in [[1200.0, 800.0], [900.0, 500.0]] {
        let mut hand = Hand::with(SPHERE, |builder| builder.with_size(size));
        open(&mut hand);
        hand.settle();
        let views = [hand.space(), hand.inside("s")];
        let measure = hand
            .harness
            .get_by_role_and_label(Role::Window, "Measure")
            .rect();
        let slider = hand.harness.get_by_role_and_label(Role::Slider, "r").rect();
        let text = (Role::MultilineTextInput, "Program text");
        let text = hand.harness.get_by_role_and_label(text.0, text.1).rect();
        assert!(measure.left() > slider.right() && measure.left() > text.right());
        assert!(
            views.iter().any(|view| view.intersects(measure)),
            "{measure} {views:?}"
        );
        assert!(measure.min.y >= 0.0 && measure.max.x <= size[0] && measure.max.y <= size[1]);
        hand.keep(&format!("measure-{}", size[0]));
    }
}

#[test]
fn the_window_opens_in_the_lower_left_corner_of_the_view_in_use() {
    for inside in [false, true] {
        let mut hand = Hand::on(SPHERE);
        let view = match inside {
            true => hand.inside("s"),
            false => hand.space(),
        };
        hand.click_at(view.center());
        hand.settle();
        open(&mut hand);
        hand.settle();
        let window = (Role::Window, "Measure");
        let window = hand
            .harness
            .get_by_role_and_label(window.0, window.1)
            .rect();
        let off = window.left_bottom() - view.left_bottom();
        assert!(
            off.x.abs() < 20.0 && off.y.abs() < 20.0,
            "{window} in {view}"
        );
    }
}

#[test]
fn the_distance_of_two_places_is_their_angle() {
    let mut hand = measuring("Distance");
    let zoom = hand.camera("s").zoom;
    click(&mut hand, [-0.3, 0.0]);
    click(&mut hand, [0.5, 0.0]);
    near(number(&mut hand, "distance"), 0.8 * zoom);
    let distance = number(&mut hand, "distance");
    assert!(distance < PI);
    let drawn = |hand: &Hand| {
        let measured = hand.window().model().measured.as_ref();
        measured.map_or(0, |(_, lines)| lines.len())
    };
    hand.until("two marks and the geodesic", |hand| drawn(hand) >= 3);
    hand.settle();
    hand.keep("distance");
    hand.click("Clear");
    assert_eq!(drawn(&hand), 0);
}

#[test]
fn a_circle_about_the_camera_is_compared_with_the_flat_one() {
    let mut hand = measuring("Circle");
    click(&mut hand, [0.0, 0.6]);
    let radius = number(&mut hand, "radius");
    near(radius, 0.6 * hand.camera("s").zoom);
    equal(number(&mut hand, "circumference"), TAU * radius.sin());
    equal(number(&mut hand, "area"), TAU * (1.0 - radius.cos()));
    assert!(text(&mut hand, "area").contains("πr² = "));
}

#[test]
fn a_triangle_has_its_excess() {
    let mut hand = measuring("Triangle");
    for place in [[-0.4, -0.3], [0.5, -0.2], [0.1, 0.5]] {
        click(&mut hand, place);
    }
    let excess = number(&mut hand, "angle excess");
    assert!(excess > 0.05, "{excess}");
    equal(number(&mut hand, "area"), excess);
    equal(number(&mut hand, "∫K"), excess);
    let sides = ["side a", "side b", "side c"].map(|name| number(&mut hand, name));
    assert!(text(&mut hand, "side a").ends_with("; B to C"));
    let [a, b, c] = sides;
    // The law of cosines for the angle opposite c.
    let angle = (c.cos() - a.cos() * b.cos()) / (a.sin() * b.sin());
    equal(number(&mut hand, "angle C"), angle.acos());
}

#[test]
fn a_closed_walk_has_its_holonomy() {
    let mut hand = Hand::on(SPHERE);
    hand.leave_trail("s");
    open(&mut hand);
    hand.hold(Key::W, 20);
    let first = hand.window().model().paths["s"].trail.length;
    hand.hold(Key::D, 20);
    let second = hand.window().model().paths["s"].trail.length - first;
    hand.until("the gap is shown", |hand| hand.shows("to the start"));
    hand.click("Close the walk");
    // A triangle with a right angle between its first two sides: its area is its angle excess, and the holonomy.
    let excess = 2.0 * ((0.5 * first).tan() * (0.5 * second).tan()).atan();
    let holonomy = number(&mut hand, "holonomy");
    assert!(excess > 0.01, "{excess}");
    assert!(
        (holonomy.abs() - excess).abs() < 1e-5,
        "{holonomy}, {excess}"
    );
}

const TORUS: &str = "surface s(u, v) = ((3 + cos v) cos u, (3 + cos v) sin u, sin v),
  u : [0, 2pi], v : [0, 2pi];
";

#[test]
fn the_way_to_the_start_is_what_closing_the_walk_adds() {
    for text in [SPHERE, TORUS] {
        for [up, right] in [[40, 0], [60, 60], [25, 100]] {
            let mut hand = Hand::on(text);
            hand.leave_trail("s");
            open(&mut hand);
            hand.hold(Key::W, up);
            hand.hold(Key::D, right);
            let walked = hand.window().model().paths["s"].trail.length;
            let shown = format!("{walked:.4}");
            hand.until("the walk is measured", |hand| {
                let names = hand.names();
                names.windows(2).any(|pair| {
                    let [name, value] = pair else { return false };
                    name == "length" && value.starts_with(&shown[..shown.len() - 1])
                })
            });
            hand.keep("walk");
            let missing = number(&mut hand, "to the start");
            hand.click("Close the walk");
            hand.until("the walk is closed", |hand| hand.shows("holonomy"));
            let whole = hand.window().model().paths["s"].trail.length;
            assert!(missing > 0.1, "{missing}");
            equal(missing, whole - walked);
        }
    }
}

#[test]
fn only_surfaces_are_measured() {
    let mut hand = Hand::on("point p = (0, 0, 0);");
    open(&mut hand);
    let at = hand.space().center();
    hand.click_at(at);
    hand.until("a sentence", |hand| hand.shows("`p` is not a surface"));
}

const MARKED: &str = "surface s(u, v) = (u, v, 0), u : [0, 2], v : [0, 1];
point p = (0.5, 0.25, 0);
geodesic g(t) : s = (1, 0) @ (0.5, 0.75), t : [0, 1];
";

/// The place of the picture of `s` from inside that is a few pixels beside (u, v).
fn beside(hand: &Hand, [u, v]: [f64; 2]) -> Pos2 {
    let camera = hand.camera("s");
    let offset = [u - 1.0, v - 0.5].map(|x| (x / camera.zoom) as f32);
    at(hand, "s", offset) + Vec2::new(3.0, -2.0)
}

#[test]
fn clicks_snap_to_points_and_ends_of_geodesics() {
    let mut hand = Hand::on(MARKED);
    open(&mut hand);
    hand.click("Distance");
    for place in [[0.5, 0.25], [1.5, 0.75]] {
        let place = beside(&hand, place);
        hand.click_at(place);
        hand.settle();
    }
    equal(number(&mut hand, "distance"), 1.25_f64.sqrt());
    // The corner of the figure that is there.
    for place in [[0.5, 0.25], [0.5, 0.75]] {
        let place = beside(&hand, place);
        hand.click_at(place);
        hand.settle();
    }
    equal(number(&mut hand, "distance"), 0.5);
    // Alt turns it off.
    hand.harness
        .event(egui::Event::ModifiersChanged(Modifiers::ALT));
    hand.click("Place");
    hand.click("Distance");
    for place in [[0.5, 0.25], [1.5, 0.75]] {
        let place = beside(&hand, place);
        hand.click_at(place);
        hand.settle();
    }
    // Both clicks are off by as much: the places are not those of the point and of the end.
    let values = |hand: &Hand| {
        hand.names()
            .into_iter()
            .filter(|name| name == "0.5")
            .count()
    };
    assert_eq!(values(&hand), 0, "{:?}", hand.names());
    near(number(&mut hand, "distance"), 1.25_f64.sqrt());
}

#[test]
fn a_click_on_a_point_of_a_surface_in_space_is_a_place_of_the_surface() {
    let mut hand =
        Hand::on("surface s(u, v) = (u, v, 0), u : [0, 2], v : [0, 2]; point p = (1, 1, 0);");
    open(&mut hand);
    let at = hand.space().center() + Vec2::new(3.0, 3.0);
    hand.harness.hover_at(at);
    hand.until("a ring", |hand| hand.window().snaps());
    hand.click_at(at);
    equal(number(&mut hand, "K"), 0.0);
    let shown = text(&mut hand, "(u, v)");
    assert_eq!(shown, "(1, 1)");
    assert!(!hand.shows("is no surface"));
}
