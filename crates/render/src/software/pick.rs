//! Picking in the 3D view: the triangle at a pixel's samples, found in the same way as for the picture, and from it the
//! object, its instance and the point on it.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::mesh::{Corner, Eye, Mesh, SUBPIXEL};
use super::raster::{self, Edges, Layer, SAMPLES, TILE, Tile};
use super::space::{Drawable, Job, batches, jobs, meshes};
use crate::camera::Camera;
use crate::point::{DrawingPoint, PixelPoint};
use crate::sample::{PositionSample, Samples};

/// The distance in pixels within which points, vectors and curves are picked.
pub const NEAR: f64 = 4.0;

/// The result of picking.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// The index among the drawn objects.
    pub object: usize,
    /// The number of its instance.
    pub instance: u64,
    /// The point.
    pub position: DrawingPoint,
    /// Fractions of the domain, from 0 to 1: along u and v for a surface, along t for a curve; otherwise zero.
    pub shares: [f64; 2],
}

/// A triangle that a sample sees.
#[derive(Clone, Copy)]
struct Seen {
    /// The job that it belongs to, and the index among the job's meshes.
    job: usize,
    mesh: usize,
    triangle: u32,
    corners: [Corner; 3],
    depth: f32,
}

/// Returns the object at a pixel: a point, vector or curve within [`NEAR`], otherwise the surface there.
pub fn pick(camera: &Camera, objects: &[Drawable], PixelPoint(at): PixelPoint) -> Option<Picked> {
    let inside = |k: usize| at[k] >= 0.0 && at[k] < f64::from(camera.size[k]);
    if !inside(0) || !inside(1) {
        return None;
    }
    let eye = Eye::new(camera);
    // A job with a single colour has one mesh of each kind.
    let objects: Vec<Drawable> = objects.iter().map(Drawable::of_one_colour).collect();
    let objects = &*objects;
    let jobs = jobs(objects);
    let window = PixelWindow::around(at, camera.size);
    let seen = window.look(&eye, objects, &jobs);
    let is_surface = |seen: &Seen| {
        matches!(
            *objects[jobs[seen.job].object].samples,
            Samples::Surfaces { .. }
        )
    };

    let mut best: Option<(f64, Seen, [f64; 2])> = None;
    let mut under: Option<(f64, Seen)> = None;
    for (pixel, samples) in window.pixels().zip(&seen) {
        let middle = pixel.map(|x| x as f64 + 0.5);
        let away = (middle[0] - at[0]).hypot(middle[1] - at[1]);
        let here = (0..2).all(|k| pixel[k] as f64 == at[k].floor());
        for (sample, seen) in SAMPLES.iter().zip(samples) {
            let Some(seen) = seen else { continue };
            if is_surface(seen) {
                let place = [0, 1].map(|k| pixel[k] as f64 + f64::from(sample[k]) / 256.0);
                let off = (place[0] - at[0]).hypot(place[1] - at[1]);
                if here && under.as_ref().is_none_or(|(least, _)| off < *least) {
                    under = Some((off, *seen));
                }
            } else if away <= NEAR
                && best.as_ref().is_none_or(|(least, other, _)| {
                    away < *least || (away == *least && seen.depth > other.depth)
                })
            {
                best = Some((away, *seen, middle));
            }
        }
    }
    let (seen, place) = match (best, under) {
        (Some((_, seen, middle)), _) => (seen, middle),
        (None, Some((_, seen))) => (seen, at),
        (None, None) => return None,
    };
    Some(found(camera, &eye, objects, &jobs[seen.job], &seen, place))
}

/// The pixels around a position.
struct PixelWindow {
    first: [usize; 2],
    end: [usize; 2],
}

impl PixelWindow {
    fn around(at: [f64; 2], size: [u32; 2]) -> Self {
        let reach = NEAR.ceil();
        Self {
            first: at.map(|x| (x - reach).floor().max(0.0) as usize),
            end: [0, 1].map(|k| ((at[k] + reach).floor() as usize + 1).min(size[k] as usize)),
        }
    }

    fn pixels(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let [first, end] = [self.first, self.end];
        (first[1]..end[1]).flat_map(move |y| (first[0]..end[0]).map(move |x| [x, y]))
    }

    fn index(&self, [x, y]: [usize; 2]) -> usize {
        (y - self.first[1]) * (self.end[0] - self.first[0]) + x - self.first[0]
    }

    /// Returns the triangles that the pixels' samples see. The tiles are those of the picture, so that depths are identical.
    fn look(&self, eye: &Eye, objects: &[Drawable], jobs: &[Job]) -> Vec<[Option<Seen>; 4]> {
        let mut all = vec![[None; 4]; self.pixels().count()];
        let tiles = |k: usize| self.first[k] / TILE..=(self.end[k] - 1) / TILE;
        let mut tiles: Vec<Tile> = tiles(1)
            .flat_map(|y| tiles(0).map(move |x| Tile::new([x * TILE, y * TILE], [0.0; 4])))
            .collect();
        let low = self.first.map(|pixel| pixel as i32 * SUBPIXEL);
        let high = self.end.map(|pixel| pixel as i32 * SUBPIXEL);
        let touches = |corners: &[&Corner; 3]| {
            (0..2).all(|k| {
                corners.iter().any(|corner| corner.at[k] >= low[k])
                    && corners.iter().any(|corner| corner.at[k] <= high[k])
            })
        };
        for batch in batches(jobs) {
            let first = batch.start;
            // For each job its meshes, and for each mesh the triangles that touch the window.
            let near: Vec<Vec<(Mesh, Vec<u32>)>> = jobs[batch]
                .par_iter()
                .map(|job| {
                    let near = |mesh: Mesh| {
                        let numbered = (0..).zip(&mesh.triangles);
                        let near = numbered.filter(|(_, t)| touches(&corners(&mesh, t)));
                        let near = near.map(|(number, _)| number).collect();
                        (mesh, near)
                    };
                    meshes(eye, objects, job).into_iter().map(near).collect()
                })
                .collect();
            let list: Vec<(usize, usize, u32)> = near
                .iter()
                .enumerate()
                .flat_map(|(job, meshes)| {
                    let meshes = meshes.iter().enumerate();
                    meshes.flat_map(move |(mesh, (_, near))| {
                        near.iter().map(move |&triangle| (job, mesh, triangle))
                    })
                })
                .collect();
            for tile in &mut tiles {
                let mut layer = Layer::new();
                for (id, &(job, mesh, triangle)) in (0..).zip(&list) {
                    let mesh = &near[job][mesh].0;
                    let triangle = &mesh.triangles[triangle as usize];
                    raster::cover(tile, &mut layer, corners(mesh, triangle), id);
                }
                for pixel in self.pixels() {
                    let Some(index) = tile.index(pixel) else {
                        continue;
                    };
                    let (seen, depth) = (layer.seen(index), tile.depth(index));
                    let places = &mut all[self.index(pixel)];
                    for (s, place) in places.iter_mut().enumerate() {
                        let Some(&(job, mesh, triangle)) = list.get(seen[s] as usize) else {
                            continue;
                        };
                        let drawn = &near[job][mesh].0;
                        let ids = &drawn.triangles[triangle as usize];
                        *place = Some(Seen {
                            job: first + job,
                            mesh,
                            triangle,
                            corners: corners(drawn, ids).map(|corner| *corner),
                            depth: depth[s],
                        });
                    }
                }
            }
        }
        all
    }
}

fn corners<'m>(mesh: &'m Mesh, triangle: &[u32; 3]) -> [&'m Corner; 3] {
    triangle.map(|corner| &mesh.corners[corner as usize])
}

/// Returns the point of a triangle that is seen at a position in the picture.
fn found(
    camera: &Camera,
    eye: &Eye,
    objects: &[Drawable],
    job: &Job,
    seen: &Seen,
    place: [f64; 2],
) -> Picked {
    let at = Vec2::new(place[0] as f32, place[1] as f32);
    let weights = weights(&seen.corners, place);
    // 1 / w is affine over the picture, and so is every interpolated quantity divided by w.
    let over_w = [0, 1, 2].map(|k| weights[k] * f64::from(seen.corners[k].inv_w));
    let sum: f64 = over_w.iter().sum();
    let w = if sum > 0.0 {
        1.0 / sum
    } else {
        f64::from(eye.near)
    };
    let instance = instance(eye, objects, job, seen);
    let samples = objects[job.object].samples.as_ref();
    let depths = [0, 1, 2].map(|k| weights[k] * f64::from(seen.corners[k].depth));
    let depth = depths.iter().sum::<f64>() as f32;
    let mut position = from_view(camera, view_place(eye, at, w as f32, depth));
    let shares = match samples {
        Samples::Surfaces { .. } => {
            let uv = |k: usize| {
                let weighted = (0..3).map(|n| over_w[n] * f64::from(seen.corners[n].uv[k]));
                (weighted.sum::<f64>() * w).clamp(0.0, 1.0)
            };
            [uv(0), uv(1)]
        }
        Samples::Curves { count, samples } => {
            let count = *count as usize;
            let own = &samples[instance * count..(instance + 1) * count];
            [along(eye, own, at), 0.0]
        }
        Samples::Points(samples) => {
            position = DrawingPoint(samples[instance].position.map(f64::from));
            [0.0; 2]
        }
        Samples::Vectors(_) => [0.0; 2],
    };
    Picked {
        object: job.object,
        instance: instance as u64,
        position,
        shares,
    }
}

/// Returns barycentric coordinates in the picture; at a position beside a triangle, they extrapolate on its plane.
fn weights(corners: &[Corner; 3], place: [f64; 2]) -> [f64; 3] {
    let Some(edges) = Edges::new(corners.map(|corner| corner.at)) else {
        return [1.0, 0.0, 0.0];
    };
    edges.weights(place.map(|x| x * f64::from(SUBPIXEL)))
}

/// Returns the point in view space that is seen at a position in pixels: at the distance `w` in perspective, otherwise at a
/// depth.
fn view_place(eye: &Eye, at: Vec2, w: f32, depth: f32) -> Vec3 {
    let ndc = Vec2::new(2.0 * at.x / eye.size.x - 1.0, 1.0 - 2.0 * at.y / eye.size.y);
    let z = if eye.is_parallel() {
        (2.0 * depth - 1.0) * eye.reach - eye.plane
    } else {
        -w
    };
    (ndc / eye.zoom * w).extend(z)
}

fn from_view(camera: &Camera, at: Vec3) -> DrawingPoint {
    let [right, up, back] = camera.axes;
    let [x, y, z] = at.to_array().map(f64::from);
    DrawingPoint((camera.eye + right * x + up * y + back * z).to_array())
}

/// Returns the instance that a triangle belongs to: a job's triangles are in the order of its instances.
fn instance(eye: &Eye, objects: &[Drawable], job: &Job, seen: &Seen) -> usize {
    let per_instance = match objects[job.object].samples.as_ref() {
        Samples::Surfaces { count, .. } => (count[1] - 1) as usize,
        _ => 1,
    };
    let mut before = 0;
    let mut start = job.range.start;
    while start < job.range.end {
        let instance = start / per_instance;
        let end = ((instance + 1) * per_instance).min(job.range.end);
        let part = Job {
            object: job.object,
            material: job.material,
            range: start..end,
            triangles: 0,
        };
        let count = meshes(eye, objects, &part)
            .get(seen.mesh)
            .map_or(0, |mesh| mesh.triangles.len());
        before += count;
        if before > seen.triangle as usize {
            return instance;
        }
        start = end;
    }
    (job.range.end - 1) / per_instance
}

/// Returns the point of a curve that is nearest to a position in the picture, as a fraction of its samples.
fn along(eye: &Eye, samples: &[PositionSample], at: Vec2) -> f64 {
    let seen = |sample: &PositionSample| {
        let view = eye.see(sample.position);
        (sample.defined != 0.0 && eye.is_in_front(view)).then(|| {
            let clip = eye.clip(view, 0.0);
            let ndc = Vec2::new(clip.x, clip.y) / clip.w;
            let pixel = Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * eye.size;
            (pixel, clip.w)
        })
    };
    let mut best = (f32::INFINITY, 0.0);
    for (k, pair) in samples.windows(2).enumerate() {
        let (Some((a, wa)), Some((b, wb))) = (seen(&pair[0]), seen(&pair[1])) else {
            continue;
        };
        if pair[0].is_last() {
            continue;
        }
        let step = b - a;
        let length = step.length_squared();
        let t = if length > 0.0 {
            ((at - a).dot(step) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let off = (a + t * step).distance(at);
        if off < best.0 {
            // The midpoint in the picture is less than halfway to an end that is farther away.
            let t = t * wa / (wb + t * (wa - wb));
            best = (off, k as f64 + f64::from(t));
        }
    }
    best.1 / (samples.len().max(2) - 1) as f64
}
