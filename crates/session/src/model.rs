//! The state of a session: the program that is shown, the user's choices, and the undo history.

mod geodesic_cameras;
mod looks;
mod placement;
mod space_camera;

use std::collections::BTreeMap;
use std::sync::Arc;

use ide::language::Analysis;
use ide::outline::DeclarationRange;
use render::trail::Trail;
use scene::ParamValues;
use scene::{Object, ObjectId, Scene};
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use super::camera_controller::CameraController;
use super::choices::{Animation, Choices, DeclaredValue, Marks, chosen_values};
use super::difference::Difference;
use super::faults::{Diagnosis, ProgramFaults};
use super::history::{EndedTrail, ExchangeTrails, History, Step, Trails};
use super::path::CameraPath;
use super::program::{Compiled, ReadProgram};
use super::reader::findings;
use placement::Placement;

/// The background of the views in space in a light window, sRGB.
const LIGHT_BACKGROUND: [u8; 3] = [214, 218, 226];

/// The state of the emphasis of an object in the views in space.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Emphasis {
    /// No object is emphasised.
    #[default]
    Off,
    /// Another object has just been highlighted.
    Begins,
    /// The object is emphasised for a while.
    On,
}

/// A text that has been read, for editor features.
#[derive(Clone, Debug)]
pub struct ReadText {
    /// Its version.
    pub version: i32,
    /// The analysis that answers an editor's questions.
    pub analysis: Arc<dyn Analysis>,
}

/// The state of a session.
#[derive(Debug, Default)]
pub struct Model {
    /// The user's choices of what is shown.
    pub choices: Choices,
    /// The steps that can be undone.
    pub history: History,
    /// The scene that is shown: that of the params' values, unless it awaits a rerun.
    pub scene: Option<Arc<Scene>>,
    /// The program that was read last.
    pub program: ReadProgram,
    /// True once a text has been read.
    pub read: bool,
    /// True if the scene is made of the program that was read last, and not of an earlier one.
    shows_text: bool,
    /// The faults of the program that are shown.
    pub faults: ProgramFaults,
    /// The object whose declaration the cursor is in.
    pub highlighted: Option<String>,
    /// The state of that object's emphasis in the views in space. It ends after a while, so that the object's colours
    /// can be judged.
    pub emphasis: Emphasis,
    /// True if the window has a light theme.
    pub is_light: bool,
    /// The paths of the geodesic cameras that leave trails, by their surfaces' names.
    pub paths: BTreeMap<String, Arc<CameraPath>>,
    /// The lines of the measured figure, with its surface's name.
    pub measured: Option<(String, Vec<Arc<Trail>>)>,
    controllers: BTreeMap<String, CameraController>,
    param_values: Option<Arc<ParamValues>>,
    /// A geodesic camera's new position that may still be withdrawn.
    placing: Option<Placement>,
}

impl Model {
    /// Takes over the saved choices of another program. The history of the previous one is dropped.
    pub fn turn_to(&mut self, choices: Choices) {
        self.history = History::default();
        self.placing = None;
        self.paths.clear();
        self.measured = None;
        self.choices = choices;
        self.param_values = None;
    }

    /// Drops the program that is shown, with its scene.
    pub fn forget_program(&mut self) {
        self.scene = None;
        self.program = ReadProgram {
            version: self.program.version,
            ..ReadProgram::default()
        };
        self.read = false;
        self.faults = ProgramFaults::default();
        self.highlighted = None;
        self.controllers.clear();
    }

    /// Takes over a compiled text. What the text does not determine stays as it is.
    pub fn take(&mut self, compiled: Compiled) {
        self.program = compiled.program;
        self.shows_text = compiled.scene.is_some();
        let is_first = !std::mem::replace(&mut self.read, true);
        let stale = if compiled.scene.is_some() {
            compiled.stale.into_iter().collect()
        } else {
            // Everything that is shown is from another text.
            let objects = self.scene.iter().flat_map(|scene| &scene.objects);
            objects.map(|object| object.name.clone()).collect()
        };
        let scene = compiled.scene.as_ref();
        let of_run = scene.and_then(|scene| scene.diagnostics.as_deref());
        self.faults.take(Diagnosis {
            // The scene may be that of other values of the params.
            findings: match of_run {
                Some(diagnostics) => findings(&self.program.text, diagnostics),
                None => compiled.findings,
            },
            stale,
        });
        if is_first {
            self.faults.show_latest();
        }
        if let Some(scene) = compiled.scene {
            self.take_scene(scene);
        }
    }

    /// Takes over another scene.
    pub fn take_scene(&mut self, scene: Arc<Scene>) {
        self.follow_declared_values(&scene);
        // A camera that the user has not moved belongs to the old scene.
        self.history.note_scene();
        self.replace_scene(scene);
    }

    /// Takes over the scene of the same text for other values of the params.
    pub fn take_rerun(&mut self, scene: Arc<Scene>) {
        self.replace_scene(scene);
        if let Some(diagnostics) = self.run_diagnostics() {
            let findings = findings(&self.program.text, diagnostics);
            self.faults.take_run(findings);
        }
    }

    /// Returns the diagnostics of the text and of the run that made the scene that is shown; `None` if there is no such
    /// run, or if the scene is that of an earlier text.
    pub fn run_diagnostics(&self) -> Option<&[Diagnostic]> {
        let scene = self.scene.as_ref().filter(|_| self.shows_text);
        scene?.diagnostics.as_deref()
    }

    fn replace_scene(&mut self, scene: Arc<Scene>) {
        self.scene = Some(scene);
        self.param_values = None;
        self.renumber_paths();
    }

    /// Makes the scene of the chosen values of the params, if they change more than numbers: a script is run.
    pub fn rerun(&mut self) {
        let chosen = self.scene.clone().zip(self.chosen_values());
        if let Some(made) = chosen.and_then(|(scene, chosen)| scene.made_anew(&chosen)) {
            self.take_rerun(made);
        }
    }

    /// Returns whether the scene of the chosen values of the params is still to be made.
    pub fn awaits_rerun(&self) -> bool {
        let made_for = self.scene.as_ref().and_then(|scene| scene.made_for());
        made_for.is_some() && made_for != self.chosen_values()
    }

    /// Resets each param whose declared value has changed to that value: the latest choice wins.
    fn follow_declared_values(&mut self, scene: &Scene) {
        for param in &scene.params {
            let now = DeclaredValue::all(param);
            let Some(before) = self.choices.openings.remove(&param.name) else {
                continue;
            };
            let both = before.iter().zip(&now).enumerate();
            for (k, _) in both.filter(|(_, (before, now))| before.differs(now)) {
                self.choices.choose(&param.name, k, None);
                self.history.drop_value(&param.name, k);
            }
        }
        self.note_declared_values(scene);
    }

    /// Stores the declared values of each param that has a chosen value.
    fn note_declared_values(&mut self, scene: &Scene) {
        let Choices {
            params, openings, ..
        } = &mut self.choices;
        openings.retain(|name, _| params.contains_key(name));
        for name in params.keys() {
            if openings.contains_key(name) {
                continue;
            }
            let param = scene.params.iter().find(|param| param.name == *name);
            openings.extend(param.map(|param| (name.clone(), DeclaredValue::all(param))));
        }
    }

    /// Returns whether an error of the text is shown, so that not everything is shown as the text declares it.
    pub fn is_stale(&self) -> bool {
        self.faults.errors().next().is_some()
    }

    /// Returns whether a view of the whole scene shows an object in a form that the text no longer declares. An
    /// incomplete declaration leaves the object as it was.
    pub fn is_stale_in(&self, view: &dyn render::view::View) -> bool {
        self.is_stale()
            && self.shown_in(view).any(|it| {
                self.faults.stale().contains(&it.name) && !self.choices.look(&it.name).hidden
            })
    }

    /// Returns whether a view of an object shows it, or a geodesic on it, in a form that the text no longer declares.
    pub fn is_stale_on(&self, object: &str) -> bool {
        if !self.is_stale() {
            return false;
        }
        let id = self.object(object).map(|(id, _)| id);
        let objects = self.scene.iter().flat_map(|scene| &scene.objects);
        let mut on_it = objects.filter(|object| {
            let geodesic = object.shape.geodesic();
            geodesic.is_some_and(|(surface, _)| Some(surface) == id)
        });
        let stale = self.faults.stale();
        id.is_none() || stale.contains(object) || on_it.any(|it| stale.contains(&it.name))
    }

    /// Returns the objects that a view shows.
    fn shown_in<'m>(
        &'m self,
        view: &'m dyn render::view::View,
    ) -> impl Iterator<Item = &'m Object> {
        let scenes = self.scene.iter();
        scenes.flat_map(move |scene| {
            let objects = scene.objects.iter();
            objects.filter(move |object| view.shows(scene, object))
        })
    }

    /// Makes an undoable step.
    pub fn change(&mut self, step: Step, edit: impl FnOnce(&mut Choices)) {
        self.keep_placement();
        let before = self.choices.clone();
        self.adjust(edit);
        let replaced = Difference::of(&before, &self.choices);
        if !replaced.is_empty() {
            self.history.record(step, replaced, Trails::default());
        }
    }

    /// Changes the choices without a step: for an animation, or a worker's result.
    pub fn adjust(&mut self, edit: impl FnOnce(&mut Choices)) {
        edit(&mut self.choices);
        self.param_values = None;
        if let Some(scene) = self.scene.clone() {
            self.note_declared_values(&scene);
        }
    }

    /// Replaces the choices, undoably if a step is given. Axes need room: a camera that the user has not moved is placed
    /// anew for them. Another declared camera shows another part of the scene.
    pub fn replace(&mut self, mut choices: Choices, step: Option<Step>) {
        let before = &self.choices.preferences;
        let after = &choices.preferences;
        let needs_room = before.marks.axes != after.marks.axes;
        if before.camera != after.camera {
            choices.space = None;
        }
        match step {
            Some(step) => self.change(step, |known| *known = choices),
            None => self.adjust(|known| *known = choices),
        }
        if needs_room {
            self.reframe();
        }
    }

    /// Changes the overlays.
    pub fn set_marks(&mut self, marks: Marks) {
        let mut choices = self.choices.clone();
        choices.preferences.marks = marks;
        self.replace(choices, Some(Step::new("Change the overlays", "")));
        self.history.settle();
    }

    /// Undoes the last step. Returns its title.
    pub fn undo(&mut self) -> Option<&'static str> {
        self.travel(History::undo)
    }

    /// Redoes the last undone step. Returns its title.
    pub fn redo(&mut self) -> Option<&'static str> {
        self.travel(History::redo)
    }

    fn travel(
        &mut self,
        step: impl FnOnce(&mut History, &mut Choices, &mut ExchangeTrails<'_>) -> Option<&'static str>,
    ) -> Option<&'static str> {
        self.keep_placement();
        let param_values = self.param_values();
        let paths = &mut self.paths;
        let mut exchange = |surface: &str, trail: Option<EndedTrail>| {
            let present = paths.remove(surface);
            // With other params' values, the path would not be a geodesic path on the surface.
            if let Some(trail) = trail.filter(|it| Some(&it.param_values) == param_values.as_ref())
            {
                paths.insert(surface.to_owned(), trail.path);
            }
            Some(EndedTrail {
                path: present?,
                param_values: param_values.clone()?,
            })
        };
        let title = step(&mut self.history, &mut self.choices, &mut exchange)?;
        self.adjust(|_| {});
        Some(title)
    }

    /// Returns the current values of the declarations that depend on params, with their names, in the order of the
    /// text: `= 0.25`. Params are not among them. For a program in another process the list is empty.
    pub fn derived_values(&mut self) -> Vec<(String, String)> {
        let (Some(scene), Some(param_values)) = (self.scene.clone(), self.param_values()) else {
            return Vec::new();
        };
        let Some(analysis) = &self.program.analysis else {
            return Vec::new();
        };
        let params = scene.params.iter();
        let values = params.map(|param| (param.name.clone(), param_values.param(param).to_vec()));
        let values: BTreeMap<String, Vec<f64>> = values.collect();
        let whole = Span::new(0, self.program.text.len() as u32);
        let hints = analysis.preview_values(whole, &values).into_iter();
        let named = hints.filter_map(|hint| {
            let holds =
                |it: &&DeclarationRange| (it.span.start..=it.span.end).contains(&hint.offset);
            let declared = self.program.declared.iter().find(holds)?;
            let name = declared.name_span.text(&self.program.text);
            (!values.contains_key(name)).then(|| (name.to_owned(), hint.label))
        });
        named.collect()
    }

    /// Returns the params' values of the scene that is shown. They are the chosen ones, unless it awaits a rerun.
    pub fn param_values(&mut self) -> Option<Arc<ParamValues>> {
        if self.param_values.is_none() {
            let made_for = self.scene.as_ref()?.made_for();
            self.param_values = made_for.or_else(|| self.chosen_values()).map(Arc::new);
        }
        self.param_values.clone()
    }

    /// Returns the chosen values of the scene's params.
    pub fn chosen_values(&self) -> Option<ParamValues> {
        let scene = self.scene.as_ref()?;
        Some(chosen_values(scene, &self.choices.params))
    }

    /// Returns the objects of the scene that are hidden in space.
    pub fn hidden(&self) -> Vec<ObjectId> {
        let numbered = self.scene.iter().flat_map(|scene| scene.numbered());
        let hidden = numbered.filter(|(_, object)| self.choices.look(&object.name).hidden);
        hidden.map(|(id, _)| id).collect()
    }

    /// Returns the object with a name.
    pub fn object(&self, name: &str) -> Option<(ObjectId, &Object)> {
        self.scene.as_ref()?.object(name)
    }

    /// Returns whether there are objects, none of which a view shows.
    pub fn is_unseen_in(&self, view: &dyn render::view::View) -> bool {
        let has_objects = self.scene.as_ref().is_some_and(|it| !it.objects.is_empty());
        has_objects && self.shown_in(view).next().is_none()
    }

    /// Returns the names of the surfaces and metrics, in the order of the text.
    pub fn surfaces(&self) -> Vec<String> {
        let objects = self.scene.iter().flat_map(|scene| &scene.objects);
        objects
            .filter(|object| object.shape.manifold().is_some())
            .map(|object| object.name.clone())
            .collect()
    }

    /// Returns the name of the object whose declaration contains an offset of the text.
    pub fn declared_at(&self, offset: u32) -> Option<&str> {
        let next = self
            .program
            .declared
            .partition_point(|it| it.span.start <= offset);
        let declared = self.program.declared.get(next.checked_sub(1)?)?;
        let name = self
            .name(declared)
            .filter(|_| offset <= declared.span.end)?;
        Some(&self.object(name)?.1.name)
    }

    /// Returns the text that was compiled last, for editor features.
    pub fn read_text(&self) -> Option<ReadText> {
        let analysis = self.program.analysis.clone()?;
        Some(ReadText {
            version: self.program.version,
            analysis,
        })
    }

    /// Returns the range in which the text declares a name.
    pub fn place_of(&self, name: &str) -> Option<Span> {
        let mut declared = self.program.declared.iter();
        let found = declared.find(|it| self.name(it) == Some(name))?;
        Some(found.name_span)
    }

    fn name(&self, declared: &DeclarationRange) -> Option<&str> {
        let Span { start, end } = declared.name_span;
        self.program.text.get(start as usize..end as usize)
    }

    /// Returns the status line's sentence about the text.
    pub fn status(&self) -> String {
        match self.read {
            true => self.faults.count(),
            false => "reading".to_owned(),
        }
    }

    /// Returns the background of the views in space: the chosen one, or else that of the theme.
    pub fn background(&self) -> [u8; 3] {
        let of_theme = match self.is_light {
            true => LIGHT_BACKGROUND,
            false => render::style::BACKGROUND,
        };
        self.choices.preferences.background.unwrap_or(of_theme)
    }

    /// Highlights the object whose declaration the cursor is in.
    pub fn highlight(&mut self, name: Option<String>) {
        if self.highlighted != name {
            self.emphasis = Emphasis::Begins;
            self.highlighted = name;
        }
    }

    /// Advances the animated components by some seconds, each up to its maximum and then from its minimum. Returns
    /// whether any has changed.
    pub fn animate(&mut self, seconds: f64) -> bool {
        let Some(scene) = self.scene.clone() else {
            return false;
        };
        let Some(param_values) = self.chosen_values() else {
            return false;
        };
        let mut moved = false;
        for param in &scene.params {
            let Some(animation) = self.choices.animations.get(&param.name) else {
                continue;
            };
            let Animation { on, speed } = animation.clone();
            let values = param_values.param(param).iter().zip(&param.ranges);
            let numbered = values.enumerate().zip(on);
            for ((k, (value, range)), _) in numbered.filter(|(_, on)| *on) {
                let next = advanced(*value, seconds * speed, range.min, range.max);
                self.adjust(|choices| choices.choose(&param.name, k, Some(next)));
                moved = true;
            }
        }
        moved
    }

    /// Returns whether anything is animated.
    pub fn is_animated(&self) -> bool {
        let params = self.scene.iter().flat_map(|scene| &scene.params);
        params
            .filter_map(|param| {
                let animation = self.choices.animations.get(&param.name)?;
                Some(animation.on.iter().take(param.ranges.len()).any(|on| *on))
            })
            .any(|on| on)
    }
}

/// Returns a value increased by a step; it restarts from the minimum when it passes the maximum.
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
