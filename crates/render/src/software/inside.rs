//! The geodesic view on the CPU: the map by crate `geodesic`, the colours by [`crate::geodesic_view`].

use std::borrow::Cow;

use scene::scene::{Scene, Shape};
use scene::values::Settings;

use crate::geodesic_view::{Inside, Paint, Seen, notes};
use crate::overlay;
use crate::request::{Picture, RenderError, Request, View};

pub(super) fn render(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    let inside = Inside::new(scene, settings, request)?;
    let seen = inside.look(&|share| progress(0.9 * share));
    let picture = paint(scene, settings, request, &inside, &seen)?;
    progress(1.0);
    Ok(picture)
}

/// Colours what a camera sees.
///
/// # Errors
/// [`RenderError::NoSurface`].
pub(crate) fn paint(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    inside: &Inside,
    seen: &Seen,
) -> Result<Picture, RenderError> {
    let View::Geodesic { surface, .. } = request.view else {
        return Err(RenderError::NoSurface { name: None });
    };
    let shape: &Shape = &scene.objects[surface.0 as usize].shape;
    let texture = request.texture(surface);
    let paint = Paint {
        texture: &texture,
        colour: request.colour(surface, shape),
        domain: inside.domain(),
        sides: inside.sides(),
        mark_centre: request.mark_centre,
        coarse: request.moving,
    };
    let (mut image, status) = seen.resolve(&paint);
    let (over, overlays) = overlay::over_inside(
        &mut image,
        scene,
        settings,
        request,
        inside,
        surface,
        || Cow::Borrowed(seen),
    );
    let count = |kind| status.iter().filter(|&&s| s == kind).count();
    let mut notes = notes(status.len(), count, &seen.work(), seen.estimate());
    notes.extend(over);
    Ok(Picture {
        image,
        backend: "software".to_owned(),
        notes,
        overlays,
    })
}
