//! Rasterisation: meshes into tiles, four samples a pixel, depth, and shading of visible triangles.
//!
//! ```text
//! meshes ──bins.rs──▶ triangles of a tile ──edges.rs──▶ which triangle each sample sees (tile.rs)
//!        ──fragments, one for each triangle that a pixel sees──shade.rs──▶ light (tile.rs) ──▶ pixels
//! ```
//!
//! Positions are fixed-point and the fill rule is top-left, so that triangles with a common edge leave no gap and cover no
//! sample twice. A tile first determines which triangle each sample sees, then shades each triangle once per pixel, at the
//! centre of the samples that see it: no hidden point is shaded, and none outside its triangle. Only if flat neighbours of
//! one surface share a pixel, the largest one is shaded for all of them.

mod bins;
mod edges;
mod tile;

use expr::processor::{Processor, Work};
use rayon::prelude::*;

use super::mesh::{Corner, Eye, Mesh, SUBPIXEL};
use super::shade::{Fragments, Material, Planes};
use crate::solids::SolidPainter;
use bins::Bins;

pub(super) use edges::{Edges, cover};
use tile::{LANES, NONE};
pub(super) use tile::{Layer, TILE, Tile};

/// The samples of a pixel, in 1/256 pixel from its top left: a rotated grid, that of the GPU's standard pattern.
pub(super) const SAMPLES: [[i32; 2]; 4] = [[96, 32], [224, 96], [32, 160], [160, 224]];

/// Meshes that are drawn together, by tile.
pub(super) struct Batch<'a> {
    eye: &'a Eye,
    materials: &'a [Material<'a>],
    meshes: &'a [Mesh],
    /// The number of each mesh's first triangle.
    bases: Vec<u32>,
    bins: Vec<Bins>,
    processor: Processor,
}

impl<'a> Batch<'a> {
    /// Creates a batch of meshes for `tiles` (across, down), the first of which begins at row `top` of the picture.
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
            .map(|mesh| Bins::new(mesh, across, down, top))
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

    /// Draws into tiles; their previous contents stay.
    pub(super) fn draw(&self, tiles: &mut [Tile]) {
        tiles
            .par_iter_mut()
            .enumerate()
            .for_each_init(Tools::new, |tools, (number, tile)| {
                if !self.is_empty(number) {
                    self.processor.run(OneTile {
                        batch: self,
                        number,
                        tile,
                        tools,
                    });
                }
            });
    }

    /// Draws a tile of which nothing else is kept, beginning with the visible solids. Returns its pixels, or `None` if it is
    /// empty.
    pub(super) fn pixels(
        &self,
        number: usize,
        space: &mut Workspace,
        solids: Option<&SolidPainter<'_>>,
    ) -> Option<Vec<[u8; 4]>> {
        let Workspace {
            tile,
            tools,
            across,
            top,
        } = space;
        let origin = [number % *across * TILE, *top + number / *across * TILE];
        let solids = solids.and_then(|solids| solids.tile(origin));
        if solids.is_none() && self.is_empty(number) {
            return None;
        }
        tile.reset(origin);
        if let Some(solids) = solids {
            tile.begin(&solids);
        }
        self.processor.run(OneTile {
            batch: self,
            number,
            tile,
            tools,
        });
        Some(self.processor.run(Means(tile)))
    }

    fn is_empty(&self, number: usize) -> bool {
        self.bins.iter().all(|bin| bin.list(number).is_empty())
    }

    #[inline(always)]
    fn draw_here(&self, number: usize, tile: &mut Tile, tools: &mut Tools) {
        tools.layer.clear();
        for ((mesh, bin), base) in self.meshes.iter().zip(&self.bins).zip(&self.bases) {
            for &triangle in bin.list(number) {
                let corners = mesh.triangles[triangle as usize].map(|c| &mesh.corners[c as usize]);
                cover(tile, &mut tools.layer, corners, base + triangle);
            }
        }
        tile.touch(&tools.layer.rows);
        self.shade(tile, tools);
    }

    /// Shades the samples that see a triangle of this batch.
    #[inline(always)]
    fn shade(&self, tile: &mut Tile, tools: &mut Tools) {
        let [left, top] = tile.origin();
        for (y, row) in tools.layer.rows.each() {
            for x in row.step_by(LANES) {
                let group = *tools.layer.group(y * TILE + x);
                // Most groups beside the scene see nothing, and most pixels inside it see one triangle.
                if group.iter().fold(NONE, |all, id| all & id) == NONE {
                    continue;
                }
                let mut differ = [0; LANES];
                for k in 0..LANES {
                    let [a, b, c, d] = [0, 1, 2, 3].map(|s| group[s * LANES + k]);
                    differ[k] = (a ^ b) | (a ^ c) | (a ^ d);
                }
                for k in 0..LANES {
                    let id = group[k];
                    let pixel = Pixel {
                        index: (y * TILE + x + k) as u16,
                        corner: [(left + x + k) as f32, (top + y) as f32],
                    };
                    if differ[k] != 0 {
                        let ids = [0, 1, 2, 3].map(|s| group[s * LANES + k]);
                        self.parts(tools, tile, &pixel, ids);
                    } else if id != NONE {
                        self.part(tools, tile, &pixel, id, 0b1111);
                    }
                }
            }
        }
        for waiting in &mut tools.waiting {
            self.settle(waiting, tile);
        }
    }

    /// Shades the samples of a pixel that do not all see one triangle.
    #[inline(always)]
    fn parts(&self, tools: &mut Tools, tile: &mut Tile, pixel: &Pixel, ids: [u32; 4]) {
        let mut open = mask(ids.map(|id| id != NONE));
        while open != 0 {
            let id = ids[dominant(ids, open)];
            let mut sees = mask(ids.map(|other| other == id));
            if sees != open
                && let Some(facet) = tools.facets.get(self, id)
                && facet.wide
            {
                for (s, &other) in ids.iter().enumerate() {
                    let bit = 1 << s;
                    if open & !sees & bit != 0 && self.goes_on(facet, other) {
                        sees |= bit;
                    }
                }
            }
            open &= !sees;
            self.part(tools, tile, pixel, id, sees);
        }
    }

    /// Shades a triangle for some samples of a pixel.
    #[inline(always)]
    fn part(&self, tools: &mut Tools, tile: &mut Tile, pixel: &Pixel, id: u32, sees: u8) {
        let Tools {
            facets, waiting, ..
        } = tools;
        let Some(facet) = facets.get(self, id) else {
            return;
        };
        let waiting = &mut waiting[facet.material as usize % QUEUES];
        if waiting.fragments.is_full() || facet.material != waiting.material {
            self.settle(waiting, tile);
            waiting.material = facet.material;
        }
        let (corner, middle) = (pixel.corner, MIDDLES[usize::from(sees)]);
        let at = [corner[0] + middle[0], corner[1] + middle[1]];
        let to = [pixel.index, sees.into()];
        waiting.fragments.push(&facet.planes, at, to);
    }

    /// Lights the samples of the waiting fragments.
    #[inline(never)]
    fn settle(&self, waiting: &mut Queue, tile: &mut Tile) {
        if let Some(material) = self.materials.get(waiting.material as usize) {
            self.processor.run(Settle {
                material,
                eye: self.eye,
                fragments: &mut waiting.fragments,
                tile,
            });
        }
    }

    /// Returns the mesh of a triangle, and its number there.
    fn find(&self, id: u32) -> (usize, u32) {
        let mesh = self.bases.partition_point(|&base| base <= id) - 1;
        (mesh, id - self.bases[mesh])
    }

    fn facet(&self, id: u32) -> Option<Facet> {
        let (mesh, triangle) = self.find(id);
        let Mesh {
            corners,
            triangles,
            material,
        } = &self.meshes[mesh];
        let ids = triangles[triangle as usize];
        let corners = ids.map(|c| &corners[c as usize]);
        let edges = Edges::new(corners.map(|corner| corner.at))?;
        let is_surface = self.materials[*material as usize].is_surface();
        Some(Facet {
            id,
            mesh: mesh as u32,
            material: *material,
            corners: ids,
            front: edges.turned(),
            wide: is_surface && edges.is_wide(),
            planes: Planes::new(&edges, corners),
        })
    }

    /// Returns true if a triangle continues a surface beyond another one: they share a corner, and the same side is visible.
    #[inline(always)]
    fn goes_on(&self, from: &Facet, id: u32) -> bool {
        let mesh = &self.meshes[from.mesh as usize];
        let number = id.wrapping_sub(self.bases[from.mesh as usize]);
        let Some(triangle) = mesh.triangles.get(number as usize) else {
            return false;
        };
        if !triangle.iter().any(|corner| from.corners.contains(corner)) {
            return false;
        }
        let at = triangle.map(|corner| mesh.corners[corner as usize].at);
        (edges::area(at) < 0) == from.front
    }
}

/// A task that draws one tile, with any set of instructions.
struct OneTile<'b, 'a> {
    batch: &'b Batch<'a>,
    number: usize,
    tile: &'b mut Tile,
    tools: &'b mut Tools,
}

impl Work for OneTile<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.batch.draw_here(self.number, self.tile, self.tools);
    }
}

/// A task that lights fragments of one material.
struct Settle<'b> {
    material: &'b Material<'b>,
    eye: &'b Eye,
    fragments: &'b mut Fragments,
    tile: &'b mut Tile,
}

impl Work for Settle<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        self.fragments.shade(self.material, self.eye);
        for number in 0..self.fragments.count() {
            let ([index, samples], light) = self.fragments.lit(number);
            self.tile.put(usize::from(index), samples as u8, light);
        }
        self.fragments.clear();
    }
}

/// A pixel that is being shaded.
struct Pixel {
    /// The index in its tile.
    index: u16,
    /// Its top left corner in the picture, in pixels.
    corner: [f32; 2],
}

/// A task that converts a tile to pixels.
struct Means<'b>(&'b Tile);

impl Work for Means<'_> {
    type Output = Vec<[u8; 4]>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        self.0.pixels()
    }
}

/// The number of cached triangles during the shading of a batch, a power of two.
const FACETS: usize = 256;

/// A triangle that is being shaded.
struct Facet {
    id: u32,
    mesh: u32,
    material: u32,
    /// The corners in its mesh.
    corners: [u32; 3],
    /// True if it runs counterclockwise as seen.
    front: bool,
    /// True for a surface's triangle that is nowhere much narrower than a pixel: a point half a pixel beside it is still
    /// near.
    wide: bool,
    planes: Planes,
}

/// Recently shaded triangles: neighbouring pixels see the same ones.
struct Facets(Vec<Option<Facet>>);

impl Facets {
    #[inline(always)]
    fn get(&mut self, batch: &Batch, id: u32) -> Option<&Facet> {
        let slot = &mut self.0[id as usize % FACETS];
        if slot.as_ref().is_none_or(|facet| facet.id != id) {
            *slot = batch.facet(id);
        }
        slot.as_ref()
    }
}

/// The number of queues, a power of two. Lines over a surface change the material every few pixels: with separate queues,
/// fragments still fill whole vectors.
const QUEUES: usize = 4;

/// Fragments that wait to be lit together. Each sample is lit once, so that the order in which queues are emptied does not
/// matter.
#[derive(Default)]
struct Queue {
    fragments: Box<Fragments>,
    /// Their material.
    material: u32,
}

/// The buffers with which a thread draws the tiles of one batch.
struct Tools {
    layer: Layer,
    facets: Facets,
    /// The queue of a material is that of its number modulo [`QUEUES`].
    waiting: [Queue; QUEUES],
}

impl Tools {
    fn new() -> Self {
        Self {
            layer: Layer::new(),
            facets: Facets(std::iter::repeat_with(|| None).take(FACETS).collect()),
            waiting: Default::default(),
        }
    }
}

/// The buffers in which a thread draws one tile after another.
pub(super) struct Workspace {
    tile: Tile,
    tools: Tools,
    across: usize,
    top: usize,
}

impl Workspace {
    /// Creates buffers for tiles, `across` in a row, starting at row `top` of the picture.
    pub(super) fn new(background: [f32; 4], across: usize, top: usize) -> Self {
        Self {
            tile: Tile::new([0; 2], background),
            tools: Tools::new(),
            across,
            top,
        }
    }
}

/// Returns a bit for each sample.
#[inline(always)]
fn mask(samples: [bool; 4]) -> u8 {
    let [a, b, c, d] = samples.map(u8::from);
    a | b << 1 | c << 2 | d << 3
}

/// Returns the first of the samples in `open` with the most frequent triangle.
#[inline(always)]
fn dominant(ids: [u32; 4], open: u8) -> usize {
    // The larger number has more samples with its triangle, or comes first. A sample that is not open counts nothing.
    let mut best = 0;
    for (s, &id) in ids.iter().enumerate() {
        let mut count = 0;
        for &other in &ids {
            count += usize::from(other == id);
        }
        let is_open = usize::from(open >> s & 1);
        best = best.max(is_open * (4 * count + 3 - s));
    }
    3 - best % 4
}

/// The centre of each set of samples, in pixels from the pixel's top left.
const MIDDLES: [[f32; 2]; 16] = {
    let mut middles = [[0.5; 2]; 16];
    let mut set = 1;
    while set < 16 {
        let mut k = 0;
        while k < 2 {
            let (mut sum, mut count, mut s) = (0, 0, 0);
            while s < 4 {
                if set >> s & 1 == 1 {
                    sum += SAMPLES[s][k];
                    count += 1;
                }
                s += 1;
            }
            middles[set][k] = sum as f32 / (count * SUBPIXEL) as f32;
            k += 1;
        }
        set += 1;
    }
    middles
};
