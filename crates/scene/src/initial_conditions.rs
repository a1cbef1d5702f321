//! The initial conditions of declared geodesics.
//!
//! In: an object that is a geodesic and the uniforms of one of its instances. Out: the place and the
//! direction it starts with, or the reason for which it cannot start and is not drawn.

use std::fmt;

use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};

use crate::scene::{ObjectId, Range, Scene};

/// The place and the direction with which one instance of a geodesic starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialConditions {
    /// The parameters (u, v) where it starts, inside the domain of its surface or, but for rounding, on the
    /// domain's sides.
    pub start: [f64; 2],
    /// The direction a σu + b σv as (a, b), finite and not zero; its length does not matter.
    pub direction: [f64; 2],
}

/// The reason for which an instance of a geodesic cannot start. Its text is the end of a sentence: "its direction is zero".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialConditionsError {
    /// A component of the direction is no finite number.
    UndefinedDirection,
    /// The direction is (0, 0).
    ZeroDirection,
    /// A parameter of the start is no finite number.
    UndefinedStart,
    /// The start lies outside the surface's domain.
    Outside {
        /// The start.
        start: [f64; 2],
        /// The domain.
        domain: [Range; 2],
    },
}

/// The distance beyond a side at which a start may lie, as a share of the domain's width.
const SLACK: f64 = 1e-12;

impl fmt::Display for InitialConditionsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UndefinedDirection => write!(f, "its direction is undefined"),
            Self::ZeroDirection => write!(f, "its direction is zero"),
            Self::UndefinedStart => write!(f, "its start is undefined"),
            Self::Outside {
                start: [u, v],
                domain: [first, second],
            } => write!(
                f,
                "its start ({u}, {v}) lies outside the domain [{}, {}] × [{}, {}]",
                first.min, first.max, second.min, second.max
            ),
        }
    }
}

/// Evaluates the starts of a geodesic's instances.
#[derive(Clone, Debug)]
pub struct InitialConditionsEvaluator {
    tape: Tape,
    registers: Registers,
    domain: [Range; 2],
}

impl InitialConditionsEvaluator {
    /// Prepares the evaluation for an object of the scene; `None` if it is not a geodesic.
    pub fn new(scene: &Scene, object: ObjectId) -> Option<Self> {
        let shape = &scene.get(object)?.shape;
        let (surface, _) = shape.geodesic()?;
        let (direction, start) = shape.initial_conditions()?;
        let domain = scene.get(surface)?.shape.manifold()?;
        let domain = domain.map(|axis| axis.range);
        Some(Self::from_nodes(&scene.graph, direction, start, domain))
    }

    /// Prepares the evaluation of expressions of a graph.
    pub(crate) fn from_nodes(
        graph: &Graph,
        direction: &[NodeId; 2],
        start: &[NodeId; 2],
        domain: [Range; 2],
    ) -> Self {
        let [a, b] = *direction;
        let [u, v] = *start;
        Self {
            tape: Tape::new(graph, &[a, b, u, v]),
            registers: Registers::default(),
            domain,
        }
    }

    /// The start of the instance with these uniforms, one number each.
    ///
    /// # Errors
    /// It cannot start.
    pub fn evaluate(
        &mut self,
        uniforms: &[f64],
    ) -> Result<InitialConditions, InitialConditionsError> {
        let number = |input: &Input| match *input {
            Input::Uniform(index) => uniforms.get(index as usize).copied(),
            Input::Variable(_) => None,
        };
        let inputs = self.tape.inputs().iter();
        let inputs: Vec<f64> = inputs
            .map(|input| number(input).unwrap_or(f64::NAN))
            .collect();
        let mut out = [f64::NAN; 4];
        self.tape.eval(&mut self.registers, &inputs, &mut out);
        let [a, b, u, v] = out;
        let (direction, start) = ([a, b], [u, v]);
        if !direction.iter().all(|x| x.is_finite()) {
            return Err(InitialConditionsError::UndefinedDirection);
        }
        if direction == [0.0; 2] {
            return Err(InitialConditionsError::ZeroDirection);
        }
        if !start.iter().all(|x| x.is_finite()) {
            return Err(InitialConditionsError::UndefinedStart);
        }
        let domain = self.domain;
        let inside = |(range, x): (&Range, &f64)| {
            // A point on a side may have been rounded beyond it.
            let slack = SLACK * (range.max - range.min);
            (range.min - slack..=range.max + slack).contains(x)
        };
        if !domain.iter().zip(&start).all(inside) {
            return Err(InitialConditionsError::Outside { start, domain });
        }
        Ok(InitialConditions { start, direction })
    }
}

#[cfg(test)]
mod tests {
    use super::{InitialConditions, InitialConditionsError, InitialConditionsEvaluator};
    use crate::param_values::ParamValues;
    use crate::scene::{ObjectId, Range, Scene};

    fn scene(source: &str) -> Scene {
        let compilation = crate::geotrace::compile(source);
        let found = compilation.diagnostics;
        compilation.scene.unwrap_or_else(|| panic!("{found:#?}"))
    }

    const PROGRAM: &str = "
        param a : [0, 1]; param place : [-1, 1], [0, 3];
        surface s(u,v) = (u, v, a), u : [0, 1], v : [0, 2];
        geodesic g(t) : s = (a, 2a) @ place, t : [0, 1];";

    #[test]
    fn a_geodesic_starts_where_its_params_put_it() {
        let scene = scene(PROGRAM);
        let mut params = ParamValues::initial(&scene);
        let mut evaluator =
            InitialConditionsEvaluator::new(&scene, ObjectId(1)).expect("a geodesic");
        let mut evaluate = |params: &ParamValues| {
            evaluator.evaluate(&params.first_instance(&scene, &scene.objects[1]))
        };
        assert_eq!(
            evaluate(&params),
            Err(InitialConditionsError::ZeroDirection)
        );
        params.set(&scene, "a", &[0.5]).expect("in range");
        let domain = [(0.0, 1.0), (0.0, 2.0)].map(|(min, max)| Range { min, max });
        let start = [-1.0, 0.0];
        let outside = Err(InitialConditionsError::Outside { start, domain });
        assert_eq!(evaluate(&params), outside);
        // A corner belongs to the domain.
        params.set(&scene, "place", &[1.0, 2.0]).expect("in range");
        let (start, direction) = ([1.0, 2.0], [0.5, 1.0]);
        assert_eq!(
            evaluate(&params),
            Ok(InitialConditions { start, direction })
        );
        let sentence = InitialConditionsError::Outside { start, domain }.to_string();
        let expected = "its start (1, 2) lies outside the domain [0, 1] × [0, 2]";
        assert_eq!(sentence, expected);
    }

    #[test]
    fn what_is_no_geodesic_has_no_initial_conditions() {
        let scene = scene(PROGRAM);
        assert!(InitialConditionsEvaluator::new(&scene, ObjectId(0)).is_none());
        assert!(InitialConditionsEvaluator::new(&scene, ObjectId(2)).is_none());
    }
}
