//! The estimated error of the geodesic view against the truth, over random scenes.

use geodesic::map::MapMethod;
use rayon::prelude::*;
use testing::inside::{Held, held, random_view};

const SCENES: u64 = 10_000;

/// Prints how the truth over the estimate is spread.
pub(crate) fn run() {
    let all: Vec<(u64, Held)> = (0..SCENES)
        .into_par_iter()
        .filter_map(|number| Some((number, held(&random_view(number)?, MapMethod::Fan)?)))
        .collect();
    let mut ratios: Vec<(f64, u64)> = all
        .iter()
        .map(|(number, held)| (held.truth / held.estimate, *number))
        .collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = ratios.len();
    println!(
        "The largest error of all pixels over the estimated one, {count} random scenes, tolerances from 0.01 to 1 px"
    );
    if count == 0 {
        return;
    }
    let outside = |low: f64, high: f64| {
        ratios
            .iter()
            .filter(|(ratio, _)| !(low..=high).contains(ratio))
            .count()
    };
    for (name, number) in [
        ("within 2×", count - outside(0.5, 2.0)),
        ("below a half", outside(0.5, f64::INFINITY)),
        ("above 2×", outside(0.0, 2.0)),
        ("above 3×", outside(0.0, 3.0)),
    ] {
        let share = 100.0 * number as f64 / count as f64;
        println!("  {name:14} {number:5} scenes, {share:6.2} %");
    }
    let at = |share: f64| ratios[(share * (count - 1) as f64).round() as usize];
    let shares = [0.0, 0.025, 0.1, 0.5, 0.9, 0.975, 1.0];
    let quantiles = shares.map(|share| format!("{:.1} %: {:.2}", 100.0 * share, at(share).0));
    println!("  quantiles: {}", quantiles.join(", "));
    let low: Vec<String> = ratios
        .iter()
        .filter(|(ratio, _)| *ratio > 3.0)
        .map(|(ratio, number)| format!("{number} ({ratio:.2})"))
        .collect();
    println!("  those above 3×, by their numbers: {}", low.join(", "));
}
