//! The ends of a fan on a reparametrised surface, in the parameters of the surface itself.

use super::Reparametrised;
use crate::ends::{Coordinates, End, Ends};
use crate::fan::Fan;
use crate::point::{PicturePoint, TangentVector, Uv};

/// Ends in (u, v) alone, of a fan whose rays run in (w, v): about poles they have no coordinates of their own, since in (u, v)
/// none are smooth there.
pub struct RestoredEnds<'a> {
    even: &'a Reparametrised<'a>,
    fan: &'a Fan<'a>,
}

impl<'a> RestoredEnds<'a> {
    pub(super) fn new(even: &'a Reparametrised<'a>, fan: &'a Fan<'a>) -> Self {
        Self { even, fan }
    }

    fn restore(&self, end: &End) -> End {
        let Some(plain) = self.fan.in_coordinates(end, Coordinates::Plain) else {
            return End {
                coordinates: Coordinates::Plain,
                at: [f64::NAN; 2],
                ..*end
            };
        };
        let (Uv(at), slopes) = self.even.restored(Uv(plain.at));
        let [along, across] = [plain.along, plain.across]
            .map(|vector| TangentVector([0, 1].map(|k| slopes[k] * vector[k])).0);
        End {
            at,
            along,
            across,
            ..plain
        }
    }
}

impl Ends for RestoredEnds<'_> {
    fn end(&self, place: PicturePoint) -> End {
        self.restore(&self.fan.end(place))
    }

    fn ends(&self, places: &[PicturePoint], out: &mut Vec<End>) {
        let first = out.len();
        self.fan.ends(places, out);
        for end in &mut out[first..] {
            *end = self.restore(end);
        }
    }

    fn zoom(&self) -> f64 {
        self.fan.zoom()
    }

    fn origin(&self) -> [f64; 2] {
        self.even.restored(Uv(self.fan.origin())).0.0
    }

    // Beyond a whole turn both parameters go on by the same.
    fn periods(&self) -> [f64; 2] {
        self.fan.periods()
    }

    // Only parameters that wrap are changed.
    fn bounds(&self) -> [[f64; 2]; 2] {
        self.fan.bounds()
    }
}
