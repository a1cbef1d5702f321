//! The ends of a fan on a reparametrised surface, in the parameters of the surface itself.

use super::Reparametrised;
use crate::ends::{Coordinates, End, Ends};
use crate::fan::Fan;
use crate::point::{PicturePoint, Uv};
use crate::surface::LANES;

/// Ends in (u, v) alone, of a fan whose rays run in (w, v): about poles they do not have their own coordinates, since in (u,
/// v) none are smooth there.
pub struct RestoredEnds<'a> {
    even: &'a Reparametrised<'a>,
    fan: &'a Fan<'a>,
}

impl<'a> RestoredEnds<'a> {
    pub(super) fn new(even: &'a Reparametrised<'a>, fan: &'a Fan<'a>) -> Self {
        Self { even, fan }
    }

    /// Returns an end in (w, v); at a pole, where that is impossible, the result is not a point.
    fn plain(&self, end: &End) -> End {
        let plain = self.fan.in_coordinates(end, Coordinates::Plain);
        plain.unwrap_or(End {
            coordinates: Coordinates::Plain,
            at: [f64::NAN; 2],
            ..*end
        })
    }
}

/// Returns an end in (w, v) at a point in (u, v), where vectors have components scaled by `slopes`.
fn placed(plain: End, at: [f64; 2], slopes: [f64; 2]) -> End {
    let [along, across] = [plain.along, plain.across].map(|v| [slopes[0] * v[0], slopes[1] * v[1]]);
    End {
        at,
        along,
        across,
        ..plain
    }
}

impl Ends for RestoredEnds<'_> {
    fn end(&self, place: PicturePoint) -> End {
        let plain = self.plain(&self.fan.end(place));
        let (Uv(at), slopes) = self.even.restored(Uv(plain.at));
        placed(plain, at, slopes)
    }

    fn ends(&self, places: &[PicturePoint], out: &mut Vec<End>) {
        let first = out.len();
        self.fan.ends(places, out);
        for ends in out[first..].chunks_mut(LANES) {
            let mut places = [[0.0; LANES]; 2];
            for (lane, end) in ends.iter_mut().enumerate() {
                *end = self.plain(end);
                for (place, at) in places.iter_mut().zip(end.at) {
                    place[lane] = at;
                }
            }
            let [at, slopes] = self.even.restored_all(&places);
            for (lane, end) in ends.iter_mut().enumerate() {
                let [at, slopes] = [at, slopes].map(|both| both.map(|lanes| lanes[lane]));
                *end = placed(*end, at, slopes);
            }
        }
    }

    fn zoom(&self) -> f64 {
        self.fan.zoom()
    }

    fn origin(&self) -> [f64; 2] {
        self.even.restored(Uv(self.fan.origin())).0.0
    }

    // Beyond a full period both parameters continue alike.
    fn periods(&self) -> [f64; 2] {
        self.fan.periods()
    }

    // Only parameters that wrap are changed.
    fn bounds(&self) -> [[f64; 2]; 2] {
        self.fan.bounds()
    }
}
