//! The look `crt` against its formula, by hand, for single rays.

use expr::{Graph, Input};
use glam::{DAffine3, DVec3};
use tracer::light::{Light, LightKind};
use tracer::shade::{EyeSample, FaceLook, LightTracer, Scenery};
use tracer::{PictureLook, Ray, SetStep, Sheets, WorldBuilder, gamma_encoded};

const ABOVE: DVec3 = DVec3::new(0.25, 0.5, 0.75);

/// The light from a ball of radius 1 about 0, along a ray.
fn seen(look: FaceLook, lights: &[Light], bounces: u32, ray: Ray) -> DVec3 {
    let mut graph = Graph::default();
    let squares = [0, 1, 2].map(|k| {
        let x = graph.input(Input::Variable(k));
        graph.mul(x, x)
    });
    let sum = graph.add(squares[0], squares[1]);
    let sum = graph.add(sum, squares[2]);
    let one = graph.constant(1.0);
    let ball = graph.sub(sum, one);
    let nowhere = |_: Input| f64::NAN;
    let mut builder = WorldBuilder::new(&graph, &nowhere);
    let ball = builder.shape(ball, [None; 3]).expect("a shape");
    let steps = [SetStep::Leaf(ball, DAffine3::IDENTITY)];
    builder.solid(steps).expect("a solid");
    let world = builder.build().expect("a world");
    let sheets = Sheets::default();
    let scenery = Scenery {
        world: &world,
        sheets: &sheets,
        glass: &[],
        look: &|_| look,
        lights,
        background: &|_| ABOVE,
        bounces,
        picture_look: PictureLook::Crt,
        opaque: &[],
        sides: &[],
    };
    LightTracer::new(&scenery).light(&ray, EyeSample::default())
}

#[test]
fn a_ball_has_the_light_of_the_formula() {
    let colour = DVec3::new(0.9, 0.5, 0.1);
    let look = FaceLook {
        colour,
        diffuse: Some(0.6),
        specular: 0.3,
        shininess: 5.0,
        mirror: DVec3::splat(0.25),
        ..FaceLook::default()
    };
    let place = DVec3::new(1.0, -3.0, 2.0);
    let shine = DVec3::new(1.0, 0.8, 2.0);
    let light = Light {
        ambient: 0.1,
        falloff: Some(3.0),
        ..Light::new(LightKind::Point(place), shine)
    };
    let origin = DVec3::new(0.3, -4.0, 0.2);
    let ray = Ray {
        origin,
        direction: DVec3::Y,
        leaving: None,
    };
    let height = (1.0f64 - 0.09 - 0.04).sqrt();
    let hit = DVec3::new(0.3, -height, 0.2);
    let (n, way, to) = (hit, 4.0 - height, place - hit);
    let (l, r) = (to.normalize(), to.length());
    let share = (3.0 / (r + way)).powi(2);
    let away = l - 2.0 * l.dot(n) * n;
    let bright = 0.3 * away.dot(DVec3::Y).max(0.0).powf(5.0);
    let lit = 0.1 * shine * 0.75 + share * colour * shine * (0.6 * n.dot(l) + bright);
    assert!(bright > 0.0);
    let none = seen(look, &[light], 0, ray);
    assert!(none.distance(lit) < 1e-12, "{none} {lit}");
    let once = seen(look, &[light], 1, ray);
    assert!(once.distance(lit + 0.25 * ABOVE) < 1e-12, "{once}");
}

#[test]
fn bytes_are_cut() {
    let light = DVec3::new(0.5, 1.7, 0.2);
    assert_eq!(gamma_encoded(light, 1.0), [127, 255, 51]);
    assert_eq!(gamma_encoded(light, 2.0), [180, 255, 114]);
}
