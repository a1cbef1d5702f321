//! Deep zooms: a surface and a camera in; the same surface in coordinates that count from the camera out.
//!
//! At a zoom of 10⁻¹² neighbouring pixels' u and v differ by a few units in their last place. Counted from the camera
//! they keep all their digits; only where the surface is evaluated are they added up, and there the rounding is as good
//! as none.

use crate::ends::Coordinates;
use crate::frame::Frame;
use crate::metric::speed;
use crate::point::Uv;
use crate::surface::{ChartData, Jet, JetBlock, Lanes, Surface};

/// A surface σ(u₀ + u, v₀ + v), as a function of (u, v).
#[derive(Clone, Copy)]
pub struct Moved<'s> {
    surface: &'s dyn Surface,
    by: [f64; 2],
    /// In the new coordinates, with those apexes that the picture comes near to.
    chart_data: ChartData,
}

/// The share of a pixel from which on the rounding of u and v is not to be put up with.
const NOTICEABLE: f64 = 1e-3;
/// An apex that is so many times farther off than the picture reaches needs no coordinates of its own: about it those
/// of the picture's points would have no more digits than u and v have.
const FAR: f64 = 1e3;

impl<'s> Moved<'s> {
    /// The surface in the camera's coordinates, and the camera in them, at (0, 0), where a picture of this size is so
    /// deep that it needs them; else `None`.
    pub fn for_camera(
        surface: &'s dyn Surface,
        frame: &Frame,
        size: [u32; 2],
    ) -> Option<(Self, Frame)> {
        let shorter = f64::from(size[0].min(size[1]).max(1));
        let zoom = frame.zoom(surface);
        let pixel = 2.0 * zoom / shorter;
        let jet = surface.jet(frame.uv);
        let rounding = speed(&jet, frame.uv.0.map(|x| x.abs() * f64::EPSILON));
        let deep = rounding > NOTICEABLE * pixel && frame.coordinates == Coordinates::Plain;
        deep.then(|| {
            let by = frame.uv.0;
            let reach = zoom * f64::from(size[0]).hypot(f64::from(size[1])) / shorter;
            let mut chart_data = *surface.chart_data();
            for axis in 0..2 {
                for end in 0..2 {
                    let edge = &mut chart_data.domain[axis][end];
                    *edge -= by[axis];
                    let mut way = [0.0; 2];
                    way[axis] = *edge;
                    if speed(&jet, way) > FAR * reach {
                        chart_data.topology.apexes[axis][end] = None;
                    }
                }
            }
            let frame = Frame {
                uv: Uv([0.0; 2]),
                ..*frame
            };
            let moved = Self {
                surface,
                by,
                chart_data,
            };
            (moved, frame)
        })
    }

    fn there(&self, uv: Uv) -> Uv {
        Uv([0, 1].map(|k| self.by[k] + uv[k]))
    }
}

impl Surface for Moved<'_> {
    fn jet(&self, uv: Uv) -> Jet {
        self.surface.jet(self.there(uv))
    }

    fn jets(&self, at: &[Lanes; 2], out: &mut JetBlock) {
        let at = [0, 1].map(|k| at[k].map(|x| self.by[k] + x));
        self.surface.jets(&at, out);
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
