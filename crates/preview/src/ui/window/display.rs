//! The window's display: its GPU, its size and its style.

use egui::{Color32, Ui, Vec2};
use session::clicks::DOUBLE_CLICK;
use session::{Preferences, Theme};

use super::frame_clock::FrameClock;
use crate::ui::event_splitter::EventSplitter;
use crate::ui::gpu_surface::GpuSurface;

/// The display of a window.
pub(crate) struct Display {
    /// The GPU that displays the window; `None` in tests.
    pub(crate) surface: Option<GpuSurface>,
    /// The name of the backend that draws the pictures.
    pub(crate) backend: String,
    /// The size of the window in the display's points.
    pub(crate) size: Option<Vec2>,
    /// The times of its frames.
    pub(crate) clock: FrameClock,
    /// True if the window is to come to the front.
    pub(crate) raise: bool,
    /// True if the window is to close.
    pub(crate) closing: bool,
    /// The context's current theme and scale.
    style: Option<(Theme, f32)>,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            surface: None,
            backend: "software".to_owned(),
            size: None,
            clock: FrameClock::default(),
            raise: false,
            closing: false,
            style: None,
        }
    }
}

impl Display {
    /// Displays the window by another GPU, whose context has no style yet.
    pub(super) fn replace(&mut self, surface: GpuSurface, backend: String) {
        self.surface = Some(surface);
        self.backend = backend;
        self.style = None;
    }

    /// Returns the colour behind text. The display is cleared with it, so that no background need be painted.
    pub(crate) fn background(&self, ui: &Ui) -> Color32 {
        match self.surface {
            Some(_) => Color32::TRANSPARENT,
            None => ui.visuals().panel_fill,
        }
    }

    /// Sets the theme and the scale of the preferences in the context, if they differ.
    pub(super) fn apply_style(&mut self, context: &egui::Context, preferences: &Preferences) {
        let style = (preferences.theme, preferences.scale);
        if self.style == Some(style) {
            return;
        }
        self.style = Some(style);
        // Once per context.
        context.add_plugin(EventSplitter::default());
        context.options_mut(|options| {
            // Its keys change the setting.
            options.zoom_with_keyboard = false;
            let input = &mut options.input_options;
            // A slow press still counts as a click.
            input.max_click_duration = f64::INFINITY;
            input.max_double_click_delay = DOUBLE_CLICK;
        });
        context.set_theme(match style.0 {
            Theme::System => egui::ThemePreference::System,
            Theme::Light => egui::ThemePreference::Light,
            Theme::Dark => egui::ThemePreference::Dark,
        });
        context.set_zoom_factor(style.1);
        for (theme, grey) in [(egui::Theme::Dark, 168), (egui::Theme::Light, 85)] {
            context.style_mut_of(theme, |style| {
                style.visuals.weak_text_color = Some(Color32::from_gray(grey));
            });
        }
        context.all_styles_mut(|style| {
            // A blinking cursor would redraw the window continuously.
            style.visuals.text_cursor.blink = false;
            style.spacing.slider_width = 150.0;
            style.spacing.interact_size.y = 22.0;
        });
    }
}
