//! The menu bar.

use egui::{Atom, Checkbox, Key, MenuBar, Panel, Response, RichText, Ui, ViewportCommand};
use render::view::View;
use render::{ViewId, Views};
use session::layout::Arrangement;
use session::pane::Pane;
use session::{Model, Step, WAVEFRONTS};

use crate::ui::dialogs::Dialog;
use crate::ui::dialogs::help::HelpPage;
use crate::ui::dialogs::{picture, program, record};
use crate::ui::panes::program::commands::{self, TextCommand};
use crate::ui::window::{TextSource, Window};
use crate::ui::{key_names, measure, navigation, toolbar, welcome};

/// The menu bar.
pub(crate) fn bar(window: &mut Window, ui: &mut Ui) {
    let frame = egui::Frame::side_top_panel(ui.style()).fill(window.display.background(ui));
    Panel::top("menu").frame(frame).show(ui, |ui| {
        MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| file(window, ui));
            ui.menu_button("Edit", |ui| edit(window, ui));
            ui.menu_button("View", |ui| view(window, ui));
            ui.menu_button("Overlays", |ui| {
                overlays(&mut window.model, &window.views, ui);
            });
            ui.menu_button("Help", |ui| help(window, ui));
            toolbar::show(window, ui);
        });
    });
}

/// Shows an entry of a menu, with its keys beside it. Returns whether it was chosen.
fn entry(ui: &mut Ui, enabled: bool, title: &str, keys: &str) -> bool {
    let button = egui::Button::new(title).shortcut_text(key_names::named(ui.ctx(), keys));
    let response = ui.add_enabled(enabled, button);
    response.accessible_name(title).clicked()
}

/// Shows a checkbox of a menu, with its keys beside it.
pub(super) fn tick(ui: &mut Ui, on: &mut bool, title: &str, keys: &str) -> Response {
    let keys = RichText::new(key_names::named(ui.ctx(), keys)).weak();
    let tick = Checkbox::new(on, (title, Atom::grow(), keys));
    ui.add(tick).accessible_name(title)
}

fn file(window: &mut Window, ui: &mut Ui) {
    if window.text.is_own() {
        program_entries(window, ui);
        ui.separator();
    }
    if entry(ui, true, "Open textures…", "") {
        choose_textures(window);
    }
    let has_picture = window.pictures.sent(&window.focus.view).is_some();
    if entry(ui, has_picture, "Save picture…", "Ctrl+E") {
        picture::ask_for_picture(window);
    }
    if entry(ui, has_picture, "Copy picture", "Ctrl+C") {
        picture::copy_picture(window, ui);
    }
    if entry(ui, has_picture, "Copy as command", "Ctrl+Shift+C") {
        picture::copy_command(window, ui);
    }
    let free = window.dialogs.recording.is_none();
    if entry(ui, has_picture && free, "Record…", "Ctrl+R") {
        record::ask(window);
    }
    if entry(ui, has_picture, "Export mesh…", "Ctrl+M") {
        picture::ask_for_mesh(window);
    }
}

/// Shows the entries for the program, in a window with its own text.
fn program_entries(window: &mut Window, ui: &mut Ui) {
    let mut next = None;
    ui.menu_button("New", |ui| {
        if entry(ui, true, "Empty", "Ctrl+N") {
            next = Some(welcome::new(""));
        }
        if let Some(text) = welcome::templates(ui) {
            next = Some(welcome::new(text));
        }
    });
    if entry(ui, true, "Open…", "Ctrl+O") {
        program::choose_file(window);
    }
    let any = !window.records.recent.paths().is_empty();
    ui.add_enabled_ui(any, |ui| {
        ui.menu_button("Open recent", |ui| {
            next = welcome::recent(window, ui).or(next.take());
        });
    });
    if entry(ui, true, "Examples…", "") {
        window.dialogs.open = Some(Dialog::Examples);
    }
    ui.separator();
    let TextSource::File { editor, .. } = &window.text.source else {
        return;
    };
    let saves = !window.panes.is_welcome && (editor.is_changed() || editor.is_new);
    if entry(ui, saves, "Save program", "Ctrl+S") {
        window.save_text();
    }
    let has_program = !window.panes.is_welcome;
    if entry(ui, has_program, "Save program as…", "Ctrl+Shift+S") {
        program::ask_for_target(window, None);
    }
    if let Some(next) = next {
        window.go_on(next);
    }
}

fn help(window: &mut Window, ui: &mut Ui) {
    if entry(ui, true, "Keyboard and mouse", "F1") {
        window.dialogs.shortcuts = true;
    }
    if window.text.is_own() && entry(ui, true, "Examples…", "") {
        window.dialogs.open = Some(Dialog::Examples);
    }
    if entry(ui, true, "Language on one page", "") {
        window.dialogs.open = Some(Dialog::Help(HelpPage::Language));
    }
    ui.separator();
    if entry(ui, true, "About Geotrace", "") {
        window.dialogs.open = Some(Dialog::Help(HelpPage::About));
    }
}

fn choose_textures(window: &Window) {
    crate::io::file_dialogs::choose_images(window.events.file_choices(), window.text.folder());
}

/// Handles the keys of the menu *File*, unless they belong to a control.
pub(crate) fn file_keys(window: &mut Window, ui: &Ui) {
    let pressed = |key| {
        let shortcut = egui::KeyboardShortcut::new(egui::Modifiers::COMMAND, key);
        ui.input_mut(|input| input.consume_shortcut(&shortcut))
    };
    if window.text.is_own() {
        if pressed(Key::O) {
            program::choose_file(window);
        }
        if pressed(Key::N) {
            window.go_on(welcome::new(""));
        }
    }
    if pressed(Key::E) {
        picture::ask_for_picture(window);
    }
    if pressed(Key::R) && window.dialogs.recording.is_none() {
        record::ask(window);
    }
    if pressed(Key::M) && window.pictures.sent(&window.focus.view).is_some() {
        picture::ask_for_mesh(window);
    }
    // With Shift, the copy keys are reported as a key and not as `Event::Copy`.
    let shifted = egui::Modifiers::COMMAND | egui::Modifiers::SHIFT;
    let command = egui::KeyboardShortcut::new(shifted, Key::C);
    if ui.input_mut(|input| input.consume_shortcut(&command)) {
        picture::copy_command(window, ui);
    }
    // Selected text takes precedence over the picture.
    let copies = ui.input(|input| input.events.contains(&egui::Event::Copy));
    if copies && !ui.ctx().text_edit_focused() {
        picture::copy_picture(window, ui);
    }
}

fn edit(window: &mut Window, ui: &mut Ui) {
    let titled = |verb: &str, title: Option<&str>| {
        title.map_or(verb.to_owned(), |title| format!("{verb}: {title}"))
    };
    let last = window.model.history.last();
    if entry(ui, last.is_some(), &titled("Undo", last), "Ctrl+Z") {
        window.undo();
    }
    let next = window.model.history.next();
    if entry(ui, next.is_some(), &titled("Redo", next), "Ctrl+Y") {
        window.redo();
    }
    if !window.text.is_own() || window.panes.is_welcome {
        return;
    }
    ui.separator();
    for (title, keys, command) in [
        ("Undo in the text", "Ctrl+Z there", TextCommand::Undo),
        ("Redo in the text", "Ctrl+Y there", TextCommand::Redo),
        ("Comment or uncomment lines", "Ctrl+/", TextCommand::Comment),
        ("Rename…", "F2", TextCommand::Rename),
        ("Apply all fixes", "Ctrl+.", TextCommand::FixAll),
        ("Format", "Shift+Alt+F", TextCommand::Format),
    ] {
        let can = commands::is_possible(window, ui, command);
        if entry(ui, can, title, keys) {
            window.edit_text(ui, command);
        }
    }
    if entry(ui, true, "Find and replace…", "Ctrl+F") {
        window.open_find();
    }
}

/// Shows the entry that opens and closes a pane.
fn open_pane(window: &mut Window, ui: &mut Ui, pane: &Pane) {
    let title = match pane {
        Pane::View(id) => window.views.title(id, " of "),
        Pane::Settings => "Settings".to_owned(),
        Pane::Program => "Program".to_owned(),
    };
    let mut open = window.panes.is_open(pane);
    if ui.checkbox(&mut open, title).changed() {
        window.panes.arranged = true;
        if open {
            window.bring_forward(pane);
        } else {
            window.panes.close(pane);
            window.note_closed(pane);
        }
    }
}

fn view(window: &mut Window, ui: &mut Ui) {
    view_panes(window, ui);
    layout(window, ui);
    window_modes(window, ui);
    ui.separator();
    camera_modes(window, ui);
    cameras(window, ui);
}

/// Shows the entries that open and close panes.
fn view_panes(window: &mut Window, ui: &mut Ui) {
    let views = window.offered().into_iter();
    let (solids, views): (Vec<ViewId>, Vec<ViewId>) =
        views.partition(|id| id.object.is_some() && !window.opens_by_itself(id));
    let views = views.into_iter().map(Pane::View);
    for pane in views.chain([Pane::Settings, Pane::Program]) {
        open_pane(window, ui, &pane);
    }
    if !solids.is_empty() {
        ui.menu_button("Geodesic view of a solid", |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| {
                for id in solids {
                    open_pane(window, ui, &Pane::View(id));
                }
            });
        });
    }
}

/// Shows the entries that arrange the panes.
fn layout(window: &mut Window, ui: &mut Ui) {
    ui.menu_button("Layout", |ui| {
        for (title, arrangement) in Arrangement::ALL {
            if ui.button(title).clicked() {
                window.panes.set_out(arrangement);
            }
        }
        ui.separator();
        if entry(ui, true, "Larger view", "Ctrl+Shift+Right") {
            window.resize_active(true);
        }
        if entry(ui, true, "Smaller view", "Ctrl+Shift+Left") {
            window.resize_active(false);
        }
    });
    if entry(ui, true, "Next view", "F6") {
        window.next_view(ui, false);
    }
}

/// Shows the entries for the modes of the window.
fn window_modes(window: &mut Window, ui: &mut Ui) {
    let alone = &mut window.panes.shows_views_alone;
    let hint = "Hides the program and the settings";
    tick(ui, alone, "Views alone", "Ctrl+B").on_hover_text(hint);
    let mut full = is_full_screen(ui);
    if tick(ui, &mut full, "Full screen", "F11").changed() {
        toggle_full_screen(ui);
    }
    let mut measures = window.dialogs.measuring.is_open();
    let hint = "Distances, circles, triangles and curvatures by clicks";
    let measure = tick(ui, &mut measures, "Measure", "M");
    if measure.on_hover_text(hint).changed() {
        measure::toggle(window);
    }
}

/// Shows the entries for the modes of the 3D view.
fn camera_modes(window: &mut Window, ui: &mut Ui) {
    let mut fly = window.model.choices.preferences.fly;
    let hint = "A drag in the 3D view turns the camera in place";
    if ui.checkbox(&mut fly, "Fly").on_hover_text(hint).changed() {
        let step = Step::new("Change a setting", "fly");
        window
            .model
            .change(step, |choices| choices.preferences.fly = fly);
    }
    navigation::entries(window, ui);
    let mut traced = window.model.choices.preferences.traced;
    let hint = "The 3D view with lights, shadows, mirrors and glass";
    let tick = tick(ui, &mut traced, "Traced", "T");
    if tick.on_hover_text(hint).changed() {
        window.toggle_traced();
    }
}

/// Shows the entries that write, choose and move cameras.
fn cameras(window: &mut Window, ui: &mut Ui) {
    let has_camera = window.model.choices.space.is_some() && !window.panes.is_welcome;
    if entry(ui, has_camera, "Write camera", "") {
        window.write_camera();
    }
    let cameras = window.model.declared_cameras();
    let cameras: Vec<String> = cameras.map(|camera| camera.name.clone()).collect();
    if !cameras.is_empty() {
        ui.menu_button("Look through", |ui| {
            for camera in cameras {
                if entry(ui, true, &camera, "") {
                    window.model.look_through(&camera);
                }
            }
        });
    }
    if entry(ui, true, "Frame everything", "F") {
        window.frame(None);
    }
    let scene = window.model.scene.iter();
    let drawn = scene.flat_map(|scene| &scene.objects);
    let drawn = drawn.filter(|object| !object.shape.is_metric());
    let drawn: Vec<String> = drawn.map(|object| object.name.clone()).collect();
    if drawn.len() > 1 {
        ui.menu_button("Frame an object", |ui| {
            egui::ScrollArea::vertical().show(ui, |ui| {
                for name in drawn {
                    if entry(ui, true, &name, "") {
                        window.frame(Some(&name));
                    }
                }
            });
        });
    }
    let inside = window.focus.view.object.clone();
    let hint = "Shows the surface from its other side";
    let mirror = egui::Button::new("Mirror the geodesic view");
    if ui
        .add_enabled(inside.is_some(), mirror)
        .on_hover_text(hint)
        .clicked()
        && let Some(surface) = inside
    {
        window.model.mirror(&surface);
        window.has_moved(ui);
    }
    if entry(ui, true, "Reset the camera", "R") {
        let id = window.focus.view.clone();
        window.camera_input(&id).reset(window, &id);
    }
}

fn is_full_screen(ui: &Ui) -> bool {
    ui.input(|input| input.viewport().fullscreen.unwrap_or(false))
}

/// Makes the window fill the screen, or restores it.
pub(crate) fn toggle_full_screen(ui: &Ui) {
    let full = !is_full_screen(ui);
    ui.ctx()
        .send_viewport_cmd(ViewportCommand::Fullscreen(full));
}

fn overlays(model: &mut Model, views: &Views, ui: &mut Ui) {
    let mut marks = model.choices.preferences.marks.clone();
    let before = marks.clone();
    for (on, title) in [
        (&mut marks.wavefronts, WAVEFRONTS),
        (&mut marks.conjugate, "Conjugate points"),
        (&mut marks.cut_locus, "Cut locus"),
        (&mut marks.error, "Estimated error"),
        (&mut marks.legend, "Legend"),
        (&mut marks.labels, "Labels"),
        (&mut marks.axes, "Axes"),
    ] {
        ui.checkbox(on, title);
    }
    for setting in views.iter().flat_map(View::settings) {
        let mut on = marks.is_on(setting);
        if ui.checkbox(&mut on, setting.title).changed() {
            marks.of_views.insert(setting.name.to_owned(), on);
        }
    }
    ui.checkbox(&mut marks.cameras, "Geodesic camera in the 3D view");
    ui.checkbox(&mut marks.trail, "Trail of the walk");
    let mut paths = model.paths.values();
    let any = paths.any(|path| path.trail.points.len() > 1);
    let clear = egui::Button::new("Clear the trail");
    if ui.add_enabled(any, clear).clicked() {
        model.clear_trails();
    }
    if marks != before {
        model.set_marks(marks);
    }
}
