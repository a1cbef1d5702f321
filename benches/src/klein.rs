//! Derivatives and WGSL of the Klein bottle: what an edit of it costs before a driver sees anything.

use scene::Shape;
use testing::examples;

use crate::measure::Times;

/// Prints the table.
pub(crate) fn run() {
    println!("The Klein bottle");
    let source = examples::one("klein").source;
    println!(
        "  check: {}",
        Times::of(51, || scene::geotrace::compile(&source))
    );
    let Some(scene) = scene::geotrace::compile(&source).scene else {
        println!("  has errors");
        return;
    };
    let surface = scene.objects.iter().find_map(|object| match object.shape {
        Shape::Surface { position, .. } => Some(position),
        _ => None,
    });
    let Some(position) = surface else {
        println!("  has no surface");
        return;
    };
    match wgsl::kernel::sample_surface(&scene.graph, position) {
        Ok(kernel) => println!(
            "  operations in the kernel: {}; generated text: {} bytes",
            kernel.operations(),
            kernel.generated().len()
        ),
        Err(error) => println!("  no kernel: {error}"),
    }
    println!(
        "  derivatives and WGSL of its samples: {}",
        Times::of(51, || wgsl::kernel::sample_surface(&scene.graph, position))
    );
}
