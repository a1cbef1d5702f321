//! The stiff list as a table: ours beside the thesis' method, for the same cases. Then pictures of a surface on which
//! geodesics part chaotically, and whose fault it is where one is off by more than was asked.

use geodesic::frame::Frame;
use geodesic::map::{MapMethod, MapOptions, exponential_map};
use geodesic::reference::Reference;
use geodesic::trace::Status;
use testing::draw::scene;
use testing::inside::opening;
use testing::stiff::cases;

/// Bumps of a third of a unit, each a tenth high.
const BUMPS: &str = "surface s(u,v) = (u, v, 0.1 sin(20u) sin(20v)), u : [-3, 3], v : [-3, 3];";
/// A side of its pictures, in pixels.
const SIDE: u32 = 128;
/// How many of their pixels are traced.
const TRACED: usize = 2000;

/// Prints the list.
pub(crate) fn run() {
    println!(
        "Stiff cases: what is measured, ours, its bound, evaluations of the dearest ray, and the thesis' method"
    );
    println!(
        "(classical Runge–Kutta, 512 steps in (u,v)); NaN where a ray does not get where it should.\n"
    );
    println!("| id | case | quantity | ours | bound | evaluations | thesis |");
    println!("| --- | --- | --- | --: | --: | --: | --: |");
    let mut missed = 0;
    for case in cases() {
        let row = case.row();
        let mark = if row.holds() { "" } else { " (missed)" };
        missed += usize::from(!row.holds());
        println!(
            "| {} | {} | {} | {:.1e} | {:.0e}{mark} | {} | {:.1e} |",
            row.id, row.case, row.quantity, row.ours, row.bound, row.evaluations, row.thesis
        );
    }
    if missed > 0 {
        println!("\n{missed} missed their bounds.");
    }
    println!();
    chaos();
}

/// Bumps from inside, by the fan and pixel by pixel: with no step of its own in common with them, the second says what
/// the integrator is worth, and the reference's own doubts stand beside both.
fn chaos() {
    let Some(view) = opening(&scene(BUMPS)) else {
        return;
    };
    let surface = view.surface();
    println!("Chaos: bumps 0.1 sin 20u sin 20v, {SIDE} × {SIDE} pixels, {TRACED} of them traced\n");
    println!(
        "| zoom | method | asked px | max px | 99 % px | estimate px | over what is asked | unresolved | truth unknown |"
    );
    println!("| --: | --- | --: | --: | --: | --: | --: | --: | --: |");
    for zoom in [0.3, 1.0] {
        let frame = match Frame::new(surface, [0.1, 0.2], 0.3, zoom) {
            Ok(frame) => frame,
            Err(error) => return println!("{error}"),
        };
        let mut reference = Reference::new(surface, &frame, [SIDE; 2], TRACED);
        for (name, method, tolerance) in [
            ("fan", MapMethod::Fan, 0.1),
            ("fan", MapMethod::Fan, 0.03),
            ("adaptive", MapMethod::Adaptive, 0.1),
        ] {
            let options = MapOptions {
                method,
                tolerance,
                ..MapOptions::default()
            };
            let map = exponential_map(surface, &frame, [SIDE; 2], &options, &|_| {});
            let errors = reference.errors(&|index| (map.uv(index), map.status[index]));
            let share = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;
            let over = errors.sample.iter().filter(|x| **x > tolerance).count();
            let limited = map
                .status
                .iter()
                .filter(|x| **x == Status::WorkLimit)
                .count();
            println!(
                "| {zoom} | {name} | {tolerance} | {:.3} | {:.3} | {:.3} | {:.2} % | {:.2} % | {:.2} % |",
                errors.max,
                errors.quantile(0.99),
                map.estimate.map_or(f64::NAN, |estimate| estimate.max),
                share(over, errors.pixels),
                share(limited, map.status.len()),
                share(errors.unknown, errors.pixels),
            );
        }
    }
}
