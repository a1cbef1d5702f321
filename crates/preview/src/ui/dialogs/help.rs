//! The pages of the menu *Help*: the language on one page, and information about this program.

use egui::{Grid, Id, Modal, RichText, ScrollArea, Ui};

use super::Dialog;
use crate::ui::window::Window;

/// A page.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum HelpPage {
    Language,
    About,
}

/// Shows a page.
pub(super) fn show(window: &mut Window, page: HelpPage, ui: &Ui) {
    let modal = Modal::new(Id::unique("help")).show(ui.ctx(), |ui| {
        match page {
            HelpPage::Language => language(window, ui),
            HelpPage::About => about(window, ui),
        }
        ui.add_space(8.0);
        ui.button("Close").clicked()
    });
    if !modal.inner && !modal.should_close() {
        window.dialogs.open = Some(Dialog::Help(page));
    }
}

fn language(window: &Window, ui: &mut Ui) {
    let screen = ui.ctx().content_rect();
    ui.set_width((screen.width() - 80.0).min(820.0));
    ui.heading("The language on one page");
    let width = ui.available_width();
    let room = (screen.height() - 160.0).max(120.0);
    let area = ScrollArea::vertical().max_height(room);
    area.auto_shrink([false, true]).show(ui, |ui| {
        Grid::new("language")
            .num_columns(2)
            .striped(true)
            .spacing([16.0, 3.0])
            .max_col_width(0.48 * width)
            .show(ui, |ui| {
                for row in window.text.language().overview() {
                    ui.add(egui::Label::new(RichText::new(row.code).monospace()).wrap());
                    ui.add(egui::Label::new(row.text.replace('`', "")).wrap());
                    ui.end_row();
                }
            });
    });
}

fn about(window: &Window, ui: &mut Ui) {
    ui.set_width(320.0);
    ui.heading(concat!("Geotrace ", env!("CARGO_PKG_VERSION")));
    ui.label("Curves, surfaces and solids as short programs, seen in space and from inside.");
    ui.add_space(4.0);
    ui.label(format!("Pictures are drawn by: {}", window.display.backend));
}
