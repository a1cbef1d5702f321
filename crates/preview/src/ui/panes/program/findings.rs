//! The list of diagnostics at the foot of the program's pane.

use egui::{Frame, Panel, RichText, ScrollArea, Ui};
use session::Finding;
use syntax::diagnostic::{Fix, Severity};
use syntax::span::Span;

use crate::ui::highlighting::severity_colour;
use crate::ui::window::Window;

/// The maximum height of the list, as a fraction of the pane's.
const SHARE: f32 = 0.4;
/// The maximum number of listed diagnostics.
const LISTED: usize = 100;

/// The effect of a click in the list.
enum Click {
    /// A range is to be shown.
    Place(Span),
    /// A fix is to be applied.
    Fix(Fix),
}

/// Lists the diagnostics, if there are any; a click on one shows its range. Diagnostics of the window's own text have
/// their fixes below.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let findings = window.model.faults.findings();
    if findings.is_empty() {
        return;
    }
    let room = SHARE * ui.available_height();
    let panel = Panel::bottom("findings").frame(Frame::new());
    let panel = panel.resizable(false).show_separator_line(false);
    let is_own = window.text.is_own();
    let click = panel.show(ui, |ui| {
        ui.separator();
        let list = ScrollArea::vertical()
            .max_height(room)
            .min_scrolled_height(room)
            .auto_shrink([false, true]);
        let clicks = list.show(ui, |ui| {
            // Errors first: they prevent the picture from being updated.
            let is_error = |it: &&Finding| it.severity == Severity::Error;
            let errors = findings.iter().filter(is_error);
            let others = findings.iter().filter(|it| !is_error(it));
            let listed = errors.chain(others).take(LISTED);
            let clicks = listed.filter_map(|finding| row(ui, finding, is_own));
            clicks.last()
        });
        clicks.inner
    });
    match click.inner {
        Some(Click::Place(place)) => window.open_place(place),
        Some(Click::Fix(fix)) => window.apply(&fix),
        None => {}
    }
}

/// Shows a diagnostic, its hint, and its fixes if the text can be edited here. Returns what was clicked.
fn row(ui: &mut Ui, finding: &Finding, is_own: bool) -> Option<Click> {
    let colour = severity_colour(finding.severity, ui.visuals().dark_mode);
    let text = format!("Line {}: {}", finding.line, finding.message);
    let link = ui.link(RichText::new(text).color(colour));
    if let Some(hint) = &finding.hint {
        ui.weak(hint);
    }
    let mut fixes = finding.fixes.iter().filter(|_| is_own).peekable();
    let mut chosen = None;
    if fixes.peek().is_some() {
        ui.horizontal_wrapped(|ui| {
            let clicked = fixes.filter(|fix| ui.small_button(&fix.title).clicked());
            chosen = clicked.last().cloned();
        });
    }
    let place = link.clicked().then_some(Click::Place(finding.span));
    chosen.map(Click::Fix).or(place)
}
