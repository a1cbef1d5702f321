//! The scene as data, and the compilers that make one.
//!
//! ```text
//! text ──syntax::geotrace──▶ hooks ──▶ geotrace.rs ──▶ Scene  +  diagnostics
//!                                                        │
//!      names and numbers ──▶ param_values.rs ────────────┼──▶ uniforms of each instance
//!      an expression     ──▶ evaluation.rs ──────────────┼──▶ its value
//!      a geodesic        ──▶ initial_conditions_evaluator.rs ┼──▶ its start and its direction
//!                            geodesic_value.rs ──────────┴──▶ its points and velocities, which expressions read
//! ```
//!
//! A scene is data: expressions in one graph, and handles into it. It knows no language, no view and no GPU. A language
//! is a module that produces a [`Scene`]; the modules beside it do not depend on any language.

pub mod crt;
mod evaluation;
mod geodesic_value;
pub mod geotrace;
mod ids;
mod initial_conditions;
mod initial_conditions_evaluator;
pub mod limits;
mod metric;
mod param_values;
mod program_scene;
mod range;
mod rerun;
mod scene;
mod solid;
mod solid_field;
mod stated_picture;

pub use evaluation::{Evaluation, Instance, Outcome, Value};
pub use geodesic_value::{
    GeodesicCache, GeodesicFault, GeodesicValue, Ground, MAX_VALUE_EVALUATIONS, ManifoldNodes,
    ValueKind,
};
pub use initial_conditions::{InitialConditions, InitialConditionsError};
pub use initial_conditions_evaluator::InitialConditionsEvaluator;
pub use param_values::{ParamValues, SetError};
pub use program_scene::ProgramScene;
pub use rerun::{FailedRun, Rerun};
pub use scene::{
    GeodesicPath, Grid, GridId, Object, ObjectId, Param, ParamId, Range, Sampling, Scene, Shape,
    SpacePath,
};
pub use solid::{
    AffineNodes, Attribute, AttributeValue, Background, BoundGrid, Camera, Cut, Light, Solid,
    SolidLeaf, SolidStep, stated_word,
};
pub use stated_picture::{StatedPicture, StatedSetting};
