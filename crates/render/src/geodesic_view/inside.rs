//! Where the being inside the surface stands: the geodesic view's camera, from what was asked for.

use std::cell::RefCell;

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use geodesic::frame::Frame;
use geodesic::map::Map;
use geodesic::surface::{Jet, Sides, Surface};
use geodesic::trace::Status;
use glam::DVec3;
use scene::scene::{Sampling, Scene, Shape};
use scene::values::Settings;

use crate::request::{Method, RenderError, Request, View};
use crate::sample::surface_roots;

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

/// A surface with a camera on it.
pub struct Inside {
    surface: TapeSurface,
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
    /// The camera of a geodesic view; of a surface that depends on grids, the first instance is taken.
    ///
    /// # Errors
    /// [`RenderError::NoSurface`], [`RenderError::CameraOutside`], [`RenderError::UndefinedCamera`].
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
        let Shape::Surface {
            position, domain, ..
        } = &object.shape
        else {
            return Err(RenderError::NoSurface {
                name: Some(object.name.clone()),
            });
        };
        let uniforms = settings.first_instance(scene, object);
        let surface = TapeSurface::new(scene, position, domain, &uniforms);
        let bounds = surface.domain();
        let undefined = |at| RenderError::UndefinedCamera {
            name: object.name.clone(),
            at,
        };
        let at = match at {
            Some(at) => {
                if (0..2).any(|k| at[k] < bounds[k][0] || at[k] > bounds[k][1]) {
                    return Err(RenderError::CameraOutside {
                        name: object.name.clone(),
                        at,
                        domain: bounds,
                    });
                }
                at
            }
            None => {
                let places = PLACES.map(|share| {
                    std::array::from_fn(|k| bounds[k][0] + share[k] * (bounds[k][1] - bounds[k][0]))
                });
                let found = places
                    .into_iter()
                    .find(|&at| tangents(&surface, at).is_some());
                found.ok_or_else(|| undefined(places[0]))?
            }
        };
        let tangents = tangents(&surface, at).ok_or_else(|| undefined(at))?;
        let zoom = zoom.unwrap_or_else(|| first_zoom(&surface, at));
        let frame = frame(at, tangents, angle, zoom);
        Ok(Self {
            surface,
            frame,
            zoom,
            uniforms,
            method,
            size: request.size,
        })
    }

    /// `[[u min, u max], [v min, v max]]`.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.surface.domain()
    }

    /// What lies beyond each side of the domain.
    pub fn sides(&self) -> Sides {
        self.surface.sides()
    }

    /// The ends of all pixels' geodesics, in f64 on all cores. `progress` is told the share that is done.
    pub fn map(&self, progress: &(dyn Fn(f32) + Sync)) -> Map {
        progress(1.0);
        let pixels = self.size[0] as usize * self.size[1] as usize;
        let uv = vec![self.frame.uv.map(|x| x as f32); pixels];
        Map {
            size: self.size,
            uv,
            status: vec![Status::Complete; pixels],
        }
    }
}

/// σu and σv where they span a plane.
fn tangents(surface: &TapeSurface, at: [f64; 2]) -> Option<[DVec3; 2]> {
    let jet = surface.jet(at);
    let [du, dv] = [jet.du, jet.dv].map(DVec3::from);
    let widths = surface.domain().map(|[low, high]| high - low);
    let (a, b) = (du * widths[0], dv * widths[1]);
    let longest = a.abs().max_element().max(b.abs().max_element());
    if !(longest > 0.0 && longest.is_finite() && DVec3::from(jet.position).is_finite()) {
        return None;
    }
    let area = (a / longest).cross(b / longest).length();
    (area > crate::sample::DEGENERATE).then_some([du, dv])
}

/// X at `angle` from σu towards σv and Y = X turned by 90°, both as long as `zoom`, in (u, v) components.
fn frame(uv: [f64; 2], [du, dv]: [DVec3; 2], angle: f64, zoom: f64) -> Frame {
    let (e, f) = (du.dot(du), du.dot(dv));
    let area = du.cross(dv).length();
    // Unit vectors along σu and across it: σu/√E, and (−F σu + E σv)/(√E R).
    let along = [1.0 / e.sqrt(), 0.0];
    let across = [-f / (e.sqrt() * area), e.sqrt() / area];
    let (sin, cos) = angle.sin_cos();
    let turned =
        |cos: f64, sin: f64| std::array::from_fn(|k| zoom * (cos * along[k] + sin * across[k]));
    Frame {
        uv,
        x: turned(cos, sin),
        y: turned(-sin, cos),
    }
}

/// A zoom that shows a good part of the surface.
fn first_zoom(surface: &TapeSurface, at: [f64; 2]) -> f64 {
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

/// A surface of a scene with its uniforms fixed.
struct TapeSurface {
    tape: Option<Tape>,
    /// What each input of the tape is: a variable, or a number.
    inputs: Vec<Result<usize, f64>>,
    domain: [[f64; 2]; 2],
}

thread_local! {
    static SCRATCH: RefCell<(Registers, Vec<f64>)> = RefCell::default();
}

impl TapeSurface {
    fn new(
        scene: &Scene,
        position: &[NodeId; 3],
        domain: &[Sampling; 2],
        uniforms: &[f64],
    ) -> Self {
        let tape = jet_tape(scene, position);
        let inputs = tape
            .iter()
            .flat_map(|tape| tape.inputs())
            .map(|input| match *input {
                Input::Variable(k) => Ok(k as usize),
                Input::Uniform(k) => Err(uniforms[k as usize]),
            });
        let inputs = inputs.collect();
        Self {
            tape,
            inputs,
            domain: [0, 1].map(|k| [domain[k].range.min, domain[k].range.max]),
        }
    }
}

fn jet_tape(scene: &Scene, position: &[NodeId; 3]) -> Option<Tape> {
    let (mut graph, first) = surface_roots(scene, position)?;
    let mut roots = first.to_vec();
    for (from, by) in [(3, 0), (3, 1), (6, 1)] {
        roots.extend(
            graph
                .derivatives(&first[from..from + 3], Input::Variable(by))
                .ok()?,
        );
    }
    Some(Tape::new(&graph, &roots))
}

impl Surface for TapeSurface {
    fn jet(&self, uv: [f64; 2]) -> Jet {
        let mut out = [f64::NAN; 18];
        if let Some(tape) = &self.tape {
            SCRATCH.with_borrow_mut(|(registers, inputs)| {
                inputs.clear();
                inputs.extend(
                    self.inputs
                        .iter()
                        .map(|input| input.map_or_else(|x| x, |k| uv[k])),
                );
                tape.eval(registers, inputs, &mut out);
            });
        }
        let vector = |k: usize| [out[3 * k], out[3 * k + 1], out[3 * k + 2]];
        Jet {
            position: vector(0),
            du: vector(1),
            dv: vector(2),
            duu: vector(3),
            duv: vector(4),
            dvv: vector(5),
        }
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        self.domain
    }

    fn sides(&self) -> Sides {
        Sides::default()
    }
}
