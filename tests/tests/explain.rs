//! A scene pays only for what it has: what `explain` says, what is planned, and what is built.

use std::path::Path;

use render::Backend;
use render::plan::{Built, Painter, SampleSource};
use scene::ParamValues;
use testing::binary::geotrace;
use testing::draw::{scene, surfaces};
use testing::examples;
use testing::wanted::Wanted;

const POINTS: &str = "grid k : [0, 1, 5];\npoint p = (k, k^2, 0);\n";

/// What the GPU path builds for the 3D view; asserts that it is what was planned.
#[track_caller]
fn built(source: &str, inside: bool) -> Built {
    let scene = scene(source);
    let settings = ParamValues::initial(&scene);
    let request = match surfaces(&scene).first() {
        Some(surface) if inside => Wanted::geodesic(*surface, [16, 16]),
        _ => Wanted::space([16, 16]),
    };
    let request = Wanted {
        backend: Backend::Gpu,
        ..request
    };
    let planned = request.plan(&scene, &settings).built();
    let (_, built) = request.draw_counted(&scene, &settings)
        .unwrap_or_else(|error| {
            panic!("{error}. The tests need a Vulkan driver: apt-get install mesa-vulkan-drivers libvulkan1")
        });
    assert_eq!(built, planned, "built and planned differ");
    built
}

#[test]
fn a_scene_of_points_builds_one_pipeline_and_nothing_else() {
    let expected = Built {
        draw_pipelines: 1,
        ..Built::default()
    };
    assert_eq!(built(POINTS, false), expected);
}

#[test]
fn an_empty_scene_builds_nothing() {
    assert_eq!(built("", false), Built::default());
}

#[test]
fn a_surface_in_space_builds_no_geodesic_kernel() {
    let found = built(&examples::one("torus").source, false);
    assert_eq!(found.draw_pipelines, 1);
    assert_eq!(found.resolve_pipelines, 0);
    assert_eq!((found.textures, found.samplers), (1, 1));
}

#[test]
fn a_view_from_inside_builds_no_painter() {
    let found = built(&examples::one("sphere").source, true);
    assert_eq!(found.draw_pipelines, 0);
    assert_eq!(found.sample_kernels, 0);
    assert_eq!(found.resolve_pipelines, 1);
    assert_eq!((found.textures, found.samplers), (1, 1));
}

#[test]
fn each_kind_of_object_has_its_own_painter() {
    let found = built(&examples::one("sphere").source, false);
    assert_eq!(found.draw_pipelines, 4);
    let found = built(&examples::one("circle").source, false);
    assert_eq!(found.draw_pipelines, 3);
    assert_eq!((found.textures, found.samplers), (0, 0));
}

#[test]
fn many_samples_come_from_a_kernel_and_few_from_blocks() {
    let source = |count: &str| {
        format!(
            "surface s(u,v) = ((2 + cos v) cos u, (2 + cos v) sin u, sin v + sin u cos(3u)), \
             u : [0, 6, {count}], v : [-1, 1, {count}];"
        )
    };
    for (count, expected) in [("20", SampleSource::Blocks), ("4000", SampleSource::Kernel)] {
        let scene = scene(&source(count));
        let request = Wanted {
            backend: Backend::Gpu,
            ..Wanted::space([16, 16])
        };
        let plan = request.plan(&scene, &ParamValues::initial(&scene));
        assert_eq!(plan.objects[0].source, expected, "{count}²");
    }
}

#[test]
fn the_plan_of_points_names_what_is_left_out() {
    let scene = scene(POINTS);
    let plan = Wanted::space([16, 16]).plan(&scene, &ParamValues::initial(&scene));
    assert_eq!(plan.painters(), [Painter::Points].into());
    assert_eq!(plan.objects[0].instances, 5);
    assert_eq!(plan.objects[0].samples, 5);
    for left_out in ["surface", "curve", "vector", "resolve pass", "sampler"] {
        assert!(
            plan.left_out
                .iter()
                .any(|sentence| sentence.contains(left_out)),
            "{left_out}: {:?}",
            plan.left_out
        );
    }
}

#[test]
fn explain_speaks_of_every_object_and_of_what_is_left_out() {
    let run = geotrace(["explain", "-"]).input(POINTS).run();
    run.expect_status(0);
    for word in ["p", "no surface pipeline", "no resolve pass", "sampler"] {
        run.expect_text(word);
    }
    for example in examples::all() {
        let run = geotrace([Path::new("explain"), &example.path]).run();
        run.expect_status(0);
        let scene = scene(&example.source);
        for object in &scene.objects {
            run.expect_text(&object.name);
        }
    }
}

#[test]
fn explain_counts_the_operations_of_all_derivatives() {
    let run = geotrace(["explain", "--format", "json"])
        .argument(&examples::one("sphere").path)
        .run();
    let json = run.expect_status(0).json();
    let count = find(&json, "derivative_operations").and_then(serde_json::Value::as_u64);
    let count = count.unwrap_or_else(|| panic!("no count in {json}"));
    println!("operations for all derivatives on the sphere: {count}");
    // Shared subexpressions are computed once.
    assert!((1..=100).contains(&count), "{count}");
}

#[test]
fn explain_counts_the_operations_of_a_solids_derivatives() {
    let source = "solid ball(x,y,z) = x^2+y^2+z^2-1; function wave(x,y,z) = sin x sin y - z; solid s = ball & wave;
                  camera eye = (0,1,0) @ (0,-4,0);";
    let run = geotrace(["explain", "-"]).input(source).run();
    run.expect_status(0);
    run.expect_text("solid s: ends of geodesics from");
    run.expect_text("operations for all derivatives");
    let plan = |source: &str| {
        let run = geotrace(["explain", "--format", "json", "-"])
            .input(source)
            .run();
        let json = run.expect_status(0).json();
        find(&json, "derivative_operations").and_then(serde_json::Value::as_u64)
    };
    // 2x, 2y, 2z.
    let ball = plan("solid ball(x,y,z) = x^2+y^2+z^2-1;");
    assert_eq!(ball, Some(3));
    // The leaf that has the most counts.
    assert!(plan(source) > ball);
}

/// The first value under a key, at any depth.
fn find<'a>(json: &'a serde_json::Value, key: &str) -> Option<&'a serde_json::Value> {
    match json {
        serde_json::Value::Object(map) => map
            .get(key)
            .or_else(|| map.values().find_map(|value| find(value, key))),
        serde_json::Value::Array(list) => list.iter().find_map(|value| find(value, key)),
        _ => None,
    }
}
