//! A picture pays only for what it needs.

use crate::scenes::{Wanted, scene};
use render::plan::{Built, Painter, SampleSource};
use render::{Backend, PictureMethod};
use scene::ObjectId;
use scene::ParamValues;

fn built(source: &str, request: &Wanted) -> Built {
    let scene = scene(source);
    request.plan(&scene, &ParamValues::initial(&scene)).built()
}

const SURFACE: &str = "surface s(u,v) = (u, v, u v), u : [0,1], v : [0,1];";

#[test]
fn points_alone_build_one_pipeline_and_nothing_else() {
    let expected = Built {
        draw_pipelines: 1,
        ..Built::default()
    };
    assert_eq!(
        built(
            "point p = (1,2,3); point q = (0,0,0);",
            &Wanted::space([64, 64])
        ),
        expected
    );
}

#[test]
fn surfaces_bring_a_sampler_and_their_distinct_images() {
    let source = format!(
        "{SURFACE} surface t(u,v) = (u, v, 1), u : [0,1], v : [0,1]; curve c(x) = (x,0,0), x : [0,1];"
    );
    let expected = Built {
        draw_pipelines: 2,
        textures: 1,
        samplers: 1,
        ..Built::default()
    };
    assert_eq!(built(&source, &Wanted::space([64, 64])), expected);
}

#[test]
fn a_geodesic_view_builds_no_painter() {
    let request = Wanted::geodesic(ObjectId::new(0), [64, 64]);
    let expected = Built {
        resolve_pipelines: 1,
        textures: 1,
        samplers: 1,
        ..Built::default()
    };
    assert_eq!(
        built(&format!("{SURFACE} point p = (0,0,0);"), &request),
        expected
    );
}

#[test]
fn a_geodesic_view_names_each_thing_that_it_leaves_out() {
    let scene = scene(&format!("{SURFACE} point p = (0,0,0);"));
    let params = ParamValues::initial(&scene);
    let mut request = Wanted::geodesic(ObjectId::new(0), [64, 64]);
    let choose = |request: &mut Wanted, chosen| {
        request.inside().method = chosen;
    };
    let parts = [
        "no point pipeline",
        "no vector pipeline",
        "no curve pipeline",
        "no surface pipeline",
        "no sampling kernel",
    ];
    for method in [PictureMethod::Fan, PictureMethod::Rk4Pixel] {
        choose(&mut request, method);
        let left_out = request.plan(&scene, &params).left_out;
        assert_eq!(left_out.len(), parts.len(), "{left_out:?}");
        for (sentence, part) in left_out.iter().zip(parts) {
            assert!(sentence.starts_with(part), "{sentence}");
        }
        assert_eq!(
            left_out[4],
            "no sampling kernel: a geodesic view has no samples"
        );
    }
}

#[test]
fn the_software_path_builds_nothing_on_a_gpu() {
    let request = Wanted {
        backend: Backend::Software,
        ..Wanted::space([64, 64])
    };
    assert_eq!(built(SURFACE, &request), Built::default());
}

#[test]
fn an_empty_scene_builds_nothing() {
    assert_eq!(built("", &Wanted::space([64, 64])), Built::default());
}

#[test]
fn an_object_is_planned_with_its_uniforms_samples_and_operations() {
    let scene = scene(
        "param a : [1,2]; param b : [1,2]; grid k : [0,1,5]; curve c(t) = b(t, k, 0), t : [0,1,20];",
    );
    let plan = Wanted::space([64, 64]).plan(&scene, &ParamValues::initial(&scene));
    let [object] = &plan.objects[..] else {
        panic!("one object")
    };
    assert_eq!(object.painter, Painter::Curves);
    assert_eq!((object.instances, object.samples), (5, 100));
    assert_eq!(object.source, SampleSource::Blocks);
    assert_eq!(object.uniforms, [1, 2]);
    assert_eq!(object.operations, 2);
}
