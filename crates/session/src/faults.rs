//! The faults of a program as they are shown. While the user types, most faults concern unfinished text: a fault is
//! shown only after a pause, and one that is gone disappears at once.

use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;

use syntax::diagnostic::Severity;

use super::program::Finding;

/// The faults of a text, and the objects that are therefore shown in an earlier form.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Diagnosis {
    /// The diagnostics, sorted by position; shared, since there may be a million of them.
    pub(crate) findings: Arc<[Finding]>,
    /// The objects that are shown in their last valid form, and those that depend on them.
    pub(crate) stale: BTreeSet<String>,
}

/// The diagnosis that is shown, and the newest one.
#[derive(Debug, Default)]
pub struct ProgramFaults {
    shown: Diagnosis,
    latest: Diagnosis,
}

impl ProgramFaults {
    /// Takes over the diagnosis of a newer text. Faults that it no longer has are no longer shown.
    pub(crate) fn take(&mut self, latest: Diagnosis) {
        let before = std::mem::take(&mut self.shown);
        let shown = before.findings.iter();
        let known: HashSet<_> = shown.map(|it| (it.severity, it.message.as_str())).collect();
        let was_shown = |it: &&Finding| known.contains(&(it.severity, it.message.as_str()));
        let kept = latest.findings.iter().filter(was_shown);
        self.shown = Diagnosis {
            findings: match kept.clone().count() == latest.findings.len() {
                true => latest.findings.clone(),
                false => kept.cloned().collect(),
            },
            stale: before.stale.intersection(&latest.stale).cloned().collect(),
        };
        self.latest = latest;
    }

    /// Takes over the findings of the same text for other values of the params, and shows them: nobody is typing.
    pub(crate) fn take_run(&mut self, findings: Arc<[Finding]>) {
        self.latest.findings = findings;
        self.show_latest();
    }

    /// Shows the newest diagnosis.
    pub fn show_latest(&mut self) {
        self.shown.clone_from(&self.latest);
    }

    /// Returns whether a fault waits for a pause in typing.
    pub fn are_waiting(&self) -> bool {
        self.shown != self.latest
    }

    /// Returns the diagnostics that are shown, sorted by position.
    pub fn findings(&self) -> &[Finding] {
        &self.shown.findings
    }

    /// Returns the errors among them.
    pub fn errors(&self) -> impl Iterator<Item = &Finding> {
        let is_error = |it: &&Finding| it.severity == Severity::Error;
        self.shown.findings.iter().filter(is_error)
    }

    /// Returns the objects that are marked as out of date.
    pub fn stale(&self) -> &BTreeSet<String> {
        &self.shown.stale
    }

    /// Returns the number of errors and warnings in words.
    pub fn count(&self) -> String {
        let count = |severity, one: &str| {
            let all = self.shown.findings.iter();
            match all.filter(|it| it.severity == severity).count() {
                0 => None,
                1 => Some(format!("1 {one}")),
                n => Some(format!("{n} {one}s")),
            }
        };
        let errors = count(Severity::Error, "error");
        let errors = errors.unwrap_or_else(|| "no errors".to_owned());
        match count(Severity::Warning, "warning") {
            Some(warnings) => format!("{errors}, {warnings}"),
            None => errors,
        }
    }
}

#[cfg(test)]
mod tests {
    use syntax::diagnostic::Severity;
    use syntax::span::Span;

    use super::{Diagnosis, ProgramFaults};
    use crate::Finding;

    fn diagnosis(messages: &[&str], stale: &[&str]) -> Diagnosis {
        let finding = |message: &&str| Finding {
            severity: Severity::Error,
            span: Span::default(),
            line: 1,
            column: 1,
            message: (*message).to_owned(),
            hint: None,
            fixes: Vec::new(),
        };
        Diagnosis {
            findings: messages.iter().map(finding).collect(),
            stale: stale.iter().map(|name| (*name).to_owned()).collect(),
        }
    }

    fn messages(faults: &ProgramFaults) -> Vec<&str> {
        let findings = faults.findings().iter();
        findings.map(|it| it.message.as_str()).collect()
    }

    #[test]
    fn a_fault_waits_for_a_pause_and_goes_at_once() {
        let mut faults = ProgramFaults::default();
        faults.take(diagnosis(&["a"], &["p"]));
        assert!(faults.are_waiting() && faults.stale().is_empty());
        assert_eq!(faults.count(), "no errors");
        faults.show_latest();
        assert_eq!((messages(&faults), faults.stale().len()), (vec!["a"], 1));
        // The next one waits again, and the one that is shown stays.
        faults.take(diagnosis(&["a", "b"], &["p", "q"]));
        assert_eq!((messages(&faults), faults.stale().len()), (vec!["a"], 1));
        assert_eq!(faults.count(), "1 error");
        faults.take(diagnosis(&["b"], &["q"]));
        assert!(messages(&faults).is_empty() && faults.stale().is_empty());
        faults.show_latest();
        assert_eq!(messages(&faults), ["b"]);
        faults.take(diagnosis(&[], &[]));
        assert!(messages(&faults).is_empty() && !faults.are_waiting());
    }
}
