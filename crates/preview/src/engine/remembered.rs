//! A picture as the window would show it: what is remembered of a program flows in, a request flows out, without a window.

use std::path::Path;
use std::sync::Arc;

use render::{PictureRequest, ViewId, Views};
use scene::Scene;

use crate::engine::request::{at_rest, picture_request};
use crate::engine::textures::Library;
use crate::io::persistence;
use crate::state::view::Theme;
use crate::state::{Choice, Model};

/// Returns the request for a view's picture as the window remembers it: of the params, cameras, colours, textures and
/// overlays that were chosen there. A window that follows the desktop's theme is taken for a dark one.
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
    let is_light = known.view.preferences.theme == Theme::Light;
    let mut model = Model::default();
    model.turn_to(known.view);
    model.is_light = is_light;
    model.take_scene(Arc::clone(scene));
    let mut library = Library::default();
    for name in model.surfaces() {
        if let Choice::Image(path) = model.view.texture(&name) {
            library.read_now(path)?;
        }
    }
    // The surface whose camera a window shows that has just been opened.
    let active = model.surfaces().into_iter().next();
    let active = active.as_deref();
    let request = picture_request(&mut model, &mut library, views, id, size, active, false);
    let request = request.ok_or_else(|| format!("there is no view `{id}`"))?;
    Ok(at_rest(request, &model, size))
}
