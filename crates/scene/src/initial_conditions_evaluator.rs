//! The initial conditions of declared geodesics.
//!
//! In: an object that is a geodesic and the uniforms of one of its instances. Out: its initial conditions, or the reason why
//! it cannot start.

use expr::tape::{Registers, Tape};
use expr::{Graph, NodeId};

use crate::initial_conditions::{InitialConditions, InitialConditionsError};
use crate::scene::{ObjectId, Range, Scene};

/// Evaluates the starts of a geodesic's instances.
#[derive(Clone, Debug)]
pub struct InitialConditionsEvaluator {
    tape: Tape,
    registers: Registers,
    domain: [Range; 2],
    has_unit: bool,
}

impl InitialConditionsEvaluator {
    /// Prepares the evaluation for an object of the scene; `None` if it is not a geodesic.
    pub fn new(scene: &Scene, object: ObjectId) -> Option<Self> {
        let shape = &scene.get(object)?.shape;
        let (surface, _) = shape.geodesic()?;
        let (direction, start, unit) = shape.initial_conditions()?;
        let domain = scene.get(surface)?.shape.manifold()?;
        let domain = domain.map(|axis| axis.range);
        let graph = &scene.graph;
        Some(Self::from_nodes(graph, direction, start, unit, domain))
    }

    /// Prepares the evaluation of expressions of a graph.
    pub(crate) fn from_nodes(
        graph: &Graph,
        direction: &[NodeId; 2],
        start: &[NodeId; 2],
        unit: Option<NodeId>,
        domain: [Range; 2],
    ) -> Self {
        let [a, b] = *direction;
        let [u, v] = *start;
        Self {
            // A length that is not read costs nothing.
            tape: Tape::new(graph, &[a, b, u, v, unit.unwrap_or(u)]),
            has_unit: unit.is_some(),
            registers: Registers::default(),
            domain,
        }
    }

    /// Returns the start of the instance with these uniforms, one number each.
    ///
    /// # Errors
    /// If it cannot start.
    pub fn evaluate(
        &mut self,
        uniforms: &[f64],
    ) -> Result<InitialConditions, InitialConditionsError> {
        let inputs = self.tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&[], uniforms)).collect();
        let mut out = [f64::NAN; 5];
        self.tape.eval(&mut self.registers, &inputs, &mut out);
        let [a, b, u, v, unit] = out;
        let unit = match self.has_unit {
            true if unit.is_nan() => return Err(InitialConditionsError::NoConnection),
            true if unit == 0.0 => return Err(InitialConditionsError::OnePlace),
            true => unit,
            false => 1.0,
        };
        InitialConditions::new([u, v], [a, b], unit, self.domain)
    }
}

#[cfg(test)]
mod tests {
    use super::InitialConditionsEvaluator;
    use crate::initial_conditions::{InitialConditions, InitialConditionsError};
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
            InitialConditionsEvaluator::new(&scene, ObjectId::new(1)).expect("a geodesic");
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
        let outside = Err(InitialConditionsError::Outside {
            place: start,
            domain,
        });
        assert_eq!(evaluate(&params), outside);
        // A corner belongs to the domain.
        params.set(&scene, "place", &[1.0, 2.0]).expect("in range");
        let (start, direction) = ([1.0, 2.0], [0.5, 1.0]);
        assert_eq!(
            evaluate(&params),
            Ok(InitialConditions {
                start,
                direction,
                unit: 1.0
            })
        );
        let sentence = InitialConditionsError::Outside {
            place: start,
            domain,
        }
        .to_string();
        let expected = "the point (1, 2) lies outside the domain [0, 1] × [0, 2]";
        assert_eq!(sentence, expected);
    }

    #[test]
    fn what_is_no_geodesic_has_no_initial_conditions() {
        let scene = scene(PROGRAM);
        assert!(InitialConditionsEvaluator::new(&scene, ObjectId::new(0)).is_none());
        assert!(InitialConditionsEvaluator::new(&scene, ObjectId::new(2)).is_none());
    }
}
