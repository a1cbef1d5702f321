//! Exponential maps, kept: a surface by its content, and the ends of a camera's geodesics by the camera's pose.

use std::sync::Arc;

use scene::ObjectId;

use super::GeodesicOptions;
use crate::cache::Cache;
use crate::content::{Content, Structure, first_instance};
use crate::error::RenderError;
use crate::geodesic_view::{PlacedCamera, RayEnds};
use crate::request::PictureRequest;
use crate::view::SharedState;
use geometry::{Manifold, ManifoldError};

/// Surfaces that are kept though no camera is on them.
const SURFACES: usize = 4;
/// Maps that are kept though other pictures have been drawn since: those of other panes.
const MAPS: usize = 6;

/// A camera with the ends of its geodesics.
#[derive(Debug)]
pub(super) struct CachedMap {
    pub(super) camera: PlacedCamera,
    pub(super) ends: Arc<RayEnds>,
}

/// The inputs that a map depends on.
#[derive(Clone, Debug, PartialEq)]
struct MapKey {
    surface: Content,
    /// But for the ring, which is no part of the map.
    options: GeodesicOptions,
    size: [u32; 2],
    /// A view at rest does not accept a coarse map, and a moving view does not wait for a fine one.
    moving: bool,
}

/// Surfaces and maps.
#[derive(Debug)]
pub(super) struct MapCache {
    surfaces: Cache<Content, Arc<Manifold>>,
    /// The one that was used last is the last one.
    maps: Vec<(MapKey, Arc<CachedMap>)>,
}

impl Default for MapCache {
    fn default() -> Self {
        Self {
            surfaces: Cache::new(SURFACES),
            maps: Vec::new(),
        }
    }
}

impl MapCache {
    /// The map of a request's camera, followed where it is not known. `progress` receives the share that is done.
    ///
    /// # Errors
    /// Those of [`PlacedCamera::new`].
    pub(super) fn get(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &GeodesicOptions,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Arc<CachedMap>, RenderError> {
        let structures = shared.structures.get(request.scene.arc());
        let id = options.camera.surface;
        let surface = first_instance(&request.scene, &request.params, &structures, id)
            .ok_or(ManifoldError::NoSurface { name: None })?;
        let key = MapKey {
            surface,
            options: GeodesicOptions {
                mark_centre: true,
                ..options.clone()
            },
            size: request.size,
            moving: request.moving,
        };
        if let Some(at) = self.maps.iter().position(|(known, _)| *known == key) {
            let known = self.maps.remove(at);
            let map = known.1.clone();
            self.maps.push(known);
            // Its surface is in use too.
            self.surfaces.get(&key.surface);
            return Ok(map);
        }
        let camera = self.place(request, options, &structures)?;
        let ends = Arc::new(camera.ends(progress));
        shared.followed += 1;
        let map = Arc::new(CachedMap { camera, ends });
        if self.maps.len() >= MAPS {
            self.maps.remove(0);
        }
        self.maps.push((key, map.clone()));
        Ok(map)
    }

    /// The camera of a request, on a surface that is kept.
    ///
    /// # Errors
    /// Those of [`PlacedCamera::new`].
    pub(super) fn place(
        &mut self,
        request: &PictureRequest,
        options: &GeodesicOptions,
        structures: &[Structure],
    ) -> Result<PlacedCamera, RenderError> {
        let (scene, params) = (&request.scene, &request.params);
        let surface = |id: ObjectId, uniforms: &[f64]| {
            let key = structures[id.0 as usize].instance(uniforms);
            if let Some(surface) = self.surfaces.get(&key) {
                return Ok(surface);
            }
            let surface = Arc::new(Manifold::new(scene, id, uniforms)?);
            self.surfaces.put(key, surface.clone(), 1);
            Ok(surface)
        };
        let camera = PlacedCamera::on(scene, params, &options.camera, request.size, surface)?;
        let camera = camera.with_method(options.method);
        Ok(if request.moving {
            camera.moving()
        } else {
            camera
        })
    }

    /// Ends a picture.
    pub(super) fn next(&mut self) {
        self.surfaces.next();
    }
}
