//! Implicit surfaces against dense sampling of their expressions.

use expr::tape::{Block, LANES, Registers, Tape};
use glam::{DAffine3, DVec3};
use tracer::{Ray, SetStep, WorldBuilder};

use crate::formula::variables;
use crate::scenes::surfaces::surfaces;
use crate::scenes::{LeafValue, Random};

/// The number of samples of a ray, in blocks.
const BLOCKS: usize = 24;

#[test]
fn no_surface_has_a_hole() {
    let variables = variables();
    let surfaces = surfaces(&variables);
    assert!(surfaces.len() >= 30);
    let graph = variables[0].graph().clone();
    let mut random = Random(9);
    for (name, formula, half) in &surfaces {
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let cuts = [Some([-half, *half]); 3];
        let shape = builder.shape(formula.node(), cuts).unwrap();
        builder
            .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
            .unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        let tape = Tape::new(&graph, &[formula.node()]);
        let mut registers = Registers::default();
        let mut direct = LeafValue::new(&graph, formula.node(), &DAffine3::IDENTITY);
        let mut seen = 0;
        for k in 0..500 {
            let direction = match k % 8 {
                0 => DVec3::NEG_Z,
                _ => random.direction(),
            };
            let origin = random.vector(*half) - 4.0 * half * direction;
            let ray = Ray {
                origin,
                direction,
                leaving: None,
            };
            let crossings = caster.cast(&ray);
            seen += crossings.len();
            let length = 8.0 * half;
            let count = BLOCKS * LANES;
            let mut said = false;
            let mut next = 0;
            for block in 0..BLOCKS {
                let t = |lane: usize| ((block * LANES + lane) as f64 + 0.5) * length / count as f64;
                let points: Vec<DVec3> = (0..LANES)
                    .map(|lane| origin + t(lane) * direction)
                    .collect();
                let columns: Vec<Block> = tape
                    .inputs()
                    .iter()
                    .map(|input| match input {
                        expr::Input::Variable(k) => {
                            std::array::from_fn(|lane| points[lane][*k as usize])
                        }
                        expr::Input::Uniform(_) => [f64::NAN; LANES],
                    })
                    .collect();
                let mut out = [[f64::NAN; LANES]];
                tape.eval_block(&mut registers, &columns, &mut out);
                for lane in 0..LANES {
                    let t = t(lane);
                    while next < crossings.len() && crossings[next].t <= t {
                        said = crossings[next].entering;
                        next += 1;
                    }
                    let inside = points[lane].abs().max_element() <= *half && out[0][lane] <= 0.0;
                    if inside == said {
                        continue;
                    }
                    // At the surface rounding decides: within 10⁻⁹ of a crossing, or of a change of the sign.
                    let near = crossings
                        .iter()
                        .any(|other| (other.t - t).abs() < 1e-9 * (1.0 + t));
                    let beside = [-1e-6, 1e-6].map(|step| {
                        let point = origin + (t + step) * direction;
                        direct.at(point).0 <= 0.0 && point.abs().max_element() <= *half
                    });
                    assert!(
                        near || beside != [inside; 2],
                        "{name}, ray {k}: at {t} inside is {inside}, {ray:?}, {crossings:#?}"
                    );
                }
            }
        }
        assert!(seen > 20 || *name == "tiny", "{name}: {seen}");
    }
}

#[test]
fn thin_and_tiny_sets_are_hit() {
    let variables = variables();
    let surfaces = surfaces(&variables);
    let graph = variables[0].graph().clone();
    for (wanted, count) in [
        ("thin shell", 4),
        ("thin gyroid", 2),
        ("tiny", 2),
        ("step", 2),
    ] {
        let (_, formula, half) = surfaces.iter().find(|(name, ..)| *name == wanted).unwrap();
        let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
        let shape = builder
            .shape(formula.node(), [Some([-half, *half]); 3])
            .unwrap();
        builder
            .solid([SetStep::Leaf(shape, DAffine3::IDENTITY)])
            .unwrap();
        let world = builder.build().unwrap();
        let mut caster = world.caster();
        // Through the middle, a little oblique.
        let direction = DVec3::new(0.1, 0.2, 1.0).normalize();
        let ray = Ray {
            origin: -9.0 * direction + DVec3::splat(1e-5),
            direction,
            leaving: None,
        };
        let crossings = caster.cast(&ray);
        assert!(
            crossings.len() >= count && crossings.len().is_multiple_of(2),
            "{wanted}: {crossings:#?}"
        );
    }
}
