//! The stiff list: every row keeps its bound. `cargo run --release -p geotrace-benches stiff` prints the table.

use crate::stiff_list::{Case, Row, cases};
use geodesic::trace::Options;

/// The rows with these names hold.
#[track_caller]
fn hold(ids: &[&str]) {
    let rows: Vec<Row> = cases()
        .iter()
        .filter(|case| ids.contains(&case.id))
        .map(Case::row)
        .collect();
    for id in ids {
        assert!(rows.iter().any(|row| row.id == *id), "no row {id}");
    }
    for row in &rows {
        println!(
            "{} {:55} {:28} {:8.1e} ≤ {:7.0e} {:6} thesis {:8.1e}",
            row.id, row.case, row.quantity, row.ours, row.bound, row.evaluations, row.thesis
        );
    }
    let failed: Vec<&Row> = rows.iter().filter(|row| !row.holds()).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn spheres_are_traced_round_and_through_their_poles() {
    hold(&["S1", "S2", "S3"]);
}

#[test]
fn tips_and_origins_are_passed() {
    hold(&["C1", "C2", "C3", "P1"]);
}

#[test]
fn charts_sheared_and_in_any_unit_give_the_same_lines() {
    hold(&["R1", "R2", "R3"]);
}

#[test]
fn tori_keep_clairauts_constant() {
    hold(&["T1", "T2", "T3", "T4", "T5", "T6", "T7"]);
}

#[test]
fn hyperbolic_lines_are_the_closed_forms() {
    hold(&["H1", "H2", "H3"]);
}

#[test]
fn ellipsoids_keep_what_they_conserve_and_focus() {
    hold(&["E1", "E2", "E4", "E5"]);
}

#[test]
fn the_earth_is_the_independent_programs() {
    hold(&["E3"]);
}

#[test]
fn bumps_isometries_and_zoll_surfaces_hold() {
    hold(&["B1", "B2", "I1", "Z1"]);
}

#[test]
fn creases_refract_and_cusps_stop() {
    hold(&["K1", "K2", "K3"]);
}

#[test]
fn what_holds_of_all_surfaces_holds() {
    hold(&["V1", "V2", "V3", "V4"]);
}

#[test]
fn no_row_of_the_list_is_left_out_of_these_tests() {
    let source = include_str!("stiff.rs");
    for case in cases() {
        assert!(source.contains(&format!("\"{}\"", case.id)), "{}", case.id);
    }
    let _ = Options::default();
}
