//! Undo and redo of changes of the choices. Changes of the text are not among them.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use scene::ParamValues;

use super::choices::Choices;
use super::difference::{Difference, Exchanged};
use super::path::CameraPath;

/// The name of a change.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Step {
    /// The title after "Undo".
    pub title: &'static str,
    /// Consecutive steps with the same mark are joined into one, until [`History::settle`].
    pub mark: String,
}

impl Step {
    /// Returns a step that is joined with those of the same mark.
    pub fn new(title: &'static str, mark: impl Into<String>) -> Self {
        Self {
            title,
            mark: mark.into(),
        }
    }
}

/// The steps that were made, and those that were undone.
#[derive(Clone, Debug, Default)]
pub struct History {
    past: VecDeque<MadeStep>,
    future: Vec<MadeStep>,
    settled: bool,
}

/// A step with what it has replaced.
#[derive(Clone, Debug)]
struct MadeStep {
    step: Step,
    replaced: Difference,
    trails: Trails,
}

/// The paths of geodesic cameras that a step has ended or extended, by surface; `None` where there was no path.
pub(super) type Trails = BTreeMap<String, Option<EndedTrail>>;

/// A path that has ended, and the params' values for which it is a geodesic path.
#[derive(Clone, Debug)]
pub(super) struct EndedTrail {
    pub(super) path: Arc<CameraPath>,
    pub(super) param_values: Arc<ParamValues>,
}

/// The maximum number of steps that are remembered.
const MAX_STEPS: usize = 200;

/// Replaces the path of a surface's camera, and returns the old one.
pub(super) type ExchangeTrails<'f> = dyn FnMut(&str, Option<EndedTrail>) -> Option<EndedTrail> + 'f;

impl History {
    pub(super) fn record(&mut self, step: Step, replaced: Difference, trails: Trails) {
        let joins = self.joins(&step);
        self.future.clear();
        self.settled = false;
        if let Some(last) = self.past.back_mut().filter(|_| joins) {
            last.replaced.add(replaced);
            return;
        }
        if self.past.len() == MAX_STEPS {
            self.past.pop_front();
        }
        self.past.push_back(MadeStep {
            step,
            replaced,
            trails,
        });
    }

    /// Returns whether a step would be joined with the last one.
    pub(super) fn joins(&self, step: &Step) -> bool {
        let last = self.past.back().map(|last| &last.step);
        !self.settled && last == Some(step)
    }

    /// Ends a gesture: the next step is not joined with the last one.
    pub fn settle(&mut self) {
        self.settled = true;
    }

    /// Returns the title of the step that would be undone.
    pub fn last(&self) -> Option<&'static str> {
        self.past.back().map(|last| last.step.title)
    }

    /// Returns the title of the step that would be redone.
    pub fn next(&self) -> Option<&'static str> {
        self.future.last().map(|next| next.step.title)
    }

    /// Undoes the last step that has an effect. Returns its title.
    pub(super) fn undo(
        &mut self,
        choices: &mut Choices,
        exchange: &mut ExchangeTrails<'_>,
    ) -> Option<&'static str> {
        loop {
            let mut entry = self.past.pop_back()?;
            if let Some(title) = entry.travel(choices, exchange) {
                self.future.push(entry);
                self.settled = true;
                return Some(title);
            }
        }
    }

    /// Redoes the next step that has an effect. Returns its title.
    pub(super) fn redo(
        &mut self,
        choices: &mut Choices,
        exchange: &mut ExchangeTrails<'_>,
    ) -> Option<&'static str> {
        loop {
            let mut entry = self.future.pop()?;
            if let Some(title) = entry.travel(choices, exchange) {
                self.past.push_back(entry);
                self.settled = true;
                return Some(title);
            }
        }
    }

    /// Drops a component of a param from all steps: the text has given it its value.
    pub(super) fn drop_value(&mut self, param: &str, component: usize) {
        self.each(|it| it.replaced.drop_value(param, component));
    }

    /// Drops the 3D camera from all steps where the user has not moved it: it is placed anew.
    pub(super) fn reframe(&mut self) {
        self.each(|it| it.replaced.reframe());
    }

    /// Drops the entries that belong to a replaced scene: the geodesic cameras that the user has not moved, which are
    /// placed anew, and the paths.
    pub(super) fn note_scene(&mut self) {
        self.each(|it| {
            it.replaced.settle_anew();
            it.trails.values_mut().for_each(|trail| *trail = None);
        });
    }

    fn each(&mut self, edit: impl Fn(&mut MadeStep)) {
        self.past.iter_mut().chain(&mut self.future).for_each(edit);
        self.past.retain(MadeStep::has_any);
        self.future.retain(MadeStep::has_any);
    }
}

impl MadeStep {
    fn has_any(&self) -> bool {
        !self.replaced.is_empty() || self.trails.values().any(Option::is_some)
    }

    /// Exchanges what the step has replaced with the current state. Returns `None` if the two are the same.
    fn travel(
        &mut self,
        choices: &mut Choices,
        exchange: &mut ExchangeTrails<'_>,
    ) -> Option<&'static str> {
        let Exchanged { mut any, cameras } = self.replaced.exchange(choices);
        for surface in cameras {
            self.trails.entry(surface).or_default();
        }
        for (surface, trail) in &mut self.trails {
            any |= trail.is_some();
            *trail = exchange(surface, trail.take());
            any |= trail.is_some();
        }
        any.then_some(self.step.title)
    }
}
