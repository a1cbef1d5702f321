//! The samples that a triangle covers: exact edge functions (J. Pineda, "A parallel algorithm for polygon rasterization",
//! 1988), evaluated over a tile eight pixels at a time.

use std::ops::{Add, BitOr, Mul};

use super::tile::{GROUP, LANES, Layer, TILE, Tile};
use super::{Corner, SAMPLES, SUBPIXEL};

/// The slope of an edge, |a| + |b|, below which its values in a tile fit 32 bits wherever it crosses the tile.
const NARROW: i64 = 1 << 16;

/// The edge functions of a triangle, whose corners are ordered so that its area is positive: `a·x + b·y + c ≥ 0` inside.
pub(in crate::software) struct Edges {
    a: [i64; 3],
    b: [i64; 3],
    c: [i64; 3],
    /// Twice the area, positive.
    area: i64,
    turned: bool,
}

impl Edges {
    /// Returns the edge functions; `None` for a triangle without an area.
    #[inline(always)]
    pub(in crate::software) fn new(corners: [[i32; 2]; 3]) -> Option<Self> {
        let p = corners.map(|at| at.map(i64::from));
        let area = area(corners);
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

    /// Returns barycentric coordinates of a position, which may be outside the triangle.
    pub(in crate::software) fn weights(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        std::array::from_fn(|k| {
            (self.a[k] as f64 * x + self.b[k] as f64 * y + self.c[k] as f64) / self.area as f64
        })
    }

    /// Returns the changes of the weights of the second and third corner from pixel to pixel, to the right and down.
    pub(in crate::software) fn gradients(&self) -> [[f32; 2]; 2] {
        let scale = f64::from(SUBPIXEL) / self.area as f64;
        [&self.a, &self.b].map(|slope| [1, 2].map(|k| (slope[k] as f64 * scale) as f32))
    }

    /// Returns true if the order of the corners was reversed: they run counterclockwise as seen, since the y of pixels
    /// points down.
    pub(in crate::software) fn turned(&self) -> bool {
        self.turned
    }

    /// Returns true if it is nowhere narrower than a pixel except at its corners.
    pub(super) fn is_wide(&self) -> bool {
        let square = |k: usize| (self.a[k] as f64).powi(2) + (self.b[k] as f64).powi(2);
        let longest = square(0).max(square(1)).max(square(2));
        (self.area as f64).powi(2) >= longest * f64::from(SUBPIXEL).powi(2)
    }

    #[inline(always)]
    fn at(&self, k: usize, x: i64, y: i64) -> i64 {
        self.a[k] * x + self.b[k] * y + self.c[k]
    }

    /// Returns 0, or −1 for an edge whose samples belong to the neighbour (top-left rule).
    #[inline(always)]
    fn bias(&self, k: usize) -> i64 {
        let top_left = self.a[k] > 0 || (self.a[k] == 0 && self.b[k] > 0);
        if top_left { 0 } else { -1 }
    }
}

/// Returns twice a triangle's area; negative if its corners run counterclockwise as seen (y points down).
#[inline(always)]
pub(super) fn area(corners: [[i32; 2]; 3]) -> i64 {
    let [p, q, r] = corners.map(|at| at.map(i64::from));
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// Marks the samples that a triangle covers in front of all previous ones as seeing it.
#[inline(always)]
pub(in crate::software) fn cover(
    tile: &mut Tile,
    layer: &mut Layer,
    corners: [&Corner; 3],
    id: u32,
) {
    let at = corners.map(|corner| corner.at);
    let Some(edges) = Edges::new(at) else {
        return;
    };
    let origin = tile.origin().map(|pixel| pixel as i32 * SUBPIXEL);
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
    let (x0, x1) = (x0 / LANES * LANES, x1.next_multiple_of(LANES));
    let step = i64::from(SUBPIXEL);
    let left = i64::from(origin[0]) + x0 as i64 * step;
    let upper = i64::from(origin[1]) + y0 as i64 * step;
    let (width, height) = ((x1 - x0) as i64 * step, (y1 - y0) as i64 * step);
    // An edge with all of these pixels on its inner side need not be tested.
    let mut crossing = [Edge::default(); 3];
    let mut narrow = true;
    for (k, edge) in crossing.iter_mut().enumerate() {
        let (a, b) = (edges.a[k], edges.b[k]);
        let start = edges.at(k, left, upper) + edges.bias(k);
        if start + a.max(0) * width + b.max(0) * height < 0 {
            return;
        }
        if start + a.min(0) * width + b.min(0) * height < 0 {
            *edge = Edge { a, b, start };
            narrow &= a.abs() + b.abs() < NARROW;
        }
    }
    // Depth is affine over the picture.
    let depths = corners.map(|corner| f64::from(corner.depth));
    let inverse = 1.0 / edges.area as f64;
    let rise = [1, 2].map(|k| depths[k] - depths[0]);
    let slope = |of: &[i64; 3]| (of[1] as f64 * rise[0] + of[2] as f64 * rise[1]) * inverse;
    let (dx, dy) = (slope(&edges.a), slope(&edges.b));
    let first = [left, upper].map(|x| x as f64);
    let corner = at[0].map(f64::from);
    let (across, along) = (dx as f32, dy as f32);
    let plane = Plane {
        start: depths[0] + dx * (first[0] - corner[0]) + dy * (first[1] - corner[1]),
        slope: [dx, dy].map(|slope| slope * step as f64),
        samples: {
            let mut samples = [0.0; GROUP];
            for (k, sample) in samples.iter_mut().enumerate() {
                *sample = across * PLACES[0][k] as f32 + along * PLACES[1][k] as f32;
            }
            samples
        },
        low: depths[0].min(depths[1]).min(depths[2]) as f32,
        high: depths[0].max(depths[1]).max(depths[2]) as f32,
    };
    let pixels = [[x0, x1], [y0, y1]];
    if narrow {
        let run = Run::<i32>::new(&crossing);
        walk(tile, layer, pixels, &run, &plane, id);
    } else {
        let run = Run::<i64>::new(&crossing);
        walk(tile, layer, pixels, &run, &plane, id);
    }
}

/// An edge function relative to the top left of the pixels in question; zero if it need not be tested.
#[derive(Clone, Copy, Default)]
struct Edge {
    a: i64,
    b: i64,
    start: i64,
}

/// Depth as an affine function over the picture.
struct Plane {
    /// The value at the top left of the pixels in question.
    start: f64,
    /// The change from pixel to pixel, to the right and down.
    slope: [f64; 2],
    /// The change from the top left of a group of pixels to each of its samples.
    samples: [f32; GROUP],
    /// The bounds of the depth, against rounding.
    low: f32,
    high: f32,
}

/// Edge functions during stepping, in integers that hold them.
struct Run<I> {
    start: [I; 3],
    /// The change from one pixel to the next one down.
    down: [I; 3],
    /// The change from one group of pixels to the next one to the right.
    along: [I; 3],
    /// The change from the top left of a group to each of its samples.
    samples: [[I; GROUP]; 3],
    /// The change from the top left of a group to the point of the group where the edge function is largest.
    reach: [I; 3],
}

/// Integers in which edge functions are computed.
trait Whole:
    Copy + Default + PartialOrd + Add<Output = Self> + Mul<Output = Self> + BitOr<Output = Self>
{
    fn new(number: i64) -> Self;
}

impl Whole for i32 {
    #[inline(always)]
    fn new(number: i64) -> Self {
        number as Self
    }
}

impl Whole for i64 {
    #[inline(always)]
    fn new(number: i64) -> Self {
        number
    }
}

/// The position of each sample of a group, in subpixels from the group's top left.
const PLACES: [[i32; GROUP]; 2] = {
    let mut places = [[0; GROUP]; 2];
    let mut k = 0;
    while k < GROUP {
        let [x, y] = SAMPLES[k / LANES];
        places[0][k] = x + (k % LANES) as i32 * SUBPIXEL;
        places[1][k] = y;
        k += 1;
    }
    places
};

impl<I: Whole> Run<I> {
    #[inline(always)]
    fn new(edges: &[Edge; 3]) -> Self {
        let step = I::new(i64::from(SUBPIXEL));
        let wide = I::new(i64::from(SUBPIXEL) * LANES as i64);
        let mut run = Self {
            start: [I::default(); 3],
            down: [I::default(); 3],
            along: [I::default(); 3],
            samples: [[I::default(); GROUP]; 3],
            reach: [I::default(); 3],
        };
        for (k, edge) in edges.iter().enumerate() {
            let (a, b) = (I::new(edge.a), I::new(edge.b));
            run.start[k] = I::new(edge.start);
            run.down[k] = b * step;
            run.along[k] = a * wide;
            run.reach[k] = I::new(edge.a.max(0)) * wide + I::new(edge.b.max(0)) * step;
            for ((sample, x), y) in run.samples[k].iter_mut().zip(PLACES[0]).zip(PLACES[1]) {
                *sample = a * I::new(i64::from(x)) + b * I::new(i64::from(y));
            }
        }
        run
    }
}

#[inline(always)]
fn walk<I: Whole>(
    tile: &mut Tile,
    layer: &mut Layer,
    [[x0, x1], [y0, y1]]: [[usize; 2]; 2],
    run: &Run<I>,
    plane: &Plane,
    id: u32,
) {
    let zero = I::default();
    let mut down = run.start;
    for y in y0..y1 {
        let mut e = down;
        down = add(down, run.down);
        let depth = plane.start + plane.slope[1] * (y - y0) as f64;
        let mut touched = [x1, x0];
        for x in (x0..x1).step_by(LANES) {
            let here = e;
            e = add(e, run.along);
            let [a, b, c] = add(here, run.reach);
            if (a < zero) | (b < zero) | (c < zero) {
                continue;
            }
            touched = [touched[0].min(x), x + LANES];
            let base = (depth + plane.slope[0] * (x - x0) as f64) as f32;
            let first = GROUP / LANES * (y * TILE + x);
            let depths = tile.depth[first..].first_chunk_mut::<GROUP>();
            let ids = layer.ids[first..].first_chunk_mut::<GROUP>();
            if let (Some(depths), Some(ids)) = (depths, ids) {
                see(depths, ids, here, &run.samples, base, plane, id);
            }
        }
        layer.rows.extend(y, touched);
    }
}

/// Tests one group of pixels. It is one plain loop over separate arrays, so that the compiler vectorises it.
#[inline(always)]
fn see<I: Whole>(
    depths: &mut [f32; GROUP],
    ids: &mut [u32; GROUP],
    [a, b, c]: [I; 3],
    samples: &[[I; GROUP]; 3],
    base: f32,
    plane: &Plane,
    id: u32,
) {
    let (low, high) = (plane.low, plane.high);
    for k in 0..GROUP {
        let inside = (a + samples[0][k]) | (b + samples[1][k]) | (c + samples[2][k]);
        let depth = base + plane.samples[k];
        let depth = if depth > low { depth } else { low };
        let depth = if depth < high { depth } else { high };
        let sees = (inside >= I::default()) & (depth > depths[k]);
        depths[k] = if sees { depth } else { depths[k] };
        ids[k] = if sees { id } else { ids[k] };
    }
}

#[inline(always)]
fn add<I: Whole>(a: [I; 3], b: [I; 3]) -> [I; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::software::raster::tile::AREA;
    use glam::{Vec2, Vec3};

    /// A small generator (Knuth's constants): the same positions on every run.
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

    #[test]
    fn a_sample_is_covered_where_its_edge_functions_say_so_however_large_the_triangle() {
        let mut state = 11;
        for reach in [4, 60, 700, 20_000] {
            let mut covered = 0;
            for _ in 0..60 {
                let mut place =
                    || next(&mut state) % (reach * SUBPIXEL) - (reach / 2 - 32) * SUBPIXEL;
                let at: [[i32; 2]; 3] = std::array::from_fn(|_| [place(), place()]);
                let Some(edges) = Edges::new(at) else {
                    continue;
                };
                let corners = at.map(|at| Corner {
                    at,
                    depth: 0.5,
                    inv_w: 1.0,
                    normal: Vec3::Z,
                    uv: Vec2::ZERO,
                });
                let mut tile = Tile::new([0; 2], [0.0; 4]);
                let mut layer = Layer::new();
                cover(&mut tile, &mut layer, corners.each_ref(), 5);
                for index in 0..AREA {
                    for (s, [x, y]) in SAMPLES.into_iter().enumerate() {
                        let px = (index % TILE) as i64 * i64::from(SUBPIXEL) + i64::from(x);
                        let py = (index / TILE) as i64 * i64::from(SUBPIXEL) + i64::from(y);
                        let inside = (0..3).all(|k| edges.at(k, px, py) + edges.bias(k) >= 0);
                        assert_eq!(layer.seen(index)[s] == 5, inside, "{at:?}, {index}, {s}");
                        covered += u32::from(inside);
                    }
                }
            }
            assert!(covered > 100, "{covered} samples, {reach}");
        }
    }
}
