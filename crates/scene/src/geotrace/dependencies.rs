//! Dependency sets: the params and grids that an expression reads, directly or through a name or a function.
//!
//! In: a param or grid at its declaration, and the dependencies of an expression's parts. Out: the dependencies of the
//! whole. They follow the text: `0k` depends on `k`, though its value is the same for every `k`, so that the number of
//! instances does not depend on the quality of simplification. Only the dependencies of a derivative follow its
//! simplified expression: the derivative of `x + k` is 1 and depends on nothing.
//!
//! Equal sets are stored once, so ten thousand declarations that read the same few params cost a few sets.

use std::sync::Arc;

use expr::Input;
use rustc_hash::FxHashMap;
use syntax::symbol::SymbolId;

/// A handle of a set of params and grids; the default is the empty set.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(crate) struct Dependencies(u32);

/// The index of a param or grid among all of them, in the order of the text.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct SourceIndex(pub(crate) u32);

/// All sets in use.
#[derive(Clone, Debug)]
pub(crate) struct DependencySets {
    /// The symbol of each source, if its name was free.
    sources: Vec<Option<SymbolId>>,
    /// Their ranks in the order of the text, if it differs from the order in which they were added.
    places: Option<Vec<u32>>,
    /// For each uniform, the set that contains only its source.
    uniforms: Vec<Dependencies>,
    /// Bit k of a set represents source k; the last word is not 0.
    sets: Vec<Arc<[u64]>>,
    ids: FxHashMap<Arc<[u64]>, Dependencies>,
    unions: FxHashMap<(Dependencies, Dependencies), Dependencies>,
}

impl Default for DependencySets {
    fn default() -> Self {
        let empty: Arc<[u64]> = Arc::new([]);
        Self {
            sources: Vec::new(),
            places: None,
            uniforms: Vec::new(),
            sets: vec![Arc::clone(&empty)],
            ids: FxHashMap::from_iter([(empty, Dependencies::default())]),
            unions: FxHashMap::default(),
        }
    }
}

impl DependencySets {
    /// Adds a param or grid with `components` components, which are the next uniforms. Returns the set that contains
    /// only it.
    pub(crate) fn declare(&mut self, symbol: Option<SymbolId>, components: usize) -> Dependencies {
        let source = self.sources.len();
        self.sources.push(symbol);
        let mut bits = vec![0; source / 64 + 1];
        bits[source / 64] = 1 << (source % 64);
        let dependencies = self.set(bits);
        let uniforms = std::iter::repeat_n(dependencies, components);
        self.uniforms.extend(uniforms);
        dependencies
    }

    /// Adds `count` uniforms, whose values are computed from others and have these dependencies; returns the first.
    pub(crate) fn add_uniforms(&mut self, dependencies: Dependencies, count: u32) -> u32 {
        let first = self.uniform_count();
        let uniforms = std::iter::repeat_n(dependencies, count as usize);
        self.uniforms.extend(uniforms);
        first
    }

    /// Returns the number of uniforms.
    pub(crate) fn uniform_count(&self) -> u32 {
        self.uniforms.len() as u32
    }

    /// Returns the dependencies of an expression with these inputs.
    pub(crate) fn of_inputs(&mut self, inputs: &[Input]) -> Dependencies {
        inputs
            .iter()
            .fold(Dependencies::default(), |dependencies, input| {
                let other = match *input {
                    Input::Uniform(index) => self.uniforms.get(index as usize).copied(),
                    Input::Variable(_) => None,
                };
                self.union(dependencies, other.unwrap_or_default())
            })
    }

    /// Returns the dependencies of an expression with two parts.
    pub(crate) fn union(&mut self, a: Dependencies, b: Dependencies) -> Dependencies {
        if a == b || b == Dependencies::default() {
            return a;
        }
        if a == Dependencies::default() {
            return b;
        }
        let pair = (a.min(b), a.max(b));
        if let Some(&known) = self.unions.get(&pair) {
            return known;
        }
        let (short, long) = (&self.sets[a.0 as usize], &self.sets[b.0 as usize]);
        let (short, long) = if short.len() <= long.len() {
            (short, long)
        } else {
            (long, short)
        };
        let mut bits = long.to_vec();
        for (word, other) in bits.iter_mut().zip(short.iter()) {
            *word |= other;
        }
        let union = self.set(bits);
        self.unions.insert(pair, union);
        union
    }

    /// Returns the subset of a set for which `is_kept` holds.
    pub(crate) fn retained(
        &mut self,
        dependencies: Dependencies,
        is_kept: impl Fn(SourceIndex) -> bool,
    ) -> Dependencies {
        let mut bits = self.sets[dependencies.0 as usize].to_vec();
        for source in self.members(dependencies).collect::<Vec<_>>() {
            if !is_kept(source) {
                bits[source.0 as usize / 64] &= !(1 << (source.0 % 64));
            }
        }
        while bits.last() == Some(&0) {
            bits.pop();
        }
        self.set(bits)
    }

    /// Returns the params and grids of a set, in the order of the text.
    pub(crate) fn sources(
        &self,
        dependencies: Dependencies,
    ) -> impl Iterator<Item = SourceIndex> + '_ {
        let in_order = self.places.is_none().then(|| self.members(dependencies));
        let mut moved: Vec<SourceIndex> = Vec::new();
        if let Some(places) = &self.places {
            moved.extend(self.members(dependencies));
            moved.sort_by_key(|source| places.get(source.0 as usize));
        }
        in_order.into_iter().flatten().chain(moved)
    }

    /// Sets the rank in the text of the source that was declared last.
    pub(crate) fn place_next(&mut self, place: u32) {
        self.places.get_or_insert_default().push(place);
    }

    /// Sets the rank in the text of each source.
    pub(crate) fn place(&mut self, places: Vec<u32>) {
        self.places = Some(places);
    }

    /// Returns the params and grids of a set, in the order in which they were added.
    fn members(&self, dependencies: Dependencies) -> impl Iterator<Item = SourceIndex> + '_ {
        let words = self.sets[dependencies.0 as usize].iter().zip(0..);
        words.flat_map(|(&word, index): (&u64, u32)| {
            let bits = (0..64).filter(move |bit| word >> bit & 1 == 1);
            bits.map(move |bit| SourceIndex(64 * index + bit))
        })
    }

    /// Returns the first param or grid of a set that has a name.
    pub(crate) fn first(&self, dependencies: Dependencies) -> Option<SymbolId> {
        let mut sources = self.sources(dependencies);
        sources.find_map(|source| *self.sources.get(source.0 as usize)?)
    }

    fn set(&mut self, bits: Vec<u64>) -> Dependencies {
        let bits: Arc<[u64]> = bits.into();
        if let Some(&known) = self.ids.get(&bits) {
            return known;
        }
        let dependencies = Dependencies(self.sets.len() as u32);
        self.sets.push(Arc::clone(&bits));
        self.ids.insert(bits, dependencies);
        dependencies
    }
}

#[cfg(test)]
mod tests {
    use expr::Input;
    use syntax::symbol::SymbolId;

    use super::{Dependencies, DependencySets};

    #[test]
    fn unions_hold_the_members_of_both_in_order_and_equal_sets_are_one() {
        let mut sets = DependencySets::default();
        let single: Vec<Dependencies> = (0..200)
            .map(|index| sets.declare(Some(SymbolId(1000 + index)), 2))
            .collect();
        let members = |sets: &DependencySets, dependencies| -> Vec<u32> {
            sets.sources(dependencies).map(|source| source.0).collect()
        };
        let a = sets.union(single[130], single[2]);
        let b = sets.union(single[64], a);
        assert_eq!(members(&sets, a), [2, 130]);
        assert_eq!(members(&sets, b), [2, 64, 130]);
        assert_eq!(sets.union(b, a), b);
        assert_eq!(sets.union(single[64], b), b);
        let c = sets.union(single[2], single[64]);
        assert_eq!(sets.union(c, single[130]), b);
        assert_eq!(sets.union(Dependencies::default(), b), b);
        assert_eq!(sets.first(b), Some(SymbolId(1002)));
        assert_eq!(sets.first(Dependencies::default()), None);
        assert_eq!(members(&sets, Dependencies::default()), [0; 0]);
        // Two uniforms each.
        let inputs = [128, 261, 260, 5].map(Input::Uniform);
        assert_eq!(sets.of_inputs(&inputs), b);
        assert_eq!(
            sets.of_inputs(&[Input::Variable(3)]),
            Dependencies::default()
        );
    }
}
