//! Faces that coincide, touch, or nearly do: the set-theoretic answer for every ray, near the origin and far away.

use glam::{DAffine3, DMat3, DVec3};
use tracer::{Ray, SetStep, ShapeId, World, WorldBuilder};

use crate::formula::{Formula, variables};
use crate::scenes::Random;

use SetStep::{Difference, Intersection, Union};

/// A box from corner to corner.
fn block(cube: ShapeId, a: [f64; 3], b: [f64; 3], place: &DAffine3) -> SetStep {
    let (a, b) = (DVec3::from_array(a), DVec3::from_array(b));
    let scale = DMat3::from_diagonal(0.5 * (b - a));
    SetStep::Leaf(
        cube,
        *place * DAffine3::from_mat3_translation(scale, 0.5 * (a + b)),
    )
}

/// The world of one solid of unit cubes and balls.
fn world(steps: impl Fn(ShapeId, ShapeId) -> Vec<SetStep>) -> World {
    let [x, y, z] = variables();
    let cube = x.abs().max(&y.abs()).max(&z.abs()) - 1.0;
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let graph = cube.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let cube = builder.shape(cube.node(), [None; 3]).unwrap();
    let ball = builder.shape(ball.node(), [None; 3]).unwrap();
    builder.solid(steps(cube, ball)).unwrap();
    builder.build().unwrap()
}

/// Near the origin and far away, upright and turned.
fn places() -> Vec<DAffine3> {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 0.7);
    vec![
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(1000.0, -700.0, 300.0)),
        DAffine3::from_mat3_translation(turn, DVec3::ZERO),
        DAffine3::from_mat3_translation(turn, DVec3::new(-600.0, 800.0, 1000.0)),
    ]
}

/// Rays towards the solid, parallel to faces' normals, oblique and grazing, in its own coordinates.
fn rays(count: usize) -> Vec<(DVec3, DVec3)> {
    let mut random = Random(5);
    let rays = (0..count).map(|k| {
        let direction = match k % 4 {
            0 => [DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z][k / 4 % 3],
            1 => (DVec3::NEG_Z + 0.01 * random.direction()).normalize(),
            _ => random.direction(),
        };
        (random.vector(1.2) - 6.0 * direction, direction)
    });
    rays.collect()
}

/// The crossings' distances.
fn cast(world: &World, place: &DAffine3, (origin, direction): (DVec3, DVec3)) -> Vec<f64> {
    let ray = Ray {
        origin: place.transform_point3(origin),
        direction: place.transform_vector3(direction),
        leaving: None,
    };
    let mut caster = world.caster();
    caster
        .cast(&ray)
        .iter()
        .map(|crossing| crossing.t)
        .collect()
}

/// The part of a ray in a box.
fn through(a: [f64; 3], b: [f64; 3], (origin, direction): (DVec3, DVec3)) -> Option<[f64; 2]> {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for k in 0..3 {
        if direction[k] == 0.0 {
            if origin[k] < a[k] || origin[k] > b[k] {
                return None;
            }
            continue;
        }
        let [s, t] = [a[k], b[k]].map(|side| (side - origin[k]) / direction[k]);
        near = near.max(s.min(t));
        far = far.min(s.max(t));
    }
    (near < far).then_some([near, far])
}

#[track_caller]
fn assert_crossings(found: &[f64], expected: &[f64], tolerance: f64, what: &dyn std::fmt::Debug) {
    let close = found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(close, "{what:?}: {found:?}, not {expected:?}");
}

/// The sides of a box that a ray passes close to an edge of, where rounding may decide.
fn near_an_edge(a: [f64; 3], b: [f64; 3], ray: (DVec3, DVec3)) -> bool {
    let grown = |by: f64| through(a.map(|x| x - by), b.map(|x| x + by), ray).is_some();
    grown(1e-9) != grown(-1e-9)
}

#[test]
fn a_hole_through_flush_faces_has_no_film() {
    for place in places() {
        // The tool ends flush with both faces.
        let world = world(|cube, _| {
            vec![
                block(cube, [-1.0; 3], [1.0; 3], &place),
                block(cube, [-0.5, -0.5, -1.0], [0.5, 0.5, 1.0], &place),
                Difference,
            ]
        });
        for ray in rays(2000) {
            let (outer, tool) = (([-1.0; 3], [1.0; 3]), ([-0.5, -0.5, -1.0], [0.5, 0.5, 1.0]));
            if near_an_edge(outer.0, outer.1, ray) || near_an_edge(tool.0, tool.1, ray) {
                continue;
            }
            let expected = match (through(outer.0, outer.1, ray), through(tool.0, tool.1, ray)) {
                (None, _) => vec![],
                (Some([a, b]), None) => vec![a, b],
                (Some([a, b]), Some([c, d])) => {
                    let mut all = Vec::new();
                    if c - a > 1e-9 {
                        all.extend([a, c]);
                    }
                    if b - d > 1e-9 {
                        all.extend([d, b]);
                    }
                    all
                }
            };
            assert_crossings(&cast(&world, &place, ray), &expected, 1e-9, &ray);
        }
    }
}

#[test]
fn boxes_that_touch_are_one() {
    for place in places() {
        let world = world(|cube, _| {
            vec![
                block(cube, [-1.0; 3], [0.25, 1.0, 1.0], &place),
                block(cube, [0.25, -1.0, -1.0], [1.0; 3], &place),
                Union,
            ]
        });
        for ray in rays(2000) {
            if near_an_edge([-1.0; 3], [1.0; 3], ray) {
                continue;
            }
            let expected = through([-1.0; 3], [1.0; 3], ray).map_or(vec![], |ab| ab.to_vec());
            // A ray along the joint runs in both faces.
            if ray.1.x.abs() < 1e-12 && (ray.0.x - 0.25).abs() < 1e-9 {
                continue;
            }
            assert_crossings(&cast(&world, &place, ray), &expected, 1e-9, &ray);
        }
    }
}

#[test]
fn gaps_and_overlaps_from_a_thousand_millionth_are_what_they_are() {
    for gap in [1e-9, 1e-8, 1e-6, -1e-9, -1e-6] {
        for place in &places()[..1] {
            let world = world(|cube, _| {
                vec![
                    block(cube, [-1.0; 3], [0.0, 1.0, 1.0], place),
                    block(cube, [gap, -1.0, -1.0], [1.0; 3], place),
                    Union,
                ]
            });
            for (origin, direction) in rays(800) {
                let ray = (origin, direction);
                let halves = [([-1.0; 3], [0.0, 1.0, 1.0]), ([gap, -1.0, -1.0], [1.0; 3])];
                if halves.iter().any(|(a, b)| near_an_edge(*a, *b, ray)) || direction.x.abs() < 1e-3
                {
                    continue;
                }
                let mut parts: Vec<[f64; 2]> = halves
                    .iter()
                    .filter_map(|(a, b)| through(*a, *b, ray))
                    .collect();
                parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let mut expected: Vec<f64> = parts.concat();
                if expected.len() == 4 && expected[1] >= expected[2] {
                    expected.drain(1..3);
                }
                assert_crossings(&cast(&world, place, ray), &expected, 1e-12, &(gap, ray));
            }
        }
    }
}

#[test]
fn a_ball_less_itself_is_nothing_and_with_itself_one() {
    for place in places() {
        // The second ball is the same set under another map: turned about its centre.
        let turn = DAffine3::from_mat3(DMat3::from_rotation_z(1.1));
        let ball = |ball| SetStep::Leaf(ball, place);
        let turned = |ball| SetStep::Leaf(ball, place * turn);
        let nothing = world(|_, b| vec![ball(b), turned(b), Difference]);
        let both = world(|_, b| vec![ball(b), turned(b), Union]);
        let common = world(|_, b| vec![ball(b), turned(b), Intersection]);
        for ray in rays(2000) {
            assert_eq!(cast(&nothing, &place, ray), Vec::<f64>::new(), "{ray:?}");
            let (b, c) = (ray.0.dot(ray.1), ray.0.length_squared() - 1.0);
            let square = b * b - c;
            if square.abs() < 1e-9 {
                continue;
            }
            let expected = if square < 0.0 {
                vec![]
            } else {
                vec![-b - square.sqrt(), -b + square.sqrt()]
            };
            for world in [&both, &common] {
                let found = cast(world, &place, ray);
                assert_crossings(&found, &expected, 1e-8, &ray);
            }
        }
    }
}

#[test]
fn a_wall_of_blocks_has_no_joints() {
    // 8 × 8 blocks with flush faces, each a leaf of its own, in front of a plate that touches them.
    for place in places() {
        let world = world(|cube, _| {
            let mut steps = vec![block(cube, [-1.0, -1.0, -0.5], [1.0, 1.0, 0.0], &place)];
            for i in 0..8 {
                for j in 0..8 {
                    let [x, y] = [i, j].map(|k| f64::from(k) / 4.0 - 1.0);
                    steps.push(block(cube, [x, y, 0.0], [x + 0.25, y + 0.25, 0.5], &place));
                    steps.push(Union);
                }
            }
            steps
        });
        for ray in rays(1500) {
            let (a, b) = ([-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]);
            if near_an_edge(a, b, ray) {
                continue;
            }
            let expected = through(a, b, ray).map_or(vec![], |ab| ab.to_vec());
            assert_crossings(&cast(&world, &place, ray), &expected, 1e-9, &ray);
        }
    }
}

#[test]
fn the_first_in_the_text_owns_a_shared_face() {
    let place = DAffine3::IDENTITY;
    let world = world(|cube, _| {
        vec![
            block(cube, [-1.0; 3], [1.0; 3], &place),
            block(cube, [-0.5, -0.5, -1.0], [0.5, 0.5, 1.0], &place),
            Union,
        ]
    });
    let ray = Ray {
        origin: DVec3::new(0.1, 0.2, 5.0),
        direction: DVec3::NEG_Z,
        leaving: None,
    };
    let mut caster = world.caster();
    let leaves: Vec<usize> = caster
        .cast(&ray)
        .iter()
        .map(|crossing| crossing.leaf)
        .collect();
    assert_eq!(leaves, [0, 0]);
}

/// A slab from `a` to `b`, by a square, by a product and by an absolute value.
fn slabs(x: &Formula, a: f64, b: f64) -> [Formula; 3] {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    [
        (x - middle).squared() - half * half,
        (x - a) * (x - b),
        (x - middle).abs() - half,
    ]
}

/// The same box three times, by squares, products and absolute values.
fn boxes(variables: &[Formula; 3], a: [f64; 3], b: [f64; 3]) -> [Formula; 3] {
    let sides = [0, 1, 2].map(|k| slabs(&variables[k], a[k], b[k]));
    [0, 1, 2].map(|form| sides[0][form].max(&sides[1][form]).max(&sides[2][form]))
}

/// A set less another one at the same place.
fn difference(a: &Formula, b: &Formula, place: &DAffine3) -> World {
    let graph = a.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let leaves = [a, b].map(|f| builder.shape(f.node(), [None; 3]).unwrap());
    let [a, b] = leaves.map(|shape| SetStep::Leaf(shape, *place));
    builder.solid(vec![a, b, Difference]).unwrap();
    builder.build().unwrap()
}

#[test]
fn pairs_of_planes_share_their_faces_in_any_form() {
    let variables = variables();
    let (outer, pocket) = (([-1.0; 3], [1.0; 3]), ([0.4, -0.5, -0.5], [1.0, 0.5, 0.5]));
    let boxes = |(a, b)| boxes(&variables, a, b);
    for place in places() {
        for a in &boxes(outer) {
            for b in &boxes(outer) {
                let nothing = difference(a, b, &place);
                for ray in rays(300) {
                    assert_eq!(cast(&nothing, &place, ray), Vec::<f64>::new(), "{ray:?}");
                }
            }
            for b in &boxes(pocket) {
                // The mouth of the pocket is flush with a face.
                let world = difference(a, b, &place);
                for ray in rays(300) {
                    let sides = [outer, pocket];
                    if sides.iter().any(|(a, b)| near_an_edge(*a, *b, ray)) {
                        continue;
                    }
                    let mut expected = Vec::new();
                    if let Some([near, far]) = through(outer.0, outer.1, ray) {
                        let hole = through(pocket.0, pocket.1, ray).unwrap_or([far; 2]);
                        let parts = [[near, hole[0]], [hole[1], far]];
                        let thick = |part: &[f64; 2]| part[1] - part[0] > 1e-9;
                        expected.extend(parts.into_iter().filter(thick).flatten());
                    }
                    assert_crossings(&cast(&world, &place, ray), &expected, 1e-9, &ray);
                }
            }
        }
    }
}

#[test]
fn crossing_planes_share_their_faces() {
    // x² ≤ y² within a box.
    let variables = variables();
    let [_, _, cube] = &boxes(&variables, [-1.0; 3], [1.0; 3]);
    let [x, y, _] = &variables;
    let wedges = (x.squared() - y.squared()).max(cube);
    let products = ((x - y) * (y + x)).max(cube);
    let halves = (x.abs() - y.abs()).max(cube);
    for place in places() {
        for (a, b) in [
            (&wedges, &halves),
            (&halves, &products),
            (&products, &wedges),
        ] {
            let nothing = difference(a, b, &place);
            for ray in rays(300) {
                assert_eq!(cast(&nothing, &place, ray), Vec::<f64>::new(), "{ray:?}");
            }
        }
    }
}
