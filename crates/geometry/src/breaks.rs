//! The samples between which a curve or a surface is interrupted, at poles and jumps.
//!
//! Intervals of the guards of its formula ([`expr::Graph::guards`]) exclude breaks. Where a guard may be zero, the
//! piece between two samples is halved until the point is known, and the limits on both sides of it decide: the object
//! continues where both sides have a position and these are close (a removable singularity, as of sin t/t).

use expr::Input;
use expr::interval::Interval;
use expr::tape::{Registers, Tape};
use rayon::prelude::*;
use scene::{Object, ParamValues, Range, Sampling, Scene, Shape};

/// The numbers of halvings of a piece after which the two sides of a point are compared. Nearer to a removable
/// singularity, rounding could look like a jump, so the second and the third are used only if the first is inconclusive.
const HALVINGS: [i32; 3] = [14, 21, 28];
/// The maximum number of interval evaluations in one piece; if they do not find a break, there is none.
const MOST_EVALUATIONS: u32 = 100;
/// The maximum number of cells, of all instances together, in which breaks are sought. An object with more of them changes
/// too fast for its samples, and is treated as continuous.
pub const MOST_BREAK_CELLS: u64 = 8192;
/// The maximum number of interval evaluations to find such a cell, for each of them.
const EVALUATIONS_FOR_CELL: u64 = 64;
/// The maximum number of interval evaluations in the search for a pole within a cell.
const EVALUATIONS_WITHIN_CELL: u32 = 250;
/// The number of halvings of a cell after which the position of a pole within it is known.
const HALVINGS_TO_POLE: i32 = 44;
/// The direction in which a pole within a cell is passed, in fractions of the cell: along none of the lines about which
/// formulas are symmetric.
const WAY_PAST_POLE: [f64; 2] = [1.0, 0.7];
/// The maximum distance between the two sides of a point, as a fraction of the distance of the samples.
const MOST_STEP: f64 = 0.125;
/// The maximum distance of a side of a point from its sample, as a fraction of the distance of the samples.
const MOST_AWAY: f64 = 2.0;
/// A curve along geodesics may jump in a step that is so many times longer than those beside it.
const FAR_STEP: f64 = 3.0;
/// The minimum ratio, at a break, of one comparison to the previous one, of the distance between the sides or of the distance
/// to them.
const STEEPEST: f64 = 0.95;
/// The number of halvings of the step between samples at which a limit is sought.
const STEP_HALVINGS: i32 = 10;
/// If there is a limit, half the step changes the value by less than this fraction of the change by the whole step.
const STEADY: f64 = 0.75;
/// The relative accuracy of a limit's coordinates.
const SLACK: f64 = 1e-6;
/// Points within this fraction of their coordinates are the same.
const ROUNDING: f64 = 1e-9;

/// A point between samples at which an object is interrupted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Break {
    /// The grid position of the first sample of the cell: a curve is interrupted between it and the next one, a surface on
    /// a side of the cell, or at a pole within it.
    pub first: [u32; 2],
    /// True if the object is unbounded near it.
    pub is_pole: bool,
}

/// The places at which an instance is interrupted.
#[derive(Clone, Debug, Default)]
pub struct Interruptions {
    /// The breaks between samples, in ascending order.
    pub breaks: Vec<Break>,
    /// The grid positions of the samples that are poles, in ascending order: the instance is unbounded near them, and
    /// undefined at them. Where it has a value there only because the pole is between numbers of f64, as of tan t at the
    /// number next to π/2, that is no place of it.
    pub poles: Vec<[u32; 2]>,
}

/// Finds the breaks of an object.
#[derive(Debug)]
pub struct Breaks {
    guards: Tape,
    position: Tape,
    /// The maximum number of cells of an instance.
    most_cells: u64,
}

/// Returns the samples of a curve along geodesics between which and the next ones it jumps: where a geodesic passes a seam of its
/// surface, its coordinates jump. Intervals do not bound these; only steps that are far longer than those beside them are
/// examined. `places` are the samples in any unit of length; `None` where the curve is undefined.
pub fn jumps_along_geodesics(
    scene: &Scene,
    object: &Object,
    domain: &Sampling,
    uniforms: &[f64],
    places: &[Option<[f64; 3]>],
) -> Vec<u32> {
    let step = |k: usize| match (places.get(k), places.get(k + 1)) {
        (Some(Some(a)), Some(Some(b))) => distance(*a, *b),
        _ => 0.0,
    };
    let is_far = |k: &usize| {
        let beside = k.checked_sub(1).map_or(0.0, step).max(step(k + 1));
        step(*k) > FAR_STEP * beside
    };
    let far = (0..places.len()).filter(is_far).map(|k| k as u32);
    far.filter(|&k| {
        let ends = [k, k + 1].map(|k| domain.value(k));
        jumps_between(scene, object, uniforms, ends)
    })
    .collect()
}

/// Returns true if a curve along geodesics jumps between two of its parameters. The piece is halved where the curve moves
/// farther.
fn jumps_between(scene: &Scene, object: &Object, uniforms: &[f64], ends: [f64; 2]) -> bool {
    let Some(position) = object.shape.position() else {
        return false;
    };
    let tape = Tape::new(&scene.graph, position);
    let mut registers = Registers::default();
    let mut place = |t: f64| {
        let variables = scene.curve_variables(&object.shape, uniforms, t);
        let inputs = tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&variables, uniforms)).collect();
        let mut out = [f64::NAN; 3];
        tape.eval(&mut registers, &inputs, &mut out);
        out.iter().all(|x| x.is_finite()).then_some(out)
    };
    let [Some(mut low), Some(mut high)] = ends.map(&mut place) else {
        return false;
    };
    let whole = distance(low, high);
    let [mut from, mut to] = ends;
    for _ in 0..HALVINGS[0] {
        let t = 0.5 * (from + to);
        let Some(middle) = place(t) else {
            return false;
        };
        match distance(low, middle) > distance(middle, high) {
            true => (to, high) = (t, middle),
            false => (from, low) = (t, middle),
        }
    }
    distance(low, high) > MOST_STEP * whole
}

impl Breaks {
    /// Returns the search for the breaks of an object; `None` if it is neither a curve nor a surface, if it is
    /// continuous wherever it is defined, or if it needs values of geodesics.
    pub fn of(scene: &Scene, params: &ParamValues, object: &Object) -> Option<Self> {
        let (Shape::Curve { position, .. } | Shape::Surface { position, .. }) = &object.shape
        else {
            return None;
        };
        if !object.shape.followed().is_empty() {
            return None;
        }
        let (mut graph, roots) = scene.graph.extract(position);
        let guards = graph.guards(&roots);
        (!guards.is_empty()).then(|| Self {
            guards: Tape::new(&graph, &guards),
            position: Tape::new(&graph, &roots),
            most_cells: MOST_BREAK_CELLS / params.instance_count(scene, object).max(1),
        })
    }

    /// Returns where an instance is interrupted; `None` if it changes too fast for its samples. `domain` is that of the
    /// object, and `uniforms` are those of [`scene::ParamValues::instance`].
    pub fn find(&self, domain: &[Sampling], uniforms: &[f64]) -> Option<Interruptions> {
        let cells = self
            .search(uniforms)
            .cells([domain.first(), domain.get(1)])?;
        let value = |at: [u32; 2]| [0, 1].map(|k| domain.get(k).map_or(0.0, |it| it.value(at[k])));
        let of_cell = |&[i, j]: &[u32; 2]| {
            let mut search = self.search(uniforms);
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let sides = if domain.len() == 1 { 1 } else { 4 };
            let sides = (0..sides).map(|k| [corners[k], corners[(k + 1) % 4]]);
            let found = sides.filter_map(|side| search.break_between(side.map(value)));
            let is_pole = found.reduce(|a, b| a || b);
            let mut has_pole = || {
                let [low, high] = [[i, j], [i + 1, j + 1]].map(value);
                domain.len() == 2 && search.has_pole_within([0, 1].map(|k| [low[k], high[k]]))
            };
            Some(Break {
                first: [i, j],
                is_pole: is_pole.or_else(|| has_pole().then_some(true))?,
            })
        };
        let mut breaks: Vec<Break> = cells.par_iter().filter_map(of_cell).collect();
        breaks.sort_unstable_by_key(|it| [it.first[1], it.first[0]]);
        let corners = cells.iter().flat_map(|&[i, j]| {
            let corners = [[i, j], [i + 1, j], [i, j + 1], [i + 1, j + 1]];
            corners.into_iter().take(2 * domain.len())
        });
        let mut samples: Vec<[u32; 2]> = corners.collect();
        samples.sort_unstable();
        samples.dedup();
        let is_pole = |sample: &[u32; 2]| self.search(uniforms).is_pole_at(domain, *sample);
        let poles = samples.into_par_iter().filter(is_pole).collect();
        Some(Interruptions { breaks, poles })
    }

    /// Returns the limits of the undefined samples of an instance that have one, with their indices; the first parameter
    /// varies fastest.
    pub fn limits(
        &self,
        domain: &[Sampling],
        uniforms: &[f64],
        is_undefined: impl Fn(usize) -> bool,
    ) -> Vec<(usize, [f64; 3])> {
        let counts = [0, 1].map(|k| domain.get(k).map_or(1, |it| it.count as usize));
        let undefined = (0..counts[0] * counts[1]).filter(|index| is_undefined(*index));
        let limit = |index: usize| {
            let grid = [index % counts[0], index / counts[0]];
            let at = [0, 1].map(|k| domain.get(k).map_or(0.0, |it| it.value(grid[k] as u32)));
            Some((index, self.limit(domain, uniforms, at)?))
        };
        undefined.filter_map(limit).collect()
    }

    /// Returns the limit of an instance at parameters at which it is undefined, if it exists, as for a formula such as
    /// sin t/t.
    pub fn limit(&self, domain: &[Sampling], uniforms: &[f64], at: [f64; 2]) -> Option<[f64; 3]> {
        let mut search = self.search(uniforms);
        if search.is_continuous(at.map(|x| [x; 2])) {
            return None;
        }
        let mut limit: Option<[f64; 3]> = None;
        for (axis, sampling) in domain.iter().enumerate() {
            let Range { min, max } = sampling.range;
            let step = (max - min) / f64::from(sampling.count - 1) * f64::powi(0.5, STEP_HALVINGS);
            let mut sides = |step: f64| {
                let side = |step: f64| {
                    let mut at = at;
                    at[axis] += step;
                    search.place(at)
                };
                let [before, behind] = [-step, step].map(side);
                Some([before?, behind?])
            };
            let Some(all) = [1.0, 2.0, 4.0]
                .map(|k| sides(k * step))
                .into_iter()
                .collect()
            else {
                continue;
            };
            let all: Vec<[[f64; 3]; 2]> = all;
            let middle = |[a, b]: [[f64; 3]; 2]| [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]));
            let [near, next, far] = [0, 1, 2].map(|k| middle(all[k]));
            let slack = SLACK * (1.0 + distance(near, [0.0; 3]));
            // Both sides approach each other, and the point between them converges.
            let meets =
                distance(all[0][0], all[0][1]) <= STEADY * distance(all[1][0], all[1][1]) + slack;
            let rests = distance(near, next) <= STEADY * distance(next, far) + slack;
            if !(meets && rests) || limit.is_some_and(|other| distance(other, near) > slack) {
                return None;
            }
            limit = limit.or(Some(near));
        }
        limit
    }

    /// Returns whether an instance may be interrupted anywhere.
    pub fn may_occur(&self, domain: &[Sampling], uniforms: &[f64]) -> bool {
        let ends = [0, 1].map(|k| {
            domain
                .get(k)
                .map_or([0.0; 2], |it| [it.range.min, it.range.max])
        });
        !self.search(uniforms).is_continuous(widened(ends))
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
    /// Returns the cells of the grid, by the positions of their first samples, in which a guard may be zero; `None` if there
    /// are too many.
    fn cells(&mut self, domain: [Option<&Sampling>; 2]) -> Option<Vec<[u32; 2]>> {
        let mut found = Vec::new();
        let mut evaluations = EVALUATIONS_FOR_CELL * self.breaks.most_cells;
        let mut boxes = vec![domain.map(|domain| [0, domain.map_or(1, |it| it.count - 1)])];
        while let Some(cell) = boxes.pop() {
            let ends = [0, 1].map(|k| {
                let value = |index| domain[k].map_or(0.0, |domain| domain.value(index));
                cell[k].map(value)
            });
            if evaluations == 0 {
                return None;
            }
            evaluations -= 1;
            if self.is_continuous(widened(ends)) {
                continue;
            }
            let sizes = cell.map(|[first, last]| last - first);
            let longer = usize::from(sizes[1] > sizes[0]);
            let [first, last] = cell[longer];
            if last - first <= 1 {
                if found.len() as u64 == self.breaks.most_cells {
                    return None;
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
        Some(found)
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

    /// Returns the object's position at parameters, if it is defined there.
    fn place(&mut self, at: [f64; 2]) -> Option<[f64; 3]> {
        let place = self.value(at);
        place.iter().all(|x| x.is_finite()).then_some(place)
    }

    /// Returns the coordinates of the object at parameters, which may be infinite or NaN.
    fn value(&mut self, at: [f64; 2]) -> [f64; 3] {
        let position = &self.breaks.position;
        let inputs = position.inputs().iter().map(|input| self.input(input, at));
        let inputs: Vec<f64> = inputs.collect();
        let mut out = [f64::NAN; 3];
        position.eval(&mut self.registers, &inputs, &mut out);
        out
    }

    /// Returns whether the object is undefined at a sample, or may be at a number next to it, and unbounded on a way to it.
    fn is_pole_at(&mut self, domain: &[Sampling], sample: [u32; 2]) -> bool {
        let at = [0, 1].map(|k| domain.get(k).map_or(0.0, |it| it.value(sample[k])));
        if self.place(at).is_some() && self.is_continuous(widened(at.map(|x| [x; 2]))) {
            return false;
        }
        let neighbours = (0..domain.len()).flat_map(|axis| {
            let last = domain[axis].count - 1;
            let before = sample[axis].checked_sub(1);
            let behind = Some(sample[axis] + 1).filter(|index| *index <= last);
            let others = [before, behind].into_iter().flatten();
            others.map(move |index| (axis, domain[axis].value(index)))
        });
        neighbours.into_iter().any(|(axis, from)| {
            let seen = HALVINGS.map(|n| {
                let mut near = at;
                near[axis] += f64::powi(0.5, n) * (from - at[axis]);
                self.value(near)
            });
            // An exponential function of a pole overflows before it.
            if seen[0].iter().any(|x| x.is_infinite()) {
                return true;
            }
            let is_defined = seen.iter().flatten().all(|x| x.is_finite());
            is_defined && goes_away(seen, rounding([seen[1], seen[2]]))
        })
    }

    /// Returns whether there is a break between two samples at which the object is defined, and whether it is a pole.
    fn break_between(&mut self, samples: [[f64; 2]; 2]) -> Option<bool> {
        let [first, last] = samples.map(|at| self.place(at));
        let ends: Sides = [first?, last?];
        let at =
            |share: f64| [0, 1].map(|k| samples[0][k] + share * (samples[1][k] - samples[0][k]));
        let widths = HALVINGS.map(|n| f64::powi(0.5, n));
        let mut parts: Vec<([f64; 2], [Option<Sides>; 2])> = vec![([0.0, 1.0], [None; 2])];
        let mut evaluations = 0;
        while let Some(([from, to], mut seen)) = parts.pop() {
            evaluations += 1;
            if evaluations > MOST_EVALUATIONS {
                return None;
            }
            let (a, b) = (at(from), at(to));
            let part = [0, 1].map(|k| [a[k].min(b[k]), a[k].max(b[k])]);
            if self.is_continuous(part) {
                continue;
            }
            let width = to - from;
            if width <= widths[seen.iter().flatten().count()] {
                let sides = [(from - width).max(0.0), (to + width).min(1.0)];
                let [before, behind] = sides.map(|share| self.place(at(share)));
                let (Some(before), Some(behind)) = (before, behind) else {
                    return Some(true);
                };
                let sides = [before, behind];
                seen = match seen {
                    [None, _] if !is_doubtful(ends, sides) => continue,
                    [None, _] => [Some(sides), None],
                    [first, None] => [first, Some(sides)],
                    [Some(first), Some(next)] => match kind_of_break([first, next, sides]) {
                        None => continue,
                        kind => return kind,
                    },
                };
            }
            let middle = 0.5 * (from + to);
            parts.extend([([middle, to], seen), ([from, middle], seen)]);
        }
        None
    }

    /// Returns whether a surface is unbounded at a point within a cell, given as the ends of both parameters.
    fn has_pole_within(&mut self, cell: [[f64; 2]; 2]) -> bool {
        let mut parts = vec![(cell, 0)];
        for _ in 0..EVALUATIONS_WITHIN_CELL {
            let Some((part, halvings)) = parts.pop() else {
                return false;
            };
            if self.is_continuous(part) {
                continue;
            }
            let middle = part.map(|[low, high]| 0.5 * (low + high));
            if halvings == HALVINGS_TO_POLE {
                return self.is_pole(middle, cell);
            }
            let halves = [0, 1].map(|k| [[part[k][0], middle[k]], [middle[k], part[k][1]]]);
            parts.extend(
                halves[1]
                    .iter()
                    .flat_map(|&v| halves[0].map(|u| ([u, v], halvings + 1))),
            );
        }
        false
    }

    /// Returns whether a surface is unbounded at a point in a cell.
    fn is_pole(&mut self, at: [f64; 2], cell: [[f64; 2]; 2]) -> bool {
        let seen = HALVINGS.map(|halvings| {
            let share = f64::powi(0.5, halvings);
            let way = [0, 1].map(|k| share * WAY_PAST_POLE[k] * (cell[k][1] - cell[k][0]));
            let side = |sign: f64| [0, 1].map(|k| at[k] + sign * way[k]);
            Some([self.place(side(-1.0))?, self.place(side(1.0))?])
        });
        let [Some(first), Some(next), Some(last)] = seen else {
            return false;
        };
        let [us, vs] = cell;
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| self.place([us[i], vs[j]]));
        let defined: Vec<[f64; 3]> = corners.into_iter().flatten().collect();
        let ways = defined.iter().zip(defined.iter().skip(1));
        let size = ways.map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
        // One side of a jump agrees with itself far from the jump; near it, it differs by the error of the jump's location.
        distance(first[0], next[0]) > MOST_STEP * size
            && kind_of_break([first, next, last]) == Some(true)
    }
}

/// Returns a box of the parameters with the numbers of f64 next to it: a pole at a number that f64 cannot represent, such
/// as π/2, may be on either side of the nearest one.
fn widened(ends: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    ends.map(|[from, to]| [from.next_down(), to.next_up()])
}

/// The positions of an object on both sides of a parameter.
type Sides = [[f64; 3]; 2];

/// Returns whether there may be a break between two samples, where `sides` are the positions on both sides of it.
fn is_doubtful(ends: Sides, sides: Sides) -> bool {
    let (apart, slack) = (distance(ends[0], ends[1]), rounding(ends));
    let away = [0, 1].map(|k| distance(sides[k], ends[k]));
    distance(sides[0], sides[1]) > MOST_STEP * apart + slack
        || away[0].max(away[1]) > MOST_AWAY * apart + slack
}

/// Returns whether there is a break, and whether it is a pole, from the positions `seen` on both sides, nearer and nearer to
/// it. A continuous object, however steep, converges there.
fn kind_of_break(seen: [Sides; 3]) -> Option<bool> {
    let [first, next, last] = seen;
    let slack = rounding(last);
    let gap = |sides: Sides| distance(sides[0], sides[1]);
    if [0, 1].map(|k| goes_away([first[k], next[k], last[k]], slack)) != [false; 2] {
        return Some(true);
    }
    goes_on([gap(next), gap(last)], slack).then_some(false)
}

/// Returns whether positions nearer and nearer to a point do not converge.
fn goes_away([first, next, last]: [[f64; 3]; 3], slack: f64) -> bool {
    goes_on([distance(first, next), distance(next, last)], slack)
}

/// Returns whether a distance does not vanish nearer to a point.
fn goes_on([before, then]: [f64; 2], slack: f64) -> bool {
    then > slack && then >= STEEPEST * before
}

/// Returns the distance up to which points of this magnitude are the same.
fn rounding([a, b]: Sides) -> f64 {
    ROUNDING * (distance(a, [0.0; 3]) + distance(b, [0.0; 3]))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).fold(0.0, |all: f64, k| all.hypot(a[k] - b[k]))
}
