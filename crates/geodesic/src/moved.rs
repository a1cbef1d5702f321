//! Deep zooms. In: a surface and a camera. Out: the same surface in coordinates relative to the camera.
//!
//! At a zoom of 10⁻¹² the u and v of neighbouring pixels differ by a few ulps. Relative to the camera they keep all
//! their digits; the sum is formed only where the surface is evaluated, and its rounding there is negligible.

use expr::interval::{Interval, Slope};
use expr::ops::Binary;

use crate::ends::Coordinates;
use crate::frame::Frame;
use crate::metric::speed;
use crate::point::Uv;
use crate::step_path::{Borders, PathPart};
use crate::surface::{ChartData, Jet, JetBlock, Lanes, Surface};

/// A surface σ(u₀ + u, v₀ + v), as a function of (u, v).
#[derive(Clone, Copy)]
pub struct Moved<'s> {
    surface: &'s dyn Surface,
    by: [f64; 2],
    /// In the new coordinates, with the apexes near the picture.
    chart_data: ChartData,
}

/// The rounding of u and v is noticeable from this fraction of a pixel on.
const NOTICEABLE: f64 = 1e-3;
/// An apex farther away than the picture's reach by this factor does not need its own coordinates: in them the
/// picture's points would have no more digits than in u and v.
const FAR: f64 = 1e3;

impl<'s> Moved<'s> {
    /// Returns the surface in the camera's coordinates, and the camera in them, at (0, 0), if a picture of this size is
    /// deep enough to need them; else `None`.
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

    fn smooth_piece(&self, uv: Uv) -> u64 {
        self.surface.smooth_piece(self.there(uv))
    }

    fn is_one_piece(&self, within: [Interval; 2]) -> bool {
        let there =
            |k: usize| Interval::binary(Binary::Add, within[k], Interval::point(self.by[k]));
        self.surface.is_one_piece([0, 1].map(there))
    }

    fn creases_along(&self, part: &PathPart<2>) -> Borders {
        let by = |k: usize| Slope::constant(self.by[k]);
        let moved = part.changed(&|k, x| Slope::binary(Binary::Add, x, by(k)));
        self.surface.creases_along(&moved)
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
