//! The GPU path against f64 and against the software path. These tests need a GPU or software Vulkan
//! (`mesa-vulkan-drivers` on Debian); without one they fail rather than pass unrun.

use std::sync::Arc;

use crate::scenes::Wanted;
use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use render::bounds::Bounds;
use render::placement::Placement;
use render::plan::Built;
use render::sample::{Samples, sample};
use render::viewpoint::Viewpoint;
use render::{Backend, BackendUsed, PictureMethod, RenderError, gpu};
use scene::ParamValues;
use scene::{ObjectId, Scene};

const SCENE: &str = "
    function f(u, v) = (sin(pi v) cos(2 pi u), sin(pi v) sin(2 pi u), cos(pi v));
    param a : [0.3, 1];
    grid k : [-1, 1, 5], [0, 1, 3];
    point p = (a, k_1, k_2);
    curve c(t) = f(t, a), t : [0, 1, 60];
    vector w = (k_1, k_2, 0.3) @ (k_2, a, k_1);
    surface s(u, v) = 0.9 f(u, v), u : [0, 1, 40], v : [0, 1, 30];
";

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

fn with(mut request: Wanted, backend: Backend) -> Wanted {
    request.backend = backend;
    request
}

/// The mean difference of two pictures' bytes, and the share of pixels that differ by more than 24 in a channel.
fn difference(a: &image::RgbaImage, b: &image::RgbaImage) -> (f64, f64) {
    assert_eq!(a.dimensions(), b.dimensions());
    let (mut sum, mut far) = (0.0, 0);
    for (p, q) in a.pixels().zip(b.pixels()) {
        let off = [0, 1, 2].map(|k| f64::from(p.0[k].abs_diff(q.0[k])));
        sum += off.iter().sum::<f64>();
        far += usize::from(off.iter().any(|&d| d > 24.0));
    }
    let pixels = f64::from(a.width()) * f64::from(a.height());
    (sum / (3.0 * pixels), far as f64 / pixels)
}

#[test]
fn every_operation_agrees_with_f64() {
    let mut graph = Graph::default();
    let [x, y] = [Input::Variable(0), Input::Uniform(5)].map(|input| graph.input(input));
    let mut roots: Vec<NodeId> = Vec::new();
    let mut names = Vec::new();
    let powers = [-9, -3, 3, 4, 5, 8, 13].map(expr::ops::Operation::Power);
    for operation in expr::ops::Operation::all().chain(powers) {
        let operands = if operation.arity() == 1 {
            vec![x]
        } else {
            vec![x, y]
        };
        roots.extend(operation.build(&mut graph, &operands));
        names.push(operation);
    }
    assert_eq!(roots.len(), names.len());
    let numbers = [
        -2.5f32, -2.0, -1.0, -0.75, -0.125, 0.0, 0.125, 0.5, 1.0, 1.5, 3.0,
    ];
    let rows: Vec<Vec<f32>> = numbers
        .iter()
        .flat_map(|&a| numbers.map(|b| vec![a, b]))
        .collect();
    let found = gpu::evaluate(&graph, &roots, &rows).expect("a GPU or software Vulkan");
    let tape = Tape::new(&graph, &roots);
    let mut out = vec![0.0; roots.len()];
    let mut wrong = Vec::new();
    for (row, found) in rows.iter().zip(&found) {
        tape.eval(
            &mut Registers::default(),
            &[row[0].into(), row[1].into()],
            &mut out,
        );
        for ((name, &expected), &found) in names.iter().zip(&out).zip(found) {
            // WGSL promises sines to 2⁻¹¹ and arcs to 4096 units in the last place.
            let close = (f64::from(found) - expected).abs() <= 1e-3 * expected.abs().max(1.0);
            let same = if expected.is_finite() {
                close
            } else {
                !found.is_finite()
            };
            if !same {
                wrong.push(format!(
                    "{name:?} of {row:?}: {found} instead of {expected}"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_row_of_the_wrong_length_is_refused() {
    let mut graph = Graph::default();
    let x = graph.input(Input::Variable(0));
    let error = gpu::evaluate(&graph, &[x], &[vec![1.0], vec![1.0, 2.0]]).unwrap_err();
    assert_eq!(
        error,
        gpu::EvaluateError::Row {
            row: 1,
            expected: 1,
            given: 2
        }
    );
}

#[test]
fn constants_need_no_inputs() {
    let mut graph = Graph::default();
    let values = [0.1, -2.5, std::f64::consts::TAU, 1e-20, 3e38];
    let roots = values.map(|value| graph.constant(value));
    let found = gpu::evaluate(&graph, &roots, &[vec![], vec![]]).expect("a GPU or software Vulkan");
    assert_eq!(found, vec![values.map(|value| value as f32).to_vec(); 2]);
}

#[test]
fn a_picture_builds_what_its_plan_says_and_nothing_else() {
    let (scene, params) = compiled(SCENE);
    let all = Built {
        draw_pipelines: 4,
        textures: 1,
        samplers: 1,
        ..Built::default()
    };
    let inside = Built {
        resolve_pipelines: 1,
        textures: 1,
        samplers: 1,
        ..Built::default()
    };
    let seen = |chosen: PictureMethod| {
        let mut request = Wanted::geodesic(ObjectId::new(3), [48, 48]);
        request.inside().method = chosen;
        request
    };
    for (request, expected) in [
        (Wanted::space([48, 48]), all),
        (seen(PictureMethod::Fan), inside),
        (seen(PictureMethod::FanLinear), inside),
        (seen(PictureMethod::Adaptive), Built::default()),
        (seen(PictureMethod::Rk4Pixel), Built::default()),
    ] {
        let request = with(request, Backend::Gpu);
        let (_, built) = request.draw_counted(&scene, &params).expect("a picture");
        assert_eq!(built, request.plan(&scene, &params).built());
        assert_eq!(built, expected);
    }
}

#[test]
fn ends_pixel_by_pixel_are_computed_and_coloured_as_by_the_software_path() {
    let (scene, params) = compiled(SCENE);
    for chosen in [PictureMethod::Adaptive, PictureMethod::Rk4Pixel] {
        let mut request = with(Wanted::geodesic(ObjectId::new(3), [48, 48]), Backend::Gpu);
        request.inside().method = chosen;
        let (picture, built) = request.draw_counted(&scene, &params).expect("a picture");
        assert_eq!(built, request.plan(&scene, &params).built());
        let request = with(request, Backend::Software);
        let software = request.draw(&scene, &params).expect("a picture");
        assert!(picture.image == software.image, "{chosen:?}");
        assert_eq!(picture.notes, software.notes);
    }
}

#[test]
fn points_alone_build_no_surface_pipeline_no_resolve_pass_and_no_sampler() {
    let (scene, params) = compiled("point p = (1, 2, 3);");
    let request = with(Wanted::space([32, 32]), Backend::Gpu);
    let (_, built) = request.draw_counted(&scene, &params).expect("a picture");
    assert_eq!(
        built,
        Built {
            draw_pipelines: 1,
            ..Built::default()
        }
    );
}

#[test]
fn both_backends_draw_the_same_picture_in_space() {
    let (scene, params) = compiled(SCENE);
    for (size, mean_bound) in [([256, 256], 0.6), ([150, 90], 1.2), ([1, 1], 8.0)] {
        let draw = |backend| {
            let camera = Viewpoint::new([2.4, -4.2, 2.4], [0.0; 3]);
            let wanted = Wanted::space(size).with_space(|space| space.camera = camera);
            with(wanted, backend)
                .draw(&scene, &params)
                .expect("a picture")
        };
        let (gpu, software) = (draw(Backend::Gpu), draw(Backend::Software));
        assert!(
            matches!(gpu.backend, BackendUsed::Gpu(_)),
            "{}",
            gpu.backend
        );
        assert_eq!(gpu.notes, software.notes);
        let (mean, far) = difference(&gpu.image, &software.image);
        println!(
            "{size:?}: mean difference {mean:.3}, {:.3} % of the pixels by more than 24",
            100.0 * far
        );
        assert!(
            mean < mean_bound && far < 0.025,
            "{size:?}: mean {mean}, far {far}"
        );
    }
}

#[test]
fn both_backends_leave_poles_and_what_is_undefined_open() {
    let text = "curve c(t) = (t, tan t, 3), t : [-4, 4, 200];
        curve d(t) = (t, t/abs(t), 2), t : [-4, 4, 200];
        surface s(u,v) = (u, v, 1/(u + v)), u : [-2, 2, 61], v : [-2, 2, 61];
        surface w(u,v) = (u, v, -3 + sqrt(1 - u v)), u : [-2, 2, 61], v : [-2, 2, 61];";
    let (scene, params) = compiled(text);
    let draw = |backend| {
        with(Wanted::space([256, 256]), backend)
            .draw(&scene, &params)
            .expect("a picture")
    };
    let (gpu, software) = (draw(Backend::Gpu), draw(Backend::Software));
    assert_eq!(gpu.notes, software.notes);
    let (mean, far) = difference(&gpu.image, &software.image);
    assert!(mean < 0.8 && far < 0.012, "mean {mean}, far {far}");
}

#[test]
fn a_picture_of_several_tiles_has_no_seams() {
    let (scene, params) = compiled(SCENE);
    let size = [2200, 40];
    let draw = |backend| {
        with(Wanted::space(size), backend)
            .draw(&scene, &params)
            .expect("a picture")
    };
    let (mean, far) = difference(&draw(Backend::Gpu).image, &draw(Backend::Software).image);
    assert!(mean < 0.5 && far < 0.01, "mean {mean}, far {far}");
}

#[test]
fn samples_of_generated_kernels_agree_with_f64() {
    let (scene, params) = compiled(SCENE);
    let Placement { centre, radius } = Bounds::of(&scene, &params).placement;
    let placement = Placement { centre, radius };
    let close = |a: &[f32; 3], b: &[f32; 3], bound: f32| {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < bound)
    };
    for (index, object) in scene.objects.iter().enumerate() {
        let id = ObjectId::new(index);
        let found = gpu::kernel_samples(&scene, &params, id, &placement)
            .expect("a GPU")
            .expect("small");
        match (found, sample(&scene, &params, id, &placement)) {
            (Samples::Points(a), Samples::Points(b)) => {
                assert_eq!(a.len(), b.len());
                let same = a
                    .iter()
                    .zip(&b)
                    .all(|(a, b)| a.defined == b.defined && close(&a.position, &b.position, 1e-4));
                assert!(same, "{}", object.name);
            }
            (
                Samples::Curves {
                    count: m,
                    samples: a,
                },
                Samples::Curves {
                    count: n,
                    samples: b,
                },
            ) => {
                assert_eq!((m, a.len()), (n, b.len()));
                let same = a
                    .iter()
                    .zip(&b)
                    .all(|(a, b)| a.defined == b.defined && close(&a.position, &b.position, 1e-4));
                assert!(same, "{}", object.name);
            }
            (Samples::Vectors(a), Samples::Vectors(b)) => {
                assert_eq!(a.len(), b.len());
                let same = a.iter().zip(&b).all(|(a, b)| {
                    a.defined == b.defined
                        && close(&a.origin, &b.origin, 1e-4)
                        && close(&a.direction, &b.direction, 1e-4)
                });
                assert!(same, "{}", object.name);
            }
            (
                Samples::Surfaces {
                    count: m,
                    samples: a,
                },
                Samples::Surfaces {
                    count: n,
                    samples: b,
                },
            ) => {
                assert_eq!((m, a.len()), (n, b.len()));
                for (a, b) in a.iter().zip(&b) {
                    assert!(
                        a.defined == b.defined && close(&a.position, &b.position, 1e-4),
                        "{a:?} {b:?}"
                    );
                    assert!(close(&a.normal, &b.normal, 5e-3), "{a:?} {b:?}");
                }
            }
            (a, b) => panic!("{}: {a:?} is not of the kind of {b:?}", object.name),
        }
    }
}

#[test]
fn what_is_undefined_is_marked_by_the_kernel_and_noted() {
    let (scene, params) = compiled("curve c(t) = (t, sqrt t, log(t + 0.5)), t : [-1, 1, 81];");
    let placement = Bounds::of(&scene, &params).placement;
    let found = gpu::kernel_samples(&scene, &params, ObjectId::new(0), &placement)
        .expect("a GPU")
        .expect("small");
    let expected = sample(&scene, &params, ObjectId::new(0), &placement);
    assert_eq!(found.undefined(), expected.undefined());
    assert!(found.undefined().1 > 30);
}

#[test]
fn both_backends_see_the_same_from_inside() {
    let surfaces = [
        (
            "sphere",
            "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];",
            3.3,
        ),
        (
            "torus",
            "surface s(u, v) = ((1 + 0.4 cos v) cos u, (1 + 0.4 cos v) sin u, 0.4 sin v),
            u : [0, 2pi], v : [0, 2pi];",
            2.0,
        ),
        (
            "cone",
            "surface s(u, v) = (v cos u, v sin u, 2 v), u : [0, 2pi], v : [0, 1];",
            1.5,
        ),
        (
            "strip",
            "surface s(u, v) = ((2 + v cos(u/2)) cos u, (2 + v cos(u/2)) sin u, v sin(u/2)),
            u : [0, 2pi], v : [-1, 1];",
            2.0,
        ),
        (
            "saddle",
            "surface s(u, v) = (u, v, u^3 - 3u v^2), u : [-1, 1], v : [-1, 1];",
            1.0,
        ),
    ];
    for (name, text, distance) in surfaces {
        let (scene, params) = compiled(text);
        let mut request = Wanted::geodesic(ObjectId::new(0), [128, 128]);
        request.inside().camera.zoom = Some(distance);
        let draw = |backend| {
            with(request.clone(), backend)
                .draw(&scene, &params)
                .expect("a picture")
        };
        let (gpu, software) = (draw(Backend::Gpu), draw(Backend::Software));
        let (mean, far) = difference(&gpu.image, &software.image);
        println!(
            "{name}: mean difference {mean:.3}, {:.3} % of the pixels by more than 24",
            100.0 * far
        );
        assert!(mean < 1.0 && far < 0.006, "{name}: mean {mean}, far {far}");
    }
}

#[test]
fn a_machine_without_a_driver_says_so_and_takes_the_software_path() {
    // In a process of its own: a device is opened once a process.
    if std::env::var_os("GEOTRACE_TEST_NO_GPU").is_none() {
        let this = std::env::current_exe().expect("the test's program");
        let name = "gpu::a_machine_without_a_driver_says_so_and_takes_the_software_path";
        let output = std::process::Command::new(this)
            .args(["--exact", name, "--nocapture"])
            .env("GEOTRACE_TEST_NO_GPU", "1")
            .env("VK_DRIVER_FILES", "/nowhere.json")
            .env("VK_ICD_FILENAMES", "/nowhere.json")
            .output()
            .expect("it starts");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(
            output.status.success(),
            "{text}{}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert!(text.contains("1 passed"), "{text}");
        return;
    }
    let (scene, params) = compiled("point p = (1, 2, 3);");
    let request = with(Wanted::space([16, 16]), Backend::Gpu);
    let error = request.draw(&scene, &params).unwrap_err();
    assert!(matches!(error, RenderError::NoGpu { .. }), "{error}");
    let picture = with(request, Backend::Auto)
        .draw(&scene, &params)
        .expect("a picture");
    assert!(
        picture
            .backend
            .to_string()
            .starts_with("software, because "),
        "{}",
        picture.backend
    );
}
