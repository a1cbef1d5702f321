//! The images of surfaces: options flow in, textures for the values of params flow out.

use export::whole_file::phrase;
use render::PictureRequest;
use render::shared::Shared;
use render::texture::{Texture, TextureError};
use scene::{ObjectId, ParamValues, Scene};

use super::failure;
use crate::argument::TextureFile;
use crate::failure::Failure;
use crate::number;
use crate::program::LoadedProgram;

/// The images of the surfaces.
pub(in crate::command) struct Images {
    pub(super) loaded: Vec<(ObjectId, Shared<Texture>)>,
    /// Surfaces that are coloured by curvature, which may change with the params.
    pub(super) curved: Vec<ObjectId>,
}

impl Images {
    /// The images for these values of the params.
    pub(in crate::command) fn at(
        &self,
        scene: &Scene,
        params: &ParamValues,
    ) -> Result<Vec<(ObjectId, Shared<Texture>)>, Failure> {
        let curvature = |&surface: &ObjectId| {
            let texture = Texture::curvature(scene, params, surface).map_err(failure)?;
            Ok((surface, texture.into()))
        };
        let curved: Result<Vec<_>, Failure> = self.curved.iter().map(curvature).collect();
        Ok([self.loaded.clone(), curved?].concat())
    }

    /// Notes on the colours of curvature.
    pub(super) fn notes(&self, program: &LoadedProgram, request: &PictureRequest) -> Vec<String> {
        let note = |&surface: &ObjectId| {
            let scale = request.texture(surface).curvature_scale()?;
            let most = scale.most;
            let [less, more] = match scale.is_clipped {
                true => [" and less", " and more"],
                false => ["", ""],
            };
            // Rounded to four digits.
            let rounded = format!("{most:.3e}").parse().unwrap_or(most);
            let most = number::show(rounded);
            Some(format!(
                "`{}` shows its Gaussian curvature: -{most}{less} is blue, 0 white, {most}{more} red",
                program.object_name(surface)?
            ))
        };
        self.curved.iter().filter_map(note).collect()
    }
}

/// The word that stands for the colours of curvature in place of a file.
const CURVATURE: &str = "curvature";
/// The word for no image.
const PLAIN: &str = "plain";

/// Reads the image files.
pub(in crate::command) fn textures(
    files: &[TextureFile],
    program: &LoadedProgram,
) -> Result<Images, Failure> {
    let mut images = Images {
        loaded: Vec::new(),
        curved: Vec::new(),
    };
    for file in files {
        let (surface, _) = program.surface(Some(&file.surface))?;
        // The last option for a surface applies.
        images.curved.retain(|&other| other != surface);
        if file.path.as_os_str() == CURVATURE {
            images.curved.push(surface);
        } else if file.path.as_os_str() == PLAIN {
            images.loaded.push((surface, Texture::plain().into()));
        } else {
            let texture =
                Texture::load(&file.path).map_err(|error| texture_failure(file, error))?;
            images.loaded.push((surface, texture.into()));
        }
    }
    Ok(images)
}

fn texture_failure(file: &TextureFile, error: TextureError) -> Failure {
    match error {
        TextureError::Unreadable { message, .. } => Failure::Unreadable {
            file: file.path.display().to_string(),
            reason: phrase(&message),
        },
        TextureError::NotAnImage { .. } | TextureError::TooLarge { .. } => Failure::Input {
            message: error.to_string(),
            hint: None,
        },
    }
}
