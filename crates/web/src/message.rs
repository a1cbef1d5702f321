//! The messages between the page and the core, as in `web/src/protocol.ts`, which documents each one. Messages carry no
//! bytes; `bindings` has functions for those.

use render::figure::FigureKind;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use session::camera_input::CameraKey;
use session::camera_input::axis_views::{AXIS_VIEWS, AxisView};
use session::measuring::Quantity;

use crate::source::{Utf16Edit, Utf16Range};

/// Reads a message by its name and its params, which are JSON.
///
/// # Errors
/// The sentence about a message that cannot be read.
pub fn read_message<T: DeserializeOwned>(name: &str, params: &str) -> Result<T, String> {
    // Via a value: a text parser for each type would add a tenth to the download.
    let params: Result<Value, _> = serde_json::from_str(params);
    let named =
        params.map(|params| Value::Object([(name.to_owned(), params)].into_iter().collect()));
    let message = named.and_then(serde_json::from_value);
    message.map_err(|error| format!("the message `{name}` cannot be read: {error}"))
}

/// A request of the page that is answered.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub enum Call {
    Open {
        name: String,
        text: String,
        version: i32,
        #[serde(default)]
        settings: Option<Value>,
    },
    Hover {
        at: u32,
    },
    Complete {
        at: u32,
    },
    Describe {
        at: u32,
        label: String,
    },
    Signature {
        at: u32,
    },
    Definition {
        at: u32,
    },
    Occurrences {
        at: u32,
    },
    PrepareRename {
        at: u32,
    },
    Rename {
        at: u32,
        name: String,
    },
    Format {
        range: Option<Utf16Range>,
    },
    Fixes(Utf16Range),
    FixAll {},
    Declaration {
        name: String,
    },
    WriteParam {
        param: String,
    },
    WriteCamera {
        name: String,
    },
    WriteColour {
        object: String,
        rgb: [u8; 3],
    },
    Settings {},
    Undo {},
    Redo {},
    Pick {
        view: String,
        at: [f64; 2],
        #[serde(default)]
        measures: bool,
    },
    Click {
        view: String,
        at: [f64; 2],
    },
    DoubleClick {
        view: String,
        at: [f64; 2],
    },
    Measure {
        figure: Option<AskedFigure>,
    },
    MeasureWalk {},
    WalkBack {},
}

/// A notice of the page, which is not answered.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase", rename_all_fields = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub enum Notice {
    Edit {
        version: i32,
        changes: Vec<Utf16Edit>,
    },
    Text {
        version: i32,
        text: String,
    },
    Cursor {
        at: Option<u32>,
    },
    ReplaceSettings {
        settings: Value,
    },
    Change {
        patch: Value,
        #[serde(default)]
        step: Option<String>,
    },
    Light {
        is_light: bool,
    },
    Panes {
        panes: Vec<Pane>,
    },
    Shown {
        view: String,
    },
    Focus {
        view: Option<String>,
    },
    Drag {
        view: String,
        grip: Grip,
        by: [f64; 2],
    },
    Zoom {
        view: String,
        at: [f64; 2],
        factor: f64,
    },
    Twist {
        view: String,
        angle: f64,
    },
    Hold {
        view: String,
        keys: Vec<CameraKey>,
        shift: bool,
        alt: bool,
    },
    Camera {
        view: String,
        #[serde(rename = "move")]
        to: CameraMove,
    },
    Release {},
}

/// A message that the core sends by itself.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(
    tag = "event",
    content = "params",
    rename_all = "camelCase",
    rename_all_fields = "camelCase"
)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub enum CoreEvent {
    Findings {
        version: i32,
        findings: Vec<PageFinding>,
    },
    Scene(Box<SceneInfo>),
    Settings {
        settings: Value,
    },
    NoPicture {
        view: String,
        message: String,
    },
    Busy {
        view: Option<String>,
        is_busy: bool,
    },
    Resync {
        version: i32,
    },
}

/// A pane on the page.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq)]
pub struct Pane {
    /// The name of its view.
    pub view: String,
    /// Its width in pixels.
    pub width: u32,
    /// Its height in pixels.
    pub height: u32,
}

/// A use of the pointer in a view in space.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub enum Grip {
    Orbit,
    Look,
    Pan,
}

/// A preset position of a camera: `"reset"`, `"frame"`, or the end of an axis: `"+x"`, `"-z"`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "String")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub enum CameraMove {
    Reset,
    Frame,
    Axis(&'static AxisView),
}

impl TryFrom<String> for CameraMove {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        match name.as_str() {
            "reset" => Ok(Self::Reset),
            "frame" => Ok(Self::Frame),
            name => {
                let end = name.replace('-', "−");
                let view = AXIS_VIEWS.iter().find(|view| view.end(view.axis) == end);
                let unknown = || format!("there is no place `{name}` for a camera");
                view.map(Self::Axis).ok_or_else(unknown)
            }
        }
    }
}

/// A figure to be measured.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct AskedFigure {
    /// The surface or metric on which it is.
    pub surface: String,
    /// Its kind.
    #[serde(deserialize_with = "figure_kind")]
    pub kind: FigureKind,
    /// Its points, (u, v).
    pub places: Vec<[f64; 2]>,
    /// The radius of a circle.
    #[serde(default)]
    pub radius: Option<f64>,
}

fn figure_kind<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<FigureKind, D::Error> {
    let name = String::deserialize(deserializer)?;
    let found = FigureKind::ALL.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| serde::de::Error::custom(format!("there is no figure `{name}`")))
}

/// A diagnostic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PageFinding {
    /// Its range.
    #[serde(flatten)]
    pub range: Utf16Range,
    /// `error`, `warning` or `hint`.
    pub severity: &'static str,
    /// Its code.
    pub code: &'static str,
    /// One sentence.
    pub message: String,
    /// A sentence with advice.
    pub hint: Option<String>,
    /// Other ranges that explain it.
    pub related: Vec<Related>,
}

/// Another range that explains a diagnostic.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Related {
    /// The range.
    #[serde(flatten)]
    pub range: Utf16Range,
    /// One sentence.
    pub message: String,
}

/// The scene of the last valid state of the text.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct SceneInfo {
    pub version: i32,
    pub stale: bool,
    /// In milliseconds.
    pub took: f64,
    pub views: Vec<ViewInfo>,
    pub params: Vec<ParamInfo>,
    pub objects: Vec<ObjectInfo>,
    pub cameras: Vec<String>,
    pub images: Vec<ImageInfo>,
    pub empty: Option<String>,
}

/// A view of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct ViewInfo {
    pub id: String,
    pub kind: String,
    pub object: Option<String>,
    pub title: String,
    pub purpose: &'static str,
    pub opens_by_itself: bool,
    pub camera: Option<&'static str>,
    pub keys: Vec<KeyInfo>,
    pub settings: Vec<SettingInfo>,
    pub instead: Option<&'static str>,
}

/// A key or gesture of a view.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct KeyInfo {
    pub keys: &'static str,
    pub action: &'static str,
}

/// A setting of a view.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct SettingInfo {
    pub name: &'static str,
    pub title: &'static str,
    pub default: bool,
}

/// A param.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct ParamInfo {
    pub name: String,
    pub components: Vec<ComponentInfo>,
}

/// A component of a param.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct ComponentInfo {
    pub value: f64,
    pub initial: f64,
    pub min: f64,
    pub max: f64,
}

/// An object that is drawn.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct ObjectInfo {
    pub name: String,
    pub kind: &'static str,
    pub colour: [u8; 3],
    pub is_colour_chosen: bool,
    pub stated_colour: Option<&'static str>,
    pub hidden: bool,
    pub has_texture: bool,
    pub stale: bool,
    pub range: Option<Utf16Range>,
}

/// An image that the text names.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct ImageInfo {
    pub word: String,
    pub is_there: bool,
}

/// The object at a point of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct Pick {
    pub object: String,
    pub kind: &'static str,
    pub instance: u64,
    pub position: Option<[f64; 3]>,
    pub parameters: Vec<f64>,
    pub polar: Option<[f64; 2]>,
    pub rows: Vec<QuantityRow>,
    pub text: String,
    pub range: Option<Utf16Range>,
}

/// A quantity with its value, in words.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct QuantityRow {
    pub name: String,
    pub value: String,
}

impl From<&Quantity> for QuantityRow {
    fn from(quantity: &Quantity) -> Self {
        Self {
            name: quantity.name.clone(),
            value: quantity.value.clone(),
        }
    }
}

/// The description of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(missing_docs, reason = "the protocol documents them")]
pub struct PictureInfo {
    pub view: String,
    pub width: u32,
    pub height: u32,
    pub exact: bool,
    pub version: i32,
    pub samples: Option<[u32; 2]>,
    pub notes: Vec<String>,
    pub place: Option<String>,
    /// In milliseconds.
    pub took: f64,
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn the_page_makes_every_call() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../web/src");
        let read = |path: &Path| std::fs::read_to_string(path).expect("a file of the page");
        let protocol = read(&folder.join("protocol.ts"));
        let (_, calls) = protocol
            .split_once("export interface Calls {")
            .expect("the calls");
        let (calls, _) = calls.split_once("\n}").expect("their end");
        let calls = calls.lines().filter_map(|line| {
            let name = line.strip_prefix("  ")?.split_once(": {")?.0;
            name.chars().all(char::is_alphabetic).then_some(name)
        });
        let calls: Vec<&str> = calls.collect();
        assert!(calls.len() > 20, "{calls:?}");
        let folders = [folder.clone(), folder.join("editor")];
        let files = folders.iter().flat_map(|folder| {
            let entries = std::fs::read_dir(folder).expect("the page");
            entries.map(|entry| entry.expect("a file").path())
        });
        let files = files.filter(|path| {
            path.extension().is_some_and(|it| it == "ts") && !path.ends_with("protocol.ts")
        });
        let page: String = files.map(|path| read(&path)).collect();
        for call in calls {
            assert!(page.contains(&format!("\"{call}\"")), "{call}");
        }
    }
}
