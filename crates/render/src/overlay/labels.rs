//! Names at objects: words over a picture in space, beside what they name, and not over each other.

use std::sync::Arc;

use glam::DVec3;
use image::RgbaImage;
use scene::Shape;

use super::line_map::LineMap;
use super::text::{self, Ink};
use crate::bounds::ObjectCloud;
use crate::camera::Camera;
use crate::point::{DrawingPoint, PixelPoint, WorldPoint};
use crate::request::PictureRequest;
use crate::sample::{PositionSample, Samples};
use crate::style;

/// The height of numbers and names of axes in pixel units.
const AXIS_HEIGHT: f32 = 15.0;
/// The height of the words beside a place: they stand on images with letters and lines of their own.
const HEIGHT: f32 = 20.0;
/// The least height of words in pixels, in a picture that is not magnified.
const LEAST_HEIGHT: f32 = 10.0;
/// The distance of words from what they name, in their heights.
const GAP: f32 = 0.45;
/// The gap beside numbers and names of axes, on either side, in their heights.
const AXIS_GAP: f32 = 0.3;
/// The direction in the picture of the place at which a surface has its name: to the right and up.
const SURFACE_SIDE: [f64; 2] = [0.5, 0.87];

/// The number of places along a curve at which it may have its name.
const CURVE_PLACES: usize = 24;
/// The share of its ink that the name of something hidden has.
const HIDDEN: f32 = 0.45;

/// The words at the place of a geodesic camera.
pub(crate) const HERE: &str = "You are here";

/// Words at a place of the picture.
#[derive(Clone, Debug)]
pub(crate) struct TextLabel {
    at: PixelPoint,
    /// Further places at which they may be, where something else is at that one.
    others: Vec<PixelPoint>,
    words: String,
    /// True if their middle is the place; otherwise they are beside it.
    is_centred: bool,
    /// True if something lies before what they name: then they are dim.
    is_hidden: bool,
    /// The lines of the picture, over which they are placed only where there is no room beside them.
    lines: Option<Arc<LineMap>>,
}

impl TextLabel {
    /// Words about a place.
    pub(super) fn centred(at: PixelPoint, words: String) -> Self {
        Self {
            at,
            others: Vec::new(),
            words,
            is_centred: true,
            is_hidden: false,
            lines: None,
        }
    }

    /// Words beside a place.
    pub(crate) fn beside(at: PixelPoint, words: impl Into<String>) -> Self {
        Self {
            at,
            others: Vec::new(),
            words: words.into(),
            is_centred: false,
            is_hidden: false,
            lines: None,
        }
    }

    /// Returns them with further places.
    #[must_use]
    pub(super) fn or_at(self, others: Vec<PixelPoint>) -> Self {
        Self { others, ..self }
    }

    /// Returns them dim, if what they name is hidden.
    #[must_use]
    pub(crate) fn hidden(self, is_hidden: bool) -> Self {
        Self { is_hidden, ..self }
    }

    /// Returns them with the lines of the picture, beside which they are placed.
    #[must_use]
    pub(crate) fn clear_of(self, lines: &Arc<LineMap>) -> Self {
        Self {
            lines: Some(Arc::clone(lines)),
            ..self
        }
    }
}

/// Returns the places in drawing units at which an object may have its name, the best one first: of a curve those that
/// are nearest to its middle, of a vector its tip, of a surface or a solid the place that is seen farthest to the upper right.
/// If any of it lies in the picture, they do. Geodesics have samples in place of a cloud.
pub(crate) fn anchors(
    camera: &Camera,
    shape: &Shape,
    cloud: &ObjectCloud,
    samples: Option<&Samples>,
) -> Vec<DrawingPoint> {
    let local = |place: &[f64; 3]| camera.placement.local(WorldPoint(*place));
    if let Some(Samples::Curves { count, samples }) = samples {
        let own = samples.get(..*count as usize).unwrap_or_default();
        let place = |sample: &PositionSample| {
            let place = DrawingPoint(sample.position.map(f64::from));
            (sample.defined != 0.0).then_some(place)
        };
        let seen = |sample: &&PositionSample| place(sample).is_some_and(|it| camera.sees(it));
        let places = if own.iter().any(|sample| seen(&sample)) {
            own.iter().filter(seen).collect()
        } else {
            own.iter().collect::<Vec<_>>()
        };
        let places = from_the_middle(&places);
        return places.filter_map(|sample| place(sample)).collect();
    }
    let is_seen = |place: &&[f64; 3]| camera.sees(local(place));
    let is_middle_seen = cloud.middle.iter().any(|place| is_seen(&place));
    let mut points: Vec<&[f64; 3]> = cloud.points.iter().filter(is_seen).collect();
    let any_seen = is_middle_seen || !points.is_empty();
    if points.is_empty() {
        points.extend(&cloud.points);
    }
    if !shape.is_surface() && shape.solid().is_none() {
        let middle = cloud.middle.iter();
        let middle = middle.filter(|_| is_middle_seen || !any_seen);
        let others = from_the_middle(&points).copied();
        let others = others.filter(|_| shape.domain().len() == 1 || !is_middle_seen);
        return middle.chain(others).map(local).collect();
    }
    let [right, up, _] = camera.axes;
    let side = right * SURFACE_SIDE[0] + up * SURFACE_SIDE[1];
    let farthest = |a: &&[f64; 3], b: &&[f64; 3]| {
        let [a, b] = [*a, *b].map(|place| DVec3::from(*place).dot(side));
        a.total_cmp(&b)
    };
    points
        .into_iter()
        .max_by(farthest)
        .map(local)
        .into_iter()
        .collect()
}

/// Returns a few of the samples of a curve, those nearest to its middle first.
fn from_the_middle<T>(samples: &[T]) -> impl Iterator<Item = &T> {
    let middle = samples.len() / 2;
    let step = (samples.len() / CURVE_PLACES).max(1);
    let before = (0..=middle).rev().step_by(step);
    let after = (middle..samples.len()).step_by(step);
    let mut places: Vec<usize> = before.chain(after).collect();
    places.sort_by_key(|place| place.abs_diff(middle));
    places.into_iter().filter_map(|place| samples.get(place))
}

/// Returns the height of numbers and names of axes in a picture, in pixels.
pub(crate) fn axis_height(request: &PictureRequest) -> f32 {
    let unit = style::pixel_unit(request.size) * request.scale;
    (AXIS_HEIGHT * unit).max(LEAST_HEIGHT / request.magnification)
}

/// Words that have their place in a picture, in pixels from its upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedWords {
    /// The words.
    pub words: String,
    /// The left end of the line on which they stand.
    pub baseline: [f32; 2],
    /// Their width.
    pub width: f32,
    /// The size of their font: of its em square.
    pub size: f32,
    /// The colour of the words, sRGB.
    pub colour: [u8; 3],
    /// The colour of the rim around the words, sRGB.
    pub rim: [u8; 3],
    /// The width of the rim.
    pub rim_width: f32,
    /// The opacity of the words and of their rim, from 0 to 1: the words of what is hidden are translucent.
    pub opacity: f32,
    /// The upper left corner.
    pub(super) corner: [f32; 2],
    /// The height of a line.
    pub(super) height: f32,
}

impl PlacedWords {
    /// The part of the picture that they take: left, top, right and bottom.
    pub(super) fn bounds(&self) -> [f32; 4] {
        let [left, top] = self.corner;
        [left, top, left + self.width, top + self.height]
    }
}

/// Writes labels over a picture, where possible not under its key, whose place is `key`.
pub(crate) fn write(
    image: &mut RgbaImage,
    labels: &[TextLabel],
    request: &PictureRequest,
    key: Option<[f32; 4]>,
) {
    let ink = Ink::over(request.backdrop());
    for placed in placed(labels, request, key) {
        let ink = ink.thinned(placed.opacity);
        text::write_outlined(image, &placed.words, placed.corner, placed.height, ink);
    }
}

/// Returns the place of each label, near what it names: where one would lie over another, over the key of the picture, which
/// is at `key`, or over a line, on another side.
pub(crate) fn placed(
    labels: &[TextLabel],
    request: &PictureRequest,
    key: Option<[f32; 4]>,
) -> Vec<PlacedWords> {
    let size = request.size;
    let axis_height = axis_height(request);
    let ink = Ink::over(request.backdrop());
    let mut taken: Vec<[f32; 4]> = key.into_iter().collect();
    let mut all = Vec::new();
    for label in labels {
        let height = match label.is_centred {
            true => axis_height,
            false => HEIGHT / AXIS_HEIGHT * axis_height,
        };
        let width = text::width(&label.words, height);
        let places = std::iter::once(&label.at).chain(&label.others);
        let gap = GAP * height;
        let corners: &[[f32; 2]] = if label.is_centred {
            &[[-0.5 * width, -0.5 * height]]
        } else {
            &[
                [gap, -height - 0.5 * gap],
                [gap, 0.5 * gap],
                [-gap - width, -height - 0.5 * gap],
                [-gap - width, 0.5 * gap],
                [-0.5 * width, -2.2 * height],
                [-0.5 * width, 1.2 * height],
            ]
        };
        let boxes = places.flat_map(|place| {
            let [x, y] = place.0.map(|x| x as f32);
            corners.iter().map(move |[dx, dy]| {
                let corner = [x + dx, y + dy];
                [corner[0], corner[1], corner[0] + width, corner[1] + height]
            })
        });
        let is_inside = |b: &[f32; 4]| {
            b[0] >= 0.0 && b[1] >= 0.0 && b[2] <= size[0] as f32 && b[3] <= size[1] as f32
        };
        let is_free = |b: &[f32; 4]| {
            let room = match label.is_centred {
                true => with_gap(*b, height),
                false => *b,
            };
            !taken.iter().any(|other| overlap(&room, other))
        };
        let mut boxes = boxes.filter(is_inside);
        let lines = label.lines.as_ref();
        let is_clear = |b: &[f32; 4]| lines.is_none_or(|lines| !lines.crosses(*b));
        let mut free = boxes.clone().filter(is_free);
        // Where lines are everywhere, a place that does not change from frame to frame.
        let place = free.clone().find(is_clear).or_else(|| free.next());
        let Some(place) = place.or_else(|| boxes.next()) else {
            continue;
        };
        // A number that would lie over another is left out: its neighbours say what it is.
        if label.is_centred && !is_free(&place) {
            continue;
        }
        taken.push(match label.is_centred {
            true => with_gap(place, height),
            false => place,
        });
        let corner = [place[0], place[1]];
        all.push(PlacedWords {
            words: label.words.clone(),
            baseline: text::baseline(&label.words, corner, height),
            width,
            size: text::em(height),
            colour: ink.words_colour(),
            rim: ink.rim_colour(),
            rim_width: text::rim(height),
            opacity: if label.is_hidden { HIDDEN } else { 1.0 },
            corner,
            height,
        });
    }
    all
}

/// Returns the part of the picture that the words of an axis take, with the gap beside them; `height` is theirs.
pub(super) fn with_gap([left, top, right, bottom]: [f32; 4], height: f32) -> [f32; 4] {
    let gap = AXIS_GAP * height;
    [left - gap, top, right + gap, bottom]
}

/// Returns whether two parts of the picture have a pixel in common.
pub(super) fn overlap(a: &[f32; 4], b: &[f32; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use scene::ParamValues;

    use super::{LineMap, PixelPoint, TextLabel, axis_height, placed};
    use crate::PictureRequest;
    use crate::request::part::SpaceOptions;

    #[test]
    fn words_keep_their_size_on_the_screen_in_a_coarse_picture() {
        let scene = scene::geotrace::compile("point p = (0, 0, 0);").scene;
        let scene = scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        for [size, height] in [[1024, 30], [256, 10]] {
            let mut request = PictureRequest::new(
                scene.clone(),
                params.clone(),
                SpaceOptions::default(),
                [size; 2],
            );
            assert_eq!(axis_height(&request), height as f32);
            let width = |request: &PictureRequest| {
                let label = TextLabel::beside(PixelPoint([5.0, 8.0]), "You are here");
                placed(&[label], request, None)[0].width * request.magnification
            };
            let at_rest = width(&request);
            (request.size, request.magnification) = ([size / 16; 2], 16.0);
            let coarse = width(&request);
            assert!(
                (coarse / at_rest - 1.0).abs() < 0.01,
                "{at_rest} at rest, {coarse}"
            );
        }
    }

    #[test]
    fn words_stand_beside_lines_where_there_is_room() {
        let scene = scene::geotrace::compile("point p = (0, 0, 0);").scene;
        let scene = scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let request = PictureRequest::new(scene, params, SpaceOptions::default(), [400; 2]);
        let corner = |segments: &[[[f64; 2]; 2]]| {
            let mut lines = LineMap::new([400; 2]);
            for ends in segments {
                let [a, b] = ends.map(PixelPoint);
                lines.add(a, b);
            }
            let label = TextLabel::beside(PixelPoint([200.0, 200.0]), "p");
            placed(&[label.clear_of(&Arc::new(lines))], &request, None)[0].corner
        };
        let usual = corner(&[]);
        assert!(usual[0] > 200.0 && usual[1] < 200.0, "{usual:?}");
        // A line to the upper right.
        let below = corner(&[[[200.0, 200.0], [300.0, 150.0]]]);
        assert!(below[0] > 200.0 && below[1] > 200.0, "{below:?}");
        let left = corner(&[
            [[200.0, 200.0], [300.0, 150.0]],
            [[200.0, 200.0], [300.0, 250.0]],
        ]);
        assert!(left[0] < 200.0, "{left:?}");
        let rows = (0..100).map(|k| [[0.0, 4.0 * f64::from(k)], [400.0, 4.0 * f64::from(k)]]);
        let rows: Vec<[[f64; 2]; 2]> = rows.collect();
        assert_eq!(corner(&rows), usual);
    }
}
