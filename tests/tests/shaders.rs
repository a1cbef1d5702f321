//! The generated WGSL of every example, validated by naga on the CPU, and golden texts of a few.

use std::path::PathBuf;

use scene::{Object, Shape};
use testing::draw::scene;
use testing::examples::{self, repository};
use wgsl::{GenerateError, Kernel};

/// The kernels that an object can need.
fn kernels(graph: &expr::Graph, object: &Object) -> Vec<Result<Kernel, GenerateError>> {
    match object.shape {
        Shape::Point { position } => vec![wgsl::kernel::sample_point(graph, position)],
        Shape::Vector { direction, origin } => {
            vec![wgsl::kernel::sample_vector(graph, origin, direction)]
        }
        Shape::Curve { position, .. } => vec![wgsl::kernel::sample_curve(graph, position)],
        Shape::Surface { position, .. } => vec![wgsl::kernel::sample_surface(graph, position)],
        // None of the others is sampled by a kernel.
        _ => Vec::new(),
    }
}

#[test]
fn every_kernel_of_every_example_is_valid() {
    let mut count = 0;
    for example in examples::all() {
        let scene = scene(&example.source);
        for object in &scene.objects {
            for kernel in kernels(&scene.graph, object) {
                let kernel = kernel
                    .unwrap_or_else(|error| panic!("{}, {}: {error}", example.name, object.name));
                assert!(
                    !kernel.generated().contains("f64"),
                    "{}: f64 in a shader",
                    example.name
                );
                count += 1;
            }
        }
    }
    assert!(count > 30, "only {count} kernels");
}

#[test]
fn the_fixed_passes_are_valid() {
    for (name, joined) in [
        ("points", wgsl::painter::points()),
        ("vectors", wgsl::painter::vectors()),
        ("curves", wgsl::painter::curves()),
        ("surfaces", wgsl::painter::surfaces()),
        ("resolve_piecewise", wgsl::painter::resolve_piecewise()),
        ("trace_scene", wgsl::traced::trace_scene("")),
    ] {
        if let Err(error) = joined {
            panic!("{name}: {error}");
        }
    }
}

/// Compares a text with `cases/wgsl/NAME.wgsl`, which `UPDATE=1` writes anew.
#[track_caller]
fn assert_text(name: &str, text: &str) {
    let path: PathBuf = repository().join(format!("tests/cases/wgsl/{name}.wgsl"));
    if testing::writes_expected() {
        std::fs::write(&path, text).expect("the golden text is writable");
        return;
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        text,
        golden,
        "{} differs; UPDATE=1 writes it anew",
        path.display()
    );
}

/// The generated functions of one object's last kernel.
fn generated(example: &str, object: &str) -> String {
    let scene = scene(&examples::one(example).source);
    let found = scene
        .objects
        .iter()
        .find(|candidate| candidate.name == object);
    let object = found.unwrap_or_else(|| panic!("no {object} in {example}"));
    let kernel = kernels(&scene.graph, object).pop().expect("a kernel");
    kernel.expect("a valid kernel").generated().to_owned()
}

#[test]
fn the_text_for_a_tangent() {
    assert_text("circle-v", &generated("circle", "v"));
}

#[test]
fn the_text_for_samples_of_a_torus() {
    assert_text("torus-s", &generated("torus", "s"));
}

#[test]
fn the_text_for_samples_of_a_monkey_saddle() {
    assert_text("monkey-s", &generated("monkey", "s"));
}
