//! The settings in the page's form: JSON, as the window writes them beside a program.

use render::ViewId;
use serde_json::{Value, json};
use session::{Choices, Step};

use super::Core;

/// Reads settings; absent ones have their initial values.
///
/// # Errors
/// The sentence about a value that cannot be read.
pub(super) fn read(settings: Value) -> Result<Choices, String> {
    let settings = match settings {
        Value::Null => json!({}),
        settings => settings,
    };
    let choices: Choices = serde_json::from_value(settings)
        .map_err(|error| format!("the settings cannot be read: {error}"))?;
    Ok(choices.sane())
}

/// Merges a patch into a value, as defined by RFC 7396.
fn merge(value: &mut Value, patch: &Value) {
    let Value::Object(patch) = patch else {
        value.clone_from(patch);
        return;
    };
    if !value.is_object() {
        *value = json!({});
    }
    let Value::Object(all) = value else {
        return;
    };
    for (name, patch) in patch {
        match patch {
            Value::Null => {
                all.remove(name);
            }
            patch => merge(all.entry(name.as_str()).or_insert(Value::Null), patch),
        }
    }
}

/// Returns the title of a step that changes settings, for "Undo".
fn title(patch: &Value) -> &'static str {
    let has = |name: &str| patch.get(name).is_some();
    let of_look = |name: &str| {
        let looks = patch.get("looks").and_then(Value::as_object);
        looks.is_some_and(|looks| looks.values().any(|look| look.get(name).is_some()))
    };
    match () {
        () if has("params") => "Move a param",
        () if has("animations") => "Animate",
        () if of_look("hidden") => "Show or hide",
        () if of_look("texture") || has("defaultTexture") => "Choose a texture",
        () if of_look("flipped") => "Flip an image",
        () if has("looks") => "Change a colour",
        () if has("space") => "Move the 3D camera",
        () if has("inside") => "Move the geodesic camera",
        () if has("closed") || has("opened") => "Open or close a view",
        () => "Change a setting",
    }
}

impl Core {
    /// Returns all settings.
    pub(super) fn settings(&self) -> Value {
        serde_json::to_value(&self.model.choices).unwrap_or_default()
    }

    pub(super) fn replace_settings(&mut self, settings: Value) {
        // Unreadable settings are ignored: the page sends the ones that it has received, or those of a link.
        if let Ok(choices) = read(settings) {
            self.put(choices, Some(Step::new("Change a setting", "")));
        }
    }

    pub(super) fn change_settings(&mut self, patch: &Value, step: Option<String>) {
        let mut settings = self.settings();
        merge(&mut settings, patch);
        if let Ok(choices) = read(settings) {
            self.put(choices, step.map(|mark| Step::new(title(patch), mark)));
        }
    }

    fn put(&mut self, choices: Choices, step: Option<Step>) {
        self.model.replace(choices, step);
        self.sent.settings.clone_from(&self.model.choices);
        self.sent.is_stale = true;
        self.note_motion();
    }

    /// Returns the edit that makes a param's current value its initial one.
    ///
    /// # Errors
    /// The sentence that says why it is not written.
    pub(super) fn write_param(&mut self, param: &str) -> Result<Value, String> {
        self.read();
        let values = self.model.scene.clone().zip(self.model.param_values());
        let values = values.and_then(|(scene, settings)| {
            let known = scene.params.iter().find(|it| it.name == param)?;
            Some(settings.param(known).to_vec())
        });
        self.editing.write_param(param, &values.unwrap_or_default())
    }

    /// The edit after which a camera of the text stands where that of the 3D view is: the one of a name, or a new one, of another
    /// name where this one is taken.
    ///
    /// # Errors
    /// The sentence that says why it is not written.
    pub(super) fn write_camera(&mut self, name: &str) -> Result<Value, String> {
        self.read();
        let mut cameras = self.model.declared_cameras();
        let name = match cameras.any(|camera| camera.name == name) {
            false if self.model.place_of(name).is_some() => self.model.free_camera_name(),
            _ => name.to_owned(),
        };
        let camera = self.model.choices.space.zip(self.model.scene.as_ref());
        let (camera, scene) = camera.ok_or("nothing is visible in space yet")?;
        // Scripts may name the axes of space otherwise.
        let [eye, target] = [camera.eye, camera.target].map(|place| scene.stated(place));
        let direction = [0, 1, 2].map(|k| target[k] - eye[k]);
        let pane = ViewId::of_scene(self.views.first().name());
        let fov = camera.vertical_fov(self.size(&pane).unwrap_or([1; 2]));
        self.editing.write_camera(&name, direction, eye, fov)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::merge;

    #[test]
    fn a_patch_is_merged_as_its_rfc_has_it() {
        let mut value = json!({ "a": "b", "c": { "d": "e", "f": "g" }, "h": [1, 2] });
        let patch = json!({ "a": "z", "c": { "f": null }, "h": [3], "i": { "j": { "k": null } } });
        merge(&mut value, &patch);
        let expected = json!({ "a": "z", "c": { "d": "e" }, "h": [3], "i": { "j": {} } });
        assert_eq!(value, expected);
    }
}
