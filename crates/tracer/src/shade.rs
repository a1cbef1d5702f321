//! The light that comes along a ray.
//!
//! Input: a world, the looks of its faces, lights, a background. Output: linear light. At a face with the colour c:
//! k·c·ΣaC + Σ V·S·C·(falloff/r)²·(k·c·(n·l) + specular·(n·h)^shininess) + (m + gF)·R + g(1 − F)·T, where R and T are what
//! the reflected and the refracted ray see, F is Fresnel's share, and V the share of the light that faces and glass on the
//! way let through. That is the look `geotrace`; `shade/crt.rs` has the light that the look `crt` takes from lights.
//! `shade/paths.rs` follows the rays, `shade/lights.rs` adds the light from lights.

mod crt;
mod lights;
mod paths;

use glam::DVec3;

use crate::cast::Crossing;
use crate::light::Light;
use crate::line::SurfaceId;
use crate::look::PictureLook;
use crate::sheet::SheetHit;
use crate::sheets::Sheets;
use crate::world::World;

pub use crt::PARALLEL_REACH;
pub use paths::{EyeSample, LightTracer};

/// The look of a face at a place; colours are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceLook {
    /// Its colour, c.
    pub colour: DVec3,
    /// The share that is scattered, k; without one, what mirror and glass leave.
    pub diffuse: Option<f64>,
    /// The strength of the highlight.
    pub specular: f64,
    /// The sharpness of the highlight.
    pub shininess: f64,
    /// The share that is reflected, m, by colour.
    pub mirror: DVec3,
    /// The share that is reflected or refracted, g.
    pub glass: f64,
    /// The gradient of the height along the normal.
    pub bump: DVec3,
}

/// The glass that a solid is of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// The refractive index.
    pub ior: f64,
    /// The length of glass that has the colour.
    pub depth: f64,
    /// The leaf whose glass it is, over all solids: it has its colour around the start of a ray.
    pub leaf: usize,
}

/// A place on a face that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// The distance along the ray, in units of its direction.
    pub t: f64,
    /// The place.
    pub position: DVec3,
    /// The unit normal on the side of the ray's start.
    pub normal: DVec3,
    /// The direction of the ray, as long as the side of the square section of the beam for which it stands; 0 for the ray alone.
    pub beam: DVec3,
    /// The object that the face belongs to.
    pub of: FaceObject,
}

/// The object that a face belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceObject {
    /// A solid.
    Solid {
        /// Its number in the world.
        solid: usize,
        /// The leaf whose surface it is, over all solids.
        leaf: usize,
        /// The surface.
        surface: SurfaceId,
        /// True where the ray enters.
        entering: bool,
    },
    /// A parametric surface.
    Sheet {
        /// Its number.
        sheet: usize,
        /// The parameters.
        uv: [f64; 2],
    },
}

/// All that is seen.
pub struct Scenery<'a> {
    /// The solids.
    pub world: &'a World,
    /// The parametric surfaces.
    pub sheets: &'a Sheets,
    /// The glass that each solid is of; `None`, also for those that are not listed, for none.
    pub glass: &'a [Option<Glass>],
    /// True for each solid that is known to let no light through; those that are not listed may.
    pub opaque: &'a [bool],
    /// The look of a face.
    pub look: &'a (dyn Fn(&Face) -> FaceLook + Sync),
    /// The lights.
    pub lights: &'a [Light],
    /// The light that comes from a unit direction where nothing else is.
    pub background: &'a (dyn Fn(DVec3) -> DVec3 + Sync),
    /// The number of reflections and refractions that are followed. After them a ray sees the background, in the look `crt`
    /// nothing.
    pub bounces: u32,
    /// The formula by which faces are lit.
    pub picture_look: PictureLook,
    /// The sides from which the faces of each leaf are seen; leaves that are not listed are seen from both.
    pub sides: &'a [FaceSides],
}

/// The sides from which a face is seen, and casts shadows.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum FaceSides {
    /// From both.
    #[default]
    Both,
    /// From outside of its solid.
    Outer,
    /// From none.
    None,
}

impl Default for FaceLook {
    fn default() -> Self {
        Self {
            colour: DVec3::ONE,
            diffuse: None,
            specular: 0.07,
            shininess: 40.0,
            mirror: DVec3::ZERO,
            glass: 0.0,
            bump: DVec3::ZERO,
        }
    }
}

impl Default for Glass {
    fn default() -> Self {
        Self {
            ior: 1.5,
            depth: 1.0,
            leaf: 0,
        }
    }
}

impl Scenery<'_> {
    /// True if a ray that comes to a crossing sees the face there.
    fn is_seen(&self, crossing: &Crossing) -> bool {
        self.is_seen_through(crossing.leaf, crossing.entering)
    }

    /// True if a ray that enters through this leaf, or leaves through it, sees the face there.
    fn is_seen_through(&self, leaf: usize, entering: bool) -> bool {
        match self.sides.get(leaf) {
            None | Some(FaceSides::Both) => true,
            Some(FaceSides::Outer) => entering,
            Some(FaceSides::None) => false,
        }
    }

    /// True if a ray sees a parametric surface where it meets it: in the look `crt`, from the side to which σu×σv points.
    fn sees(&self, hit: &SheetHit) -> bool {
        self.picture_look == PictureLook::Geotrace || hit.is_front
    }
}

impl From<&Crossing> for Face {
    fn from(crossing: &Crossing) -> Self {
        Self {
            t: crossing.t,
            position: crossing.position,
            normal: if crossing.entering {
                crossing.normal
            } else {
                -crossing.normal
            },
            beam: DVec3::ZERO,
            of: FaceObject::Solid {
                solid: crossing.solid,
                leaf: crossing.leaf,
                surface: crossing.surface,
                entering: crossing.entering,
            },
        }
    }
}

impl Face {
    /// The face of a parametric surface where a ray meets it.
    fn on_sheet(sheet: usize, hit: &SheetHit) -> Self {
        Self {
            t: hit.t,
            position: hit.position,
            normal: hit.normal,
            beam: DVec3::ZERO,
            of: FaceObject::Sheet { sheet, uv: hit.uv },
        }
    }

    /// Returns the sides of the parallelogram in the tangent plane that the beam meets.
    pub fn footprint(&self) -> [DVec3; 2] {
        let width = self.beam.length();
        if width == 0.0 {
            return [DVec3::ZERO; 2];
        }
        let direction = self.beam / width;
        let across = direction.cross(self.normal).try_normalize();
        let across = across.unwrap_or_else(|| self.normal.any_orthonormal_vector());
        let along = self.normal.cross(across);
        let cosine = direction.dot(self.normal).abs();
        [width * across, width / cosine.max(f64::EPSILON) * along]
    }

    /// The unit normal that leads out of the solid; of a parametric surface, the one on the side of the ray's start.
    pub fn outward(&self) -> DVec3 {
        match self.of {
            FaceObject::Solid {
                entering: false, ..
            } => -self.normal,
            _ => self.normal,
        }
    }
}

impl FaceLook {
    /// The share that is scattered, k: stated, or what mirror and glass leave.
    pub fn scattered(&self) -> f64 {
        let left = (1.0 - self.mirror.max_element() - self.glass).max(0.0);
        self.diffuse.unwrap_or(left)
    }

    /// The look with mirror and glass together at most 1: rays see it so.
    #[must_use]
    pub fn balanced(mut self) -> Self {
        let sum = self.mirror.max_element() + self.glass;
        if sum > 1.0 {
            self.mirror /= sum;
            self.glass /= sum;
        }
        self
    }
}
