//! Scenes that are made anew for other values of their params.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Makes the scene for some values of its params, one number per uniform; `None` where the text has an error there.
type Make<S> = dyn Fn(&[f64]) -> Option<S> + Send + Sync;

/// Values with the scene that they make.
type Made<S> = (Vec<f64>, Option<Arc<S>>);

/// Makes a scene anew where its params change more than numbers. All scenes that it makes share it, and the last one is
/// kept.
pub struct Rerun<S> {
    maker: Arc<Maker<S>>,
    /// The values that its scene is for.
    values: Vec<f64>,
}

struct Maker<S> {
    make: Box<Make<S>>,
    /// The last values, with their scene.
    last: Mutex<Option<Made<S>>>,
}

impl<S> Rerun<S> {
    /// Of a scene that was made for these values, which `make` receives too.
    pub(crate) fn new(
        values: Vec<f64>,
        make: impl Fn(&[f64]) -> Option<S> + Send + Sync + 'static,
    ) -> Self {
        let maker = Maker {
            make: Box::new(make),
            last: Mutex::default(),
        };
        Self {
            maker: Arc::new(maker),
            values,
        }
    }

    /// Returns the scene for other values; `None` for those of its own scene, and where the text has an error. `attach` gives a
    /// new scene its own.
    pub(crate) fn at(&self, uniforms: &[f64], attach: impl FnOnce(&mut S, Self)) -> Option<Arc<S>> {
        if uniforms == self.values {
            return None;
        }
        let last = self.maker.last.lock();
        let mut last = last.unwrap_or_else(PoisonError::into_inner);
        if let Some((known, scene)) = &*last
            && known == uniforms
        {
            return scene.clone();
        }
        let scene = (self.maker.make)(uniforms).map(|mut scene| {
            let rerun = Self {
                maker: self.maker.clone(),
                values: uniforms.to_vec(),
            };
            attach(&mut scene, rerun);
            Arc::new(scene)
        });
        *last = Some((uniforms.to_vec(), scene.clone()));
        scene
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
