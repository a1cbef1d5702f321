//! Solids that are unions of products: of intersections of simple leaves, and of complements of such leaves.
//!
//! Input: set operations in postfix order. Output: the products that a solid is the union of, if it is one. J. Goldfeather,
//! J. P. M. Hultquist and H. Fuchs, "Fast constructive-solid geometry display in the Pixel-Powers graphics system", SIGGRAPH
//! 1986, multiply any tree out into a sum of such products. Here a tree counts as it is written: products that are multiplied
//! out may be many, and meet each other.

use crate::tree::TreeStep;

/// The number of leaves of a product: more are left to the sweep.
pub(crate) const MOST: usize = 8;

/// A leaf of a product.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductLeaf {
    pub(crate) leaf: u32,
    /// True if the solid lies outside of it.
    pub(crate) complemented: bool,
}

/// The leaves of each product that a solid is the union of, ascending; `is_simple` is true of those that are convex or bounded
/// by one quadric. `None` if the solid is none such union.
pub(crate) fn products(
    steps: &[TreeStep],
    is_simple: &dyn Fn(usize) -> bool,
) -> Option<Vec<Vec<ProductLeaf>>> {
    /// A set as a union of products, and, if it is one, as a union of leaves.
    struct Set {
        products: Vec<Vec<ProductLeaf>>,
        leaves: Option<Vec<u32>>,
    }
    let mut stack: Vec<Set> = Vec::new();
    for step in steps {
        if let TreeStep::Leaf(leaf) = *step {
            if !is_simple(leaf) {
                return None;
            }
            let leaf = leaf as u32;
            let complemented = false;
            stack.push(Set {
                products: vec![vec![ProductLeaf { leaf, complemented }]],
                leaves: Some(vec![leaf]),
            });
            continue;
        }
        let (b, a) = (stack.pop()?, stack.pop()?);
        stack.push(match step {
            TreeStep::Union => Set {
                products: joined(a.products, b.products),
                leaves: a.leaves.zip(b.leaves).map(|(a, b)| joined(a, b)),
            },
            TreeStep::Intersection => product(a.products, only(b.products)?)?,
            _ => {
                let complemented = true;
                let outside = |leaf| ProductLeaf { leaf, complemented };
                product(a.products, b.leaves?.into_iter().map(outside).collect())?
            }
        });
    }
    /// Both lists, in any order.
    fn joined<T>(mut a: Vec<T>, mut b: Vec<T>) -> Vec<T> {
        if a.len() < b.len() {
            std::mem::swap(&mut a, &mut b);
        }
        a.append(&mut b);
        a
    }
    fn only<T>(mut list: Vec<T>) -> Option<T> {
        let last = list.pop();
        last.filter(|_| list.is_empty())
    }
    fn product(a: Vec<Vec<ProductLeaf>>, b: Vec<ProductLeaf>) -> Option<Set> {
        let mut leaves = joined(only(a)?, b);
        leaves.sort_unstable_by_key(|of| of.leaf);
        (leaves.len() <= MOST).then(|| Set {
            products: vec![leaves],
            leaves: None,
        })
    }
    Some(stack.pop()?.products)
}
