//! The window's saved state, and its counters.

use session::{Model, Theme};

use crate::io::path_list::PathList;
use crate::io::persistence::ViewStore;
use crate::io::report::{Counters, Report};
use crate::io::settings::SharedSettings;

/// The records of a window.
#[derive(Default)]
pub(crate) struct Records {
    /// Saves the view between runs.
    pub(super) view_store: Option<ViewStore>,
    pub(crate) counters: Counters,
    /// The settings for all programs.
    pub(super) settings: SharedSettings,
    /// The theme and the scale with which the program was opened.
    pub(super) appearance: Option<(Theme, f32)>,
    /// The programs that were opened last.
    pub(crate) recent: PathList,
    /// Writes the counters after each frame.
    pub(super) report: Option<Report>,
}

impl Records {
    /// Counts a frame, and reports it; `is_settled` is true if the window is settled after it.
    pub(super) fn note_frame(&mut self, model: &mut Model, is_settled: bool) {
        self.counters.frames += 1;
        if let Some(report) = &self.report {
            self.counters.settled = is_settled;
            count(&mut self.counters, model);
            report.write(&self.counters);
        }
    }
}

fn count(counters: &mut Counters, model: &mut Model) {
    counters.stale = model.is_stale();
    counters.status = model.status();
    if let (Some(scene), Some(param_values)) = (model.scene.clone(), model.param_values()) {
        let values = |param| param_values.param(param).to_vec();
        let params = scene.params.iter();
        counters.params = params.map(|it| (it.name.clone(), values(it))).collect();
    }
    counters.eye = model.choices.space.map(|camera| camera.eye);
    let inside = model.choices.inside.iter();
    let paths = model.paths.iter();
    counters.trails = paths
        .map(|(name, path)| (name.clone(), path.trail.length))
        .collect();
    counters.inside = inside
        .map(|(name, it)| (name.clone(), it.place().to_vec()))
        .collect();
}
