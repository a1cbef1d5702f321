//! A hand on the window: opens it on a text, waits until it shows what it was told, presses, drags and reads.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, HarnessBuilder, Node};
use preview::Window;
use session::{ChartCamera, InsideCamera, SolidCamera};
use tempfile::TempDir;

/// A sphere whose radius is a param, and a point beside it.
pub(crate) const SPHERE: &str = "param r : [1, 3];
surface s(u,v) = r(cos v cos u, cos v sin u, sin v), u : [0, 2pi], v : [-pi/2, pi/2];
point p = (0, 0, r + 1);
";

/// How long a condition may take: far more than it needs, since the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(60);
/// Seconds that each frame of the harness takes.
pub(crate) const FRAME: f32 = 1.0 / 60.0;

/// The window and what holds it.
pub(crate) struct Hand {
    pub(crate) harness: Harness<'static, Option<Window>>,
    pub(crate) path: PathBuf,
    folder: Option<TempDir>,
}

impl Hand {
    /// The window on a file with this text, when its pictures are there.
    pub(crate) fn on(text: &str) -> Self {
        Self::with(text, |builder| builder.with_size([1200.0, 800.0]))
    }

    /// The same, with a harness of another kind.
    pub(crate) fn with(
        text: &str,
        dress: impl FnOnce(HarnessBuilder<Option<Window>>) -> HarnessBuilder<Option<Window>>,
    ) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("program.gtr");
        std::fs::write(&path, text).expect("written");
        Self::open(path, folder, true, dress)
    }

    /// The window on a CRT script.
    pub(crate) fn script(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("script.crt");
        std::fs::write(&path, text).expect("written");
        Self::opened(path, folder)
    }

    /// The window on a file that is not watched.
    pub(crate) fn unwatched(text: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("program.gtr");
        std::fs::write(&path, text).expect("written");
        Self::open(path, folder, false, |builder| {
            builder.with_size([1200.0, 800.0])
        })
    }

    /// The window without a program, which lists those that were opened last as a folder remembers them.
    pub(crate) fn welcome(state: &Path) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let state = state.to_owned();
        let builder = Harness::builder().with_step_dt(FRAME);
        let harness = builder.with_size([1200.0, 800.0]).build_ui_state(
            move |ui, window: &mut Option<Window>| {
                let window = window.get_or_insert_with(|| {
                    let languages = ide::Languages::standard();
                    let views = render::Views::standard();
                    let window = Window::welcome(ui.ctx(), &languages, views);
                    let mut window = window.expect("its threads start");
                    window.remember_paths_in(&state);
                    window
                });
                window.show(ui);
            },
            None,
        );
        let mut hand = Self {
            harness,
            path: folder.path().join("program.gtr"),
            folder: Some(folder),
        };
        hand.settle();
        hand
    }

    fn open(
        path: PathBuf,
        folder: TempDir,
        watched: bool,
        dress: impl FnOnce(HarnessBuilder<Option<Window>>) -> HarnessBuilder<Option<Window>>,
    ) -> Self {
        let file = path.clone();
        let harness = dress(Harness::builder().with_step_dt(FRAME)).build_ui_state(
            move |ui, window: &mut Option<Window>| {
                let window = window.get_or_insert_with(|| {
                    let languages = ide::Languages::standard();
                    Window::of_file(
                        ui.ctx(),
                        &languages,
                        render::Views::standard(),
                        file.clone(),
                        watched,
                    )
                    .expect("the file is there")
                });
                window.show(ui);
            },
            None,
        );
        let mut hand = Self {
            harness,
            path,
            folder: Some(folder),
        };
        hand.settle();
        hand
    }

    /// Closes the window and opens another one on the same file.
    pub(crate) fn again(mut self) -> Self {
        let (path, folder) = (self.path.clone(), self.folder.take());
        // What is to be remembered is written at the latest when the window goes.
        drop(self);
        Self::opened(path, folder.expect("kept"))
    }

    /// The window on a file that is there.
    pub(crate) fn opened(path: PathBuf, folder: TempDir) -> Self {
        Self::open(path, folder, true, |builder| {
            builder.with_size([1200.0, 800.0])
        })
    }

    /// Closes the window; its folder is removed when it is dropped.
    pub(crate) fn close(mut self) -> TempDir {
        let folder = self.folder.take();
        drop(self);
        folder.expect("kept")
    }

    /// Writes another text into the field whose text ends so.
    pub(crate) fn enter(&mut self, end: &str, text: &str) {
        let fields = self.harness.get_all_by_role(Role::TextInput);
        let has_end = |node: &Node<'_>| node.value().is_some_and(|it| it.ends_with(end));
        let field = fields.into_iter().find(has_end);
        field.expect("there is such a field").focus();
        self.harness.run_steps(2);
        self.press(Modifiers::COMMAND, Key::A);
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.run_steps(3);
    }

    /// Types a text into the field of this role and name, and presses Enter.
    pub(crate) fn type_number(&mut self, role: Role, name: &str, text: &str) {
        self.harness.get_by_role_and_label(role, name).focus();
        self.harness.run_steps(2);
        self.press(Modifiers::COMMAND, Key::A);
        self.harness.event(Event::Text(text.to_owned()));
        self.harness.run_steps(2);
        self.press(Modifiers::NONE, Key::Enter);
    }

    /// Gives the keys to the program's text, with the cursor at its end.
    pub(crate) fn write_at_end(&mut self) {
        let text = self
            .harness
            .get_by_role_and_label(Role::MultilineTextInput, "Program text");
        text.focus();
        self.harness.run_steps(2);
        self.press(Modifiers::COMMAND, Key::End);
    }

    /// Clicks on a place.
    pub(crate) fn click_at(&mut self, at: Pos2) {
        self.clicks_at(at, 1);
        self.harness.run_steps(2);
    }

    /// Clicks so many times, at once, on a place.
    pub(crate) fn clicks_at(&mut self, at: Pos2, times: usize) {
        self.harness.hover_at(at);
        self.harness.step();
        for _ in 0..times {
            for pressed in [true, false] {
                self.harness.event(Event::PointerButton {
                    pos: at,
                    button: PointerButton::Primary,
                    pressed,
                    modifiers: Modifiers::NONE,
                });
                self.harness.step();
            }
        }
    }

    /// Gives the keys to the geodesic view of a surface, whose camera leaves a trail from now on.
    pub(crate) fn leave_trail(&mut self, surface: &str) {
        let at = self.inside(surface).center();
        self.click_at(at);
        self.click("Overlays");
        self.click("Trail of the walk");
        self.press(Modifiers::NONE, Key::Escape);
        self.settle();
    }

    pub(crate) fn window(&self) -> &Window {
        self.harness.state().as_ref().expect("it has been drawn")
    }

    pub(crate) fn window_mut(&mut self) -> &mut Window {
        self.harness
            .state_mut()
            .as_mut()
            .expect("it has been drawn")
    }

    /// Draws frames until something holds.
    pub(crate) fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let begun = Instant::now();
        loop {
            self.harness.step();
            if holds(self) {
                return;
            }
            let window = self.window();
            assert!(
                begun.elapsed() < PATIENCE,
                "{what}: not within {PATIENCE:?}; {}, {:?}",
                window.model().status(),
                window.counters()
            );
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Draws frames until the window has no more to do: nothing moves, and each picture is the newest.
    pub(crate) fn settle(&mut self) {
        // What moves, moves for a while after the last motion.
        self.harness.run_steps(14);
        self.until("the window comes to rest", |hand| {
            hand.window().is_settled()
        });
        self.harness.run_steps(2);
        self.until("the window comes to rest", |hand| {
            hand.window().is_settled()
        });
    }

    /// Holds a key for some frames.
    pub(crate) fn hold(&mut self, key: Key, frames: usize) {
        self.harness.key_down(key);
        self.harness.run_steps(frames);
        self.harness.key_up(key);
        self.settle();
    }

    /// Hands over events at once, as a slow frame has them.
    pub(crate) fn in_one_frame(&mut self, events: impl IntoIterator<Item = Event>) {
        self.harness.input_mut().events.extend(events);
        self.harness.step();
    }

    /// Presses a key with modifiers.
    pub(crate) fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.run_steps(3);
    }

    /// Clicks on what has this name.
    pub(crate) fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).scroll_to_me();
        self.harness.run_steps(20);
        self.harness.get_by_label(label).click();
        self.harness.run_steps(3);
    }

    /// Clicks on what has this role and name.
    pub(crate) fn click_on(&mut self, role: Role, label: &str) {
        self.harness
            .get_by_role_and_label(role, label)
            .scroll_to_me();
        self.harness.run_steps(20);
        self.harness.get_by_role_and_label(role, label).click();
        self.harness.run_steps(3);
    }

    /// Opens a tab of the settings.
    pub(crate) fn settings(&mut self, tab: &str) {
        self.click_on(Role::Button, tab);
    }

    /// Writes the value of a param into the text, by its menu.
    pub(crate) fn update_text(&mut self, param: &str) {
        self.click(&format!("More for {param}"));
        self.click("Update the text");
    }

    /// Clicks on the first whose name contains this.
    pub(crate) fn click_like(&mut self, part: &str) {
        self.like(part).click();
        self.harness.run_steps(3);
    }

    /// The first whose name contains this.
    pub(crate) fn like<'a>(&'a self, part: &'a str) -> Node<'a> {
        self.harness
            .get_all_by_label_contains(part)
            .next()
            .expect("one has this name")
    }

    /// The role and the name of what has the focus; nothing if nothing has it.
    pub(crate) fn focused(&self) -> Option<(Role, String)> {
        let root = self.harness.root();
        let focused = root.children_recursive().find(|node| node.is_focused())?;
        let node = focused.accesskit_node();
        Some((node.role(), node.label().unwrap_or_default()))
    }

    /// Presses Tab until what has the focus is called so, from its beginning.
    pub(crate) fn tab_to(&mut self, name: &str) {
        for _ in 0..200 {
            if self.focused().is_some_and(|(_, it)| it.starts_with(name)) {
                return;
            }
            self.press(Modifiers::NONE, Key::Tab);
        }
        panic!("Tab does not reach {name}");
    }

    /// Whether anything is called so, in part.
    pub(crate) fn shows(&self, part: &str) -> bool {
        self.names().iter().any(|name| name.contains(part))
    }

    /// All names and values that a screen reader finds.
    pub(crate) fn names(&self) -> Vec<String> {
        let root = self.harness.root();
        let nodes = root.children_recursive();
        nodes
            .flat_map(|node| {
                let node = node.accesskit_node();
                [node.label(), node.value()]
                    .into_iter()
                    .flatten()
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// Where everything is that is called so, in part.
    pub(crate) fn rects(&self, part: &str) -> Vec<Rect> {
        let found = self.harness.query_all_by_label_contains(part);
        found.map(|node| node.rect()).collect()
    }

    /// Drags a slider from its left end by so many points.
    pub(crate) fn slide(&mut self, name: &str, by: f32) {
        let slider = self.harness.get_by_role_and_label(Role::Slider, name);
        let from = slider.rect().left_center() + Vec2::new(6.0, 0.0);
        let way = Vec2::new(by, 0.0);
        self.drag(from, way, PointerButton::Primary, Modifiers::NONE);
    }

    /// Drags with a button from a place by a way, in steps.
    pub(crate) fn drag(
        &mut self,
        from: Pos2,
        by: Vec2,
        button: PointerButton,
        modifiers: Modifiers,
    ) {
        let event = |pos, pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers,
        };
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.hover_at(from);
        self.harness.step();
        self.harness.event(event(from, true));
        self.harness.step();
        for step in 1..=8 {
            self.harness.hover_at(from + by * (step as f32 / 8.0));
            self.harness.step();
        }
        self.harness.event(event(from + by, false));
        self.harness.step();
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.settle();
    }

    /// Writes a picture of the window where `GEOTRACE_TEST_PICTURES` says, to be looked at.
    pub(crate) fn keep(&mut self, name: &str) {
        if let Some(folder) = std::env::var_os("GEOTRACE_TEST_PICTURES") {
            let picture = self.harness.render().expect("a driver");
            let path = Path::new(&folder).join(format!("{name}.png"));
            picture.save(path).expect("written");
        }
    }

    /// Turns the wheel over a place.
    pub(crate) fn wheel(&mut self, at: Pos2, points: f32) {
        self.harness.hover_at(at);
        self.harness.step();
        self.harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: egui::vec2(0.0, points),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        self.harness.run_steps(40);
        self.settle();
    }

    /// Where the 3D view is.
    pub(crate) fn space(&self) -> Rect {
        self.like("3D view of ").rect()
    }

    /// Where the geodesic view of a surface is.
    pub(crate) fn inside(&self, surface: &str) -> Rect {
        self.like(&format!("Geodesic view of {surface} from"))
            .rect()
    }

    /// Where the 3D camera stands, and what it looks at.
    pub(crate) fn eye(&self) -> ([f64; 3], [f64; 3]) {
        let camera = self.window().model().choices.space.expect("a camera");
        (camera.eye, camera.target)
    }

    /// The geodesic camera of a surface.
    pub(crate) fn camera(&self, surface: &str) -> ChartCamera {
        let camera = &self.window().model().choices.inside[surface];
        *camera.chart().expect("a surface")
    }

    /// The geodesic camera of a solid.
    pub(crate) fn solid_camera(&self, solid: &str) -> SolidCamera {
        match self.window().model().choices.inside[solid] {
            InsideCamera::Solid(camera) => camera,
            InsideCamera::Chart(_) => panic!("`{solid}` is no solid"),
        }
    }

    /// The value of a param with one component.
    pub(crate) fn param(&mut self, name: &str) -> f64 {
        let model = self.window().model();
        let scene = model.scene.clone().expect("a scene");
        let param = scene.params.iter().find(|it| it.name == name);
        let range = param.expect("declared").ranges[0];
        let chosen = model.choices.params.get(name).and_then(|values| values[0]);
        chosen.unwrap_or(range.min).clamp(range.min, range.max)
    }
}
