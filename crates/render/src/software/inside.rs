//! The geodesic view on the CPU: the map by crate `geodesic`, the colours by [`crate::geodesic_view`].

use scene::scene::Scene;
use scene::values::Settings;

use crate::request::{Picture, RenderError, Request};

pub(super) fn render(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    let _ = (scene, settings, request, progress);
    Err(RenderError::Camera("the geodesic view is not there yet".to_owned()))
}
