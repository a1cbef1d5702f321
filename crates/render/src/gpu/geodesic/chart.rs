//! A view's chart as the generated kernel knows it: a camera on a surface in; what the uniform holds out.

use geodesic::frame::Frame;
use geodesic::surface::{Side, Sides};

use crate::geodesic_view;
use crate::gpu::layout::ChartCamera;

/// The most steps of one pixel's geodesic.
const STEP_LIMIT: u32 = 2_000;

/// The chart in scaled coordinates: offsets from the camera, in units in which the camera's tangent vectors are
/// about 1.
pub(super) struct Chart {
    pub(super) at: [f64; 2],
    pub(super) scale: [f64; 2],
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    pub(super) domain: [[f64; 2]; 2],
    pub(super) sides: [u32; 4],
    pub(super) tip_powers: [f32; 4],
    pub(super) zoom: f64,
}

impl Chart {
    pub(super) fn new(frame: &Frame, domain: [[f64; 2]; 2], sides: Sides, zoom: f64) -> Self {
        // Where a component is 0 for both vectors the chart would have no tangent plane; the frame excludes that.
        let scale = [0, 1].map(|k| frame.x[k].hypot(frame.y[k]));
        Self {
            at: frame.uv.0,
            scale,
            x: [0, 1].map(|k| frame.x[k] / scale[k]),
            y: [0, 1].map(|k| frame.y[k] / scale[k]),
            domain,
            sides: [sides.u[0], sides.u[1], sides.v[0], sides.v[1]].map(side_code),
            tip_powers: [1.0; 4],
            zoom,
        }
    }

    /// The chart of a camera that has been set up.
    pub(super) fn of(inside: &geodesic_view::Inside) -> Self {
        let mut chart = Self::new(&inside.frame, inside.domain(), inside.sides(), inside.zoom);
        for (side, apex) in inside.apexes().as_flattened().iter().enumerate() {
            if let Some(apex) = apex.filter(|apex| apex.regular) {
                chart.tip_powers[side] = apex.power as f32;
                if !apex.smooth {
                    chart.sides[side] = CONE;
                }
            }
        }
        chart
    }

    pub(super) fn camera(&self, size: [u32; 2], rows: [u32; 2], map_row: u32) -> ChartCamera {
        let end = |side: usize| {
            [0, 1].map(|k| ((self.domain[k][side] - self.at[k]) / self.scale[k]) as f32)
        };
        ChartCamera {
            origin: self.at.map(|x| x as f32),
            scale: self.scale.map(|x| x as f32),
            x: self.x.map(|x| x as f32),
            y: self.y.map(|x| x as f32),
            minimum: end(0),
            maximum: end(1),
            sides: self.sides,
            tip_powers: self.tip_powers,
            size,
            rows,
            per_length: (1.0 / self.zoom) as f32,
            step_limit: STEP_LIMIT,
            instance: 0,
            map_row,
        }
    }
}

/// The number of a side that is the tip of a cone in lib/chart.wgsl.
pub(super) const CONE: u32 = 4;

/// The number of a side in lib/chart.wgsl.
pub(super) fn side_code(side: Side) -> u32 {
    match side {
        Side::Edge => 0,
        Side::Wrap => 1,
        Side::WrapFlip => 2,
        Side::Pole => 3,
    }
}
