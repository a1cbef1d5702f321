//! The lesson of `docs/lesson.md`, given in the window: what is measured there beside its closed form.

use std::f64::consts::TAU;

use crate::hand::Hand;
use crate::measuring::{at, click_inside, equal, near, number, open, text};

/// The window on a program of the repository, with *Measure* open and a tool chosen.
fn on(path: &str, tool: &str) -> Hand {
    let repository = concat!(env!("CARGO_MANIFEST_DIR"), "/../../");
    let program = std::fs::read_to_string(format!("{repository}{path}"));
    let mut hand = Hand::on(&program.expect("a program"));
    open(&mut hand);
    hand.click(tool);
    hand
}

#[test]
fn the_curvature_of_the_torus_is_under_the_pointer() {
    let mut hand = on("docs/lesson/fan.gtr", "Place");
    for place in [[0.0, 0.0], [0.1, 0.5], [-0.3, -0.7]] {
        let pointer = at(&hand, "s", place);
        hand.harness.hover_at(pointer);
        hand.settle();
        let place = text(&mut hand, "(u, v)");
        let v = place.trim_end_matches(')').rsplit(", ").next();
        let v: f64 = v.expect("v").parse().expect("a number");
        let r = 0.6;
        equal(number(&mut hand, "K"), v.cos() / (r * (1.0 + r * v.cos())));
    }
}

#[test]
fn circles_of_the_hyperbolic_plane_are_too_long() {
    let mut hand = on("docs/lesson/hyperbolic.gtr", "Circle");
    click_inside(&mut hand, "h", [0.2, 0.1]);
    let radius = number(&mut hand, "radius");
    near(radius, f64::hypot(0.2, 0.1) * hand.camera("h").zoom);
    equal(number(&mut hand, "circumference"), TAU * radius.sinh());
    equal(number(&mut hand, "area"), TAU * (radius.cosh() - 1.0));
}

#[test]
fn a_hyperbolic_triangle_lacks_its_area() {
    let mut hand = on("docs/lesson/hyperbolic.gtr", "Triangle");
    for place in [[-0.2, -0.1], [0.2, -0.15], [0.05, 0.25]] {
        click_inside(&mut hand, "h", place);
    }
    let excess = number(&mut hand, "angle excess");
    assert!(excess < -0.01, "{excess}");
    equal(number(&mut hand, "area"), -excess);
    let [a, b, c] = ["side a", "side b", "side c"].map(|name| number(&mut hand, name));
    let angle = (a.cosh() * b.cosh() - c.cosh()) / (a.sinh() * b.sinh());
    equal(number(&mut hand, "angle C"), angle.acos());
}

#[test]
fn the_opposite_point_of_a_sphere_is_at_the_distance_pi() {
    let mut hand = on("docs/lesson/sphere.gtr", "Distance");
    let zoom = hand.camera("s").zoom;
    click_inside(&mut hand, "s", [0.0, 0.0]);
    // Not near the end of `east`, to which a click would snap.
    let place = [0.7, 0.0_f32];
    click_inside(&mut hand, "s", place);
    let walked = f64::from(place[0]) * zoom;
    let around = (walked % TAU).min(TAU - walked % TAU);
    near(number(&mut hand, "distance"), around);
    // The other way around the sphere.
    if around > TAU / 3.0 {
        near(number(&mut hand, "geodesic 2"), TAU - around);
    }
}

#[test]
fn bending_changes_no_distance() {
    let mut hand = on("examples/deformation.gtr", "Distance");
    click_inside(&mut hand, "s", [-0.4, 0.1]);
    click_inside(&mut hand, "s", [0.5, -0.3]);
    let before = number(&mut hand, "distance");
    let lines = hand.window().model().measured.clone();
    hand.slide("a", 200.0);
    assert!(hand.param("a") > 0.5);
    hand.until("measured anew", |hand| {
        hand.window().model().measured != lines
    });
    equal(number(&mut hand, "distance"), before);
}
