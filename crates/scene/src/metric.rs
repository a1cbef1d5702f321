//! Searches a declared metric for a point where it is not positive definite: E > 0 and E G − F² > 0 must hold inside
//! the domain of a metric.
//!
//! In: E, F and G as expressions, the domain, and the uniforms of one instance. Out: a point inside the domain where one
//! of them fails, if the search finds one.
//!
//! The search evaluates the metric on a lattice, and walks downhill from the lattice's minimum values, so that it also
//! finds a line where the metric only just vanishes. The domain's sides are excluded: a metric may collapse there, as
//! `sin^2 u` does at the poles of a sphere.

use expr::tape::{Registers, Tape};
use expr::{Graph, NodeId};

use crate::scene::Sampling;

/// A point where E, F and G are not a metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Witness {
    /// Its parameters.
    pub(crate) at: [f64; 2],
    pub(crate) defect: Defect,
}

/// The condition that E, F and G violate at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Defect {
    /// One of them is not a finite number.
    Undefined,
    /// E has this value, which is not positive.
    First(f64),
    /// E is positive, but E G − F² has this value.
    Determinant(f64),
}

/// The maximum number of operations on the lattice of one metric.
const LATTICE_OPERATIONS: usize = 2_000_000;

/// The maximum number of lattice lines along one parameter. Even, so that the middle of the domain is on one.
const LINES: usize = 32;

/// The distance of the walks from the domain's sides, as a fraction of its width.
const MARGIN: f64 = 1e-3;

/// Values below this fraction of the metric's typical value are considered zero: near a zero line a walk stops at a
/// distance of about 1e-8, and the value is quadratic there.
const ZERO: f64 = 1e-13;

/// The number of minimum values of the lattice from which a walk starts.
const WALKS: usize = 3;

/// The bounds of the number of steps of a walk, which has fewer if the tape is long. Some hundred suffice; where a metric is
/// steep and its values are noise, a walk with short steps would never end.
const STEPS: [usize; 2] = [200, 2_000];

/// Searches one instance of a metric. `instances` is the number of instances that will be searched, which share the
/// work.
pub(crate) fn witness(
    graph: &Graph,
    components: &[NodeId; 3],
    domain: &[Sampling; 2],
    uniforms: &[f64],
    instances: usize,
) -> Option<Witness> {
    let tape = Tape::new(graph, components);
    let budget = LATTICE_OPERATIONS / instances.max(1) / (tape.operation_count() + 1);
    let lines = LINES.min(budget.isqrt() & !1).max(4);
    let mut search = Search {
        tape,
        registers: Registers::default(),
        domain,
        uniforms,
        steps: (budget / 16).clamp(STEPS[0], STEPS[1]),
    };
    let points: Vec<Point> = (1..lines)
        .flat_map(|i| (1..lines).map(move |j| [i, j].map(|k| k as f64 / lines as f64)))
        .map(|share| search.point(share))
        .collect();
    let worst = points.iter().filter_map(Point::defect);
    if let Some(defect) = worst.min_by_key(|defect| match defect {
        Defect::First(_) => 0,
        Defect::Determinant(_) => 1,
        Defect::Undefined => 2,
    }) {
        let kind = std::mem::discriminant(&defect);
        let same = |point: &&Point| {
            let found = point.defect();
            found.is_some_and(|found| std::mem::discriminant(&found) == kind)
        };
        // The point deepest inside: the sides are the least likely to be its cause.
        let deepest = points.iter().filter(same).max_by(|a, b| {
            let depth = |point: &Point| point.share.map(|x| x.min(1.0 - x)).into_iter();
            let least = |point: &Point| depth(point).fold(f64::INFINITY, f64::min);
            least(a).total_cmp(&least(b))
        })?;
        return Some(search.witness(deepest, deepest.defect()?));
    }
    MERITS
        .iter()
        .find_map(|&merit| search.descend(&points, merit, 1.0 / lines as f64))
}

/// The quantities that must be positive: E, G, and E G − F² relative to E G.
const MERITS: [fn(&Point) -> f64; 3] = [
    |point| point.form[0],
    |point| point.form[2],
    |point| 1.0 - point.form[1] / point.form[0] * (point.form[1] / point.form[2]),
];

/// E, F and G at a point of the domain, whose coordinates are fractions of the domain's width.
#[derive(Clone, Copy, Debug)]
struct Point {
    share: [f64; 2],
    form: [f64; 3],
}

impl Point {
    fn determinant(&self) -> f64 {
        let [e, f, g] = self.form;
        let determinant = e * g - f * f;
        if determinant.is_normal() || determinant < 0.0 {
            return determinant;
        }
        // The products under- or overflow where the metric itself does not.
        let scaled = 1.0 - f / e * (f / g);
        if e > 0.0 && g > 0.0 && scaled > 0.0 {
            f64::MIN_POSITIVE
        } else {
            determinant
        }
    }

    fn defect(&self) -> Option<Defect> {
        if !self.form.iter().all(|x| x.is_finite()) {
            return Some(Defect::Undefined);
        }
        if self.form[0] <= 0.0 {
            return Some(Defect::First(self.form[0]));
        }
        let determinant = self.determinant();
        (determinant <= 0.0).then_some(Defect::Determinant(determinant))
    }
}

struct Search<'a> {
    tape: Tape,
    registers: Registers,
    domain: &'a [Sampling; 2],
    uniforms: &'a [f64],
    /// The maximum number of steps of a walk.
    steps: usize,
}

impl Search<'_> {
    /// Returns the parameters of a point.
    fn parameters(&self, share: [f64; 2]) -> [f64; 2] {
        std::array::from_fn(|axis| {
            let range = self.domain[axis].range;
            range.min * (1.0 - share[axis]) + range.max * share[axis]
        })
    }

    fn point(&mut self, share: [f64; 2]) -> Point {
        let at = self.parameters(share);
        let inputs = self.tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&at, self.uniforms)).collect();
        let mut form = [f64::NAN; 3];
        self.tape.eval(&mut self.registers, &inputs, &mut form);
        Point { share, form }
    }

    /// Walks downhill from the lattice's minimum values of a merit.
    fn descend(
        &mut self,
        points: &[Point],
        merit: fn(&Point) -> f64,
        cell: f64,
    ) -> Option<Witness> {
        let mut ranked: Vec<(f64, &Point)> = points.iter().map(|p| (merit(p), p)).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let typical = ranked.get(ranked.len() / 2)?.0;
        for &(_, start) in ranked.iter().take(WALKS) {
            let end = self.walk(*start, merit, cell);
            if let Some(defect) = end.defect() {
                return Some(self.witness(&end, defect));
            }
            let is_inside = |x: &f64| (1.5 * MARGIN..=1.0 - 1.5 * MARGIN).contains(x);
            if merit(&end) <= ZERO * typical && end.share.iter().all(is_inside) {
                // So close to zero that the rest is rounding.
                let defect = match merit(&Point {
                    form: [0.0, 1.0, 1.0],
                    ..end
                }) {
                    0.0 => Defect::First(0.0),
                    _ => Defect::Determinant(0.0),
                };
                return Some(self.witness(&end, defect));
            }
        }
        None
    }

    /// Compass search: steps along the axes while the merit decreases, halved when no step decreases it, up to the
    /// maximum number of steps.
    fn walk(&mut self, start: Point, merit: fn(&Point) -> f64, cell: f64) -> Point {
        let mut best = start;
        let mut step = cell;
        for _ in 0..self.steps {
            if step <= 1e-10 || best.defect().is_some() {
                break;
            }
            let moves = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]];
            let next = moves
                .map(|[x, y]| {
                    let [u, v] = best.share;
                    let share = [u + x, v + y].map(|x| x.clamp(MARGIN, 1.0 - MARGIN));
                    self.point(share)
                })
                .into_iter()
                .find(|point| point.defect().is_some() || merit(point) < merit(&best));
            match next {
                Some(point) => best = point,
                None => step *= 0.5,
            }
        }
        best
    }

    fn witness(&self, point: &Point, defect: Defect) -> Witness {
        Witness {
            at: self.parameters(point.share),
            defect,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Defect, Witness, witness};
    use crate::param_values::ParamValues;
    use crate::scene::Scene;

    fn found(metric: &str) -> Option<Witness> {
        let source = format!("metric h(u,v) = {metric};");
        let scene: Scene = crate::geotrace::compile(&source).scene.expect("no errors");
        let object = &scene.objects[0];
        let (components, domain) = object.shape.metric().expect("a metric");
        let uniforms = ParamValues::initial(&scene).first_instance(&scene, object);
        witness(&scene.graph, components, domain, &uniforms, 1)
    }

    #[test]
    fn metrics_of_the_textbooks_have_no_witness() {
        for metric in [
            "(1, 0, sin^2 u), u : [0, pi], v : [0, 2pi]",
            "(1, 0, sinh^2 u), u : [0, 30], v : [0, 2pi]",
            "4(1, 0, u^2)/(1 - u^2)^2, u : [0, 1], v : [0, 2pi]",
            "4(1, 0, 1)/(1 - u^2 - v^2)^2, u : [-0.7, 0.7], v : [-0.7, 0.7]",
            "(1, 0, 1)/v^2, u : [-1e6, 1e6], v : [0, 1e-6]",
            "(1, 0.999999, 1), u : [0, 1], v : [0, 1]",
            "1e-200(1, 0, 1), u : [0, 1], v : [0, 1]",
            "1e200(1, 0.5, 1), u : [0, 1], v : [0, 1]",
            "((1 + (cos u)/2)^2, 0, sin^2 u), u : [0, pi], v : [0, 2pi]",
        ] {
            assert_eq!(found(metric), None, "{metric}");
        }
    }

    #[test]
    fn a_witness_is_a_point_where_the_metric_fails() {
        for metric in [
            "(1, 0, sin u), u : [0.1, 6], v : [0, 1]",
            "(cos v, 0, 1), u : [0, 1], v : [0, 2]",
            "(1, 1.0000001, 1), u : [0, 1], v : [0, 1]",
            "(1, 2 exp(-((u - 0.31)^2 + (v - 0.72)^2)/0.0001), 1), u : [0, 1], v : [0, 1]",
        ] {
            let Some(Witness { at: [u, v], defect }) = found(metric) else {
                panic!("{metric}: nothing found");
            };
            assert_ne!(defect, Defect::Undefined, "{metric}");
            let body = metric.split(", u :").next().unwrap_or_default();
            let source = format!("metric h(u,v) = {metric};");
            let compilation = crate::geotrace::compile(&source);
            let params = ParamValues::initial(compilation.scene.as_ref().expect("a scene"));
            let value = compilation.evaluate(&format!("h({u}, {v})"), &params);
            let value = value.expect("a value").outcome;
            let crate::Outcome::Single(crate::Value::Vector(form)) = value else {
                panic!("{body} is no vector");
            };
            let [e, f, g] = [0, 1, 2].map(|k| form[k].expect("defined"));
            let fails = e <= 0.0 || e * g - f * f <= 1e-15;
            assert!(fails, "{metric}: E = {e}, F = {f}, G = {g} at ({u}, {v})");
        }
    }

    #[test]
    fn a_steep_metric_of_noise_is_searched_in_bounded_time() {
        let (sender, ended) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let noise = "1 + (cos abs(u/1e-200))^2, 0, 1 + (v/1e-9 - 1/u)^2";
            let witness = found(&format!("({noise}), u : [1e-3, 1], v : [-pi/2, pi/2]"));
            let _ = sender.send(witness);
        });
        let witness = ended.recv_timeout(std::time::Duration::from_secs(60));
        assert_eq!(witness.expect("the search ends"), None);
    }
}
