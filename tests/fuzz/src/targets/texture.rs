//! Image files.

use std::io::Write;

use render::texture::{TexelBudget, Texture};

/// Decodes an image from a file.
pub(crate) fn run(input: &[u8]) {
    let mut file = tempfile::NamedTempFile::new().expect("a file");
    file.write_all(input).expect("it can be written");
    match Texture::load(file.path(), &TexelBudget::default()) {
        Ok(texture) => assert!(!texture.levels().is_empty(), "a texture has levels"),
        Err(error) => assert!(!error.to_string().is_empty(), "a sentence"),
    }
}
