//! Files for the reader: a picture as PNG, the scene as a mesh.

use std::io::Cursor;

use export::mesh::{self, MeshFormat};
use image::ImageFormat;
use render::{Backend, ViewId};
use session::request::at_rest;

use super::Core;

/// The bytes of a file, and sentences about them.
#[derive(Debug)]
pub struct Saved {
    /// The content.
    pub bytes: Vec<u8>,
    /// Its media type.
    pub media_type: &'static str,
    /// Sentences for the reader.
    pub notes: Vec<String>,
}

impl Core {
    /// Returns the picture of a view at rest, in a given size, as a PNG file.
    ///
    /// # Errors
    /// A sentence for the reader of the page.
    pub fn save_picture(&mut self, view: &str, size: [u32; 2]) -> Result<Saved, String> {
        self.read();
        let id = ViewId::from(view);
        let request = self.request(&id, size);
        let request = request.ok_or("there is nothing to see")?;
        let request = at_rest(request, &self.model, size);
        let drawn = render::render(&self.views, &request, Backend::Software, &|_| {});
        let drawn = drawn.map_err(|error| error.to_string())?;
        let mut bytes = Cursor::new(Vec::new());
        let written = drawn.image.write_to(&mut bytes, ImageFormat::Png);
        written.map_err(|error| error.to_string())?;
        Ok(Saved {
            bytes: bytes.into_inner(),
            media_type: "image/png",
            notes: drawn.remarks().map(str::to_owned).collect(),
        })
    }

    /// Returns the objects that are not hidden, as a file of the format with an extension.
    ///
    /// # Errors
    /// A sentence for the reader of the page.
    pub fn save_mesh(&mut self, extension: &str) -> Result<Saved, String> {
        self.read();
        let format = MeshFormat::from_extension(extension)
            .ok_or_else(|| format!("there is no format `{extension}`"))?;
        let id = ViewId::of_scene(self.views.first().name());
        let request = self.request(&id, [256; 2]);
        let request = request.ok_or("there is nothing to export")?;
        let request = at_rest(request, &self.model, [256; 2]);
        let model = mesh::model(&request, None);
        let mut bytes = Vec::new();
        let notes = model.write(format, &mut bytes);
        let notes = notes.map_err(|error| error.to_string())?;
        Ok(Saved {
            bytes,
            media_type: match format {
                MeshFormat::Obj => "model/obj",
                MeshFormat::Ply => "model/ply",
                MeshFormat::Stl => "model/stl",
                MeshFormat::Gltf => "model/gltf+json",
                MeshFormat::Glb => "model/gltf-binary",
            },
            notes: model.notes.into_iter().chain(notes).collect(),
        })
    }
}
