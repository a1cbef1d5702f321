//! Undo and redo of changes of the view, never of the text.

use std::collections::VecDeque;

use super::difference::{Difference, Exchanged};
use super::view::View;

/// The name of a change.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Step {
    /// The title behind "Undo".
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

/// The entries that each step has replaced.
#[derive(Clone, Debug, Default)]
pub struct History {
    past: VecDeque<(Step, Difference)>,
    future: Vec<(Step, Difference)>,
    settled: bool,
}

/// The number of steps that are remembered.
const MAX_STEPS: usize = 200;

/// A step that was taken back, or made again.
#[derive(Debug)]
pub(super) struct Travelled {
    pub(super) title: &'static str,
    pub(super) cameras: Vec<String>,
}

impl History {
    pub(super) fn record(&mut self, step: Step, replaced: Difference) {
        self.future.clear();
        let joins = !std::mem::take(&mut self.settled);
        if let Some((last, before)) = self.past.back_mut()
            && joins
            && *last == step
        {
            before.add(replaced);
            return;
        }
        if self.past.len() == MAX_STEPS {
            self.past.pop_front();
        }
        self.past.push_back((step, replaced));
    }

    /// Ends a gesture: the next step is one of its own.
    pub fn settle(&mut self) {
        self.settled = true;
    }

    /// Returns the title of the step that would be undone.
    pub fn last(&self) -> Option<&'static str> {
        self.past.back().map(|(step, _)| step.title)
    }

    /// Returns the title of the step that would be done again.
    pub fn next(&self) -> Option<&'static str> {
        self.future.last().map(|(step, _)| step.title)
    }

    /// Takes the last step back that has changed anything.
    pub(super) fn undo(&mut self, view: &mut View) -> Option<Travelled> {
        loop {
            let (step, mut other) = self.past.pop_back()?;
            if let Some(travelled) = travel(&step, &mut other, view) {
                self.future.push((step, other));
                self.settled = true;
                return Some(travelled);
            }
        }
    }

    /// Makes the last step again that was taken back and would change anything.
    pub(super) fn redo(&mut self, view: &mut View) -> Option<Travelled> {
        loop {
            let (step, mut other) = self.future.pop()?;
            if let Some(travelled) = travel(&step, &mut other, view) {
                self.past.push_back((step, other));
                self.settled = true;
                return Some(travelled);
            }
        }
    }

    /// The text has given a component of a param its value: no step does any more.
    pub(super) fn drop_value(&mut self, param: &str, component: usize) {
        self.each(|it| it.drop_value(param, component));
    }

    /// Drops the 3D camera where the user has not moved it: it is placed anew.
    pub(super) fn reframe(&mut self) {
        self.each(Difference::reframe);
    }

    /// Drops the geodesic cameras that the user has not moved: they are placed anew.
    pub(super) fn settle_anew(&mut self) {
        self.each(Difference::settle_anew);
    }

    fn each(&mut self, edit: impl Fn(&mut Difference)) {
        let past = self.past.iter_mut();
        past.chain(&mut self.future)
            .for_each(|(_, other)| edit(other));
        self.past.retain(|(_, other)| !other.is_empty());
        self.future.retain(|(_, other)| !other.is_empty());
    }
}

fn travel(step: &Step, other: &mut Difference, view: &mut View) -> Option<Travelled> {
    let Exchanged { any, cameras } = other.exchange(view);
    any.then_some(Travelled {
        title: step.title,
        cameras,
    })
}
