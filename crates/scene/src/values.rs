//! Values for a scene's params and grids, and the instances they give.

use crate::scene::{GridId, Object, Scene};

/// A value for each param, and for those grids that have been fixed.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// One number per uniform; those of a grid that is not fixed are overwritten for each instance.
    uniforms: Vec<f64>,
    /// The grids whose value has been fixed.
    fixed: Vec<GridId>,
}

/// Why a value was refused.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum SetError {
    /// No param or grid has this name.
    Unknown {
        name: String,
        suggestion: Option<String>,
    },
    /// The number of values is not the number of components.
    Components {
        name: String,
        expected: usize,
        given: usize,
    },
    /// A value lies outside its interval (or is not a number).
    OutOfRange {
        name: String,
        component: usize,
        value: f64,
        min: f64,
        max: f64,
    },
}

impl Settings {
    /// Each param at its minimum, no grid fixed.
    pub fn opening(scene: &Scene) -> Self {
        let _ = scene;
        todo!()
    }

    /// Gives a param a value, or fixes a grid to one.
    pub fn set(&mut self, scene: &Scene, name: &str, values: &[f64]) -> Result<(), SetError> {
        let _ = (scene, name, values);
        todo!()
    }

    /// One number per uniform, for an object that depends on no grid.
    pub fn uniforms(&self) -> &[f64] {
        &self.uniforms
    }

    /// How many instances of the object are drawn.
    pub fn instance_count(&self, scene: &Scene, object: &Object) -> u64 {
        let _ = (scene, object, &self.fixed);
        todo!()
    }

    /// The uniforms of each instance of an object in turn, the last grid's last axis fastest: calls `visit`
    /// with one number per uniform.
    pub fn for_each_instance(&self, scene: &Scene, object: &Object, visit: impl FnMut(&[f64])) {
        let _ = (scene, object, visit);
        todo!()
    }

    /// The uniforms of the first instance.
    pub fn first_instance(&self, scene: &Scene, object: &Object) -> Vec<f64> {
        let _ = (scene, object);
        todo!()
    }
}
