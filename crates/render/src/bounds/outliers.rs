//! The outliers among an object's coarse places, such as the slopes that lead to a pole.

use geometry::Breaks;
use scene::{Object, ParamValues, Sampling, Scene};

/// The measure of outliers.
struct Measure {
    /// The inner box of a branch excludes this share of its samples at each end.
    outer: f64,
    /// The object's box reaches so many times the average size of the inner boxes beyond them; what lies further is an outlier
    /// and does not shrink the rest of the picture. A short branch may be all slope: its own size says little.
    reach: f64,
    /// If the box of all samples is at most this many times as long, no sample is an outlier.
    most: f64,
}

/// An object that may have a place where it has no bound.
const USUAL: Measure = Measure {
    outer: 0.02,
    reach: 2.0,
    most: 1.0,
};
/// An object with poles. A steep one takes many samples; near a slow one, as of log t, none is far away.
const WITH_POLES: Measure = Measure {
    outer: 1.0 / 3.0,
    reach: 3.0,
    most: 2.0,
};
/// The number of an object's instances that are searched for poles.
const SEARCHED: u64 = 16;
/// The minimum share of a branch in the samples of an instance. If no branch has it, all samples count as one branch.
const LEAST_BRANCH: f64 = 0.1;
/// If there are fewer samples, none is an outlier.
const FEWEST: usize = 50;
const EVERYTHING: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// A coordinate that turns more often may oscillate on its way to a pole: its turns tell nothing.
const MOST_TURNS: usize = 16;
/// The interval around no value.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// A part of an object that nothing interrupts.
struct Branch {
    places: Vec<[f64; 3]>,
    /// True if the places are those of a curve, in order.
    is_curve: bool,
}

/// Returns the interval along each axis beyond which coarse places of an object are outliers. The places are those at the
/// parameters `axes`, the first of which varies fastest, of one instance after the other; those at poles become undefined.
pub(super) fn limits(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    axes: &[Vec<f64>; 2],
    places: &mut [[f64; 3]],
) -> [[f64; 2]; 3] {
    let outliers = Outliers::of(scene, params, object, axes);
    let of_instance = axes[0].len() * axes[1].len();
    if let Outliers::Poles(instances) = &outliers {
        for (places, cells) in places.chunks_mut(of_instance).zip(instances) {
            cells.poles.iter().for_each(|&k| places[k] = [f64::NAN; 3]);
        }
    }
    let finite = |places: &[[f64; 3]]| -> Vec<[f64; 3]> {
        places.iter().filter(|at| is_finite(at)).copied().collect()
    };
    let all = finite(places);
    if all.len() < FEWEST {
        return [EVERYTHING; 3];
    }
    let (measure, mut branches) = match outliers {
        Outliers::None => return [EVERYTHING; 3],
        Outliers::Some => (USUAL, Vec::new()),
        Outliers::Poles(instances) => {
            let parts = places.chunks(of_instance);
            let branches = parts.zip(&instances).flat_map(|(places, cells)| {
                let least = LEAST_BRANCH * finite(places).len() as f64;
                let branches = cells.branches(places).into_iter();
                branches.filter(move |branch| branch.places.len() as f64 >= least)
            });
            (WITH_POLES, branches.collect())
        }
    };
    if branches.is_empty() {
        branches.push(Branch {
            places: all,
            is_curve: false,
        });
    }
    std::array::from_fn(|k| measure.interval(&branches, k))
}

impl Branch {
    /// Returns the interval of the coordinate `k` between the slopes at both ends of a curve, which may lead to poles: from where
    /// it turns first to where it turns last.
    fn between_slopes(&self, k: usize) -> Option<[f64; 2]> {
        let turn = |three: &[[f64; 3]]| {
            let [a, b, c] = [0, 1, 2].map(|n: usize| three[n][k]);
            ((b - a) * (c - b) < 0.0).then_some(b)
        };
        let turns: Vec<f64> = self.places.windows(3).filter_map(turn).collect();
        if !self.is_curve || turns.is_empty() || turns.len() > MOST_TURNS {
            return None;
        }
        let around = |[low, high]: [f64; 2], x: f64| [low.min(x), high.max(x)];
        Some(turns.into_iter().fold(NOTHING, around))
    }
}

impl Measure {
    /// Returns the interval beyond which values of the branches' coordinate `k` are outliers.
    fn interval(&self, branches: &[Branch], k: usize) -> [f64; 2] {
        let count: usize = branches.iter().map(|branch| branch.places.len()).sum();
        let around = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
        let (mut inner, mut whole) = (NOTHING, NOTHING);
        let mut size = 0.0;
        for branch in branches {
            let mut values: Vec<f64> = branch.places.iter().map(|place| place[k]).collect();
            values.sort_unstable_by(f64::total_cmp);
            let last = values.len() - 1;
            let middle = [self.outer, 1.0 - self.outer]
                .map(|share| values[(share * last as f64).round() as usize]);
            let [low, high] = around(middle, branch.between_slopes(k).unwrap_or(middle));
            inner = around(inner, [low, high]);
            whole = around(whole, [values[0], values[last]]);
            size += (high - low) * (values.len() as f64 / count as f64);
        }
        let reach = self.reach * size;
        let [low, high] = [inner[0] - reach, inner[1] + reach];
        let cut = high.min(whole[1]) - low.max(whole[0]);
        // A box without inner extent (most samples in one plane) has no measure for outliers.
        if reach > 0.0 && whole[1] - whole[0] > self.most * cut {
            [low, high]
        } else {
            EVERYTHING
        }
    }
}

/// The meaning of places far from most of an object.
enum Outliers {
    /// They belong to it as any other: it is continuous.
    None,
    /// Some may lead to a place where it has no bound.
    Some,
    /// It has poles; the cells of each instance, if it has few.
    Poles(Vec<Cells>),
}

impl Outliers {
    fn of(scene: &Scene, params: &ParamValues, object: &Object, axes: &[Vec<f64>; 2]) -> Self {
        let domain = object.shape.domain();
        if domain.is_empty() {
            return Self::Some;
        }
        let Some(breaks) = Breaks::of(scene, params, object) else {
            let is_known = object.shape.followed().is_empty() && object.shape.position().is_some();
            return if is_known { Self::None } else { Self::Some };
        };
        let mut outliers = Self::None;
        let (mut instances, mut has_poles) = (Vec::new(), false);
        let count = params.instance_count(scene, object);
        for instance in 0..count.min(SEARCHED) {
            let uniforms = params.instance(scene, object, instance);
            let mut cells = Cells::new(axes);
            let found = breaks.find(domain, &uniforms);
            for it in found.iter().flat_map(|found| &found.breaks) {
                cells.open(domain, axes, it.first);
                has_poles |= it.is_pole;
            }
            for sample in found.iter().flat_map(|found| &found.poles) {
                cells.open_at_pole(domain, axes, *sample);
                has_poles = true;
            }
            instances.push(cells);
            // Within a cell of a surface there may be one that was not found.
            if found.is_none() || domain.len() > 1 && breaks.may_occur(domain, &uniforms) {
                outliers = Self::Some;
            }
        }
        match has_poles {
            true if count > SEARCHED => Self::Poles(Vec::new()),
            true => Self::Poles(instances),
            false => outliers,
        }
    }
}

/// The cells between the coarse samples of an instance.
struct Cells {
    /// The numbers of samples along the axes.
    counts: [usize; 2],
    /// For each cell, whether the object is interrupted in it.
    are_open: Vec<bool>,
    /// The indices of the coarse samples that are poles.
    poles: Vec<usize>,
}

impl Cells {
    fn new(axes: &[Vec<f64>; 2]) -> Self {
        let counts = [0, 1].map(|k| axes[k].len());
        Self {
            counts,
            are_open: vec![false; counts[0] * counts[1]],
            poles: Vec::new(),
        }
    }

    /// Opens the cell that contains a sample of the domain, or begins at it.
    fn open(&mut self, domain: &[Sampling], axes: &[Vec<f64>; 2], sample: [u32; 2]) {
        let (index, _) = self.before(domain, axes, sample);
        self.are_open[index] = true;
    }

    /// Opens the cell that begins at a pole, a sample of the domain, which is no place.
    fn open_at_pole(&mut self, domain: &[Sampling], axes: &[Vec<f64>; 2], sample: [u32; 2]) {
        let (index, is_coarse) = self.before(domain, axes, sample);
        self.are_open[index] = true;
        if is_coarse {
            self.poles.push(index);
        }
    }

    /// Returns the index of the last coarse sample before a sample of the domain, and whether it is that sample.
    fn before(&self, domain: &[Sampling], axes: &[Vec<f64>; 2], sample: [u32; 2]) -> (usize, bool) {
        let at = [0, 1].map(|k| domain.get(k).map_or(0.0, |it| it.value(sample[k])));
        let [i, j] = [0, 1].map(|k| {
            let until = axes[k].partition_point(|value| *value <= at[k]);
            until.saturating_sub(1)
        });
        (
            j * self.counts[0] + i,
            axes[0][i] == at[0] && axes[1][j] == at[1],
        )
    }

    /// Returns the branches of the instance with these places: what is defined, and is joined by sides of cells that are not
    /// all open.
    fn branches(&self, places: &[[f64; 3]]) -> Vec<Branch> {
        let [columns, rows] = self.counts;
        let is_closed = |i: usize, j: usize| {
            let is_cell = i + 1 < columns && (j + 1 < rows || rows == 1);
            is_cell && !self.are_open[j * columns + i]
        };
        let joined = |[i, j]: [usize; 2]| {
            let (left, below) = (i.checked_sub(1), j.checked_sub(1));
            let closed =
                |i: Option<usize>, j: Option<usize>| i.zip(j).is_some_and(|(i, j)| is_closed(i, j));
            let (here, row) = (Some(i), Some(j));
            let sides = [
                (closed(left, row) || closed(left, below)).then(|| [i - 1, j]),
                (closed(here, row) || closed(here, below)).then(|| [i + 1, j]),
                (closed(here, below) || closed(left, below)).then(|| [i, j - 1]),
                (rows > 1 && (closed(here, row) || closed(left, row))).then(|| [i, j + 1]),
            ];
            sides.into_iter().flatten()
        };
        let mut is_new: Vec<bool> = places.iter().map(is_finite).collect();
        let mut branches = Vec::new();
        for first in 0..places.len() {
            let mut branch = Vec::new();
            let mut waiting = Vec::new();
            if std::mem::take(&mut is_new[first]) {
                waiting.push(first);
            }
            while let Some(index) = waiting.pop() {
                branch.push(places[index]);
                for [i, j] in joined([index % columns, index / columns]) {
                    let next = j * columns + i;
                    if std::mem::take(&mut is_new[next]) {
                        waiting.push(next);
                    }
                }
            }
            if !branch.is_empty() {
                // From its first place, a curve goes on to the next one.
                branches.push(Branch {
                    places: branch,
                    is_curve: rows == 1,
                });
            }
        }
        branches
    }
}

/// Returns whether a place is finite.
pub(super) fn is_finite(place: &[f64; 3]) -> bool {
    place.iter().all(|x| x.is_finite())
}
