//! Surfaces whose parameter runs unevenly across a seam. In: a surface. Out: the same surface in parameters that are smooth
//! there.
//!
//! Where σ(u₀,v) = σ(u₁,v) but σu(u₀,v) = ρ σu(u₁,v), ρ ≠ 1, the coordinates continued beyond the seam have a kink that the
//! surface does not have. With u = ψ(w), and ψ' inversely proportional to a length or an area that is smooth across the
//! seam, σ(ψ(w), v) has no kink: geodesics, their Jacobi fields and the interpolation between them are smooth again. Points
//! and vectors are converted at the interface.
//!
//! Only for surfaces in space: the sides of a metric given by its coefficients wrap only where these are the same on
//! both.

mod change;
mod ends;

use std::array::from_fn;

use expr::interval::Interval;

use crate::ends::Coordinates;
use crate::fan::Fan;
use crate::frame::Frame;
use crate::point::{TangentVector, Uv};
use crate::scale::{Scale, at};
use crate::surface::{ChartData, Jet, JetBlock, LANES, Lanes, Side, Surface};
use crate::topology::{PLACES, Topology, place};
use crate::vector::{combine, cross, norm};
use change::ParameterChange;

pub use ends::RestoredEnds;

/// A surface σ(ψ(w), v), σ(u, ψ(w)) or with both parameters changed, over the same domain.
pub struct Reparametrised<'s> {
    surface: &'s dyn Surface,
    /// By axis: the surface's parameter as a function of the new one; `None` where it is unchanged.
    changes: [Option<ParameterChange>; 2],
    chart_data: ChartData,
}

/// The maximum relative difference of speeds that count as equal, and of their ratio along a seam.
const SAME_SPEED: f64 = 1e-6;

/// A seam across which a parameter's speed jumps by the same factor everywhere, or whose parameter is not proportional to the
/// area swept by a line from a smooth pole.
struct UnevenSeam {
    axis: usize,
    /// The fraction of the other axis at which the seam is crossed at the highest speed, by a line that closes.
    fastest: f64,
}

impl<'s> Reparametrised<'s> {
    /// Returns the surface in even parameters; `None` if they are useless: it has no seam, has equal speeds on both sides of
    /// each seam, or is not smooth there in any parameter.
    pub fn of(surface: &'s dyn Surface) -> Option<Self> {
        let uneven = [0, 1].map(|axis| UnevenSeam::find(surface, axis));
        if uneven.iter().all(Option::is_none) {
            return None;
        }
        let domain = surface.domain();
        let changes = uneven.map(|seam| {
            let seam = seam?;
            ParameterChange::of_density(domain[seam.axis], |x| seam.density(surface, x))
        });
        if changes.iter().all(Option::is_none) {
            return None;
        }
        let mut even = Self {
            surface,
            changes,
            chart_data: *surface.chart_data(),
        };
        even.chart_data.scale = Scale::measure(&|uv| even.jet(uv), domain);
        even.chart_data.topology = Topology::find(&|uv| even.jet(uv), domain);
        let smooth = (0..2)
            .all(|axis| even.changes[axis].is_none() || UnevenSeam::find(&even, axis).is_none());
        (smooth && even.sides() == surface.sides()).then_some(even)
    }

    /// The same for a picture, with its camera in the new parameters; also `None` where the camera is in a pole's own
    /// coordinates.
    pub fn for_camera(surface: &'s dyn Surface, frame: &Frame) -> Option<(Self, Frame)> {
        if frame.coordinates != Coordinates::Plain {
            return None;
        }
        let even = Self::of(surface)?;
        let (uv, slopes) = even.changed(frame.uv);
        let frame = Frame {
            uv,
            x: divided(frame.x, slopes),
            y: divided(frame.y, slopes),
            ..*frame
        };
        Some((even, frame))
    }

    /// Returns the ends of a fan on this surface, in the parameters of the original surface.
    pub fn restored_ends<'a>(&'a self, fan: &'a Fan<'a>) -> RestoredEnds<'a> {
        RestoredEnds::new(self, fan)
    }

    /// Converts a point, possibly beyond sides that wrap, to the new parameters. Also returns the factors from the new
    /// components of a vector there to the original ones.
    pub fn changed(&self, uv: Uv) -> (Uv, [f64; 2]) {
        let place = Uv(from_fn(|k| match &self.changes[k] {
            Some(change) => change.inverse(uv[k]),
            None => uv[k],
        }));
        (place, self.restored(place).1)
    }

    /// Converts a point to the surface's own parameters, with the same factors.
    pub fn restored(&self, place: Uv) -> (Uv, [f64; 2]) {
        let both = [0, 1].map(|k| match &self.changes[k] {
            Some(change) => change.forward(place[k]),
            None => [place[k], 1.0, 0.0],
        });
        (Uv(both.map(|[u, _, _]| u)), both.map(|[_, slope, _]| slope))
    }

    /// Does the same for several points, side by side.
    fn restored_all(&self, places: &[Lanes; 2]) -> [[Lanes; 2]; 2] {
        let both = [0, 1].map(|k| match &self.changes[k] {
            Some(change) => change.forward_all(&places[k]),
            None => [places[k], [1.0; LANES], [0.0; LANES]],
        });
        [0, 1].map(|n| [both[0][n], both[1][n]])
    }

    /// Converts a vector at a point, both in the new parameters, to the surface's own parameters.
    pub(crate) fn restored_vector(&self, place: Uv, vector: TangentVector) -> TangentVector {
        let (_, slopes) = self.restored(place);
        TangentVector(from_fn(|k| slopes[k] * vector[k]))
    }
}

fn divided(vector: TangentVector, by: [f64; 2]) -> TangentVector {
    TangentVector(from_fn(|k| vector[k] / by[k]))
}

impl UnevenSeam {
    /// Compares both sides, the speeds at one point first: for most surfaces that suffices.
    fn find(surface: &dyn Surface, axis: usize) -> Option<Self> {
        let side = surface.sides().of(axis)[0];
        if !surface.is_embedded() || !matches!(side, Side::Wrap | Side::WrapFlip) {
            return None;
        }
        let flipped = side == Side::WrapFlip;
        let poles = [0, 1].map(|end| surface.apex(1 - axis, end));
        if poles
            .iter()
            .flatten()
            .any(|apex| apex.smooth && !apex.regular)
        {
            return Some(Self { axis, fastest: 0.5 });
        }
        let domain = surface.domain();
        let tangent = |along: f64, across: f64| {
            let jet = surface.jet(at(domain, place(axis, along, across)));
            along_axis(&jet, axis)
        };
        let mut common = None;
        let mut fastest = (0.0, 0.5);
        let mut compared = 0;
        for across in PLACES {
            let near = tangent(0.0, across);
            let far = tangent(1.0, if flipped { 1.0 - across } else { across });
            let speed = norm(near);
            let ratio = norm(far) / speed;
            if !ratio.is_finite() {
                continue;
            }
            let common = *common.get_or_insert(ratio);
            let off = norm(combine(common, near, -1.0, far));
            if (common - 1.0).abs() <= SAME_SPEED || off > SAME_SPEED * common * speed {
                return None;
            }
            compared += 1;
            if speed > fastest.0 {
                fastest = (speed, across);
            }
        }
        (compared > PLACES.len() / 2).then_some(Self {
            axis,
            // On a strip with a flip, only the middle line closes.
            fastest: if flipped { 0.5 } else { fastest.1 },
        })
    }

    /// Returns a measure that is smooth across the seam, per unit of the parameter: the area swept by a line from a smooth
    /// pole, with which the coordinates about the pole are smooth too; without a pole, the length of a line across the seam.
    fn density(&self, surface: &dyn Surface, along: f64) -> f64 {
        let (axis, other) = (self.axis, 1 - self.axis);
        let domain = surface.domain();
        let smooth = |end: &usize| {
            let apex = surface.apex(other, *end);
            apex.is_some_and(|apex| apex.smooth && apex.power == 1.0)
        };
        if let Some(end) = [0, 1].iter().find(|end| smooth(end)) {
            let jet = surface.jet(Uv(place(axis, along, domain[other][*end])));
            return norm(cross(along_axis(&jet, other), jet.duv));
        }
        let across = at(domain, [self.fastest; 2])[other];
        norm(along_axis(
            &surface.jet(Uv(place(axis, along, across))),
            axis,
        ))
    }
}

fn along_axis(jet: &Jet, axis: usize) -> [f64; 3] {
    if axis == 0 { jet.du } else { jet.dv }
}

impl Surface for Reparametrised<'_> {
    fn jet(&self, place: Uv) -> Jet {
        let mut uv = place;
        let changed = [0, 1].map(|k| {
            let change = self.changes[k].as_ref()?;
            let [u, first, second] = change.forward(place[k]);
            uv[k] = u;
            Some([first, second])
        });
        let mut jet = self.surface.jet(uv);
        for (axis, changed) in changed.into_iter().enumerate() {
            let Some([first, second]) = changed else {
                continue;
            };
            let (tangent, twice) = if axis == 0 {
                (&mut jet.du, &mut jet.duu)
            } else {
                (&mut jet.dv, &mut jet.dvv)
            };
            *twice = combine(first * first, *twice, second, *tangent);
            *tangent = tangent.map(|x| first * x);
            jet.duv = jet.duv.map(|x| first * x);
        }
        jet
    }

    fn jets(&self, places: &[Lanes; 2], out: &mut JetBlock) {
        let mut at = *places;
        let changed = [0, 1].map(|k| {
            let change = self.changes[k].as_ref()?;
            let [u, first, second] = change.forward_all(&places[k]);
            at[k] = u;
            Some([first, second])
        });
        self.surface.jets(&at, out);
        for (axis, changed) in changed.into_iter().enumerate() {
            let Some([first, second]) = changed else {
                continue;
            };
            let (tangent, twice) = if axis == 0 {
                (&mut out.du, &mut out.duu)
            } else {
                (&mut out.dv, &mut out.dvv)
            };
            for k in 0..3 {
                for lane in 0..LANES {
                    let square = first[lane] * first[lane];
                    twice[k][lane] = square * twice[k][lane] + second[lane] * tangent[k][lane];
                    tangent[k][lane] *= first[lane];
                    out.duv[k][lane] *= first[lane];
                }
            }
        }
    }

    fn smooth_piece(&self, uv: Uv) -> u64 {
        self.surface.smooth_piece(self.restored(uv).0)
    }

    fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        // The parameters grow with the new ones, up to rounding.
        let ends =
            [Interval::lower, Interval::upper].map(|end| self.restored(Uv(within.map(end))).0.0);
        let restored = |k: usize| {
            let rounding = 16.0 * f64::EPSILON * ends[0][k].abs().max(ends[1][k].abs());
            Interval::new(ends[0][k] - rounding, ends[1][k] + rounding)
        };
        self.surface.is_one_piece([0, 1].map(restored))
    }

    fn is_embedded(&self) -> bool {
        self.surface.is_embedded()
    }

    fn instruction_count(&self) -> usize {
        self.surface.instruction_count()
    }

    fn chart_data(&self) -> &ChartData {
        &self.chart_data
    }
}
