//! Overlays: drawn over a picture on request, and computed only then.
//!
//! ```text
//! geodesic view:  rows of ends ──curves.rs: declared geodesics, trails──────────────────────┐
//! (geodesic.rs;   map of ends ──measured.rs──┬─▶ lines.rs: wavefronts, conjugate points, error ─┼──▶ picture ──legend.rs──▶ picture
//! on a solid                                 └─▶ cut_locus.rs: the cut locus ───────────────────┤
//! solid.rs)       knots in space, map of ends ──solid.rs: declared geodesics────────────────┘
//! 3D view:        a geodesic camera, trails ──space.rs──▶ arrows and curves, drawn as such; legend.rs over them
//! ```
//!
//! Declared geodesics are objects of the scene: they are drawn whenever their surface is shown.

mod axes;
mod curves;
mod cut_locus;
mod geodesic;
mod ink;
mod labels;
mod legend;
mod line_map;
mod lines;
mod measured;
mod solid;
mod space;
mod text;

pub(crate) use axes::AxesBox;
pub(crate) use geodesic::GeodesicOverlay;
pub use labels::PlacedWords;
pub(crate) use labels::{TextLabel, anchors, axis_height, placed};
pub(crate) use line_map::LineMap;
pub(crate) use solid::over_solid;
pub(crate) use space::{KeyedCamera, OverlayObject, camera_objects, trail_objects};
pub use text::{Contour, outlines};

use image::RgbaImage;
use ink::Inks;
use rayon::prelude::*;
use scene::ObjectId;

use crate::camera::Camera;
use crate::error::RenderError;
use crate::occlusion::Occlusion;
use crate::point::DrawingPoint;
use crate::request::PictureRequest;
use crate::sample::{Painter, Samples};
use crate::style::{self, Decoder};
use crate::texture::CurvatureScale;
use crate::trail::Trail;
use crate::viewpoint::GeodesicCamera;

/// Returns the painters that overlays need in space, in addition to those of the scene's objects: for a displayed geodesic
/// camera, and for trails.
pub(crate) fn painters(
    request: &PictureRequest,
    camera: Option<&GeodesicCamera>,
) -> &'static [Painter] {
    let is_shown = |surface| space::is_shown(&request.scene, surface);
    match camera {
        Some(camera) if is_shown(camera.surface) => &space::PAINTERS,
        _ if request.overlays.axes => &[Painter::Curves],
        _ if request.trails.iter().any(|trail| is_shown(trail.surface)) => &[Painter::Curves],
        _ => &[],
    }
}

/// Returns the names of what is drawn in space in addition to the scene's objects.
pub(crate) fn names<'a>(extras: impl IntoIterator<Item = &'a OverlayObject>) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = extras.into_iter().map(|extra| extra.name).collect();
    names.dedup();
    names
}

/// Returns the label at the position of the displayed geodesic camera, if some objects show one.
pub(crate) fn here(
    objects: &[OverlayObject],
    camera: &Camera,
    occlusion: &Occlusion,
) -> Option<TextLabel> {
    let arrow = objects.iter().find_map(|object| match &*object.samples {
        Samples::Vectors(arrows) => arrows.first(),
        _ => None,
    })?;
    let place = DrawingPoint(arrow.origin.map(f64::from));
    let label = TextLabel::beside(camera.pixel_of(place)?, labels::HERE);
    Some(label.hidden(occlusion.hides(place, None)))
}

/// Returns the letters of figures among some objects.
pub(crate) fn letters(
    objects: &[OverlayObject],
    camera: &Camera,
    occlusion: &Occlusion,
) -> Vec<TextLabel> {
    let letters = objects.iter().filter_map(|object| {
        let (letter, place) = object.letter?;
        let label = TextLabel::beside(camera.pixel_of(place)?, letter);
        Some(label.hidden(occlusion.hides(place, None)))
    });
    letters.collect()
}

/// The maximum difference from the backdrop of a pixel that counts as empty.
const NEAR_BACKDROP: u8 = 2;

/// Returns true if there is any overlay on a geodesic picture of a surface.
pub(crate) fn any_geodesic(request: &PictureRequest, surface: ObjectId) -> bool {
    request.overlays.any()
        || request.trails_on(surface).next().is_some()
        || request.scene.geodesics_on(surface).next().is_some()
}

/// Returns true if there is any overlay on a 3D picture that shows this geodesic camera, if any.
pub(crate) fn any_space(request: &PictureRequest, camera: Option<&GeodesicCamera>) -> bool {
    let keyed = || camera.is_some() || keyed_surfaces(request).next().is_some();
    let words = request.overlays.labels || request.overlays.axes;
    words || request.overlays.legend && keyed() || !request.trails.is_empty()
}

/// Draws the overlays of a 3D picture: at the key's position the key to its overlays and to the colours of curvature, if the
/// legend is on, and the lengths of trails; over all of that, labels. Returns the names of what was drawn.
///
/// # Errors
/// Those of the displayed geodesic camera.
pub(crate) fn over_space(
    image: &mut RgbaImage,
    request: &PictureRequest,
    camera: Option<&KeyedCamera<'_>>,
    labels: &[TextLabel],
    place: Option<[f32; 4]>,
) -> Result<Vec<&'static str>, RenderError> {
    let (key, legend) = space_key(request, camera)?;
    key.draw(image, legend::unit(request), place);
    labels::write(image, labels, request, place);
    let drawn = [("legend", legend), ("labels", request.overlays.labels)];
    let drawn = drawn.into_iter().filter(|(_, drawn)| *drawn);
    Ok(drawn.map(|(name, _)| name).collect())
}

/// Returns true if a 3D picture has a key.
///
/// # Errors
/// Those of the displayed geodesic camera.
pub(crate) fn has_space_key(
    request: &PictureRequest,
    camera: Option<&KeyedCamera<'_>>,
) -> Result<bool, RenderError> {
    Ok(!space_key(request, camera)?.0.is_empty())
}

/// Returns the rectangle of the key over a 3D picture, left, top, right and bottom in pixels, if it has one: in the corner
/// that covers least of the scene.
///
/// # Errors
/// Those of the displayed geodesic camera.
pub(crate) fn space_key_place(
    request: &PictureRequest,
    camera: Option<&KeyedCamera<'_>>,
    image: &RgbaImage,
    labels: &[TextLabel],
) -> Result<Option<[f32; 4]>, RenderError> {
    let (key, _) = space_key(request, camera)?;
    if key.is_empty() {
        return Ok(None);
    }
    let words = labels::placed(labels, request, None);
    let boxes: Vec<[f32; 4]> = words.iter().map(PlacedWords::bounds).collect();
    let backdrop = request.backdrop();
    let is_covered = |[x, y]: [u32; 2]| {
        let [r, g, b, alpha] = image.get_pixel(x, y).0;
        let off = [0, 1, 2].map(|k| [r, g, b][k].abs_diff(backdrop[k]));
        let is_seen = alpha > 0 && off.into_iter().any(|off| off > NEAR_BACKDROP);
        let at = [x as f32, y as f32];
        let is_word = |[left, top, right, bottom]: &[f32; 4]| {
            (*left..*right).contains(&at[0]) && (*top..*bottom).contains(&at[1])
        };
        is_seen || boxes.iter().any(is_word)
    };
    Ok(key.place(request.size, legend::unit(request), is_covered))
}

/// Returns the key to a 3D picture, and whether it has entries other than trails.
fn space_key(
    request: &PictureRequest,
    camera: Option<&KeyedCamera<'_>>,
) -> Result<(legend::Legend, bool), RenderError> {
    let mut key = legend::Legend::new(request.theme);
    if request.overlays.legend {
        if let Some(camera) = camera {
            space::key(&mut key, request, camera)?;
        }
        for (name, scale) in keyed_surfaces(request) {
            key.curvature(name, scale);
        }
    }
    let legend = !key.is_empty();
    for trail in request.trails.iter().filter(|it| it.kind.has_key()) {
        if space::is_shown(&request.scene, trail.surface) {
            key.line(
                Inks::of(request.theme).trail(&trail.kind),
                &trail_words(trail),
            );
        }
    }
    Ok((key, legend))
}

/// Returns the names of the surfaces that are drawn in colours of curvature, with their scales.
fn keyed_surfaces(request: &PictureRequest) -> impl Iterator<Item = (&str, CurvatureScale)> {
    let options = request.view.space();
    let objects = request.scene.numbered();
    let drawn = objects.filter(move |(id, object)| {
        object.shape.is_surface() && options.is_none_or(|options| options.shows(*id))
    });
    drawn.filter_map(|(id, object)| {
        let scale = request.own_texture(id)?.curvature_scale()?;
        Some((object.name.as_str(), scale))
    })
}

fn trail_words(trail: &Trail) -> String {
    format!("trail, length {}", legend::fixed_digits(trail.length))
}

fn wave_words(distance: f64) -> String {
    format!("wavefronts, every {}", legend::digits(distance))
}

/// The style of lines over pictures of a size; each has a dark rim, so that it is visible on any background.
#[derive(Clone, Copy, Debug)]
struct StrokeStyle {
    /// Half the width of a line in pixels.
    half: f32,
    /// Half the width of a line's rim in pixels.
    rim: f32,
    decoder: Decoder,
}

/// The colour of a line.
#[derive(Clone, Copy, Debug)]
struct StrokeColour {
    srgb: [u8; 3],
    /// The colour in linear light.
    light: [f32; 3],
    /// The opacity of its dark rim, from 0 to 1.
    rim: f32,
}

impl StrokeColour {
    fn new(srgb: [u8; 3]) -> Self {
        let light = style::linear(srgb);
        Self {
            srgb,
            light,
            rim: 0.55,
        }
    }

    /// Returns it with an opaque rim, for a line that must stand out from the image under it.
    fn outlined(self) -> Self {
        Self { rim: 1.0, ..self }
    }
}

impl StrokeStyle {
    /// Returns the style in a picture of a size, with widths multiplied by `scale`.
    fn for_size(size: [u32; 2], scale: f32) -> Self {
        let unit = style::pixel_unit(size) * scale;
        let half = (1.1 * unit).max(0.7);
        Self {
            half,
            rim: half + 0.8 * unit.max(0.8),
            decoder: Decoder::get(),
        }
    }

    /// Returns the distance in pixels from a line beyond which pixels show nothing of it.
    #[inline(always)]
    fn reach(&self) -> f32 {
        self.rim + 0.5
    }

    /// Draws a line over a pixel's bytes, at this distance in pixels from the line's centre.
    #[inline]
    fn ink(&self, pixel: &mut [u8], ink: &StrokeColour, distance: f32) {
        let dark = ink.rim * (self.rim - distance + 0.5).clamp(0.0, 1.0);
        let line = (self.half - distance + 0.5).clamp(0.0, 1.0);
        if line >= 1.0 {
            pixel[..3].copy_from_slice(&ink.srgb);
        } else if dark > 0.0 {
            blend_by(self.decoder, pixel, [0.0; 3], dark);
            if line > 0.0 {
                blend_by(self.decoder, pixel, ink.light, line);
            }
        }
    }
}

/// Draws lines over a picture: `distance` returns the distance of a pixel (by its index) to the nearest line, in pixels. The
/// widths are multiplied by `scale`. Returns true if any line is visible.
fn stroke(
    image: &mut RgbaImage,
    (colour, scale): ([u8; 3], f32),
    distance: impl Fn(usize) -> Option<f32> + Sync,
) -> bool {
    let pen = StrokeStyle::for_size([image.width(), image.height()], scale);
    let ink = StrokeColour::new(colour);
    let ink_pixel = |(index, pixel): (usize, &mut [u8])| {
        let Some(distance) = distance(index) else {
            return false;
        };
        pen.ink(pixel, &ink, distance);
        distance < pen.half
    };
    let pixels = image.par_chunks_mut(4).enumerate();
    let any = |a: bool, b: bool| a || b;
    pixels.map(ink_pixel).reduce(|| false, any)
}

/// Blends a colour (linear light) over a pixel's bytes.
fn blend(pixel: &mut [u8], colour: [f32; 3], share: f32) {
    blend_by(Decoder::get(), pixel, colour, share);
}

/// As [`blend`], with the table fetched in advance.
#[inline]
fn blend_by(decoder: Decoder, pixel: &mut [u8], colour: [f32; 3], share: f32) {
    for (byte, colour) in pixel.iter_mut().zip(colour) {
        let under = decoder.decode(*byte);
        *byte = style::encode(under + share * (colour - under));
    }
}

/// Blends a colour (linear light) over a pixel that may be transparent, with straight alpha.
fn cover(pixel: &mut [u8; 4], colour: [f32; 3], share: f32) {
    let under = f32::from(pixel[3]) / 255.0;
    let alpha = under + share * (1.0 - under);
    if alpha <= 0.0 {
        return;
    }
    // The visible part of the colour beneath is a fraction of the result.
    blend(&mut pixel[..3], colour, share / alpha);
    pixel[3] = (255.0 * alpha).round() as u8;
}

#[cfg(test)]
mod tests {
    use scene::{ObjectId, ParamValues};

    use super::{KeyedCamera, StrokeColour, StrokeStyle, blend, camera_objects, cover, space_key};
    use crate::bounds::Bounds;
    use crate::camera::Camera;
    use crate::request::part::SpaceOptions;
    use crate::request::{PictureRequest, Spacing};
    use crate::viewpoint::{GeodesicCamera, Viewpoint};

    #[test]
    fn a_key_names_no_lines_where_none_is_drawn() {
        let text = "surface s(u, v) = (u, v, 0), u : [-1, 1], v : [-1, 1];";
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let mut request = PictureRequest::new(scene, params, SpaceOptions::default(), [800, 600]);
        request.overlays.legend = true;
        let camera = GeodesicCamera::new(ObjectId::new(0)).zoomed(1.0);
        let bounds = Bounds::of(&request.scene, &request.params);
        let viewpoint = Viewpoint::new([0.0, 0.0, 5.0], [0.0; 3]);
        let view = Camera::new(&bounds, &viewpoint, request.size).expect("a camera");
        let mut height = |wavefronts, conjugate_points| {
            request.overlays.wavefronts = wavefronts;
            request.overlays.conjugate_points = conjugate_points;
            let objects = camera_objects(&request, &camera, &bounds.placement).expect("objects");
            let keyed = KeyedCamera {
                camera: &camera,
                view: &view,
                objects: &objects,
            };
            let (key, _) = space_key(&request, Some(&keyed)).expect("a key");
            let place = key.place(request.size, super::legend::unit(&request), |_| false);
            let [_, top, _, bottom] = place.expect("room");
            bottom - top
        };
        let without = height(None, false);
        assert_eq!(height(Some(Spacing::Every(100.0)), false), without);
        assert!(height(Some(Spacing::Every(0.5)), false) > without);
        // A plane has none.
        assert_eq!(height(None, true), without);
    }

    #[test]
    fn a_line_is_its_colour_in_its_middle_and_nothing_beyond_its_rim() {
        let pen = StrokeStyle::for_size([800, 600], 1.0);
        for under in 0..=255 {
            for colour in 0..=255 {
                let ink = StrokeColour::new([colour; 3]);
                let mut blended = [under; 3];
                blend(&mut blended, ink.light, 1.0);
                assert_eq!(blended, ink.srgb, "over {under}");
            }
            let mut blended = [under; 3];
            blend(&mut blended, [0.3; 3], 0.0);
            assert_eq!(blended, [under; 3]);
            let ink = StrokeColour::new([77; 3]);
            let inked = |distance: f32| {
                let mut pixel = [under; 4];
                pen.ink(&mut pixel, &ink, distance);
                pixel
            };
            assert_eq!(inked(pen.half - 0.5), [77, 77, 77, under]);
            assert_eq!(inked(pen.reach()), [under; 4]);
            // There is no step between the two.
            let mut before = inked(0.0);
            let mut distance = 0.0;
            while distance < pen.reach() {
                distance += 0.01;
                let next = inked(distance);
                assert!(
                    (0..3).all(|k| before[k].abs_diff(next[k]) <= 12),
                    "{before:?} and {next:?} {distance} from the middle"
                );
                before = next;
            }
        }
    }

    #[test]
    fn covering_a_transparent_pixel_gives_the_colour_with_its_share() {
        let mut clear = [9, 9, 9, 0];
        cover(&mut clear, [1.0; 3], 0.4);
        assert_eq!(clear, [255, 255, 255, 102]);
        let mut opaque = [255, 255, 255, 255];
        cover(&mut opaque, [0.0; 3], 1.0);
        assert_eq!(opaque, [0, 0, 0, 255]);
        cover(&mut opaque, [1.0; 3], 0.0);
        assert_eq!(opaque, [0, 0, 0, 255]);
    }
}
