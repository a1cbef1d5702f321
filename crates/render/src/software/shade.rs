//! The colours of points on triangles.
//!
//! In: triangles with their interpolated quantities ([`Planes`]), and the points to be shaded. Out: light. Points wait until
//! there are many ([`Fragments`]), so that branch-free code processes several at once.

use glam::Vec3;

use super::mesh::{Corner, Eye, SUBPIXEL};
use super::raster::{Edges, TILE};
use crate::style;
use crate::texture::{Sampler, threshold};

/// The appearance of triangles of one kind of one object.
#[derive(Clone, Debug)]
pub(super) struct Material<'a> {
    pub kind: MaterialKind<'a>,
    /// The colour in linear light.
    pub colour: [f32; 3],
    /// The fraction of [`style::EMPHASIS_COLOUR`] that is mixed in.
    pub emphasis: f32,
}

/// The kind of lighting of triangles.
#[derive(Clone, Debug)]
pub(super) enum MaterialKind<'a> {
    /// A strip or disc that faces the eye: its texture coordinates are the position in the unit disc.
    Glyph,
    /// An arrowhead.
    Cone,
    /// A surface.
    Surface(Sampler<'a>),
}

impl Material<'_> {
    pub(super) fn is_surface(&self) -> bool {
        matches!(self.kind, MaterialKind::Surface(_))
    }
}

/// The quantities that are interpolated on a triangle, divided by the distance: all of them are then affine over the
/// picture.
pub(super) struct Planes {
    /// The position in the picture, in pixels, of the values in `here`.
    origin: [f32; 2],
    here: [f32; PLANES],
    /// The changes from pixel to pixel, to the right and down.
    slopes: [[f32; PLANES]; 2],
    /// 1 if the front is seen, otherwise −1.
    side: f32,
}

/// The number of interpolated values, and one constant.
const PLANES: usize = 8;
/// Texture coordinates.
const UV: [usize; 2] = [0, 1];
/// 1 over the distance.
const INVERSE: usize = 2;
/// Normals.
const NORMAL: [usize; 3] = [3, 4, 5];
/// The smallest of 1 over the corners' distances.
const LEAST: usize = 6;

impl Planes {
    /// Returns the planes of a triangle with an area.
    pub(super) fn new(edges: &Edges, corners: [&Corner; 3]) -> Self {
        let values = corners.map(|corner| {
            let w = corner.inv_w;
            let (uv, n) = (corner.uv * w, corner.normal * w);
            [uv.x, uv.y, w, n.x, n.y, n.z, 0.0, 0.0]
        });
        let [[ax, bx], [ay, by]] = edges.gradients();
        let [p, q, r] = values;
        let mut here = p;
        here[LEAST] = p[INVERSE].min(q[INVERSE]).min(r[INVERSE]);
        // Subtract first: what is common to all corners leaves no rounding error.
        let slope = |a: f32, b: f32| std::array::from_fn(|k| a * (q[k] - p[k]) + b * (r[k] - p[k]));
        Self {
            origin: corners[0].at.map(|x| x as f32 / SUBPIXEL as f32),
            here,
            slopes: [slope(ax, bx), slope(ay, by)],
            side: if edges.turned() { 1.0 } else { -1.0 },
        }
    }
}

/// The number of fragments of one [`Block`].
const LANES: usize = 32;
/// The number of blocks that wait.
const BLOCKS: usize = 2;

/// Points on triangles of one material that wait for their light.
#[derive(Default)]
pub(super) struct Fragments {
    count: usize,
    blocks: [Block; BLOCKS],
}

/// Fragments, as separate arrays.
#[derive(Default)]
struct Block {
    /// The positions in pixels.
    at: [[f32; LANES]; 2],
    /// Interpolated values.
    values: [[f32; LANES]; PLANES],
    /// The changes of the first three values to the right and down; after that, those of u and v.
    slopes: [[f32; LANES]; 6],
    side: [f32; LANES],
    uv: [[f32; LANES]; 2],
    /// The factor of the colour, and the white that is added.
    lights: [[f32; LANES]; 2],
    light: [[f32; LANES]; 3],
    /// The indices of their pixels in the tile, and the caller's own data.
    to: [[u16; 2]; LANES],
}

impl Fragments {
    pub(super) fn is_full(&self) -> bool {
        self.count == LANES * BLOCKS
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a fragment, unless it is full: a position in the picture, in pixels, on a triangle. `to` is the index of its pixel
    /// in the tile and a number of the caller's.
    #[inline(always)]
    pub(super) fn push(&mut self, planes: &Planes, at: [f32; 2], to: [u16; 2]) {
        let (block, lane) = (self.count / LANES, self.count % LANES);
        let Some(block) = self.blocks.get_mut(block) else {
            return;
        };
        let Planes {
            origin,
            here,
            slopes: [across, along],
            side,
        } = planes;
        let (x, y) = (at[0] - origin[0], at[1] - origin[1]);
        for (k, values) in block.values.iter_mut().enumerate() {
            values[lane] = here[k] + across[k] * x + along[k] * y;
        }
        for k in 0..3 {
            block.slopes[k][lane] = across[k];
            block.slopes[k + 3][lane] = along[k];
        }
        block.at[0][lane] = at[0];
        block.at[1][lane] = at[1];
        block.side[lane] = *side;
        block.to[lane] = to;
        self.count += 1;
    }

    /// Returns the data that was pushed with a fragment, and its light.
    #[inline(always)]
    pub(super) fn lit(&self, number: usize) -> ([u16; 2], [f32; 3]) {
        let block = &self.blocks[number / LANES % BLOCKS];
        let lane = number % LANES;
        let [r, g, b] = [
            block.light[0][lane],
            block.light[1][lane],
            block.light[2][lane],
        ];
        (block.to[lane], [r, g, b])
    }

    /// Computes the light of all fragments.
    #[inline(always)]
    pub(super) fn shade(&mut self, material: &Material, eye: &Eye) {
        let count = self.count;
        for (number, block) in self.blocks.iter_mut().enumerate() {
            let filled = count.saturating_sub(number * LANES).min(LANES);
            if filled == 0 {
                break;
            }
            block.shade(filled, material, eye);
        }
    }
}

#[allow(clippy::needless_range_loop)] // Several arrays are walked together, lane by lane.
impl Block {
    #[inline(always)]
    fn shade(&mut self, filled: usize, material: &Material, eye: &Eye) {
        let colour = material.colour;
        match &material.kind {
            MaterialKind::Glyph => {
                for k in 0..filled {
                    let inverse = 1.0 / self.values[INVERSE][k].max(self.values[LEAST][k]);
                    let [u, v] = UV.map(|n| self.values[n][k] * inverse);
                    let facing = (1.0 - (u * u + v * v).min(1.0)).sqrt();
                    self.set(k, colour.map(|c| c * style::glyph_light(facing)));
                }
            }
            MaterialKind::Cone => {
                for k in 0..filled {
                    let normal = Vec3::from(NORMAL.map(|n| self.values[n][k]));
                    let to_eye = Vec3::from(to_eye(eye, [self.at[0][k], self.at[1][k]]));
                    let facing = normal.normalize_or(to_eye).dot(to_eye).abs();
                    self.set(k, colour.map(|c| c * style::glyph_light(facing)));
                }
            }
            MaterialKind::Surface(image) => {
                self.interpolate();
                // Lanes without a fragment read the image's corner, and are not shown.
                for uv in &mut self.uv {
                    uv[filled..].fill(0.0);
                }
                self.illuminate(eye);
                let [ax, ay, bx, by, ..] = self.slopes;
                let thresholds = if image.dithers() {
                    self.thresholds()
                } else {
                    [0.0; LANES]
                };
                let footprints = image.footprints(&[ax, ay, bx, by], &thresholds);
                image.averages(&self.uv, &footprints, &mut self.light);
                for (light, colour) in self.light.iter_mut().zip(colour) {
                    for k in 0..LANES {
                        light[k] = light[k] * colour * self.lights[0][k] + self.lights[1][k];
                    }
                }
            }
        }
        if material.emphasis != 0.0 {
            for k in 0..LANES {
                let light = [self.light[0][k], self.light[1][k], self.light[2][k]];
                self.set(k, style::emphasised(light, material.emphasis));
            }
        }
    }

    /// Returns the thresholds of the fragments' pixels.
    #[inline(always)]
    fn thresholds(&self) -> [f32; LANES] {
        let mut thresholds = [0.0; LANES];
        for k in 0..LANES {
            let [index, _] = self.to[k].map(i32::from);
            thresholds[k] = threshold(index % TILE as i32, index / TILE as i32);
        }
        thresholds
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, [r, g, b]: [f32; 3]) {
        self.light[0][lane] = r;
        self.light[1][lane] = g;
        self.light[2][lane] = b;
    }

    /// Computes texture coordinates and their slopes.
    #[inline(always)]
    fn interpolate(&mut self) {
        for k in 0..LANES {
            let inverse = 1.0 / self.values[INVERSE][k].max(self.values[LEAST][k]);
            let (u, v) = (self.values[0][k] * inverse, self.values[1][k] * inverse);
            let [ax, ay, aw, bx, by, bw] = [0, 1, 2, 3, 4, 5].map(|n| self.slopes[n][k]);
            self.uv[0][k] = u;
            self.uv[1][k] = v;
            // The quotient rule.
            self.slopes[0][k] = (ax - u * aw) * inverse;
            self.slopes[1][k] = (ay - v * aw) * inverse;
            self.slopes[2][k] = (bx - u * bw) * inverse;
            self.slopes[3][k] = (by - v * bw) * inverse;
        }
    }

    #[inline(always)]
    fn illuminate(&mut self, eye: &Eye) {
        for k in 0..LANES {
            let to_eye = to_eye(eye, [self.at[0][k], self.at[1][k]]);
            let [x, y, z] = [3, 4, 5].map(|n: usize| self.values[n][k]);
            let length = (x * x + y * y + z * z).sqrt();
            // The side is the triangle's: near a silhouette an interpolated normal may lean away from the eye, and flipping
            // it there would speckle the rim. A point without a normal faces the eye.
            let scale = self.side[k] / length;
            let is_one = scale.abs() < f32::MAX;
            let normal = [
                if is_one { x * scale } else { to_eye[0] },
                if is_one { y * scale } else { to_eye[1] },
                if is_one { z * scale } else { to_eye[2] },
            ];
            let (diffuse, white) = style::surface_light(normal, to_eye);
            self.lights[0][k] = diffuse;
            self.lights[1][k] = white;
        }
    }
}

/// Returns the unit vector to the eye from the point that is seen at a position in the picture, in view space.
#[inline(always)]
fn to_eye(eye: &Eye, at: [f32; 2]) -> [f32; 3] {
    if eye.is_parallel() {
        return [0.0, 0.0, 1.0];
    }
    let x = (1.0 - 2.0 * at[0] / eye.size.x) / eye.zoom.x;
    let y = (2.0 * at[1] / eye.size.y - 1.0) / eye.zoom.y;
    let scale = 1.0 / (x * x + y * y + 1.0).sqrt();
    [x * scale, y * scale, scale]
}
