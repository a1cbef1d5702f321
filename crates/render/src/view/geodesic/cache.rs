//! A cache of exponential maps: surfaces by content, and the ends of a camera's geodesics by the camera's pose.

use std::sync::Arc;

use scene::{ObjectId, Range, Sampling};

use super::GeodesicOptions;
use crate::cache::Cache;
use crate::content::{Content, Structure, first_instance};
use crate::error::RenderError;
use crate::geodesic_view::{PlacedCamera, PlacedSolidCamera, RayEnds};
use crate::request::PictureRequest;
use crate::view::SharedState;
use geodesic::pixels::Map;
use geometry::{FollowedGeodesic, Manifold, ManifoldError, SolidSurface, follow_declared_over};

/// The number of surfaces that are kept although no camera is on them.
const SURFACES: usize = 4;
/// The number of maps that are kept although other pictures have been drawn since, for other panes.
const MAPS: usize = 6;
/// The maximum number of knots of geodesics on solids that are kept although the last picture has not drawn them.
const KNOTS: usize = 1 << 18;

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
    /// The options, except for the ring, which does not affect the map.
    options: GeodesicOptions,
    size: [u32; 2],
    /// A view at rest does not accept a coarse map, and a moving view does not wait for a fine one.
    moving: bool,
}

impl MapKey {
    fn of(surface: Content, options: &GeodesicOptions, request: &PictureRequest) -> Self {
        Self {
            surface,
            options: GeodesicOptions {
                mark_centre: true,
                ..options.clone()
            },
            size: request.size,
            moving: request.moving,
        }
    }
}

/// Surfaces and maps.
#[derive(Debug)]
pub(super) struct MapCache {
    surfaces: Cache<Content, Arc<Manifold>>,
    /// The most recently used map is last.
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
    /// Returns the map of a request's camera; its geodesics are followed if it is not cached. `progress` receives the
    /// completed fraction.
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
        let key = MapKey::of(surface, options, request);
        if let Some(map) = used(&mut self.maps, &key) {
            // Its surface is in use too.
            self.surfaces.get(&key.surface);
            return Ok(map);
        }
        let camera = self.place(request, options, &structures)?;
        let ends = Arc::new(camera.ends(progress));
        shared.followed += 1;
        let map = Arc::new(CachedMap { camera, ends });
        keep(&mut self.maps, MAPS, key, map.clone());
        Ok(map)
    }

    /// Returns the camera of a request, on a cached surface.
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
            let key = structures[id.index()].instance(scene, params, uniforms);
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

/// Returns the value of a key, and moves it to the end.
fn used<K: PartialEq, T>(kept: &mut Vec<(K, Arc<T>)>, key: &K) -> Option<Arc<T>> {
    let at = kept.iter().position(|(known, _)| known == key)?;
    let known = kept.remove(at);
    let value = known.1.clone();
    kept.push(known);
    Some(value)
}

/// Adds a value; of more than `most`, the least recently used one is evicted.
fn keep<K, T>(kept: &mut Vec<(K, Arc<T>)>, most: usize, key: K, value: Arc<T>) {
    if kept.len() >= most {
        kept.remove(0);
    }
    kept.push((key, value));
}

/// A camera on a solid with the ends of its geodesics.
type SolidMap = (PlacedSolidCamera, Map<3>);

/// Maps of solids, and the solids that were compiled for them.
#[derive(Debug)]
pub(super) struct SolidMapCache {
    /// The most recently used one is last.
    solids: Vec<(Content, Arc<SolidSurface>)>,
    maps: Vec<(MapKey, Arc<SolidMap>)>,
    geodesics: Cache<(Content, [u64; 3]), Arc<FollowedGeodesic>>,
}

impl Default for SolidMapCache {
    fn default() -> Self {
        Self {
            solids: Vec::new(),
            maps: Vec::new(),
            geodesics: Cache::new(KNOTS),
        }
    }
}

impl SolidMapCache {
    /// Returns the map of a request's camera; its geodesics are followed if it is not cached.
    ///
    /// # Errors
    /// Those of [`PlacedSolidCamera::new`] and [`PlacedSolidCamera::ends`].
    pub(super) fn get(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &GeodesicOptions,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Arc<SolidMap>, RenderError> {
        let surface = content_of(shared, request, options)?;
        let key = MapKey::of(surface, options, request);
        if let Some(map) = used(&mut self.maps, &key) {
            return Ok(map);
        }
        let camera = self.place(shared, request, options)?;
        let map = camera.ends(progress)?;
        shared.followed += 1;
        let map = Arc::new((camera, map));
        keep(&mut self.maps, MAPS, key, map.clone());
        Ok(map)
    }

    /// Returns the camera of a request, on a cached solid.
    ///
    /// # Errors
    /// Those of [`PlacedSolidCamera::new`].
    pub(super) fn place(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        options: &GeodesicOptions,
    ) -> Result<PlacedSolidCamera, RenderError> {
        let (scene, id) = (&request.scene, options.camera.surface);
        let content = content_of(shared, request, options)?;
        let solid = match used(&mut self.solids, &content) {
            Some(solid) => solid,
            None => {
                let solid = Arc::new(SolidSurface::new(scene, &request.params, id)?);
                keep(&mut self.solids, SURFACES, content, solid.clone());
                solid
            }
        };
        let camera = PlacedSolidCamera::on(solid, scene, &options.camera, request.size)?;
        let camera = camera.with_method(options.method);
        Ok(if request.moving {
            camera.moving()
        } else {
            camera
        })
    }

    /// Returns a geodesic that is declared on a solid, at the given values of its parameter; it is followed if it is not
    /// cached.
    pub(super) fn followed(
        &mut self,
        request: &PictureRequest,
        structures: &[Structure],
        id: ObjectId,
        sampling: &Sampling,
    ) -> Arc<FollowedGeodesic> {
        let (scene, params) = (&request.scene, &request.params);
        let structure = &structures[id.index()];
        let content = structure.instances(scene, params, &scene.objects[id.index()]);
        let Range { min, max } = sampling.range;
        let key = (
            content,
            [min.to_bits(), max.to_bits(), u64::from(sampling.count)],
        );
        if let Some(known) = self.geodesics.get(&key) {
            return known;
        }
        let followed = Arc::new(follow_declared_over(scene, params, id, sampling));
        let knots = followed.lines.iter().map(Vec::len).sum();
        self.geodesics.put(key, followed.clone(), knots);
        followed
    }

    /// Ends a picture.
    pub(super) fn next(&mut self) {
        self.geodesics.next();
    }
}

/// Returns the content of a solid, everything on which it depends.
fn content_of(
    shared: &mut SharedState,
    request: &PictureRequest,
    options: &GeodesicOptions,
) -> Result<Content, RenderError> {
    let (scene, params) = (&request.scene, &request.params);
    let structures = shared.structures.get(scene.arc());
    let content = first_instance(scene, params, &structures, options.camera.surface);
    Ok(content.ok_or(ManifoldError::NoSurface { name: None })?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::ParamValues;

    #[test]
    fn a_solid_that_is_used_is_kept() {
        let names = ["p", "q", "r", "s", "t"];
        assert_eq!(names.len(), SURFACES + 1);
        let balls = names
            .map(|name| format!("solid {name}(x,y,z) = x^2 + y^2 + z^2 - 1;"))
            .concat();
        let scene = scene::geotrace::compile(&balls).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let first = GeodesicOptions::new(ObjectId::new(0));
        let request = PictureRequest::new(scene, params, first, [4; 2]);
        let (mut shared, mut cache) = (SharedState::default(), SolidMapCache::default());
        let mut place = |k: usize| {
            let options = GeodesicOptions::new(ObjectId::new(k));
            let camera = cache.place(&mut shared, &request, &options);
            camera.expect("a camera")
        };
        let solids: Vec<_> = (0..SURFACES).map(&mut place).collect();
        let mut is_kept = |k: usize| {
            let before = solids.get(k).map(PlacedSolidCamera::solid);
            let now = place(k);
            before.is_some_and(|before| std::ptr::eq(now.solid(), before))
        };
        assert!(is_kept(0));
        // One more than are kept: the one that has not been used for longest is evicted.
        assert!(!is_kept(SURFACES));
        assert!(is_kept(0) && is_kept(SURFACES - 1) && !is_kept(1));
    }
}
