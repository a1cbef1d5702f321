//! Cameras, and the places of samples.
//!
//! Input: a camera, a pixel, the number of a sample. Output: a ray. Samples lie on additive sequences whose steps are the
//! powers of 1/φ with φᵈ⁺¹ = φ + 1 (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018), as
//! integers over 2³²: the same on every machine and for any number of threads. Rays are computed in vectors, a block of
//! them at once.

use expr::processor::Processor;
use expr::vectors::{Instructions, MOST_LANES, Vector, VectorWork};
use glam::DVec3;

use crate::line::Ray;

/// A camera with a thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensCamera {
    /// The lens' centre.
    pub position: DVec3,
    /// The direction of the picture's centre.
    pub direction: DVec3,
    /// The direction that is up in the picture, as far as it is across the direction.
    pub up: DVec3,
    /// The vertical opening in radians.
    pub fov: f64,
    /// The turn of the picture's up towards its right, in radians.
    pub roll: f64,
    /// The distance of the plane that is sharp.
    pub focus: f64,
    /// The lens' radius.
    pub aperture: f64,
    /// The shape of the lens.
    pub bokeh: Bokeh,
    /// The way in which directions lie in the picture.
    pub projection: LensProjection,
    /// The places that are sharp.
    pub sharp: SharpPlaces,
}

/// A camera with what all rays through a picture have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraFrame {
    camera: LensCamera,
    /// The picture's right and up, and the direction of its centre.
    axes: [DVec3; 3],
    /// The tangent of half the vertical opening.
    tangent: f64,
    /// The picture's middle, in pixels.
    centre: [f64; 2],
    /// The side of a pixel, the picture's height being 2.
    pixel: f64,
}

/// The places that a lens shows sharp, at the distance `focus`.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum SharpPlaces {
    /// A plane across the direction.
    #[default]
    Plane,
    /// A ball around the lens' centre; places on the lens are seen from behind.
    Ball,
}

/// The way in which directions lie in a picture.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum LensProjection {
    /// Straight lines are straight.
    #[default]
    Pinhole,
    /// Both coordinates of the picture are angles.
    Spherical,
    /// The coordinate to the right is an angle.
    Cylindrical,
}

impl LensProjection {
    /// Returns the projection with this name in programs.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "pinhole" => Self::Pinhole,
            "spherical" => Self::Spherical,
            "cylindrical" => Self::Cylindrical,
            _ => return None,
        })
    }
}

/// The shape of a lens, and of what lies out of focus.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Bokeh {
    /// A disc.
    #[default]
    Circle,
    /// A line to the right.
    Line,
    /// A regular polygon with this number of corners, the first one to the right.
    Polygon(u32),
    /// A star with five tips, one of them up.
    Star,
    /// A square with sides along the picture's.
    Box,
    /// A normal distribution, whose standard deviation is the lens' radius.
    Gaussian,
}

impl Bokeh {
    /// Returns the shape with this name in programs.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "circle" => Self::Circle,
            "line" => Self::Line,
            "triangle" => Self::Polygon(3),
            "square" => Self::Polygon(4),
            "pentagon" => Self::Polygon(5),
            "hexagon" => Self::Polygon(6),
            "octagon" => Self::Polygon(8),
            "star" => Self::Star,
            "box" => Self::Box,
            "gaussian" => Self::Gaussian,
            _ => return None,
        })
    }
}

/// The corners of a star, both its tips and those between them.
pub const STAR_CORNERS: u32 = 10;
/// The distance of a star's inner corners from its centre.
pub const STAR_INNER: f64 = 0.382;

/// The steps in two, four and six dimensions: 2³²/φ, 2³²/φ², … as whole numbers
const STEPS_2: [u32; 2] = [3_242_174_889, 2_447_445_413];
const STEPS_4: [u32; 4] = [3_679_390_609, 3_152_041_523, 2_700_274_806, 2_313_257_605];
const STEPS_6: [u32; 6] = [
    3_859_688_306,
    3_468_523_226,
    3_117_001_274,
    2_801_104_767,
    2_517_223_199,
    2_262_111_973,
];

/// The properties of a scene that need samples of their own, beside those of the pixels.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct SampleAxes {
    /// A lens.
    pub lens: bool,
    /// Lights that have a size.
    pub lights: bool,
    /// The samples of a pixel lie in turn on a grid of so many columns and rows, from the pixel's top left; a grid of one
    /// has its place in the pixel's middle.
    pub grid: Option<u32>,
}

/// The place of a sample: numbers from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// In the pixel, to the right and down.
    pub pixel: [f64; 2],
    /// The side of the part of the pixel that it stands for beside the samples before it: 1 for the first one, then less.
    pub side: f64,
    /// On the lens.
    pub lens: [f64; 2],
    /// On lights.
    pub light: [f64; 2],
}

impl Default for LensCamera {
    /// A camera at 0 that looks along y.
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            direction: DVec3::Y,
            up: DVec3::Z,
            fov: std::f64::consts::FRAC_PI_4,
            roll: 0.0,
            focus: 1.0,
            aperture: 0.0,
            bokeh: Bokeh::default(),
            projection: LensProjection::default(),
            sharp: SharpPlaces::default(),
        }
    }
}

impl SampleAxes {
    /// The place of a sample of a pixel.
    // What depends on the number of the sample alone is then taken out of the loop over pixels.
    #[inline(always)]
    pub fn sample(self, pixel: [u32; 2], sample: u32) -> Sample {
        let steps: &[u32] = match (self.lens, self.lights) {
            (false, false) => &STEPS_2,
            (true, true) => &STEPS_6,
            _ => &STEPS_4,
        };
        let place = |axis: usize| {
            let start = if axis < 2 {
                1 << 31
            } else {
                hash(pixel, axis as u32)
            };
            let place = steps[axis].wrapping_mul(sample).wrapping_add(start);
            f64::from(place) / 2f64.powi(32)
        };
        let pair = |axis: usize| [place(axis), place(axis + 1)];
        Sample {
            pixel: match self.grid {
                Some(count) => on_grid(count, sample),
                None => pair(0),
            },
            side: 1.0 / (1.0 + f64::from(sample)).sqrt(),
            lens: if self.lens { pair(2) } else { [0.5; 2] },
            light: match (self.lens, self.lights) {
                (_, false) => [0.5; 2],
                (lens, true) => pair(if lens { 4 } else { 2 }),
            },
        }
    }
}

impl LensCamera {
    /// The start and unit direction of the ray through a place of the picture, `x` to the right and `y` down in pixels,
    /// and a place on the lens, two numbers from 0 to 1.
    pub fn ray(&self, size: [u32; 2], place: [f64; 2], lens: [f64; 2]) -> (DVec3, DVec3) {
        self.frame(size).ray(place, lens)
    }

    /// Prepares for many rays through a picture of this size.
    pub(crate) fn frame(&self, size: [u32; 2]) -> CameraFrame {
        CameraFrame {
            camera: *self,
            axes: self.axes(),
            tangent: (0.5 * self.fov).tan(),
            centre: size.map(|side| 0.5 * f64::from(side)),
            pixel: 2.0 / f64::from(size[1]),
        }
    }

    /// The picture's right and up, and the direction of its centre.
    pub fn axes(&self) -> [DVec3; 3] {
        let forward = self.direction.normalize_or(DVec3::Y);
        let across = forward.cross(self.up);
        // Along the vertical, the picture's up is y.
        let right = across
            .try_normalize()
            .or(forward.cross(DVec3::Y).try_normalize());
        let right = right.unwrap_or(DVec3::X);
        let up = right.cross(forward);
        let (sin, cos) = self.roll.sin_cos();
        [cos * right - sin * up, cos * up + sin * right, forward]
    }
}

impl CameraFrame {
    /// The ray through a place, as [`LensCamera::ray`] has it.
    fn ray(&self, place: [f64; 2], lens: [f64; 2]) -> (DVec3, DVec3) {
        let mut places = PlaceBlock::default();
        places.set(0, place, lens);
        let [x, y, z, dx, dy, dz] = Processor::here().run_vectors(RaysThrough {
            frame: self,
            places: &places,
        });
        (
            DVec3::new(x[0], y[0], z[0]),
            DVec3::new(dx[0], dy[0], dz[0]),
        )
    }

    /// The angle of a pixel in a unit direction, in radians: the smaller one, where it is not a square.
    pub(crate) fn pixel_angle(&self, direction: DVec3) -> f64 {
        match self.camera.projection {
            LensProjection::Pinhole => {
                let cosine = direction.dot(self.axes[2]);
                cosine * cosine * self.tangent * self.pixel
            }
            _ => 0.5 * self.camera.fov * self.pixel,
        }
    }

    /// Adds the rays of samples of pixels, which start on no surface.
    pub(crate) fn add_rays(
        &self,
        processor: Processor,
        samples: &[([u32; 2], Sample)],
        rays: &mut Vec<Ray>,
    ) {
        let mut places = PlaceBlock::default();
        for samples in samples.chunks(MOST_LANES) {
            for (lane, ([i, j], sample)) in samples.iter().enumerate() {
                let [x, y] = sample.pixel;
                places.set(lane, [f64::from(*i) + x, f64::from(*j) + y], sample.lens);
            }
            let [x, y, z, dx, dy, dz] = processor.run_vectors(RaysThrough {
                frame: self,
                places: &places,
            });
            rays.extend((0..samples.len()).map(|k| Ray {
                origin: DVec3::new(x[k], y[k], z[k]),
                direction: DVec3::new(dx[k], dy[k], dz[k]),
                leaving: None,
            }));
        }
    }
}

/// A number for each of as many rays as the widest vectors have lanes.
type Block = [f64; MOST_LANES];

/// The places of rays in a picture, to the right and down in pixels, and on the lens.
#[derive(Default)]
struct PlaceBlock {
    picture: [Block; 2],
    lens: [Block; 2],
}

impl PlaceBlock {
    fn set(&mut self, lane: usize, picture: [f64; 2], lens: [f64; 2]) {
        for axis in 0..2 {
            self.picture[axis][lane] = picture[axis];
            self.lens[axis][lane] = lens[axis];
        }
    }
}

/// The coordinates of the starts and of the unit directions of the rays through places.
struct RaysThrough<'a> {
    frame: &'a CameraFrame,
    places: &'a PlaceBlock,
}

impl VectorWork for RaysThrough<'_> {
    type Output = [Block; 6];

    #[inline(always)]
    fn run<S: Instructions>(self, s: S) -> Self::Output {
        let mut rays = [[0.0; MOST_LANES]; 6];
        for part in 0..Vector::<S>::PARTS {
            let load =
                |blocks: &[Block; 2]| [0, 1].map(|axis| Vector::load(s, &blocks[axis], part));
            let place = load(&self.places.picture);
            let (origin, direction) = self.frame.rays(s, place, || load(&self.places.lens));
            for (block, numbers) in rays.iter_mut().zip(origin.into_iter().chain(direction)) {
                numbers.store(block, part);
            }
        }
        rays
    }
}

impl CameraFrame {
    /// The starts and unit directions of the rays through places in the picture and on the lens.
    #[inline(always)]
    fn rays<S: Instructions>(
        &self,
        s: S,
        [x, y]: [Vector<S>; 2],
        lens: impl FnOnce() -> [Vector<S>; 2],
    ) -> ([Vector<S>; 3], [Vector<S>; 3]) {
        let camera = &self.camera;
        let number = |number: f64| Vector::splat(s, number);
        let [right, up, forward] = self.axes.map(|axis| axis.to_array().map(number));
        // From −1 to 1 over the picture's height.
        let across = (x - number(self.centre[0])) * number(self.pixel);
        let upward = (number(self.centre[1]) - y) * number(self.pixel);
        let angular = |place: Vector<S>| (number(0.5 * camera.fov) * place).sin_cos().0;
        let across = match camera.projection {
            LensProjection::Pinhole => number(self.tangent) * across,
            _ => angular(across),
        };
        let upward = match camera.projection {
            LensProjection::Spherical => angular(upward),
            _ => number(self.tangent) * upward,
        };
        let direction = [0, 1, 2].map(|k| forward[k] + across * right[k] + upward * up[k]);
        let position = camera.position.to_array().map(number);
        if camera.aperture <= 0.0 {
            return (position, normalized(s, direction));
        }
        let [a, b] = camera.bokeh.places(s, lens());
        let radius = number(camera.aperture);
        let offset = [0, 1, 2].map(|k| radius * (a * right[k] + b * up[k]));
        let (offset, direction) = match camera.sharp {
            SharpPlaces::Plane => (offset, direction),
            SharpPlaces::Ball => (offset.map(|part| -part), normalized(s, direction)),
        };
        let focus = number(camera.focus);
        let towards = [0, 1, 2].map(|k| focus * direction[k] - offset[k]);
        let origin = [0, 1, 2].map(|k| position[k] + offset[k]);
        (origin, normalized(s, towards))
    }
}

/// Vectors of length 1.
#[inline(always)]
fn normalized<S: Instructions>(s: S, [x, y, z]: [Vector<S>; 3]) -> [Vector<S>; 3] {
    let scale = Vector::splat(s, 1.0) / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|part| part * scale)
}

impl Bokeh {
    /// The places in the shape, to the right and up, of pairs of numbers that are evenly distributed from 0 to 1.
    #[inline(always)]
    fn places<S: Instructions>(self, s: S, [u, v]: [Vector<S>; 2]) -> [Vector<S>; 2] {
        let number = |number: f64| Vector::splat(s, number);
        let disc = |radius: Vector<S>| {
            let (sin, cos) = (number(std::f64::consts::TAU) * v).sin_cos();
            [radius * cos, radius * sin]
        };
        let even = |part: Vector<S>| number(2.0) * part - number(1.0);
        match self {
            Self::Circle => disc(u.sqrt()),
            Self::Line => [even(u), number(0.0)],
            Self::Box => [even(u), even(v)],
            Self::Gaussian => disc(u.map(|u| (-2.0 * (1.0 - u).ln()).sqrt())),
            Self::Polygon(_) | Self::Star => {
                [0, 1].map(|axis| u.map_with(v, |u, v| self.place_in_polygon([u, v])[axis]))
            }
        }
    }

    /// The place in a polygon or a star.
    fn place_in_polygon(self, place: [f64; 2]) -> [f64; 2] {
        let corner = |angle: f64, radius: f64| [radius * angle.cos(), radius * angle.sin()];
        match self {
            Self::Polygon(count) => {
                let step = std::f64::consts::TAU / f64::from(count);
                fan(count, place, |k| corner(f64::from(k) * step, 1.0))
            }
            _ => {
                let step = std::f64::consts::PI / 5.0;
                fan(STAR_CORNERS, place, |k| {
                    let radius = if k % 2 == 0 { 1.0 } else { STAR_INNER };
                    corner(std::f64::consts::FRAC_PI_2 + f64::from(k) * step, radius)
                })
            }
        }
    }
}

/// The place of a sample on a grid: column by column, from the pixel's top left.
fn on_grid(count: u32, sample: u32) -> [f64; 2] {
    if count <= 1 {
        return [0.5; 2];
    }
    let place = sample % count.saturating_mul(count);
    [place / count, place % count].map(|k| f64::from(k) / f64::from(count))
}

/// A place in a polygon of triangles about 0 that have equal areas.
fn fan(count: u32, [u, v]: [f64; 2], corner: impl Fn(u32) -> [f64; 2]) -> [f64; 2] {
    let scaled = u * f64::from(count);
    let k = (scaled.floor() as u32).min(count.saturating_sub(1));
    let out = (scaled - f64::from(k)).sqrt();
    let (a, b) = (corner(k), corner(k + 1));
    [0, 1].map(|axis| out * ((1.0 - v) * a[axis] + v * b[axis]))
}

/// Mixes the coordinates of a pixel and an axis.
fn hash(pixel: [u32; 2], axis: u32) -> u32 {
    let mut mixed = 0x9e37_79b9u32;
    for part in [pixel[0], pixel[1], axis] {
        mixed ^= part;
        mixed = (mixed ^ (mixed >> 16)).wrapping_mul(0x7feb_352d);
        mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0x846c_a68b);
        mixed ^= mixed >> 16;
    }
    mixed
}
