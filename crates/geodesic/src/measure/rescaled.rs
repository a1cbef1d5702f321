//! Surfaces of extreme sizes. In: a surface. Out: the same surface in units in which its size and its domain's widths are
//! of order 1. A search multiplies several lengths, which would overflow or underflow.
//!
//! The units are powers of two, so that nothing is rounded.

use expr::interval::{Interval, Slope};
use expr::ops::Binary;

use super::MeasureError;
use crate::point::{TangentVector, Uv};
use crate::step_path::{Borders, PathPart};
use crate::surface::{ChartData, Jet, Surface};

/// A surface in other units of length and of its parameters.
pub(super) struct Rescaled<'s> {
    surface: &'s dyn Surface,
    /// The unit of length.
    size: f64,
    /// The units of the parameters.
    units: [f64; 2],
    chart_data: ChartData,
}

/// Sizes between the inverse of this and this are usual.
const USUAL: f64 = 1e30;

impl<'s> Rescaled<'s> {
    /// Returns the surface in usual units; `None` if its own units are usual.
    pub(super) fn of(surface: &'s dyn Surface) -> Option<Self> {
        let mut chart_data = *surface.chart_data();
        let lengths = [
            chart_data.scale.size,
            chart_data.domain[0][1] - chart_data.domain[0][0],
            chart_data.domain[1][1] - chart_data.domain[1][0],
        ];
        let is_usual = |length: &f64| (1.0 / USUAL..USUAL).contains(length);
        if lengths.iter().all(is_usual) {
            return None;
        }
        let [size, unit_u, unit_v] = lengths.map(|length| length.log2().round().exp2());
        let units = [unit_u, unit_v];
        if !(size.is_normal() && units.iter().all(|unit| unit.is_normal())) {
            return None;
        }
        chart_data.scale.size /= size;
        for axis in 0..2 {
            chart_data.scale.stretch[axis] /= size / units[axis];
            for end in 0..2 {
                chart_data.domain[axis][end] /= units[axis];
                if let Some(apex) = &mut chart_data.topology.apexes[axis][end] {
                    apex.rate *= units[1 - axis];
                    apex.bend /= units[axis].powf(1.0 / apex.power);
                }
            }
        }
        Some(Self {
            surface,
            size,
            units,
            chart_data,
        })
    }

    /// Returns the unit of length.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Converts a point to the new parameters.
    pub(super) fn changed(&self, uv: Uv) -> Uv {
        Uv([0, 1].map(|k| uv[k] / self.units[k]))
    }

    /// Converts a point to the surface's own parameters.
    pub(super) fn restored(&self, uv: Uv) -> Uv {
        Uv([0, 1].map(|k| uv[k] * self.units[k]))
    }

    /// Converts a unit vector to the surface's own parameters and units.
    pub(super) fn restored_vector(&self, vector: TangentVector) -> TangentVector {
        TangentVector([0, 1].map(|k| vector[k] * (self.units[k] / self.size)))
    }

    /// Converts an inner product of two of σu and σv, by their indices.
    pub(super) fn restored_product(&self, product: f64, of: [usize; 2]) -> f64 {
        of.into_iter()
            .fold(product, |product, k| product * (self.size / self.units[k]))
    }

    /// Converts an error's point and length to the surface's own units.
    pub(super) fn restored_error(&self, error: MeasureError) -> MeasureError {
        let place = |at: [f64; 2]| self.restored(Uv(at)).0;
        match error {
            MeasureError::Outside { at, .. } => MeasureError::Outside {
                at: place(at),
                domain: self.surface.domain(),
            },
            MeasureError::Undefined { at } => MeasureError::Undefined { at: place(at) },
            MeasureError::Degenerate { at } => MeasureError::Degenerate { at: place(at) },
            MeasureError::Crease { at } => MeasureError::Crease { at: place(at) },
            MeasureError::BadLength { length } => MeasureError::BadLength {
                length: length * self.size,
            },
            MeasureError::NotFinite => error,
        }
    }
}

impl Surface for Rescaled<'_> {
    fn jet(&self, uv: Uv) -> Jet {
        let [a, b] = self.units;
        let jet = self.surface.jet(Uv([a * uv[0], b * uv[1]]));
        // One factor after the other: their product may overflow.
        let times = |vector: [f64; 3], units: &[f64]| {
            units
                .iter()
                .fold(vector.map(|x| x / self.size), |vector, unit| {
                    vector.map(|x| x * unit)
                })
        };
        Jet {
            // Without an embedding the position is (u, v, 0).
            position: if self.is_embedded() {
                times(jet.position, &[])
            } else {
                [uv[0], uv[1], 0.0]
            },
            du: times(jet.du, &[a]),
            dv: times(jet.dv, &[b]),
            duu: times(jet.duu, &[a, a]),
            duv: times(jet.duv, &[a, b]),
            dvv: times(jet.dvv, &[b, b]),
        }
    }

    fn smooth_piece(&self, uv: Uv) -> u64 {
        self.surface.smooth_piece(self.restored(uv))
    }

    fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        let restored =
            |k: usize| Interval::binary(Binary::Mul, within[k], Interval::point(self.units[k]));
        self.surface.is_one_piece([0, 1].map(restored))
    }

    fn creases_along(&self, part: &PathPart<2>) -> Borders {
        let unit = |k: usize| Slope::constant(self.units[k]);
        let restored = part.changed(&|k, x| Slope::binary(Binary::Mul, x, unit(k)));
        self.surface.creases_along(&restored)
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
