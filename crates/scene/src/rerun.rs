//! Scenes that are recomputed for other values of their params.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use syntax::diagnostic::{Diagnostic, Severity};

/// Computes the scene for some values of its params, one number per uniform.
type Make<S> = dyn Fn(&[f64]) -> S + Send + Sync;

/// Values with their scene.
type Made<S> = (Vec<f64>, Arc<S>);

/// Recomputes a scene if its params change more than numbers. It is shared by all scenes that it creates, and stores
/// the last one.
pub struct Rerun<S> {
    maker: Arc<Maker<S>>,
    /// The values of its scene.
    values: Vec<f64>,
}

/// The diagnostics of a run with errors.
#[derive(Clone, Debug, PartialEq)]
pub struct FailedRun(pub Arc<[Diagnostic]>);

impl FailedRun {
    /// Returns an error if there is one among these diagnostics.
    pub(crate) fn check(diagnostics: &Arc<[Diagnostic]>) -> Result<(), Self> {
        match first_error(diagnostics) {
            Some(_) => Err(Self(Arc::clone(diagnostics))),
            None => Ok(()),
        }
    }
}

impl fmt::Display for FailedRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = first_error(&self.0).map(|it| it.message.as_str());
        f.write_str(first.unwrap_or_default())
    }
}

impl std::error::Error for FailedRun {}

fn first_error(diagnostics: &[Diagnostic]) -> Option<&Diagnostic> {
    let mut all = diagnostics.iter();
    all.find(|it| it.severity == Severity::Error)
}

struct Maker<S> {
    make: Box<Make<S>>,
    /// The last values, with their scene.
    last: Mutex<Option<Made<S>>>,
}

impl<S> Rerun<S> {
    /// Creates the rerun of a scene for these values, which `make` receives too.
    pub fn new(values: Vec<f64>, make: impl Fn(&[f64]) -> S + Send + Sync + 'static) -> Self {
        let maker = Maker {
            make: Box::new(make),
            last: Mutex::default(),
        };
        Self {
            maker: Arc::new(maker),
            values,
        }
    }

    /// Returns the values of its scene.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the scene for other values; `None` for the values of its own scene. `attach` gives a new scene its own
    /// rerun.
    pub(crate) fn at(&self, uniforms: &[f64], attach: impl FnOnce(&mut S, Self)) -> Option<Arc<S>> {
        if uniforms == self.values {
            return None;
        }
        let last = self.maker.last.lock();
        let mut last = last.unwrap_or_else(PoisonError::into_inner);
        if let Some((known, scene)) = &*last
            && known == uniforms
        {
            return Some(scene.clone());
        }
        let mut scene = (self.maker.make)(uniforms);
        let rerun = Self {
            maker: self.maker.clone(),
            values: uniforms.to_vec(),
        };
        attach(&mut scene, rerun);
        let scene = Arc::new(scene);
        *last = Some((uniforms.to_vec(), scene.clone()));
        Some(scene)
    }
}

impl<S> Clone for Rerun<S> {
    fn clone(&self) -> Self {
        Self {
            maker: self.maker.clone(),
            values: self.values.clone(),
        }
    }
}

impl<S> fmt::Debug for Rerun<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rerun").finish_non_exhaustive()
    }
}
