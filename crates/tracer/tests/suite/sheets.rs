//! Parametric surfaces against closed forms and their implicit twins.

use std::f64::consts::{PI, TAU};

use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, Sheet, SheetScratch, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;
use crate::scenes::sheets::{NamedSheet, sheets};

fn sheet(components: &[Formula; 3], domain: [[f64; 2]; 2]) -> Sheet {
    let nodes: [NodeId; 3] = [0, 1, 2].map(|k| components[k].node());
    let graph: Graph = components[0].graph().clone();
    Sheet::new(&graph, nodes, domain, &|_: Input| f64::NAN).unwrap()
}

/// The distances at which the implicit surface is crossed.
fn implicit(formula: &Formula, rays: &[Ray]) -> Vec<Vec<f64>> {
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(formula.node(), [None; 3]).unwrap();
    builder
        .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
        .unwrap();
    let world = builder.build().unwrap();
    let mut caster = world.caster();
    let all = rays.iter();
    all.map(|ray| caster.cast(ray).iter().map(|crossing| crossing.t).collect())
        .collect()
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = Random(21);
    let rays = (0..count).map(|_| {
        let direction = random.direction();
        Ray {
            origin: random.vector(1.2) - 5.0 * direction,
            direction,
            leaving: None,
        }
    });
    rays.collect()
}

/// Compares where tangency does not decide: two crossings closer than 10⁻³ may be missed by one of both.
fn compare(sheet: &Sheet, formula: &Formula, rays: &[Ray]) {
    let expected = implicit(formula, rays);
    let mut scratch = SheetScratch::default();
    let mut hits = 0;
    for (ray, expected) in rays.iter().zip(&expected) {
        if expected.windows(2).any(|pair| pair[1] - pair[0] < 1e-3) {
            continue;
        }
        let found = sheet.cast(&mut scratch, ray.origin, ray.direction, None);
        let found: Vec<f64> = found.iter().map(|hit| hit.t).collect();
        let close = found.len() == expected.len()
            && found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b));
        assert!(close, "{ray:?}: {found:?}, not {expected:?}");
        hits += found.len();
    }
    assert!(hits > 500, "{hits}");
}

#[test]
fn torus_and_ball_are_hit_where_their_implicit_twins_are() {
    let [u, v, z] = &variables();
    let tube = &(1.0 + 0.4 * v.cos());
    let torus = [tube * u.cos(), tube * u.sin(), 0.4 * v.sin()];
    let (x, y) = (u, v);
    let twin = ((x.squared() + y.squared()).sqrt() - 1.0).squared() + z.squared() - 0.16;
    compare(&sheet(&torus, [[0.0, TAU]; 2]), &twin, &rays(1500));
    // Two poles and a seam.
    let ball = [u.sin() * v.cos(), u.sin() * v.sin(), u.cos()];
    let twin = x.squared() + y.squared() + z.squared() - 1.0;
    compare(&sheet(&ball, [[0.0, PI], [0.0, TAU]]), &twin, &rays(1500));
}

#[test]
fn hits_lie_on_ray_and_surface_and_rays_leave_it() {
    let [u, v, _] = &variables();
    let helicoid = [v * u.cos(), v * u.sin(), 0.3 * u];
    let domain = [[-6.0, 6.0], [-1.5, 1.5]];
    let sheet = sheet(&helicoid, domain);
    let bounds = sheet.bounds();
    assert!(bounds.lower.z <= -1.8 && bounds.upper.z < 1.81 && bounds.upper.x < 1.6);
    let mut scratch = SheetScratch::default();
    let mut seen = 0;
    for ray in rays(1000) {
        let hits = sheet
            .cast(&mut scratch, ray.origin, ray.direction, None)
            .to_vec();
        for hit in &hits {
            let [u, v] = hit.uv;
            let place = DVec3::new(v * u.cos(), v * u.sin(), 0.3 * u);
            assert!(place.distance(ray.origin + hit.t * ray.direction) < 1e-10);
            let normal = DVec3::new(-0.3 * u.sin(), 0.3 * u.cos(), -v).normalize();
            assert!((normal.dot(hit.normal).abs() - 1.0).abs() < 1e-12);
            assert!(hit.normal.dot(ray.direction) <= 0.0);
            seen += 1;
        }
        // On from the first hit: the others, and not this one.
        if let [first, rest @ ..] = &hits[..] {
            if first.normal.dot(ray.direction).abs() < 1e-3 {
                continue;
            }
            let onward = sheet.cast(&mut scratch, first.position, ray.direction, Some(first.uv));
            assert_eq!(onward.len(), rest.len(), "{ray:?}: {onward:?} and {hits:?}");
            for (a, b) in onward.iter().zip(rest) {
                assert!((a.t + first.t - b.t).abs() < 1e-9);
            }
        }
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn normals_are_those_at_the_place() {
    let [u, v, _] = &variables();
    let tube = &(2.0 + 0.5 * v.cos());
    let torus = [tube * u.cos(), tube * u.sin(), 0.5 * v.sin()];
    let torus = sheet(&torus, [[0.0, TAU]; 2]);
    let mut scratch = SheetScratch::default();
    let mut hits = 0;
    for mut ray in rays(500) {
        ray.origin += ray.direction;
        for hit in torus.cast(&mut scratch, ray.origin, ray.direction, None) {
            let [u, v] = hit.uv;
            let outward = DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin());
            let error = (hit.normal - outward)
                .length()
                .min((hit.normal + outward).length());
            assert!(error < 1e-14, "{error:e}: {hit:?}");
            hits += 1;
        }
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn a_sheet_that_is_undefined_or_degenerate_has_an_answer() {
    let [u, v, _] = &variables();
    let nan = u.number(f64::NAN);
    let mut scratch = SheetScratch::default();
    let ray = &rays(1)[0];
    let nowhere = sheet(&[u.clone(), v.clone(), nan], [[0.0, 1.0]; 2]);
    assert!(nowhere.bounds().is_empty());
    assert!(
        nowhere
            .cast(&mut scratch, ray.origin, ray.direction, None)
            .is_empty()
    );
    let line = sheet(&[u.clone(), u.clone(), u.clone()], [[0.0, 1.0]; 2]);
    assert!(
        line.cast(&mut scratch, DVec3::new(0.5, 0.5, -3.0), DVec3::Z, None)
            .is_empty()
    );
    // A pole in the middle of the domain, in a cell and where cells meet.
    for at in [0.1, 0.0] {
        let pole = sheet(&[u.clone(), v.clone(), 1.0 / (u - at)], [[-1.0, 1.0]; 2]);
        for k in 1..100 {
            let step = 0.9f64.powi(k);
            for place in [at - step, at + step].into_iter().filter(|x| x.abs() < 1.0) {
                let origin = DVec3::new(place, 0.3, 0.0);
                let height = 1.0 / (place - at);
                let direction = height.signum() * DVec3::Z;
                let hits = pole.cast(&mut scratch, origin, direction, None);
                assert_eq!(hits.len(), 1, "{place}: {hits:?}");
                assert!((hits[0].t / height.abs() - 1.0).abs() < 1e-9, "{hits:?}");
            }
        }
    }
    let half = sheet(&[u.clone(), v.sqrt(), u * v], [[-1.0, 1.0]; 2]);
    let hits = half.cast(&mut scratch, DVec3::new(0.25, 0.5, -3.0), DVec3::Z, None);
    assert_eq!(hits.len(), 1);
    assert!((hits[0].t - 3.0625).abs() < 1e-12);
}

/// Surfaces with folds, poles, tips, pinches, waves and kinks, and tubes whose frames are derivatives.
fn shapes() -> Vec<NamedSheet> {
    let mut all = sheets(&variables());
    all.extend(simple_shapes(&variables()));
    all
}

fn simple_shapes([u, v, _]: &[Formula; 3]) -> Vec<NamedSheet> {
    let waves = &(0.3 * (3.0 * u).sin() * (5.0 * v).cos());
    let far = &(1e6 + u.cos());
    vec![
        (
            "ball",
            [u.sin() * v.cos(), u.sin() * v.sin(), u.cos()],
            [[0.0, PI], [0.0, TAU]],
        ),
        (
            "waves",
            [u.clone(), v.clone(), waves.clone()],
            [[-2.0, 2.0]; 2],
        ),
        (
            "cone",
            [v * u.cos(), v * u.sin(), v.clone()],
            [[0.0, TAU], [-1.0, 1.0]],
        ),
        (
            "umbrella",
            [u * v, u.clone(), v.squared()],
            [[-1.0, 1.0], [-1.0, 1.0]],
        ),
        (
            "thin",
            [u.cos(), 1e-3 * u.sin(), v.clone()],
            [[0.0, TAU], [-1.0, 1.0]],
        ),
        (
            "kinks",
            [u.clone(), v.clone(), (u - 0.3).abs().max(&(u * v))],
            [[-1.0, 1.0]; 2],
        ),
        (
            "far",
            [far.clone(), u.sin(), v.clone()],
            [[0.0, TAU], [-1.0, 1.0]],
        ),
    ]
}

#[test]
fn no_place_is_lost_between_cells_or_by_what_leaves_them_out() {
    let mut random = Random(77);
    let mut scratch = SheetScratch::default();
    for (name, components, domain) in shapes() {
        let surface = sheet(&components, domain);
        let bounds = surface.bounds();
        let size = (bounds.upper - bounds.lower).length();
        let graph = components[0].graph().clone();
        let tape = expr::tape::Tape::new(&graph, &[0, 1, 2].map(|k| components[k].node()));
        let mut registers = expr::tape::Registers::default();
        let mut place = |uv: [f64; 2]| {
            let inputs: Vec<f64> = tape
                .inputs()
                .iter()
                .map(|input| match input {
                    Input::Variable(k) => uv[*k as usize],
                    Input::Uniform(_) => f64::NAN,
                })
                .collect();
            let mut out = [0.0; 3];
            tape.eval(&mut registers, &inputs, &mut out);
            DVec3::from_array(out)
        };
        let sheets = tracer::Sheets::new(vec![sheet(&components, domain)]);
        let mut tangent = 0;
        for k in 0..4000 {
            // Every fourth place lies where cells meet: at a share with a small power of two below it.
            let uv = domain.map(|[a, b]| match k % 4 {
                0 => a + (b - a) * f64::from(random.below(65) as u32) / 64.0,
                _ => random.between(a, b),
            });
            let target = place(uv);
            let direction = random.direction();
            let origin = target - random.between(0.1, 3.0) * size * direction;
            let distance = (target - origin).dot(direction);
            let hits = surface.cast(&mut scratch, origin, direction, None).to_vec();
            assert!(hits.windows(2).all(|pair| pair[0].t <= pair[1].t));
            let slack = 1e-9 * (1.0 + distance.abs()) + 4.0 * f64::EPSILON * origin.length();
            let found = hits
                .iter()
                .any(|hit| (hit.t - distance).abs() <= 1e3 * slack);
            if !found {
                // Only where the ray touches the surface may rounding decide, or at the rim.
                let step = 1e-5;
                let mut near = |du: f64, dv: f64| place([uv[0] + du, uv[1] + dv]);
                let su = near(step, 0.0) - near(-step, 0.0);
                let sv = near(0.0, step) - near(0.0, -step);
                let normal = su.cross(sv);
                let cosine = normal.normalize_or_zero().dot(direction).abs();
                let at_rim = (0..2).any(|k| uv[k] == domain[k][0] || uv[k] == domain[k][1]);
                assert!(
                    cosine < 1e-3 || at_rim || normal.length() < 1e-14,
                    "{name} at {uv:?}, {cosine}: {hits:?}, not {distance}"
                );
                tangent += 1;
            }
            // The first of all is the first that is handed out when only that is wanted.
            let mut first = f64::INFINITY;
            let ray = tracer::SheetsRay {
                origin,
                direction,
                leaving: None,
                reach: f64::INFINITY,
            };
            sheets.cast(&mut scratch, ray, &mut |_, hit| {
                first = first.min(hit.t);
                first
            });
            let least = hits.first().map_or(f64::INFINITY, |hit| hit.t);
            let same = first == least || (first - least).abs() <= 1e-6;
            assert!(same, "{name}: {first}, not {least}");
        }
        assert!(tangent < 200, "{name}: {tangent} of 4000");
    }
}

#[test]
fn a_ray_costs_few_evaluations() {
    let rays = rays(2000);
    for (name, components, domain) in shapes() {
        let surface = sheet(&components, domain);
        let bounds = surface.bounds();
        let (centre, size) = (
            0.5 * (bounds.lower + bounds.upper),
            0.3 * (bounds.upper - bounds.lower).length(),
        );
        let mut scratch = SheetScratch::default();
        let cast = |scratch: &mut SheetScratch| {
            let mut hits = 0;
            for ray in &rays {
                let origin = centre + size * ray.origin;
                hits += surface.cast(scratch, origin, ray.direction, None).len();
            }
            hits
        };
        // The first time the linear maps of the cells are made.
        cast(&mut scratch);
        let before = scratch.counters();
        let hits = cast(&mut scratch);
        let after = scratch.counters();
        let [places, cells] = [after.places - before.places, after.cells - before.cells];
        let (places, cells) = (
            places as f64 / hits as f64,
            cells as f64 / rays.len() as f64,
        );
        assert!(hits > 1000, "{name}: {hits}");
        // Along the axes most boxes are left out at once too.
        for (k, ray) in rays.iter().enumerate() {
            let direction = DVec3::AXES[k % 3];
            let origin = centre + size * (ray.origin - 3.0 * direction);
            surface.cast(&mut scratch, origin, direction, None);
        }
        let met = (scratch.counters().met - after.met) as f64 / rays.len() as f64;
        assert!(
            met < 100.0,
            "{name}: {met} boxes are met by a ray along an axis"
        );
        assert!(places < 8.0, "{name}: {places} evaluations for a hit");
        assert!(cells < 8.0, "{name}: {cells} cells are divided for a ray");
    }
}

#[test]
fn rays_meet_the_same_places_in_any_order_and_without_what_is_kept() {
    let rays = rays(400);
    for (name, components, domain) in sheets(&variables()) {
        let hits = |kept: usize, order: &mut dyn Iterator<Item = usize>| {
            let mut surface = sheet(&components, domain);
            surface.keep_at_most(kept);
            let mut scratch = SheetScratch::default();
            let mut all = vec![Vec::new(); rays.len()];
            for k in order {
                let Ray {
                    origin, direction, ..
                } = rays[k];
                // Rays along the axes touch some of the surfaces.
                let direction = if k % 5 == 0 {
                    DVec3::AXES[k % 3]
                } else {
                    direction
                };
                let found = surface.cast(&mut scratch, origin, direction, None);
                all[k].extend_from_slice(found);
            }
            (all, scratch.counters())
        };
        let (forward, counters) = hits(usize::MAX, &mut (0..rays.len()));
        let (backward, _) = hits(usize::MAX, &mut (0..rays.len()).rev());
        let (alone, without) = hits(0, &mut (0..rays.len()));
        assert_eq!(forward, backward, "{name}");
        assert_eq!(forward, alone, "{name}");
        assert_eq!(counters.parts, without.parts, "{name}");
        assert!(counters.cells <= without.cells, "{name}");
    }
}

#[test]
fn a_picture_divides_no_cell_twice() {
    let variables = variables();
    for (name, components, domain) in sheets(&variables) {
        let surface = sheet(&components, domain);
        let mut scratch = SheetScratch::default();
        let bounds = surface.bounds();
        let half = 0.5 * (bounds.upper - bounds.lower).max_element();
        let eye = bounds.centre() + 8.0 * half * DVec3::Z;
        let mut picture = || {
            let before = scratch.counters();
            let mut hits = 0;
            for k in 0..80 * 80 {
                let [x, y] = [k % 80, k / 80].map(|i| f64::from(i) / 40.0 - 0.9875);
                let target = bounds.centre() + half * DVec3::new(x, y, 0.0);
                hits += surface.cast(&mut scratch, eye, target - eye, None).len();
            }
            let after = scratch.counters();
            let parts = after.parts - before.parts;
            (hits, after.cells - before.cells, parts)
        };
        let (hits, cells, parts) = picture();
        assert!(hits > 1000, "{name}: {hits}");
        assert!(cells < 25_000, "{name}: {cells} evaluations on cells");
        assert!(parts < 60_000, "{name}: {parts} cells are examined");
        assert_eq!(picture(), (hits, 0, parts), "{name}");
    }
}
