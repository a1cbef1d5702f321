//! The settings for all programs: a small file in the user's state folder, which all windows share.
//!
//! A file that cannot be read yields the defaults; if none can be written, a setting only applies to this window.

use std::path::{Path, PathBuf};

use export::whole_file::write_whole;
use serde::{Deserialize, Serialize};
use session::Theme;

/// The settings.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Settings {
    /// True if the choices for a program are saved in a file beside it.
    pub(crate) remembers_views: bool,
    /// The theme, once it is chosen.
    pub(crate) theme: Option<Theme>,
    /// The scale of text and controls, once it is chosen.
    pub(crate) scale: Option<f32>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            remembers_views: true,
            theme: None,
            scale: None,
        }
    }
}

/// The settings, with their file.
#[derive(Debug, Default)]
pub(crate) struct SharedSettings {
    /// `None` if nothing is to be saved.
    file: Option<PathBuf>,
    now: Settings,
}

impl SharedSettings {
    /// Reads the settings in a folder.
    pub(crate) fn in_folder(folder: &Path) -> Self {
        let file = folder.join("settings.json");
        Self {
            now: read(&file),
            file: Some(file),
        }
    }

    /// Returns the current settings.
    pub(crate) fn now(&self) -> Settings {
        self.now
    }

    /// Changes the current settings, which another window may have changed: for this window, and for all that are
    /// opened from now on.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut Settings)) {
        if let Some(file) = &self.file {
            self.now = read(file);
        }
        change(&mut self.now);
        if let Some(file) = &self.file
            && let Some(folder) = file.parent()
            && std::fs::create_dir_all(folder).is_ok()
            && let Ok(bytes) = serde_json::to_vec_pretty(&self.now)
        {
            let _ = write_whole(file, &bytes);
        }
    }
}

/// Reads the settings of a file; missing ones have their defaults.
fn read(file: &Path) -> Settings {
    let bytes = std::fs::read(file).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::{Settings, SharedSettings};

    #[test]
    fn settings_are_kept_and_what_cannot_be_read_is_at_its_default() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("not/there/yet");
        let mut settings = SharedSettings::in_folder(&place);
        assert!(settings.now().remembers_views);
        settings.change(|settings| {
            settings.remembers_views = false;
            settings.scale = Some(1.5);
        });
        assert_eq!(SharedSettings::in_folder(&place).now().scale, Some(1.5));
        assert!(!SharedSettings::in_folder(&place).now().remembers_views);
        std::fs::write(place.join("settings.json"), "{ broken").expect("written");
        assert_eq!(SharedSettings::in_folder(&place).now(), Settings::default());
        std::fs::write(place.join("settings.json"), "{}").expect("written");
        assert_eq!(SharedSettings::in_folder(&place).now(), Settings::default());
    }

    #[test]
    fn a_window_keeps_what_another_one_has_set() {
        let folder = tempfile::tempdir().expect("a folder");
        let [mut one, mut other] = [(); 2].map(|()| SharedSettings::in_folder(folder.path()));
        one.change(|settings| settings.remembers_views = false);
        other.change(|settings| settings.scale = Some(1.5));
        let now = SharedSettings::in_folder(folder.path()).now();
        assert!(!now.remembers_views);
        assert_eq!(now.scale, Some(1.5));
    }
}
