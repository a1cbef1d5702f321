//! Meshes of solids: closed, manifold, on the surface, with sharp edges.

use std::collections::HashMap;
use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use tracer::{SetStep, SolidMesh, WorkBudget, World, WorldBuilder, contour};

use crate::formula::{Formula, variables};
use crate::scenes::surfaces::surfaces;
use crate::scenes::{Random, shapes};

fn world(formula: &Formula, cut: Option<[f64; 2]>) -> World {
    let graph = formula.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(formula.node(), [cut; 3]).unwrap();
    builder
        .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
        .unwrap();
    builder.build().unwrap()
}

fn meshed(world: &World, cells: u32) -> SolidMesh {
    let bounds = world.bounds(0).expect("a box");
    contour(world, 0, &bounds, cells, &WorkBudget::new(u64::MAX)).expect("work enough")
}

/// Panics unless each edge belongs to two triangles that pass it in opposite directions, and the triangles around each
/// vertex are one fan.
fn assert_closed_manifold(mesh: &SolidMesh, name: &str) {
    let mut next: HashMap<(u32, u32), u32> = HashMap::new();
    let mut corners: HashMap<u32, Vec<(u32, u32)>> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to, other) in [(a, b, c), (b, c, a), (c, a, b)] {
            assert!(from != to, "{name}: an edge from a vertex to itself");
            let known = next.insert((from, to), other);
            assert!(
                known.is_none(),
                "{name}: two triangles on one side of an edge"
            );
            corners.entry(from).or_default().push((to, other));
        }
    }
    for (from, to) in next.keys() {
        assert!(next.contains_key(&(*to, *from)), "{name}: an open edge");
    }
    for (vertex, fan) in &corners {
        let onward: HashMap<u32, u32> = fan.iter().copied().collect();
        let (start, mut here, mut count) = (fan[0].0, fan[0].0, 0);
        loop {
            here = onward[&here];
            count += 1;
            if here == start || count > fan.len() {
                break;
            }
        }
        assert_eq!(count, fan.len(), "{name}: several fans at vertex {vertex}");
    }
}

fn volume(mesh: &SolidMesh) -> f64 {
    let triangles = mesh.triangles.iter();
    let parts = triangles.map(|triangle| {
        let [a, b, c] = triangle.map(|k| mesh.positions[k as usize]);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}

#[test]
fn the_corners_of_a_cube_stay_sharp() {
    let [x, y, z] = variables();
    let cube = x.abs().max(&y.abs()).max(&z.abs()) - 1.0;
    let mesh = meshed(&world(&cube, None), 8);
    assert_closed_manifold(&mesh, "cube");
    assert!((volume(&mesh) - 8.0).abs() < 1e-9, "{}", volume(&mesh));
    for corner in 0..8 {
        let corner = DVec3::from_array([0, 1, 2].map(|k| 1.0 - 2.0 * f64::from(corner >> k & 1)));
        let nearest = mesh.positions.iter().map(|at| at.distance(corner));
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-9, "{corner}");
    }
}

#[test]
fn a_ball_has_its_volume() {
    let [x, y, z] = variables();
    let ball = x.squared() + y.squared() + z.squared() - 1.0;
    let mesh = meshed(&world(&ball, None), 64);
    assert_closed_manifold(&mesh, "ball");
    let expected = 4.0 * PI / 3.0;
    assert!(
        (volume(&mesh) / expected - 1.0).abs() < 1e-3,
        "{}",
        volume(&mesh)
    );
    let away = mesh.positions.iter().map(|at| (at.length() - 1.0).abs());
    assert!(away.fold(0.0, f64::max) < 1e-3);
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(position.normalize().distance(*normal) < 0.05);
    }
}

#[test]
fn what_touches_itself_is_a_manifold_too() {
    // Balls in rows whose edges and corners meet between the corners of the grid, and every implicit surface at hand.
    let [x, y, z] = variables();
    let mut wild: Vec<(String, Formula, f64)> = surfaces(&variables())
        .into_iter()
        .map(|(name, formula, half)| (name.to_owned(), formula, half))
        .collect();
    let checks = (7.0 * &x).sin() * (7.0 * &y).sin() * (7.0 * &z).sin();
    wild.push(("checks".into(), checks, 1.0));
    let noise =
        (31.0 * &x).sin() + (37.0 * &y).sin() + (41.0 * &z).sin() + (53.0 * (&x + &y)).sin();
    wild.push(("noise".into(), noise, 1.0));
    let mut triangles = 0;
    for (name, formula, half) in &wild {
        for cells in [7, 20] {
            let world = world(formula, Some([-half, *half]));
            let mesh = meshed(&world, cells);
            assert_closed_manifold(&mesh, name);
            triangles += mesh.triangles.len();
        }
    }
    assert!(triangles > 20_000, "{triangles}");
}

#[test]
fn random_trees_have_closed_meshes() {
    let variables = variables();
    let formulas = shapes(&variables);
    let graph = formulas[0].graph().clone();
    let mut random = Random(11);
    let mut meshed_count = 0;
    for round in 0..30 {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let ids: Vec<_> = formulas
            .iter()
            .map(|formula| builder.shape(formula.node(), [None; 3]).unwrap())
            .collect();
        let steps = random.tree(&ids, 12, 1.0);
        builder.solid(&steps).unwrap();
        let world = builder.build().unwrap();
        let Some(bounds) = world.bounds(0).filter(|bounds| !bounds.is_empty()) else {
            continue;
        };
        let work = WorkBudget::new(u64::MAX);
        let mesh = contour(&world, 0, &bounds, 24, &work).expect("work enough");
        assert_closed_manifold(&mesh, &format!("tree {round}"));
        meshed_count += usize::from(!mesh.triangles.is_empty());
        // Vertices are in cells that the surface passes.
        let step = (bounds.upper - bounds.lower).max_element() / 24.0;
        assert!(mesh.positions.iter().all(|at| {
            let slack = DVec3::splat(2.0 * step);
            at.cmpge(bounds.lower - slack).all() && at.cmple(bounds.upper + slack).all()
        }));
    }
    assert!(meshed_count > 12, "{meshed_count}");
}

#[test]
fn a_mesh_takes_no_more_work_than_it_may() {
    let [x, y, z] = &variables();
    let wave = (x * 3.0).sin() + (y * 3.0).sin() + (z * 3.0).sin();
    let graph = wave.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let shape = builder.shape(wave.node(), [Some([-1.0, 1.0]); 3]).unwrap();
    let leaf = SetStep::Leaf(shape, DAffine3::IDENTITY);
    builder.solid([leaf]).unwrap();
    let world = builder.build().unwrap();
    let bounds = world.bounds(0).unwrap();
    let meshed = |most: u64| {
        let work = WorkBudget::new(most);
        let mesh = contour(&world, 0, &bounds, 16, &work);
        (mesh, most - work.left())
    };
    let (Some(whole), taken) = meshed(u64::MAX) else {
        panic!("no mesh");
    };
    assert!(!whole.triangles.is_empty());
    assert!(taken > 1_000);
    // Whatever is left beyond it makes no difference; with less there is no mesh, and nothing is left.
    assert_eq!(meshed(taken + 1), (Some(whole), taken));
    assert_eq!(meshed(taken), (None, taken));
    assert_eq!(meshed(1_000), (None, 1_000));
}
