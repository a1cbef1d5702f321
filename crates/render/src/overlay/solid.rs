//! The overlays of the geodesic picture of a solid: declared geodesics as lines over the picture, and the annotations that
//! pictures of surfaces have.
//!
//! Knots in space and the pixels' ends flow in, a picture with lines and a key flows out. A pixel's distance to a line is
//! measured in the tangent plane and turned into pixels by the derivatives of its end, so that lines are as wide as others
//! wherever they are seen. Pieces of lines are looked up for a block of pixels at once.

use std::collections::HashMap;
use std::sync::Arc;

use geodesic::piecewise::BLOCK;
use geodesic::pixels::Map;
use geodesic::trace::Status;
use geometry::{FollowedGeodesic, cut_note};
use glam::DVec3;
use image::RgbaImage;
use rayon::prelude::*;
use scene::{ObjectId, Range, Sampling};

use super::curves::{LineColours, NamePlace, NamePlaces, drawn_range, piece_count, straight};
use super::geodesic::Annotations;
use super::measured::{MeasuredEnds, duals, steps};
use super::{StrokeColour, StrokeStyle};
use crate::geodesic_view::PlacedSolidCamera;
use crate::request::PictureRequest;

/// The side of a cell of the table of pieces, in pieces: most pieces lie in one or two cells.
const CELL: f64 = 1.5;
/// The most cells that the neighbourhood of a pixel may cover: beyond it, lines are thinner than can be seen.
const MOST_CELLS: f64 = 1024.0;
/// The farthest that a line may be beside the tangent plane of a pixel's end, in pixels: what is farther lies on another sheet.
const BESIDE: f64 = 1.0;

/// The lines of one colour of a declared geodesic.
struct SolidCurve {
    /// Empty but for the first colour.
    name: String,
    /// sRGB.
    colour: [u8; 3],
    followed: Arc<FollowedGeodesic>,
    /// The numbers of the lines that have the colour.
    lines: Vec<usize>,
    /// It is longer than what is drawn.
    is_cut: bool,
}

impl SolidCurve {
    /// Sentences for the user about what is left out.
    fn notes(&self) -> Vec<String> {
        if self.name.is_empty() {
            return Vec::new();
        }
        let mut notes = self.followed.notes.clone();
        let cut = self.is_cut.then(|| cut_note(&self.name));
        notes.extend(cut.filter(|note| !self.followed.notes.contains(note)));
        notes
    }
}

/// Draws what lies over the picture of a solid: declared geodesics, and what the request selects. `follow` follows a declared
/// geodesic to the given values of its parameter. Returns notes for a reader, and the names of what was drawn.
pub(crate) fn over_solid(
    image: &mut RgbaImage,
    request: &PictureRequest,
    camera: &PlacedSolidCamera,
    map: &Map<3>,
    follow: &mut dyn FnMut(ObjectId, &Sampling) -> Arc<FollowedGeodesic>,
) -> (Vec<String>, Vec<&'static str>) {
    let curves = curves(request, camera, follow);
    let overlays = &request.overlays;
    if curves.is_empty() && !overlays.any() {
        return (Vec::new(), Vec::new());
    }
    let places = overlays
        .labels
        .then(|| NamePlaces::new(map.size, curves.len()));
    draw_lines(image, request.scale, camera, map, &curves, places.as_ref());
    let measured = overlays
        .any()
        .then(|| MeasuredEnds::in_space(overlays, camera, map));
    let places = places.map_or(Vec::new(), |places| places.pixels());
    let notes = curves.iter().flat_map(SolidCurve::notes);
    let annotations = Annotations {
        request,
        notes: notes.collect(),
        geodesics: curves
            .into_iter()
            .map(|curve| (curve.colour, curve.name))
            .collect(),
        trails: Vec::new(),
    };
    annotations.draw(image, measured.as_ref(), &places)
}

/// All geodesics declared on the solid, in pieces that are straight in the picture.
fn curves(
    request: &PictureRequest,
    camera: &PlacedSolidCamera,
    follow: &mut dyn FnMut(ObjectId, &Sampling) -> Arc<FollowedGeodesic>,
) -> Vec<SolidCurve> {
    let straight = straight(camera.size(), camera.frame.zoom());
    let colours = request.instance_colours();
    let mut curves = Vec::new();
    for (id, object) in request.scene.geodesics_on(camera.object) {
        let Some((_, domain)) = object.shape.space_geodesic() else {
            continue;
        };
        let whole = [domain.range.min, domain.range.max];
        let drawn = drawn_range(whole, straight);
        let [min, max] = drawn;
        let sampling = Sampling {
            range: Range { min, max },
            count: 1 + piece_count(max - min, domain.count, straight),
        };
        let followed = follow(id, &sampling);
        let colours = LineColours::new(&colours[id.index()]);
        for (number, colour) in colours.colours.iter().enumerate() {
            let lines = (0..followed.lines.len()).filter(|line| colours.number(*line) == number);
            curves.push(SolidCurve {
                name: match number {
                    0 => object.name.clone(),
                    _ => String::new(),
                },
                colour: *colour,
                lines: lines.collect(),
                followed: followed.clone(),
                is_cut: drawn != whole,
            });
        }
    }
    curves
}

/// A piece of a line, as an offset from the camera.
#[derive(Clone, Copy)]
struct Piece {
    curve: u32,
    from: DVec3,
    step: DVec3,
    middle: DVec3,
    /// Half its length.
    half: f64,
}

impl Piece {
    fn new(curve: u32, from: DVec3, to: DVec3) -> Self {
        Self {
            curve,
            from,
            step: to - from,
            middle: 0.5 * (from + to),
            half: 0.5 * from.distance(to),
        }
    }

    /// The corners of the box that holds it.
    fn bounds(&self) -> [DVec3; 2] {
        let to = self.from + self.step;
        [self.from.min(to), self.from.max(to)]
    }
}

/// Pieces of lines by the cells of space that they go through.
struct PieceTable {
    pieces: Vec<Piece>,
    side: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl PieceTable {
    fn new(curves: &[SolidCurve], origin: DVec3, side: f64) -> Self {
        let mut table = Self {
            pieces: Vec::new(),
            side,
            cells: HashMap::new(),
        };
        for (number, curve) in (0..).zip(curves) {
            for line in curve.lines.iter().map(|line| &curve.followed.lines[*line]) {
                let places = line
                    .iter()
                    .map(|knot| Some(DVec3::from(knot.as_ref()?.position?)));
                let places: Vec<Option<DVec3>> = places.collect();
                for ends in places.windows(2) {
                    if let [Some(from), Some(to)] = *ends {
                        table.enter(Piece::new(number, from - origin, to - origin));
                    }
                }
            }
        }
        table
    }

    fn enter(&mut self, piece: Piece) {
        let number = self.pieces.len() as u32;
        let [low, high] = piece.bounds().map(|corner| self.cell(corner));
        for cell in cells(low, high) {
            self.cells.entry(cell).or_default().push(number);
        }
        self.pieces.push(piece);
    }

    fn cell(&self, at: DVec3) -> [i64; 3] {
        (at / self.side).to_array().map(|x| x.floor() as i64)
    }

    /// Finds the pieces that may go through a box, each once and in order; returns false if it has too many cells.
    fn find(&self, low: DVec3, high: DVec3, found: &mut Vec<u32>) -> bool {
        found.clear();
        let count = (high - low) / self.side + 1.0;
        if count.element_product() > MOST_CELLS {
            return false;
        }
        for cell in cells(self.cell(low), self.cell(high)) {
            let here = self.cells.get(&cell).into_iter().flatten();
            found.extend(here.filter(|piece| {
                let [from, to] = self.pieces[**piece as usize].bounds();
                from.cmple(high).all() && to.cmpge(low).all()
            }));
        }
        found.sort_unstable();
        found.dedup();
        true
    }
}

/// All cells from one corner of a box to the other.
fn cells(low: [i64; 3], high: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    let plane = move |x: i64| {
        let row = move |y: i64| (low[2]..=high[2]).map(move |z| [x, y, z]);
        (low[1]..=high[1]).flat_map(row)
    };
    (low[0]..=high[0]).flat_map(plane)
}

/// A pixel's end, and how a step from it becomes one in pixels.
struct PixelPlane {
    at: DVec3,
    /// The steps of one pixel to the right and down.
    spans: [DVec3; 2],
    /// See [`duals`].
    duals: [DVec3; 2],
    /// The longer of both steps.
    pixel: f64,
    /// The extent along each axis of the places where a line is seen, and the radius of a ball that holds them.
    about: DVec3,
    near: f64,
}

impl PixelPlane {
    /// `reach` is half the width of a line in pixels.
    fn new(map: &Map<3>, index: usize, reach: f64) -> Option<Self> {
        if map.status[index] != Status::Complete {
            return None;
        }
        let spans = steps(*map.by_pixel.get(index)?);
        let pixel = spans[0].length().max(spans[1].length());
        let [right, down] = spans;
        // Of an ellipse in space, and what lies beside it.
        let about = DVec3::from([0, 1, 2].map(|k| reach * right[k].hypot(down[k])));
        Some(Self {
            at: DVec3::from(map.offset[index].map(f64::from)),
            spans,
            duals: duals(spans),
            pixel,
            about: about + BESIDE * pixel,
            near: reach * right.length().hypot(down.length()) + BESIDE * pixel,
        })
    }

    /// The box within which a line is seen.
    fn bounds(&self) -> [DVec3; 2] {
        [self.at - self.about, self.at + self.about]
    }

    /// The square of the distance to a piece in pixels; NaN where pixels have no place, infinite for a piece that is too far away
    /// or on another sheet.
    fn distance_squared(&self, piece: &Piece) -> f64 {
        let near = self.near + piece.half;
        if self.at.distance_squared(piece.middle) > near * near {
            return f64::INFINITY;
        }
        let flat = |step: DVec3| self.duals.map(|dual| dual.dot(step));
        let from = piece.from - self.at;
        let ([px, py], [qx, qy]) = (flat(from), flat(piece.step));
        let square = qx * qx + qy * qy;
        let t = (-(px * qx + py * qy) / square.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        let [x, y] = [px + t * qx, py + t * qy];
        let beside = from + t * piece.step - x * self.spans[0] - y * self.spans[1];
        match beside.length() <= BESIDE * self.pixel {
            true => x * x + y * y,
            false => f64::INFINITY,
        }
    }
}

/// Draws the lines, the first one undermost, and notes the places where their names may be.
fn draw_lines(
    image: &mut RgbaImage,
    scale: f32,
    camera: &PlacedSolidCamera,
    map: &Map<3>,
    curves: &[SolidCurve],
    places: Option<&NamePlaces>,
) {
    let size = map.size;
    let side = CELL * straight(size, camera.frame.zoom());
    let table = PieceTable::new(curves, DVec3::from(map.origin), side);
    let width = size[0] as usize;
    if table.pieces.is_empty() || width == 0 {
        return;
    }
    let pen = StrokeStyle::for_size(size, scale);
    let inks: Vec<StrokeColour> = curves
        .iter()
        .map(|curve| StrokeColour::new(curve.colour))
        .collect();
    let (block, reach) = (BLOCK as usize, f64::from(pen.reach()));
    // Nearer to a line than this a pixel has its colour.
    let inked = f64::from(pen.half - 0.5).powi(2);
    let bands = image.par_chunks_mut(4 * block * width).enumerate();
    bands.for_each(|(band, pixels)| {
        let mut named = vec![NamePlace::NONE; curves.len()];
        let mut squares = vec![f64::INFINITY; curves.len()];
        let (mut found, mut near) = (Vec::new(), Vec::new());
        let first = band * block * width;
        let rows = pixels.len() / (4 * width);
        for left in (0..width).step_by(block) {
            let right = (left + block).min(width);
            let planes: Vec<(usize, PixelPlane)> = (0..rows)
                .flat_map(|row| (left..right).map(move |column| row * width + column))
                .filter_map(|index| Some((index, PixelPlane::new(map, first + index, reach)?)))
                .collect();
            let bounds = planes.iter().map(|(_, plane)| plane.bounds());
            let Some([low, high]) = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) else {
                continue;
            };
            let is_whole = table.find(low, high, &mut found);
            if is_whole && found.is_empty() {
                continue;
            }
            for (index, plane) in &planes {
                let pieces = if is_whole {
                    &found
                } else {
                    let [low, high] = plane.bounds();
                    if !table.find(low, high, &mut near) {
                        continue;
                    }
                    &near
                };
                for &piece in pieces {
                    let piece = &table.pieces[piece as usize];
                    let square = &mut squares[piece.curve as usize];
                    if *square > inked {
                        // (A NaN is no smaller.)
                        *square = square.min(plane.distance_squared(piece));
                    }
                }
                for ((square, ink), named) in squares.iter_mut().zip(&inks).zip(&mut named) {
                    let distance = square.sqrt() as f32;
                    *square = f64::INFINITY;
                    if distance >= pen.reach() {
                        continue;
                    }
                    if let Some(places) = places
                        && distance < pen.half
                    {
                        named.note(places.place(first + index));
                    }
                    pen.ink(&mut pixels[4 * index..4 * index + 4], ink, distance);
                }
            }
        }
        if let Some(places) = places {
            places.note(&named);
        }
    });
}
