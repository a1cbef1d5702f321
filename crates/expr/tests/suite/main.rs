//! The tests of expressions, a module for each subject. They are one program: linking one for each takes minutes.

mod conformance;
mod derivatives;
mod elementary;
mod formula;
mod intervals;
mod jets;
mod limits;
mod lines;
mod polynomials;
mod simplification;
mod values;
mod vectors;
