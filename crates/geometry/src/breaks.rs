//! The samples between which a curve or a surface breaks off, at poles and jumps.
//!
//! Intervals of the guards of its formula ([`expr::Graph::guards`]) say where there is none. Where one may be zero, the
//! piece between two samples is halved until the place is known, and what lies on both sides of it decides: the object
//! goes on where both sides have a place and these are near each other (a removable singularity, as of sin t/t).

use expr::interval::Interval;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input};
use rayon::prelude::*;
use scene::{Object, ParamValues, Sampling, Scene, Shape};

/// The number of times that a piece is halved. Nearer to a removable singularity, rounding could look like a jump.
const HALVINGS: i32 = 14;
/// The most evaluations on intervals in one piece; where they do not find its break, it has none.
const MOST_EVALUATIONS: u32 = 100;
/// The most cells of all instances together in which breaks are looked for. An object with more of them changes faster than
/// its samples can tell, and breaks off nowhere.
pub const MOST_BREAK_CELLS: u64 = 8192;
/// The most evaluations on intervals that look for such a cell, for each of them.
const EVALUATIONS_FOR_CELL: u64 = 64;
/// The largest distance of the two sides of the place, as a share of the distance of the samples.
const MOST_STEP: f64 = 0.125;
/// The largest distance of a side of the place from its sample, as a share of the distance of the samples.
const MOST_AWAY: f64 = 2.0;
/// Places within this share of their coordinates are one.
const ROUNDING: f64 = 1e-9;

/// Finds the breaks of an object.
#[derive(Debug)]
pub struct Breaks {
    guards: Tape,
    position: Tape,
    /// The most cells of an instance.
    most_cells: u64,
}

impl Breaks {
    /// Returns what finds the breaks of an object; `None` if it is no curve and no surface, or one that is continuous
    /// wherever it is defined, or that needs values of geodesics.
    pub fn of(scene: &Scene, params: &ParamValues, object: &Object) -> Option<Self> {
        let (Shape::Curve { position, .. } | Shape::Surface { position, .. }) = &object.shape
        else {
            return None;
        };
        if !object.shape.followed().is_empty() {
            return None;
        }
        let (mut graph, roots): (Graph, _) = scene.graph.extract(position);
        let guards = graph.guards(&roots);
        (!guards.is_empty()).then(|| Self {
            guards: Tape::new(&graph, &guards),
            position: Tape::new(&graph, &roots),
            most_cells: MOST_BREAK_CELLS / params.instance_count(scene, object).max(1),
        })
    }

    /// Returns the indices, ascending, of the samples of a curve behind which an instance breaks off before the next
    /// one. `uniforms` are those of [`scene::ParamValues::instance`].
    pub fn along(&self, domain: &Sampling, uniforms: &[f64]) -> Vec<u32> {
        let mut search = self.search(uniforms);
        let cells = search.cells([Some(domain), None]);
        let cells = cells.into_iter().map(|[index, _]| index);
        cells
            .filter(|index| {
                search.breaks_between([*index, index + 1].map(|i| [domain.value(i), 0.0]))
            })
            .collect()
    }

    /// Returns the pairs of neighbouring samples of a surface, by their places in the grid, between which an instance
    /// breaks off. `uniforms` are those of [`scene::ParamValues::instance`].
    pub fn between(&self, domain: &[Sampling; 2], uniforms: &[f64]) -> Vec<[[u32; 2]; 2]> {
        let cells = self.search(uniforms).cells(domain.each_ref().map(Some));
        let value = |at: [u32; 2]| [0, 1].map(|k| domain[k].value(at[k]));
        let of_cell = |[i, j]: [u32; 2]| {
            let mut search = self.search(uniforms);
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let sides = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]);
            let breaks = sides.filter(|side| search.breaks_between(side.map(value)));
            breaks.collect::<Vec<_>>()
        };
        cells.into_par_iter().flat_map_iter(of_cell).collect()
    }

    /// Returns whether an instance may break off anywhere.
    pub fn may_occur(&self, domain: &[Sampling], uniforms: &[f64]) -> bool {
        let ends = [0, 1].map(|k| {
            domain
                .get(k)
                .map_or([0.0; 2], |it| [it.range.min, it.range.max])
        });
        !self.search(uniforms).is_continuous(ends)
    }

    fn search<'a>(&'a self, uniforms: &'a [f64]) -> BreakSearch<'a> {
        BreakSearch {
            breaks: self,
            uniforms,
            registers: Registers::default(),
        }
    }
}

/// The search in one instance.
struct BreakSearch<'a> {
    breaks: &'a Breaks,
    uniforms: &'a [f64],
    registers: Registers,
}

impl BreakSearch<'_> {
    /// Returns the cells of the grid, by the places of their first samples, in which a guard may be zero; none if there are
    /// too many.
    fn cells(&mut self, domain: [Option<&Sampling>; 2]) -> Vec<[u32; 2]> {
        let mut found = Vec::new();
        let mut evaluations = EVALUATIONS_FOR_CELL * self.breaks.most_cells;
        let mut boxes = vec![domain.map(|domain| [0, domain.map_or(1, |it| it.count - 1)])];
        while let Some(cell) = boxes.pop() {
            let ends = [0, 1].map(|k| {
                let value = |index| domain[k].map_or(0.0, |domain| domain.value(index));
                cell[k].map(value)
            });
            if evaluations == 0 {
                return Vec::new();
            }
            evaluations -= 1;
            if self.is_continuous(ends) {
                continue;
            }
            let sizes = cell.map(|[first, last]| last - first);
            let longer = usize::from(sizes[1] > sizes[0]);
            let [first, last] = cell[longer];
            if last - first <= 1 {
                if found.len() as u64 == self.breaks.most_cells {
                    return Vec::new();
                }
                found.push(cell.map(|[first, _]| first));
                continue;
            }
            let middle = first + (last - first) / 2;
            for half in [[middle, last], [first, middle]] {
                let mut part = cell;
                part[longer] = half;
                boxes.push(part);
            }
        }
        found
    }

    fn input(&self, input: &Input, at: [f64; 2]) -> f64 {
        match *input {
            Input::Variable(k) => at[k as usize],
            Input::Uniform(k) => self.uniforms[k as usize],
        }
    }

    /// Returns whether no guard is zero in a box of the parameters.
    fn is_continuous(&mut self, ends: [[f64; 2]; 2]) -> bool {
        let guards = &self.breaks.guards;
        let inputs = guards.inputs().iter().map(|input| match *input {
            Input::Variable(k) => {
                let [from, to] = ends[k as usize];
                Interval::new(from, to)
            }
            Input::Uniform(k) => Interval::point(self.uniforms[k as usize]),
        });
        let inputs: Vec<Interval> = inputs.collect();
        let mut out = vec![Interval::UNDEFINED; guards.root_count()];
        guards.eval_intervals(&mut self.registers, &inputs, &mut out);
        !out.iter().any(|guard| guard.contains(0.0))
    }

    /// Returns the object's place at parameters, if it has one.
    fn place(&mut self, at: [f64; 2]) -> Option<[f64; 3]> {
        let position = &self.breaks.position;
        let inputs = position.inputs().iter().map(|input| self.input(input, at));
        let inputs: Vec<f64> = inputs.collect();
        let mut out = [f64::NAN; 3];
        position.eval(&mut self.registers, &inputs, &mut out);
        out.iter().all(|x| x.is_finite()).then_some(out)
    }

    /// Returns whether the object breaks off between two samples, at both of which it is defined.
    fn breaks_between(&mut self, samples: [[f64; 2]; 2]) -> bool {
        let [Some(first), Some(last)] = samples.map(|at| self.place(at)) else {
            return false;
        };
        let size = distance(first, [0.0; 3]) + distance(last, [0.0; 3]);
        let (apart, slack) = (distance(first, last), ROUNDING * size);
        let at =
            |share: f64| [0, 1].map(|k| samples[0][k] + share * (samples[1][k] - samples[0][k]));
        let least = f64::powi(0.5, HALVINGS);
        let mut parts = vec![[0.0, 1.0]];
        let mut evaluations = 0;
        while let Some([from, to]) = parts.pop() {
            evaluations += 1;
            if evaluations > MOST_EVALUATIONS {
                return false;
            }
            let (a, b) = (at(from), at(to));
            let ends = [0, 1].map(|k| [a[k].min(b[k]), a[k].max(b[k])]);
            if self.is_continuous(ends) {
                continue;
            }
            if to - from > least {
                let middle = 0.5 * (from + to);
                parts.extend([[middle, to], [from, middle]]);
                continue;
            }
            let sides = [(from - least).max(0.0), (to + least).min(1.0)];
            let goes_on = match sides.map(|share| self.place(at(share))) {
                [Some(before), Some(behind)] => {
                    let away = distance(before, first).max(distance(behind, last));
                    distance(before, behind) <= MOST_STEP * apart + slack
                        && away <= MOST_AWAY * apart + slack
                }
                _ => false,
            };
            if !goes_on {
                return true;
            }
        }
        false
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).fold(0.0, |all: f64, k| all.hypot(a[k] - b[k]))
}
