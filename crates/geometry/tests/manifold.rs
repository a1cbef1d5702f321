//! From a scene's objects to manifolds and to geodesics as polylines.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use geometry::{
    GeodesicSegment, GeodesicStart, MAX_DECLARED_EVALUATIONS, MAX_LINE_EVALUATIONS, Manifold,
    ManifoldError, evaluations_per_line, follow_declared, knots_at, lies_in_space,
};
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
    assert!(surface.surface().is_embedded());
    // The param is at its minimum.
    let position = surface.surface().jet([0.0, FRAC_PI_2].into()).position;
    assert!((position[0] - 2.0).abs() < 1e-12, "{position:?}");
    let metric = manifold(&scene, "m").expect("a metric");
    assert!(!metric.surface().is_embedded());
}

#[test]
fn other_objects_are_refused_with_their_name() {
    let scene = scene();
    let refused = manifold(&scene, "p").expect_err("a point");
    let name = Some("p".to_owned());
    assert_eq!(refused, ManifoldError::NoSurface { name });
    let missing = Manifold::new(&scene, ObjectId::new(99), &[]).expect_err("no object");
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
        max_evaluations: 10_000,
    };
    let first = manifold.polylines(&[segment]);
    let points: Vec<[f64; 2]> = first[0].points.iter().flatten().copied().collect();
    assert_eq!(points.len(), 5);
    // Along the equator of a sphere of radius 2.
    for (k, [u, v]) in points.into_iter().enumerate() {
        assert!((u - 1.0 - PI / 8.0 * k as f64).abs() < 1e-8, "{u}");
        assert!((v - FRAC_PI_2).abs() < 1e-8, "{v}");
    }
    let again = manifold.clone().polylines(&[segment]);
    assert!(Arc::ptr_eq(&first[0].points, &again[0].points));
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

#[test]
fn a_geodesic_whose_evaluations_are_used_up_has_the_knots_before_that() {
    let scene = scene();
    let manifold = manifold(&scene, "s").expect("a surface");
    let start = GeodesicStart::Chart([0.0, FRAC_PI_2], [1.0, 0.3]);
    let lengths: Vec<f64> = (-50..=50).map(|k| 3.0 * f64::from(k)).collect();
    let whole = knots_at(manifold.surface(), &start, &lengths, MAX_LINE_EVALUATIONS);
    assert!(!whole.is_cut && whole.knots.iter().all(Option::is_some));
    assert!(!whole.ends_early);
    // What lies behind the start is followed first.
    let cut = knots_at(manifold.surface(), &start, &lengths, 2_000);
    assert!(cut.is_cut && cut.ends_early);
    assert!(cut.knots[100].is_none());
    let reached = cut.knots.iter().flatten().count();
    assert!((10..90).contains(&reached), "{reached}");
}

#[test]
fn the_evaluations_of_a_scene_are_shared_by_its_geodesics() {
    let all = MAX_DECLARED_EVALUATIONS;
    assert_eq!(evaluations_per_line(&scene(), 1), MAX_LINE_EVALUATIONS);
    assert_eq!(evaluations_per_line(&scene(), 1_000), all / 1_000);
    let many: String = (0..100)
        .map(|k| format!("geodesic g{k}(t) : s = (0, 1) @ (0, pi/2), t : [0, 1e6];\n"))
        .collect();
    let text = PROGRAM.replace(
        "geodesic g(t) : s = (0, 1) @ (0, pi/2), t : [0, 2, 5];\n",
        &many,
    );
    let scene = scene::geotrace::compile(&text).scene.expect("a scene");
    assert_eq!(evaluations_per_line(&scene, 1), all / 100);
    assert_eq!(evaluations_per_line(&scene, 1_000), all / 100_000);
    let (id, _) = scene.object("g7").expect("a geodesic");
    let followed = follow_declared(&scene, &ParamValues::initial(&scene), id);
    let [note] = &followed.notes[..] else {
        panic!("{:?}", followed.notes);
    };
    assert!(note.starts_with("`g7` is not drawn to its end"), "{note}");
}
