//! Exact ray casting.
//!
//! ```text
//! expressions, set operations, maps ──world.rs──▶ World ──cast.rs──▶ crossings of a ray
//!          │ shape.rs: boxes (bounds.rs), polynomials (surface.rs) and other expressions (field.rs)
//!          │ shared.rs: coincident surfaces           tree.rs: set operations         bvh.rs: a hierarchy of boxes
//! ```
//!
//! Rays with similar directions are processed in bundles (`bundle.rs`, `near.rs`): a leaf that none of them meets is
//! excluded once for all of them, and solids that are unions of products of simple leaves (`product.rs`, `first.rs`) need no
//! sweep.
//!
//! Pictures (`picture.rs`) follow rays from a camera (`camera.rs`) through the world, parametric surfaces (`sheet.rs`) and
//! lights (`shade.rs`, `light.rs`, `optics.rs`).
//!
//! `contour.rs` makes meshes of solids, and `tables.rs` converts a world to tables for GPUs.
//!
//! A solid is a tree of set operations on shapes under affine maps; a shape is the set where an expression is not positive.
//! Combinations of polynomials are solved as such (`roots.rs`), other expressions by interval arithmetic. There are no
//! settings and no tolerances. Everything is in f64 and depends only on the world and the ray.
//!
//! Of the maintained libraries, `fidget` evaluates in f32 and finds surfaces on a grid of samples, and `parry` supports
//! neither implicit shapes nor set operations on rays; `roots.rs` explains why no polynomial solver is used, and
//! [`expr::interval`] why no interval library is.
//!
//! ```
//! use expr::{Graph, Input};
//! use glam::{DAffine3, DVec3};
//! use tracer::{Ray, SetStep, WorldBuilder};
//!
//! let mut graph = Graph::default();
//! let squares = [0, 1, 2].map(|k| {
//!     let x = graph.input(Input::Variable(k));
//!     graph.mul(x, x)
//! });
//! let [xx, yy, zz] = squares;
//! let sum = graph.add(xx, yy);
//! let sum = graph.add(sum, zz);
//! let one = graph.constant(1.0);
//! let ball = graph.sub(sum, one);
//!
//! let no_uniforms = |_| f64::NAN;
//! let mut builder = WorldBuilder::new(&graph, &no_uniforms);
//! let ball = builder.shape(ball, [None; 3])?;
//! builder.solid(&[SetStep::Leaf(ball, DAffine3::IDENTITY)])?;
//! let world = builder.build()?;
//! let ray = Ray { origin: DVec3::new(0.0, 0.0, -3.0), direction: DVec3::Z, leaving: None };
//! let t: Vec<f64> = world.caster().cast(&ray).iter().map(|crossing| crossing.t).collect();
//! assert_eq!(t, [2.0, 4.0]);
//! # Ok::<(), tracer::BuildError>(())
//! ```

mod bounds;
mod bundle;
mod bvh;
pub mod camera;
mod cast;
mod contour;
mod field;
mod first;
mod frame;
mod leaf;
pub mod light;
mod line;
mod look;
mod low;
mod near;
pub mod optics;
pub mod picture;
mod product;
mod program;
mod region_bounds;
mod roots;
pub mod shade;
mod shape;
mod shared;
mod sheet;
mod sheets;
pub mod srgb;
mod surface;
pub mod tables;
mod threads;
mod tree;
mod world;

pub use bounds::{BoundingBox, LARGEST_EXPONENT, WorkBudget};
pub use cast::{Caster, Crossing};
pub use contour::{SolidMesh, contour};
pub use field::{MOST_RAY_EVALUATIONS, TILE_RAY_OPERATIONS};
pub use line::{Ray, SurfaceId};
pub use look::{PictureLook, gamma_encoded};
pub use sheet::{MOST_HALVED, Sheet, SheetCounters, SheetHit, SheetScratch};
pub use sheets::{Sheets, SheetsRay};
pub use world::{BuildError, SEARCHED_RADII, SetStep, ShapeId, World, WorldBuilder, is_singular};
