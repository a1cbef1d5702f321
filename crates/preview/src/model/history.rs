//! Undo and redo of changes of the view, never of the text.

use super::View;

/// The name of a change.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Step {
    /// What the user reads behind "Undo".
    pub title: &'static str,
    /// Steps in a row with the same mark are one, until [`History::settle`].
    pub mark: String,
}

impl Step {
    /// A step that is joined with those like it.
    pub fn new(title: &'static str, mark: impl Into<String>) -> Self {
        Self {
            title,
            mark: mark.into(),
        }
    }
}

/// Views as they were before each step.
#[derive(Clone, Debug, Default)]
pub struct History {
    past: Vec<(Step, View)>,
    future: Vec<(Step, View)>,
    settled: bool,
}

/// How many steps are remembered.
const MAX_STEPS: usize = 200;

impl History {
    pub(super) fn record(&mut self, step: Step, before: View) {
        self.future.clear();
        let joins = !self.settled && self.past.last().is_some_and(|(last, _)| *last == step);
        self.settled = false;
        if joins {
            return;
        }
        if self.past.len() == MAX_STEPS {
            self.past.remove(0);
        }
        self.past.push((step, before));
    }

    /// Ends a gesture: the next step is one of its own.
    pub fn settle(&mut self) {
        self.settled = true;
    }

    /// What would be undone.
    pub fn last(&self) -> Option<&'static str> {
        self.past.last().map(|(step, _)| step.title)
    }

    /// What would be done again.
    pub fn next(&self) -> Option<&'static str> {
        self.future.last().map(|(step, _)| step.title)
    }

    pub(super) fn undo(&mut self, view: &mut View) -> Option<&'static str> {
        let (step, before) = self.past.pop()?;
        let title = step.title;
        self.future.push((step, std::mem::replace(view, before)));
        self.settled = true;
        Some(title)
    }

    pub(super) fn redo(&mut self, view: &mut View) -> Option<&'static str> {
        let (step, after) = self.future.pop()?;
        let title = step.title;
        self.past.push((step, std::mem::replace(view, after)));
        self.settled = true;
        Some(title)
    }
}
