//! The user's choices of what is shown. They are identified by name, so that they survive a new compilation, and are
//! saved, so that they survive the session.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use render::view::Setting;
use scene::{Param, ParamValues, Range, Scene};
use serde::{Deserialize, Serialize};

use super::camera::SpaceCamera;
use super::inside_camera::InsideCamera;
use super::pane::saved_views;

/// The chosen values of params, by name and component.
pub type ChosenParams = BTreeMap<String, Vec<Option<f64>>>;

/// All choices.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Choices {
    /// The appearance of objects, by name.
    pub looks: BTreeMap<String, Look>,
    /// The chosen values of params.
    pub params: ChosenParams,
    /// The declared values of the params that have a chosen value, by component.
    pub openings: BTreeMap<String, Vec<DeclaredValue>>,
    /// The animated params.
    pub animations: BTreeMap<String, Animation>,
    /// The camera of the views in space; if absent, everything is seen.
    pub space: Option<SpaceCamera>,
    /// The cameras of the geodesic views, by their surfaces' names.
    pub inside: BTreeMap<String, InsideCamera>,
    /// The closed views of objects, by name: `geodesic:s`.
    pub closed: BTreeSet<String>,
    /// The opened views among those that do not open by themselves, by name.
    pub opened: BTreeSet<String>,
    /// The image files that surfaces may show, in the order in which they were opened.
    pub textures: Vec<PathBuf>,
    /// The texture of surfaces without a choice of their own.
    pub default_texture: TextureChoice,
    /// All other choices.
    pub preferences: Preferences,
}

/// The appearance of an object.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Look {
    /// Its colour, sRGB; `None` for the default of its kind.
    pub colour: Option<[u8; 3]>,
    /// The texture of a surface.
    pub texture: TextureChoice,
    /// True if its image is upside down.
    pub flipped: bool,
    /// True if it is not drawn.
    pub hidden: bool,
}

/// A texture.
#[derive(Clone, Debug, Default, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum TextureChoice {
    /// The session's default; as the default itself, the built-in picture that shows directions.
    #[default]
    Default,
    /// No picture: only the colour.
    Plain,
    /// The Gaussian curvature, in colours.
    Curvature,
    /// An image file.
    Image(PathBuf),
}

/// The declared value and interval of a component of a param.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct DeclaredValue {
    /// The initial value: the declared one, or else the minimum.
    pub value: f64,
    /// The minimum.
    pub min: f64,
    /// The maximum.
    pub max: f64,
}

impl DeclaredValue {
    /// Returns the values of all components of a param.
    pub fn all(param: &Param) -> Vec<Self> {
        let values = param.initial.iter().zip(&param.ranges);
        let declared = |(value, range): (&f64, &Range)| Self {
            value: *value,
            min: range.min,
            max: range.max,
        };
        values.map(declared).collect()
    }

    /// Returns whether the declared initial value changed. A default that moved only because the interval changed
    /// does not count.
    pub fn differs(&self, now: &Self) -> bool {
        let same_range = (self.min, self.max) == (now.min, now.max);
        self.value != now.value && (same_range || now.value != now.min)
    }
}

/// Returns the values of a scene's params: the chosen ones, clamped to their intervals.
pub fn chosen_values(scene: &Scene, chosen: &ChosenParams) -> ParamValues {
    let mut param_values = ParamValues::initial(scene);
    for param in &scene.params {
        let Some(values) = chosen.get(&param.name) else {
            continue;
        };
        let mut all = param_values.param(param).to_vec();
        for ((value, chosen), range) in all.iter_mut().zip(values).zip(&param.ranges) {
            if let Some(chosen) = chosen.filter(|it| it.is_finite()) {
                *value = chosen.clamp(range.min, range.max);
            }
        }
        // Within their intervals, values are not refused.
        let _ = param_values.set(scene, &param.name, &all);
    }
    param_values
}

/// The animation of a param's components.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Animation {
    /// True for each animated component.
    pub on: Vec<bool>,
    /// Units per second.
    pub speed: f64,
}

impl Default for Animation {
    fn default() -> Self {
        Self {
            on: Vec::new(),
            speed: 1.0,
        }
    }
}

/// A light or dark theme.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum Theme {
    /// The desktop's theme.
    #[default]
    System,
    /// Dark text on a light background.
    Light,
    /// Light text on a dark background.
    Dark,
}

/// The overlays of pictures.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Marks {
    /// A key to lines and hatching.
    pub legend: bool,
    /// Geodesic circles around the camera.
    pub wavefronts: bool,
    /// Conjugate points.
    pub conjugate: bool,
    /// The cut locus.
    pub cut_locus: bool,
    /// The estimated error.
    pub error: bool,
    /// Names beside the objects.
    pub labels: bool,
    /// A box with ticks around the scene.
    pub axes: bool,
    /// The geodesic cameras, in the views in space.
    pub cameras: bool,
    /// The paths of geodesic cameras.
    pub trail: bool,
    /// The chosen settings of views, by name.
    #[serde(flatten)]
    pub of_views: BTreeMap<String, bool>,
}

impl Marks {
    /// Returns whether a setting of a view is on.
    pub fn is_on(&self, setting: &Setting) -> bool {
        let chosen = self.of_views.get(setting.name);
        chosen.copied().unwrap_or(setting.default)
    }
}

impl Default for Marks {
    fn default() -> Self {
        Self {
            legend: false,
            wavefronts: false,
            conjugate: false,
            cut_locus: false,
            error: false,
            labels: true,
            axes: false,
            cameras: true,
            trail: false,
            of_views: BTreeMap::new(),
        }
    }
}

/// The title of the overlay of wavefronts in the menu.
pub const WAVEFRONTS: &str = "Wavefronts (geodesic circles)";

/// The available sizes of the window's controls, as factors.
pub const SCALES: [f32; 5] = [0.8, 1.0, 1.25, 1.5, 2.0];

/// The maximum number of samples to which a pixel of a traced picture may be refined.
pub const MOST_SAMPLES: u32 = 4096;

/// Choices that belong to no object.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Preferences {
    /// The speed of cameras, 1 by default.
    pub camera_speed: f64,
    /// The background of the views in space, sRGB; `None` for the default.
    pub background: Option<[u8; 3]>,
    /// The theme.
    pub theme: Theme,
    /// The side of pictures of the whole scene in pixels; `None` for the size of their panes.
    pub space_size: Option<u32>,
    /// The side of pictures of one object in pixels; `None` for the size of their panes.
    pub inside_size: Option<u32>,
    /// The overlays of pictures.
    pub marks: Marks,
    /// True if a drag in space turns the camera in place, and not about its target.
    pub fly: bool,
    /// True if the lines of sight of the views in space are parallel.
    pub orthographic: bool,
    /// True if the pane of the whole scene shows it traced: with its lights, shadows, mirrors and glass.
    pub traced: bool,
    /// The declared camera from which the views in space open; the first one if none is chosen.
    pub camera: Option<String>,
    /// The number of samples to which each pixel of a traced picture at rest is refined.
    pub samples: u32,
    /// True if releasing a slider writes its value into the text.
    pub write_on_release: bool,
    /// True if the status line shows what draws the pictures, the time that takes, and their accuracy.
    pub run_times: bool,
    /// The scale of text and controls, 1 by default.
    pub scale: f32,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            camera_speed: 1.0,
            background: None,
            theme: Theme::System,
            space_size: None,
            inside_size: None,
            marks: Marks::default(),
            fly: false,
            orthographic: false,
            traced: false,
            camera: None,
            samples: 256,
            write_on_release: false,
            run_times: false,
            scale: 1.0,
        }
    }
}

impl Choices {
    /// Chooses a value for a component, from 0, of a param, or with `None` leaves it to the text.
    pub fn choose(&mut self, param: &str, component: usize, value: Option<f64>) {
        let values = self.params.entry(param.to_owned()).or_default();
        if values.len() <= component {
            values.resize(component + 1, None);
        }
        values[component] = value;
        if values.iter().all(Option::is_none) {
            self.params.remove(param);
        }
    }

    /// Sets whether a component, from 0, of a param is animated.
    pub fn animate(&mut self, param: &str, component: usize, on: bool) {
        let all = &mut self.animations.entry(param.to_owned()).or_default().on;
        if all.len() <= component {
            all.resize(component + 1, false);
        }
        all[component] = on;
    }

    /// Returns the look of an object.
    pub fn look(&self, name: &str) -> Look {
        self.looks.get(name).cloned().unwrap_or_default()
    }

    /// Returns the texture of a surface; [`TextureChoice::Default`] only stands for the built-in picture.
    pub fn texture(&self, name: &str) -> &TextureChoice {
        match self.looks.get(name).map(|look| &look.texture) {
            None | Some(TextureChoice::Default) => &self.default_texture,
            Some(choice) => choice,
        }
    }

    /// Returns the choices with every number in its valid range: a file may hold anything.
    #[must_use]
    pub fn sane(mut self) -> Self {
        let preferences = &mut self.preferences;
        let clamp = |x: f64, low: f64, high: f64, other: f64| {
            if x.is_finite() {
                x.clamp(low, high)
            } else {
                other
            }
        };
        preferences.camera_speed = clamp(preferences.camera_speed, 0.01, 100.0, 1.0);
        preferences.scale = clamp(f64::from(preferences.scale), 0.5, 4.0, 1.0) as f32;
        preferences.samples = preferences.samples.clamp(1, MOST_SAMPLES);
        for side in [&mut preferences.space_size, &mut preferences.inside_size] {
            *side = side.map(|side| side.clamp(16, 4096));
        }
        for animation in self.animations.values_mut() {
            animation.speed = clamp(animation.speed, -1e6, 1e6, 1.0);
        }
        self.closed = saved_views(self.closed);
        self.space = self.space.filter(SpaceCamera::is_sane);
        self.inside.retain(|_, camera| camera.is_sane());
        for values in self.params.values_mut() {
            for value in values {
                *value = value.filter(|value| value.is_finite());
            }
        }
        self
    }
}
