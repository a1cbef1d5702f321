//! The command that draws a picture again. In: a request. Out: the options of `geotrace render`, and a line for a
//! shell.
//!
//! Numbers have as many digits as they need to be read back exactly.

use std::path::Path;
use std::sync::Arc;

use render::figure::Figure;
use render::geodesic_view::{PlacedCamera, PlacedSolidCamera};
use render::request::{Overlays, Spacing};
use render::shared::Shared;
use render::style::Theme;
use render::texture::Texture;
use render::trail::{Trail, TrailKind};
use render::view::View;
use render::view::traced::TracedOptions;
use render::viewpoint::{GeodesicCamera, Pose, Projection};
use render::{PictureMethod, PictureRequest, ViewId, Views};
use scene::{GridId, ObjectId};

/// The maximum number of points of a path that has an option: Linux accepts words up to 128 KiB, and a point takes up
/// to 50 bytes.
pub const MOST_PLACES: usize = 2000;

/// An option of `geotrace render`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PictureOption {
    /// Its name, without the leading dashes.
    pub name: &'static str,
    /// Its value; `None` for an option without one.
    pub value: Option<String>,
}

impl PictureOption {
    /// Returns the word of a command line: `--name` or `--name=value`.
    pub fn word(&self) -> String {
        match &self.value {
            Some(value) => format!("--{}={value}", self.name),
            None => format!("--{}", self.name),
        }
    }
}

/// Returns the options with which `geotrace render` draws the picture of a request. Defaults are omitted.
pub fn options(request: &PictureRequest, views: &Views) -> Vec<PictureOption> {
    // A new field requires an option here, or a reason for having none.
    let PictureRequest {
        scene: _,
        params: _,
        view,
        size: [width, height],
        textures: _,
        // No option: the images that the program names are beside it, and only an option replaces the background.
        images: _,
        background_image: _,
        flipped: _,
        curved: _,
        theme,
        colours: _,
        overlays,
        scale,
        trails,
        // A picture that is saved is of a view at rest.
        moving: _,
        magnification: _,
    } = request;
    let mut options = Vec::new();
    let id = ViewId::from_request(request);
    let traced = view.get::<TracedOptions>();
    let camera = traced.and_then(|traced| traced.space.declared.as_ref());
    options.add(
        "view",
        match camera {
            Some(camera) => format!("{id}:{camera}"),
            None => id.to_string(),
        },
    );
    options.add("size", format!("{width}x{height}"));
    if let Some(traced) = traced {
        if let Some(samples) = traced.samples {
            options.add("samples", samples.to_string());
        }
        if let Some(bounces) = traced.bounces {
            options.add("bounces", bounces.to_string());
        }
        if let Some(look) = traced.look {
            options.add("look", look.name().to_owned());
        }
        if let Some(gamma) = traced.gamma {
            options.add("gamma", gamma.to_string());
        }
    }
    if *theme == Theme::Print {
        options.add("theme", "print".to_owned());
    }
    settings(&mut options, request, views);
    params(&mut options, request);
    space(&mut options, request);
    if let Some(camera) = view.shown_camera().filter(|_| view.draws_lines()) {
        geodesic_camera(&mut options, request, camera);
    }
    objects(&mut options, request);
    over(&mut options, view.drawn(*overlays));
    if view.draws_lines() {
        self::trails(&mut options, request, trails);
    }
    if *scale != 1.0 {
        options.add("scale", scale.to_string());
    }
    options
}

/// Returns a shell command line that draws a program's picture with these options.
pub fn command(program: &Path, output: &Path, options: &[PictureOption]) -> String {
    let mut line = "geotrace render".to_owned();
    let fixed = [
        program.display().to_string(),
        "-o".to_owned(),
        output.display().to_string(),
    ];
    for word in fixed
        .into_iter()
        .chain(options.iter().map(PictureOption::word))
    {
        line.push(' ');
        line.push_str(&quoted(&word));
    }
    line
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

/// A list of options that grows.
trait Grow {
    fn add(&mut self, name: &'static str, value: String);
    fn flag(&mut self, name: &'static str, is_set: bool);
    fn numbers(&mut self, name: &'static str, numbers: &[f64]);
}

impl Grow for Vec<PictureOption> {
    fn add(&mut self, name: &'static str, value: String) {
        let value = Some(value);
        self.push(PictureOption { name, value });
    }

    fn flag(&mut self, name: &'static str, is_set: bool) {
        if is_set {
            self.push(PictureOption { name, value: None });
        }
    }

    fn numbers(&mut self, name: &'static str, numbers: &[f64]) {
        self.add(name, list(numbers));
    }
}

fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    numbers.join(",")
}

/// Adds the settings of the view, and its method.
fn settings(options: &mut Vec<PictureOption>, request: &PictureRequest, views: &Views) {
    let known = views.get(request.view.name()).map(View::settings);
    for setting in known.unwrap_or_default() {
        if let Some(on) = request.view.is_on(setting.name)
            && on != setting.default
        {
            let state = if on { "on" } else { "off" };
            options.add("setting", format!("{}={state}", setting.name));
        }
    }
    let method = request.view.method().unwrap_or_default();
    if method != PictureMethod::default() {
        options.add("method", method.name().to_owned());
    }
}

fn params(options: &mut Vec<PictureOption>, request: &PictureRequest) {
    let (scene, params) = (&request.scene, &request.params);
    for param in &scene.params {
        let values = params.param(param);
        if values != param.initial {
            options.add("set", format!("{}={}", param.name, list(values)));
        }
    }
    for (id, grid) in (0..).map(GridId).zip(&scene.grids) {
        if let Some(values) = params.fixed_grid(scene, id) {
            options.add("set", format!("{}={}", grid.name, list(values)));
        }
    }
}

fn space(options: &mut Vec<PictureOption>, request: &PictureRequest) {
    let Some(space) = request.view.space() else {
        return;
    };
    let camera = &space.camera;
    for (name, place) in [("eye", camera.eye), ("target", camera.target)] {
        if let Some(place) = place {
            // In the text's coordinates.
            options.numbers(name, &request.scene.stated(place.0));
        }
    }
    let is_flat = camera.projection == Projection::Orthographic;
    let is_traced = request.view.get::<TracedOptions>().is_some();
    options.flag("orthographic", is_flat && !is_traced);
    if let Some(colour) = space.background {
        let digits = if colour[3] == 255 { 3 } else { 4 };
        options.add("background", hexadecimal(&colour[..digits]));
    }
    let objects = request.scene.numbered();
    for (_, object) in objects.filter(|(id, _)| !space.shows(*id)) {
        options.add("hide", object.name.clone());
    }
}

fn hexadecimal(parts: &[u8]) -> String {
    parts.iter().map(|part| format!("{part:02x}")).collect()
}

/// Adds the position of a geodesic camera.
fn geodesic_camera(
    options: &mut Vec<PictureOption>,
    request: &PictureRequest,
    camera: &GeodesicCamera,
) {
    if request.view.space().is_some()
        && let Some(surface) = request.scene.get(camera.surface)
    {
        options.add("show-camera", surface.name.clone());
    }
    let GeodesicCamera {
        surface: _,
        pose,
        zoom,
    } = by_angle(request, camera);
    if let Pose::At {
        at,
        angle,
        mirrored,
    } = pose
    {
        if let Some(at) = at {
            options.numbers("at", &at);
        }
        if angle != 0.0 {
            options.numbers("angle", &[degrees(angle)]);
        }
        options.flag("mirrored", mirrored);
    }
    if let Pose::InSpace { at, angle } = pose {
        if let Some(at) = at {
            options.numbers("at", &request.scene.stated(at));
        }
        if angle != 0.0 {
            options.numbers("angle", &[degrees(angle)]);
        }
    }
    if let Some(zoom) = zoom {
        options.numbers("zoom", &[zoom]);
    }
}

/// Returns the camera with its direction as an angle; unchanged if it cannot be placed.
fn by_angle(request: &PictureRequest, camera: &GeodesicCamera) -> GeodesicCamera {
    let placed = || PlacedCamera::new(&request.scene, &request.params, camera, request.size).ok();
    let on_solid = || {
        let (scene, params) = (&request.scene, &request.params);
        PlacedSolidCamera::new(scene, params, camera, request.size).ok()
    };
    match camera.pose {
        Pose::At { .. } | Pose::InSpace { .. } => *camera,
        Pose::SpaceFrame(_) => on_solid().map_or(*camera, |placed| placed.by_angle()),
        Pose::Frame(_) => placed().map_or(*camera, |placed| placed.by_angle()),
    }
}

/// Returns the number of degrees that is read back as exactly this angle, if there is one.
fn degrees(angle: f64) -> f64 {
    let near = angle.to_degrees();
    let candidates = [near, near.next_up(), near.next_down()];
    let exact = candidates.into_iter().find(|it| it.to_radians() == angle);
    exact.unwrap_or(near)
}

fn objects(options: &mut Vec<PictureOption>, request: &PictureRequest) {
    for (id, object) in request.scene.numbered() {
        let name = &object.name;
        if let Some(texture) = texture(request, id) {
            options.add("texture", format!("{name}={texture}"));
        }
        if request.flipped.contains(&id) {
            options.add("flip", name.clone());
        }
        if let Some(colour) = request.chosen_colour(id) {
            options.add("colour", format!("{name}={}", hexadecimal(&colour)));
        }
    }
}

/// Returns the word for the image of a surface; `None` if it shows the built-in one.
fn texture(request: &PictureRequest, id: ObjectId) -> Option<String> {
    let own = request.textures.iter().rev().find(|(it, _)| *it == id);
    let is_curved = |texture: &Texture| texture.curvature_scale().is_some();
    if request.curved.contains(&id) || own.is_some_and(|(_, texture)| is_curved(texture)) {
        return Some("curvature".to_owned());
    }
    let (_, texture) = own?;
    match texture.file() {
        Some(file) => {
            let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
            Some(file.display().to_string())
        }
        None => (**texture == *Texture::plain()).then(|| "plain".to_owned()),
    }
}

/// Adds what is drawn over the picture.
fn over(options: &mut Vec<PictureOption>, overlays: Overlays) {
    let Overlays {
        legend,
        wavefronts,
        conjugate_points,
        cut_locus,
        error,
        labels,
        axes,
        hidden_lines,
    } = overlays;
    options.flag("labels", labels);
    options.flag("legend", legend);
    options.flag("axes", axes);
    options.flag("hidden-lines", hidden_lines);
    options.flag("cut-locus", cut_locus);
    options.flag("error", error);
    options.flag("conjugate", conjugate_points);
    match wavefronts {
        None => {}
        Some(Spacing::Auto) => options.flag("wavefronts", true),
        Some(Spacing::Every(distance)) => options.numbers("wavefronts", &[distance]),
    }
}

/// Adds the figures and paths that are drawn.
fn trails(options: &mut Vec<PictureOption>, request: &PictureRequest, trails: &[Shared<Trail>]) {
    let mut known: Vec<(ObjectId, &Arc<Figure>)> = Vec::new();
    for trail in trails {
        let Some(surface) = request.scene.get(trail.surface) else {
            continue;
        };
        match &trail.kind {
            TrailKind::Walked if (2..=MOST_PLACES).contains(&trail.points.len()) => {
                let value = format!("{}={}", surface.name, places(&trail.points));
                options.add("path", value);
            }
            TrailKind::Walked => {}
            TrailKind::Measured(figure) if known.contains(&(trail.surface, figure)) => {}
            TrailKind::Measured(figure) => {
                known.push((trail.surface, figure));
                let (name, kind) = (&surface.name, figure.kind.name());
                let mut value = format!("{name}={kind}:{}", places(&figure.places));
                if let Some(radius) = figure.radius {
                    value.push_str(&format!(":{radius}"));
                }
                options.add("figure", value);
            }
        }
    }
}

/// Returns whether a path has an option: command lines are limited, so a path of many points has none.
pub fn has_option(trail: &Trail) -> bool {
    trail.kind != TrailKind::Walked || trail.points.len() <= MOST_PLACES
}

fn places(places: &[[f64; 2]]) -> String {
    let places: Vec<String> = places.iter().map(|place| list(place)).collect();
    places.join(":")
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{PictureOption, command, degrees};

    #[test]
    fn words_are_quoted_where_a_shell_would_read_them_otherwise() {
        let option = |name, value: &str| PictureOption {
            name,
            value: Some(value.to_owned()),
        };
        let options = [
            option("set", "a=-1"),
            option("texture", "s=/it's here/map.png"),
            PictureOption {
                name: "axes",
                value: None,
            },
        ];
        assert_eq!(
            command(
                Path::new("my torus.gtr"),
                Path::new("torus-3d.png"),
                &options
            ),
            "geotrace render 'my torus.gtr' -o torus-3d.png --set=a=-1 \
             '--texture=s=/it'\\''s here/map.png' --axes"
        );
    }

    #[test]
    fn an_angle_of_some_degrees_is_read_back() {
        for k in 0..10_000 {
            let given = f64::from(k) * 0.037_123_456_7 - 180.0;
            let angle = given.to_radians();
            assert_eq!(degrees(angle).to_radians(), angle, "{given}");
        }
    }
}
