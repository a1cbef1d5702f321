//! Programs that these tests draw.

use scene::scene::Scene;

/// What a program without mistakes compiles to.
pub(crate) fn scene(source: &str) -> Scene {
    let compilation = scene::compile(source);
    compilation
        .scene
        .unwrap_or_else(|| panic!("{source}: {:?}", compilation.diagnostics))
}
