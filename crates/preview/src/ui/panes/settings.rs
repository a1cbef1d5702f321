//! The settings, in tabs: params, objects, views, preferences.

mod objects;
mod params;
mod script;
mod views;

use egui::{ScrollArea, Ui};
pub(crate) use params::DefineValues;

use crate::ui::window::Window;

/// A tab of the settings.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) enum SettingsTab {
    /// The params' sliders.
    #[default]
    Params,
    /// The looks of objects, and the textures.
    Objects,
    /// The pictures and their cameras.
    Views,
    /// The window itself.
    Preferences,
}

impl SettingsTab {
    const ALL: [(&'static str, Self); 4] = [
        ("Params", Self::Params),
        ("Objects", Self::Objects),
        ("Views", Self::Views),
        ("Preferences", Self::Preferences),
    ];
}

/// Draws the pane.
pub(super) fn show(window: &mut Window, ui: &mut Ui) {
    let margin = egui::Frame::new().inner_margin(8.0);
    margin.show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            for (title, tab) in SettingsTab::ALL {
                ui.selectable_value(&mut window.panes.settings_tab, tab, title);
            }
        });
        ui.separator();
        let tab = window.panes.settings_tab;
        let area = ScrollArea::both().id_salt(tab as u8).auto_shrink(false);
        area.show(ui, |ui| match tab {
            SettingsTab::Params => {
                params::show(window, ui);
                script::show(window, ui);
            }
            SettingsTab::Objects => objects::show(window, ui),
            SettingsTab::Views => views::show(&mut window.model, ui),
            SettingsTab::Preferences => {
                views::preferences(&mut window.model, ui);
                views::memory(window, ui);
            }
        });
    });
    params::write_released(window, ui);
}
