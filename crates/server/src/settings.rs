//! The user's settings.

use serde_json::Value;

/// The settings under `geotrace` that the server uses.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Settings {
    /// Show how words are split: `geotrace.inlayHints.splits`.
    pub(crate) splits: bool,
    /// Show the values of defines: `geotrace.inlayHints.values`.
    pub(crate) values: bool,
    /// Offer the views of surfaces above them: `geotrace.codeLens`.
    pub(crate) lenses: bool,
    /// Open the window of each document that is opened: `geotrace.preview.open` is `"onOpen"`, and
    /// `geotrace.preview.in` is not `"panel"`, which the editor opens itself.
    pub(crate) preview_on_open: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            splits: true,
            values: true,
            lenses: true,
            preview_on_open: false,
        }
    }
}

impl Settings {
    /// Returns the settings with the editor's JSON applied: the section itself, or an object that contains it. Values
    /// that are missing or of another type stay as they are.
    #[must_use]
    pub(crate) fn with(self, json: &Value) -> Self {
        let section = json.get("geotrace").unwrap_or(json);
        let value = |path: &[&str]| path.iter().try_fold(section, |value, key| value.get(key));
        let flag =
            |path: &[&str], before: bool| value(path).and_then(Value::as_bool).unwrap_or(before);
        let open = value(&["preview", "open"]).and_then(Value::as_str);
        let is_panel = value(&["preview", "in"]).and_then(Value::as_str) == Some("panel");
        Self {
            splits: flag(&["inlayHints", "splits"], self.splits),
            values: flag(&["inlayHints", "values"], self.values),
            lenses: flag(&["codeLens"], self.lenses),
            preview_on_open: open
                .map_or(self.preview_on_open, |when| when == "onOpen" && !is_panel),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Settings;
    use serde_json::json;

    #[test]
    fn what_is_not_set_is_as_it_was() {
        let settings =
            Settings::default().with(&json!({"geotrace": {"inlayHints": {"splits": false}}}));
        assert_eq!(
            settings,
            Settings {
                splits: false,
                ..Settings::default()
            }
        );
        let settings = settings.with(&json!({"codeLens": false, "inlayHints": 7}));
        assert_eq!(
            (settings.splits, settings.values, settings.lenses),
            (false, true, false)
        );
        assert_eq!(settings.with(&json!(null)), settings);
        let opened = settings.with(&json!({"preview": {"open": "onOpen"}}));
        assert!(opened.preview_on_open && opened.with(&json!({"preview": 1})) == opened);
        assert!(
            !opened
                .with(&json!({"preview": {"open": "onCommand"}}))
                .preview_on_open
        );
        let in_panel = json!({"preview": {"open": "onOpen", "in": "panel"}});
        assert!(!opened.with(&in_panel).preview_on_open);
    }
}
