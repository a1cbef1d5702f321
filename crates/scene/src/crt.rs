//! The CRT scene language: a script is run, and its results are converted to a scene.
//!
//! ```text
//! syntax::crt::tree::Script ──run.rs──▶ values (value.rs, operate.rs, call.rs, object.rs) ──▶ entities (entity.rs)
//!                                                                                              │
//!                                          Scene + diagnostics + values of variables ◀──build.rs
//! ```
//!
//! A script has left-handed coordinates: x right, y up, z into the screen. In the scene, y and z are exchanged;
//! [`Scene::stated`] exchanges them back. The scene has the param `t`; for another value of it the script is run again
//! ([`Scene::at`]).

mod assignment;
mod build;
mod call;
pub mod codes;
mod convert;
mod entity;
mod extent;
mod object;
mod operate;
mod random;
mod run;
mod value;
mod vector;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use syntax::crt::tree::{Expression, Script};
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

pub use assignment::Assignment;
pub use convert::{Converted, MAX_CONVERTED_LEAVES, NameTest};
pub use extent::EntityExtent;

use crate::rerun::Rerun;
use crate::scene::Scene;
use run::Interpreter;
use value::ScriptSettings;

/// The maximum total number of loop iterations, macro calls and objects in a run.
pub const MAX_WORK: u32 = 1_000_000;
/// The maximum total number of expressions, statements and elements of compared lists in a run: they take some seconds.
pub const MAX_STEPS: u64 = 64_000_000;
/// The number of bytes of a new string that count as one iteration.
pub(crate) const BYTES_OF_A_ROUND: usize = 256;
/// The maximum depth of nested macro calls.
pub const MAX_CALLS: u32 = 200;
/// The maximum nesting depth of expressions and statements, over all calls.
pub const MAX_NESTING: u32 = if cfg!(target_family = "wasm") {
    MAX_NESTING_IN_BROWSER
} else {
    10_000
};
/// The maximum nesting depth in a browser. The whole stack there has one megabyte, which suffices for one and a half times this
/// depth.
pub const MAX_NESTING_IN_BROWSER: u32 = 1_000;
/// The maximum number of characters of a string, of elements of a list, and of leaves of all entities.
pub const MAX_SIZE: u64 = 1_000_000;

/// For runs that are never cancelled.
static NEVER: AtomicBool = AtomicBool::new(false);

/// The stack size of a run, in bytes: the limits on nested expressions and calls require less.
const STACK: usize = 64 << 20;

/// The result of running a script.
#[derive(Debug, Default)]
pub struct ScriptRun {
    /// The scene.
    pub scene: Scene,
    /// The errors, warnings and hints of the run, sorted by position.
    pub diagnostics: Vec<Diagnostic>,
    /// The assignments of names, including parameters, that the run has reached, in the order of the text.
    pub assignments: Vec<Assignment>,
}

/// The value of an expression at the end of a script.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluated {
    /// Its type.
    pub kind: &'static str,
    /// The value in the syntax of a script.
    pub text: String,
    /// Its numbers: one for a number, three for a vector or a colour.
    pub numbers: Vec<f64>,
}

/// The lines of a text.
#[derive(Debug)]
struct ScriptLines {
    text: Arc<str>,
    starts: Vec<usize>,
}

impl ScriptLines {
    fn new(text: &str) -> Self {
        let ends = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            starts: std::iter::once(0).chain(ends).collect(),
            text: text.into(),
        }
    }

    /// Returns the `line:column` of an offset, both from 1.
    fn place(&self, offset: u32) -> String {
        let offset = (offset as usize).min(self.text.len());
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line.saturating_sub(1)];
        let before = self.text.get(start..offset).unwrap_or("");
        format!("{line}:{}", before.chars().count() + 1)
    }
}

/// Runs a script at t = 0. `text` is the script's text.
pub fn run(script: &Script, text: &str) -> ScriptRun {
    run_unless(script, text, &Arc::default(), &NEVER).unwrap_or_default()
}

/// Runs a script at t = 0; `None` if `given_up` is or becomes true. `of_reading` are the diagnostics of reading the script,
/// which its scenes have too.
pub fn run_unless(
    script: &Script,
    text: &str,
    of_reading: &Arc<[Diagnostic]>,
    given_up: &AtomicBool,
) -> Option<ScriptRun> {
    let lines = Arc::new(ScriptLines::new(text));
    let mut run = run_at(script, &lines, 0.0, given_up)?;
    run.scene.diagnostics = Some(all_diagnostics(of_reading, &run.diagnostics));
    let (script, of_reading) = (script.clone(), Arc::clone(of_reading));
    run.scene.rerun = Some(Rerun::new(vec![0.0], move |uniforms| {
        let t = uniforms.first().copied().unwrap_or(0.0);
        let mut run = run_at(&script, &lines, t, &NEVER).unwrap_or_default();
        run.scene.diagnostics = Some(all_diagnostics(&of_reading, &run.diagnostics));
        run.scene
    }));
    Some(run)
}

/// Returns the diagnostics of reading a script and of running it, sorted by position.
fn all_diagnostics(of_reading: &[Diagnostic], of_run: &[Diagnostic]) -> Arc<[Diagnostic]> {
    let mut all = [of_reading, of_run].concat();
    Diagnostic::sort(&mut all);
    all.into()
}

/// Evaluates an expression at the end of a script.
///
/// # Errors
/// The diagnostics of the expression.
pub fn evaluate(
    script: &Script,
    text: &str,
    t: f64,
    expression: &Expression,
) -> Result<Evaluated, Vec<Diagnostic>> {
    let lines = ScriptLines::new(text);
    on_stack(|| {
        let mut interpreter = Interpreter::new(&lines, t, &NEVER);
        interpreter.script(script);
        interpreter.value_at_end(expression)
    })
    .unwrap_or_else(|| Err(vec![not_run()]))
}

/// Converts a script at a value of `t` into a program of the Geotrace language; `None` if it has more than
/// [`MAX_CONVERTED_LEAVES`] leaves. Parts with errors are omitted. `is_free` returns true for names that a program may
/// declare.
pub fn convert(script: &Script, text: &str, t: f64, is_free: NameTest<'_>) -> Option<Converted> {
    let lines = ScriptLines::new(text);
    on_stack(|| {
        let mut interpreter = Interpreter::new(&lines, t, &NEVER);
        interpreter.script(script);
        let (settings, drawn) = interpreter.left();
        convert::program(&settings, &drawn, is_free)
    })?
}

/// Runs a script at a value of `t`; `None` if the run is cancelled.
fn run_at(
    script: &Script,
    lines: &ScriptLines,
    t: f64,
    given_up: &AtomicBool,
) -> Option<ScriptRun> {
    run_on_stack(|| {
        let mut interpreter = Interpreter::new(lines, t, given_up);
        interpreter.script(script);
        interpreter.finish()
    })
}

/// Returns the result of a run, or a diagnostic if it panics or cannot be started.
fn run_on_stack(run: impl FnOnce() -> Option<ScriptRun> + Send) -> Option<ScriptRun> {
    on_stack(run).unwrap_or_else(|| {
        Some(ScriptRun {
            scene: build::scene(&ScriptSettings::default(), Vec::new()),
            diagnostics: vec![not_run()],
            ..ScriptRun::default()
        })
    })
}

/// Returns the diagnostic of a script whose run panics or cannot be started.
fn not_run() -> Diagnostic {
    let message = "internal error: the script could not be run";
    Diagnostic::error(codes::INTERNAL_ERROR, Span::new(0, 0), message)
}

/// Runs a closure on a thread with its own stack; `None` if it panics or the thread cannot be created. A program in a browser
/// has no threads: its only stack is made large enough by the linker.
fn on_stack<R: Send>(work: impl FnOnce() -> R + Send) -> Option<R> {
    if cfg!(target_family = "wasm") {
        return Some(work());
    }
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK);
        thread.spawn_scoped(scope, work).ok()?.join().ok()
    })
}

#[cfg(test)]
mod tests {
    use super::{codes, run_on_stack};

    #[test]
    fn a_run_that_panics_is_an_error_of_the_script() {
        let run = run_on_stack(|| panic!("a fault")).expect("it is not given up");
        let [found] = &run.diagnostics[..] else {
            panic!("{:?}", run.diagnostics);
        };
        assert_eq!(found.code, codes::INTERNAL_ERROR);
        assert!(found.message.starts_with("internal error"));
        assert_eq!(run.scene.params.len(), 1, "`t` can be moved on");
    }
}
