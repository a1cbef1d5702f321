//! Samples of pictures: their limits, their parts and their independence of threads.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Mutex;

use expr::{Graph, Input};
use glam::{DAffine3, DVec3};
use tracer::camera::{Bokeh, LensCamera, LensProjection};
use tracer::light::{Light, LightKind};
use tracer::picture::LightSums;
use tracer::shade::{EyeSample, Face, FaceLook, FaceObject, Glass, LightTracer, Scenery};
use tracer::{Ray, SetStep, Sheet, Sheets, World, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::surfaces::surfaces;
use crate::scenes::{LeafValue, Random, shapes};

fn world(formulas: &[Formula]) -> World {
    let graph = match formulas {
        [first, ..] => first.graph().clone(),
        [] => Graph::default(),
    };
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    for formula in formulas {
        let shape = builder.shape(formula.node(), [None; 3]).unwrap();
        builder
            .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
            .unwrap();
    }
    builder.build().unwrap()
}

fn sheet(components: &[Formula; 3], domain: [[f64; 2]; 2]) -> Sheet {
    let nodes = [0, 1, 2].map(|k| components[k].node());
    let graph = components[0].graph().clone();
    Sheet::new(&graph, nodes, domain, &|_: Input| f64::NAN).unwrap()
}

fn camera() -> LensCamera {
    LensCamera {
        position: DVec3::new(0.0, -4.0, 0.0),
        direction: DVec3::Y,
        up: DVec3::Z,
        fov: FRAC_PI_2,
        roll: 0.0,
        focus: 4.0,
        aperture: 0.0,
        bokeh: Bokeh::Circle,
        projection: LensProjection::Pinhole,
        sharp: Default::default(),
    }
}

fn black(_: DVec3) -> DVec3 {
    DVec3::ZERO
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray {
        origin,
        direction,
        leaving: None,
    }
}

fn drawn(scenery: &Scenery<'_>, camera: &LensCamera, samples: u32, threads: usize) -> Vec<DVec3> {
    let mut sums = LightSums::new([20, 12]);
    assert!(sums.add(scenery, camera, None, samples, threads, &|_| true));
    sums.means().collect()
}

/// White faces under light from everywhere.
fn white(_: &Face) -> FaceLook {
    FaceLook {
        specular: 0.0,
        ..FaceLook::default()
    }
}

/// Light from everywhere.
fn everywhere() -> Light {
    Light {
        ambient: 1.0,
        ..Light::new(LightKind::Parallel(DVec3::ZERO), DVec3::ONE)
    }
}

#[test]
fn a_bundle_sees_what_its_rays_see_alone() {
    let variables = variables();
    let surfaces = surfaces(&variables);
    let graph = variables[0].graph().clone();
    for (name, formula, half) in surfaces {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder
            .shape(formula.node(), [Some([-half, half]); 3])
            .unwrap();
        builder
            .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
            .unwrap();
        let world = builder.build().unwrap();
        let [mut alone, mut together] = [world.caster(), world.caster()];
        let mut random = Random(77);
        let (mut seen, mut differ) = (0, 0);
        for _ in 0..8 {
            let direction = random.direction();
            let origin = random.vector(0.7 * half) - 4.0 * half * direction;
            let spread = random.between(0.001, 0.05);
            let rays: Vec<Ray> = (0..64)
                .map(|_| ray(origin, (direction + random.vector(spread)).normalize()))
                .collect();
            together.begin_bundle(&rays);
            for (k, ray) in rays.iter().enumerate() {
                let [one, other] = [alone.first(ray), together.first_of_bundle(k)];
                seen += usize::from(one.is_some());
                let same = match (one, other) {
                    (Some(one), Some(other)) => (one.t - other.t).abs() <= 1e-9 * (1.0 + one.t),
                    (one, other) => one.is_none() && other.is_none(),
                };
                differ += usize::from(!same);
            }
        }
        assert_eq!(differ, 0, "{name}");
        assert!(seen > 40 || name == "tiny", "{name}: {seen}");
    }
}

#[test]
fn normals_are_exact_at_a_hundred_thousand_places() {
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let mut random = Random(5);
    let mut checked = 0;
    while checked < 100_000 {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .map(|f| builder.shape(f.node(), [None; 3]).unwrap())
            .collect();
        let kind = random.below(ids.len());
        let map = random.map(1.0);
        builder.solid([SetStep::Leaf(ids[kind], map)]).unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        let mut direct = LeafValue::new(&graph, formulas[kind].node(), &map);
        for _ in 0..500 {
            let direction = random.direction();
            let ray = ray(random.vector(1.0) - 6.0 * direction, direction);
            for crossing in caster.cast(&ray) {
                let (_, gradient) = direct.at(crossing.position);
                let Some(expected) = gradient.try_normalize() else {
                    continue;
                };
                // At edges and where the gradient is small the normal depends on the last digits of the place.
                let turn = [DVec3::X, DVec3::Y, DVec3::Z].map(|step| {
                    let (_, beside) = direct.at(crossing.position + 1e-8 * step);
                    beside.normalize_or_zero().distance(expected)
                });
                if turn.iter().any(|turn| *turn > 1e-6) {
                    continue;
                }
                let off = crossing.normal.cross(expected).length();
                assert!(off <= 1e-5, "shape {kind}: {off} at {crossing:?}");
                checked += 1;
            }
        }
    }
}

#[test]
fn a_blurred_edge_converges_to_its_integral() {
    // A thin white wall, y = 0 and z ≤ 0.1, out of focus.
    let [_, y, z] = variables();
    let formulas = [(0.0 - &y).max(&(&y - 1e-9)).max(&(z - 0.1))];
    let world = world(&formulas);
    let lights = [everywhere()];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &white,
        lights: &lights,
        background: &black,
        bounces: 0,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let blurred = LensCamera {
        aperture: 0.5,
        focus: 2.0,
        ..camera()
    };
    let mut sums = LightSums::new([4, 8]);
    sums.add(&scenery, &blurred, None, 4096, 2, &|_| true);
    let means: Vec<DVec3> = sums.means().collect();
    // The share of the pixel and of the lens from which the plane y = 0 is met below the edge. A ray through the lens at
    // the height b and the sharp plane at the height s meets y = 0 at 2s − b.
    let share = |row: u32| {
        let count = 400;
        let inside = (0..count).map(|k| {
            let y = f64::from(row) + (f64::from(k) + 0.5) / f64::from(count);
            let sharp = 2.0 * (8.0 - 2.0 * y) / 8.0;
            // Below the edge: b > 2s − 0.1. The part of a disc above a line.
            let h = ((2.0 * sharp - 0.1) / 0.5).clamp(-1.0, 1.0);
            (h.acos() - h * (1.0 - h * h).sqrt()) / PI
        });
        inside.sum::<f64>() / f64::from(count)
    };
    let mut partial = 0;
    for row in 0..8 {
        for column in 0..4 {
            let mean = means[row as usize * 4 + column].x;
            let expected = share(row);
            assert!(
                (mean - expected).abs() < 0.01,
                "{row}: {mean}, not {expected}"
            );
            partial += usize::from(expected > 0.05 && expected < 0.95);
        }
    }
    assert!(partial >= 4);
}

#[test]
fn soft_shadows_converge_to_the_visible_share_of_the_light() {
    // A wall, y ≤ 0 above the ground: half of the light at (0, 0, 4) is behind the plane y = 0 seen along it.
    let [x, y, z] = variables();
    let ground = &z + 0.0 * x;
    let wall = y.max(&(1.0 - &z)).max(&(&z - 2.0));
    let world = world(&[ground, wall]);
    let light = Light {
        size: 0.5,
        ..Light::new(LightKind::Point(DVec3::new(0.0, 0.0, 4.0)), DVec3::ONE)
    };
    let lights = [light];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &white,
        lights: &lights,
        background: &black,
        bounces: 0,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut tracer = LightTracer::new(&scenery);
    let axes = tracer::camera::SampleAxes {
        lens: false,
        lights: true,
        grid: None,
    };
    let count = 4096;
    let mut sum = 0.0;
    for k in 0..count {
        let down = ray(DVec3::new(0.0, 0.0, 0.5), DVec3::NEG_Z);
        let sample = EyeSample {
            light: axes.sample([1, 1], k).light,
            spread: 0.0,
        };
        sum += tracer.light(&down, sample).x;
    }
    // The cosine is that at (0, 0, 4) to within 1/128.
    let mean = sum / f64::from(count);
    assert!((mean - 0.5).abs() < 0.01, "{mean}");
}

#[test]
fn lenses_have_their_shapes() {
    let shapes = [
        (Bokeh::Circle, 1.0),
        (Bokeh::Line, 1.0),
        (Bokeh::Polygon(3), 1.0),
        (Bokeh::Polygon(4), 1.0),
        (Bokeh::Polygon(5), 1.0),
        (Bokeh::Polygon(6), 1.0),
        (Bokeh::Polygon(8), 1.0),
        (Bokeh::Star, 1.0),
        (Bokeh::Box, 2f64.sqrt()),
    ];
    for (bokeh, radius) in shapes {
        let camera = LensCamera {
            aperture: 1.0,
            bokeh,
            ..camera()
        };
        let axes = tracer::camera::SampleAxes {
            lens: true,
            lights: false,
            grid: None,
        };
        let (mut centre, mut farthest) = (DVec3::ZERO, 0.0f64);
        for k in 0..4096 {
            let (origin, _) = camera.ray([9, 9], [4.5; 2], axes.sample([2, 2], k).lens);
            let offset = origin - camera.position;
            assert_eq!(offset.y, 0.0);
            centre += offset / 4096.0;
            farthest = farthest.max(offset.length());
        }
        assert!(centre.length() < 0.01, "{bokeh:?}: {centre}");
        let close = farthest <= radius + 1e-12 && farthest > 0.95 * radius;
        assert!(close, "{bokeh:?}: {farthest}");
    }
}

#[test]
fn footprints_are_what_pixels_meet() {
    // A floor that mirrors, seen at a slant, and a ceiling that is only seen in it.
    let [_, _, z] = variables();
    let world = world(&[z.clone(), 5.0 - z]);
    let seen: Mutex<Vec<Face>> = Mutex::default();
    let look = |face: &Face| {
        seen.lock().expect("no panic").push(*face);
        FaceLook {
            mirror: DVec3::ONE,
            ..FaceLook::default()
        }
    };
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &look,
        lights: &[],
        background: &black,
        bounces: 1,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let camera = LensCamera {
        position: 2.0 * DVec3::Z,
        direction: DVec3::new(1.0, 0.4, -0.7),
        fov: 0.8,
        ..camera()
    };
    let size = [33; 2];
    let mut sums = LightSums::new(size);
    let mut areas = || -> Vec<f64> {
        assert!(sums.add(&scenery, &camera, None, 1, 1, &|_| true));
        let faces = std::mem::take(&mut *seen.lock().expect("no panic"));
        let (floor, ceiling): (Vec<&Face>, Vec<&Face>) =
            faces.iter().partition(|face| face.normal.z > 0.0);
        assert_eq!([floor.len(), ceiling.len()], [33 * 33; 2]);
        assert!(ceiling.iter().all(|face| face.beam == DVec3::ZERO));
        let area = |face: &&Face| {
            let [a, b] = face.footprint();
            a.cross(b).z.abs()
        };
        floor.iter().map(area).collect()
    };
    // The footprints of the first samples fill the part of the floor that the picture shows.
    let corner = |at: [f64; 2]| {
        let (origin, direction) = camera.ray(size, at, [0.5; 2]);
        origin - origin.z / direction.z * direction
    };
    let [a, b, c, d] = [[0.0, 0.0], [33.0, 0.0], [33.0, 33.0], [0.0, 33.0]].map(corner);
    let whole = 0.5 * (c - a).cross(d - b).z.abs();
    let first = areas();
    let share = first.iter().sum::<f64>() / whole;
    assert!((0.8..1.0).contains(&share), "{share}");
    // With the second one each stands for half of its pixel.
    let share = areas().iter().sum::<f64>() / first.iter().sum::<f64>();
    assert!((0.4..0.6).contains(&share), "{share}");
}

#[test]
fn pictures_are_the_same_on_any_number_of_threads() {
    let [x, y, z] = variables();
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let waves = ball.clone() + 0.1 * (7.0 * x).sin() - 0.0;
    let world = world(&[waves]);
    let look = |face: &Face| FaceLook {
        colour: 0.5 + 0.5 * face.normal,
        mirror: DVec3::splat(0.3),
        ..FaceLook::default()
    };
    let lights = [Light {
        size: 0.3,
        ..Light::new(LightKind::Point(DVec3::new(2.0, -3.0, 4.0)), DVec3::ONE)
    }];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &[],
        look: &look,
        lights: &lights,
        background: &|direction| 0.5 + 0.5 * direction,
        bounces: 4,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let camera = LensCamera {
        aperture: 0.1,
        bokeh: Bokeh::Star,
        ..camera()
    };
    let one = drawn(&scenery, &camera, 5, 1);
    assert_eq!(one, drawn(&scenery, &camera, 5, 3));
    assert_eq!(one, drawn(&scenery, &camera, 5, 16));
    // Stopped: nothing is added.
    let mut sums = LightSums::new([20, 12]);
    assert!(!sums.add(&scenery, &camera, None, 1, 2, &|_| false));
    assert_eq!(sums.samples(), 0);
}

#[test]
fn sheets_and_solids_are_seen_together() {
    let [u, v, z] = variables();
    let ball = u.squared() + (&v + 0.0).squared() + z.squared() - 1.0;
    let world = world(&[ball]);
    let pane = |y: f64| sheet(&[u.clone(), u.number(y), v.clone()], [[-3.0, 3.0]; 2]);
    let sheets = Sheets::new(vec![pane(-2.0), pane(0.0), pane(3.0)]);
    let look = |face: &Face| match face.of {
        FaceObject::Sheet { sheet: 0, .. } => FaceLook {
            colour: DVec3::new(0.5, 1.0, 1.0),
            diffuse: Some(0.0),
            glass: 0.8,
            specular: 0.0,
            ..FaceLook::default()
        },
        FaceObject::Sheet { sheet, .. } => FaceLook {
            colour: DVec3::splat(if sheet == 1 { 0.25 } else { 0.125 }),
            ..white(face)
        },
        FaceObject::Solid { .. } => white(face),
    };
    let lights = [everywhere()];
    let scenery = Scenery {
        world: &world,
        sheets: &sheets,
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
    let mut seen = |x: f64| {
        let ray = ray(DVec3::new(x, -5.0, 0.1), DVec3::Y);
        tracer.light(&ray, EyeSample::default())
    };
    // Through the pane of glass: the ball, beside it the pane behind.
    assert!((seen(0.2) - 0.8 * DVec3::new(0.5, 1.0, 1.0)).length() < 1e-12);
    assert!((seen(2.0) - 0.2 * DVec3::new(0.5, 1.0, 1.0)).length() < 1e-12);
    let first = tracer
        .first(&ray(DVec3::new(0.0, 5.0, 0.0), DVec3::NEG_Y))
        .unwrap();
    assert!(matches!(first.of, FaceObject::Sheet { sheet: 2, .. }));
    assert_eq!(first.normal, DVec3::Y);
}

#[test]
fn a_camera_inside_glass_looks_out_of_it() {
    let [x, y, z] = variables();
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let world = world(&[ball]);
    let look = |_: &Face| FaceLook {
        glass: 1.0,
        ..white_glass()
    };
    let glass = [Some(Glass {
        ior: 1.5,
        depth: 1.0,
        leaf: 0,
    })];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::default(),
        glass: &glass,
        look: &look,
        lights: &[],
        background: &|_| DVec3::ONE,
        bounces: 64,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut tracer = LightTracer::new(&scenery);
    // From the centre all rays go straight out; 4 % come back each time, and go out in the end.
    let seen = tracer.light(&ray(DVec3::ZERO, DVec3::X), EyeSample::default());
    assert!((seen.x - 1.0).abs() < 2e-3, "{seen}");
    // Near the rim, along it: total reflection, again and again.
    let inside = ray(DVec3::new(0.95, 0.0, 0.0), DVec3::Z);
    let seen = tracer.light(&inside, EyeSample::default());
    assert!(seen.x.is_finite() && seen.x <= 1.0 + 1e-12);
}

fn white_glass() -> FaceLook {
    FaceLook {
        specular: 0.0,
        diffuse: Some(0.0),
        ..FaceLook::default()
    }
}

#[test]
fn other_projections_turn_by_angles() {
    let spherical = LensCamera {
        projection: LensProjection::Spherical,
        ..camera()
    };
    let (_, direction) = spherical.ray([200, 100], [200.0, 50.0], [0.5; 2]);
    // X f W/H becomes sin(X fov/2 W/H).
    let expected = DVec3::new((FRAC_PI_2 / 2.0 * 2.0).sin(), 1.0, 0.0).normalize();
    assert!(direction.distance(expected) < 1e-12);
    let cylindrical = LensCamera {
        projection: LensProjection::Cylindrical,
        ..camera()
    };
    let (_, direction) = cylindrical.ray([200, 100], [200.0, 0.0], [0.5; 2]);
    assert!(direction.distance(DVec3::new(1.0, 1.0, 1.0).normalize()) < 1e-12);
}

#[test]
fn the_rays_of_a_tile_are_lit_as_each_is_alone() {
    let variables = variables();
    let [x, y, z] = &variables;
    let cube = x.abs().max(&y.abs()).max(&z.abs()) - 1.0;
    let rod = x.squared() + y.squared() - 0.36;
    let ball = x.squared() + y.squared() + z.squared() - 0.3;
    let ring = (x.squared() + y.squared() + z.squared() + 0.9).squared()
        - 4.0 * (x.squared() + y.squared());
    let ground = z + 1.0;
    let graph = x.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let [cube, rod, ball, ring, ground] = [&cube, &rod, &ball, &ring, &ground]
        .map(|formula| builder.shape(formula.node(), [None; 3]).unwrap());
    let leaf = |shape, map| SetStep::Leaf(shape, map);
    let turned = DAffine3::from_rotation_x(FRAC_PI_2);
    let moved = |x, y, z| DAffine3::from_translation(DVec3::new(x, y, z));
    let solids: [&[SetStep]; 6] = [
        &[
            leaf(cube, DAffine3::IDENTITY),
            leaf(rod, DAffine3::IDENTITY),
            SetStep::Difference,
            leaf(rod, turned),
            SetStep::Difference,
        ],
        &[leaf(ground, DAffine3::IDENTITY)],
        &[leaf(ball, moved(2.0, -0.5, -0.4))],
        &[leaf(ball, moved(-1.9, 0.3, -0.4))],
        // Flush with the box, and glass in its hole.
        &[leaf(cube, moved(0.0, 2.0, 0.0))],
        &[
            leaf(ring, moved(0.0, 0.0, 0.8)),
            leaf(ball, moved(0.0, 0.0, 0.2)),
            SetStep::Union,
        ],
    ];
    for solid in solids {
        builder.solid(solid).unwrap();
    }
    let world = builder.build().unwrap();
    let point = |x, y, z| Light::new(LightKind::Point(DVec3::new(x, y, z)), DVec3::splat(0.4));
    let lights = [
        point(4.0, -6.0, 5.0),
        point(-5.0, -3.0, 2.0),
        Light {
            size: 0.5,
            ..point(0.0, 0.0, 9.0)
        },
        Light::new(LightKind::Parallel(DVec3::new(0.2, 1.0, -0.3)), DVec3::ONE),
    ];
    let glass = [None, None, None, None, None, Some(Glass::default())];
    let scenery = Scenery {
        world: &world,
        sheets: &Sheets::new(Vec::new()),
        glass: &glass,
        look: &|face| {
            let FaceObject::Solid { solid, .. } = face.of else {
                return FaceLook::default();
            };
            FaceLook {
                mirror: DVec3::splat([0.0, 0.3, 0.6, 0.6, 0.1, 0.0][solid]),
                glass: if solid == 5 { 0.9 } else { 0.0 },
                ..FaceLook::default()
            }
        },
        lights: &lights,
        background: &|direction| direction.abs(),
        bounces: 4,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    let mut random = Random(31);
    let mut met = 0;
    for tile in 0..200 {
        let eye = DVec3::new(-0.5, -6.0, 2.5) + random.vector(0.5);
        let forward = (random.vector(1.5) - eye).normalize();
        let spread = [0.02, 0.1, 0.5][tile % 3];
        let rays: Vec<Ray> = (0..16)
            .map(|_| ray(eye, (forward + random.vector(spread)).normalize()))
            .collect();
        let sample = |k| EyeSample {
            light: [f64::from(k) / 16.0, 0.3],
            spread: 0.0,
        };
        let samples: Vec<EyeSample> = (0..16).map(sample).collect();
        let together = LightTracer::new(&scenery).lights(&rays, &samples);
        for ((ray, &sample), light) in rays.iter().zip(&samples).zip(together) {
            let mut alone = LightTracer::new(&scenery);
            met += usize::from(alone.first(ray).is_some());
            let alone = alone.light(ray, sample);
            assert_eq!(alone, light, "tile {tile}: {ray:?}");
            let mut caster = world.caster();
            let first = caster
                .first(ray)
                .map(|crossing| (crossing.t, crossing.leaf));
            let face = LightTracer::new(&scenery).first(ray);
            let face = face.map(|face| match face.of {
                FaceObject::Solid { leaf, .. } => (face.t, leaf),
                FaceObject::Sheet { .. } => (face.t, usize::MAX),
            });
            assert_eq!(first, face, "tile {tile}: {ray:?}");
        }
    }
    assert!(met > 2000, "{met}");
}

#[test]
fn work_that_is_kept_is_expected_once() {
    let variables = variables();
    let all = crate::scenes::sheets::sheets(&variables);
    let (_, components, domain) = all.iter().find(|(name, ..)| *name == "trefoil").unwrap();
    let sheets = Sheets::new(vec![sheet(components, *domain)]);
    let world = world(&[]);
    let scenery = Scenery {
        world: &world,
        sheets: &sheets,
        glass: &[],
        opaque: &[],
        look: &white,
        lights: &[everywhere()],
        background: &black,
        bounces: 0,
        picture_look: Default::default(),
        sides: &[],
    };
    let camera = LensCamera {
        position: DVec3::new(0.0, 0.0, 8.0),
        direction: -DVec3::Z,
        up: DVec3::Y,
        fov: 0.8,
        ..camera()
    };
    let told = std::sync::Mutex::new((None, 0));
    let mut sums = LightSums::new([512, 512]);
    sums.add(&scenery, &camera, None, 1, 1, &|progress| {
        let mut told = told.lock().unwrap();
        told.0 = told.0.or(progress.expected);
        told.1 = progress.operations;
        true
    });
    let (expected, taken) = told.into_inner().unwrap();
    let share = expected.unwrap() as f64 / taken as f64;
    assert!((0.7..1.2).contains(&share), "{share} of {taken} operations");
}
