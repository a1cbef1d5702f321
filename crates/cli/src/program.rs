//! The programs of commands. In: a path. Out: a scene, values of its params, and the numbers of arguments. Diagnostics
//! are reported on the way.

use std::path::Path;
use std::sync::Arc;

use geometry::Manifold;
use ide::language::{Compiled, Language, Scope};
use scene::{Evaluation, Object, ObjectId, Outcome, ParamValues, Scene, SetError, Shape, Value};
use syntax::diagnostic::Diagnostic;

use crate::argument::{Assignment, Format, PlaceArgument, Quantity};
use crate::failure::Failure;
use crate::output;
use crate::registry::Context;
use crate::report::{self, SeverityCounts, json};
use crate::source::SourceText;
use crate::style::TextColours;

/// A program without errors.
#[derive(Debug)]
pub(crate) struct LoadedProgram {
    /// The text.
    pub(crate) source: SourceText,
    format: Format,
    scene: Arc<Scene>,
    scope: Box<dyn Scope>,
}

/// Reads and compiles a program that may have errors. A file that is not UTF-8 compiles as an empty program with one
/// error.
///
/// # Errors
/// [`Failure::Unreadable`], and those of [`Context::language`].
pub(crate) fn compile(context: &Context, path: &Path) -> Result<(SourceText, Compiled), Failure> {
    let language = context.language(path)?;
    let source = SourceText::read(path)?;
    let text = match source.undecodable {
        Some(_) => "",
        None => &source.text,
    };
    let compiled = language.compile(text);
    let mut compiled = compiled.map_err(|error| Failure::Unreadable {
        file: source.name.clone(),
        reason: error.to_string(),
    })?;
    if path == Path::new("-") && context.language.is_none() && compiled.scene.is_none() {
        note_other_language(context, text, &compiled);
    }
    if let Some(diagnostic) = &source.undecodable {
        compiled.diagnostics = vec![diagnostic.clone()];
        compiled.scene = None;
    }
    Ok((source, compiled))
}

/// Prints a note if standard input, which is read in the standard language, has fewer errors in another one.
fn note_other_language(context: &Context, text: &str, compiled: &Compiled) {
    let errors = SeverityCounts::count(&compiled.diagnostics).errors;
    let mut others = context.registry.languages.all();
    let fits = |language: &&Arc<dyn Language>| {
        let read = language.compile(text);
        read.is_ok_and(|it| SeverityCounts::count(&it.diagnostics).errors < errors)
    };
    if let Some(other) = others.find(fits) {
        output::print_error(&format!(
            "note: this seems to be in another language: `--language {}`\n",
            other.name()
        ));
    }
}

impl LoadedProgram {
    /// Reads and compiles a program. Its warnings are printed on standard error; so are its errors, and in JSON also on
    /// standard output. If they depend on the params, [`Self::params`] or [`Self::run_for`] prints them.
    ///
    /// # Errors
    /// Those of [`compile`], [`Failure::ProgramHasErrors`], and [`Failure::Input`] if the language produces no scene
    /// from the text.
    pub(crate) fn load(context: &Context, path: &Path, format: Format) -> Result<Self, Failure> {
        let (source, compiled) = compile(context, path)?;
        let scene = compiled.scene.as_ref();
        if scene.is_none_or(|scene| scene.diagnostics.is_none()) {
            report_diagnostics(&source, &compiled.diagnostics, format)?;
        }
        let scene = compiled.scene.ok_or_else(|| Failure::Input {
            message: format!("`{}` has no scene", source.name),
            hint: None,
        })?;
        Ok(Self {
            source,
            format,
            scene,
            scope: compiled.scope,
        })
    }

    /// Returns the scene.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Evaluates an expression in the scope at the end of the program.
    ///
    /// # Errors
    /// The diagnostics of the expression.
    pub(crate) fn evaluate(
        &self,
        expression: &str,
        params: &ParamValues,
    ) -> Result<Evaluation, Vec<Diagnostic>> {
        self.scope.evaluate(expression, params)
    }

    /// Returns the first instance of a surface or a metric, ready for geodesics.
    ///
    /// # Errors
    /// [`Failure::Input`] if its derivatives are too large, [`Failure::Usage`] for other objects.
    pub(crate) fn manifold(&self, id: ObjectId, params: &ParamValues) -> Result<Manifold, Failure> {
        let manifold = Manifold::first(self.scene(), params, id);
        manifold.map_err(|error| Failure::no_manifold(&error))
    }

    /// Returns the name of an object.
    pub(crate) fn object_name(&self, id: ObjectId) -> Option<&str> {
        Some(&self.scene.get(id)?.name)
    }

    /// Sets the params that the `--set` arguments name: from then on the program has the scene of these values. Returns the
    /// values of all params.
    ///
    /// # Errors
    /// Those of [`Self::values`] and [`Self::run_for`].
    pub(crate) fn set_params(
        &mut self,
        assignments: &[Assignment],
    ) -> Result<ParamValues, Failure> {
        let params = self.values(assignments)?;
        self.run_for(&params)?;
        Ok(params)
    }

    /// Returns the params at their initial values, changed by the `--set` arguments.
    ///
    /// # Errors
    /// [`Failure::Usage`]: an unknown name, a wrong number of values, a value out of range.
    pub(crate) fn values(&self, assignments: &[Assignment]) -> Result<ParamValues, Failure> {
        let scene = self.scene();
        let mut params = ParamValues::initial(scene);
        for assignment in assignments {
            let option = format!("--set {}", assignment.name);
            let values: Result<Vec<f64>, Failure> = assignment
                .values
                .iter()
                .map(|value| self.number(&option, value, &params))
                .collect();
            params
                .set(scene, &assignment.name, &values?)
                .map_err(|error| refused(scene, &error))?;
        }
        Ok(params)
    }

    /// Gives the program the scene of these params. If the program is run for that, the diagnostics of the run are reported.
    ///
    /// # Errors
    /// [`Failure::ProgramHasErrors`] if the run has errors.
    pub(crate) fn run_for(&mut self, params: &ParamValues) -> Result<(), Failure> {
        self.scene = self.scene.at(params);
        let diagnostics = self.scene.diagnostics.as_deref().unwrap_or_default();
        report_diagnostics(&self.source, diagnostics, self.format)
    }

    /// Reports the diagnostics of a run that has errors.
    pub(crate) fn failed_run(&self, diagnostics: &[Diagnostic]) -> Failure {
        match report_diagnostics(&self.source, diagnostics, self.format) {
            Err(failure) => failure,
            Ok(()) => Failure::ProgramHasErrors,
        }
    }

    /// Evaluates the number given to an option. An expression may use all names of the program.
    ///
    /// # Errors
    /// [`Failure::Usage`] if the expression has an error or is not a number.
    pub(crate) fn number(
        &self,
        option: &str,
        quantity: &Quantity,
        params: &ParamValues,
    ) -> Result<f64, Failure> {
        let text = match quantity {
            Quantity::Number(value) => return Ok(*value),
            Quantity::Expression(text) => text,
        };
        let wrong = |reason: &str, hint: Option<String>| Failure::Usage {
            message: format!("{option}: `{text}`: {reason}"),
            hint,
        };
        match self.evaluate(text, params) {
            Ok(evaluation) => match evaluation.outcome {
                Outcome::Single(Value::Number(Some(value))) => Ok(value),
                Outcome::Single(Value::Number(None)) => {
                    Err(wrong("this number is undefined", None))
                }
                Outcome::Single(Value::Text(_)) => Err(wrong("this is not a number", None)),
                Outcome::Single(Value::Vector(_)) => {
                    Err(wrong("this is a vector, but a number is required", None))
                }
                Outcome::Instances(_) => Err(wrong(
                    "this depends on a grid, but one number is required",
                    Some("`--set` gives a grid one value".into()),
                )),
            },
            Err(diagnostics) => Err(match diagnostics.into_iter().next() {
                Some(first) => wrong(&first.message, first.hint),
                None => wrong("this is not a number", None),
            }),
        }
    }

    /// Evaluates the numbers of a point or a direction, each like [`Self::number`].
    pub(crate) fn numbers<const N: usize>(
        &self,
        option: &str,
        quantities: &[Quantity; N],
        params: &ParamValues,
    ) -> Result<[f64; N], Failure> {
        let mut numbers = [0.0; N];
        for (number, quantity) in numbers.iter_mut().zip(quantities) {
            *number = self.number(option, quantity, params)?;
        }
        Ok(numbers)
    }

    /// Evaluates the `N` numbers of a point or a direction on an object, each like [`Self::number`].
    ///
    /// # Errors
    /// [`Failure::Usage`] for a wrong count of numbers, or those of [`Self::number`].
    pub(crate) fn place<const N: usize>(
        &self,
        option: &str,
        place: &PlaceArgument,
        params: &ParamValues,
        object: &Object,
    ) -> Result<[f64; N], Failure> {
        let numbers = <&[Quantity; N]>::try_from(place.0.as_slice());
        let Ok(numbers) = numbers else {
            let (name, kind) = (&object.name, object.shape.kind());
            let wanted = match N {
                3 => "three numbers x,y,z",
                _ => "two numbers u,v",
            };
            return Err(Failure::usage(format!(
                "{option}: `{name}` is a {kind} and requires {wanted}, found {}",
                place.0.len()
            )));
        };
        self.numbers(option, numbers, params)
    }

    /// Finds a surface, a metric or a solid by its name; without a name the first surface or metric, or else the first
    /// solid.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is none.
    pub(crate) fn ground(&self, name: Option<&str>) -> Result<(ObjectId, &Object), Failure> {
        let scene = self.scene();
        let is_named = |object: &Object| name.is_none_or(|name| object.name == name);
        let mut solids = scene
            .numbered()
            .filter(|(_, object)| object.shape.solid().is_some() && is_named(object));
        let has_chart = |(_, object): (ObjectId, &Object)| {
            object.shape.manifold().is_some() && is_named(object)
        };
        if !scene.numbered().any(has_chart)
            && let Some(solid) = solids.next()
        {
            return Ok(solid);
        }
        self.first_with_inside(name, "surface, metric or solid")
    }

    /// Finds a surface, a metric or a solid that an image is for, by its name.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is none.
    pub(crate) fn textured(&self, name: &str) -> Result<(ObjectId, &Object), Failure> {
        self.first_with_inside(Some(name), "surface, metric, solid or background")
    }

    fn first_with_inside(
        &self,
        name: Option<&str>,
        wanted: &str,
    ) -> Result<(ObjectId, &Object), Failure> {
        if let Some(name) = name {
            self.refuse_part(name)?;
        }
        self.first_of(name, wanted, &|shape: &Shape| shape.has_inside())
    }

    /// Refuses the name of a solid that is only a part of others.
    fn refuse_part(&self, name: &str) -> Result<(), Failure> {
        if !self.scene().parts.iter().any(|part| part.name == name) {
            return Ok(());
        }
        Err(Failure::Usage {
            message: format!("`{name}` is a part of another solid, and is not drawn itself"),
            hint: Some(format!("`solid copy = {name};` draws it")),
        })
    }

    /// Finds the objects with a name: several objects of a script may share one.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is no such object.
    pub(crate) fn objects(&self, name: &str) -> Result<Vec<ObjectId>, Failure> {
        let found: Vec<ObjectId> = self.scene.objects_named(name).map(|(id, _)| id).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        self.refuse_part(name)?;
        let names = quoted(self.scene.objects.iter());
        Err(Failure::Usage {
            message: format!("`{}` declares no object `{name}`", self.source.name),
            hint: Some(match &names[..] {
                [] => "it declares no object".into(),
                [only] => format!("its only object is {only}"),
                several => format!("its objects are {}", several.join(", ")),
            }),
        })
    }

    /// Finds a surface or metric by its name; without a name, the first one.
    ///
    /// # Errors
    /// [`Failure::Usage`] if there is no such surface.
    pub(crate) fn surface(&self, name: Option<&str>) -> Result<(ObjectId, &Object), Failure> {
        let is_one = |shape: &Shape| shape.manifold().is_some();
        self.first_of(name, "surface or metric", &is_one)
    }

    /// Finds an object by its name, if its shape is `wanted`; without a name, the first such object.
    fn first_of(
        &self,
        name: Option<&str>,
        wanted: &str,
        is_one: &dyn Fn(&Shape) -> bool,
    ) -> Result<(ObjectId, &Object), Failure> {
        let scene = self.scene();
        let known = || scene.numbered().filter(|(_, object)| is_one(&object.shape));
        let found = match name {
            Some(name) => known().find(|(_, object)| object.name == name),
            None => known().next(),
        };
        found.ok_or_else(|| {
            let file = &self.source.name;
            let message = match name.and_then(|name| scene.object(name)) {
                Some((_, object)) => {
                    let (name, kind) = (&object.name, object.shape.kind());
                    format!("`{name}` of `{file}` is a {kind}, not a {wanted}")
                }
                None => match name {
                    Some(name) => format!("`{file}` declares no {wanted} `{name}`"),
                    None => format!("`{file}` declares no {wanted}"),
                },
            };
            let names = quoted(known().map(|(_, object)| object));
            let mut kinds: Vec<&str> = Vec::new();
            for (_, object) in known() {
                if !kinds.contains(&object.shape.kind()) {
                    kinds.push(object.shape.kind());
                }
            }
            let has_solids = scene.objects.iter().any(|it| it.shape.solid().is_some());
            let hint = match &names[..] {
                // Those that look for solids too find one.
                [] if has_solids => "figures and measurements require a surface with parameters; `geotrace trace` and `--view geodesic` work on solids".into(),
                [] => "a surface is declared like this: surface s(u, v) = (u, v, u v), u : [-1, 1], v : [-1, 1];".into(),
                [only] => format!("its {} is {only}", kinds.concat()),
                several => {
                    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind}s")).collect();
                    format!("its {} are {}", joined(&kinds), several.join(", "))
                }
            };
            Failure::Usage {
                message,
                hint: Some(hint),
            }
        })
    }
}

/// Returns the names of objects in backquotes, each once.
pub(crate) fn quoted<'a>(objects: impl Iterator<Item = &'a Object>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for object in objects {
        let name = format!("`{}`", object.name);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Joins words with commas, and an `and` before the last.
fn joined(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

fn refused(scene: &Scene, error: &SetError) -> Failure {
    let hint = match error {
        SetError::Unknown {
            suggestion: None, ..
        } => {
            let params = scene.params.iter().map(|param| &param.name);
            let grids = scene.grids.iter().map(|grid| &grid.name);
            let names: Vec<String> = params
                .chain(grids)
                .map(|name| format!("`{name}`"))
                .collect();
            Some(if names.is_empty() {
                "the program declares no param and no grid".into()
            } else {
                format!("`--set` accepts {}", names.join(", "))
            })
        }
        _ => None,
    };
    Failure::Usage {
        message: format!("--set: {error}"),
        hint,
    }
}

/// Prints diagnostics: as text on standard error, and errors in JSON also on standard output.
///
/// # Errors
/// [`Failure::ProgramHasErrors`] if there is an error among them.
pub(crate) fn report_diagnostics(
    source: &SourceText,
    diagnostics: &[Diagnostic],
    format: Format,
) -> Result<(), Failure> {
    if diagnostics.is_empty() {
        return Ok(());
    }
    let counts = SeverityCounts::count(diagnostics);
    let text = report::text(source, diagnostics, TextColours::for_stderr());
    output::print_error(&format!("{text}{}: {}\n", source.name, counts.text()));
    if counts.errors == 0 {
        return Ok(());
    }
    if format == Format::Json {
        let mut document = json::DiagnosticsJson::default();
        document.add(source, diagnostics);
        output::print_json(&document)?;
    }
    Err(Failure::ProgramHasErrors)
}
