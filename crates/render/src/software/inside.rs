//! The geodesic view on the CPU: the map by crate `geodesic`, the colours by [`crate::geodesic_view`].

use geodesic::map::Map;
use geodesic::trace::Status;
use scene::scene::{Scene, Shape};
use scene::values::Settings;

use crate::geodesic_view::{Inside, Paint, resolve};
use crate::request::{Picture, RenderError, Request, View};

pub(super) fn render(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Picture, RenderError> {
    let inside = Inside::new(scene, settings, request)?;
    let View::Geodesic { surface, .. } = request.view else {
        return Err(RenderError::NoSurface { name: None });
    };
    let shape: &Shape = &scene.objects[surface.0 as usize].shape;
    let map = inside.map(&|share| progress(0.95 * share));
    let texture = request.texture(surface);
    let paint = Paint {
        texture: &texture,
        colour: request.colour(surface, shape),
        domain: inside.domain(),
        mark_centre: request.mark_centre,
    };
    let image = resolve(&map, &paint);
    progress(1.0);
    Ok(Picture {
        image,
        backend: "software".to_owned(),
        notes: notes(&map),
    })
}

/// What a reader of the picture should be told of pixels that show nothing of the surface.
fn notes(map: &Map) -> Vec<String> {
    let kinds = [
        (Status::LeftDomain, "lie beyond the surface's edge"),
        (Status::ConePoint, "end at the tip of a cone"),
        (
            Status::Degenerate,
            "end where the surface has no tangent plane",
        ),
        (Status::Undefined, "end where the surface is undefined"),
        (
            Status::WorkLimit,
            "could not be followed within the limit of work",
        ),
    ];
    let note = |(status, what): (Status, &str)| {
        let count = map.status.iter().filter(|&&s| s == status).count();
        let share = 100.0 * count as f64 / map.status.len() as f64;
        (count > 0).then(|| format!("{share:.2} % of the pixels {what}; they are hatched"))
    };
    kinds.into_iter().filter_map(note).collect()
}
