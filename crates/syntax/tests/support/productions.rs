//! Productions with their sets FIRST and FOLLOW, the LL(1) table, and random sentences.
//!
//! The sets are those of Aho, Lam, Sethi, Ullman: *Compilers*, 4.4.
#![allow(dead_code, unreachable_pub)]

use std::collections::{BTreeMap, BTreeSet};

use syntax::productions::{Item, Production};

/// A set of terminals; `None` is the end of the input in FOLLOW, and the empty word in FIRST.
pub type Lookaheads<T> = BTreeSet<Option<T>>;

/// A place of an LL(1) table: the nonterminal that is expected, and the next terminal, `None` at the end of the input.
pub type Cell<N, T> = (N, Option<T>);

/// A grammar with its sets.
#[derive(Clone, Debug)]
pub struct Productions<N: 'static, T: 'static> {
    start: N,
    productions: &'static [Production<N, T>],
    first: BTreeMap<N, Lookaheads<T>>,
    follow: BTreeMap<N, Lookaheads<T>>,
    /// The least number of productions by which each nonterminal ends.
    lengths: BTreeMap<N, usize>,
}

impl<N: Copy + Ord, T: Copy + Ord> Productions<N, T> {
    /// Computes the sets of a grammar, by iteration to the least fixed point.
    pub fn new(start: N, productions: &'static [Production<N, T>]) -> Self {
        let mut grammar = Self {
            start,
            productions,
            first: BTreeMap::new(),
            follow: BTreeMap::from([(start, Lookaheads::from([None]))]),
            lengths: BTreeMap::new(),
        };
        while grammar.grow() {}
        grammar
    }

    /// The productions.
    pub fn productions(&self) -> &'static [Production<N, T>] {
        self.productions
    }

    /// The terminals that a text of a nonterminal begins with, and `None` if it may be empty.
    pub fn first(&self, nonterminal: N) -> Lookaheads<T> {
        self.first.get(&nonterminal).cloned().unwrap_or_default()
    }

    /// The terminals behind a text of a nonterminal, and `None` if it may end the input.
    pub fn follow(&self, nonterminal: N) -> Lookaheads<T> {
        self.follow.get(&nonterminal).cloned().unwrap_or_default()
    }

    /// The nonterminals that have a production, and those that the start reaches.
    pub fn nonterminals(&self) -> (BTreeSet<N>, BTreeSet<N>) {
        let defined = self.productions.iter().map(|it| it.left).collect();
        let mut reached = BTreeSet::from([self.start]);
        let mut open = vec![self.start];
        while let Some(next) = open.pop() {
            let own = self.productions.iter().filter(|it| it.left == next);
            for item in own.flat_map(|it| it.right) {
                if let Item::N(nonterminal) = item
                    && reached.insert(*nonterminal)
                {
                    open.push(*nonterminal);
                }
            }
        }
        (defined, reached)
    }

    /// The LL(1) table.
    pub fn table(&self) -> Table<N, T> {
        let mut cells: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for production in self.productions {
            let mut lookaheads = self.first_of(production.right);
            if lookaheads.remove(&None) {
                lookaheads.extend(self.follow(production.left));
            }
            for lookahead in lookaheads {
                let cell = cells.entry((production.left, lookahead)).or_default();
                cell.push(production.right);
            }
        }
        Table {
            start: self.start,
            cells,
        }
    }

    /// A random sentence. Once it is about `budget` long, the shortest ways out are taken. `below` returns a random number
    /// below the one that it is given.
    pub fn sentence(&self, budget: usize, mut below: impl FnMut(usize) -> usize) -> Vec<T> {
        let mut text = Vec::new();
        let mut stack = vec![Item::N(self.start)];
        while let Some(item) = stack.pop() {
            match item {
                Item::T(terminal) => text.push(terminal),
                Item::N(nonterminal) => {
                    let all = self.productions.iter();
                    let all: Vec<_> = all.filter(|it| it.left == nonterminal).collect();
                    let chosen = if text.len() + stack.len() > budget {
                        let mut all = all.into_iter();
                        // A nonterminal that never ends derives nothing here.
                        let shortest = |it: &&Production<N, T>| self.length(it.right);
                        let all = all.by_ref().filter(|it| shortest(it).is_some());
                        all.min_by_key(shortest)
                    } else {
                        all.get(below(all.len().max(1))).copied()
                    };
                    stack.extend(chosen.iter().flat_map(|it| it.right.iter().rev()));
                }
            }
        }
        text
    }

    /// Takes each production into account once; true if a set grew.
    fn grow(&mut self) -> bool {
        let mut has_grown = false;
        for Production { left, right } in self.productions {
            let first = self.first_of(right);
            has_grown |= extend(self.first.entry(*left).or_default(), first);
            for (k, item) in right.iter().enumerate() {
                if let Item::N(nonterminal) = item {
                    let mut after = self.first_of(&right[k + 1..]);
                    if after.remove(&None) {
                        after.extend(self.follow(*left));
                    }
                    has_grown |= extend(self.follow.entry(*nonterminal).or_default(), after);
                }
            }
            if let Some(length) = self.length(right) {
                let known = self.lengths.entry(*left).or_insert(usize::MAX);
                has_grown |= length + 1 < *known;
                *known = (length + 1).min(*known);
            }
        }
        has_grown
    }

    fn first_of(&self, items: &[Item<N, T>]) -> Lookaheads<T> {
        let mut result = Lookaheads::new();
        for item in items {
            let mut first = match item {
                Item::T(terminal) => Lookaheads::from([Some(*terminal)]),
                Item::N(nonterminal) => self.first(*nonterminal),
            };
            let may_be_empty = first.remove(&None);
            result.extend(first);
            if !may_be_empty {
                return result;
            }
        }
        result.insert(None);
        result
    }

    /// The least number of productions by which steps end; `None` if they are not known to.
    fn length(&self, items: &[Item<N, T>]) -> Option<usize> {
        let each = items.iter().map(|item| match item {
            Item::T(_) => Some(0),
            Item::N(nonterminal) => self.lengths.get(nonterminal).copied(),
        });
        each.sum()
    }
}

/// Adds a set to another one; true if that grew.
fn extend<T: Ord>(set: &mut Lookaheads<T>, more: Lookaheads<T>) -> bool {
    let before = set.len();
    set.extend(more);
    set.len() > before
}

/// The right side of a production.
pub type Right<N, T> = &'static [Item<N, T>];

/// An LL(1) table, with all productions of each cell.
#[derive(Clone, Debug)]
pub struct Table<N: 'static, T: 'static> {
    start: N,
    cells: BTreeMap<Cell<N, T>, Vec<Right<N, T>>>,
}

impl<N: Copy + Ord, T: Copy + Ord> Table<N, T> {
    /// The cells with several productions: none of an LL(1) grammar has.
    pub fn conflicts(&self) -> BTreeMap<Cell<N, T>, &[Right<N, T>]> {
        let several = self.cells.iter().filter(|(_, all)| all.len() > 1);
        several.map(|(cell, all)| (*cell, &all[..])).collect()
    }

    /// Returns true if a text is a sentence. Of several productions in a cell the first that is not empty is taken.
    pub fn accepts(&self, text: &[T]) -> bool {
        let mut stack = vec![Item::N(self.start)];
        let mut rest = text.iter().copied().peekable();
        while let Some(item) = stack.pop() {
            match item {
                Item::T(terminal) if rest.peek() == Some(&terminal) => {
                    rest.next();
                }
                Item::T(_) => return false,
                Item::N(nonterminal) => {
                    let Some(all) = self.cells.get(&(nonterminal, rest.peek().copied())) else {
                        return false;
                    };
                    let chosen = all.iter().find(|right| !right.is_empty());
                    stack.extend(chosen.iter().flat_map(|right| right.iter().rev()));
                }
            }
        }
        rest.next().is_none()
    }
}
