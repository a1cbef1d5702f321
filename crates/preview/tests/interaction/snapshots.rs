//! A few pictures of the whole window, drawn by a software driver: light, dark, dense, small, stale. What differs from
//! run to run (times) is covered before they are compared.

use egui::{Rect, Theme};
use egui_kittest::SnapshotOptions;

use crate::hand::Hand;

/// A surface without an edge, about which nothing is to be said below, and a curve.
const SCENE: &str = "param h : [0.5, 2];
surface s(u,v) = (cos v cos u, cos v sin u, h sin v), u : [0, 2pi], v : [-pi/2, pi/2];
curve c(t) = (1.5 cos t, 1.5 sin t, 1), t : [0, 2pi];
";

/// Compares what is seen with the picture that is kept.
fn compare(mut hand: Hand, theme: Theme, name: &str) {
    let theme = Some(theme);
    hand.harness.input_mut().system_theme = theme;
    hand.settle();
    // A bar to scroll with fades away.
    hand.harness.run_steps(90);
    // The status line has times: what stands behind them moves with them.
    let screen = hand.harness.ctx.content_rect();
    let status = hand.rects("Status: ").into_iter();
    let lowest = status.max_by(|a, b| a.top().total_cmp(&b.top()));
    let covered = lowest.map(|rect| Rect::from_min_max(rect.min, screen.max));
    if let Some(rect) = covered {
        hand.harness.mask(rect.expand(3.0));
    }
    let picture = hand.harness.render().expect("a driver");
    // A processor that joins a product and a sum may round an edge's pixel to its neighbour's colour, and a driver may
    // round a letter's edge: a few pixels of the edges, never a line of text or the border of a surface.
    let options = SnapshotOptions::new()
        .threshold(0.8)
        .max_failed_pixels(300_usize);
    egui_kittest::image_snapshot_options(&picture, name, &options);
}

#[test]
fn the_window_is_as_it_was_in_the_light() {
    let hand = Hand::with(SCENE, |builder| builder.with_size([1100.0, 640.0]).wgpu());
    compare(hand, Theme::Light, "light");
}

#[test]
fn the_window_is_as_it_was_in_the_dark_and_marks_what_is_stale() {
    let mut hand = Hand::with(SCENE, |builder| builder.with_size([1100.0, 640.0]).wgpu());
    hand.window_mut()
        .set_text(SCENE.replace("sin t, 1)", "sin t, 1"));
    hand.until("the error is shown", |hand| {
        hand.window().model().is_stale()
    });
    compare(hand, Theme::Dark, "dark_stale");
}

#[test]
fn the_window_is_as_it_was_on_a_small_dense_screen() {
    let hand = Hand::with(SCENE, |builder| {
        builder
            .with_size([560.0, 360.0])
            .with_pixels_per_point(2.0)
            .wgpu()
    });
    compare(hand, Theme::Light, "small_dense");
}
