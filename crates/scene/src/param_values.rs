//! Values for a scene's params and grids, and the resulting instances.
//!
//! In: names and numbers from a command line, a slider or an animation. Out: one number per uniform, in the order of
//! `expr::Input::Uniform`, for each instance of an object.

use expr::number;
use std::fmt;
use std::sync::Arc;

use syntax::spelling::nearest;

use crate::rerun::FailedRun;
use crate::scene::{Grid, GridId, Object, Param, Range, Scene};
use crate::solid::BoundGrid;

/// A value for each param, and for those grids that have been fixed.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamValues {
    /// One number per uniform; the numbers of a grid that is not fixed are overwritten for each instance.
    uniforms: Vec<f64>,
    /// The grids whose value has been fixed.
    fixed: Vec<GridId>,
}

/// The reason why a value is refused.
#[derive(Clone, Debug, PartialEq)]
pub enum SetError {
    /// No param or grid has this name.
    Unknown {
        /// The name as given.
        name: String,
        /// A param or grid with a similar name.
        suggestion: Option<String>,
    },
    /// The name is that of a component in an expression.
    Component {
        /// The name as given.
        name: String,
        /// The param or grid.
        whole: String,
        /// The number of its components.
        components: usize,
    },
    /// The number of values differs from the number of components.
    Components {
        /// The param or grid.
        name: String,
        /// The number of its components.
        expected: usize,
        /// The number of given values.
        given: usize,
    },
    /// A value is outside its interval (or is not a number).
    OutOfRange {
        /// The param or grid.
        name: String,
        /// The index of the component, from 0.
        component: usize,
        /// The number of its components.
        components: usize,
        /// The value as given.
        value: f64,
        /// The minimum.
        min: f64,
        /// The maximum.
        max: f64,
    },
}

impl fmt::Display for SetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { name, suggestion } => {
                write!(f, "no param or grid is named `{name}`")?;
                match suggestion {
                    Some(suggestion) => write!(f, "; did you mean `{suggestion}`?"),
                    None => Ok(()),
                }
            }
            Self::Component {
                name,
                whole,
                components,
            } => {
                let all: Vec<String> = (1..=*components).map(|k| format!("V{k}")).collect();
                let all = all.join(",");
                write!(
                    f,
                    "`{name}` is a component of `{whole}`: state all of them, as in `{whole}={all}`"
                )
            }
            Self::Components {
                name,
                expected: 1,
                given,
            } => write!(f, "`{name}` is one number, but {given} were given"),
            Self::Components {
                name,
                expected,
                given: 1,
            } => write!(f, "`{name}` has {expected} components, but 1 was given"),
            Self::Components {
                name,
                expected,
                given,
            } => write!(
                f,
                "`{name}` has {expected} components, but {given} were given"
            ),
            Self::OutOfRange {
                name,
                component,
                components,
                value,
                min,
                max,
            } => {
                let [value, min, max] = [value, min, max].map(|number| number::text(*number));
                if *components == 1 {
                    write!(f, "`{name}` = {value} ")?;
                } else {
                    write!(f, "`{name}_{}` = {value} ", component + 1)?;
                }
                write!(f, "lies outside its interval [{min}, {max}]")
            }
        }
    }
}

impl std::error::Error for SetError {}

impl SetError {
    /// Checks values against the intervals of a param's or grid's components.
    ///
    /// # Errors
    /// [`SetError::Components`], [`SetError::OutOfRange`].
    pub fn check(name: &str, ranges: &[Range], values: &[f64]) -> Result<(), Self> {
        if ranges.len() != values.len() {
            return Err(Self::Components {
                name: name.to_owned(),
                expected: ranges.len(),
                given: values.len(),
            });
        }
        let Some(component) = Range::first_outside(ranges, values) else {
            return Ok(());
        };
        let range = ranges[component];
        Err(Self::OutOfRange {
            name: name.to_owned(),
            component,
            components: ranges.len(),
            value: values[component],
            min: range.min,
            max: range.max,
        })
    }
}

impl Scene {
    /// Returns the scene for these values of its params: a new scene if the values may change more than numbers, otherwise
    /// the given one.
    pub fn at(self: &Arc<Self>, params: &ParamValues) -> Arc<Self> {
        self.made_anew(params).unwrap_or_else(|| self.clone())
    }

    /// Returns the scene of [`Scene::at`], or `None` if it is the given one.
    pub fn made_anew(&self, params: &ParamValues) -> Option<Arc<Self>> {
        let attach = |scene: &mut Self, rerun| scene.rerun = Some(rerun);
        self.rerun.as_ref()?.at(params.uniforms(), attach)
    }

    /// Returns an error if the run that made the scene has errors.
    ///
    /// # Errors
    /// [`FailedRun`].
    pub fn check_run(&self) -> Result<(), FailedRun> {
        self.diagnostics.as_ref().map_or(Ok(()), FailedRun::check)
    }

    /// Returns the values of its params for which the scene was made, if other values may change more than numbers.
    pub fn made_for(&self) -> Option<ParamValues> {
        Some(ParamValues {
            uniforms: self.rerun.as_ref()?.values().to_vec(),
            ..ParamValues::initial(self)
        })
    }
}

impl ParamValues {
    /// Returns the initial value of each param, with no grid fixed.
    pub fn initial(scene: &Scene) -> Self {
        let mut uniforms = vec![0.0; scene.uniform_count as usize];
        for param in &scene.params {
            let first = param.first_uniform as usize;
            for (place, value) in uniforms[first..].iter_mut().zip(&param.initial) {
                *place = *value;
            }
        }
        for grid in &scene.grids {
            let first = grid.first_uniform as usize;
            for (place, axis) in uniforms[first..].iter_mut().zip(&grid.axes) {
                *place = axis.range.min;
            }
        }
        Self {
            uniforms,
            fixed: Vec::new(),
        }
    }

    /// Sets the value of a param, or fixes a grid to a value within its intervals, whose ends are included.
    ///
    /// # Errors
    /// If the name is unknown, the number of values differs from the number of components, or a value is outside its
    /// interval; the values are then unchanged.
    pub fn set(&mut self, scene: &Scene, name: &str, values: &[f64]) -> Result<(), SetError> {
        if let Some(param) = scene.params.iter().find(|param| param.name == name) {
            SetError::check(name, &param.ranges, values)?;
            self.write(param.first_uniform, values);
            return Ok(());
        }
        let position = scene.grids.iter().position(|grid| grid.name == name);
        let Some(position) = position else {
            return Err(unknown(scene, name));
        };
        let grid = &scene.grids[position];
        let ranges: Vec<Range> = grid.axes.iter().map(|axis| axis.range).collect();
        SetError::check(name, &ranges, values)?;
        self.write(grid.first_uniform, values);
        let id = GridId(position as u32);
        if !self.fixed.contains(&id) {
            self.fixed.push(id);
        }
        Ok(())
    }

    /// Returns one number per uniform, for an expression that depends on no grid and no geodesic.
    pub fn uniforms(&self) -> &[f64] {
        &self.uniforms
    }

    /// Returns the value of a param, one number per component.
    pub fn param(&self, param: &Param) -> &[f64] {
        let first = param.first_uniform as usize;
        &self.uniforms[first..first + param.ranges.len()]
    }

    /// Returns the value to which a grid is fixed, one number per axis.
    pub fn fixed_grid(&self, scene: &Scene, id: GridId) -> Option<&[f64]> {
        let grid: &Grid = scene.grids.get(id.0 as usize)?;
        let first = grid.first_uniform as usize;
        self.fixed
            .contains(&id)
            .then(|| &self.uniforms[first..first + grid.axes.len()])
    }

    /// Returns the number of drawn instances of the object: the product of the numbers of values of its grids that are
    /// not fixed. At most [`crate::limits::MAX_INSTANCES`] in a compiled scene.
    pub fn instance_count(&self, scene: &Scene, object: &Object) -> u64 {
        self.combinations(scene, &object.grids)
    }

    /// Calls `visit` with the uniforms of each instance of an object in turn, one number per uniform. The last grid's
    /// last axis varies fastest.
    pub fn for_each_instance(&self, scene: &Scene, object: &Object, mut visit: impl FnMut(&[f64])) {
        let mut uniforms = self.uniforms.clone();
        for index in 0..self.instance_count(scene, object) {
            self.combination(scene, &object.grids, index, &mut uniforms);
            scene.fill(object, &mut uniforms);
            visit(&uniforms);
        }
    }

    /// Returns the number of combinations of the values of those grids that are not fixed; saturates.
    pub fn combination_count(&self, scene: &Scene, grids: &[BoundGrid]) -> u64 {
        let ids: Vec<GridId> = grids.iter().map(|bound| bound.grid).collect();
        self.combinations(scene, &ids)
    }

    /// Returns the given uniforms with the `index`-th combination of the values of those grids that are not fixed, counted from
    /// 0 and below [`ParamValues::combination_count`], written to the uniforms of the grids. The values of geodesics that the
    /// object reads are computed for it.
    pub fn with_combination(
        &self,
        scene: &Scene,
        object: &Object,
        grids: &[BoundGrid],
        index: u64,
        uniforms: &[f64],
    ) -> Vec<f64> {
        let ids: Vec<GridId> = grids.iter().map(|bound| bound.grid).collect();
        let mut own = self.uniforms.clone();
        self.combination(scene, &ids, index, &mut own);
        let mut uniforms = uniforms.to_vec();
        for bound in grids {
            if let Some(grid) = scene.grids.get(bound.grid.0 as usize) {
                let (from, to) = (grid.first_uniform as usize, bound.first_uniform as usize);
                let count = grid.axes.len();
                let own = own.get(from..from + count);
                if let (Some(own), Some(bound)) = (own, uniforms.get_mut(to..to + count)) {
                    bound.copy_from_slice(own);
                }
            }
        }
        scene.fill(object, &mut uniforms);
        uniforms
    }

    /// Returns the uniforms of the first instance.
    pub fn first_instance(&self, scene: &Scene, object: &Object) -> Vec<f64> {
        self.instance(scene, object, 0)
    }

    /// Returns the uniforms of the `index`-th instance that [`ParamValues::for_each_instance`] visits, counted from 0
    /// and below [`ParamValues::instance_count`]. This allows instances to be distributed over threads.
    pub fn instance(&self, scene: &Scene, object: &Object, index: u64) -> Vec<f64> {
        let mut uniforms = self.uniforms.clone();
        self.combination(scene, &object.grids, index, &mut uniforms);
        scene.fill(object, &mut uniforms);
        uniforms
    }

    /// Returns the number of combinations of values of the grids that are not fixed; saturates.
    pub(crate) fn combinations(&self, scene: &Scene, grids: &[GridId]) -> u64 {
        self.open_axes(scene, grids)
            .fold(1, |product: u64, (_, axis)| {
                product.saturating_mul(u64::from(axis.count))
            })
    }

    /// Writes the values of the grids' `index`-th combination, the last axis fastest, to `uniforms`.
    pub(crate) fn combination(
        &self,
        scene: &Scene,
        grids: &[GridId],
        index: u64,
        uniforms: &mut [f64],
    ) {
        // In mixed radix the last axis is the last digit: compute the digits from the last to the first.
        let axes: Vec<_> = self.open_axes(scene, grids).collect();
        let mut rest = index;
        for (place, axis) in axes.into_iter().rev() {
            let count = u64::from(axis.count);
            uniforms[place] = axis.value((rest % count) as u32);
            rest /= count;
        }
    }

    /// Returns the axes of those grids that are not fixed, each with its uniform.
    fn open_axes<'a>(
        &'a self,
        scene: &'a Scene,
        grids: &'a [GridId],
    ) -> impl Iterator<Item = (usize, crate::scene::Sampling)> + 'a {
        grids
            .iter()
            .filter(|id| !self.fixed.contains(id))
            .filter_map(|id| scene.grids.get(id.0 as usize))
            .flat_map(|grid| (grid.first_uniform as usize..).zip(grid.axes.iter().copied()))
    }

    fn write(&mut self, first_uniform: u32, values: &[f64]) {
        let first = first_uniform as usize;
        self.uniforms[first..first + values.len()].copy_from_slice(values);
    }
}

/// Returns the error for a name that no param or grid has.
fn unknown(scene: &Scene, name: &str) -> SetError {
    let params = scene.params.iter().map(|it| (&it.name, it.ranges.len()));
    let grids = scene.grids.iter().map(|it| (&it.name, it.axes.len()));
    let component = name.rsplit_once('_').and_then(|(whole, number)| {
        let number: usize = number.parse().ok()?;
        let mut all = params.chain(grids);
        all.find(|(other, count)| *other == whole && (1..=*count).contains(&number))
    });
    match component {
        Some((whole, components)) => SetError::Component {
            name: name.to_owned(),
            whole: whole.clone(),
            components,
        },
        None => SetError::Unknown {
            name: name.to_owned(),
            suggestion: suggestion(scene, name),
        },
    }
}

/// Returns the param or grid whose name is nearest to a word, if it is near enough.
fn suggestion(scene: &Scene, word: &str) -> Option<String> {
    let params = scene.params.iter().map(|param| param.name.as_str());
    let grids = scene.grids.iter().map(|grid| grid.name.as_str());
    nearest(word, params.chain(grids))
}

#[cfg(test)]
mod tests {
    use syntax::span::Span;

    use super::{ParamValues, SetError};
    use crate::scene::{Grid, GridId, Object, Param, Range, Sampling, Scene, Shape};

    const fn range(min: f64, max: f64) -> Range {
        Range { min, max }
    }

    /// param alpha = 1.5 : [1, 2]; param b : [0, 1], [5, 6]; grid k : [0, 1, 2], [10, 12, 3]; grid m : [7, 8, 2];
    fn scene() -> Scene {
        let axis = |min, max, count| Sampling {
            range: range(min, max),
            count,
        };
        let span = Span::default();
        Scene {
            params: vec![
                Param {
                    name: "alpha".into(),
                    name_span: span,
                    ranges: vec![range(1.0, 2.0)],
                    initial: vec![1.5],
                    first_uniform: 0,
                },
                Param {
                    name: "b".into(),
                    name_span: span,
                    ranges: vec![range(0.0, 1.0), range(5.0, 6.0)],
                    initial: vec![0.0, 5.0],
                    first_uniform: 1,
                },
            ],
            grids: vec![
                Grid {
                    name: "k".into(),
                    name_span: span,
                    axes: vec![axis(0.0, 1.0, 2), axis(10.0, 12.0, 3)],
                    first_uniform: 3,
                },
                Grid {
                    name: "m".into(),
                    name_span: span,
                    axes: vec![axis(7.0, 8.0, 2)],
                    first_uniform: 5,
                },
            ],
            uniform_count: 6,
            ..Scene::default()
        }
    }

    fn object(scene: &mut Scene) -> Object {
        let zero = scene.graph.constant(0.0);
        Object {
            name: "p".into(),
            name_span: Span::default(),
            shape: Shape::Point {
                position: [zero; 3],
            },
            params: vec![],
            grids: vec![GridId(0), GridId(1)],
            geodesic_values: Vec::new(),
            attributes: Vec::new(),
        }
    }

    #[test]
    fn params_open_with_their_value() {
        let scene = scene();
        let params = ParamValues::initial(&scene);
        assert_eq!(params.uniforms(), [1.5, 0.0, 5.0, 0.0, 10.0, 7.0]);
        assert_eq!(params.param(&scene.params[1]), [0.0, 5.0]);
    }

    #[test]
    fn instances_run_through_the_product_with_the_last_axis_fastest() {
        let mut scene = scene();
        let object = object(&mut scene);
        let mut params = ParamValues::initial(&scene);
        assert_eq!(params.instance_count(&scene, &object), 12);
        let mut seen = Vec::new();
        params.for_each_instance(&scene, &object, |uniforms| {
            seen.push(uniforms[3..].to_vec())
        });
        assert_eq!(seen.len(), 12);
        assert_eq!(seen[0], [0.0, 10.0, 7.0]);
        assert_eq!(seen[1], [0.0, 10.0, 8.0]);
        assert_eq!(seen[2], [0.0, 11.0, 7.0]);
        assert_eq!(seen[6], [1.0, 10.0, 7.0]);
        assert_eq!(seen[11], [1.0, 12.0, 8.0]);
        assert_eq!(params.instance(&scene, &object, 2)[3..], seen[2][..]);

        params.set(&scene, "k", &[0.25, 11.5]).unwrap();
        assert_eq!(params.instance_count(&scene, &object), 2);
        assert_eq!(
            params.first_instance(&scene, &object)[3..],
            [0.25, 11.5, 7.0]
        );
        assert_eq!(
            params.fixed_grid(&scene, GridId(0)),
            Some(&[0.25, 11.5][..])
        );
        assert_eq!(params.fixed_grid(&scene, GridId(1)), None);
    }

    #[test]
    fn a_refused_value_changes_nothing_and_says_why() {
        let scene = scene();
        let mut params = ParamValues::initial(&scene);
        let before = params.clone();
        let sentence = |error: Result<(), SetError>| error.unwrap_err().to_string();
        assert_eq!(
            sentence(params.set(&scene, "alpha", &[3.0])),
            "`alpha` = 3 lies outside its interval [1, 2]"
        );
        assert_eq!(
            sentence(params.set(&scene, "alpha", &[f64::NAN])),
            "`alpha` = undefined lies outside its interval [1, 2]"
        );
        assert_eq!(
            sentence(params.set(&scene, "b", &[0.5, -1.0])),
            "`b_2` = -1 lies outside its interval [5, 6]"
        );
        assert_eq!(
            sentence(params.set(&scene, "k_2", &[11.0])),
            "`k_2` is a component of `k`: state all of them, as in `k=V1,V2`"
        );
        assert_eq!(
            sentence(params.set(&scene, "b_3", &[0.5])),
            "no param or grid is named `b_3`"
        );
        assert_eq!(
            sentence(params.set(&scene, "b", &[0.5])),
            "`b` has 2 components, but 1 was given"
        );
        assert_eq!(
            sentence(params.set(&scene, "m", &[7.0, 8.0])),
            "`m` is one number, but 2 were given"
        );
        assert_eq!(
            sentence(params.set(&scene, "alhpa", &[1.0])),
            "no param or grid is named `alhpa`; did you mean `alpha`?"
        );
        assert_eq!(
            sentence(params.set(&scene, "zebra", &[1.0])),
            "no param or grid is named `zebra`"
        );
        assert_eq!(params, before);
        params.set(&scene, "alpha", &[2.0]).unwrap();
        assert_eq!(params.uniforms()[0], 2.0);
    }
}
