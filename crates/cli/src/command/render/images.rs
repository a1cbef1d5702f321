//! The images of objects: options and a program flow in, textures for the values of params flow out.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use export::whole_file::phrase;
use render::PictureRequest;
use render::shared::Shared;
use render::texture::{TexelBudget, Texture, TextureError, missing_file, named_file};
use scene::{Object, ObjectId, ParamValues, Scene};

use super::failure;
use crate::argument::TextureFile;
use crate::failure::Failure;
use crate::number;
use crate::program::LoadedProgram;

/// The images of the objects.
pub(in crate::command) struct Images {
    pub(super) loaded: Vec<(ObjectId, Shared<Texture>)>,
    /// Those that the program names, by their words.
    pub(in crate::command) named: Vec<(String, Shared<Texture>)>,
    /// That of the background, instead of the one that it names.
    pub(super) background: Option<Shared<Texture>>,
    /// Sentences about images that the program names and that are not shown.
    missing: Vec<String>,
    /// The files of those that are there and cannot be read.
    unreadable: Vec<PathBuf>,
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

    /// The files of the images, also of those that could not be read.
    pub(in crate::command) fn files(&self) -> impl Iterator<Item = &Path> {
        let loaded = self.loaded.iter().map(|(_, texture)| texture);
        let named = self.named.iter().map(|(_, texture)| texture);
        let all = loaded.chain(named).chain(&self.background);
        let read = all.filter_map(|texture| texture.file());
        read.chain(self.unreadable.iter().map(PathBuf::as_path))
    }

    /// Notes on the colours of curvature, and on images that are not shown.
    pub(in crate::command) fn notes(
        &self,
        program: &LoadedProgram,
        request: &PictureRequest,
    ) -> Vec<String> {
        let note = |&surface: &ObjectId| {
            let scale = request.texture(surface).curvature_scale()?;
            let most = scale.most;
            let name = program.object_name(surface)?;
            if scale.is_flat {
                return Some(format!(
                    "`{name}` shows its Gaussian curvature: it is 0 everywhere, which is white"
                ));
            }
            let [less, more] = match scale.is_clipped {
                true => [" and less", " and more"],
                false => ["", ""],
            };
            let most = number::show(number::rounded(most, 4));
            Some(format!(
                "`{name}` shows its Gaussian curvature: -{most}{less} is blue, 0 white, {most}{more} red"
            ))
        };
        let missing = self.missing.iter().cloned();
        self.curved.iter().filter_map(note).chain(missing).collect()
    }
}

/// The word that stands for the colours of curvature in place of a file.
const CURVATURE: &str = "curvature";
/// The word for no image.
const PLAIN: &str = "plain";

/// Reads the image files: those of options, and those that the program names, beside it or in `folder`.
pub(in crate::command) fn textures(
    files: &[TextureFile],
    folder: Option<&Path>,
    program: &LoadedProgram,
) -> Result<Images, Failure> {
    let scene = program.scene();
    let budget = TexelBudget::default();
    let mut images = Images {
        loaded: Vec::new(),
        named: Vec::new(),
        background: None,
        missing: Vec::new(),
        unreadable: Vec::new(),
        curved: Vec::new(),
    };
    let beside = Path::new(&program.source.name).parent();
    let folders = beside.into_iter().chain(folder).map(Path::to_owned);
    let folders: Vec<PathBuf> = folders.collect();
    let objects = scene.objects.iter().chain(&scene.stage);
    let shows_its_own = |object: &&Object| !files.iter().any(|file| file.object == object.name);
    let words: BTreeSet<&str> = objects
        .filter(shows_its_own)
        .flat_map(Object::image_words)
        .collect();
    for word in words {
        let Some(file) = named_file(word, &folders) else {
            images.missing.push(missing_file(word, &folders));
            continue;
        };
        match Texture::load(&file, &budget) {
            Ok(image) => images.named.push((word.to_owned(), image.into())),
            Err(error) => {
                images.missing.push(error.to_string());
                images.unreadable.push(file);
            }
        }
    }
    for file in files {
        let load = || {
            let path = sought(&file.path, &folders);
            Texture::load(&path, &budget).map_err(|error| texture_failure(file, error))
        };
        let background = scene.background();
        if let Some(object) = background.filter(|object| object.name == file.object) {
            refuse_word(file, object.shape.kind())?;
            images.background = Some(load()?.into());
            continue;
        }
        let named = scene.objects_named(&file.object);
        let solids = named.filter(|(_, object)| object.shape.solid().is_some());
        let solids: Vec<(ObjectId, &Object)> = solids.collect();
        if let Some((_, first)) = solids.first() {
            refuse_word(file, first.shape.kind())?;
            let image = Shared::from(load()?);
            images
                .loaded
                .extend(solids.into_iter().map(|(id, _)| (id, image.clone())));
            continue;
        }
        let (surface, _) = program.textured(&file.object)?;
        // The last option for a surface applies.
        images.curved.retain(|&other| other != surface);
        if file.path.as_os_str() == CURVATURE {
            images.curved.push(surface);
        } else if file.path.as_os_str() == PLAIN {
            images.loaded.push((surface, Texture::plain().into()));
        } else {
            images.loaded.push((surface, load()?.into()));
        }
    }
    Ok(images)
}

/// Returns the file of an option: in the current folder, or else where images are sought that the program names.
fn sought<'a>(path: &'a Path, folders: &[PathBuf]) -> Cow<'a, Path> {
    if path.is_absolute() || path.exists() {
        return path.into();
    }
    let named = path.to_str().and_then(|name| named_file(name, folders));
    named.map_or(path.into(), Cow::Owned)
}

/// Refuses a word in place of a file for an object other than a surface or a metric.
fn refuse_word(file: &TextureFile, kind: &str) -> Result<(), Failure> {
    let mut words = [CURVATURE, PLAIN].into_iter();
    match words.find(|word| file.path.as_os_str() == *word) {
        Some(word) => Err(Failure::Usage {
            message: format!(
                "`{}` is a {kind}, but `{word}` is for a surface or a metric",
                file.object
            ),
            hint: Some(format!(
                "a {kind} shows an image file: `{}=FILE`",
                file.object
            )),
        }),
        None => Ok(()),
    }
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
