//! Pictures of programs that compile.

use std::sync::Arc;

use ide::Languages;
use render::{Backend, PictureRequest, Views};
use scene::ParamValues;

/// The size of the pictures, in pixels.
const SIZE: [u32; 2] = [12, 9];
/// The most bytes of a program: its samples are many enough.
const LONGEST: usize = 3000;
/// The most objects of a program that is drawn.
const OBJECTS: usize = 12;
/// The most views of a program that are drawn.
const VIEWS: usize = 4;

/// Compiles a program, and draws it in every view.
pub(crate) fn run(input: &[u8]) {
    let text = String::from_utf8_lossy(&input[..input.len().min(LONGEST)]);
    let languages = Languages::standard();
    let compiled = languages
        .default_language()
        .compile(&text)
        .expect("it is small");
    let Some(scene) = compiled.scene else {
        return;
    };
    if scene.objects.len() > OBJECTS {
        return;
    }
    let params = Arc::new(ParamValues::initial(&scene));
    let views = Views::standard();
    for id in views.of_scene(Some(&scene)).iter().take(VIEWS) {
        let Some(options) = views.options(id, &scene) else {
            continue;
        };
        let request = PictureRequest::new(scene.clone(), params.clone(), options, SIZE);
        match render::render(&views, &request, Backend::Software, &|_| {}) {
            Ok(picture) => assert_eq!(picture.image.dimensions(), (SIZE[0], SIZE[1])),
            Err(error) => assert!(!error.to_string().is_empty(), "a sentence"),
        }
    }
}
