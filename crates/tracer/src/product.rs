//! Solids that are unions of products: of intersections of simple leaves, and of complements of such leaves.
//!
//! In: set operations in postfix order. Out: the products whose union is the solid, if it has this form. J. Goldfeather, J.
//! P. M. Hultquist and H. Fuchs, "Fast constructive-solid geometry display in the Pixel-Powers graphics system", SIGGRAPH
//! 1986, expand any tree into a sum of such products. Here a tree is used as written: expanded products may be numerous, and
//! intersect each other.

use crate::tree::TreeStep;

/// A product of simple leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Product {
    /// The number of its leaves that are not complemented.
    pub(crate) positives: usize,
    /// True if it is the only product of its solid.
    pub(crate) is_alone: bool,
}

/// The role of a leaf in a product.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProductLeaf {
    /// The number of the product.
    pub(crate) product: u32,
    /// True if the product is outside of the leaf.
    pub(crate) complemented: bool,
}

/// Returns the products whose unions are solids, and the role of each leaf in one; `None` for leaves of other solids.
/// `is_simple` is true of leaves that are convex or bounded by one quadric.
pub(crate) fn find_products(
    solids: &[Vec<TreeStep>],
    leaf_count: usize,
    is_simple: &dyn Fn(usize) -> bool,
) -> (Vec<Product>, Vec<Option<ProductLeaf>>) {
    let mut products = Vec::new();
    let mut product_of = vec![None; leaf_count];
    for steps in solids {
        let of_solid = products_of(steps, is_simple).unwrap_or_default();
        for leaves in &of_solid {
            let number = products.len() as u32;
            products.push(Product {
                positives: leaves.iter().filter(|(_, outside)| !outside).count(),
                is_alone: of_solid.len() == 1,
            });
            for &(leaf, complemented) in leaves {
                product_of[leaf] = Some(ProductLeaf {
                    product: number,
                    complemented,
                });
            }
        }
    }
    (products, product_of)
}

/// The leaves of each product, with true for complemented ones.
type ProductLeaves = Vec<(usize, bool)>;

/// Returns the products whose union is the solid.
fn products_of(
    steps: &[TreeStep],
    is_simple: &dyn Fn(usize) -> bool,
) -> Option<Vec<ProductLeaves>> {
    /// A set as a union of products, and, if it is one, as a union of leaves.
    struct Set {
        products: Vec<ProductLeaves>,
        leaves: Option<Vec<usize>>,
    }
    /// Returns both lists as one, in any order.
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
    let mut stack: Vec<Set> = Vec::new();
    for step in steps {
        if let TreeStep::Leaf(leaf) = *step {
            if !is_simple(leaf) {
                return None;
            }
            stack.push(Set {
                products: vec![vec![(leaf, false)]],
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
            TreeStep::Intersection => Set {
                products: vec![joined(only(a.products)?, only(b.products)?)],
                leaves: None,
            },
            _ => {
                let outside = b.leaves?.into_iter().map(|leaf| (leaf, true)).collect();
                Set {
                    products: vec![joined(only(a.products)?, outside)],
                    leaves: None,
                }
            }
        });
    }
    Some(stack.pop()?.products)
}
