//! The geodesic view on the CPU: the map by crate `geodesic`, the colours by [`crate::geodesic_view`].

use geometry::ManifoldError;
use scene::ParamValues;
use scene::{Scene, Shape};

use crate::geodesic_view::{Inside, Paint, Seen, Tally, count, notes};
use crate::overlay::OverInside;
use crate::request::{Picture, RenderError, Request, View};

pub(super) fn render(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    let inside = Inside::new(scene, settings, request)?;
    let seen = inside.look(&|share| progress(0.9 * share));
    let picture = paint(scene, settings, request, &inside, &seen, &Tally::default())?;
    progress(1.0);
    Ok(picture)
}

/// Colours what a camera sees; what that takes is added to the tally.
///
/// # Errors
/// [`RenderError::Manifold`].
pub(crate) fn paint(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    inside: &Inside,
    seen: &Seen,
    tally: &Tally,
) -> Result<Picture, RenderError> {
    let View::Geodesic { surface, .. } = request.view else {
        return Err(ManifoldError::NoSurface { name: None }.into());
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
    let over = OverInside::new(scene, settings, request, inside, surface, tally);
    let (mut image, status) = seen.resolve_under(&paint, over.layer(), tally);
    let (over, overlays) = over.finish(&mut image, seen, Some(&status));
    let mut notes = notes(status.len(), count(&status), &seen.work(), seen.estimate());
    notes.extend(over);
    Ok(Picture {
        image,
        backend: "software".to_owned(),
        notes,
        overlays,
    })
}
