//! The colours of places on triangles.
//!
//! Input: triangles with what is interpolated on them ([`Planes`]), and where on them it is wanted. What flows out:
//! light. Places wait until there are many ([`Fragments`]), so that whatever has no branches is computed for several of
//! them at once.

use glam::Vec3;

use super::mesh::{Corner, Eye, SUBPIXEL};
use super::raster::Edges;
use crate::style;
use crate::texture::Sampler;

/// The appearance of triangles of one kind of one object.
#[derive(Clone, Debug)]
pub(super) struct Material<'a> {
    pub kind: MaterialKind<'a>,
    /// The colour in linear light.
    pub colour: [f32; 3],
    /// The share of [`style::EMPHASIS_COLOUR`] that is mixed in.
    pub emphasis: f32,
}

/// The kind of lighting of triangles.
#[derive(Clone, Debug)]
pub(super) enum MaterialKind<'a> {
    /// A strip or disc that faces the eye: its texture coordinates are the place in the unit disc.
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

/// The quantities that are interpolated on a triangle, over the distance: then all of them are affine over the picture.
pub(super) struct Planes {
    /// The picture's place, in pixels, that `here` belongs to.
    origin: [f32; 2],
    here: [f32; PLANES],
    /// The changes from pixel to pixel, to the right and down.
    slopes: [[f32; PLANES]; 2],
    /// 1 if the front is seen, else −1.
    side: f32,
}

/// Values that are interpolated, with one that is the same everywhere.
const PLANES: usize = 8;
/// Texture coordinates.
const UV: [usize; 2] = [0, 1];
/// 1 over the distance.
const INVERSE: usize = 2;
/// Normals.
const NORMAL: [usize; 3] = [3, 4, 5];
/// The least of 1 over the corners' distances.
const LEAST: usize = 6;

impl Planes {
    /// Those of a triangle with an area.
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
        // Differences first: what is common to all corners leaves no rounding error.
        let slope = |a: f32, b: f32| std::array::from_fn(|k| a * (q[k] - p[k]) + b * (r[k] - p[k]));
        Self {
            origin: corners[0].at.map(|x| x as f32 / SUBPIXEL as f32),
            here,
            slopes: [slope(ax, bx), slope(ay, by)],
            side: if edges.turned() { 1.0 } else { -1.0 },
        }
    }
}

/// Fragments of one [`Block`].
const LANES: usize = 32;
/// Blocks that wait.
const BLOCKS: usize = 2;

/// Places on triangles of one material that wait for their light.
#[derive(Default)]
pub(super) struct Fragments {
    count: usize,
    blocks: [Block; BLOCKS],
}

/// Fragments, by what they consist of.
#[derive(Default)]
struct Block {
    /// In pixels.
    at: [[f32; LANES]; 2],
    /// Interpolated values.
    values: [[f32; LANES]; PLANES],
    /// The changes of the first three of them to the right and down; after that, those of u and v.
    slopes: [[f32; LANES]; 6],
    side: [f32; LANES],
    uv: [[f32; LANES]; 2],
    /// The factor of the colour, and the white that is added.
    lights: [[f32; LANES]; 2],
    light: [[f32; LANES]; 3],
    /// The caller's own words.
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

    /// One more, unless it is full: the place of the picture, in pixels, on a triangle.
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

    /// The data that was pushed with a fragment, and its light.
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

    /// Finds the light of all.
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
                // Lanes without a fragment are looked up at the image's corner, and not shown.
                for uv in &mut self.uv {
                    uv[filled..].fill(0.0);
                }
                self.illuminate(eye);
                let [ax, ay, bx, by, ..] = self.slopes;
                let footprints = image.footprints(&[ax, ay, bx, by], 0);
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

    #[inline(always)]
    fn set(&mut self, lane: usize, [r, g, b]: [f32; 3]) {
        self.light[0][lane] = r;
        self.light[1][lane] = g;
        self.light[2][lane] = b;
    }

    /// Texture coordinates and their slopes.
    #[inline(always)]
    fn interpolate(&mut self) {
        for k in 0..LANES {
            let inverse = 1.0 / self.values[INVERSE][k].max(self.values[LEAST][k]);
            let (u, v) = (self.values[0][k] * inverse, self.values[1][k] * inverse);
            let [ax, ay, aw, bx, by, bw] = [0, 1, 2, 3, 4, 5].map(|n| self.slopes[n][k]);
            self.uv[0][k] = u;
            self.uv[1][k] = v;
            // The derivative of a quotient.
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
            // The side is the triangle's: near a silhouette an interpolated normal may lean away from the eye, and
            // turning it over there would speckle the rim. What has no normal faces the eye.
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

/// The unit vector to the eye from what is seen at a place of the picture, in view space.
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
