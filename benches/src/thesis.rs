//! The thesis' method at its best: several pixels at a time in vectors, in double and in single precision. The command
//! `geotrace accuracy` has the same method one pixel at a time in double precision.
//!
//! ```text
//! scene ──evaluator.rs (real.rs, single.rs)──▶ derivatives ──accelerations.rs──▶ rk4.rs ──▶ the pixels' ends
//! ```
//!
//! Nothing else needs f32 or these equations, so they live here and the library evaluates in f64 alone.

mod accelerations;
mod evaluator;
mod real;
mod rk4;
mod single;

use expr::processor::Processor;
use geodesic::frame::Frame;
use geodesic::map::pixel_place;
use geodesic::surface::Surface;
use geodesic::trace::Status;
use scene::{ParamValues, Scene, Shape};

use self::evaluator::Code;
use self::real::Real;
use self::rk4::Domain;

/// How many points are worked on at once in double precision.
const LANES: usize = 8;
/// How many in single precision: as wide.
const SINGLES: usize = 16;

/// u and v, or their derivatives, lane by lane.
type Pair<T, const N: usize> = [[T; N]; 2];

/// A vector's components, or E, F and G, lane by lane.
type Triple<T, const N: usize> = [[T; N]; 3];

/// The geodesic equations of a scene's first surface or metric, from symbolic derivatives.
#[derive(Clone, Debug)]
pub(crate) enum Equations {
    /// σ and its derivatives.
    Embedded(Code),
    /// E, F, G and their first derivatives.
    Intrinsic(Code),
}

impl Equations {
    /// The equations with the params at their opening values; `None` where there is no surface, or too large a one.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let settings = ParamValues::initial(scene);
        scene.objects.iter().find_map(|object| {
            let uniforms = || settings.first_instance(scene, object);
            match &object.shape {
                Shape::Surface { position, .. } => {
                    let code = Code::embedded(&scene.graph, *position, &uniforms());
                    code.ok().map(Self::Embedded)
                }
                Shape::Metric { components, .. } => {
                    let code = Code::intrinsic(&scene.graph, *components, &uniforms());
                    code.ok().map(Self::Intrinsic)
                }
                _ => None,
            }
        })
    }

    fn code(&self) -> &Code {
        match self {
            Self::Embedded(code) | Self::Intrinsic(code) => code,
        }
    }

    /// (u'', v'') at several points with these velocities.
    #[inline(always)]
    fn accelerations<T: Real, const N: usize>(
        &self,
        processor: Processor,
        registers: &mut [[T; N]],
        at: &Pair<T, N>,
        velocity: &Pair<T, N>,
        out: &mut Pair<T, N>,
    ) {
        let undefined = [T::nearest(f64::NAN); N];
        match self {
            Self::Embedded(code) => {
                let mut derivatives = [[undefined; 3]; 6];
                code.eval(processor, registers, at, derivatives.as_flattened_mut());
                accelerations::embedded(processor, &derivatives, velocity, out);
            }
            Self::Intrinsic(code) => {
                let mut form = [[undefined; 3]; 3];
                code.eval(processor, registers, at, form.as_flattened_mut());
                accelerations::intrinsic(processor, &form, velocity, out);
            }
        }
    }
}

/// What lanes are made of.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Precision {
    /// Eight pixels at a time in f64.
    Double,
    /// Sixteen pixels at a time in f32, the surface too: as fast as the method gets on a processor.
    Single,
}

/// The ends of all pixels of a picture, row by row from the top, with their statuses.
#[derive(Clone, Debug, Default)]
pub(crate) struct Picture {
    pub(crate) ends: Vec<[f64; 2]>,
    pub(crate) status: Vec<Status>,
    pub(crate) evaluations: u64,
}

/// Follows every pixel's geodesic with so many steps.
pub(crate) fn picture(
    surface: &dyn Surface,
    equations: &Equations,
    frame: &Frame,
    size: [u32; 2],
    steps: u32,
    precision: Precision,
) -> Picture {
    match precision {
        Precision::Double => rows::<f64, LANES>(surface, equations, frame, size, steps),
        Precision::Single => rows::<f32, SINGLES>(surface, equations, frame, size, steps),
    }
}

fn rows<T: Real, const N: usize>(
    surface: &dyn Surface,
    equations: &Equations,
    frame: &Frame,
    size: [u32; 2],
    steps: u32,
) -> Picture {
    let domain = Domain::new(surface);
    // At a pole (u,v) has no directions: a frame there is moved off it.
    let frame = frame.plain(surface);
    let mut registers = equations.code().registers::<T, N>();
    let mut picture = Picture::default();
    let places = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| (column, row)));
    let starts: Vec<[[f64; 2]; 2]> = places
        .map(|(column, row)| [frame.uv.0, frame.velocity(pixel_place(size, column, row)).0])
        .collect();
    for group in starts.chunks(N) {
        let starts = std::array::from_fn(|lane| group[lane.min(group.len() - 1)]);
        let ends = rk4::follow::<T, N>(domain, equations, &mut registers, starts, steps.max(1));
        for end in ends.into_iter().take(group.len()) {
            picture.ends.push(end.at);
            picture.status.push(end.status);
            picture.evaluations += end.evaluations;
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use geodesic::map::{MapMethod, MapOptions, exponential_map};
    use testing::examples;
    use testing::inside::opening;

    #[test]
    fn several_geodesics_at_once_end_where_each_by_itself_does() {
        // Through wraps and flips, off edges, by poles; surfaces and a metric.
        for name in ["torus", "klein", "monkey", "halfplane"] {
            let scene = testing::draw::scene(&examples::one(name).source);
            let view = opening(&scene).expect("a surface");
            let equations = Equations::of(&scene).expect("equations");
            let (surface, frame, size) = (view.surface(), view.frame(), [27, 11]);
            let options = MapOptions {
                method: MapMethod::Rk4 { steps: 32 },
                ..MapOptions::default()
            };
            let one = exponential_map(surface, &frame, size, &options, &|_| {});
            assert!(one.work.evaluations <= 4 * 32 * 27 * 11);
            assert!(one.by_pixel.is_empty());
            let [eight, sixteen] = [Precision::Double, Precision::Single]
                .map(|precision| picture(surface, &equations, &frame, size, 32, precision));
            assert_eq!(one.status, eight.status, "{name}");
            // The pixel in the middle needs no geodesic there, but here it has one of no length.
            assert_eq!(one.work.evaluations + 4 * 32, eight.evaluations, "{name}");
            let back = |at: [f64; 2]| {
                let mut at = at;
                surface.sides().wrap(surface.domain(), &mut at);
                surface.jet(at.into()).position
            };
            let gap = |a: [f64; 2], b: [f64; 2]| {
                let (a, b) = (back(a), back(b));
                (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
            };
            let mut off = 0;
            for k in 0..one.offset.len() {
                if one.status[k] != Status::Complete {
                    continue;
                }
                let at = one.uv(k).0;
                assert!(gap(at, eight.ends[k]) < 1e-4, "{name}: {at:?}");
                let single = sixteen.status[k] == Status::Complete;
                off += usize::from(!single || gap(at, sixteen.ends[k]) > 1e-2);
            }
            assert!(off < 10, "{name}: {off}");
            assert_ne!(eight.ends, sixteen.ends);
        }
    }
}
