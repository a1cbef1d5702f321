//! What the window shows, as plain data: no window, no thread, no picture.
//!
//! ```text
//! compiled texts ──take()──▶ Model ◀──change()── what the user does, each step under its name
//!                              │                     └─ history.rs: undo, redo
//!                              ├─ view.rs: what is remembered by name, and between runs
//!                              └─ settings(): values for the scene's params
//! ```

mod camera;
mod history;
mod view;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use scene::scene::{Object, ObjectId, Scene, Shape};
use scene::values::Settings;

pub use crate::compiler::Finding;
pub use camera::{InsideCamera, SpaceCamera};
pub use history::{History, Step};
pub use view::{Animation, Choice, Look, Marks, Preferences, SCALES, Theme, View, WAVEFRONTS};

use crate::compiler::Compiled;
pub use crate::walked::Walked;

/// The window's state.
#[derive(Debug, Default)]
pub struct Model {
    /// What the user has chosen to see.
    pub view: View,
    /// What can be undone.
    pub history: History,
    /// What is shown.
    pub scene: Option<Arc<Scene>>,
    /// The text that was compiled last.
    pub text: Arc<str>,
    /// Its version.
    pub version: i32,
    /// Whether it compiled.
    pub ok: bool,
    /// Whether any text has been compiled.
    pub read: bool,
    /// What compiling it took.
    pub took: std::time::Duration,
    /// What is wrong or surprising in it.
    pub findings: Vec<Finding>,
    /// The objects that are shown as they last were.
    pub stale: BTreeSet<String>,
    /// The object whose declaration the cursor stands on.
    pub highlighted: Option<String>,
    /// Counts the times that geodesic cameras were put somewhere by other means than walking.
    pub placed: u64,
    /// The ways that geodesic cameras have gone, by their surfaces' names, where they leave trails.
    pub walked: BTreeMap<String, Arc<Walked>>,
    /// Counts the times that trails were begun anew.
    pub trails_begun: u64,
    settings: Option<Arc<Settings>>,
}

impl Model {
    /// Takes over what a text compiled to. What it does not say stays as it is.
    pub(crate) fn take(&mut self, compiled: Compiled) {
        self.text = compiled.text;
        self.version = compiled.version;
        self.ok = compiled.ok;
        self.read = true;
        self.took = compiled.took;
        self.findings = compiled.findings;
        if let Some(scene) = compiled.scene {
            self.heed_openings(&scene);
            self.scene = Some(scene);
            self.stale = compiled.stale.into_iter().collect();
            self.settings = None;
        }
    }

    /// Where the text gives a param another value than before, that is the one it has now: what was said last holds.
    fn heed_openings(&mut self, scene: &Scene) {
        let Some(old) = &self.scene else {
            return;
        };
        let (before, after) = (Settings::opening(old), Settings::opening(scene));
        for param in &scene.params {
            let known = old.params.iter().find(|it| it.name == param.name);
            let same_ranges = known.is_some_and(|it| it.ranges == param.ranges);
            if same_ranges && known.is_some_and(|it| before.param(it) != after.param(param)) {
                self.view.params.remove(&param.name);
            }
        }
    }

    /// Whether a picture of an object shows it as it no longer is in the text.
    pub fn is_stale(&self) -> bool {
        !self.ok && self.read
    }

    /// Does a step that can be undone.
    pub fn change(&mut self, step: Step, edit: impl FnOnce(&mut View)) {
        let before = self.view.clone();
        edit(&mut self.view);
        if self.view == before {
            return;
        }
        self.history.record(step, before);
        self.settings = None;
    }

    /// Remembers the view for a step that is done elsewhere, and comes back by [`Model::adjust`].
    pub fn begin(&mut self, step: Step) {
        self.history.record(step, self.view.clone());
    }

    /// Changes the view without a step: an animation, or what a worker has found out.
    pub fn adjust(&mut self, edit: impl FnOnce(&mut View)) {
        edit(&mut self.view);
        self.settings = None;
    }

    /// Takes the last step back; its name.
    pub fn undo(&mut self) -> Option<&'static str> {
        let title = self.history.undo(&mut self.view)?;
        self.placed += 1;
        self.settings = None;
        Some(title)
    }

    /// Does the last step again that was taken back; its name.
    pub fn redo(&mut self) -> Option<&'static str> {
        let title = self.history.redo(&mut self.view)?;
        self.placed += 1;
        self.settings = None;
        Some(title)
    }

    /// The params' values for the scene: those that were chosen, kept within their intervals.
    pub fn settings(&mut self) -> Option<Arc<Settings>> {
        let scene = self.scene.as_ref()?;
        let view = &self.view;
        let settings = self.settings.get_or_insert_with(|| {
            let mut settings = Settings::opening(scene);
            for param in &scene.params {
                let Some(values) = view.params.get(&param.name) else {
                    continue;
                };
                let mut all = settings.param(param).to_vec();
                for ((value, chosen), range) in all.iter_mut().zip(values).zip(&param.ranges) {
                    if chosen.is_finite() {
                        *value = chosen.clamp(range.min, range.max);
                    }
                }
                // Within their intervals, they are not refused.
                let _ = settings.set(scene, &param.name, &all);
            }
            Arc::new(settings)
        });
        Some(Arc::clone(settings))
    }

    /// The objects of the scene that are hidden in space.
    pub fn hidden(&self) -> Vec<ObjectId> {
        let objects = self.scene.iter().flat_map(|scene| &scene.objects);
        let numbered = (0..).map(ObjectId).zip(objects);
        let hidden = numbered.filter(|(_, object)| self.view.look(&object.name).hidden);
        hidden.map(|(id, _)| id).collect()
    }

    /// The object of a name.
    pub fn object(&self, name: &str) -> Option<(ObjectId, &Object)> {
        let objects = &self.scene.as_ref()?.objects;
        (0..)
            .map(ObjectId)
            .zip(objects)
            .find(|(_, it)| it.name == name)
    }

    /// Whether there are metrics, geodesics on them, and nothing else: no object has a place in space.
    pub fn has_only_metrics(&self) -> bool {
        let objects = self.scene.as_ref().map_or(&[][..], |scene| &scene.objects);
        let is_metric = |object: &Object| matches!(object.shape, Shape::Metric { .. });
        let placeless = |object: &Object| match &object.shape {
            Shape::Geodesic { surface, .. } => {
                objects.get(surface.0 as usize).is_some_and(is_metric)
            }
            _ => is_metric(object),
        };
        !objects.is_empty() && objects.iter().all(placeless)
    }

    /// The names of the surfaces and metrics, in the order of the text.
    pub fn surfaces(&self) -> Vec<String> {
        let objects = self.scene.iter().flat_map(|scene| &scene.objects);
        objects
            .filter(|object| object.shape.patch().is_some())
            .map(|object| object.name.clone())
            .collect()
    }

    /// The name that is declared around a place of the text.
    pub fn declared_at(&self, offset: u32) -> Option<&str> {
        let scene = self.scene.as_ref()?;
        let end = |from: u32| {
            let rest = self.text.get(from as usize..)?;
            Some(from + rest.find(';')? as u32 + 1)
        };
        let start = |from: u32| {
            let before = self.text.get(..from as usize)?;
            Some(before.rfind([';', '\n']).map_or(0, |at| at as u32 + 1))
        };
        let around = |object: &&Object| {
            let at = object.name_span.start;
            let range = start(at).map(|from| from..=end(at).unwrap_or(u32::MAX));
            range.is_some_and(|range| range.contains(&offset))
        };
        let found = scene.objects.iter().find(around)?;
        Some(&found.name)
    }

    /// What the status line says of the text.
    pub fn status(&self) -> String {
        let errors = self.errors().count();
        match self.errors().next() {
            None if !self.read => "Status: reading".to_owned(),
            None => "Status: OK".to_owned(),
            Some(first) => {
                let more = match errors - 1 {
                    0 => String::new(),
                    1 => " (and 1 more)".to_owned(),
                    n => format!(" (and {n} more)"),
                };
                format!(
                    "Status: line {}, column {}: {}{more}",
                    first.line, first.column, first.message
                )
            }
        }
    }

    /// The errors among the findings.
    pub fn errors(&self) -> impl Iterator<Item = &Finding> {
        let is_error = |it: &&Finding| it.severity == syntax::diagnostic::Severity::Error;
        self.findings.iter().filter(is_error)
    }

    /// Moves what is animated by some seconds, each up to its greatest value and then from its least; whether
    /// anything has moved.
    pub fn animate(&mut self, seconds: f64) -> bool {
        let Some(scene) = self.scene.clone() else {
            return false;
        };
        let Some(settings) = self.settings() else {
            return false;
        };
        let mut moved = false;
        for param in &scene.params {
            let Some(animation) = self.view.animations.get(&param.name) else {
                continue;
            };
            let mut values = settings.param(param).to_vec();
            let speed = animation.speed;
            let mut any = false;
            for (k, (value, range)) in values.iter_mut().zip(&param.ranges).enumerate() {
                if animation.on.get(k).copied().unwrap_or(false) {
                    *value = advanced(*value, seconds * speed, range.min, range.max);
                    any = true;
                }
            }
            if any {
                moved = true;
                self.adjust(|view| {
                    view.params.insert(param.name.clone(), values);
                });
            }
        }
        moved
    }

    /// Whether anything is animated.
    pub fn is_animated(&self) -> bool {
        let params = self.scene.iter().flat_map(|scene| &scene.params);
        params
            .filter_map(|param| {
                let animation = self.view.animations.get(&param.name)?;
                Some(animation.on.iter().take(param.ranges.len()).any(|on| *on))
            })
            .any(|on| on)
    }
}

/// A value that has grown by a step and begins anew at the least when it passes the greatest.
fn advanced(value: f64, step: f64, min: f64, max: f64) -> f64 {
    let next = value + step;
    if (min..=max).contains(&next) {
        return next;
    }
    let width = max - min;
    if width.is_finite() && width > 0.0 {
        (min + (next - min).rem_euclid(width)).clamp(min, max)
    } else {
        min
    }
}

#[cfg(test)]
mod tests;
