//! The welcome screen, instead of the panes while there is no program: new programs, recent ones, the examples.

use egui::{CentralPanel, Frame, RichText, ScrollArea, Ui};

use crate::examples::TEMPLATES;
use crate::ui::dialogs::program;
use crate::ui::gallery;
use crate::ui::window::{Next, UNTITLED, Window};

/// The width of the column beside the examples, in points.
const COLUMN: f32 = 220.0;

/// Shows the welcome screen.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    let frame = Frame::central_panel(ui.style()).inner_margin(16.0);
    let frame = frame.fill(window.display.background(ui));
    CentralPanel::default().frame(frame).show(ui, |ui| {
        let mut next = None;
        ui.horizontal_top(|ui| {
            ui.vertical(|ui| {
                ui.set_width(COLUMN);
                let area = ScrollArea::vertical().id_salt("begin").auto_shrink(false);
                area.show(ui, |ui| next = begin(window, ui));
            });
            ui.add_space(16.0);
            ui.vertical(|ui| {
                ui.heading("Examples");
                ui.add_space(4.0);
                let room = ui.available_height();
                next = gallery::show(ui, room).or(next.take());
            });
        });
        if let Some(next) = next {
            window.go_on(next);
        }
    });
}

/// Shows the programs to start from. Returns the chosen step.
fn begin(window: &Window, ui: &mut Ui) -> Option<Next> {
    let mut next = None;
    ui.label(RichText::new("Geotrace").size(28.0).strong());
    ui.label("Curves, surfaces and solids as short programs, seen in space and from inside.");
    ui.add_space(16.0);
    ui.heading("New program");
    if ui.button("Empty").clicked() {
        next = Some(new(""));
    }
    if let Some(text) = templates(ui) {
        next = Some(new(text));
    }
    ui.add_space(12.0);
    ui.heading("Open");
    if ui.button("Open…").clicked() {
        program::choose_file(window);
    }
    recent(window, ui).or(next)
}

/// Returns the step to a new program.
pub(crate) fn new(text: &'static str) -> Next {
    Next::New {
        name: UNTITLED,
        text,
    }
}

/// Shows a button for each template. Returns the text of the chosen one.
pub(crate) fn templates(ui: &mut Ui) -> Option<&'static str> {
    let chosen = TEMPLATES
        .iter()
        .filter(|template| ui.button(template.title).clicked());
    chosen.map(|template| template.text).last()
}

/// Lists the recent programs. Returns the step to the chosen one.
pub(crate) fn recent(window: &Window, ui: &mut Ui) -> Option<Next> {
    let mut next = None;
    for path in window.records.recent.paths() {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let link = ui.add(
            egui::Button::new(name.to_string_lossy())
                .frame(false)
                .truncate(),
        );
        if link.on_hover_text(path.display().to_string()).clicked() {
            next = Some(Next::File(path.clone()));
        }
    }
    next
}
