//! Every target with a fixed number of inputs from a fixed seed, and a few attempts of every attack. `GEOTRACE_FUZZ=10` gives
//! ten times as many.

use fuzz::run::{self, Report};
use fuzz::{ATTACKS, target};

fn times() -> u64 {
    let wanted = std::env::var("GEOTRACE_FUZZ").ok();
    wanted.and_then(|it| it.parse().ok()).unwrap_or(1)
}

fn check(name: &str) {
    let target = target(name).expect("a target");
    let report = run::run(target, 1, times() * target.tested);
    assert_passed(name, &report, target.tested);
}

fn assert_passed(name: &str, report: &Report, least: u64) {
    assert!(report.inputs >= least, "only {} inputs", report.inputs);
    let failures: Vec<_> = report
        .failures
        .iter()
        .map(|it| String::from_utf8_lossy(it))
        .collect();
    assert!(
        failures.is_empty(),
        "{} inputs of `{name}` fail; the first is {:?}",
        failures.len(),
        failures[0]
    );
}

macro_rules! targets {
    ($($name:ident)*) => {
        $(#[test] fn $name() { check(stringify!($name)); })*

        #[test]
        fn every_target_is_tested() {
            let tested = [$(stringify!($name)),*];
            let all: Vec<&str> = fuzz::TARGETS.iter().map(|it| it.name).collect();
            assert_eq!(all, tested);
        }
    };
}

targets! { program script edits format expression picture server requests protocol settings texture }

#[test]
fn attacks() {
    for attack in ATTACKS {
        let report = (attack.run)(1, times() * attack.tested);
        assert_passed(attack.name, &report, attack.tested);
    }
}
