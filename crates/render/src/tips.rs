//! Tips of solids between rays, which the rays miss.
//!
//! In: points on a solid found by a grid of rays. Out: the tips that extend farther than the margin of a picture covers.
//! From the point that is farthest in a direction, points around it are tried at decreasing distances.

use glam::{DAffine3, DMat3, DVec3};
use tracer::{BoundingBox, Caster, Crossing, Ray};

/// A tip counts if it extends the range of the points along its direction by this fraction: half of it is slightly less than
/// [`crate::style::MARGIN`].
const REACH: f64 = 0.0375;
/// A point has no tip beside it if the component of its unit normal along the direction exceeds this.
const BLUNT: f64 = 0.95;
/// The number of times that the distance of the tried points is halved.
const HALVINGS: i32 = 14;
/// After this many halvings, a search that has gained less than [`LITTLE`] of a cell ends.
const FIRST: i32 = 3;
const LITTLE: f64 = 0.1;
/// The maximum number of steps of a search.
const STEPS: usize = 40;

/// Returns the tips of a solid in a box. Its points were found by `in_a_row` rays in each row; `operations` limits the work.
pub(crate) fn tips(
    caster: &mut Caster<'_>,
    bounds: &BoundingBox,
    found: &[Crossing],
    in_a_row: usize,
    operations: u64,
) -> Vec<DVec3> {
    let half = 0.5 * (bounds.upper - bounds.lower);
    if !half.cmpgt(DVec3::ZERO).all() {
        return Vec::new();
    }
    let frame = DAffine3::from_mat3_translation(DMat3::from_diagonal(half), bounds.centre());
    let into = frame.inverse();
    let places = found.iter().map(|crossing| {
        let normal = (half * crossing.normal).normalize_or_zero();
        (into.transform_point3(crossing.position), normal)
    });
    let places: Vec<[DVec3; 2]> = places
        .filter(|(place, _)| place.is_finite())
        .map(|(place, normal)| [place, normal])
        .collect();
    let mut search = TipSearch {
        caster,
        frame,
        cell: 2.0 / in_a_row as f64,
        operations,
    };
    let mut tips = Vec::new();
    for direction in directions() {
        let along = |[place, _]: &&[DVec3; 2]| place.dot(direction);
        let by = |a: &&[DVec3; 2], b: &&[DVec3; 2]| along(a).total_cmp(&along(b));
        let ends = places.iter().min_by(by).zip(places.iter().max_by(by));
        let Some((least, most)) = ends else {
            break;
        };
        if most[1].dot(direction).abs() > BLUNT {
            continue;
        }
        let tip = search.tip(most[0], direction);
        let [low, high, reached] = [least[0], most[0], tip].map(|place| place.dot(direction));
        if reached - high > REACH * (high - low) {
            tips.push(frame.transform_point3(tip));
        }
    }
    tips
}

/// Returns the unit directions to the centres of the sides of a cube, to those of its edges, and to its corners.
fn directions() -> impl Iterator<Item = DVec3> {
    let signs = || [-1.0, 0.0, 1.0].into_iter();
    let all = signs().flat_map(move |x| signs().map(move |y| [x, y]));
    let all = all.flat_map(move |[x, y]| signs().map(move |z| DVec3::new(x, y, z)));
    all.filter_map(DVec3::try_normalize)
}

/// Searches for tips in a frame in which the box extends from −1 to 1.
struct TipSearch<'a, 'w> {
    caster: &'a mut Caster<'w>,
    frame: DAffine3,
    /// The distance between rays.
    cell: f64,
    operations: u64,
}

impl TipSearch<'_, '_> {
    /// Returns the farthest point in a direction that is found near a point of the solid.
    fn tip(&mut self, from: DVec3, direction: DVec3) -> DVec3 {
        let (a, b) = direction.any_orthonormal_pair();
        let straight = [a, b, -a, -b];
        let oblique = [a + b, a - b, -a + b, -a - b];
        let (mut tip, mut halvings) = (from, 1);
        for _ in 0..STEPS {
            let height = tip.dot(direction);
            let little = LITTLE * self.cell;
            let is_blunt = halvings > FIRST && height - from.dot(direction) < little;
            if is_blunt || halvings > HALVINGS || self.caster.operations() > self.operations {
                break;
            }
            let step = self.cell * 0.5_f64.powi(halvings);
            let mut best = tip;
            for aside in straight.into_iter().chain(oblique) {
                let place = self.highest(tip + step * aside, direction);
                if let Some(place) = place
                    && place.dot(direction) > best.dot(direction)
                {
                    best = place;
                }
            }
            if best.dot(direction) - height < 1e-3 * self.cell {
                halvings += 1;
            }
            tip = best;
        }
        tip
    }

    /// Returns the farthest point of the solid in a direction on a line of that direction.
    fn highest(&mut self, beside: DVec3, direction: DVec3) -> Option<DVec3> {
        let above = beside + (2.0 - beside.dot(direction)) * direction;
        let ray = Ray {
            origin: self.frame.transform_point3(above),
            direction: self.frame.transform_vector3(-direction),
            leaving: None,
        };
        let met = self.caster.first(&ray)?;
        let place = above - met.t * direction;
        place.is_finite().then_some(place)
    }
}
