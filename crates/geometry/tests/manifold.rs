//! From a scene's objects to manifolds and to geodesics as polylines.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use geometry::{GeodesicSegment, Manifold, ManifoldError, follow_declared, lies_in_space};
use scene::{ObjectId, ParamValues, Scene};

const PROGRAM: &str = "\
param r : [2, 3];
surface s(u,v) = r(cosu sinv, sinu sinv, cosv), u : [0,2pi], v : [0,pi];
metric m(u,v) = (1, 0, sin(u)^2), u : [0.1,3], v : [0,2pi];
point p = (0, 0, 0);
geodesic g(t) : s = (0, 1) @ (0, pi/2), t : [0, 2, 5];
";

fn scene() -> Scene {
    let compilation = scene::geotrace::compile(PROGRAM);
    compilation
        .scene
        .unwrap_or_else(|| panic!("{:?}", compilation.diagnostics))
}

fn manifold(scene: &Scene, name: &str) -> Result<Manifold, ManifoldError> {
    let (id, object) = scene.object(name).expect("an object");
    let uniforms = ParamValues::initial(scene).first_instance(scene, object);
    Manifold::new(scene, id, &uniforms)
}

#[test]
fn a_surface_lies_in_space_and_a_metric_does_not() {
    let scene = scene();
    let surface = manifold(&scene, "s").expect("a surface");
    assert!(surface.parametric().is_some());
    // The param is at its minimum.
    let position = surface.surface().jet([0.0, FRAC_PI_2].into()).position;
    assert!((position[0] - 2.0).abs() < 1e-12, "{position:?}");
    let metric = manifold(&scene, "m").expect("a metric");
    assert!(metric.parametric().is_none());
    assert!(!metric.surface().is_embedded());
}

#[test]
fn other_objects_are_refused_with_their_name() {
    let scene = scene();
    let refused = manifold(&scene, "p").expect_err("a point");
    let name = Some("p".to_owned());
    assert_eq!(refused, ManifoldError::NoSurface { name });
    let missing = Manifold::new(&scene, ObjectId(99), &[]).expect_err("no object");
    assert_eq!(missing, ManifoldError::NoSurface { name: None });
}

#[test]
fn a_geodesic_is_followed_once() {
    let scene = scene();
    let manifold = manifold(&scene, "s").expect("a surface");
    let segment = GeodesicSegment {
        start: [1.0, FRAC_PI_2],
        direction: [1.0, 0.0],
        lengths: [0.0, PI],
        pieces: 4,
    };
    let first = manifold.polylines(&[segment]);
    let points: Vec<[f64; 2]> = first[0].iter().flatten().copied().collect();
    assert_eq!(points.len(), 5);
    // Along the equator of a sphere of radius 2.
    for (k, [u, v]) in points.into_iter().enumerate() {
        assert!((u - 1.0 - PI / 8.0 * k as f64).abs() < 1e-8, "{u}");
        assert!((v - FRAC_PI_2).abs() < 1e-8, "{v}");
    }
    let again = manifold.clone().polylines(&[segment]);
    assert!(Arc::ptr_eq(&first[0], &again[0]));
}

#[test]
fn declared_geodesics_have_knots_at_their_samples() {
    let scene = scene();
    let (id, _) = scene.object("g").expect("a geodesic");
    assert!(lies_in_space(&scene, id));
    let followed = follow_declared(&scene, &ParamValues::initial(&scene), id);
    assert_eq!((followed.count, followed.lines.len()), (5, 1));
    assert!(followed.notes.is_empty(), "{:?}", followed.notes);
    // A meridian of a sphere of radius 2, from the equator downwards.
    let last = followed.lines[0][4].and_then(|knot| knot.position);
    let [x, _, z] = last.expect("a knot in space");
    assert!((x - 2.0 * 1_f64.cos()).abs() < 1e-8, "{x}");
    assert!((z + 2.0 * 1_f64.sin()).abs() < 1e-8, "{z}");
}
