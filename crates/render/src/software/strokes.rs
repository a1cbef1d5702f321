//! Curves as vectors: their polylines in the picture, without the hidden parts.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::curves;
use super::mesh::Eye;
use super::space::{DepthMap, Drawable};
use crate::camera::Camera;
use crate::layers::Stroke;
use crate::sample::Samples;
use crate::style;

/// The distance in pixels between the points at which a line is tested.
const STEP: f32 = 0.5;
/// The maximum number of points of a piece.
const MOST_STEPS: f32 = 16_384.0;
/// Gaps up to this length, in widths of the line, are closed: the line is on the surface that seems to hide it.
const LEAST_GAP: f32 = 1.0;
/// Parts of a line up to this length, in pixels, are left out.
const LEAST_PART: f32 = 0.75;
/// The maximum relative difference of widths along a stroke.
const SAME_WIDTH: f32 = 0.12;
/// The maximum difference of depths along a stroke, as a fraction of the range of all lines: strokes are ordered by depth.
const SAME_DEPTH: f32 = 0.04;
/// Smaller differences of depth are rounding errors.
const LEAST_DEPTH: f32 = 1e-6;
/// Pieces are clipped at this many half pictures from the centre.
const GUARD: f32 = 1.1;

/// Objects that may hide lines.
#[derive(Clone, Copy)]
pub(crate) struct LineCover<'a> {
    depths: &'a DepthMap,
    key: Option<[f32; 4]>,
}

/// The visibility of a point of a line.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Sight {
    Seen,
    /// Something is in front of it.
    Hidden,
    /// It is not drawn.
    Absent,
}

impl<'a> LineCover<'a> {
    /// Creates a cover from the depths of everything that may hide a line, and the rectangle of the picture's key, in which
    /// no line is drawn: left, top, right and bottom in pixels.
    pub(crate) fn new(depths: &'a DepthMap, key: Option<[f32; 4]>) -> Self {
        Self { depths, key }
    }

    /// Returns the visibility of a position in the picture at a depth.
    fn sight(&self, at: Vec2, depth: f32) -> Sight {
        let is_under_key = self.key.is_some_and(|[left, top, right, bottom]| {
            (left..right).contains(&at.x) && (top..bottom).contains(&at.y)
        });
        match self.depths.at(at.to_array()) {
            Some(farthest) if !is_under_key && depth > farthest => Sight::Seen,
            Some(_) if !is_under_key => Sight::Hidden,
            _ => Sight::Absent,
        }
    }
}

/// Returns the visible parts of the curves among some objects, in drawing order, and below them the hidden parts of marked
/// curves.
pub(crate) fn strokes(
    camera: &Camera,
    objects: &[(&Drawable, bool)],
    cover: &LineCover<'_>,
) -> Vec<Stroke> {
    let eye = Eye::new(camera);
    let lines = objects.par_iter().map(|(object, _)| depths(&eye, object));
    let none = [f32::INFINITY, f32::NEG_INFINITY];
    let [least, greatest] = lines.reduce(|| none, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let depth_step = (SAME_DEPTH * (greatest - least)).max(LEAST_DEPTH);
    let mut strokes: Vec<Stroke> = objects
        .par_iter()
        .flat_map_iter(|(object, hidden)| of_object(&eye, object, cover, depth_step, *hidden))
        .collect();
    strokes.sort_by(|a, b| {
        let order = b.is_hidden.cmp(&a.is_hidden);
        order.then(a.nearness.total_cmp(&b.nearness))
    });
    strokes
}

/// Returns the smallest and the largest depth of an object's lines in the picture.
fn depths(eye: &Eye, object: &Drawable) -> [f32; 2] {
    let mut range = [f32::INFINITY, f32::NEG_INFINITY];
    let Samples::Curves { count, samples } = &*object.samples else {
        return range;
    };
    for instance in samples.chunks(*count as usize) {
        for run in curves::runs(eye, instance) {
            let run = curves::distinct(eye, &run);
            let pieces = run.windows(2);
            let ends = pieces.filter_map(|piece| cut(eye, [piece[0], piece[1]]));
            for at in ends.flatten() {
                let clip = eye.clip(at, 0.0);
                let depth = clip.z / clip.w;
                range = [range[0].min(depth), range[1].max(depth)];
            }
        }
    }
    range
}

/// Returns the strokes of an object's lines; depths along a visible stroke differ by at most `depth_step`.
fn of_object(
    eye: &Eye,
    object: &Drawable,
    cover: &LineCover<'_>,
    depth_step: f32,
    with_hidden: bool,
) -> Vec<Stroke> {
    let Samples::Curves { count, samples } = &*object.samples else {
        return Vec::new();
    };
    let eye = eye.with_lines(object.line);
    let colour = |colour: &[f32; 3]| style::emphasised(*colour, object.emphasis).map(style::encode);
    let own: Vec<[u8; 3]> = object.colours.iter().map(colour).collect();
    let further = own.last().into_iter().cycle();
    let mut strokes = Vec::new();
    let instances = samples.chunks(*count as usize);
    for (instance, &colour) in instances.zip(own.iter().chain(further)) {
        for run in curves::runs(&eye, instance) {
            let run = curves::distinct(&eye, &run);
            let parts = parts(&eye, &run, cover, depth_step, with_hidden);
            strokes.extend(parts.iter().map(|part| Stroke {
                points: part.iter().map(|it| it.at.to_array()).collect(),
                width: part.iter().map(|it| it.width).sum::<f32>() / part.len() as f32,
                colour,
                is_hidden: part.iter().any(|it| it.sight == Sight::Hidden),
                nearness: part.iter().map(|it| it.depth).sum::<f32>() / part.len() as f32,
            }));
        }
    }
    strokes
}

/// A point of a line in the picture.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Vec2,
    width: f32,
    depth: f32,
    /// True if the line has a corner or an end here.
    is_kept: bool,
    sight: Sight,
}

/// Returns the parts of a line through points in view space that are drawn: the visible ones, and if requested the hidden
/// ones.
fn parts(
    eye: &Eye,
    run: &[Vec3],
    cover: &LineCover<'_>,
    depth_step: f32,
    with_hidden: bool,
) -> Vec<Vec<Place>> {
    let mut places: Vec<Place> = Vec::new();
    let pieces = run.windows(2).map(|piece| [piece[0], piece[1]]);
    // A line that is a single point is a dot.
    let dot = match *run {
        [at] => Some([at, at]),
        _ => None,
    };
    for piece in pieces.chain(dot) {
        let Some([from, to]) = cut(eye, piece) else {
            continue;
        };
        let length = (pixel(eye, to) - pixel(eye, from)).length();
        let steps = (length / STEP).ceil().clamp(1.0, MOST_STEPS) as u32;
        places.extend((0..=steps).map(|k| {
            let at = from.lerp(to, k as f32 / steps as f32);
            place(eye, at, k == 0 || k == steps, cover)
        }));
    }
    close_gaps(&mut places);
    let mut parts: Vec<Vec<Place>> = vec![Vec::new()];
    for (k, place) in places.iter().enumerate() {
        let last = parts.len() - 1;
        let part = &mut parts[last];
        // Clipped pieces do not join.
        let joins = part
            .last()
            .is_none_or(|it| (it.at - place.at).length() < 4.0 * STEP && it.sight == place.sight);
        let is_drawn = match place.sight {
            Sight::Seen => true,
            Sight::Hidden => with_hidden,
            Sight::Absent => false,
        };
        if !is_drawn || !joins {
            parts.push(Vec::new());
            if is_drawn {
                parts.extend([vec![*place]]);
            }
            continue;
        }
        let same = part.first().is_none_or(|first| {
            let is_as_deep = (place.depth - first.depth).abs() <= depth_step;
            (is_as_deep || place.sight == Sight::Hidden)
                && (place.width - first.width).abs() <= SAME_WIDTH * first.width.max(place.width)
        });
        part.push(*place);
        if !same && k + 1 < places.len() {
            // The next part begins at the end of this one.
            parts.push(vec![*place]);
        }
    }
    let is_whole = |part: &[Place]| !part.is_empty() && part.len() == places.len();
    parts.retain(|part| length(part) > LEAST_PART || is_whole(part));
    parts.iter().map(|part| corners(part)).collect()
}

fn place(eye: &Eye, at: Vec3, is_kept: bool, cover: &LineCover<'_>) -> Place {
    let half = eye.half_width(at);
    let clip = eye.clip(at, eye.lift * half);
    let depth = clip.z / clip.w;
    let on_picture = pixel(eye, at);
    Place {
        at: on_picture,
        width: 2.0 * half / eye.pixel(at),
        depth,
        is_kept,
        sight: cover.sight(on_picture, depth),
    }
}

/// Returns the position in the picture of a point in view space.
fn pixel(eye: &Eye, at: Vec3) -> Vec2 {
    let offset = at.truncate() / eye.distance(at).max(eye.near) * eye.zoom;
    Vec2::new(1.0 + offset.x, 1.0 - offset.y) * 0.5 * eye.size
}

/// Returns the part of a piece inside the picture or close to it.
fn cut(eye: &Eye, [from, to]: [Vec3; 2]) -> Option<[Vec3; 2]> {
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for axis in 0..2 {
        for side in [-1.0, 1.0] {
            let inside = |at: Vec3| GUARD * eye.distance(at) - side * eye.zoom[axis] * at[axis];
            let [a, b] = [inside(from), inside(to)];
            if a < 0.0 && b < 0.0 {
                return None;
            }
            if a < 0.0 {
                first = first.max(a / (a - b));
            } else if b < 0.0 {
                last = last.min(a / (a - b));
            }
        }
    }
    (first < last).then(|| [from.lerp(to, first), from.lerp(to, last)])
}

/// Makes the line visible where it is hidden for less than its width.
fn close_gaps(places: &mut [Place]) {
    let mut seen_last: Option<usize> = None;
    for k in 0..places.len() {
        if places[k].sight != Sight::Seen {
            continue;
        }
        if let Some(last) = seen_last
            && k > last + 1
            && (places[k].at - places[last].at).length() <= LEAST_GAP * places[k].width
        {
            for gap in &mut places[last + 1..k] {
                gap.sight = Sight::Seen;
            }
        }
        seen_last = Some(k);
    }
}

fn length(part: &[Place]) -> f32 {
    let pieces = part.windows(2);
    pieces.map(|pair| (pair[1].at - pair[0].at).length()).sum()
}

/// Returns the points of a part that are corners or ends, each once.
fn corners(part: &[Place]) -> Vec<Place> {
    let last = part.len() - 1;
    let numbered = part.iter().enumerate();
    let kept = numbered.filter(|(k, place)| place.is_kept || *k == 0 || *k == last);
    let mut kept: Vec<Place> = kept.map(|(_, place)| *place).collect();
    let end = kept.last().copied();
    kept.dedup_by(|b, a| (a.at - b.at).length() < 0.2);
    if let Some(end) = end
        && kept.len() < 2
    {
        kept.push(end);
    }
    kept
}
