//! Random solids, rays and an evaluation of their leaves that shares nothing with casting.
#![allow(dead_code, unreachable_pub)]

use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DMat3, DVec3};
use tracer::{SetStep, ShapeId};

use super::formula::Formula;

pub mod sheets;
pub mod surfaces;

/// Numbers that are the same on every run.
pub struct Random(pub u64);

impl Random {
    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = self.0 ^ (self.0 >> 33);
        let x = x.wrapping_mul(0xff51_afd7_ed55_8ccd);
        ((x ^ (x >> 33)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.unit()
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.unit() * n as f64) as usize).min(n - 1)
    }

    pub fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|_| self.between(-size, size)))
    }

    /// A unit vector.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector(1.0);
            if v.length() > 0.1 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }

    /// A map with rotation, shear, unequal scales, and every fourth time a reflection.
    pub fn map(&mut self, place: f64) -> DAffine3 {
        let rotation = DMat3::from_axis_angle(self.direction(), self.between(0.0, 6.0));
        let shear = DMat3::from_cols(
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(self.between(-0.7, 0.7), 1.0, 0.0),
            DVec3::new(self.between(-0.7, 0.7), self.between(-0.7, 0.7), 1.0),
        );
        let mut scale = DVec3::from_array([0, 1, 2].map(|_| self.between(0.4, 1.6)));
        if self.below(4) == 0 {
            scale.x = -scale.x;
        }
        let matrix = rotation * shear * DMat3::from_diagonal(scale);
        DAffine3::from_mat3_translation(matrix, self.vector(place))
    }

    /// A tree of up to `most` leaves over these shapes.
    pub fn tree(&mut self, shapes: &[ShapeId], most: usize, place: f64) -> Vec<SetStep> {
        let count = 1 + self.below(most);
        let mut steps = Vec::new();
        let mut open = 0;
        let mut left = count;
        while left > 0 || open > 1 {
            if left > 0 && (open < 2 || self.below(2) == 0) {
                let shape = shapes[self.below(shapes.len())];
                steps.push(SetStep::Leaf(shape, self.map(place)));
                open += 1;
                left -= 1;
            } else {
                let joins = [
                    SetStep::Union,
                    SetStep::Intersection,
                    SetStep::Difference,
                    SetStep::Union,
                ];
                steps.push(joins[self.below(4)]);
                open -= 1;
            }
        }
        steps
    }
}

/// Shapes of every class about the origin, of a size of about 1.
pub fn shapes([x, y, z]: &[Formula; 3]) -> Vec<Formula> {
    let rr = &(x.squared() + y.squared());
    let r2 = &(rr + z.squared());
    let gyroid = (3.0 * x).sin() * (3.0 * y).cos()
        + (3.0 * y).sin() * (3.0 * z).cos()
        + (3.0 * z).sin() * (3.0 * x).cos();
    vec![
        r2 - 1.0,
        x.abs().max(&y.abs()).max(&z.abs()) - 0.8,
        rr.max(&z.squared()) - 0.6,
        (rr.sqrt() - 0.8).squared() + z.squared() - 0.09,
        (r2 + 0.64 - 0.09).squared() - 2.56 * rr,
        x.abs() + y.abs() + z.abs() - 1.0,
        x.powi(4) + y.powi(4) + z.powi(4) - 0.9,
        rr.sqrt() + z.abs() - 1.0,
        r2.sqrt().max(&-(r2.sqrt() - 0.2)) - 0.9,
        gyroid.max(&(r2 - 1.0)),
        (r2 - 1.0).powi(3) - x.squared() * z.powi(3) - 0.1 * y.squared() * z.powi(3),
        rr - (1.0 - z.squared()) * (0.3 + z.squared()),
    ]
}

/// A leaf's expression under its map, evaluated at points of space.
pub struct LeafValue {
    tape: Tape,
    registers: Registers,
    inverse: DAffine3,
}

impl LeafValue {
    pub fn new(graph: &Graph, root: NodeId, map: &DAffine3) -> Self {
        let (mut graph, roots) = graph.extract(&[root]);
        let mut all = roots.clone();
        for k in 0..3 {
            all.extend(graph.derivatives(&roots, Input::Variable(k)).unwrap());
        }
        Self {
            tape: Tape::new(&graph, &all),
            registers: Registers::default(),
            inverse: map.inverse(),
        }
    }

    /// The value and the gradient by the coordinates of space.
    pub fn at(&mut self, point: DVec3) -> (f64, DVec3) {
        let at = self.inverse.transform_point3(point);
        let inputs: Vec<f64> = self
            .tape
            .inputs()
            .iter()
            .map(|input| match input {
                Input::Variable(k) => at[*k as usize],
                Input::Uniform(_) => f64::NAN,
            })
            .collect();
        let mut out = [0.0; 4];
        self.tape.eval(&mut self.registers, &inputs, &mut out);
        let gradient = DVec3::new(out[1], out[2], out[3]);
        (out[0], self.inverse.matrix3.transpose() * gradient)
    }
}
