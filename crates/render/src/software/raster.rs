//! Rasterising: meshes into tiles, four samples a pixel, depth, and shading of what is seen.
//!
//! Places are fixed-point and the fill rule is top-left, so that triangles with a common edge leave no gap and no
//! sample twice. A tile first finds which triangle each sample sees, then shades each triangle once a pixel, at the
//! middle of the samples that see it: no place is shaded that is hidden in the end, and none outside its triangle.

use expr::processor::{Processor, Work};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::mesh::{Corner, Eye, Mesh, SUBPIXEL};
use super::shade::{Material, Place};
use crate::style::Encoder;

/// Pixels along a tile's side.
pub(super) const TILE: usize = 64;
/// Samples of a pixel, in 1/256 pixel from its top left: a rotated grid, that of the GPU's standard pattern.
pub(super) const SAMPLES: [[i32; 2]; 4] = [[96, 32], [224, 96], [32, 160], [160, 224]];
/// Sees no triangle of the current batch.
pub(super) const NONE: u32 = u32::MAX;

/// One tile's samples.
pub(super) struct Tile {
    /// Of the top left pixel.
    origin: [usize; 2],
    /// 0 where nothing but the background is seen.
    depth: Vec<[f32; 4]>,
    /// In linear light; means nothing where the background is seen.
    light: Vec<[[f32; 3]; 4]>,
    /// In linear light, with its alpha.
    background: [f32; 4],
    /// What a pixel of it is.
    empty: [u8; 4],
    encoder: Encoder,
}

impl Tile {
    /// A tile of background.
    pub(super) fn new(origin: [usize; 2], background: [f32; 4]) -> Self {
        Self {
            origin,
            depth: vec![[0.0; 4]; TILE * TILE],
            light: vec![[[0.0; 3]; 4]; TILE * TILE],
            background,
            empty: {
                let [r, g, b, alpha] = background;
                let [r, g, b] = [r, g, b].map(crate::style::encode);
                let alpha = (255.0 * alpha).round() as u8;
                if alpha == 0 { [0; 4] } else { [r, g, b, alpha] }
            },
            encoder: Encoder::get(),
        }
    }

    /// The tile as if new, at another place.
    fn reset(&mut self, origin: [usize; 2]) {
        self.origin = origin;
        self.depth.fill([0.0; 4]);
    }

    /// Where a pixel of the picture stands in the tile.
    pub(super) fn index(&self, [x, y]: [usize; 2]) -> Option<usize> {
        let [left, top] = self.origin;
        let inside = (left..left + TILE).contains(&x) && (top..top + TILE).contains(&y);
        inside.then(|| (y - top) * TILE + x - left)
    }

    /// The depths of a pixel's samples; 0 where nothing is seen.
    pub(super) fn depth(&self, index: usize) -> [f32; 4] {
        self.depth[index]
    }

    /// The mean of a pixel's samples, sRGB; the pixel is the picture's.
    pub(super) fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        self.mean((y - self.origin[1]) * TILE + x - self.origin[0])
    }

    fn mean(&self, index: usize) -> [u8; 4] {
        let seen = self.depth[index].map(|depth| depth > 0.0);
        if seen == [false; 4] {
            return self.empty;
        }
        let [r, g, b, alpha] = self.background;
        let mut samples = self.light[index];
        for (sample, seen) in samples.iter_mut().zip(seen) {
            if !seen {
                *sample = [r, g, b];
            }
        }
        if alpha == 1.0 {
            let sum = |k: usize| samples.iter().map(|light| light[k]).sum::<f32>();
            let mean = |k: usize| self.encoder.encode(0.25 * sum(k));
            return [mean(0), mean(1), mean(2), 255];
        }
        let alphas = seen.map(|seen| if seen { 1.0 } else { alpha });
        let sum: f32 = alphas.iter().sum();
        if sum == 0.0 {
            return [0; 4];
        }
        let mean = |k: usize| {
            let weighted = samples.iter().zip(alphas).map(|(light, a)| a * light[k]);
            self.encoder.encode(weighted.sum::<f32>() / sum)
        };
        let alpha = (0.25 * 255.0 * sum).round() as u8;
        [mean(0), mean(1), mean(2), alpha]
    }
}

/// A mesh's triangles by tile.
struct Bins {
    /// Where each tile's triangles begin; one more entry than there are tiles.
    starts: Vec<u32>,
    /// The triangles whose box touches the tile, in order.
    triangles: Vec<u32>,
}

impl Bins {
    fn list(&self, tile: usize) -> &[u32] {
        &self.triangles[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}

/// Meshes that are drawn together, by tile.
pub(super) struct Batch<'a> {
    eye: &'a Eye,
    materials: &'a [Material<'a>],
    meshes: &'a [Mesh],
    /// For each mesh the number of its first triangle.
    bases: Vec<u32>,
    bins: Vec<Bins>,
    processor: Processor,
}

impl<'a> Batch<'a> {
    /// Meshes for `tiles` (across, down), of which the first begins at the picture's row `top`.
    pub(super) fn new(
        eye: &'a Eye,
        materials: &'a [Material<'a>],
        meshes: &'a [Mesh],
        [across, down]: [usize; 2],
        top: usize,
    ) -> Self {
        let mut bases = Vec::with_capacity(meshes.len());
        let mut total = 0;
        for mesh in meshes {
            bases.push(total);
            total += mesh.triangles.len() as u32;
        }
        let bins = meshes
            .par_iter()
            .map(|mesh| bin(mesh, across, down, top))
            .collect();
        Self {
            eye,
            materials,
            meshes,
            bases,
            bins,
            processor: Processor::here(),
        }
    }

    /// Draws into tiles that keep what was drawn before.
    pub(super) fn draw(&self, tiles: &mut [Tile]) {
        tiles
            .par_iter_mut()
            .enumerate()
            .for_each_init(nothing_seen, |seen, (number, tile)| {
                if !self.is_empty(number) {
                    self.draw_tile(number, tile, seen);
                }
            });
    }

    /// Draws the tile of a number, of which nothing else is kept: gives its pixels, or none if it is empty.
    pub(super) fn pixels(&self, number: usize, space: &mut Workspace) -> Option<Vec<[u8; 4]>> {
        if self.is_empty(number) {
            return None;
        }
        let Workspace {
            tile,
            seen,
            across,
            top,
        } = space;
        tile.reset([number % *across * TILE, *top + number / *across * TILE]);
        self.draw_tile(number, tile, seen);
        Some((0..TILE * TILE).map(|index| tile.mean(index)).collect())
    }

    fn is_empty(&self, number: usize) -> bool {
        self.bins.iter().all(|bin| bin.list(number).is_empty())
    }

    fn draw_tile(&self, number: usize, tile: &mut Tile, seen: &mut [[u32; 4]]) {
        let batch = self;
        self.processor.run(OneTile {
            batch,
            number,
            tile,
            seen,
        });
    }

    #[inline(always)]
    fn draw_here(&self, number: usize, tile: &mut Tile, seen: &mut [[u32; 4]]) {
        seen.fill([NONE; 4]);
        for ((mesh, bin), base) in self.meshes.iter().zip(&self.bins).zip(&self.bases) {
            for &triangle in bin.list(number) {
                let corners = mesh.triangles[triangle as usize].map(|c| &mesh.corners[c as usize]);
                cover(tile, seen, corners, base + triangle);
            }
        }
        self.shade(tile, seen);
    }

    /// Shades the samples that see a triangle of this batch.
    #[inline(always)]
    fn shade(&self, tile: &mut Tile, seen: &[[u32; 4]]) {
        let [r, g, b, _] = tile.background;
        // Neighbours see the same triangles: what is computed once a triangle is kept for some of them.
        let mut known: [Option<Facet>; FACETS] = std::array::from_fn(|_| None);
        for (index, ids) in seen.iter().enumerate() {
            let pixel = [tile.origin[0] + index % TILE, tile.origin[1] + index / TILE];
            for (first, &id) in ids.iter().enumerate() {
                if id == NONE || ids[..first].contains(&id) {
                    continue;
                }
                let sees = ids.map(|other| other == id);
                let count = sees.iter().filter(|&&sees| sees).count();
                let at = Vec2::from([0, 1].map(|k| {
                    let samples = SAMPLES.iter().zip(sees).filter(|(_, sees)| *sees);
                    let sum: i32 = samples.map(|(sample, _)| sample[k]).sum();
                    pixel[k] as f32 + sum as f32 / (count as i32 * SUBPIXEL) as f32
                }));
                let slot = &mut known[id as usize % FACETS];
                if slot.as_ref().is_none_or(|facet| facet.id != id) {
                    *slot = self.facet(id);
                }
                // No closure: what is called through one would not be compiled for this processor.
                let light = match slot {
                    Some(facet) => facet.material.shade(&place(self.eye, facet, at)),
                    None => [r, g, b],
                };
                for (sample, sees) in tile.light[index].iter_mut().zip(sees) {
                    if sees {
                        *sample = light;
                    }
                }
            }
        }
    }

    fn facet(&self, id: u32) -> Option<Facet<'_>> {
        let number = self.bases.partition_point(|&base| base <= id) - 1;
        let mesh = &self.meshes[number];
        let triangle = mesh.triangles[(id - self.bases[number]) as usize];
        let corners = triangle.map(|c| &mesh.corners[c as usize]);
        Some(Facet {
            id,
            edges: Edges::new(corners.map(|corner| corner.at))?,
            corners,
            material: &self.materials[mesh.material as usize],
        })
    }
}

/// One tile to be drawn, with the instructions that there are.
struct OneTile<'b, 'a> {
    batch: &'b Batch<'a>,
    number: usize,
    tile: &'b mut Tile,
    seen: &'b mut [[u32; 4]],
}

impl Work for OneTile<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.batch.draw_here(self.number, self.tile, self.seen);
    }
}

/// How many triangles are remembered while a tile is shaded.
const FACETS: usize = 64;

/// A triangle that is being shaded.
struct Facet<'a> {
    id: u32,
    edges: Edges,
    corners: [&'a Corner; 3],
    material: &'a Material<'a>,
}

/// What a thread draws one tile after the other in.
pub(super) struct Workspace {
    tile: Tile,
    seen: Vec<[u32; 4]>,
    across: usize,
    top: usize,
}

impl Workspace {
    /// For tiles that lie `across` to a row, from the picture's row `top` on.
    pub(super) fn new(background: [f32; 4], across: usize, top: usize) -> Self {
        Self {
            tile: Tile::new([0; 2], background),
            seen: nothing_seen(),
            across,
            top,
        }
    }
}

fn nothing_seen() -> Vec<[u32; 4]> {
    vec![[NONE; 4]; TILE * TILE]
}

fn bin(mesh: &Mesh, across: usize, down: usize, top: usize) -> Bins {
    let side = TILE as i32 * SUBPIXEL;
    let top = top as i32 * SUBPIXEL;
    let tiles = |triangle: &[u32; 3]| {
        let corners = triangle.map(|c| mesh.corners[c as usize].at);
        [(0, 0, across), (1, top, down)].map(|(k, start, tiles)| {
            let low = corners.iter().map(|at| at[k]).min().unwrap_or(0) - start;
            let high = corners.iter().map(|at| at[k]).max().unwrap_or(0) - start;
            low.div_euclid(side).max(0)..(high.div_euclid(side) + 1).min(tiles as i32)
        })
    };
    let each = |triangle: &[u32; 3], visit: &mut dyn FnMut(usize)| {
        let [columns, rows] = tiles(triangle);
        for y in rows {
            for x in columns.clone() {
                visit(y as usize * across + x as usize);
            }
        }
    };
    let mut starts = vec![0; across * down + 1];
    for triangle in &mesh.triangles {
        each(triangle, &mut |tile| starts[tile + 1] += 1);
    }
    for tile in 0..across * down {
        starts[tile + 1] += starts[tile];
    }
    let mut next = starts.clone();
    let mut triangles = vec![0; starts[across * down] as usize];
    for (number, triangle) in (0..).zip(&mesh.triangles) {
        each(triangle, &mut |tile| {
            triangles[next[tile] as usize] = number;
            next[tile] += 1;
        });
    }
    Bins { starts, triangles }
}

/// Edge functions of a triangle, its corners in the order that gives it a positive area:
/// `a·x + b·y + c ≥ 0` inside.
pub(super) struct Edges {
    a: [i64; 3],
    b: [i64; 3],
    c: [i64; 3],
    /// Twice the area, positive.
    area: i64,
    /// Whether the corners had to be taken in the opposite order.
    turned: bool,
}

impl Edges {
    /// None for a triangle without an area.
    #[inline(always)]
    pub(super) fn new(corners: [[i32; 2]; 3]) -> Option<Self> {
        let p = corners.map(|at| at.map(i64::from));
        let area =
            (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        if area == 0 {
            return None;
        }
        let sign = area.signum();
        let mut edges = Self {
            a: [0; 3],
            b: [0; 3],
            c: [0; 3],
            area: area.abs(),
            turned: sign < 0,
        };
        for k in 0..3 {
            // The edge opposite to corner k.
            let (from, to) = (p[(k + 1) % 3], p[(k + 2) % 3]);
            edges.a[k] = sign * (from[1] - to[1]);
            edges.b[k] = sign * (to[0] - from[0]);
            edges.c[k] = -(edges.a[k] * from[0] + edges.b[k] * from[1]);
        }
        Some(edges)
    }

    /// Barycentric coordinates of a place, which may lie beside the triangle.
    pub(super) fn weights(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|k| {
            (self.a[k] as f64 * x + self.b[k] as f64 * y + self.c[k] as f64) / self.area as f64
        })
    }

    #[inline(always)]
    fn at(&self, k: usize, x: i64, y: i64) -> i64 {
        self.a[k] * x + self.b[k] * y + self.c[k]
    }

    /// 0, or −1 for an edge whose own samples belong to the neighbour (top-left rule).
    #[inline(always)]
    fn bias(&self, k: usize) -> i64 {
        let top_left = self.a[k] > 0 || (self.a[k] == 0 && self.b[k] > 0);
        if top_left { 0 } else { -1 }
    }
}

/// Lets a triangle be seen by the samples that it covers in front of all before.
#[inline(always)]
pub(super) fn cover(tile: &mut Tile, seen: &mut [[u32; 4]], corners: [&Corner; 3], id: u32) {
    let at = corners.map(|corner| corner.at);
    let Some(edges) = Edges::new(at) else {
        return;
    };
    let origin = tile.origin.map(|pixel| pixel as i32 * SUBPIXEL);
    // The pixels of the triangle's box in the tile.
    let span = |k: usize| {
        let low = at[0][k].min(at[1][k]).min(at[2][k]) - origin[k];
        let high = at[0][k].max(at[1][k]).max(at[2][k]) - origin[k];
        let first = low.div_euclid(SUBPIXEL).clamp(0, TILE as i32);
        let last = (high.div_euclid(SUBPIXEL) + 1).clamp(0, TILE as i32);
        (first as usize, last as usize)
    };
    let ((x0, x1), (y0, y1)) = (span(0), span(1));
    if x0 >= x1 || y0 >= y1 {
        return;
    }
    let left = i64::from(origin[0]) + x0 as i64 * i64::from(SUBPIXEL);
    let upper = i64::from(origin[1]) + y0 as i64 * i64::from(SUBPIXEL);
    let step = i64::from(SUBPIXEL);
    let (width, height) = ((x1 - x0) as i64 * step, (y1 - y0) as i64 * step);
    let mut offsets = [[0; 4]; 3];
    let mut starts = [0; 3];
    for k in 0..3 {
        // Wholly outside of one edge?
        let best =
            edges.at(k, left, upper) + (edges.a[k].max(0)) * width + (edges.b[k].max(0)) * height;
        if best < 0 {
            return;
        }
        starts[k] = edges.at(k, left, upper) + edges.bias(k);
        offsets[k] = SAMPLES.map(|[x, y]| edges.a[k] * i64::from(x) + edges.b[k] * i64::from(y));
    }
    // Depth is affine over the picture.
    let depths = corners.map(|corner| f64::from(corner.depth));
    let area = edges.area as f64;
    let slope = |coefficients: &[i64; 3]| -> f64 {
        (0..3)
            .map(|k| coefficients[k] as f64 * depths[k])
            .sum::<f64>()
            / area
    };
    let (dx, dy) = (slope(&edges.a), slope(&edges.b));
    let start: f64 = (0..3)
        .map(|k| edges.at(k, left, upper) as f64 * depths[k])
        .sum::<f64>()
        / area;
    let low = depths[0].min(depths[1]).min(depths[2]) as f32;
    let high = depths[0].max(depths[1]).max(depths[2]) as f32;
    let sample_depth = SAMPLES.map(|[x, y]| (dx * f64::from(x) + dy * f64::from(y)) as f32);
    let (pixel_dx, pixel_dy) = (dx * step as f64, dy * step as f64);
    for y in y0..y1 {
        let row = (y - y0) as i64 * step;
        let mut e: [i64; 3] = std::array::from_fn(|k| starts[k] + edges.b[k] * row);
        let row_depth = start + pixel_dy * (y - y0) as f64;
        for x in x0..x1 {
            let index = y * TILE + x;
            let mut depth = None;
            for s in 0..4 {
                let inside =
                    (e[0] + offsets[0][s]) | (e[1] + offsets[1][s]) | (e[2] + offsets[2][s]);
                if inside >= 0 {
                    let depth = *depth
                        .get_or_insert_with(|| (row_depth + pixel_dx * (x - x0) as f64) as f32);
                    let depth = (depth + sample_depth[s]).clamp(low, high);
                    if depth > tile.depth[index][s] {
                        tile.depth[index][s] = depth;
                        seen[index][s] = id;
                    }
                }
            }
            for (value, slope) in e.iter_mut().zip(&edges.a) {
                *value += slope * step;
            }
        }
    }
}

/// Interpolates perspective-correctly.
#[inline(always)]
fn place(eye: &Eye, facet: &Facet, at: Vec2) -> Place {
    let Facet {
        edges,
        corners,
        material,
        ..
    } = facet;
    let area = edges.area as f64;
    // Weights at a place of the picture, over w.
    let weights = |at: Vec2| -> Vec3 {
        let (x, y) = (
            f64::from(at.x) * f64::from(SUBPIXEL),
            f64::from(at.y) * f64::from(SUBPIXEL),
        );
        let weight = |k: usize| {
            let value = edges.a[k] as f64 * x + edges.b[k] as f64 * y + edges.c[k] as f64;
            (value / area) as f32 * corners[k].inv_w
        };
        Vec3::new(weight(0), weight(1), weight(2))
    };
    let uv = |weights: Vec3| {
        let sum = weights.element_sum();
        let weighted =
            corners[0].uv * weights.x + corners[1].uv * weights.y + corners[2].uv * weights.z;
        weighted / sum
    };
    let here = weights(at);
    let uv_here = uv(here);
    let footprint = if material.is_surface() {
        [Vec2::X, Vec2::Y].map(|step| uv(weights(at + step)) - uv_here)
    } else {
        [Vec2::ZERO; 2]
    };
    let normal =
        corners[0].normal * here.x + corners[1].normal * here.y + corners[2].normal * here.z;
    let ndc = Vec2::new(2.0 * at.x / eye.size.x - 1.0, 1.0 - 2.0 * at.y / eye.size.y);
    let to_eye = (-ndc / eye.zoom).extend(1.0).normalize();
    // Pixels' y runs down: what is counterclockwise as seen has a negative area in them.
    Place {
        normal,
        uv: uv_here,
        footprint,
        to_eye,
        front: edges.turned,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small generator (Knuth's constants): the same places on every run.
    fn next(state: &mut u64) -> i32 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 33) as i32
    }

    #[test]
    fn triangles_that_tile_a_square_cover_every_sample_exactly_once() {
        // A 9 × 9 lattice of corners, the inner ones jittered, with both diagonals and both directions of turn.
        let step = 5 * SUBPIXEL;
        let mut state = 7;
        let corners: Vec<[i32; 2]> = (0..81)
            .map(|k| {
                let mut place = |n: i32| {
                    let jitter = if (1..8).contains(&n) {
                        next(&mut state) % (step / 5)
                    } else {
                        0
                    };
                    // Steps of 1/8 pixel: edges that run through samples are the hard case of the fill rule.
                    (n * step + jitter) / 32 * 32
                };
                [place(k % 9), place(k / 9)]
            })
            .collect();
        let mut edges = Vec::new();
        for j in 0..8 {
            for i in 0..8 {
                let [a, b, c, d] = [j * 9 + i, j * 9 + i + 1, j * 9 + i + 10, j * 9 + i + 9];
                let pair = if (i + j) % 2 == 0 {
                    [[a, b, c], [a, d, c]]
                } else {
                    [[a, b, d], [b, d, c]]
                };
                edges.extend(
                    pair.iter()
                        .filter_map(|t| Edges::new(t.map(|k| corners[k]))),
                );
            }
        }
        assert_eq!(edges.len(), 128);
        for y in 0..40 {
            for x in 0..40 {
                for [sx, sy] in SAMPLES {
                    let (px, py) = (i64::from(x * SUBPIXEL + sx), i64::from(y * SUBPIXEL + sy));
                    let inside =
                        |edges: &&Edges| (0..3).all(|k| edges.at(k, px, py) + edges.bias(k) >= 0);
                    assert_eq!(
                        edges.iter().filter(inside).count(),
                        1,
                        "sample at ({x}, {y})"
                    );
                }
            }
        }
    }
}
