//! A picture as the window would show it, without a window. In: the remembered view of a program. Out: a request.

use std::path::Path;
use std::sync::Arc;

use render::shared::Shared;
use render::texture::Texture;
use render::trail::Trail;
use render::{PictureRequest, ViewId, Views};
use scene::Scene;
use session::Theme;
use session::figures;
use session::measuring::PlacedFigure;
use session::request::{PaneRequest, at_rest, picture_request};
use session::textures::ImageState;
use session::{Model, TextureChoice};

use crate::engine::textures::Library;
use crate::io::persistence::{self, Drawn, DrawnFigure};

/// Returns the request for a view's picture as the window remembers it: with the chosen params, cameras, colours,
/// textures and overlays. A window that follows the desktop's theme counts as dark.
///
/// # Errors
/// A sentence: nothing is remembered of the program, an image cannot be read, or there is no such view.
pub fn remembered(
    program: &Path,
    scene: &Arc<Scene>,
    views: &Views,
    id: &ViewId,
    size: [u32; 2],
) -> Result<PictureRequest, String> {
    let known = persistence::read(program).map_err(|reason| reason.to_string())?;
    let drawn = known.drawn;
    let is_light = known.choices.preferences.theme == Theme::Light;
    let mut model = Model::default();
    model.turn_to(known.choices);
    model.is_light = is_light;
    model.take_scene(Arc::clone(scene));
    model.rerun();
    let mut library = Library::default();
    for name in model.surfaces() {
        if let TextureChoice::Image(path) = model.choices.texture(&name) {
            let texture =
                Texture::load(path, &library.source.budget).map_err(|error| error.to_string())?;
            library.put(path.clone(), ImageState::Ready(Arc::new(texture)));
        }
    }
    // The surface whose camera a newly opened window shows.
    let active = model.surfaces().into_iter().next();
    let pane = PaneRequest {
        id,
        size,
        active: active.as_deref(),
    };
    let request = picture_request(&mut model, &mut library, views, pane);
    let mut request = request.ok_or_else(|| format!("there is no view `{id}`"))?;
    request.trails = trails(&mut model, id, &drawn);
    Ok(at_rest(request, &model, size))
}

/// Returns the trails of a view: in space those on all surfaces, in a geodesic view those on its own. Those that cannot
/// be drawn are left out.
fn trails(model: &mut Model, id: &ViewId, drawn: &Drawn) -> Vec<Shared<Trail>> {
    let is_shown = |name: &str| id.object.as_deref().is_none_or(|own| own == name);
    let mut all = Vec::new();
    for (name, places) in drawn.paths.iter().filter(|(name, _)| is_shown(name)) {
        if let Some(subject) = model.subject(name)
            && let Ok(manifold) = subject.manifold()
        {
            let trail = Trail::through(manifold.surface(), subject.surface, places.clone());
            all.push(Arc::new(trail).into());
        }
    }
    let figure = drawn.figure.as_ref().and_then(DrawnFigure::placed);
    if let Some(PlacedFigure { surface, figure }) = figure.filter(|it| is_shown(&it.surface))
        && let Some(subject) = model.subject(&surface)
        && let Ok(manifold) = subject.manifold()
    {
        let measured = figures::measured(manifold.surface(), &subject, &figure);
        all.extend(measured.lines.into_iter().map(Shared::from));
    }
    all
}
