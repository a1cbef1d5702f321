//! Tips of solids that rays between them miss.
//!
//! Input: places on a solid that rays find, so many in a row. Output: the tips that reach further than the margin of a
//! picture covers. From the place that lies furthest in a direction, places around it are tried, nearer and nearer.

use glam::{DAffine3, DMat3, DVec3};
use tracer::{BoundingBox, Caster, Crossing, Ray};

/// A tip counts where it reaches further by this share of the length of the places along its direction: half of it is a
/// little less than [`crate::style::MARGIN`].
const REACH: f64 = 0.0375;
/// A place whose unit normal leads so far along the direction has no tip beside it.
const BLUNT: f64 = 0.95;
/// The halvings of the distance at which places are tried.
const HALVINGS: i32 = 14;
/// After so many, a search that has gained less than [`LITTLE`] of a cell ends.
const FIRST: i32 = 3;
const LITTLE: f64 = 0.1;
/// The most steps of a search.
const STEPS: usize = 40;

/// The tips of a solid in a box, whose places were found by so many rays in a row; at most so many operations are done.
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
    let frame = DAffine3::from_mat3_translation(DMat3::from_diagonal(half), bounds.center());
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

/// The unit directions to the middles of the sides of a cube, to those of its edges, and to its corners.
fn directions() -> impl Iterator<Item = DVec3> {
    let signs = || [-1.0, 0.0, 1.0].into_iter();
    let all = signs().flat_map(move |x| signs().map(move |y| [x, y]));
    let all = all.flat_map(move |[x, y]| signs().map(move |z| DVec3::new(x, y, z)));
    all.filter_map(DVec3::try_normalize)
}

/// Looks for tips in a frame in which the box is from −1 to 1.
struct TipSearch<'a, 'w> {
    caster: &'a mut Caster<'w>,
    frame: DAffine3,
    /// The distance of rays.
    cell: f64,
    operations: u64,
}

impl TipSearch<'_, '_> {
    /// The place that is found to lie furthest in a direction, near one on the solid.
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

    /// The place on the solid that lies furthest in a direction, on a line of that direction.
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
