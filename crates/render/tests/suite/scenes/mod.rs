//! Programs that these tests draw, and pictures of them.

use std::sync::Arc;

use scene::Scene;

#[path = "../../../../../tests/src/wanted.rs"]
#[allow(dead_code, unreachable_pub)]
mod wanted;

#[allow(unused_imports)]
pub(crate) use wanted::{Drawn, Wanted};

/// What a program without mistakes compiles to.
pub(crate) fn scene(source: &str) -> Arc<Scene> {
    let compilation = scene::geotrace::compile(source);
    let scene = compilation
        .scene
        .unwrap_or_else(|| panic!("{source}: {:?}", compilation.diagnostics));
    Arc::new(scene)
}
