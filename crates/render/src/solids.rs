//! Solids in the 3D view: a ray through each pixel finds the visible face, its light and its depth.
//!
//! ```text
//! camera + world + look + tints ──SolidPainter──▶ tiles of pixels: linear light and clip depth
//!                                               └▶ the crossing at a pixel, for picking
//! ```
//!
//! Both backends draw the same tiles: the software path begins with them, the GPU composes them by their depth. At rest,
//! pixels at edges have a ray for each of their four samples. Other pixels have one depth, that of the sample in which the
//! face is farthest, so that a surface that lies in a solid's face is seen and not the face: [`SolidPainter::depth_behind`].

mod images;
mod store;
mod tables;

pub(crate) use tables::{AttributeList, SceneTables, TableField, TableLook};

pub(crate) use store::{SolidScene, SolidStore, TracedScene, notes};

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use tracer::camera::SampleAxes;
use tracer::shade::Face;
use tracer::{BoundingBox, Caster, Crossing, Ray, World};

use crate::camera::Camera;
use crate::counters::PixelCounters;
use crate::error::RenderError;
use crate::point::WorldPoint;
use crate::request::PictureRequest;
use crate::style;

/// Pixels along a tile's side.
pub(crate) const TILE: usize = 64;
/// The samples of a pixel at an edge, in pixels from its top left: those of both backends' rasterisers.
const SAMPLES: [[f64; 2]; 4] = [
    [0.375, 0.125],
    [0.875, 0.375],
    [0.125, 0.625],
    [0.625, 0.875],
];
/// The side of a block of pixels whose rays are read together.
const BUNDLE: usize = 8;
/// Neighbours on one surface are at an edge if the vector between them leaves the tangent plane by this fraction.
const BEND: f64 = 0.6;

/// The fraction of a depth by which rounding may move a surface's triangles.
const DEPTH_ROUNDING: f64 = 1.0 / (1 << 19) as f64;
/// The distance by which their corners may be moved in the picture, in pixels.
const PLACE_ROUNDING: f64 = 1.0 / 128.0;
/// The maximum fraction of its depth by which a face is moved away, so that one that is seen at a grazing angle stays.
const MOST_BEHIND: f64 = 0.5;

/// The number of places in a pixel whose mean colour it has, where those of its samples differ by more than [`DIFFERENT`]: as
/// in the traced view, and at the same places.
const PLACES: u32 = 16;
const DIFFERENT: f64 = 1.0 / 64.0;
/// A face's tangent plane stands for the face up to this change of distance, as a fraction of the distance.
const MOST_ALONG: f64 = 0.5;

/// The solid that a sample sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SolidSample {
    /// The depth in clip space, above 0 and at most 1; 0 if no solid is seen.
    pub(crate) depth: f32,
    /// Linear light.
    pub(crate) light: [f32; 3],
}

/// The solids that are seen in a tile.
#[derive(Clone, Debug)]
pub(crate) struct SolidTile {
    /// The pixels, row by row, [`TILE`] in a row.
    pub(crate) pixels: Vec<SolidSample>,
    /// The pixels at edges, by their index in the tile, each with its four samples.
    pub(crate) splits: Vec<(u16, [SolidSample; 4])>,
}

/// The tint of a solid, which the window chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tint {
    /// The factor of its faces' linear colours.
    pub(crate) colour: [f32; 3],
    /// The fraction of [`style::EMPHASIS_COLOUR`] that is mixed into it, from 0 to 1.
    pub(crate) emphasis: f32,
}

/// Casts the rays of a picture.
pub(crate) struct SolidPainter<'a> {
    camera: &'a Camera,
    scene: &'a SolidScene,
    world: &'a World,
    /// For each solid of the world.
    tints: &'a [Tint],
    /// True if pixels at edges have a ray for each sample.
    is_smooth: bool,
    counters: &'a PixelCounters,
    /// The number of rays that exceeded the work limit.
    cut_short: AtomicU64,
    /// The operations so far.
    operations: AtomicU64,
    /// The parts of the picture in which solids are seen: left, top, right and bottom in pixels.
    boxes: Vec<[f64; 4]>,
}

/// The point of a solid at a position in the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SolidHit {
    /// The crossing.
    pub(crate) crossing: Crossing,
    /// The depth in clip space.
    pub(crate) depth: f32,
}

impl<'a> SolidPainter<'a> {
    /// Begins a picture of a world by a camera. `tints` has one entry for each solid.
    pub(crate) fn new(
        camera: &'a Camera,
        scene: &'a SolidScene,
        tints: &'a [Tint],
        is_smooth: bool,
        counters: &'a PixelCounters,
    ) -> Self {
        let world = scene.world();
        let solids = 0..world.solid_count();
        let boxes = solids.filter_map(|solid| seen_box(camera, world.bounds(solid)));
        Self {
            camera,
            scene,
            world,
            tints,
            is_smooth,
            counters,
            cut_short: AtomicU64::new(0),
            operations: AtomicU64::new(0),
            boxes: boxes.collect(),
        }
    }

    /// Returns true once the tiles have used more than [`most_space_operations`]: then no more are drawn.
    fn is_out_of_work(&self) -> bool {
        self.operations.load(Ordering::Relaxed) > most_space_operations(self.camera.size)
    }

    /// Returns the notes on the solids, once all tiles are drawn.
    ///
    /// # Errors
    /// [`RenderError::TooMuchWork`] if the limit was exceeded before that.
    pub(crate) fn notes(&self, request: &PictureRequest) -> Result<Vec<String>, RenderError> {
        if self.is_out_of_work() {
            let most = most_space_operations(self.camera.size);
            return Err(RenderError::TooMuchWork(most));
        }
        let notes = self.scene.notes(request);
        let cut_short = cut_short_note(self.cut_short.load(Ordering::Relaxed));
        Ok(notes.chain(cut_short).collect())
    }

    /// Draws the tile that begins at a pixel; `None` if no solid is seen in it.
    pub(crate) fn tile(&self, [left, top]: [usize; 2]) -> Option<SolidTile> {
        let [width, height] = self.camera.size.map(|side| side as usize);
        let right = (left + TILE).min(width);
        let bottom = (top + TILE).min(height);
        let touches = |it: &[f64; 4]| {
            it[0] <= right as f64
                && it[1] <= bottom as f64
                && it[2] >= left as f64
                && it[3] >= top as f64
        };
        let is_empty = left >= right || top >= bottom || !self.boxes.iter().any(touches);
        if is_empty || self.is_out_of_work() {
            return None;
        }
        // Pixels of the neighbouring tiles also decide whether a pixel is at an edge.
        let ring = usize::from(self.is_smooth);
        let [across, down] = [right - left + 2 * ring, bottom - top + 2 * ring];
        let mut rays = RayCounter::new(self);
        let mut hits: Vec<Option<SolidHit>> = vec![None; across * down];
        for block in blocks([across, down]) {
            let middle = |&[x, y]: &[usize; 2]| {
                [(left + x) as f64, (top + y) as f64].map(|at| at + 0.5 - ring as f64)
            };
            let places: Vec<[f64; 2]> = block.iter().map(middle).collect();
            rays.cast(&places, |k, hit| {
                let [x, y] = block[k];
                hits[y * across + x] = hit;
            });
        }
        let mut tile = SolidTile {
            pixels: vec![SolidSample::default(); TILE * TILE],
            splits: Vec::new(),
        };
        let mut any = false;
        for block in blocks([right - left, bottom - top]) {
            // The samples of all edge pixels of a block, read together.
            let mut places: Vec<[f64; 2]> = Vec::new();
            let known = tile.splits.len();
            for [i, j] in block {
                let at = (j + ring) * across + i + ring;
                let index = j * TILE + i;
                let corner = [(left + i) as f64, (top + j) as f64];
                if let Some(hit) = &hits[at] {
                    let middle = corner.map(|at| at + 0.5);
                    let offsets = SAMPLES.map(|sample| sample.map(|at| at - 0.5));
                    tile.pixels[index] = self.lit(hit, middle, &offsets);
                    any = true;
                }
                let is_edge = self.is_smooth
                    && [at - 1, at + 1, at - across, at + across]
                        .iter()
                        .any(|&other| is_edge(hits[at].as_ref(), hits[other].as_ref()));
                if is_edge {
                    let sample = |sample: [f64; 2]| [0, 1].map(|k| corner[k] + sample[k]);
                    places.extend(SAMPLES.map(sample));
                    tile.splits
                        .push((index as u16, [SolidSample::default(); 4]));
                }
            }
            let splits = &mut tile.splits[known..];
            rays.cast(&places, |k, hit| {
                if let Some(hit) = hit {
                    splits[k / 4].1[k % 4] = self.lit(&hit, places[k], &[[0.0; 2]]);
                    any = true;
                }
            });
        }
        any.then_some(tile)
    }

    /// Finds the solid that is seen at a position in the picture, in pixels from its top left.
    pub(crate) fn hit(&self, place: [f64; 2]) -> Option<SolidHit> {
        let mut found = None;
        RayCounter::new(self).cast(&[place], |_, hit| found = hit);
        found
    }

    /// Returns the light of the point that is seen at a position in the picture, for samples at offsets from it.
    fn lit(&self, hit: &SolidHit, place: [f64; 2], offsets: &[[f64; 2]]) -> SolidSample {
        let face = Face::from(&hit.crossing);
        let look = self.scene.look(&face);
        let slope = look.bump - face.normal.dot(look.bump) * face.normal;
        let normal = (face.normal - slope).normalize_or(face.normal);
        let view = self.camera.axes.map(|axis| axis.dot(normal) as f32);
        let (diffuse, white) = style::surface_light(view, self.to_eye(place));
        let tint = self.tints.get(hit.crossing.solid);
        let factor = tint.map_or([1.0; 3], |tint| tint.colour);
        // A single sample at an edge is one of the four whose mean is taken.
        let is_averaged = self.is_smooth && offsets.len() > 1 && self.scene.look_varies(&face);
        let colour = match is_averaged {
            true => self.mean_colour(&hit.crossing, look.colour, place, offsets),
            false => look.colour.clamp(DVec3::ZERO, DVec3::ONE),
        };
        let colour = colour.to_array();
        let light = [0, 1, 2].map(|k| colour[k] as f32 * factor[k] * diffuse + white);
        SolidSample {
            depth: self.depth_behind(hit, place, offsets),
            light: style::emphasised(light, tint.map_or(0.0, |tint| tint.emphasis)),
        }
    }

    /// Returns the mean linear colour of a face in a pixel, where it has the colour `middle` at a position in the picture:
    /// over samples at offsets from it, and over more places if their colours differ. The face is taken as its tangent
    /// plane, which is partly beside the face: where no colour is defined there, `middle` stands for it.
    fn mean_colour(
        &self,
        face: &Crossing,
        middle: DVec3,
        place: [f64; 2],
        offsets: &[[f64; 2]],
    ) -> DVec3 {
        let colour = |offset: &[f64; 2]| {
            let ray = ray(self.camera, [0, 1].map(|k| place[k] + offset[k]));
            let t = face.normal.dot(face.position - ray.origin) / face.normal.dot(ray.direction);
            let is_near = (t - face.t).abs() <= MOST_ALONG * face.t;
            let beside = is_near.then(|| ray.origin + t * ray.direction);
            let colour = beside.and_then(|point| self.scene.colour_beside(face.leaf, point));
            colour.unwrap_or(middle).clamp(DVec3::ZERO, DVec3::ONE)
        };
        let mean = |colours: &[DVec3]| colours.iter().sum::<DVec3>() / colours.len() as f64;
        let samples: Vec<DVec3> = offsets.iter().map(colour).collect();
        let differs = |it: &DVec3| (*it - samples[0]).abs().max_element() > DIFFERENT;
        if !samples.iter().any(differs) {
            return mean(&samples);
        }
        let sample = |k: u32| SampleAxes::default().sample([0; 2], k).pixel;
        let places = (0..PLACES).map(|k| sample(k).map(|at| at - 0.5));
        mean(&places.map(|offset| colour(&offset)).collect::<Vec<_>>())
    }

    /// Returns the least depth of a face's tangent plane in samples at offsets from a position in the picture, in pixels, less
    /// the rounding of triangles: a surface in this plane is in front of it in all of these samples.
    fn depth_behind(&self, hit: &SolidHit, place: [f64; 2], offsets: &[[f64; 2]]) -> f32 {
        let depth = f64::from(hit.depth);
        let slope = depth_slope(self.camera, &hit.crossing, place, depth);
        let rises = offsets.iter().map(|at| slope[0] * at[0] + slope[1] * at[1]);
        let least = rises.fold(f64::INFINITY, f64::min);
        let rounding = DEPTH_ROUNDING * depth + PLACE_ROUNDING * (slope[0].abs() + slope[1].abs());
        (depth + least - rounding).max(MOST_BEHIND * depth) as f32
    }

    /// Returns the unit vector to the eye from the point that is seen at a position in the picture, in view space.
    fn to_eye(&self, place: [f64; 2]) -> [f32; 3] {
        if self.camera.parallel.is_some() {
            return [0.0, 0.0, 1.0];
        }
        let [x, y] = across(self.camera, place).map(|x| x as f32);
        Vec3::new(-x, -y, 1.0).normalize().to_array()
    }
}

/// Casts rays, and adds their number to the counters when it is dropped.
struct RayCounter<'p, 'a> {
    painter: &'p SolidPainter<'a>,
    caster: Caster<'a>,
    rays: Vec<Ray>,
    count: u64,
    /// The operations of the caster that have been counted.
    operations: u64,
}

impl<'p, 'a> RayCounter<'p, 'a> {
    fn new(painter: &'p SolidPainter<'a>) -> Self {
        Self {
            painter,
            caster: painter.world.caster(),
            rays: Vec::new(),
            count: 0,
            operations: 0,
        }
    }

    /// Casts the rays through some positions in the picture, which are read together.
    fn cast(&mut self, places: &[[f64; 2]], mut found: impl FnMut(usize, Option<SolidHit>)) {
        if places.is_empty() || self.painter.is_out_of_work() {
            return;
        }
        let camera = self.painter.camera;
        self.rays.clear();
        self.rays
            .extend(places.iter().map(|&place| ray(camera, place)));
        self.caster.begin_tile(places.len());
        self.caster.begin_bundle(&self.rays);
        self.count += places.len() as u64;
        for k in 0..places.len() {
            let crossing = self.caster.first_of_bundle(k);
            let hit = crossing.and_then(|crossing| {
                let depth = depth(camera, crossing.t);
                (depth > 0.0).then_some(SolidHit { crossing, depth })
            });
            found(k, hit);
        }
        let operations = self.caster.operations();
        let new = operations - std::mem::replace(&mut self.operations, operations);
        self.painter.operations.fetch_add(new, Ordering::Relaxed);
    }
}

impl Drop for RayCounter<'_, '_> {
    fn drop(&mut self) {
        self.painter.counters.count_rays(self.count);
        let cut_short = self.caster.rays_cut_short();
        self.painter
            .cut_short
            .fetch_add(cut_short, Ordering::Relaxed);
    }
}

/// The operations of a picture on solids, lights and surfaces, in addition to those of its pixels: some seconds of two
/// cores.
pub const MOST_OPERATIONS: u64 = 1 << 30;
/// The additional operations for each pixel of the 3D view: about those of a gyroid that fills the picture.
pub const MOST_SPACE_PIXEL_OPERATIONS: u64 = 1 << 9;
/// The same for a sample of the traced view, with shadows and reflections.
pub const MOST_TRACED_PIXEL_OPERATIONS: u64 = 1 << 10;

/// Returns the maximum operations on solids for a picture of this size in the 3D view. See [`tracer::Caster::operations`].
pub(crate) fn most_space_operations(size: [u32; 2]) -> u64 {
    MOST_OPERATIONS + pixel_count(size) * MOST_SPACE_PIXEL_OPERATIONS
}

/// Returns the maximum operations for one sample of a traced picture of this size, unless a request sets another limit.
pub fn most_traced_operations(size: [u32; 2]) -> u64 {
    MOST_OPERATIONS + pixel_count(size) * MOST_TRACED_PIXEL_OPERATIONS
}

fn pixel_count([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// Returns the note on rays that exceeded the work limit.
pub(crate) fn cut_short_note(rays: u64) -> Option<String> {
    let noun = if rays == 1 { "ray" } else { "rays" };
    (rays > 0).then(|| {
        format!("{rays} {noun} exceeded the work limit: objects along them may be missing")
    })
}

/// Returns the blocks of a part of the picture, each with its pixels.
fn blocks([width, height]: [usize; 2]) -> impl Iterator<Item = Vec<[usize; 2]>> {
    let corners = (0..height)
        .step_by(BUNDLE)
        .flat_map(move |y| (0..width).step_by(BUNDLE).map(move |x| [x, y]));
    corners.map(move |[x, y]| {
        (y..(y + BUNDLE).min(height))
            .flat_map(|y| (x..(x + BUNDLE).min(width)).map(move |x| [x, y]))
            .collect()
    })
}

/// Returns the position of a ray through the picture at distance 1 along the view direction: right and up, in drawing units.
fn across(camera: &Camera, [x, y]: [f64; 2]) -> [f64; 2] {
    let [width, height] = camera.size.map(f64::from);
    let [tx, ty] = camera.half_tangents();
    [(2.0 * x / width - 1.0) * tx, (1.0 - 2.0 * y / height) * ty]
}

/// Returns the ray through a position in the picture, in the scene's units. Its t is the distance along the view direction
/// in drawing units: from the eye, or from the nearest plane that an orthographic camera draws.
fn ray(camera: &Camera, place: [f64; 2]) -> Ray {
    let [right, up, back] = camera.axes;
    let [x, y] = across(camera, place);
    let aside = x * right + y * up;
    let (origin, direction) = match camera.parallel {
        None => (camera.eye, aside - back),
        Some(parallel) => {
            let ahead = parallel.distance - parallel.reach;
            (camera.eye + parallel.distance * aside - ahead * back, -back)
        }
    };
    let placement = &camera.placement;
    Ray {
        origin: DVec3::from(placement.centre) + placement.radius * origin,
        direction: placement.radius * direction,
        leaving: None,
    }
}

/// Returns the depth in clip space of a point on a ray. Points in front of the near plane are moved into it.
fn depth(camera: &Camera, t: f64) -> f32 {
    let depth = match camera.parallel {
        None => camera.near / t,
        Some(parallel) => 1.0 - 0.5 * t / parallel.reach,
    };
    depth.min(1.0) as f32
}

/// Returns the change of depth in the tangent plane of a point on the ray through a position in the picture, for a pixel to
/// the right and a pixel down. Depth is affine over the picture.
fn depth_slope(camera: &Camera, crossing: &Crossing, place: [f64; 2], depth: f64) -> [f64; 2] {
    let [right, up, back] = camera.axes.map(|axis| axis.dot(crossing.normal));
    let [width, height] = camera.size.map(f64::from);
    let [tx, ty] = camera.half_tangents();
    let steps = [2.0 * tx / width * right, -2.0 * ty / height * up];
    let slope = match camera.parallel {
        None => {
            let [x, y] = across(camera, place);
            steps.map(|step| depth * step / (x * right + y * up - back))
        }
        Some(parallel) => {
            steps.map(|step| -0.5 * parallel.distance * step / (parallel.reach * back))
        }
    };
    // The plane of a point at the border of what is seen contains the ray.
    slope.map(|x| if x.is_finite() { x } else { 0.0 })
}

/// Returns true if an edge separates two neighbours.
fn is_edge(a: Option<&SolidHit>, b: Option<&SolidHit>) -> bool {
    let (a, b) = match (a, b) {
        (Some(a), Some(b)) => (&a.crossing, &b.crossing),
        (None, None) => return false,
        _ => return true,
    };
    if (a.solid, a.surface) != (b.solid, b.surface) {
        return true;
    }
    let way = (b.position - a.position).normalize_or_zero();
    way.dot(a.normal).abs().max(way.dot(b.normal).abs()) > BEND
}

/// Returns the part of the picture in which the contents of a box are seen; `None` for an empty box, the whole picture for
/// an unbounded one.
fn seen_box(camera: &Camera, bounds: Option<BoundingBox>) -> Option<[f64; 4]> {
    let all = [0.0, 0.0, f64::INFINITY, f64::INFINITY];
    let Some(bounds) = bounds else {
        return Some(all);
    };
    if bounds.is_empty() {
        return None;
    }
    let mut seen = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    for corner in 0..8 {
        let side = |k: usize| match corner >> k & 1 {
            0 => bounds.lower[k],
            _ => bounds.upper[k],
        };
        let place = camera
            .placement
            .local(WorldPoint([side(0), side(1), side(2)]));
        let ahead = camera.axes[2].dot(camera.eye - DVec3::from(place.0));
        let pixel = camera.pixel_of(place);
        let (Some(at), true) = (pixel, ahead > 1e-6 || camera.parallel.is_some()) else {
            return Some(all);
        };
        for k in 0..2 {
            // Add a pixel: rays at edges do not pass through the centres of pixels.
            seen[k] = seen[k].min(at.0[k] - 1.0);
            seen[k + 2] = seen[k + 2].max(at.0[k] + 1.0);
        }
    }
    // Near the eye's plane, projected positions may be NaN.
    if seen.iter().any(|x| x.is_nan()) {
        return Some(all);
    }
    Some(seen)
}
