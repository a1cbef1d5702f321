//! The list of diagnostics at the foot of the program's pane.

use egui::{Frame, Panel, RichText, ScrollArea, Ui};
use session::Finding;
use syntax::span::Span;

use crate::ui::highlighting::severity_colour;
use crate::ui::window::Window;

/// The share of the pane that the list takes at most.
const SHARE: f32 = 0.4;
/// The number of diagnostics that are listed.
const LISTED: usize = 100;

/// Lists the diagnostics, if there are any; a click on one shows its place.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let findings = window.model.faults.findings();
    if findings.is_empty() {
        return;
    }
    let room = SHARE * ui.available_height();
    let panel = Panel::bottom("findings").frame(Frame::new());
    let panel = panel.resizable(false).show_separator_line(false);
    let place = panel.show(ui, |ui| {
        ui.separator();
        let list = ScrollArea::vertical()
            .max_height(room)
            .auto_shrink([false, true]);
        let places = list.show(ui, |ui| {
            let listed = findings.iter().take(LISTED);
            let places = listed.filter_map(|finding| row(ui, finding));
            places.last()
        });
        places.inner
    });
    if let Some(place) = place.inner {
        window.open_place(place);
    }
}

/// Shows a diagnostic and its hint; returns its place if it was clicked on.
fn row(ui: &mut Ui, finding: &Finding) -> Option<Span> {
    let colour = severity_colour(finding.severity, ui.visuals().dark_mode);
    let text = format!("Line {}: {}", finding.line, finding.message);
    let link = ui.link(RichText::new(text).color(colour));
    if let Some(hint) = &finding.hint {
        ui.weak(hint);
    }
    link.clicked().then_some(finding.span)
}
