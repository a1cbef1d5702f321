//! Light against closed forms.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine3, DVec3};
use tracer::camera::{Bokeh, LensCamera, LensProjection, SampleAxes};
use tracer::light::{Light, LightKind};
use tracer::optics::{fresnel, reflected, refracted};
use tracer::shade::{EyeSample, Face, FaceLook, FaceObject, Glass, LightTracer, Scenery};
use tracer::srgb;
use tracer::{Ray, SetStep, Sheet, Sheets, World, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

/// Solid 0 is the ground z ≤ 0, solid 1 a unit ball at a height, solid 2 a slab 2 ≤ x ≤ 3.
fn world(height: f64) -> World {
    let [x, y, z] = variables();
    let ground = z.clone() + 0.0;
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let slab = (x - 2.5).abs() - 0.5;
    let graph = slab.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let places = [0.0, height, 0.0].map(|z| DAffine3::from_translation(DVec3::new(0.0, 0.0, z)));
    for (formula, place) in [ground, ball, slab].iter().zip(places) {
        let shape = builder.shape(formula.node(), [None; 3]).unwrap();
        builder.solid([SetStep::Leaf(shape, place)]).unwrap();
    }
    builder.build().unwrap()
}

/// A solid for each formula.
fn solids(formulas: &[Formula]) -> World {
    let graph = formulas[0].graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    for formula in formulas {
        let shape = builder.shape(formula.node(), [None; 3]).unwrap();
        let steps = [SetStep::Leaf(shape, DAffine3::IDENTITY)];
        builder.solid(steps).unwrap();
    }
    builder.build().unwrap()
}

/// A scenery without glass, lights and background.
fn scenery<'a>(
    world: &'a World,
    sheets: &'a Sheets,
    look: &'a (dyn Fn(&Face) -> FaceLook + Sync),
) -> Scenery<'a> {
    Scenery {
        world,
        sheets,
        glass: &[],
        look,
        lights: &[],
        background: &black,
        bounces: 16,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    }
}

/// Glass of this colour that lets everything through.
fn clear(colour: DVec3) -> FaceLook {
    FaceLook {
        colour,
        diffuse: Some(0.0),
        specular: 0.0,
        glass: 1.0,
        ..FaceLook::default()
    }
}

/// A face that scatters all light.
fn matt(colour: DVec3) -> FaceLook {
    FaceLook {
        colour,
        diffuse: Some(1.0),
        specular: 0.0,
        ..FaceLook::default()
    }
}

fn power(colour: DVec3, exponent: f64) -> DVec3 {
    DVec3::from_array(colour.to_array().map(|c| c.powf(exponent)))
}

#[track_caller]
fn assert_light(actual: DVec3, expected: DVec3) {
    let close = actual.distance(expected) <= 1e-12;
    assert!(close, "{actual}, not {expected}");
}

fn black(_: DVec3) -> DVec3 {
    DVec3::ZERO
}

fn light(kind: LightKind) -> Light {
    Light::new(kind, DVec3::ONE)
}

/// The number of the solid that a face belongs to.
fn solid(face: &Face) -> usize {
    match face.of {
        FaceObject::Solid { solid, .. } => solid,
        FaceObject::Sheet { .. } => usize::MAX,
    }
}

/// The light that comes to a place from a direction.
fn seen(tracer: &mut LightTracer<'_>, origin: DVec3, direction: DVec3) -> DVec3 {
    let ray = Ray {
        origin,
        direction,
        leaving: None,
    };
    tracer.light(&ray, EyeSample::default())
}

#[track_caller]
fn assert_close(actual: f64, expected: f64, tolerance: f64) {
    let close = (actual - expected).abs() <= tolerance;
    assert!(close, "{actual:?}, not {expected:?}");
}

#[test]
#[should_panic(expected = "not 1.0")]
fn closeness_can_fail() {
    assert_close(1.1, 1.0, 0.01);
}

#[test]
fn fresnel_and_snell_are_their_closed_forms() {
    // At right angles ((n − 1)/(n + 1))²; at Brewster's angle only one polarisation is reflected.
    assert_close(fresnel(1.0, 1.0, 1.5), 0.04, 1e-15);
    let brewster = 1.5f64.atan();
    let sine = brewster.sin() / 1.5;
    let across = ((brewster - sine.asin()).sin() / (brewster + sine.asin()).sin()).powi(2);
    assert_close(fresnel(brewster.cos(), 1.0, 1.5), 0.5 * across, 1e-15);
    assert_eq!(fresnel(0.3, 1.5, 1.0), 1.0);
    assert_eq!(fresnel(0.3, 1.3, 1.3), 0.0);
    // The same share from either side.
    let inside = (1.0f64 - (0.6f64.sin() / 1.5).powi(2)).sqrt();
    assert_close(
        fresnel(0.6f64.cos(), 1.0, 1.5),
        fresnel(inside, 1.5, 1.0),
        1e-15,
    );
    let direction = DVec3::new(0.6, 0.0, -0.8);
    let bent = refracted(direction, DVec3::Z, 1.0, 1.5).unwrap();
    assert_close(bent.x, 0.4, 1e-15);
    assert_close(bent.length(), 1.0, 1e-15);
    assert_eq!(refracted(direction, DVec3::Z, 2.0, 1.0), None);
    assert_eq!(refracted(direction, DVec3::Z, 1.5, 1.5), Some(direction));
    assert_eq!(reflected(direction, DVec3::Z), DVec3::new(0.6, 0.0, 0.8));
}

#[test]
fn lights_fade_and_end_as_their_formulas_say() {
    let point = Light {
        falloff: Some(2.0),
        ..light(LightKind::Point(DVec3::new(0.0, 0.0, 4.0)))
    };
    assert_close(point.from(DVec3::ZERO, [0.5; 2], 0.0).share, 0.25, 1e-15);
    let spot = |soft| {
        light(LightKind::Spot {
            position: DVec3::new(0.0, 0.0, 1.0),
            direction: DVec3::NEG_Z,
            angle: FRAC_PI_2,
            soft,
        })
    };
    // The edge is at 45°: at x = 1. Hard, then fading over the outer half, whose middle has half the light.
    assert_eq!(
        spot(0.0).from(DVec3::X * 0.999_999, [0.5; 2], 0.0).share,
        1.0
    );
    assert_eq!(
        spot(0.0).from(DVec3::X * 1.000_001, [0.5; 2], 0.0).share,
        0.0
    );
    let middle = DVec3::X * (0.75 * FRAC_PI_2 / 2.0).tan();
    assert_close(spot(0.5).from(middle, [0.5; 2], 0.0).share, 0.5, 1e-12);
    let beam = light(LightKind::Beam {
        position: DVec3::new(0.0, 0.0, 3.0),
        direction: DVec3::NEG_Z,
        radius: 0.5,
        soft: 0.0,
    });
    let seen = beam.from(DVec3::new(0.3, 0.0, 1.0), [0.5; 2], 0.0);
    assert_eq!(
        (seen.share, seen.distance, seen.towards),
        (1.0, 2.0, DVec3::Z)
    );
    assert_eq!(
        beam.from(DVec3::new(0.6, 0.0, 1.0), [0.5; 2], 0.0).share,
        0.0
    );
    assert_eq!(
        beam.from(DVec3::new(0.0, 0.0, 4.0), [0.5; 2], 0.0).share,
        0.0
    );
}

#[test]
fn ground_is_lit_by_the_cosine_and_dark_behind_a_ball() {
    let world = world(2.0);
    let look = |_: &Face| FaceLook {
        colour: DVec3::new(0.5, 0.25, 1.0),
        specular: 0.0,
        ..FaceLook::default()
    };
    let lights = [Light {
        ambient: 0.1,
        ..light(LightKind::Parallel(DVec3::new(0.0, -1.0, -1.0)))
    }];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &look,
        lights: &lights,
        background: &black,
        bounces: 8,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut tracer = LightTracer::new(&scenery);
    let cosine = 0.5f64.sqrt();
    let lit = seen(&mut tracer, DVec3::new(0.5, 3.0, 5.0), DVec3::NEG_Z);
    for (actual, colour) in lit.to_array().into_iter().zip([0.5, 0.25, 1.0]) {
        assert_close(actual, colour * (0.1 + cosine), 1e-14);
    }
    // The centre of the shadow is at y = −2.
    let dark = seen(&mut tracer, DVec3::new(0.0, -2.0, 0.5), DVec3::NEG_Z);
    assert_close(dark.y, 0.25 * 0.1, 1e-15);
}

#[test]
fn glass_bends_absorbs_and_reflects_exactly() {
    let world = world(2.0);
    let look = |face: &Face| FaceLook {
        colour: DVec3::new(0.5, 1.0, 0.25),
        diffuse: Some(0.0),
        specular: 0.0,
        glass: f64::from(u8::from(solid(face) == 2)),
        ..FaceLook::default()
    };
    let sky = |direction: DVec3| DVec3::splat(if direction.x > 0.0 { 1.0 } else { 0.0 });
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[
            None,
            None,
            Some(Glass {
                ior: 1.5,
                depth: 2.0,
                leaf: 2,
            }),
        ],
        look: &look,
        lights: &[],
        background: &sky,
        bounces: 64,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut tracer = LightTracer::new(&scenery);
    let angle = 0.5f64;
    let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let seen = seen(&mut tracer, DVec3::new(0.0, 0.0, 8.0), direction);
    // Through a plate: T² a (1 + R² a² + R⁴ a⁴ + …), a what a passage leaves.
    let inner = (angle.sin() / 1.5).asin();
    let share = fresnel(angle.cos(), 1.0, 1.5);
    for (actual, colour) in seen.to_array().into_iter().zip([0.5f64, 1.0, 0.25]) {
        let left = colour.powf(1.0 / inner.cos() / 2.0);
        let expected = (1.0 - share).powi(2) * left / (1.0 - (share * left).powi(2));
        // Rays below 2⁻¹⁰ of weight add nothing.
        assert_close(actual, expected, 1e-3);
    }
}

#[test]
fn light_that_a_bump_bends_back_stays_outside_of_the_glass() {
    let world = world(2.0);
    // The height turns the normal of the face x = 2 by 20 degrees; the ray comes to it at 44 degrees, just below total
    // reflection. It is bent by 83 degrees, which is 103 from the true normal.
    let tilt = 20.0f64.to_radians();
    let look = |face: &Face| FaceLook {
        glass: f64::from(u8::from(solid(face) == 2)),
        bump: tilt.tan() * DVec3::Y,
        ..clear(DVec3::splat(0.5))
    };
    let glass = Glass {
        ior: 0.7,
        leaf: 2,
        ..Glass::default()
    };
    let sheets = Sheets::default();
    let scenery = Scenery {
        glass: &[None, None, Some(glass)],
        background: &|_| DVec3::ONE,
        ..scenery(&world, &sheets, &look)
    };
    let mut tracer = LightTracer::new(&scenery);
    let angle = 64.0f64.to_radians();
    let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let light = seen(&mut tracer, DVec3::new(0.0, 0.0, 8.0), direction);
    assert_light(light, DVec3::ONE);
}

#[test]
fn an_opaque_face_is_seen_through_glass_that_lies_on_it() {
    let no_sheets = Sheets::default();
    let [_, _, z] = variables();
    let (slab, table) = ((&z - 0.5).abs() - 0.5, &z + 0.0);
    let colour = DVec3::new(0.6, 0.3, 0.1);
    let lights = [Light {
        ambient: 1.0,
        ..light(LightKind::Parallel(DVec3::ZERO))
    }];
    let glass = Glass {
        ior: 1.33,
        ..Glass::default()
    };
    for glass_first in [true, false] {
        let world = solids(&match glass_first {
            true => [slab.clone(), table.clone()],
            false => [table.clone(), slab.clone()],
        });
        let look = |face: &Face| match (solid(face) == 0) == glass_first {
            true => clear(DVec3::ONE),
            false => matt(colour),
        };
        let glass = [Some(glass).filter(|_| glass_first), Some(glass)];
        let scenery = Scenery {
            glass: &glass[..if glass_first { 1 } else { 2 }],
            lights: &lights,
            ..scenery(&world, &no_sheets, &look)
        };
        let mut tracer = LightTracer::new(&scenery);
        for slope in [0.0, 0.1, 0.3, 1.7] {
            let direction = DVec3::new(slope, 0.2, -1.0).normalize();
            let seen = seen(&mut tracer, DVec3::new(0.1, 0.2, 3.0), direction);
            let share = 1.0 - fresnel(-direction.z, 1.0, 1.33);
            assert_light(seen, share * colour);
        }
    }
}

#[test]
fn glass_that_touches_other_glass_has_its_own_colour() {
    let no_sheets = Sheets::default();
    let [_, _, z] = variables();
    let slabs = [(&z - 0.5).abs() - 0.5, (&z + 0.5).abs() - 0.5];
    let colours = [DVec3::new(1.0, 0.5, 0.25), DVec3::new(0.5, 0.5, 1.0)];
    let direction = DVec3::new(0.6, 0.0, -0.8);
    for order in [[0, 1], [1, 0]] {
        let world = solids(&order.map(|k| slabs[k].clone()));
        let look = |face: &Face| clear(colours[order[solid(face)]]);
        let glass = [2.0, 0.5].map(|depth| Glass {
            ior: 1.0,
            depth,
            leaf: 0,
        });
        let glass = order.map(|k| Some(glass[k]));
        let scenery = Scenery {
            glass: &glass,
            background: &|_| DVec3::ONE,
            ..scenery(&world, &no_sheets, &look)
        };
        let mut tracer = LightTracer::new(&scenery);
        let seen = seen(&mut tracer, DVec3::new(0.1, 0.2, 3.0), direction);
        let [first, second] = [0, 1].map(|k| power(colours[k], 1.25 / [2.0, 0.5][k]));
        assert_light(seen, first * second);
    }
}

#[test]
fn glass_gives_its_colour_to_shadows() {
    let no_sheets = Sheets::default();
    let [_, _, z] = variables();
    // The ground, glass that lies on it, and a pane above.
    let formulas = [&z + 0.0, (&z - 0.5).abs() - 0.5, (&z - 2.5).abs() - 0.5];
    let world = solids(&formulas);
    let colour = DVec3::new(0.9, 0.5, 0.3);
    let look = |face: &Face| match solid(face) {
        0 => matt(DVec3::new(0.8, 0.6, 0.4)),
        _ => FaceLook {
            glass: 0.6,
            ..clear(colour)
        },
    };
    let glass = |depth, leaf| {
        Some(Glass {
            ior: 1.0,
            depth,
            leaf,
        })
    };
    let glass = [None, glass(0.5, 1), glass(0.7, 2)];
    let lights = [light(LightKind::Parallel(DVec3::new(0.0, -0.6, -0.8)))];
    let scenery = Scenery {
        glass: &glass,
        lights: &lights,
        ..scenery(&world, &no_sheets, &look)
    };
    let mut tracer = LightTracer::new(&scenery);
    // From between both panes: the way of the eye is through the lower one too.
    let from_air = seen(&mut tracer, DVec3::new(0.0, 0.0, 1.5), DVec3::NEG_Z);
    let shadow = 0.6f64.powi(3) * power(colour, 1.25 / 0.5 + 1.25 / 0.7);
    let lit = 0.8 * DVec3::new(0.8, 0.6, 0.4) * shadow;
    assert_light(from_air, 0.6 * power(colour, 1.0 / 0.5) * lit);
    // From within the lower one.
    let from_within = seen(&mut tracer, DVec3::new(0.0, 0.0, 0.5), DVec3::NEG_Z);
    assert_light(from_within, power(colour, 0.5 / 0.5) * lit);
    // A light within it, and nothing between.
    let lights = [light(LightKind::Point(DVec3::new(0.0, 0.3, 0.4)))];
    let scenery = Scenery {
        lights: &lights,
        ..scenery
    };
    let mut tracer = LightTracer::new(&scenery);
    let near = seen(&mut tracer, DVec3::new(0.0, 0.0, 0.5), DVec3::NEG_Z);
    let lit = 0.8 * DVec3::new(0.8, 0.6, 0.4) * power(colour, 0.5 / 0.5);
    assert_light(near, power(colour, 0.5 / 0.5) * lit);
}

#[test]
fn faces_at_one_place_let_light_through_as_one() {
    let [u, v, _] = &variables();
    let [_, _, z] = variables();
    let pane = |height: f64| {
        let position = [u.node(), v.node(), u.number(height).node()];
        Sheet::new(&u.graph(), position, [[-9.0, 9.0]; 2], &|_| f64::NAN).unwrap()
    };
    let ground = &z + 2.0;
    let slab = (&z - 0.5).abs() - 0.5;
    let below = (&z + 0.5).abs() - 0.5;
    // The glass on the way, and the number of places at which light passes a face of it.
    let cases = [
        (vec![&slab], vec![], 2),
        (vec![&slab, &slab], vec![], 2),
        (vec![&slab, &below], vec![], 3),
        (vec![&slab], vec![1.0], 2),
        (vec![&slab, &below], vec![0.0, 1.0, 1.5], 4),
        (vec![], vec![0.5, 0.5], 1),
    ];
    let lights = [light(LightKind::Parallel(DVec3::NEG_Z))];
    for (glass, panes, places) in cases {
        let formulas = [&ground].into_iter().chain(glass).cloned();
        let world = solids(&formulas.collect::<Vec<_>>());
        let sheets = Sheets::new(panes.iter().map(|&height| pane(height)).collect());
        let look = |face: &Face| match solid(face) {
            0 => matt(DVec3::ONE),
            _ => FaceLook {
                glass: 0.6,
                ..clear(DVec3::ONE)
            },
        };
        let glass = Glass {
            ior: 1.0,
            ..Glass::default()
        };
        let scenery = Scenery {
            glass: &[None, Some(glass), Some(glass)],
            lights: &lights,
            ..scenery(&world, &sheets, &look)
        };
        let mut tracer = LightTracer::new(&scenery);
        let share = 0.6f64.powi(places);
        let [beside, through] = [-1.5, 3.0].map(|height| {
            let eye = DVec3::new(0.1, 0.2, height);
            seen(&mut tracer, eye, DVec3::NEG_Z).x
        });
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-12;
        let is_one = close(beside, share) && close(through, share * share);
        assert!(is_one, "{places} places, {panes:?}: {beside}, {through}");
    }
}

#[test]
fn an_eye_within_glass_sees_its_colour() {
    let no_sheets = Sheets::default();
    let [_, _, z] = variables();
    let world = solids(&[(&z - 0.5).abs() - 0.5]);
    let colour = |place: DVec3| DVec3::new(0.3, 0.9, 0.5 + 0.1 * place.x);
    let look = |face: &Face| clear(colour(face.position));
    let glass = [Some(Glass {
        ior: 1.0,
        ..Glass::default()
    })];
    let scenery = Scenery {
        glass: &glass,
        background: &|_| DVec3::ONE,
        ..scenery(&world, &no_sheets, &look)
    };
    let mut tracer = LightTracer::new(&scenery);
    let eye = DVec3::new(2.0, 0.0, 0.5);
    let through = seen(&mut tracer, eye, DVec3::new(0.0, 0.8, 0.6));
    assert_light(through, power(colour(eye), 0.5 / 0.6));
    // Along the slab there is no end of it.
    assert_light(seen(&mut tracer, eye, DVec3::Y), DVec3::ZERO);
}

#[test]
fn a_surface_on_the_face_of_a_solid_is_seen_evenly() {
    let [u, v, _] = &variables();
    let normal = DVec3::new(0.6, 0.48, 0.64);
    let along = DVec3::new(0.8, -0.36, -0.48);
    let across = normal.cross(along);
    let [x, y, z] = variables();
    let half_space = 0.6 * x + 0.48 * y + 0.64 * z - 0.7;
    let world = solids(&[half_space]);
    let place = |k: usize| along[k] * u + across[k] * v + 0.7 * normal[k];
    let nodes = [0, 1, 2].map(place);
    let graph = nodes[0].graph().clone();
    let nodes = nodes.each_ref().map(Formula::node);
    let sheet = Sheet::new(&graph, nodes, [[-9.0, 9.0]; 2], &|_| f64::NAN).unwrap();
    let sheets = Sheets::new(vec![sheet]);
    let lights = [light(LightKind::Parallel(-normal))];
    let [on_solid, on_sheet] = [DVec3::X, DVec3::Y];
    for share in [0.0, 0.5] {
        let look = |face: &Face| match face.of {
            FaceObject::Solid { .. } => matt(on_solid),
            FaceObject::Sheet { .. } => FaceLook {
                glass: share,
                ..matt(on_sheet)
            },
        };
        let scenery = Scenery {
            lights: &lights,
            ..scenery(&world, &sheets, &look)
        };
        let mut tracer = LightTracer::new(&scenery);
        let mut random = Random(12);
        for _ in 0..300 {
            let direction = random.direction();
            let direction = direction * -direction.dot(normal).signum();
            let origin = random.vector(1.0) + 3.0 * normal;
            // Beside the surface only the solid is there.
            let reach = (origin.dot(normal) - 0.7) / -direction.dot(normal);
            if reach > 5.0 {
                continue;
            }
            let seen = seen(&mut tracer, origin, direction);
            assert_light(seen, if share == 0.0 { on_sheet } else { on_solid });
        }
    }
}

#[test]
fn mirrors_show_the_sky_and_a_white_furnace_stays_white() {
    let world = world(1.5);
    let sky = |_: DVec3| DVec3::ONE;
    let mut random = Random(4);
    let glass = [Some(Glass::default()); 3];
    for kind in 0..3 {
        let look = |face: &Face| {
            let mut look = FaceLook {
                specular: 0.0,
                diffuse: Some(0.0),
                ..FaceLook::default()
            };
            match (kind + solid(face)) % 3 {
                0 => look.mirror = DVec3::ONE,
                1 => (look.mirror, look.glass) = (DVec3::splat(0.3), 0.9),
                _ => (look.diffuse, look.mirror) = (Some(0.5), DVec3::splat(0.5)),
            }
            look
        };
        let lights = [Light {
            ambient: 0.5,
            colour: DVec3::splat(0.6),
            ..light(LightKind::Point(DVec3::new(-4.0, 3.0, 5.0)))
        }];
        let scenery = Scenery {
            world: &world,
            sheets: &Sheets::default(),
            glass: &glass,
            look: &look,
            lights: &lights,
            background: &sky,
            bounces: 16,
            picture_look: Default::default(),
            opaque: &[],
            sides: &[],
        };
        let mut tracer = LightTracer::new(&scenery);
        for _ in 0..500 {
            let origin = DVec3::new(-3.0, 0.5, 2.0) + random.vector(1.0);
            let seen = seen(&mut tracer, origin, random.direction());
            assert!(
                seen.max_element() <= 1.0 + 1e-12 && seen.min_element() >= 0.0,
                "{seen}"
            );
        }
    }
    let look = |_: &Face| FaceLook {
        diffuse: Some(0.0),
        specular: 0.0,
        mirror: DVec3::new(1.0, 0.5, 0.25),
        ..FaceLook::default()
    };
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &look,
        lights: &[],
        background: &|direction| DVec3::splat(direction.z),
        bounces: 1,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut tracer = LightTracer::new(&scenery);
    let seen = seen(
        &mut tracer,
        DVec3::new(-5.0, 0.0, 4.0),
        DVec3::new(-0.6, 0.0, -0.8),
    );
    assert!(
        (seen - 0.8 * DVec3::new(1.0, 0.5, 0.25)).length() < 1e-14,
        "{seen}"
    );
}

#[test]
fn samples_and_lenses_are_where_the_page_says() {
    // The first sample is in the middle; the others fill the pixel evenly, to 1/n in each strip.
    let plain = SampleAxes::default();
    assert_eq!(plain.sample([3, 4], 0).pixel, [0.5; 2]);
    let count = 256;
    let mut strips = [[0; 16]; 2];
    for k in 0..count {
        let places = plain.sample([3, 4], k).pixel;
        for axis in 0..2 {
            strips[axis][(places[axis] * 16.0) as usize] += 1;
        }
    }
    assert!(
        strips.iter().flatten().all(|n| (13..=19).contains(n)),
        "{strips:?}"
    );
    // The third sample by the numbers of the additive sequence.
    let whole = |x: f64| (x * 2f64.powi(32)) as u32;
    let third = plain.sample([3, 4], 2).pixel.map(whole);
    assert_eq!(third, [41_898_834, 2_747_407_178]);
    let lens = SampleAxes {
        lens: true,
        lights: false,
        grid: None,
    };
    assert_ne!(lens.sample([3, 4], 1).lens, lens.sample([4, 3], 1).lens);
    assert_eq!(whole(lens.sample([3, 4], 1).pixel[0]), 1_531_906_961);
    let both = SampleAxes {
        lens: true,
        lights: true,
        grid: None,
    };
    let step = |k| both.sample([3, 4], k).light.map(whole);
    let [a, b] = [step(7), step(8)];
    assert_eq!(
        [b[0].wrapping_sub(a[0]), b[1].wrapping_sub(a[1])],
        [2_517_223_199, 2_262_111_973]
    );
    let camera = LensCamera {
        position: DVec3::new(1.0, -4.0, 2.0),
        direction: DVec3::new(0.0, 2.0, -1.0),
        fov: PI / 4.0,
        roll: 0.3,
        focus: 3.0,
        aperture: 0.1,
        up: DVec3::Z,
        bokeh: Bokeh::Circle,
        projection: LensProjection::Pinhole,
        sharp: Default::default(),
    };
    // All rays of a pixel meet in the sharp plane, three along the axis.
    let (size, place) = ([640, 480], [100.5, 40.5]);
    let axis = camera.direction.normalize();
    let meet = |lens| {
        let (origin, direction) = camera.ray(size, place, lens);
        let t = (3.0 - (origin - camera.position).dot(axis)) / direction.dot(axis);
        origin + t * direction
    };
    let first = meet([0.0, 0.0]);
    for lens in [[1.0, 0.0], [0.5, 0.3], [0.9, 0.8]] {
        assert!(meet(lens).distance(first) < 1e-12);
    }
    let (_, up) = LensCamera {
        roll: 0.0,
        aperture: 0.0,
        ..camera
    }
    .ray(size, [320.0, 0.0], [0.0; 2]);
    assert_close(up.angle_between(axis), PI / 8.0, 1e-12);
    assert!(up.z > axis.z);
    assert_eq!(srgb::bytes(DVec3::new(-1.0, 0.5, f64::NAN)), [0, 188, 0]);
}
