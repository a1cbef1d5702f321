//! Solids: from recorded declarations to sets of points.

use std::sync::Arc;

use expr::Input;
use expr::value::Value;
use syntax::diagnostic::{Diagnostic, Related};
use syntax::geotrace::actions::Declaration;
use syntax::geotrace::declarations::COORDINATES;

use crate::geotrace::code::Expression;
use crate::geotrace::declarations::{Declarations, Owner, Understood, kind_of};
use crate::geotrace::declare::list_span;
use crate::geotrace::dependencies::Dependencies;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::interval::{DeclaredInterval, Purpose};
use crate::geotrace::sets::{ClosedGrid, DeclaredSolid, PointSet, too_many_leaves};
use crate::geotrace::symbol::Meaning;
use crate::limits::MAX_LEAVES;
use crate::scene::Shape;
use crate::solid::{AffineNodes, BoundGrid, Cut, EVERYWHERE, Solid, SolidLeaf, SolidStep};

/// The intervals of x, y and z.
type Cuts = [Option<Cut>; 3];

impl Declarations {
    /// `solid b(x,y,z) = f;` or `solid s = a & b;`
    pub(crate) fn solid(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Understood> {
        let is_set = declaration.parameters.is_empty();
        let cuts = self.cuts(declaration, intervals);
        let [body] = self.expressions(intervals)?;
        let variables = match is_set {
            true => COORDINATES.len(),
            false => declaration.parameters.len(),
        };
        let (mut set, own) = match is_set {
            true => self.lowerer.lower_set(body, &mut self.found),
            false => self.field(declaration, body, variables),
        };
        let before = self.found.len();
        let (attributes, stated) = self.stated(declaration.keyword, variables);
        let is_sound = self.found.len() == before;
        let mut dependencies = self.lowerer.dependencies.union(own, stated);
        for part in set.iter().flat_map(|set| &set.named) {
            if let Meaning::Solid(part) = self.lowerer.symbols.meaning(*part) {
                let sets = &mut self.lowerer.dependencies;
                dependencies = sets.union(dependencies, part.dependencies);
            }
        }
        if let Some(first) = &set
            && self.closes_inside(first, dependencies)
        {
            // Now that the set is known to read a grid at which a part closes, the part gets uniforms of its own.
            self.lowerer.renames_parts = true;
            set = self.lowerer.lower_set(body, &mut self.found).0;
            self.lowerer.renames_parts = false;
        }
        let (mut set, uncut) = self.cut(declaration, set?, cuts?)?;
        if !attributes.is_empty() {
            set.state(&attributes);
        }
        let warning = self.filled_holes(declaration, &set.solid, dependencies);
        self.found.extend(warning);
        let uncut = uncut.map(|solid| self.closed_at(solid, dependencies));
        let named = std::mem::take(&mut set.named);
        set.solid = self.closed_at(set.solid, dependencies);
        let instances = self.close(&mut set, dependencies);
        set.size = set.size.saturating_mul(instances);
        self.check_leaves(declaration, set.size)?;
        let (value_params, params) = (self.without_grids(own), self.without_grids(dependencies));
        let size = set.size;
        let names = declaration.parameters.iter();
        let stated: Option<Arc<[Box<str>]>> =
            (!is_set).then(|| names.map(|it| it.name.as_str().into()).collect());
        // Writing would copy the leaves of a solid that is shared.
        if set.solid.parameters != stated {
            Arc::make_mut(&mut set.solid).parameters.clone_from(&stated);
        }
        let parameters = stated.unwrap_or_else(|| COORDINATES.map(Box::from).into());
        let solid = Arc::clone(&set.solid);
        let meaning = Meaning::Solid(Arc::new(DeclaredSolid {
            set,
            uncut,
            parameters,
            value_dependencies: value_params,
            dependencies: params,
        }));
        if !is_sound {
            return None;
        }
        // The objects that a checker draws are not used.
        let shown = match self.is_checker {
            true => Arc::default(),
            false => Arc::clone(&solid),
        };
        let drawn = self.object(declaration, Shape::Solid(shown), params, attributes);
        let drawn = drawn.map(|mut drawn| {
            drawn.leaves = size;
            drawn.named = named;
            drawn.closed = dependencies;
            drawn
        });
        Some(Understood::from(meaning).drawn(drawn))
    }

    /// Applies the intervals of x, y and z: to the leaf of a function, or to a set as a whole. Returns also the uncut solid of
    /// a set that is cut.
    fn cut(
        &mut self,
        declaration: &Declaration<'_>,
        mut set: PointSet,
        cuts: Cuts,
    ) -> Option<(PointSet, Option<Arc<Solid>>)> {
        if !declaration.parameters.is_empty() {
            for leaf in &mut Arc::make_mut(&mut set.solid).leaves {
                leaf.cuts = cuts;
            }
            return Some((set, None));
        }
        if cuts.iter().all(Option::is_none) {
            return Some((set, None));
        }
        let graph = &mut self.lowerer.graph;
        let leaf = SolidLeaf {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            field: graph.constant(EVERYWHERE),
            cuts,
            map: AffineNodes::identity(graph),
            attributes: Arc::default(),
        };
        let uncut = Arc::clone(&set.solid);
        let cut = set.joined(PointSet::leaf(leaf), SolidStep::Intersection);
        Some((self.sound(cut, declaration.name_span)?, Some(uncut)))
    }

    /// Reports a solid with this number of leaves as an error and returns `None` if it has too many of them, by itself or with
    /// all solids before it.
    fn check_leaves(&mut self, declaration: &Declaration<'_>, size: u64) -> Option<()> {
        let error = if size > MAX_LEAVES {
            too_many_leaves(size)
        } else if !self.is_checker && self.leaves + size > MAX_LEAVES {
            too_many_leaves_in_all(size, self.leaves)
        } else {
            return Some(());
        };
        self.found.push(error.at(declaration.name_span));
        None
    }

    /// Returns a solid given by a function of two or three numbers.
    fn field(
        &mut self,
        declaration: &Declaration<'_>,
        body: Expression,
        variables: usize,
    ) -> (Option<PointSet>, Dependencies) {
        let lowered = self.over_variables(body, variables);
        let dependencies = lowered.dependencies;
        if !matches!(variables, 2 | 3) {
            let message = format!(
                "a solid has the parameters x, y and z, or two for a prism, but `{}` has {variables}",
                declaration.name
            );
            let error = SemanticError::new(error::PARAMETER_COUNT, message);
            let place = list_span(declaration.parameters, declaration.name_span);
            self.found.push(error.at(place));
            return (None, dependencies);
        }
        let field = match lowered.value {
            None => return (None, dependencies),
            Some(Value::Number(field)) => field,
            Some(vector) => {
                let message = format!(
                    "a solid is where a number is not positive, but this is {}",
                    kind_of(&vector)
                );
                let error = SemanticError::new(error::NOT_A_SOLID, message);
                let span = self.lowerer.code.span(body);
                self.found.push(error.at(span));
                return (None, dependencies);
            }
        };
        let leaf = SolidLeaf {
            name: declaration.name.to_owned(),
            name_span: declaration.name_span,
            field,
            cuts: [None; 3],
            map: AffineNodes::identity(&mut self.lowerer.graph),
            attributes: Arc::default(),
        };
        (Some(PointSet::leaf(leaf)), dependencies)
    }

    /// Returns the intervals of x, y and z; `None` after an error.
    fn cuts(
        &mut self,
        declaration: &Declaration<'_>,
        intervals: &[DeclaredInterval],
    ) -> Option<Cuts> {
        let mut cuts: [Option<(Cut, &DeclaredInterval)>; 3] = [None; 3];
        let mut is_sound = true;
        for interval in intervals {
            let lowerer = &mut self.lowerer;
            let bounds = interval.bounds(lowerer, Purpose::Cut, &mut self.found);
            // An unknown tag has been reported.
            let place = interval.read.tag.and_then(|(position, span)| {
                let position = position? as usize;
                Some((position, span, cuts.get_mut(position)?))
            });
            let (Some(bounds), Some((position, span, place))) = (bounds, place) else {
                is_sound = false;
                continue;
            };
            if let Some((_, first)) = place {
                let name = match declaration.parameters.get(position) {
                    Some(parameter) => &parameter.name,
                    None => COORDINATES[position],
                };
                let message = format!("the parameter `{name}` has two intervals");
                let mut error = SemanticError::new(error::DUPLICATE_TAG, message);
                error.trail.extend(first.read.tag.map(|(_, span)| Related {
                    span,
                    message: "its first interval is here".to_owned(),
                }));
                self.found.push(error.at(span));
                is_sound = false;
                continue;
            }
            let cut = Cut {
                range: bounds.range,
                cells: bounds.count,
            };
            *place = Some((cut, interval));
        }
        is_sound.then(|| cuts.map(|cut| cut.map(|(cut, _)| cut)))
    }

    /// Returns a set as the union of its instances.
    fn closed_at(&self, mut solid: Arc<Solid>, dependencies: Dependencies) -> Arc<Solid> {
        let (_, grids) = self.sources_of(dependencies);
        if !grids.is_empty() {
            let bound = grids.into_iter().filter_map(|grid| {
                let first_uniform = self.scene.grids.get(grid.0 as usize)?.first_uniform;
                Some(BoundGrid {
                    grid,
                    first_uniform,
                })
            });
            let closed = SolidStep::Instances(bound.collect());
            Arc::make_mut(&mut solid).steps.push(closed);
        }
        solid
    }

    /// Returns a warning about a set in which a grid affects only subtracted parts: each of its instances fills the holes of
    /// the others.
    fn filled_holes(
        &self,
        declaration: &Declaration<'_>,
        solid: &Solid,
        dependencies: Dependencies,
    ) -> Option<Diagnostic> {
        let taken_away = solid.taken_away();
        if !taken_away.contains(&true) {
            return None;
        }
        let (_, grids) = self.sources_of(dependencies);
        let grids = grids.into_iter();
        let mut grids = grids.filter_map(|id| self.scene.grids.get(id.0 as usize));
        let graph = &self.lowerer.graph;
        let grid = grids.find(|grid| {
            let count = grid.axes.len() as u32;
            let own = grid.first_uniform..grid.first_uniform + count;
            let is_own = |input: &Input| matches!(input, Input::Uniform(k) if own.contains(k));
            let reads = |leaf: &SolidLeaf| graph.inputs(&leaf.point_nodes()).iter().any(is_own);
            let leaves = taken_away.iter().zip(&solid.leaves);
            let mut moved = leaves.filter(|(_, leaf)| reads(leaf)).peekable();
            moved.peek().is_some() && moved.all(|(taken, _)| *taken)
        })?;
        let (name, grid) = (&declaration.name, &grid.name);
        let message = format!(
            "`{name}` is the union of its instances for the values of `{grid}`, and each fills the holes of the others"
        );
        let hint = format!(
            "declare the subtracted part as a solid of its own, so that it is the union for all values of `{grid}`, and subtract that solid"
        );
        let warning = Diagnostic::warning(error::FILLED_HOLES, declaration.name_span, message);
        Some(warning.with_hint(hint))
    }

    /// Returns true if a part of a set closes at a grid that the set itself reads, in the grid's own uniforms.
    fn closes_inside(&self, set: &PointSet, dependencies: Dependencies) -> bool {
        let (_, grids) = self.sources_of(dependencies);
        let mut closed = set.closed.iter().filter(|closed| closed.level == 0);
        let firsts: Vec<u32> = grids
            .iter()
            .filter_map(|id| Some(self.scene.grids.get(id.0 as usize)?.first_uniform))
            .collect();
        closed.any(|closed| firsts.contains(&closed.own))
    }

    /// Records the grids at which a set closes; returns the number of its instances.
    fn close(&self, set: &mut PointSet, dependencies: Dependencies) -> u64 {
        let (_, grids) = self.sources_of(dependencies);
        let mut instances: u64 = 1;
        for id in grids {
            let Some(grid) = self.scene.grids.get(id.0 as usize) else {
                continue;
            };
            for axis in &grid.axes {
                instances = instances.saturating_mul(u64::from(axis.count));
            }
            let closed = ClosedGrid {
                bound: BoundGrid {
                    grid: id,
                    first_uniform: grid.first_uniform,
                },
                own: grid.first_uniform,
                level: 0,
                axes: grid.axes.clone(),
            };
            if !set.closed.contains(&closed) {
                set.closed.push(closed);
            }
        }
        instances
    }

    /// Returns the params in a set of dependencies.
    fn without_grids(&mut self, dependencies: Dependencies) -> Dependencies {
        let sources = &self.sources;
        let is_param = |index: usize| !matches!(sources.get(index), Some(Owner::Grid(_)));
        let sets = &mut self.lowerer.dependencies;
        sets.retained(dependencies, |source| is_param(source.0 as usize))
    }
}

fn too_many_leaves_in_all(count: u64, others: u64) -> SemanticError {
    let message = format!(
        "this solid has {count} leaves, instances included, on top of the {others} of the solids above; the limit is {MAX_LEAVES} in all"
    );
    SemanticError::new(error::TOO_MANY_LEAVES, message)
}
