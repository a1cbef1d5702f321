//! The proportions of a surface: which of its coordinate lines are much longer than the others.
//!
//! They decide the number of cells of the image that shows orientation. The params have their initial values, so that the
//! cells stay while a slider moves.

use expr::tape::{Registers, Tape};
use scene::{Object, ParamValues, Sampling, Scene};

/// The sides of a surface's domain, by the lengths of the coordinate lines.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Proportions {
    /// Neither is much longer.
    Even,
    /// The lines along u are much longer.
    LongAlongU,
    /// The lines along v are much longer.
    LongAlongV,
}

/// Lines are much longer than others if they are more than this many times as long: the names in the cells of an even
/// surface can be read up to about this ratio, as on a Möbius strip that is eight times as long as wide.
const MUCH: f64 = 9.0;
/// The number of cells along either side of an even surface, along the long side of another one and along its short side.
const CELLS: u32 = 8;
pub(super) const MOST_CELLS: u32 = 24;
const FEWEST_CELLS: u32 = 3;
/// The number of places along u and along v where the lengths are compared.
const PLACES: u32 = 8;
/// The distance between points that measure a length, as a fraction of the domain's side.
const STEP: f64 = 1e-4;

impl Proportions {
    /// Returns the proportions of the first instance of a surface or metric with the initial values of the params: the
    /// median over its domain, since a pole may have lines of any length.
    pub(crate) fn of(scene: &Scene, object: &Object) -> Self {
        let mut ratios = ratios(scene, object);
        ratios.retain(|ratio| *ratio > 0.0 && ratio.is_finite());
        ratios.sort_unstable_by(f64::total_cmp);
        match ratios.get(ratios.len() / 2) {
            Some(&ratio) if ratio > MUCH => Self::LongAlongU,
            Some(&ratio) if ratio * MUCH < 1.0 => Self::LongAlongV,
            _ => Self::Even,
        }
    }

    /// Returns the number of cells along u and along v.
    pub(super) fn cells(self) -> [u32; 2] {
        match self {
            Self::Even => [CELLS; 2],
            Self::LongAlongU => [MOST_CELLS, FEWEST_CELLS],
            Self::LongAlongV => [FEWEST_CELLS, MOST_CELLS],
        }
    }
}

/// Returns the ratio of the lengths of the domain's sides along u and along v at each of some places, as there.
fn ratios(scene: &Scene, object: &Object) -> Vec<f64> {
    let shape = &object.shape;
    let (roots, domain) = match (shape.surface(), shape.metric()) {
        (Some((position, domain)), _) => (position, domain),
        (None, Some((components, domain))) => (components, domain),
        (None, None) => return Vec::new(),
    };
    let tape = Tape::new(&scene.graph, roots);
    let uniforms = ParamValues::initial(scene).first_instance(scene, object);
    let mut registers = Registers::default();
    let mut values = |at: [f64; 2]| {
        let inputs = tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&at, &uniforms)).collect();
        let mut out = [0.0; 3];
        tape.eval(&mut registers, &inputs, &mut out);
        out
    };
    let value =
        |axis: &Sampling, share: f64| axis.range.min + share * (axis.range.max - axis.range.min);
    let share = |k: u32| (f64::from(k) + 0.5) / f64::from(PLACES);
    let places = (0..PLACES).flat_map(|j| (0..PLACES).map(move |i| [share(i), share(j)]));
    let ratio = |[u, v]: [f64; 2]| {
        let mut at = |u: f64, v: f64| values([value(&domain[0], u), value(&domain[1], v)]);
        let here = at(u, v);
        if shape.is_metric() {
            let [e, _, g] = here;
            let [width, height] = [0, 1].map(|k| domain[k].range.max - domain[k].range.min);
            return (e / g).sqrt() * width / height;
        }
        let distance = |to: [f64; 3]| {
            let [x, y, z] = [0, 1, 2].map(|k| to[k] - here[k]);
            x.hypot(y).hypot(z)
        };
        distance(at(u + STEP, v)) / distance(at(u, v + STEP))
    };
    places.map(ratio).collect()
}
