//! Both views of a scene as pictures, offscreen: wgpu painters, and a software path for machines without a GPU.
//!
//! ```text
//! Scene + ParamValues ──sample.rs (f64 blocks) or a generated kernel──▶ samples ──gpu/ or software/──▶ 3D picture
//! surface + Frame ──geodesic kernel (gpu/) or geodesic::map──▶ Map ──resolve: texture──▶ geodesic picture
//! ```
//!
//! What is built for a picture is planned first ([`plan`](mod@plan)); both backends draw from the same samples
//! with the same camera ([`camera`]) and the same constants ([`style`]).
//! All filtering, shading and averaging happens in linear light; textures and pictures hold sRGB.

pub mod bounds;
pub mod camera;
pub mod geodesic_view;
pub mod gpu;
pub mod live;
pub mod overlay;
pub mod plan;
pub mod request;
pub mod sample;
pub mod software;
pub mod style;
pub mod texture;

pub use request::{Backend, Method, Picture, RenderError, Request, View};

use scene::{ParamValues, Scene};

/// Draws one picture. `progress` is told the share that is done, from 0 to 1, from any thread.
///
/// [`Backend::Auto`] takes a GPU where there is one and the software path otherwise; [`Picture::backend`] says
/// which and why.
///
/// # Errors
/// See [`RenderError`]; nothing a scene or a request holds leads to a panic.
pub fn render(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    request.check(scene)?;
    let mut picture = by_backend(scene, settings, request, progress)?;
    if matches!(request.view, View::Space { .. }) {
        let image = &mut picture.image;
        let drawn = overlay::over_space(image, scene, settings, request)?;
        picture.overlays.extend(drawn);
    }
    Ok(picture)
}

fn by_backend(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    match request.backend {
        Backend::Gpu => gpu::render(scene, settings, request, progress),
        Backend::Software => {
            let mut picture = software::render(scene, settings, request, progress)?;
            picture.backend = "software, as asked for".to_owned();
            Ok(picture)
        }
        Backend::Auto => match gpu::render(scene, settings, request, progress) {
            Err(RenderError::NoGpu { reason }) => {
                let mut picture = software::render(scene, settings, request, progress)?;
                picture.backend = format!("software, because {reason}");
                Ok(picture)
            }
            // A driver that fails must not cost the picture; what it said is not lost.
            Err(RenderError::Gpu(message)) => {
                let mut picture = software::render(scene, settings, request, progress)?;
                picture.backend = format!("software, because the GPU failed: {message}");
                Ok(picture)
            }
            other => other,
        },
    }
}
