//! The stiff list as a table: ours beside the thesis' method, for the same cases.

use testing::stiff::cases;

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
}
