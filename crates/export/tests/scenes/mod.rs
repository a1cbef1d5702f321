//! Programs that these tests draw.

use scene::Scene;

/// What a program without mistakes compiles to.
pub(crate) fn scene(source: &str) -> Scene {
    let compilation = scene::geotrace::compile(source);
    compilation
        .scene
        .unwrap_or_else(|| panic!("{source}: {:?}", compilation.diagnostics))
}
