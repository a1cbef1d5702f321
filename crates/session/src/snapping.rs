//! Picking for measurements, and the points to which clicks then snap: declared points on a surface, the ends of
//! declared geodesics, and the lettered points of figures.
//!
//! In: a request and a pixel. Out: the point to measure there, or the exact snapped point within a few pixels, with its
//! pixel. The points of a scene are computed once for its params.

use std::sync::Arc;

use expr::tape::{Registers, Tape};
use geodesic::measure;
use geodesic::surface::Surface;
use geodesic::vector::{dot, norm};
use geometry::{Manifold, follow_declared};
use render::point::{PixelPoint, WorldPoint};
use render::shared::Shared;
use render::view::Hit;
use render::{PictureRequest, Renderer};
use scene::{Object, ObjectId, ParamValues, Scene, Shape};

/// The maximum distance between a click and a point to which it snaps, in pixels.
const REACH: f64 = 10.0;
/// The distance of the pixels that determine the scale of a geodesic view on its surface, in pixels.
const PROBE: f64 = 2.0;
/// The maximum distance of a point that counts as on a surface, as a fraction of the surface's size.
const ON_SURFACE: f64 = 1e-6;
/// The maximum distance between a picked point and a target that counts as visible there, as a fraction of the scene's
/// radius.
const SEEN: f64 = 0.03;
/// The number of points along each side of a domain from which the search for a point starts.
const LATTICE: u32 = 32;
/// The maximum number of steps of that search.
const STEPS: u32 = 40;
/// The maximum number of instances of an object.
const INSTANCES: u64 = 64;

/// A point to which clicks snap.
#[derive(Clone, Copy, Debug)]
struct SnapTarget {
    surface: ObjectId,
    uv: [f64; 2],
    /// Its position in space; `None` on a metric.
    position: Option<[f64; 3]>,
}

/// The treatment of a click near a point, an end or a corner.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Snapping {
    /// The click snaps to it.
    On,
    /// The click stays where it is.
    Off,
}

/// The points of a scene to which clicks snap.
#[derive(Debug)]
pub struct SnapTargets {
    scene: Shared<Scene>,
    param_values: Arc<ParamValues>,
    declared: Vec<SnapTarget>,
}

/// The result of snapping.
#[derive(Clone, Copy, Debug)]
struct Snap {
    hit: Hit,
    at: PixelPoint,
}

/// A point of a picture at which something is measured.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasuredPlace {
    /// The object and point there; `None` if there is none.
    pub hit: Option<Hit>,
    /// The pixel that was snapped to; `None` if the click did not snap.
    pub snapped: Option<PixelPoint>,
}

/// Returns the point that a click on a pixel measures. If a line covers a surface or a metric there, the latter is
/// measured. `known` caches the scene's snap targets.
pub fn measured_place(
    renderer: &mut Renderer,
    known: &mut Option<SnapTargets>,
    request: &PictureRequest,
    at: PixelPoint,
    snapping: Snapping,
) -> MeasuredPlace {
    if snapping == Snapping::On
        && let Some(Snap { hit, at }) = snap(renderer, known, request, at)
    {
        return MeasuredPlace {
            hit: Some(hit),
            snapped: Some(at),
        };
    }
    let mut hit = renderer.pick(request, at).ok().flatten();
    if let Some(found) = &hit
        && !is_measurable(&request.scene, found.object)
        && let Some(beneath) = without_lines(request)
        && let Ok(Some(below)) = renderer.pick(&beneath, at)
    {
        hit = Some(below);
    }
    MeasuredPlace { hit, snapped: None }
}

/// Returns true if points of an object can be measured.
fn is_measurable(scene: &Scene, id: ObjectId) -> bool {
    scene
        .get(id)
        .is_some_and(|object| object.shape.manifold().is_some())
}

/// Returns the request of a view in space without points, vectors and curves; `None` for another view.
fn without_lines(request: &PictureRequest) -> Option<PictureRequest> {
    let mut request = request.clone();
    let scene = request.scene.clone();
    let space = request.view.space_mut()?;
    let is_line = |object: &Object| !object.shape.is_surface() && object.shape.solid().is_none();
    let lines = scene.numbered().filter(|(_, object)| is_line(object));
    space.hidden.extend(lines.map(|(id, _)| id));
    Some(request)
}

/// Returns the target to which a click on a pixel snaps. `known` caches the scene's snap targets.
fn snap(
    renderer: &mut Renderer,
    known: &mut Option<SnapTargets>,
    request: &PictureRequest,
    at: PixelPoint,
) -> Option<Snap> {
    let is_known = known
        .as_ref()
        .is_some_and(|it| it.scene == request.scene && it.param_values == request.params);
    if !is_known {
        *known = Some(SnapTargets {
            scene: request.scene.clone(),
            param_values: request.params.clone(),
            declared: declared(&request.scene, &request.params),
        });
    }
    let declared = known.as_ref().map_or(&[][..], |it| &it.declared);
    let corners = corners(request);
    let targets = declared.iter().chain(&corners);
    match request.view.geodesic_camera() {
        Some(camera) => from_inside(
            renderer,
            request,
            at,
            targets.filter(|it| it.surface == camera.surface),
        ),
        None => in_space(renderer, request, at, targets),
    }
}

/// Snaps in a view in space, to the nearest visible target.
fn in_space<'t>(
    renderer: &mut Renderer,
    request: &PictureRequest,
    at: PixelPoint,
    targets: impl Iterator<Item = &'t SnapTarget>,
) -> Option<Snap> {
    let camera = renderer.camera(request).ok()?;
    let pixel = |target: &SnapTarget| {
        let local = camera.placement.local(WorldPoint(target.position?));
        camera.pixel_of(local)
    };
    let mut near: Vec<(f64, PixelPoint, &SnapTarget)> = targets
        .filter_map(|target| {
            let place = pixel(target)?;
            Some((distance(place, at), place, target))
        })
        .filter(|(far, ..)| *far <= REACH)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    near.into_iter().find_map(|(_, place, target)| {
        let seen = renderer.pick(request, place).ok().flatten()?;
        let (WorldPoint(seen), position) = (seen.position?, target.position?);
        let off = [0, 1, 2].map(|k| seen[k] - position[k]);
        let radius = camera.placement.radius;
        (norm(off) <= SEEN * radius).then(|| Snap {
            hit: target.hit(),
            at: place,
        })
    })
}

/// Snaps in a geodesic view. The points of the surface at the neighbouring pixels determine the distance of a target
/// from the click in pixels.
fn from_inside<'t>(
    renderer: &mut Renderer,
    request: &PictureRequest,
    at: PixelPoint,
    targets: impl Iterator<Item = &'t SnapTarget>,
) -> Option<Snap> {
    let targets: Vec<&SnapTarget> = targets.collect();
    let surface = targets.first()?.surface;
    let manifold = Manifold::first(&request.scene, &request.params, surface).ok()?;
    let surface = manifold.surface();
    let mut place = |dx: f64, dy: f64| {
        let pixel = PixelPoint([at.0[0] + dx, at.0[1] + dy]);
        Some(renderer.pick(request, pixel).ok()??.parameters)
    };
    let (here, right, below) = (place(0.0, 0.0)?, place(PROBE, 0.0)?, place(0.0, PROBE)?);
    let right = measure::shortest_step(surface, here, right);
    let below = measure::shortest_step(surface, here, below);
    let pixels = |target: &SnapTarget| {
        let step = measure::shortest_step(surface, here, target.uv);
        let probes = measure::components(right, below, step)?;
        Some(probes.map(|x| PROBE * x))
    };
    let offsets = targets
        .iter()
        .filter_map(|target| Some((pixels(target)?, target)));
    let near = offsets.filter(|([x, y], _)| x.hypot(*y) <= REACH);
    let ([x, y], target) = near.min_by(|a, b| {
        let [a, b] = [a.0, b.0].map(|[x, y]| x.hypot(y));
        a.total_cmp(&b)
    })?;
    Some(Snap {
        hit: target.hit(),
        at: PixelPoint([at.0[0] + x, at.0[1] + y]),
    })
}

impl SnapTarget {
    fn hit(&self) -> Hit {
        Hit {
            object: self.surface,
            position: self.position.map(WorldPoint),
            parameters: self.uv,
            instance: 0,
            leaf: None,
            polar: None,
        }
    }
}

/// Returns the lettered points of the figures in a picture.
fn corners(request: &PictureRequest) -> Vec<SnapTarget> {
    let marks = request
        .trails
        .iter()
        .filter_map(|trail| Some((trail.surface, trail.mark?.at)));
    let mut last: Option<(ObjectId, Manifold)> = None;
    let mut all = Vec::new();
    for (id, uv) in marks {
        if last.as_ref().is_none_or(|(known, _)| *known != id) {
            let manifold = Manifold::first(&request.scene, &request.params, id);
            last = manifold.ok().map(|it| (id, it));
        }
        if let Some((_, manifold)) = &last {
            all.push(target(manifold.surface(), id, uv));
        }
    }
    all
}

/// Returns the declared points that lie on surfaces, and the ends of the declared geodesics.
fn declared(scene: &Scene, params: &ParamValues) -> Vec<SnapTarget> {
    let points: Vec<[f64; 3]> = scene
        .objects
        .iter()
        .flat_map(|object| positions(scene, params, object))
        .collect();
    let mut all = Vec::new();
    for (id, object) in scene.numbered() {
        if object.shape.manifold().is_none() {
            continue;
        }
        let Ok(manifold) = Manifold::first(scene, params, id) else {
            continue;
        };
        let surface = manifold.surface();
        if surface.is_embedded() {
            let places = points.iter().filter_map(|place| locate(surface, *place));
            all.extend(places.map(|uv| target(surface, id, uv)));
        }
        for (geodesic, _) in scene.geodesics_on(id) {
            let followed = follow_declared(scene, params, geodesic);
            for line in followed.lines.iter().take(INSTANCES as usize) {
                let ends = [line.first(), line.last()].into_iter().flatten().flatten();
                all.extend(ends.map(|knot| target(surface, id, knot.uv)));
            }
        }
    }
    all
}

fn target(surface: &dyn Surface, id: ObjectId, uv: [f64; 2]) -> SnapTarget {
    let position = || surface.jet(uv.into()).position;
    SnapTarget {
        surface: id,
        uv,
        position: surface.is_embedded().then(position),
    }
}

/// Returns the positions of the instances of a point; empty for another object.
fn positions(scene: &Scene, params: &ParamValues, object: &Object) -> Vec<[f64; 3]> {
    let Shape::Point { position } = &object.shape else {
        return Vec::new();
    };
    let tape = Tape::new(&scene.graph, position);
    let instances = params.instance_count(scene, object).min(INSTANCES);
    let place = |index: u64| {
        let uniforms = params.instance(scene, object, index);
        let inputs = tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&[], &uniforms)).collect();
        let mut out = [f64::NAN; 3];
        tape.eval(&mut Registers::default(), &inputs, &mut out);
        out
    };
    (0..instances).map(place).collect()
}

/// Returns the (u, v) of a surface at a point of space; `None` if the point is not on the surface.
///
/// Gauss–Newton steps start from the nearest point of a lattice.
fn locate(surface: &dyn Surface, place: [f64; 3]) -> Option<[f64; 2]> {
    let domain = surface.domain();
    let off = |uv: [f64; 2]| {
        let position = surface.jet(uv.into()).position;
        [0, 1, 2].map(|k| place[k] - position[k])
    };
    let share = |axis: usize, k: u32| {
        let [low, high] = domain[axis];
        low + (high - low) * f64::from(k) / f64::from(LATTICE)
    };
    let lattice = (0..=LATTICE).flat_map(|i| (0..=LATTICE).map(move |j| (i, j)));
    let lattice = lattice.map(|(i, j)| [share(0, i), share(1, j)]);
    let far = |uv: &[f64; 2]| norm(off(*uv));
    let finite = lattice.filter(|uv| far(uv).is_finite());
    let mut uv = finite.min_by(|a, b| far(a).total_cmp(&far(b)))?;
    for _ in 0..STEPS {
        let jet = surface.jet(uv.into());
        let off = off(uv);
        let [e, f, g] = [
            dot(jet.du, jet.du),
            dot(jet.du, jet.dv),
            dot(jet.dv, jet.dv),
        ];
        let [p, q] = [dot(jet.du, off), dot(jet.dv, off)];
        let determinant = e * g - f * f;
        if determinant <= 1e-12 * e * g || !determinant.is_finite() {
            break;
        }
        let step = [(p * g - f * q) / determinant, (e * q - p * f) / determinant];
        uv = [0, 1].map(|k| (uv[k] + step[k]).clamp(domain[k][0], domain[k][1]));
    }
    (far(&uv) <= ON_SURFACE * surface.scale().size).then_some(uv)
}

fn distance(PixelPoint(a): PixelPoint, PixelPoint(b): PixelPoint) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use scene::{ObjectId, ParamValues};

    use super::{declared, locate};
    use geometry::Manifold;

    #[test]
    fn a_point_of_a_surface_is_found_and_no_other() {
        let text = "surface s(u, v) = ((2 + cos v) cos u, (2 + cos v) sin u, sin v), u : [0, 2pi], v : [0, 2pi];";
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let torus = Manifold::first(&scene, &params, ObjectId::new(0)).expect("a surface");
        let place = |u: f64, v: f64| {
            let r = 2.0 + v.cos();
            [r * u.cos(), r * u.sin(), v.sin()]
        };
        for [u, v] in [[1.0, 2.0], [6.2, 0.01], [3.3, 6.0]] {
            let found = locate(torus.surface(), place(u, v)).expect("it is there");
            assert!(
                (found[0] - u).abs() < 1e-9 && (found[1] - v).abs() < 1e-9,
                "{found:?}"
            );
        }
        assert_eq!(locate(torus.surface(), [2.0, 0.0, 0.0]), None);
    }

    #[test]
    fn points_on_surfaces_and_ends_of_geodesics_are_targets() {
        let text = "param a = 1 : [0, 2];
            surface s(u, v) = (u, v, a u v), u : [0, 2], v : [0, 2];
            metric h(u, v) = (1, 0, 1), u : [0, 4], v : [0, 1];
            point p = (1, 1, a);
            point beside = (1, 1, 5);
            geodesic g(t) : h = (1, 0) @ (0.5, 0.5), t : [0, 2];";
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let found = declared(&scene, &params);
        let places: Vec<(usize, [f64; 2])> = found
            .iter()
            .map(|it| (it.surface.index(), it.uv.map(|x| (x * 1e6).round() / 1e6)))
            .collect();
        assert_eq!(places, [(0, [1.0, 1.0]), (1, [0.5, 0.5]), (1, [2.5, 0.5])]);
    }
}
