//! The tests of the tracer, a module for each subject. They are one program: linking one for each takes minutes.

mod contours;
mod csg;
mod endless;
mod flush;
#[path = "../../../expr/tests/suite/formula/mod.rs"]
mod formula;
mod hostile;
mod look_crt;
mod pictures;
mod products;
mod scenes;
mod shading;
mod shapes;
mod sheets;
mod sheets_tight;
mod surfaces;
mod tables;
