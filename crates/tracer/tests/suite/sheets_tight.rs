//! Rays do not pass through parametric surfaces.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use expr::{Graph, Input, NodeId};
use glam::DVec3;
use tracer::{Sheet, SheetScratch, Sheets, SheetsRay};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

fn sheet(components: &[Formula; 3], domain: [[f64; 2]; 2]) -> Sheet {
    let nodes: [NodeId; 3] = [0, 1, 2].map(|k| components[k].node());
    let graph: Graph = components[0].graph().clone();
    Sheet::new(&graph, nodes, domain, &|_: Input| f64::NAN).unwrap()
}

/// The number of times that the ray from `origin` meets the surface at `target`, but for rounding.
fn met(sheet: &Sheet, scratch: &mut SheetScratch, origin: DVec3, target: DVec3) -> usize {
    let direction = (target - origin).normalize();
    let distance = (target - origin).length();
    let slack = 1e-9 + 1e3 * f64::EPSILON * (origin.length() + target.length());
    let hits = sheet.cast(scratch, origin, direction, None).iter();
    hits.filter(|hit| (hit.t - distance).abs() <= slack).count()
}

#[test]
fn rays_through_the_middles_of_cells_meet_them_from_near_and_far() {
    let [u, v, _] = &variables();
    let mut scratch = SheetScratch::default();
    type Height = fn(f64) -> f64;
    let surfaces: [(Formula, Height); 3] = [
        (u.number(0.0), |_| 0.0),
        (0.3 * u, |x| 0.3 * x),
        (0.3 * u.abs(), |x| 0.3 * x.abs()),
    ];
    for (z, height) in surfaces {
        let surface = sheet(&[u.clone(), v.clone(), z], [[-32.0, 32.0]; 2]);
        for power in 0..8 {
            let distance = 10.0f64.powi(power);
            let mut random = Random(5);
            for _ in 0..500 {
                // The cells are squares between whole numbers.
                let [x, y] = [0, 1].map(|_| random.below(64) as f64 - 31.5);
                let target = DVec3::new(x, y, height(x));
                let up = random.direction() + 1.5 * DVec3::Z;
                for origin in [target + distance * up, target - distance * up] {
                    let met = met(&surface, &mut scratch, origin, target);
                    assert_eq!(met, 1, "{target} from {origin}");
                }
            }
        }
    }
}

#[test]
fn rays_in_the_plane_of_a_seam_meet_a_closed_surface_from_inside() {
    let [u, v, _] = &variables();
    let mut scratch = SheetScratch::default();
    let ball = [u.cos() * v.sin(), u.sin() * v.sin(), v.cos()];
    let tube = &(2.0 + v.cos());
    let torus = [tube * u.cos(), tube * u.sin(), v.sin()];
    let cylinder = [u.cos(), u.sin(), v.clone()];
    // A point inside, the surface, its domain, and how far away it is in the direction at this angle. It closes where y = 0.
    type Distance = fn(f64) -> f64;
    let (round, straight): (Distance, Distance) = (|_| 1.0, |angle| 1.0 / angle.cos().abs());
    let surfaces = [
        (0.0, ball.clone(), [[-PI, PI], [0.0, PI]], round),
        (0.0, ball, [[0.0, TAU], [0.0, PI]], round),
        (-2.0, torus, [[-PI, PI]; 2], round),
        (0.0, cylinder, [[-PI, PI], [-9.0, 9.0]], straight),
    ];
    for (x, components, domain, distance) in surfaces {
        let surface = sheet(&components, domain);
        for k in 0..360 {
            let angle = f64::from(k).to_radians();
            let direction = DVec3::new(angle.cos(), 0.0, angle.sin());
            let distance = distance(angle);
            // Beyond the ends of the cylinder.
            if distance > 9.0 {
                continue;
            }
            let hits = surface.cast(&mut scratch, x * DVec3::X, direction, None);
            let first = hits.first().map(|hit| hit.t);
            let is_met = first.is_some_and(|t| (t - distance).abs() < 1e-12);
            assert!(is_met, "{x}, {direction}: {first:?}");
        }
    }
}

/// A surface with its place and unit normal in closed form.
struct ClosedForm {
    name: &'static str,
    components: [Formula; 3],
    domain: [[f64; 2]; 2],
    place: fn(f64, f64) -> DVec3,
    normal: fn(f64, f64) -> DVec3,
}

fn closed_forms() -> Vec<ClosedForm> {
    let [u, v, _] = &variables();
    let tube = &(2.0 + v.cos());
    let form = |name, components, domain, place, normal| ClosedForm {
        name,
        components,
        domain,
        place,
        normal,
    };
    vec![
        form(
            "plane",
            [u.clone(), v.clone(), 0.2 * u],
            [[-1.0, 1.0]; 2],
            |u, v| DVec3::new(u, v, 0.2 * u),
            |_, _| DVec3::new(-0.2, 0.0, 1.0).normalize(),
        ),
        form(
            "ball",
            [u.cos() * v.sin(), u.sin() * v.sin(), v.cos()],
            [[-PI, PI], [0.0, PI]],
            |u, v| DVec3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos()),
            |u, v| DVec3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos()),
        ),
        form(
            "ball by latitude",
            [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()],
            [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]],
            |u, v| DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin()),
            |u, v| DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin()),
        ),
        form(
            "cylinder",
            [u.cos(), u.sin(), v.clone()],
            [[-PI, PI], [-1.0, 1.0]],
            |u, v| DVec3::new(u.cos(), u.sin(), v),
            |u, _| DVec3::new(u.cos(), u.sin(), 0.0),
        ),
        form(
            "torus",
            [tube * u.cos(), tube * u.sin(), v.sin()],
            [[-PI, PI]; 2],
            |u, v| {
                let tube = 2.0 + v.cos();
                DVec3::new(tube * u.cos(), tube * u.sin(), v.sin())
            },
            |u, v| DVec3::new(v.cos() * u.cos(), v.cos() * u.sin(), v.sin()),
        ),
        form(
            "disc",
            [v * u.cos(), v * u.sin(), u.number(0.0)],
            [[-PI, PI], [0.0, 1.0]],
            |u, v| DVec3::new(v * u.cos(), v * u.sin(), 0.0),
            |_, _| DVec3::Z,
        ),
        form(
            "cone",
            [v * u.cos(), v * u.sin(), v.clone()],
            [[-PI, PI], [0.0, 1.0]],
            |u, v| DVec3::new(v * u.cos(), v * u.sin(), v),
            |u, _| DVec3::new(u.cos(), u.sin(), -1.0).normalize(),
        ),
    ]
}

#[test]
fn random_rays_meet_surfaces_from_near_and_far_wherever_these_are() {
    for form in closed_forms() {
        for moved in [0.0, 1e3, 1e6].map(|far| far * DVec3::new(1.0, -0.7, 0.3)) {
            let components = [0, 1, 2].map(|k| moved[k] + &form.components[k]);
            let surface = sheet(&components, form.domain);
            let mut scratch = SheetScratch::default();
            let mut random = Random(9);
            for k in 0..3000 {
                let distance = [3.0, 1e3, 1e6][k % 3];
                let [mut u, mut v] = form.domain.map(|[a, b]| random.between(a, b));
                match k % 5 {
                    // On an edge of cells, on the seam, and near the pole.
                    0 => u = PI * (random.below(129) as f64 / 64.0 - 1.0),
                    1 => u = form.domain[0][0],
                    // Near its tip a cone is met twice.
                    2 if form.name != "cone" => {
                        v = form.domain[1][0] + 10.0f64.powf(random.between(-16.0, -2.0))
                    }
                    _ => {}
                }
                u = u.clamp(form.domain[0][0], form.domain[0][1]);
                let target = moved + (form.place)(u, v);
                let direction = random.direction();
                if (form.normal)(u, v).dot(direction).abs() < 0.1 {
                    continue;
                }
                let origin = target - distance * direction;
                let met = met(&surface, &mut scratch, origin, target);
                let name = form.name;
                // Near a pole, or where the surface closes, rounding from afar may lead to both sides.
                let is_near = distance + moved.x < 1e4;
                let is_right = met == 1 || met > 1 && !is_near;
                assert!(is_right, "{name}: {met} at {u}, {v} from {origin}");
            }
            let work = scratch.counters();
            assert!(work.parts < 400_000, "{}: {work:?}", form.name);
        }
    }
}

#[test]
fn rays_through_a_pole_meet_it_once() {
    let poles = [DVec3::Z, DVec3::Z, DVec3::ZERO, DVec3::ZERO];
    let names = ["ball", "ball by latitude", "disc", "cone"];
    for (pole, name) in poles.into_iter().zip(names) {
        let forms = closed_forms();
        let form = forms.iter().find(|form| form.name == name).unwrap();
        let surface = sheet(&form.components, form.domain);
        let mut scratch = SheetScratch::default();
        let mut random = Random(3);
        for k in 0..300 {
            let direction = random.direction() + 2.0 * DVec3::Z;
            let beside = [0.0, 1e-16, 1e-12, 1e-10][k % 4] * random.direction();
            for origin in [pole + direction, pole - direction, pole - 4.0 * DVec3::Z] {
                let found = met(&surface, &mut scratch, origin + beside, pole + beside);
                assert_eq!(found, 1, "{name} from {origin}");
            }
        }
    }
}

#[test]
fn rays_that_leave_a_seam_or_a_common_edge_do_not_meet_it() {
    let [u, v, _] = &variables();
    let ball = [u.cos() * v.sin(), u.sin() * v.sin(), v.cos()];
    let whole = Sheets::new(vec![sheet(&ball, [[0.0, TAU], [0.0, PI]])]);
    let halves = [[-PI, 0.0], [0.0, PI]].map(|half| sheet(&ball, [half, [0.0, PI]]));
    let halves = Sheets::new(halves.into());
    let mut scratch = SheetScratch::default();
    let mut random = Random(8);
    for surfaces in [whole, halves] {
        for k in 0..1000 {
            // From the seam where u is 0 and y is 0, as a camera in that plane sees it.
            let angle = random.between(0.1, PI - 0.1);
            let place = DVec3::new(angle.sin(), 0.0, angle.cos());
            let outward = place + 0.9 * random.direction();
            let towards = if k % 2 == 0 {
                outward
            } else {
                outward.with_y(0.0)
            };
            let eye = place + 3.0 * towards;
            let mut cast = |origin, direction, leaving| {
                let (mut found, mut reach) = (None, f64::INFINITY);
                let ray = SheetsRay {
                    origin,
                    direction,
                    leaving,
                    reach,
                };
                surfaces.cast(&mut scratch, ray, &mut |sheet, hit| {
                    if hit.t < reach {
                        found = Some((hit.position, (sheet, hit.uv)));
                        reach = hit.t;
                    }
                    reach
                });
                found
            };
            let (position, leaving) = cast(eye, place - eye, None).unwrap();
            for direction in [outward, eye - place] {
                let again = cast(position, direction, Some(leaving));
                assert_eq!(again, None, "{position} {leaving:?} {direction}");
            }
        }
    }
}
