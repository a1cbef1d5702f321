//! The tests of geodesics, a module for each subject. They are one program: linking one for each takes minutes.

mod closed_forms;
mod conjugate;
mod creases;
mod estimates;
mod fan;
mod hard_stops;
mod implicit;
mod intrinsic;
mod measure_regions;
mod measures;
mod near;
mod pictures;
mod piecewise;
mod places_in_space;
mod poles;
mod random;
mod random_forms;
mod stiff;
#[allow(dead_code, unreachable_pub)]
#[path = "../../../../tests/src/stiff/mod.rs"]
mod stiff_list;
mod uneven_seams;

use stiff_list::shapes;
