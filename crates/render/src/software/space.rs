//! The 3D view: samples to meshes to tiles, in batches of triangles and bands of rows, so that the memory for large scenes
//! and large pictures is bounded.

use std::sync::Arc;

use super::mesh::{Eye, Mesh};
use super::raster::{Batch, TILE, Tile, Workspace};
use super::shade::{Material, MaterialKind};
use super::{curves, points, surfaces, vectors};
use crate::camera::Camera;
use crate::sample::Samples;
use crate::solids::SolidPainter;
use crate::style::{self, LineStyle, Look};
use crate::texture::{Sampler, SurfaceImage};
use image::RgbaImage;
use rayon::prelude::*;

/// The number of pixels of a band.
const BAND: usize = 1 << 21;
/// The approximate number of triangles of a job.
const JOB: usize = 8_192;
/// The approximate number of triangles of a batch.
const BATCH: usize = 1 << 20;

/// The ratio of length to width of a footprint from which on it is blurred during motion.
const COARSE_ANISOTROPY: f32 = 4.0;

/// A part of an object: instances of points, vectors and curves, rows of quads of surfaces.
pub(super) struct Job {
    pub(super) object: usize,
    /// The first of the object's materials.
    pub(super) material: u32,
    pub(super) range: std::ops::Range<usize>,
    pub(super) triangles: usize,
}

/// An object with its samples and its look.
#[derive(Clone, Debug)]
pub struct Drawable {
    /// Its samples, in the drawing units of the camera.
    pub samples: Arc<Samples>,
    /// The colours of its instances in linear light, at least one; the last one is that of all further instances.
    pub colours: Arc<[[f32; 3]]>,
    /// The fraction of [`style::EMPHASIS_COLOUR`] that is mixed into it, from 0 to 1.
    pub emphasis: f32,
    /// The look of its lines.
    pub line: LineStyle,
    /// The image of a surface; none for other kinds.
    pub image: Option<SurfaceImage>,
    /// True if its image is sampled as by [`Sampler::coarse`].
    pub(crate) is_coarse: bool,
    /// For a surface, one of `stride` columns and rows of samples is drawn.
    pub(crate) stride: usize,
}

impl Drawable {
    /// Creates an object with its look.
    pub(crate) fn new(samples: Arc<Samples>, look: &Look, image: Option<SurfaceImage>) -> Self {
        Self {
            samples,
            colours: look.colours.clone(),
            emphasis: look.emphasis,
            line: look.line,
            image,
            is_coarse: false,
            stride: 1,
        }
    }

    /// Returns the object with one colour for all instances, and no image.
    pub(super) fn of_one_colour(&self) -> Self {
        let colours = self.colours.iter().take(1).copied().collect();
        Self {
            colours,
            image: None,
            ..self.clone()
        }
    }

    /// Returns the number of looks of its instances; the last one is that of all further instances.
    fn look_count(&self) -> usize {
        let image = self.image.as_ref();
        let images = image.map_or(1, |image| image.texture.instances().count());
        self.colours.len().max(images)
    }

    /// Returns the number of the parts of an instance that [`Job::range`] counts.
    fn units_per_instance(&self) -> usize {
        match self.samples.as_ref() {
            Samples::Surfaces { count, .. } => surfaces::quads(count[1], self.stride),
            _ => 1,
        }
    }

    /// Returns an object of which nothing is drawn.
    pub(crate) fn nothing() -> Self {
        Self {
            samples: Arc::new(Samples::Points(Vec::new())),
            colours: Arc::from([[0.0; 3]]),
            emphasis: 0.0,
            line: LineStyle::default(),
            image: None,
            is_coarse: false,
            stride: 1,
        }
    }
}

/// The depths of a picture's pixels, for each that of its farthest sample; 0 where nothing is seen.
#[derive(Clone, Debug)]
pub(crate) struct DepthMap {
    size: [u32; 2],
    depths: Vec<f32>,
}

impl DepthMap {
    /// Returns the depth at a position in the picture; `None` outside it.
    pub(crate) fn at(&self, [x, y]: [f32; 2]) -> Option<f32> {
        let [width, height] = self.size.map(|side| side as f32);
        let inside = (0.0..width).contains(&x) && (0.0..height).contains(&y);
        let index = || y as usize * self.size[0] as usize + x as usize;
        inside.then(|| self.depths.get(index()).copied()).flatten()
    }
}

/// Draws as [`draw_beside`] does, and also returns the depths of the pixels.
pub(crate) fn draw_with_depths(
    camera: &Camera,
    objects: &[Drawable],
    solids: Option<&SolidPainter<'_>>,
    background: [f32; 4],
    progress: &(dyn Fn(f32) + Sync),
) -> (RgbaImage, DepthMap) {
    let eye = Eye::new(camera);
    let materials = materials(objects);
    let jobs = jobs(objects);
    let batches = batches(&jobs);
    let [width, height] = camera.size.map(|side| side as usize);
    let mut image = RgbaImage::new(camera.size[0], camera.size[1]);
    let mut depths = vec![0.0; width * height];
    let across = width.div_ceil(TILE);
    let band_rows = (BAND / (across * TILE) / TILE).max(1) * TILE;
    let bands = image.chunks_mut(band_rows * width * 4);
    for (band, (pixels, depths)) in bands.zip(depths.chunks_mut(band_rows * width)).enumerate() {
        let top = band * band_rows;
        let size = [across, (depths.len() / width).div_ceil(TILE)];
        let mut tiles = tiles(size, top, background, solids);
        for batch in &batches {
            let meshes = batch_meshes(&eye, objects, &jobs[batch.clone()]);
            Batch::new(&eye, &materials, &meshes, size, top).draw(&mut tiles);
        }
        let rows = pixels.par_chunks_mut(4 * width);
        let rows = rows.zip(depths.par_chunks_mut(width)).enumerate();
        rows.for_each(|(y, (row, depths))| {
            for (x, (pixel, depth)) in row.chunks_exact_mut(4).zip(depths).enumerate() {
                let tile = &tiles[y / TILE * across + x / TILE];
                pixel.copy_from_slice(&tile.pixel(x, top + y));
                if let Some(index) = tile.index([x, top + y]) {
                    *depth = tile.depth(index).into_iter().fold(f32::INFINITY, f32::min);
                }
            }
        });
        progress((top + band_rows).min(height) as f32 / height as f32);
    }
    let size = camera.size;
    (image, DepthMap { size, depths })
}

/// Returns the tiles of a band whose first row of pixels is `top`, with the background and the solids.
fn tiles(
    [across, down]: [usize; 2],
    top: usize,
    background: [f32; 4],
    solids: Option<&SolidPainter<'_>>,
) -> Vec<Tile> {
    let tile = |k: usize| {
        let origin = [k % across * TILE, top + k / across * TILE];
        let mut tile = Tile::new(origin, background);
        if let Some(solids) = solids.and_then(|solids| solids.tile(origin)) {
            tile.begin(&solids);
        }
        tile
    };
    (0..across * down).into_par_iter().map(tile).collect()
}

/// Returns the meshes of a batch of jobs.
fn batch_meshes(eye: &Eye, objects: &[Drawable], jobs: &[Job]) -> Vec<Mesh> {
    let jobs = jobs.par_iter();
    jobs.flat_map_iter(|job| meshes(eye, objects, job))
        .collect()
}

/// Returns the materials of objects, two for each look of their instances; the second one is that of arrowheads.
fn materials(objects: &[Drawable]) -> Vec<Material<'_>> {
    let own = objects.iter().flat_map(|object| {
        let samplers = object.image.iter().flat_map(SurfaceImage::samplers);
        let samplers = samplers.map(|it| {
            if object.is_coarse {
                it.coarse(COARSE_ANISOTROPY)
            } else {
                it
            }
        });
        let samplers: Vec<Sampler<'_>> = samplers.collect();
        (0..object.look_count()).flat_map(move |look| {
            let sampler = samplers.get(look).or(samplers.last()).cloned();
            let kind = sampler.map_or(MaterialKind::Glyph, MaterialKind::Surface);
            let last = object.colours.len() - 1;
            [kind, MaterialKind::Cone].map(|kind| Material {
                kind,
                colour: object.colours[look.min(last)],
                emphasis: object.emphasis,
            })
        })
    });
    own.collect()
}

/// Draws objects as seen by a camera, in front of a background (linear light and alpha). `progress` receives the completed
/// fraction.
pub fn draw(
    camera: &Camera,
    objects: &[Drawable],
    background: [f32; 4],
    progress: &(dyn Fn(f32) + Sync),
) -> RgbaImage {
    draw_beside(camera, objects, None, background, progress)
}

/// Draws objects together with solids; both hide what is behind them.
pub(crate) fn draw_beside(
    camera: &Camera,
    objects: &[Drawable],
    solids: Option<&SolidPainter<'_>>,
    background: [f32; 4],
    progress: &(dyn Fn(f32) + Sync),
) -> RgbaImage {
    let eye = Eye::new(camera);
    let materials = materials(objects);
    let jobs = jobs(objects);
    let batches = batches(&jobs);
    let [width, height] = camera.size.map(|side| side as usize);
    let mut image = RgbaImage::new(camera.size[0], camera.size[1]);
    let across = width.div_ceil(TILE);
    let band_rows = (BAND / (across * TILE) / TILE).max(1) * TILE;
    let bands = height.div_ceil(band_rows);
    // If everything fits into one batch, it is transformed only once, whatever the number of bands.
    let whole = (batches.len() < 2).then(|| batch_meshes(&eye, objects, &jobs));
    for (band, pixels) in image.chunks_mut(band_rows * width * 4).enumerate() {
        let top = band * band_rows;
        let rows = pixels.len() / (4 * width);
        let size = [across, rows.div_ceil(TILE)];
        if let Some(meshes) = &whole {
            let batch = Batch::new(&eye, &materials, meshes, size, top);
            let tiles: Vec<Option<Vec<[u8; 4]>>> = (0..size[0] * size[1])
                .into_par_iter()
                .map_init(
                    || Workspace::new(background, across, top),
                    |space, number| batch.pixels(number, space, solids),
                )
                .collect();
            let empty = Tile::new([0; 2], background).pixel(0, 0);
            fill(pixels, width, |x, y| {
                let tile = tiles[y / TILE * across + x / TILE].as_ref();
                tile.map(|pixels| &pixels[y % TILE * TILE..][..TILE])
                    .ok_or(empty)
            });
            progress((band + 1) as f32 / bands as f32);
            continue;
        }
        let mut tiles = tiles(size, top, background, solids);
        for (number, batch) in batches.iter().enumerate() {
            let meshes = batch_meshes(&eye, objects, &jobs[batch.clone()]);
            Batch::new(&eye, &materials, &meshes, size, top).draw(&mut tiles);
            progress((band * batches.len() + number + 1) as f32 / (bands * batches.len()) as f32);
        }
        pixels
            .par_chunks_mut(4 * width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                    let tile = &tiles[y / TILE * across + x / TILE];
                    pixel.copy_from_slice(&tile.pixel(x, top + y));
                }
            });
    }
    image
}

/// Fills rows of pixels from those of tiles: `row` returns the row of the tile that begins there, or one colour for all.
fn fill<'t>(
    pixels: &mut [u8],
    width: usize,
    row: impl Fn(usize, usize) -> Result<&'t [[u8; 4]], [u8; 4]> + Sync,
) {
    pixels
        .par_chunks_mut(4 * width)
        .enumerate()
        .for_each(|(y, pixels)| {
            for (number, pixels) in pixels.chunks_mut(4 * TILE).enumerate() {
                let (pixels, _) = pixels.as_chunks_mut::<4>();
                match row(number * TILE, y) {
                    Ok(tile) => pixels.copy_from_slice(&tile[..pixels.len()]),
                    Err(colour) => pixels.fill(colour),
                }
            }
        });
}

/// Splits the objects into jobs.
pub(super) fn jobs(objects: &[Drawable]) -> Vec<Job> {
    let mut jobs = Vec::new();
    let mut material = 0;
    for (index, object) in objects.iter().enumerate() {
        // Units of work and the triangles of each.
        let (units, triangles) = match object.samples.as_ref() {
            Samples::Points(samples) => (samples.len(), style::POINT_SEGMENTS),
            Samples::Vectors(samples) => (
                samples.len(),
                2 * style::HEAD_SEGMENTS + style::JOIN_SEGMENTS + 2,
            ),
            Samples::Curves { count, samples } => (samples.len() / *count as usize, 2 * count),
            Samples::Surfaces { count, samples } => {
                let instances = samples.len() / (count[0] as usize * count[1] as usize);
                let [across, down] = count.map(|n| surfaces::quads(n, object.stride));
                (instances * down, 2 * across as u32)
            }
        };
        let triangles = triangles as usize;
        let step = (JOB / triangles).max(1);
        for start in (0..units).step_by(step) {
            let range = start..(start + step).min(units);
            jobs.push(Job {
                object: index,
                material,
                triangles: range.len() * triangles,
                range,
            });
        }
        material += 2 * object.look_count() as u32;
    }
    jobs
}

/// Groups jobs, in order.
pub(super) fn batches(jobs: &[Job]) -> Vec<std::ops::Range<usize>> {
    let mut batches = Vec::new();
    let (mut start, mut triangles) = (0, 0);
    for (index, job) in jobs.iter().enumerate() {
        triangles += job.triangles;
        if triangles >= BATCH || index + 1 == jobs.len() {
            batches.push(start..index + 1);
            (start, triangles) = (index + 1, 0);
        }
    }
    batches
}

/// Returns the triangles of a job. Those of instances with looks of their own are separate meshes.
pub(super) fn meshes(eye: &Eye, objects: &[Drawable], job: &Job) -> Vec<Mesh> {
    let object = &objects[job.object];
    let last = object.look_count() - 1;
    if last == 0 {
        return part(eye, object, job.material, job.range.clone());
    }
    let per_instance = object.units_per_instance();
    let mut meshes = Vec::new();
    let mut start = job.range.start;
    while start < job.range.end {
        let instance = start / per_instance;
        let end = match instance < last {
            true => ((instance + 1) * per_instance).min(job.range.end),
            false => job.range.end,
        };
        let material = job.material + 2 * instance.min(last) as u32;
        meshes.extend(part(eye, object, material, start..end));
        start = end;
    }
    meshes
}

/// Returns the triangles of a part of an object, which have one colour.
fn part(eye: &Eye, object: &Drawable, material: u32, range: std::ops::Range<usize>) -> Vec<Mesh> {
    let eye = &eye.with_lines(object.line);
    match object.samples.as_ref() {
        Samples::Points(samples) => vec![points::mesh(eye, material, &samples[range])],
        Samples::Vectors(samples) => {
            vectors::meshes(eye, [material, material + 1], &samples[range]).into()
        }
        Samples::Curves { count, samples } => {
            vec![curves::mesh(eye, material, *count, samples, range)]
        }
        Samples::Surfaces { count, samples } => {
            vec![surfaces::mesh(
                eye,
                material,
                *count,
                object.stride,
                samples,
                range,
            )]
        }
    }
}
