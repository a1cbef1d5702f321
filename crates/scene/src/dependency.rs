//! What an expression depends on: the uniforms that it reads, each found once per node of the graph.
//!
//! What flows in: nodes. What flows out: sorted uniforms. Ten thousand objects that share an expression look
//! into it once: each node's set is kept, and equal sets are one.

use expr::{Graph, Input, Node, NodeId};
use rustc_hash::FxHashMap;

/// The most members that all sets together may have before they are no longer kept.
const MAX_MEMBERS: usize = 4_000_000;

/// Names a set of uniforms.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, Ord, PartialEq, PartialOrd)]
struct SetId(u32);

/// The sets found so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dependencies {
    nodes: FxHashMap<NodeId, SetId>,
    sets: Vec<Box<[u32]>>,
    ids: FxHashMap<Box<[u32]>, SetId>,
    unions: FxHashMap<(SetId, SetId), SetId>,
    /// How many members the sets have together.
    members: usize,
}

impl Dependencies {
    /// The uniforms that the roots depend on, sorted.
    pub(crate) fn of(&mut self, graph: &Graph, roots: &[NodeId]) -> Vec<u32> {
        let mut all = self.set(Box::default());
        for &root in roots {
            let set = self.of_node(graph, root);
            all = self.union(all, set);
            if self.members > MAX_MEMBERS {
                // Too many different sets are worth more room than they save time.
                *self = Self::default();
                return read(graph, roots);
            }
        }
        self.sets[all.0 as usize].to_vec()
    }

    fn of_node(&mut self, graph: &Graph, root: NodeId) -> SetId {
        // Each node twice: when it is met, and when its operands are known.
        let mut stack = vec![(root, false)];
        while let Some((id, operands_known)) = stack.pop() {
            if self.members > MAX_MEMBERS {
                break;
            }
            if self.nodes.contains_key(&id) {
                continue;
            }
            let node = graph.node(id);
            if !operands_known {
                stack.push((id, true));
                stack.extend(node.operands().map(|operand| (operand, false)));
                continue;
            }
            let mut set = self.set(match node {
                Node::Input(Input::Uniform(index)) => Box::new([index]),
                _ => Box::default(),
            });
            for operand in node.operands() {
                let other = self.nodes.get(&operand).copied().unwrap_or(set);
                set = self.union(set, other);
            }
            self.nodes.insert(id, set);
        }
        match self.nodes.get(&root) {
            Some(&set) => set,
            None => self.set(Box::default()),
        }
    }

    fn set(&mut self, members: Box<[u32]>) -> SetId {
        if let Some(&id) = self.ids.get(&members) {
            return id;
        }
        let id = SetId(self.sets.len() as u32);
        self.members += members.len();
        self.sets.push(members.clone());
        self.ids.insert(members, id);
        id
    }

    fn union(&mut self, a: SetId, b: SetId) -> SetId {
        if a == b {
            return a;
        }
        let pair = (a.min(b), a.max(b));
        if let Some(&id) = self.unions.get(&pair) {
            return id;
        }
        let mut members = [&*self.sets[a.0 as usize], &*self.sets[b.0 as usize]].concat();
        members.sort_unstable();
        members.dedup();
        let id = self.set(members.into());
        self.unions.insert(pair, id);
        id
    }
}

/// The same without keeping anything.
fn read(graph: &Graph, roots: &[NodeId]) -> Vec<u32> {
    let inputs = graph.inputs(roots).into_iter();
    inputs
        .filter_map(|input| match input {
            Input::Uniform(index) => Some(index),
            Input::Variable(_) => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use expr::{Graph, Input};

    use super::{Dependencies, MAX_MEMBERS, read};

    #[test]
    fn kept_sets_agree_with_a_walk_and_are_shared() {
        let mut graph = Graph::default();
        let mut dependencies = Dependencies::default();
        let variable = graph.input(Input::Variable(0));
        let mut roots = Vec::new();
        let mut sum = variable;
        for index in 0..200_u32 {
            let uniform = graph.input(Input::Uniform(index % 7));
            let product = graph.multiply(uniform, sum);
            sum = graph.add(product, variable);
            roots.push(sum);
        }
        for root in roots {
            let expected = read(&graph, &[root]);
            assert_eq!(dependencies.of(&graph, &[root]), expected);
        }
        assert!(dependencies.sets.len() <= 15, "{}", dependencies.sets.len());
        assert_eq!(dependencies.of(&graph, &[variable]), [0; 0]);
        assert_eq!(dependencies.of(&graph, &[]), [0; 0]);
    }

    #[test]
    fn too_many_sets_are_given_up() {
        let mut graph = Graph::default();
        let mut dependencies = Dependencies::default();
        let mut sum = graph.input(Input::Uniform(0));
        let count = 3000;
        for index in 1..count {
            let uniform = graph.input(Input::Uniform(index));
            sum = graph.add(sum, uniform);
        }
        assert!((count * count / 2) as usize > MAX_MEMBERS);
        let expected: Vec<u32> = (0..count).collect();
        assert_eq!(dependencies.of(&graph, &[sum]), expected);
        assert!(dependencies.members <= MAX_MEMBERS);
    }
}
