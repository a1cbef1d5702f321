//! Geodesics on implicit surfaces against those of the same surfaces with parameters, and against closed forms.

use crate::shapes::*;
use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId};
use geodesic::ends::Ends;
use geodesic::fan::{Fan, FanOptions};
use geodesic::frame::Frame;
use geodesic::implicit::{ImplicitSurface, PlaceError, SpaceFan, SpaceFrame, SpaceTraceError};
use geodesic::map::pixel_place;
use geodesic::metric::Metric;
use geodesic::piecewise::PiecewiseMap;
use geodesic::surface::{ParametricSurface, Surface};
use geodesic::trace::{Options, Status, trace};

/// A field made of x, y and z.
struct Field {
    g: Graph,
    at: [NodeId; 3],
}

impl Field {
    fn new() -> Self {
        let mut g = Graph::default();
        let at = [0, 1, 2].map(|k| g.input(Input::Variable(k)));
        Self { g, at }
    }
    fn c(&mut self, x: f64) -> NodeId {
        self.g.constant(x)
    }
    /// (x − a)²
    fn square(&mut self, k: usize, a: f64) -> NodeId {
        let a = self.c(a);
        let x = self.g.sub(self.at[k], a);
        self.g.mul(x, x)
    }
    fn sum(&mut self, nodes: &[NodeId]) -> NodeId {
        let zero = self.c(0.0);
        nodes.iter().fold(zero, |sum, x| self.g.add(sum, *x))
    }
    fn plus(&mut self, node: NodeId, x: f64) -> NodeId {
        let x = self.c(x);
        self.g.add(node, x)
    }
    fn times(&mut self, node: NodeId, x: f64) -> NodeId {
        let x = self.c(x);
        self.g.mul(node, x)
    }
    fn done(self, field: NodeId, size: f64) -> ImplicitSurface {
        ImplicitSurface::new(&self.g, field, &[], Some(size)).expect("a small field")
    }
}

/// x²/a² + y²/b² + z²/c² − 1, times a factor.
fn ellipsoid([a, b, c]: [f64; 3], factor: f64) -> ImplicitSurface {
    let mut f = Field::new();
    let terms: Vec<NodeId> = [a, b, c]
        .into_iter()
        .enumerate()
        .map(|(k, a)| {
            let square = f.square(k, 0.0);
            f.times(square, 1.0 / (a * a))
        })
        .collect();
    let sum = f.sum(&terms);
    let field = f.plus(sum, -1.0);
    let field = f.times(field, factor);
    f.done(field, 2.0 * a.max(b).max(c))
}

/// (√(x² + y²) − 1)² + z² − r².
fn ring(r: f64) -> ImplicitSurface {
    let mut f = Field::new();
    let squares = [f.square(0, 0.0), f.square(1, 0.0)];
    let sum = f.sum(&squares);
    let root = f.g.unary(Unary::Sqrt, sum);
    let off = f.plus(root, -1.0);
    let off = f.g.mul(off, off);
    let z = f.square(2, 0.0);
    let sum = f.sum(&[off, z]);
    let field = f.plus(sum, -r * r);
    f.done(field, 2.0 + 2.0 * r)
}

/// x² + y² − 4, endless.
fn pipe() -> ImplicitSurface {
    let mut f = Field::new();
    let squares = [f.square(0, 0.0), f.square(1, 0.0)];
    let sum = f.sum(&squares);
    let field = f.plus(sum, -4.0);
    f.done(field, f64::INFINITY)
}

/// The cube [−1, 1]³ times a size, as one field of `max` and `abs`.
fn cube(size: f64) -> ImplicitSurface {
    let mut f = Field::new();
    let [x, y, z] = f.at.map(|x| f.g.unary(Unary::Abs, x));
    let two = f.g.binary(Binary::Max, x, y);
    let all = f.g.binary(Binary::Max, two, z);
    let field = f.plus(all, -size);
    f.done(field, 2.0 * size)
}

/// The implicit twins of surfaces with parameters.
fn twins() -> Vec<(&'static str, ParametricSurface, ImplicitSurface)> {
    vec![
        ("sphere", spheroid(1.0, 1.0), ellipsoid([1.0; 3], 1.0)),
        ("torus", torus(0.4), ring(0.4)),
        ("thin torus", torus(0.02), ring(0.02)),
        (
            "ellipsoid",
            triaxial(1.0, 2.0, 3.0),
            ellipsoid([1.0, 2.0, 3.0], 1.0),
        ),
        ("cylinder", cylinder(), pipe()),
    ]
}

fn combine(s: f64, a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| s * a[k] + t * b[k])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(combine(1.0, a, -1.0, b))
}

/// A tight trace with conjugate points.
fn tight() -> Options {
    Options {
        tolerance: 1e-12,
        conjugates: true,
        ..Options::default()
    }
}

#[test]
fn ends_and_conjugate_points_are_those_of_the_parametric_twins() {
    for (name, chart, space) in twins() {
        let domain = chart.domain();
        let mut left = 0;
        for (share, [a, b], way) in [
            ([0.3, 0.4], [1.0, 0.3], 4.0),
            ([0.7, 0.55], [-0.4, 1.0], 6.0),
            ([0.1, 0.6], [1.0, 1.0], 2.5),
        ] {
            let uv = [0, 1].map(|k| domain[k][0] + share[k] * (domain[k][1] - domain[k][0]));
            let jet = chart.jet(uv.into());
            let direction = combine(a, jet.du, b, jet.dv);
            // A thin torus turns a direction much within a short way.
            let way = if name == "thin torus" { 0.3 * way } else { way };
            let truth = trace(&chart, uv, [a, b], way, &tight()).expect("a start");
            let found = space
                .trace(jet.position, direction, way, &tight())
                .expect("a start");
            if truth.status == Status::LeftDomain {
                left += 1;
                continue;
            }
            assert_eq!(truth.status, Status::Complete, "{name}");
            assert_eq!(found.status, Status::Complete, "{name}");
            let off = apart(found.position, truth.position.expect("in space"));
            assert!(off < 1e-9, "{name} {share:?}: {off:e} by {}", found.steps);
            assert_eq!(found.conjugates.len(), truth.conjugates.len(), "{name}");
            for (a, b) in found.conjugates.iter().zip(&truth.conjugates) {
                assert!((a - b).abs() < 1e-9, "{name}: {a} and {b}");
            }
            let [m, rate] = [0, 1].map(|k| (found.jacobi[k] - truth.jacobi[k]).abs());
            let large = truth.jacobi[0].abs().max(1.0);
            assert!(
                m < 1e-8 * large && rate < 1e-7 * large,
                "{name}: {m:e} {rate:e}"
            );
        }
        assert!(left < 2, "{name}: {left} of 3 ways leave the chart");
    }
}

#[test]
fn a_surface_of_any_size_and_any_scale_of_its_field_is_traced_alike() {
    let unit = ellipsoid([1.0, 2.0, 3.0], 1.0);
    let from = [0.5, 0.9, 2.2];
    let one = unit
        .trace(from, [1.0, -0.2, 0.3], 5.0, &tight())
        .expect("a start");
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        for factor in [1.0, 1e-9, 1e9] {
            let other = ellipsoid([1.0, 2.0, 3.0].map(|a| scale * a), factor);
            let start = from.map(|x| scale * x);
            let end = other.trace(start, [1.0, -0.2, 0.3], 5.0 * scale, &tight());
            let end = end.expect("a start");
            assert_eq!(end.status, Status::Complete);
            let off = apart(end.position.map(|x| x / scale), one.position);
            // The place that far from the surface is reached by steps that round differently.
            assert!(off < 1e-9, "{scale:e} {factor:e}: {off:e}");
        }
    }
}

#[test]
fn estimates_and_drifts_tell_of_the_error() {
    let sphere = ellipsoid([1.0; 3], 1.0);
    for tolerance in [1e-5, 1e-8, 1e-11] {
        let options = Options {
            tolerance,
            compare: true,
            ..Options::default()
        };
        let end = sphere.trace([1.0, 0.0, 0.0], [0.0, 3.0, 4.0], 20.0, &options);
        let end = end.expect("a start");
        let (sin, cos) = 20.0_f64.sin_cos();
        let off = apart(end.position, [cos, 0.6 * sin, 0.8 * sin]);
        assert!(
            off < 3.0 * end.error_estimate + 1e-13,
            "{tolerance:e}: {off:e}, {end:?}"
        );
        assert!(off < 1e3 * tolerance, "{tolerance:e}: {off:e}");
        assert!(end.speed_drift.abs() < 1e3 * tolerance);
    }
}

#[test]
fn a_start_is_brought_onto_the_surface_along_the_gradient() {
    let sphere = ellipsoid([1.0; 3], 1.0);
    for far in [1e-3, 0.5, 2.0, 1e3, 1e8] {
        let at = sphere.place([0.6 * far, 0.0, 0.8 * far]).expect("a place");
        assert!(apart(at, [0.6, 0.0, 0.8]) < 1e-12, "{far}: {at:?}");
    }
    let bad = sphere.place([0.0; 3]).expect_err("the middle");
    assert_eq!(bad, PlaceError::NoGradient);
    let bad = sphere.place([f64::NAN, 0.0, 0.0]).expect_err("no number");
    assert_eq!(bad, PlaceError::NotFinite);
    // The direction is taken into the tangent plane.
    let (at, v) = sphere
        .start([0.0, 0.0, 2.0], [1.0, 0.0, 5.0])
        .expect("a start");
    assert!(apart(at, [0.0, 0.0, 1.0]) < 1e-15 && apart(v, [1.0, 0.0, 0.0]) < 1e-14);
    let bad = sphere.start([0.0, 0.0, 2.0], [0.0, 0.0, 5.0]);
    assert_eq!(bad, Err(SpaceTraceError::NormalDirection));
}

#[test]
fn a_frame_that_misses_its_surface_is_brought_onto_it_whatever_its_zoom() {
    let sphere = ellipsoid([1.0; 3], 1.0);
    for zoom in [1e-4, 1.0, 1e4] {
        let frame = SpaceFrame::new(&sphere, [0.6, 0.0, 0.8], 0.3, zoom).expect("a frame");
        assert_eq!(frame.brought_onto(&sphere), Ok(frame));
        let beside = SpaceFrame {
            at: [0.6, 0.0, 0.8 + 1e-7 * zoom],
            ..frame
        };
        let brought = beside.brought_onto(&sphere).expect("a frame");
        assert_ne!(brought, beside);
        let radius = brought.at.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((radius - 1.0).abs() < 1e-15, "{brought:?}");
        assert!((brought.zoom() / zoom - 1.0).abs() < 1e-12, "{brought:?}");
    }
}

#[test]
fn what_has_no_surface_is_refused() {
    // x² + 1 is positive everywhere.
    let mut f = Field::new();
    let square = f.square(0, 0.0);
    let field = f.plus(square, 1.0);
    let empty = f.done(field, 1.0);
    assert!(empty.place([0.7, 0.0, 0.0]).is_err());
    // An undefined one.
    let mut f = Field::new();
    let field = f.c(f64::NAN);
    let undefined = f.done(field, 1.0);
    assert_eq!(undefined.place([0.7, 0.0, 0.0]), Err(PlaceError::Undefined));
}

#[test]
fn a_ray_ends_where_the_field_is_undefined() {
    // √x + y² − 1, a sheet that ends at x = 0.
    let mut f = Field::new();
    let root = f.g.unary(Unary::Sqrt, f.at[0]);
    let y = f.square(1, 0.0);
    let sum = f.sum(&[root, y]);
    let field = f.plus(sum, -1.0);
    let sheet = f.done(field, 1.0);
    let end = sheet.trace([0.5, 0.5, 0.0], [-1.0, 1.0, 0.0], 3.0, &Options::default());
    let end = end.expect("a start");
    assert!(
        matches!(end.status, Status::Undefined | Status::Degenerate),
        "{end:?}"
    );
    assert!(end.length < 1.5 && end.evaluations < 4000, "{end:?}");
}

#[test]
fn the_tip_of_a_cone_is_degenerate_and_a_near_miss_goes_on() {
    // x² + y² − z²: level sets near 0 are nearly singular too.
    for level in [0.0, 1e-12, 1e-6] {
        let mut f = Field::new();
        let squares = [f.square(0, 0.0), f.square(1, 0.0)];
        let z = f.square(2, 0.0);
        let sum = f.sum(&squares);
        let field = f.g.sub(sum, z);
        let field = f.plus(field, -level);
        let cone = f.done(field, 2.0);
        let end = cone.trace([1.0, 0.0, 1.0], [-1.0, 0.0, -1.0], 3.0, &Options::default());
        let end = end.expect("a start");
        if level == 0.0 {
            assert_eq!(end.status, Status::Degenerate, "{end:?}");
            assert!((end.length - 2.0_f64.sqrt()).abs() < 1e-6, "{end:?}");
        } else {
            assert_eq!(end.status, Status::Complete, "{end:?}");
            // Through the neck, straight on.
            assert!(end.position[2] < -0.5, "{end:?}");
        }
        assert!(end.evaluations < 4000, "{end:?}");
    }
}

#[test]
fn a_face_ends_at_its_edges() {
    for size in [1e-6, 1.0, 1e6] {
        let cube = cube(size);
        let from = [0.2 * size, 0.1 * size, size];
        let end = cube.trace(from, [3.0, 4.0, 0.0], 10.0 * size, &Options::default());
        let end = end.expect("a start");
        assert_eq!(end.status, Status::LeftDomain);
        // 0.2 + 0.6 s = 1 or 0.1 + 0.8 s = 1.
        let s = 1.125 * size;
        assert!(
            (end.length - s).abs() < 1e-9 * size,
            "{}: {}",
            size,
            end.length
        );
        assert!(apart(end.position, [0.875 * size, size, size]) < 1e-9 * size);
    }
}

/// The unit ball without the places where |x| is less than `half`.
fn slit_ball(half: f64) -> ImplicitSurface {
    let mut f = Field::new();
    let squares = [0, 1, 2].map(|k| f.square(k, 0.0));
    let sum = f.sum(&squares);
    let ball = f.plus(sum, -1.0);
    let x = f.at[0];
    let size = f.g.unary(Unary::Abs, x);
    let slit = f.times(size, -1.0);
    let slit = f.plus(slit, half);
    let field = f.g.binary(Binary::Max, ball, slit);
    f.done(field, 2.0)
}

#[test]
fn a_ray_ends_at_a_slit_however_narrow_it_is() {
    for half in [1e-2, 1e-3, 1e-4, 1e-5] {
        let ball = slit_ball(half);
        for start in [0.1_f64, 0.5, 1.2] {
            let from = [-start.sin(), 0.0, start.cos()];
            let end = ball.trace(from, [1.0, 0.0, 0.4], 2.0, &Options::default());
            let end = end.expect("a start");
            assert_eq!(end.status, Status::LeftDomain, "{half}, {start}: {end:?}");
            let s = start - half.asin();
            assert!(
                (end.length - s).abs() < 1e-9,
                "{half}, {start}: {}",
                end.length
            );
        }
    }
}

#[test]
fn points_on_the_way_are_the_ends_of_shorter_geodesics() {
    let lengths = [0.0, 0.013, 0.4, 1.0, 1.7, 4.0, 9.5];
    let options = Options::default();
    for surface in [ellipsoid([2.0, 1.0, 0.6], 1.0), ring(0.4)] {
        let (at, direction) = ([1.0, 0.7, 0.2], [0.1, 0.4, 1.0]);
        let found = surface.trace_points(at, direction, &lengths, &options);
        let found = found.expect("a geodesic");
        assert_eq!(
            (found.points.len(), found.status),
            (lengths.len(), Status::Complete)
        );
        for (length, point) in lengths.into_iter().zip(found.points) {
            let end = surface
                .trace(at, direction, length, &tight())
                .expect("a geodesic");
            let off = apart(point, end.position);
            assert!(off < 2e-9 * (1.0 + length), "{off} after {length}");
        }
    }
    // Where it ends early its end is the last one.
    let face = cube(1.0);
    let place = [1.0, 0.2, 0.1];
    let found = face.trace_points(place, [0.0, 1.0, 0.0], &[0.3, 0.6, 0.9, 1.2], &options);
    let found = found.expect("a geodesic");
    assert_eq!((found.points.len(), found.status), (3, Status::LeftDomain));
    assert!(
        apart(found.points[2], [1.0, 1.0, 0.1]) < 1e-9,
        "{:?}",
        found.points
    );
}

/// Both fans of a picture, and the largest distance of their pixels' ends in pixels.
fn pictures(chart: &ParametricSurface, space: &ImplicitSurface, uv: [f64; 2], zoom: f64) -> f64 {
    let size = [160, 120];
    let frame = Frame::new(chart, uv, 0.4, zoom).expect("a frame");
    let fan = Fan::build(chart, &frame, size, &FanOptions::default());
    let jet = chart.jet(frame.uv);
    let vector = |v: [f64; 2]| combine(v[0], jet.du, v[1], jet.dv);
    let in_space = SpaceFrame {
        at: jet.position,
        x: vector(frame.x.0),
        y: vector(frame.y.0),
    };
    let space_fan = SpaceFan::build(space, &in_space, size, &FanOptions::default());
    let space_fan = space_fan.expect("a fan");
    let piecewise = PiecewiseMap::cut(&space_fan, size, 0.05);
    let map = piecewise.map(false);
    let pixel = 2.0 * zoom / 120.0;
    let sides = chart.sides();
    let mut worst = 0.0_f64;
    for index in 0..size[0] * size[1] {
        let place = pixel_place(size, index % size[0], index / size[0]);
        let truth = fan.end(place);
        let (truth, at_pole) = match fan.in_coordinates(&truth, geodesic::ends::Coordinates::Plain)
        {
            Some(end) => (end, false),
            None => (truth, true),
        };
        if truth.status != Status::Complete || at_pole {
            continue;
        }
        let mut uv = truth.at;
        sides.bring_back(chart.domain(), &mut uv);
        let there = chart.jet(uv.into()).position;
        let k = index as usize;
        assert_eq!(map.status[k], Status::Complete, "{place:?}");
        let here: [f64; 3] = std::array::from_fn(|n| map.origin[n] + f64::from(map.offset[k][n]));
        worst = worst.max(apart(here, there) / pixel);
    }
    assert!(Metric::of(&jet).r > 0.0);
    worst
}

#[test]
fn pictures_are_those_of_the_parametric_twins() {
    for ((name, chart, space), zoom) in twins().into_iter().zip([2.0, 2.0, 0.5, 2.0, 1.5]) {
        let domain = chart.domain();
        let uv = [0.3, 0.45];
        let uv = [0, 1].map(|k| domain[k][0] + uv[k] * (domain[k][1] - domain[k][0]));
        let off = pictures(&chart, &space, uv, zoom);
        assert!(off < 0.25, "{name}: {off} px");
    }
}

#[test]
fn pictures_of_any_size_are_alike() {
    let size = [64, 64];
    let ends = |scale: f64| {
        let solid = ellipsoid([1.0, 2.0, 3.0].map(|a| scale * a), 1.0);
        let near = [0.5, 1.0, 2.0].map(|x| scale * x);
        let frame = SpaceFrame::new(&solid, near, 0.3, 1.5 * scale).expect("a frame");
        let fan = SpaceFan::build(&solid, &frame, size, &FanOptions::default()).expect("a fan");
        let map = PiecewiseMap::cut(&fan, size, 0.05).map(false);
        assert!(map.status.iter().all(|status| *status == Status::Complete));
        let offsets = map.offset.into_iter();
        offsets
            .map(|at| at.map(|x| f64::from(x) / scale))
            .collect::<Vec<[f64; 3]>>()
    };
    let unit = ends(1.0);
    let pixel = 3.0 / 64.0;
    for scale in [1e-6, 1e-3, 1e3, 1e6] {
        for (a, b) in unit.iter().zip(ends(scale)) {
            assert!(apart(*a, b) < 0.05 * pixel, "{scale:e}: {a:?} {b:?}");
        }
    }
}

#[test]
fn the_work_of_a_picture_stays_within_its_limit() {
    let ring = ring(0.4);
    let frame = SpaceFrame::new(&ring, [1.4, 0.0, 0.1], 0.7, 40.0).expect("a frame");
    let size = [48, 48];
    let max_evaluations = 1_000_000;
    let options = FanOptions {
        max_evaluations,
        ..FanOptions::default()
    };
    let fan = SpaceFan::build(&ring, &frame, size, &options).expect("a fan");
    PiecewiseMap::cut(&fan, size, 0.05).map(false);
    let used = fan.work().evaluations;
    // Each thread may follow one pixel more.
    assert!(
        (max_evaluations..max_evaluations + 200_000).contains(&used),
        "{used}"
    );
}

#[test]
fn a_picture_of_a_cube_shows_one_face() {
    let cube = cube(1.0);
    let frame = SpaceFrame::new(&cube, [0.3, 0.2, 1.1], 0.3, 2.0).expect("a frame");
    let size = [96, 96];
    let fan = SpaceFan::build(&cube, &frame, size, &FanOptions::default()).expect("a fan");
    let map = PiecewiseMap::cut(&fan, size, 0.05).map(false);
    for index in 0..size[0] * size[1] {
        let [x, y] = pixel_place(size, index % size[0], index / size[0]).0;
        let at = combine(1.0, frame.at, 1.0, frame.velocity([x, y]));
        let off = at[0].abs().max(at[1].abs()) - 1.0;
        if off.abs() < 1e-3 {
            continue;
        }
        let expected = if off < 0.0 {
            Status::Complete
        } else {
            Status::LeftDomain
        };
        assert_eq!(map.status[index as usize], expected, "{at:?}");
    }
}

#[test]
fn a_frame_walks_and_returns() {
    let torus = ring(0.4);
    let frame = SpaceFrame::new(&torus, [1.4, 0.0, 0.1], 0.7, 0.3).expect("a frame");
    let options = Options::default();
    let (there, trace) = frame.advance(&torus, [2.0, 1.0], &options).expect("a step");
    assert_eq!(trace.status, Status::Complete);
    assert!((there.zoom() - 0.3).abs() < 1e-12);
    let (back, _) = there
        .advance(&torus, [-2.0, -1.0], &options)
        .expect("a step");
    assert!(apart(back.at, frame.at) < 1e-9 && apart(back.x, frame.x) < 1e-9);
    assert!(apart(back.y, frame.y) < 1e-9);
    assert!((frame.angle(&torus) - 0.7).abs() < 1e-12);
}

#[test]
fn a_length_beyond_all_measure_ends_for_the_work_and_not_for_the_surface() {
    // A sphere whose size is not known, as of a geodesic that a program declares.
    let mut f = Field::new();
    let squares = [0, 1, 2].map(|k| f.square(k, 0.0));
    let sum = f.sum(&squares);
    let field = f.plus(sum, -1.0);
    let sphere = f.done(field, f64::INFINITY);
    let options = Options::default();
    for length in [1e3, 1e12] {
        let end = sphere.trace_points([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], &[length], &options);
        let end = end.expect("a start");
        assert_eq!(end.status, Status::WorkLimit, "of {length}");
    }
}
