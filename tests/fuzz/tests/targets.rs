//! Every target with a fixed number of inputs from a fixed seed. `GEOTRACE_FUZZ=10` gives ten times as many.

use fuzz::{run, target};

fn check(name: &str) {
    let target = target(name).expect("a target");
    let times = std::env::var("GEOTRACE_FUZZ")
        .ok()
        .and_then(|it| it.parse().ok());
    let report = run::run(target, 1, times.unwrap_or(1) * target.tested);
    assert!(
        report.inputs >= target.tested,
        "only {} inputs",
        report.inputs
    );
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

targets! { program script edits format expression picture server protocol settings texture }
