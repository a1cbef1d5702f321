//! Affine maps over the nodes of a graph.
//!
//! In: the placement of a set, as nodes. Out: maps as rows of nodes, composed, inverted, and tested for singularity.

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId, TooLarge};

use crate::solid::AffineNodes;

/// A map is singular if its determinant is at most this fraction of the product of its columns' lengths.
pub(crate) const LEAST_DETERMINANT: f64 = 1e-12;

/// The half angle below which a rotation equals that of its vector within rounding, including in 32 bits.
const LEAST_HALF_ANGLE: f64 = 1e-18;

impl AffineNodes {
    /// Returns the identity map.
    pub(crate) fn identity(graph: &mut Graph) -> Self {
        let (zero, one) = (graph.constant(0.0), graph.constant(1.0));
        Self([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| if row == column { one } else { zero })))
    }

    /// Returns the map x ↦ x + v.
    pub(crate) fn translation(graph: &mut Graph, by: [NodeId; 3]) -> Self {
        let mut map = Self::identity(graph);
        for (row, by) in map.0.iter_mut().zip(by) {
            row[3] = by;
        }
        map
    }

    /// Returns the map x ↦ (s₁x₁, s₂x₂, s₃x₃).
    pub(crate) fn scaling(graph: &mut Graph, by: [NodeId; 3]) -> Self {
        let mut map = Self::identity(graph);
        for (k, by) in by.into_iter().enumerate() {
            map.0[k][k] = by;
        }
        map
    }

    /// Returns the rotation about a vector w by |w| radians, counterclockwise as seen from its tip: Rodrigues' formula
    /// with s = sin h / h and h = |w|/2, cos 2h · 1 + s cos h · `[w]×` + s²/2 · w wᵀ, which is the identity at w = 0.
    pub(crate) fn rotation(graph: &mut Graph, about: [NodeId; 3]) -> Self {
        let is_zero = |graph: &Graph, node| graph.value(node) == Some(0.0);
        let mut map = Self::identity(graph);
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            if is_zero(graph, about[next]) && is_zero(graph, about[last]) {
                let (sine, cosine) = (
                    graph.unary(Unary::Sin, about[axis]),
                    graph.unary(Unary::Cos, about[axis]),
                );
                map.0[next][next] = cosine;
                map.0[last][last] = cosine;
                map.0[last][next] = sine;
                map.0[next][last] = graph.neg(sine);
                return map;
            }
        }
        let squares = about.map(|w| graph.mul(w, w));
        let sum = graph.add(squares[0], squares[1]);
        let sum = graph.add(sum, squares[2]);
        let angle = graph.unary(Unary::Sqrt, sum);
        let (half, least) = (graph.constant(0.5), graph.constant(LEAST_HALF_ANGLE));
        let h = graph.mul(half, angle);
        let h = graph.binary(Binary::Max, h, least);
        let (sine, cosine) = (graph.unary(Unary::Sin, h), graph.unary(Unary::Cos, h));
        let s = graph.div(sine, h);
        let cross = graph.mul(s, cosine);
        let square = graph.mul(s, s);
        let outer = graph.mul(half, square);
        let whole = graph.unary(Unary::Cos, angle);
        for row in 0..3 {
            for column in 0..3 {
                let product = graph.mul(about[row], about[column]);
                let mut entry = graph.mul(outer, product);
                if row == column {
                    entry = graph.add(entry, whole);
                } else {
                    let other = graph.mul(cross, about[3 - row - column]);
                    entry = match (column + 3 - row) % 3 {
                        1 => graph.sub(entry, other),
                        _ => graph.add(entry, other),
                    };
                }
                map.0[row][column] = entry;
            }
        }
        map
    }

    /// Returns the composition of this map after `first`.
    pub(crate) fn after(&self, graph: &mut Graph, first: &Self) -> Self {
        let mut map = *first;
        for row in 0..3 {
            for column in 0..4 {
                let factors = [0, 1, 2].map(|k| (self.0[row][k], first.0[k][column]));
                let mut sum = product_sum(graph, factors);
                if column == 3 {
                    sum = graph.add(sum, self.0[row][3]);
                }
                map.0[row][column] = sum;
            }
        }
        map
    }

    /// Returns the determinant of the matrix.
    pub(crate) fn determinant(&self, graph: &mut Graph) -> NodeId {
        let first = [0, 1, 2].map(|column| (self.0[0][column], self.cofactor(graph, 0, column)));
        product_sum(graph, first)
    }

    /// Returns (−1)ʲ⁺ᵏ times the minor without row j and column k.
    fn cofactor(&self, graph: &mut Graph, row: usize, column: usize) -> NodeId {
        let (r, s) = ((row + 1) % 3, (row + 2) % 3);
        let (c, d) = ((column + 1) % 3, (column + 2) % 3);
        let a = graph.mul(self.0[r][c], self.0[s][d]);
        let b = graph.mul(self.0[r][d], self.0[s][c]);
        graph.sub(a, b)
    }

    /// Returns the point that the map takes to (`Variable(0)`, `Variable(1)`, `Variable(2)`).
    pub(crate) fn preimage(&self, graph: &mut Graph) -> [NodeId; 3] {
        let place = [0, 1, 2].map(|k| {
            let x = graph.input(Input::Variable(k));
            graph.sub(x, self.0[k as usize][3])
        });
        let determinant = self.determinant(graph);
        [0, 1, 2].map(|row| {
            let factors = [0, 1, 2].map(|k| (self.cofactor(graph, k, row), place[k]));
            let sum = product_sum(graph, factors);
            graph.div(sum, determinant)
        })
    }

    /// Returns three nodes over `Variable(0)` to `Variable(2)` as an affine map; `None` if one of their derivatives reads a
    /// variable.
    pub(crate) fn of_image(
        graph: &mut Graph,
        image: [NodeId; 3],
    ) -> Result<Option<Self>, TooLarge> {
        let mut map = Self::identity(graph);
        let is_variable = |input: &Input| matches!(input, Input::Variable(_));
        for column in 0..3 {
            let slopes = graph.derivatives(&image, Input::Variable(column))?;
            if graph.inputs(&slopes).iter().any(is_variable) {
                return Ok(None);
            }
            for (row, slope) in map.0.iter_mut().zip(slopes) {
                row[column as usize] = slope;
            }
        }
        let zero = graph.constant(0.0);
        let origin = graph.substitute(&image, &|input| is_variable(&input).then_some(zero))?;
        for (row, at) in map.0.iter_mut().zip(origin) {
            row[3] = at;
        }
        Ok(Some(map))
    }

    /// Returns true if a map with these entries, row by row, is singular regardless of the product of its columns' lengths,
    /// which may be out of range.
    pub(crate) fn is_flat(numbers: &[f64]) -> bool {
        let mut scaled = numbers.to_vec();
        for column in 0..3 {
            let entries = (column..numbers.len()).step_by(4);
            let most = entries
                .clone()
                .fold(0.0, |most, k| numbers[k].abs().max(most));
            if most > 0.0 {
                entries.for_each(|k| scaled[k] /= most);
            }
        }
        Self::is_singular(&scaled)
    }

    /// Returns true if a map with these entries, row by row, is singular or undefined.
    pub(crate) fn is_singular(numbers: &[f64]) -> bool {
        let [a, b, c, _, d, e, f, _, g, h, i, _] = numbers else {
            return true;
        };
        let determinant = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g);
        let columns = [[a, d, g], [b, e, h], [c, f, i]];
        let lengths = columns.map(|column| column.iter().map(|x| *x * *x).sum::<f64>().sqrt());
        let volume: f64 = lengths.iter().product();
        let is_finite = numbers.iter().all(|number| number.is_finite());
        !(is_finite && determinant.abs() > LEAST_DETERMINANT * volume)
    }
}

fn product_sum(graph: &mut Graph, factors: [(NodeId, NodeId); 3]) -> NodeId {
    let [a, b, c] = factors.map(|(a, b)| graph.mul(a, b));
    let sum = graph.add(a, b);
    graph.add(sum, c)
}

#[cfg(test)]
mod tests {
    use expr::{Graph, NodeId};

    use crate::geodesic_value::numbers;
    use crate::solid::AffineNodes;

    fn constants<const N: usize>(graph: &mut Graph, values: [f64; N]) -> [NodeId; N] {
        values.map(|value| graph.constant(value))
    }

    fn values(graph: &Graph, map: &AffineNodes) -> Vec<f64> {
        numbers(graph, map.0.as_flattened(), &[], &[])
    }

    fn close(a: &[f64], b: &[f64]) {
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }

    #[test]
    fn rotations_turn_counterclockwise_and_no_vector_turns_nothing() {
        let graph = &mut Graph::default();
        let quarter = std::f64::consts::FRAC_PI_2;
        // About z, x goes to y; the general formula agrees with that of an axis.
        for tilt in [0.0, 1e-9] {
            let about = constants(graph, [tilt, 0.0, quarter]);
            let map = AffineNodes::rotation(graph, about);
            let found = values(graph, &map);
            for (k, expected) in [(0, 0.0), (1, -1.0), (4, 1.0), (5, 0.0), (10, 1.0)] {
                assert!((found[k] - expected).abs() < 2e-9, "{k} {found:?}");
            }
        }
        // About (1, 1, 1) by a third of a turn, x goes to y, y to z, z to x.
        let third = std::f64::consts::TAU / 3.0 / 3_f64.sqrt();
        let about = constants(graph, [third; 3]);
        let map = AffineNodes::rotation(graph, about);
        close(
            &values(graph, &map),
            &[0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        );
        let nothing = constants(graph, [0.0; 3]);
        let identity = AffineNodes::identity(graph);
        let map = AffineNodes::rotation(graph, nothing);
        close(&values(graph, &map), &values(graph, &identity));
        // Nor does a vector that comes to zero only when its params do.
        let inputs = [0, 1, 2].map(|k| graph.input(expr::Input::Uniform(k)));
        let map = AffineNodes::rotation(graph, inputs);
        let found = numbers(graph, map.0.as_flattened(), &[0.0; 3], &[]);
        close(&found, &values(graph, &identity));
    }

    #[test]
    fn a_preimage_undoes_a_map() {
        let graph = &mut Graph::default();
        let (about, by) = (
            constants(graph, [0.3, -0.7, 0.2]),
            constants(graph, [2.0, 3.0, -0.5]),
        );
        let along = constants(graph, [1.0, -2.0, 5.0]);
        let turn = AffineNodes::rotation(graph, about);
        let scale = AffineNodes::scaling(graph, by);
        let shift = AffineNodes::translation(graph, along);
        let map = scale.after(graph, &shift);
        let map = turn.after(graph, &map);
        assert!(!AffineNodes::is_singular(&values(graph, &map)));
        let rows: Vec<f64> = values(graph, &map);
        let at = [0.25, -1.5, 2.0];
        let image: Vec<f64> = rows
            .chunks(4)
            .map(|row| row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3])
            .collect();
        let preimage = map.preimage(graph);
        close(&numbers(graph, &preimage, &[], &image), &at);
    }

    #[test]
    fn singular_maps_are_flat_or_undefined() {
        let flat = [1.0, 2.0, 0.0, 9.0, 2.0, 4.0, 0.0, 9.0, 0.0, 0.0, 1.0, 9.0];
        assert!(AffineNodes::is_singular(&flat));
        let mut small = [0.0; 12];
        for k in 0..3 {
            small[5 * k] = 1e-60;
        }
        assert!(!AffineNodes::is_singular(&small));
        for extreme in [1e-110, 1e103] {
            let mut map = [0.0; 12];
            for k in 0..3 {
                map[5 * k] = extreme;
            }
            assert!(AffineNodes::is_singular(&map) && !AffineNodes::is_flat(&map));
        }
        assert!(AffineNodes::is_flat(&flat));
        small[3] = f64::NAN;
        assert!(AffineNodes::is_singular(&small));
    }
}
