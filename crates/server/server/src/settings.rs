//! What a user can set.

use serde_json::Value;

/// The settings under `geotrace` that the server heeds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Settings {
    /// Show how words are split: `geotrace.inlayHints.splits`.
    pub(crate) splits: bool,
    /// Show the values of defines: `geotrace.inlayHints.values`.
    pub(crate) values: bool,
    /// Offer the views of surfaces above them: `geotrace.codeLens`.
    pub(crate) lenses: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            splits: true,
            values: true,
            lenses: true,
        }
    }
}

impl Settings {
    /// From the editor's JSON: the section itself, or an object that holds it. What is missing or of another type is as
    /// it was.
    #[must_use]
    pub(crate) fn with(self, json: &Value) -> Self {
        let section = json.get("geotrace").unwrap_or(json);
        let flag = |path: &[&str], before: bool| {
            let value = path.iter().try_fold(section, |value, key| value.get(key));
            value.and_then(Value::as_bool).unwrap_or(before)
        };
        Self {
            splits: flag(&["inlayHints", "splits"], self.splits),
            values: flag(&["inlayHints", "values"], self.values),
            lenses: flag(&["codeLens"], self.lenses),
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
    }
}
