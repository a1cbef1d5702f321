//! Where the being inside the surface stands, and what it sees in f64: the geodesic view's camera and map.

use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::map::{self, Arithmetic, Map, MapOptions, exponential_map};
use geodesic::surface::{Sides, Surface};
use geodesic::topology::Apex;
use geodesic::trace::TraceError;
use glam::DVec3;
use scene::scene::Scene;
use scene::values::Settings;

use crate::ground::Ground;
use crate::request::{Method, RenderError, Request, View};
use crate::sample::DEGENERATE;

/// Where the camera first looks for a place, as shares of the domain: its middle, then others off every symmetry.
const PLACES: [[f64; 2]; 7] = [
    [0.5, 0.5],
    [0.47, 0.53],
    [0.39, 0.36],
    [0.61, 0.32],
    [0.27, 0.71],
    [0.83, 0.64],
    [0.13, 0.17],
];
/// The first zoom, as a share of the shorter of the two coordinate lines through the camera.
const FIRST_ZOOM: f64 = 0.55;
/// Steps of [`Method::Rk4Pixel`] for each pixel.
const RK4_STEPS: u32 = 128;

/// The error that the integrator is asked for, in pixels: on its way to the end a ray's error grows by a few times.
const TOLERANCE: f64 = 0.03;

/// A surface with a camera on it.
#[derive(Clone, Debug)]
pub struct Inside {
    ground: Ground,
    /// The camera: a place and two tangent vectors X ⟂ Y of the length [`Inside::zoom`].
    pub frame: Frame,
    /// The distance on the surface from the picture's centre to the middle of its shorter side's edge.
    pub zoom: f64,
    /// The uniforms of the surface's first instance.
    pub uniforms: Vec<f64>,
    /// How geodesics are followed.
    pub method: Method,
    size: [u32; 2],
}

impl Inside {
    /// The camera of a geodesic view; of a surface that depends on grids, the first instance is taken. A place
    /// beyond a side that wraps is brought back into the domain.
    ///
    /// # Errors
    /// [`RenderError::NoSurface`], [`RenderError::CameraOutside`], [`RenderError::UndefinedCamera`],
    /// [`RenderError::TooLarge`].
    pub fn new(scene: &Scene, settings: &Settings, request: &Request) -> Result<Self, RenderError> {
        let View::Geodesic {
            surface,
            at,
            angle,
            zoom,
            method,
        } = request.view
        else {
            return Err(RenderError::NoSurface { name: None });
        };
        let object = scene
            .objects
            .get(surface.0 as usize)
            .ok_or(RenderError::NoSurface { name: None })?;
        let name = || object.name.clone();
        let uniforms = settings.first_instance(scene, object);
        let ground = Ground::new(scene, surface, &uniforms)?;
        let surface = ground.surface();
        let at = at.unwrap_or_else(|| first_place(surface));
        // The length does not matter yet: the first zoom is measured from where the frame turns out to stand.
        let unit = Frame::new(surface, at, angle, 1.0).map_err(|error| match error {
            TraceError::OutsideDomain { at, domain } => RenderError::CameraOutside {
                name: name(),
                at,
                domain,
            },
            _ => RenderError::UndefinedCamera { name: name(), at },
        })?;
        if unit.coordinates == Coordinates::Plain && !has_tangent_plane(surface, unit.uv) {
            return Err(RenderError::UndefinedCamera { name: name(), at });
        }
        let zoom = zoom.unwrap_or_else(|| first_zoom(surface, unit.uv));
        Ok(Self {
            frame: unit.zoomed(zoom),
            ground,
            zoom,
            uniforms,
            method,
            size: request.size,
        })
    }

    /// `[[u min, u max], [v min, v max]]`.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.ground.surface().domain()
    }

    /// What lies beyond each side of the domain.
    pub fn sides(&self) -> Sides {
        self.ground.surface().sides()
    }

    /// The sides that are one point: `[axis][end]`.
    pub fn apexes(&self) -> [[Option<Apex>; 2]; 2] {
        self.ground.apexes()
    }

    /// The ends of all pixels' geodesics, in f64 on all cores. `progress` is told the share that is done.
    pub fn map(&self, progress: &(dyn Fn(f32) + Sync)) -> Map {
        let method = match self.method {
            Method::Auto | Method::Adaptive => map::Method::Adaptive,
            Method::Rk4Pixel => map::Method::Rk4 {
                steps: RK4_STEPS,
                arithmetic: Arithmetic::F64,
            },
        };
        let options = MapOptions {
            method,
            tolerance: TOLERANCE,
            ..MapOptions::default()
        };
        exponential_map(
            self.ground.surface(),
            &self.frame,
            self.size,
            &options,
            progress,
        )
    }
}

/// A place with a tangent plane, the domain's middle if that has one.
fn first_place(surface: &dyn Surface) -> [f64; 2] {
    let domain = surface.domain();
    let places = PLACES.map(|share| {
        std::array::from_fn(|k| domain[k][0] + share[k] * (domain[k][1] - domain[k][0]))
    });
    let found = places
        .into_iter()
        .find(|&at| has_tangent_plane(surface, at));
    found.unwrap_or(places[0])
}

/// Whether σ is defined and σu, σv span a plane, each taken times its domain's width.
fn has_tangent_plane(surface: &dyn Surface, at: [f64; 2]) -> bool {
    let jet = surface.jet(at);
    let widths = surface.domain().map(|[low, high]| high - low);
    let (a, b) = (
        DVec3::from(jet.du) * widths[0],
        DVec3::from(jet.dv) * widths[1],
    );
    let longest = a.abs().max_element().max(b.abs().max_element());
    if !(longest > 0.0 && longest.is_finite() && DVec3::from(jet.position).is_finite()) {
        return false;
    }
    (a / longest).cross(b / longest).length() > DEGENERATE
}

/// A zoom that shows a good part of the surface.
fn first_zoom(surface: &dyn Surface, at: [f64; 2]) -> f64 {
    const STEPS: u32 = 64;
    let domain = surface.domain();
    let length = |k: usize| -> f64 {
        let [low, high] = domain[k];
        let step = (high - low) / f64::from(STEPS);
        let pieces = (0..STEPS).map(|n| {
            let mut place = at;
            place[k] = low + (f64::from(n) + 0.5) * step;
            let jet = surface.jet(place);
            DVec3::from(if k == 0 { jet.du } else { jet.dv }).length() * step
        });
        pieces.filter(|piece| piece.is_finite()).sum()
    };
    let shorter = [length(0), length(1)]
        .into_iter()
        .filter(|&l| l > 0.0)
        .fold(f64::INFINITY, f64::min);
    if shorter.is_finite() {
        FIRST_ZOOM * shorter
    } else {
        1.0
    }
}
