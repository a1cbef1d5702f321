//! The camera and the exponential map.

use std::f64::consts::PI;

use crate::shapes::*;
use expr::ops::Unary;
use geodesic::frame::Frame;
use geodesic::intrinsic::MetricSurface;
use geodesic::map::{MapMethod, MapOptions, exponential_map, pixel_place};
use geodesic::metric::Metric;
use geodesic::point::Uv;
use geodesic::reference::Reference;
use geodesic::surface::{ChartData, Jet, Surface, USUAL_INSTRUCTIONS};
use geodesic::trace::{Options, Status};

/// X ⟂ Y of one length.
#[track_caller]
fn assert_orthogonal(surface: &dyn Surface, frame: &Frame, zoom: f64) {
    let metric = Metric::of(&surface.jet(frame.uv));
    let (xx, xy, yy) = (
        metric.inner(frame.x, frame.x),
        metric.inner(frame.x, frame.y),
        metric.inner(frame.y, frame.y),
    );
    let square = zoom * zoom;
    assert!(
        (xx - square).abs() < 1e-9 * square,
        "{frame:?}: {xx} {square}"
    );
    assert!(
        (yy - square).abs() < 1e-9 * square,
        "{frame:?}: {yy} {square}"
    );
    assert!(xy.abs() < 1e-9 * square, "{frame:?}: {xy}");
}

#[test]
fn a_frame_is_carried_around_a_triangle_of_the_sphere_by_its_area() {
    let s = spheroid(1.0, 1.0);
    let start = Frame::new(&s, [1.0, 0.3], 0.4, 0.5).expect("a frame");
    assert_orthogonal(&s, &start, 0.5);
    assert!((start.zoom(&s) - 0.5).abs() < 1e-14);
    // A quarter of a great circle is π/2 long, and the octant's three right angles turn the frame by π/2.
    let quarter = PI;
    let options = Options::default();
    let mut frame = start;
    for step in [[quarter, 0.0], [0.0, quarter]] {
        frame = frame.advance(&s, step, &options).expect("a way").0;
        assert_orthogonal(&s, &frame, 0.5);
    }
    // Back to the start along the third side, which lies along −X now.
    let frame = frame
        .advance(&s, [-quarter, 0.0], &options)
        .expect("a way")
        .0;
    assert!(
        (0..2).all(|k| (frame.uv[k] - start.uv[k]).abs() < 1e-9),
        "{frame:?} {start:?}"
    );
    let turned = start.turned(PI / 2.0);
    let miss = [0, 1].map(|k| {
        (frame.x[k] - turned.x[k])
            .abs()
            .max((frame.y[k] - turned.y[k]).abs())
    });
    assert!(miss[0].max(miss[1]) < 1e-8, "{frame:?} {turned:?}");
}

#[test]
fn a_frame_passes_a_moebius_strips_seam_mirrored_and_returns_as_it_was() {
    let s = moebius(0.0);
    let options = Options::default();
    let start = Frame::new(&s, [0.5, 0.1], PI - 0.1, 1.0).expect("a frame");
    let (there, trace) = start.advance(&s, [0.9, 0.1], &options).expect("a way");
    assert!(
        trace.flipped && trace.status == Status::Complete,
        "{trace:?}"
    );
    assert_orthogonal(&s, &there, 1.0);
    let left = Metric::of(&s.jet(there.uv)).turn_left(there.x);
    assert!(
        (0..2).all(|k| (left[k] + there.y[k]).abs() < 1e-9),
        "{there:?} is not mirrored"
    );
    let (back, _) = there.advance(&s, [-0.9, -0.1], &options).expect("a way");
    let miss = [
        (back.uv.0, start.uv.0),
        (back.x.0, start.x.0),
        (back.y.0, start.y.0),
    ];
    for (a, b) in miss {
        assert!(
            (0..2).all(|k| (a[k] - b[k]).abs() < 1e-9),
            "{back:?} {start:?}"
        );
    }
}

#[test]
fn every_pixel_of_a_sphere_is_right_with_the_pole_in_the_picture() {
    for method in [MapMethod::Fan, MapMethod::Adaptive] {
        every_pixel_of_a_sphere_is_right(method);
    }
}

fn every_pixel_of_a_sphere_is_right(method: MapMethod) {
    let s = spheroid(1.0, 1.0);
    let frame = Frame::new(&s, [0.3, 1.2], 0.5, 2.0).expect("a frame");
    let size = [40, 24];
    let options = MapOptions {
        method,
        ..MapOptions::default()
    };
    let map = exponential_map(&s, &frame, size, &options, &|_| {});
    assert_eq!(map.offset.len(), 40 * 24);
    let pixel = 2.0 * 2.0 / 24.0;
    let at = s.jet(frame.uv);
    let mut worst = 0.0_f64;
    for row in 0..size[1] {
        for column in 0..size[0] {
            let place = pixel_place(size, column, row);
            let index = (row * size[0] + column) as usize;
            assert_eq!(map.status[index], Status::Complete);
            let velocity = frame.velocity(place);
            let w = [0, 1, 2].map(|k| at.du[k] * velocity[0] + at.dv[k] * velocity[1]);
            let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
            let end = s.jet(map.uv(index)).position;
            let (sin, cos) = length.sin_cos();
            let gap: f64 = (0..3)
                .map(|k| (at.position[k] * cos + w[k] / length * sin - end[k]).powi(2))
                .sum();
            worst = worst.max(gap.sqrt() / pixel);
        }
    }
    assert!(worst <= 0.1, "{worst} px, {method:?}");
}

#[test]
fn the_middle_of_an_odd_picture_is_the_camera_itself() {
    let s = torus(0.4);
    let frame = Frame::new(&s, [0.3, 1.2], 0.0, 2.0).expect("a frame");
    for method in [
        MapMethod::Fan,
        MapMethod::FanLinear,
        MapMethod::Adaptive,
        RK4,
    ] {
        let options = MapOptions {
            method,
            ..MapOptions::default()
        };
        let map = exponential_map(&s, &frame, [9, 7], &options, &|_| {});
        assert_eq!(map.uv(31), frame.uv, "{method:?}");
    }
}

const RK4: MapMethod = MapMethod::Rk4 { steps: 8 };

#[test]
fn pictures_of_no_and_of_one_pixel_and_without_zoom_are_finite() {
    let s = torus(0.4);
    let frame = Frame::new(&s, [0.3, 1.2], 0.0, 0.0).expect("a frame");
    for size in [[0, 0], [1, 1], [3, 2]] {
        for method in [
            MapMethod::Fan,
            MapMethod::FanLinear,
            MapMethod::Adaptive,
            RK4,
        ] {
            let options = MapOptions {
                method,
                ..MapOptions::default()
            };
            let map = exponential_map(&s, &frame, size, &options, &|_| {});
            assert_eq!(map.offset.len(), (size[0] * size[1]) as usize);
            assert!(
                (0..map.offset.len()).all(|k| map.uv(k) == [0.3, 1.2]),
                "{map:?}"
            );
        }
    }
}

#[test]
fn a_pixel_s_derivatives_are_the_differences_to_its_neighbours() {
    // Through a flip and around poles; 0.01 of a pixel's step, of second order in it.
    let cases: [(&dyn Surface, [f64; 2], f64); 3] = [
        (&spheroid(1.0, 0.8), [0.3, 1.2], 1.5),
        (&torus(0.4), [6.2, 0.1], 1.2),
        (&moebius(0.0), [6.1, 0.1], 0.5),
    ];
    for ((s, at, zoom), method) in cases
        .into_iter()
        .flat_map(|case| [MapMethod::Fan, MapMethod::Adaptive].map(|method| (case, method)))
    {
        let frame = Frame::new(s, at, 0.5, zoom).expect("a frame");
        let size = [65, 65];
        let options = MapOptions {
            method,
            tolerance: if method == MapMethod::Fan { 1e-2 } else { 1e-5 },
            ..MapOptions::default()
        };
        let map = exponential_map(s, &frame, size, &options, &|_| {});
        let mut compared = 0;
        for index in 66..64 * 65 {
            let (left, right, up, down) = (index - 1, index + 1, index - 65, index + 65);
            let complete = |k: usize| map.status[k] == Status::Complete;
            if ![index, left, right, up, down].into_iter().all(complete) || index % 65 % 64 == 0 {
                continue;
            }
            let metric = Metric::of(
                &s.jet(geodesic::map::bring_back(s.domain(), s.sides(), map.uv(index)).0),
            );
            let known = map.by_pixel[index];
            for (k, pair) in [[left, right], [up, down]].into_iter().enumerate() {
                let [a, b] = pair.map(|n| map.offset[n].map(f64::from));
                let central = [0, 1].map(|k| 0.5 * (b[k] - a[k]));
                let off = [0, 1].map(|c| f64::from(known[k][c]) - central[c]);
                let pixel = 2.0 * zoom / 65.0;
                // Where the neighbours have been brought back by other periods there is nothing to compare.
                if central[0].abs() > 1.0 || central[1].abs() > 1.0 || metric.r < 0.3 * metric.g {
                    continue;
                }
                compared += 1;
                let error = metric.inner(off, off).sqrt() / pixel;
                assert!(error < 0.05, "{error} at {index} of {at:?}, {method:?}");
            }
        }
        assert!(compared > 2000, "{compared}");
    }
}

#[test]
fn pixels_share_a_picture_s_work() {
    let share = |side| MapOptions::default().evaluations_per_pixel([side; 2]);
    assert_eq!([32, 200, 16_384].map(share), [20_000, 1000, 400]);
}

/// A surface whose jets claim to take this many instructions.
struct Dear<S>(S, usize);

impl<S: Surface> Surface for Dear<S> {
    fn jet(&self, uv: Uv) -> Jet {
        self.0.jet(uv)
    }

    fn instruction_count(&self) -> usize {
        self.1
    }

    fn chart_data(&self) -> &ChartData {
        self.0.chart_data()
    }
}

#[test]
fn a_picture_s_work_is_bounded_whatever_an_evaluation_takes() {
    let size = [24; 2];
    for (instructions, most) in [(0, 300_000), (USUAL_INSTRUCTIONS * 100, 3_000)] {
        let s = Dear(torus(0.4), instructions);
        // So far that no pixel's geodesic can be followed.
        let frame = Frame::new(&s, [0.3, 0.2], 0.0, 1e6).expect("a frame");
        for method in [MapMethod::Fan, MapMethod::Adaptive] {
            let options = MapOptions {
                method,
                max_evaluations: 300_000,
                ..MapOptions::default()
            };
            let map = exponential_map(&s, &frame, size, &options, &|_| {});
            // A start is evaluated in any case.
            let most = most + 10 * 24 * 24;
            assert!(
                map.work.evaluations <= most,
                "{method:?}: {} of {most}",
                map.work.evaluations
            );
            let unknown = map.status.iter().filter(|x| **x == Status::WorkLimit);
            assert!(unknown.count() > 24 * 20, "{method:?}");
        }
    }
}

/// E = 10⁻²⁰⁰ + v⁴, F = 0, G = |1/(u − ½) + u/π|: geodesics that take thousands of evaluations, and end in many ways.
fn hostile() -> MetricSurface {
    metric([[0.0, 1.0], [-1.0, 1.0]], |m| {
        let square = m.mul(m.v, m.v);
        let fourth = m.mul(square, square);
        let (least, middle, one, zero) = (m.c(1e-200), m.c(-0.5), m.c(1.0), m.c(0.0));
        let e = m.add(least, fourth);
        let from = m.add(m.u, middle);
        let pole = m.g.div(one, from);
        let slope = m.c(1.0 / PI);
        let slope = m.mul(slope, m.u);
        let sum = m.add(pole, slope);
        // As a root: of an absolute value it would be known where its argument changes its sign.
        let square = m.mul(sum, sum);
        [e, zero, m.f(Unary::Sqrt, square)]
    })
}

#[test]
fn pixels_that_rays_say_nothing_about_have_work_in_common() {
    let s = hostile();
    let mut followed = 0;
    for at in [[0.25, 0.0], [0.25, 0.3], [0.6, 0.1]] {
        let Ok(frame) = Frame::new(&s, at, 0.0, 1.0) else {
            continue;
        };
        for size in [[64; 2], [200; 2]] {
            let options = MapOptions {
                max_evaluations: 2_000_000,
                ..MapOptions::default()
            };
            let map = exponential_map(&s, &frame, size, &options, &|_| {});
            let work = map.work;
            followed += work.followed;
            assert!(work.evaluations < 2_000_000, "{at:?} {size:?}: {work:?}");
        }
    }
    assert!(followed > 1000, "{followed}");
}

#[test]
fn the_thesis_method_ends_where_the_adaptive_one_does() {
    let cases: [(&dyn Surface, [f64; 2], f64); 4] = [
        (&torus(0.4), [6.2, 0.1], 1.2),
        (&moebius(0.0), [6.1, 0.1], 1.5),
        (&catenoid(), [0.1, 0.2], 4.0),
        (&half_plane(), [0.1, 1.0], 2.0),
    ];
    for (s, at, zoom) in cases {
        let frame = Frame::new(s, at, 0.5, zoom).expect("a frame");
        let [one, exact] = [MapMethod::Rk4 { steps: 32 }, MapMethod::Adaptive].map(|method| {
            let options = MapOptions {
                method,
                tolerance: 1e-4,
                ..MapOptions::default()
            };
            exponential_map(s, &frame, [27, 11], &options, &|_| {})
        });
        assert!(one.work.evaluations <= 4 * 32 * 27 * 11);
        assert!(one.by_pixel.is_empty());
        // Where nothing ends before its time, both find the same.
        if one.status.iter().all(|&status| status == Status::Complete) {
            for k in 0..one.offset.len() {
                let [a, b] = [one.uv(k), exact.uv(k)];
                let turns = (a[0] - b[0]) / TAU;
                assert!((turns - turns.round()).abs() < 1e-2, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn the_fan_s_picture_is_true_to_the_tolerance_and_says_how_true() {
    let cases: [(&dyn Surface, [f64; 2], f64); 4] = [
        (&torus(0.4), [1.0, 0.5], 2.0),
        (&spheroid(1.0, 0.7), [1.0, 1.3], 2.0),
        (&moebius(0.0), [6.1, 0.1], 1.5),
        (&klein(TAU), [1.0, 0.9], 1.0),
    ];
    for (s, at, zoom) in cases {
        let frame = Frame::new(s, at, 0.3, zoom).expect("a frame");
        let size = [160, 120];
        let map = exponential_map(s, &frame, size, &MapOptions::default(), &|_| {});
        let mut reference = Reference::new(s, &frame, size, 200);
        let errors = reference.errors(&|k| (map.uv(k), map.status[k]));
        let estimate = map.estimate.expect("a fan estimates its error");
        assert_eq!(errors.unlike, 0, "{errors} at {at:?}");
        assert!(errors.max <= 0.15, "{errors} at {at:?}");
        assert!(errors.max <= 2.0 * estimate.max, "{errors}, {estimate:?}");
        let pixels = 160 * 120;
        assert!(map.work.evaluations < pixels, "{:?}", map.work);
    }
}

#[test]
fn where_geodesics_part_chaotically_the_estimate_is_no_more_than_3_times_too_low() {
    let surface = bumps();
    let frame = Frame::new(&surface, [0.02, 0.7], 0.7, 1.2).expect("a frame");
    let size = [128; 2];
    let map = exponential_map(&surface, &frame, size, &MapOptions::default(), &|_| {});
    let mut reference = Reference::new(&surface, &frame, size, 1200);
    let errors = reference.errors(&|k| (map.uv(k), map.status[k]));
    let estimate = map.estimate.expect("a fan estimates its error");
    assert!(errors.max <= 3.0 * estimate.max, "{errors}, {estimate:?}");
    assert!(errors.quantile(0.99) <= 0.1, "{errors}");
}

#[test]
fn each_pixel_by_itself_is_as_true_as_is_asked() {
    // Where geodesics part, what the first steps are off grows on the way.
    let cases: [(&dyn Surface, [f64; 2], f64, f64); 9] = [
        (&torus(0.4), [0.3, 1.2], 2.0, 0.1),
        (&torus(0.4), [0.0, 3.1], 5.0, 0.1),
        (&torus(0.4), [0.0, 3.1], 5.0, 0.01),
        (&torus(0.4), [0.0, 3.1], 5.0, 1.0),
        (&catenoid(), [0.1, 0.2], 4.0, 0.1),
        (&bumps(), [0.1, 0.2], 0.3, 0.1),
        (&half_plane(), [0.0, 1.0], 4.0, 0.1),
        (&klein(TAU), [1.0, 0.9], 1.0, 0.1),
        (&spheroid(1.0, 0.5), [1.0, 1.3], 6.0, 0.1),
    ];
    for (s, at, zoom, tolerance) in cases {
        let frame = Frame::new(s, at, 0.3, zoom).expect("a frame");
        let size = [72, 72];
        let options = MapOptions {
            method: MapMethod::Adaptive,
            tolerance,
            ..MapOptions::default()
        };
        let map = exponential_map(s, &frame, size, &options, &|_| {});
        let mut reference = Reference::new(s, &frame, size, 400);
        let errors = reference.errors(&|k| (map.uv(k), map.status[k]));
        let estimate = map.estimate.expect("the method estimates its error");
        assert_eq!(errors.unlike, 0, "{errors} at {at:?}");
        assert!(
            errors.max <= tolerance,
            "{errors} at {at:?} with {tolerance}"
        );
        assert!(errors.max <= estimate.max, "{errors}, {estimate:?}");
    }
}

#[test]
fn a_strip_that_lies_between_the_places_looked_at_is_seen() {
    let mut m = Maker::new();
    let position = [m.u, m.v, m.c(0.0)];
    let strip = m.done(position, [[0.0, 40.0], [0.0, 1.0]]);
    for (size, zoom) in [([300, 300], 20.0), ([512, 384], 30.0), ([800, 600], 40.0)] {
        let frame = Frame::new(&strip, [20.0, 0.5], 0.3, zoom).expect("a frame");
        let map = exponential_map(&strip, &frame, size, &MapOptions::default(), &|_| ());
        let (sin, cos) = 0.3_f64.sin_cos();
        let (mut wrong, mut seen) = (Vec::new(), 0);
        for (index, status) in (0..).zip(&map.status) {
            let [x, y] = pixel_place(size, index % size[0], index / size[0]).0;
            let at = [x * cos - y * sin, x * sin + y * cos];
            let is_seen = (zoom * at[0]).abs() < 20.0 && (zoom * at[1]).abs() < 0.5;
            seen += usize::from(is_seen);
            if is_seen != (*status == Status::Complete) {
                wrong.push([index % size[0], index / size[0]]);
            }
        }
        assert!(
            seen > 1500 && wrong.len() < 12,
            "{size:?}: {} of {seen}, {wrong:?}",
            wrong.len()
        );
    }
}
