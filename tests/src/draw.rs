//! Scenes and pictures of examples, drawn in this process.

use std::sync::Arc;

use image::RgbaImage;
use render::{Backend, RenderedImage};
use scene::geotrace::compile;
use scene::{ObjectId, Shape};
use scene::{ParamValues, Scene};

use crate::wanted::Wanted;

/// Compiles a program.
///
/// # Panics
/// When it has errors.
#[track_caller]
pub fn scene(source: &str) -> Arc<Scene> {
    let compilation = compile(source);
    let scene = compilation.scene;
    Arc::new(scene.unwrap_or_else(|| panic!("{:#?}", compilation.diagnostics)))
}

/// The surfaces of a scene.
pub fn surfaces(scene: &Scene) -> Vec<ObjectId> {
    let objects = scene.objects.iter().enumerate();
    objects
        .filter(|(_, object)| matches!(object.shape, Shape::Surface { .. }))
        .map(|(index, _)| ObjectId::new(index))
        .collect()
}

/// Values of params in the middle of their intervals: nothing is degenerate there, as it may be at an end.
///
/// # Panics
/// When a scene refuses its own values.
pub fn middle(scene: &Scene) -> ParamValues {
    let mut settings = ParamValues::initial(scene);
    for param in &scene.params {
        let values: Vec<f64> = param
            .ranges
            .iter()
            .map(|range| range.min + 0.4 * (range.max - range.min))
            .collect();
        settings
            .set(scene, &param.name, &values)
            .expect("a value inside the interval");
    }
    settings
}

/// Draws a picture. On the GPU it must be possible: a machine without one has Mesa's software driver.
///
/// # Panics
/// When there is no picture.
#[track_caller]
pub fn draw(
    scene: &Arc<Scene>,
    settings: &ParamValues,
    request: &Wanted,
) -> RenderedImage<RgbaImage> {
    match request.draw(scene, settings) {
        Ok(picture) => picture,
        Err(error) if request.backend == Backend::Gpu => panic!(
            "no picture from the GPU: {error}. The tests need a Vulkan driver; without a GPU: \
             apt-get install mesa-vulkan-drivers libvulkan1"
        ),
        Err(error) => panic!("no picture: {error}"),
    }
}

/// The share of pixels, 0 to 1, that differ from the upper left one.
pub fn drawn_share(image: &RgbaImage) -> f64 {
    let background = *image.get_pixel(0, 0);
    let drawn = image.pixels().filter(|pixel| **pixel != background).count();
    drawn as f64 / f64::from(image.width() * image.height())
}
