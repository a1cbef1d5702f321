//! Geodesic views, kept: the ground that a being lives in by its content, and what a camera sees by where it stands.

use std::sync::Arc;

use geometry::{Manifold, ManifoldError};
use scene::ParamValues;
use scene::{Object, ObjectId, Scene};

use super::content::{Content, Structure, object};
use super::kept::Kept;
use crate::geodesic_view::{Inside, Seen, Tally};
use crate::overlay::Standpoint;
use crate::request::{RenderError, Request, View};

/// Grounds that are kept though no view stands on them.
const GROUNDS: usize = 4;
/// Views that are kept though other pictures have been drawn since: those of other panes.
const LOOKS: usize = 6;

/// A camera with what it sees.
#[derive(Debug)]
pub(crate) struct Look {
    pub(crate) inside: Inside,
    pub(crate) seen: Seen,
    /// What its pictures are made of is added to it.
    pub(crate) tally: Arc<Tally>,
}

/// What a look depends on, beside its ground.
#[derive(Clone, Debug, PartialEq)]
struct Standing {
    ground: Content,
    view: View,
    size: [u32; 2],
    /// A coarse look is none for a view at rest, nor a fine one what a moving view waits for.
    moving: bool,
}

/// Grounds and looks.
#[derive(Debug)]
pub(crate) struct Looks {
    grounds: Kept<Content, Arc<Manifold>>,
    /// The one that was used last stands last.
    looks: Vec<(Standing, Arc<Look>)>,
    /// How many views have had their geodesics followed so far.
    pub(crate) followed: u64,
    /// What their pictures were made of.
    pub(crate) tally: Arc<Tally>,
}

impl Default for Looks {
    fn default() -> Self {
        Self {
            grounds: Kept::new(GROUNDS),
            looks: Vec::new(),
            followed: 0,
            tally: Arc::default(),
        }
    }
}

impl Looks {
    /// What the camera of a geodesic view sees.
    ///
    /// # Errors
    /// Those of [`Inside::new`].
    pub(crate) fn look(
        &mut self,
        scene: &Scene,
        settings: &ParamValues,
        structures: &[Structure],
        request: &Request,
    ) -> Result<Arc<Look>, RenderError> {
        let View::Geodesic { surface, .. } = request.view else {
            return Err(ManifoldError::NoSurface { name: None }.into());
        };
        let on = object(scene, surface).ok_or(ManifoldError::NoSurface { name: None })?;
        let standing = Standing {
            ground: ground_content(scene, settings, structures, surface, on),
            view: request.view.clone(),
            size: request.size,
            moving: request.moving,
        };
        if let Some(at) = self.looks.iter().position(|(key, _)| *key == standing) {
            let known = self.looks.remove(at);
            let look = known.1.clone();
            self.looks.push(known);
            // Also its ground is in use.
            self.grounds.get(&standing.ground);
            return Ok(look);
        }
        let inside = self.stand(scene, settings, structures, request)?;
        let seen = inside.look(&|_| {});
        self.followed += 1;
        let tally = Arc::clone(&self.tally);
        let look = Arc::new(Look {
            inside,
            seen,
            tally,
        });
        if self.looks.len() >= LOOKS {
            self.looks.remove(0);
        }
        self.looks.push((standing, look.clone()));
        Ok(look)
    }

    /// The camera of a geodesic view, on a ground that is kept.
    ///
    /// # Errors
    /// Those of [`Inside::new`].
    fn stand(
        &mut self,
        scene: &Scene,
        settings: &ParamValues,
        structures: &[Structure],
        request: &Request,
    ) -> Result<Inside, RenderError> {
        Inside::on(scene, settings, request, |id, uniforms| {
            let key = structures[id.0 as usize].instance(uniforms);
            if let Some(ground) = self.grounds.get(&key) {
                return Ok(ground);
            }
            let ground = Arc::new(Manifold::new(scene, id, uniforms)?);
            self.grounds.put(key, ground.clone(), 1);
            Ok(ground)
        })
    }

    /// What the 3D view's picture of a geodesic camera depends on.
    pub(crate) fn standpoint_content(
        scene: &Scene,
        settings: &ParamValues,
        structures: &[Structure],
        standpoint: &Standpoint,
    ) -> Option<Content> {
        let on = object(scene, standpoint.surface)?;
        Some(ground_content(
            scene,
            settings,
            structures,
            standpoint.surface,
            on,
        ))
    }

    /// Ends a picture.
    pub(crate) fn next(&mut self) {
        self.grounds.next();
    }
}

fn ground_content(
    scene: &Scene,
    settings: &ParamValues,
    structures: &[Structure],
    surface: ObjectId,
    on: &Object,
) -> Content {
    structures[surface.0 as usize].instance(&settings.first_instance(scene, on))
}
