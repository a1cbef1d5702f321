//! A renderer's pictures against those that are made from scratch, and what it makes for them, by the software path and on a
//! GPU. The latter needs one, or software Vulkan (`mesa-vulkan-drivers` on Debian); without it these tests fail rather
//! than pass unrun.

use std::path::PathBuf;
use std::sync::Arc;

use crate::scenes::{Drawn, Wanted};
use image::RgbaImage;
use render::counters::WorkCounters;
use render::gpu::Gpu;
use render::gpu::Pixels;
use render::point::PixelPoint;
use render::request::{Overlays, Spacing};
use render::viewpoint::{Pose, Viewpoint};
use render::{Backend, RenderError, RenderedImage, Renderer};
use scene::ParamValues;
use scene::{ObjectId, Scene};

const SIZE: [u32; 2] = [120, 90];

fn compiled(text: &str) -> (Arc<Scene>, ParamValues) {
    let scene = crate::scenes::scene(text);
    let params = ParamValues::initial(&scene);
    (scene, params)
}

fn examples() -> Vec<(String, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut all: Vec<(String, String)> = std::fs::read_dir(folder)
        .expect("examples/ is readable")
        .map(|entry| entry.expect("examples/ is readable").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "gtr"))
        .map(|path| {
            let text = std::fs::read_to_string(&path).expect("an example is UTF-8");
            (path.display().to_string(), text)
        })
        .collect();
    all.sort();
    assert!(all.len() >= 16);
    all
}

/// Twenty surfaces, of which each reads its own param; `edited` has another expression.
fn twenty(edited: Option<usize>) -> String {
    (0..20)
        .map(|k| {
            let bump = if edited == Some(k) { "0.3 u v" } else { "0.2 u v" };
            format!(
                "param a{k} : [0, 1];\n\
                 surface s{k}(u, v) = (u + {k}, v, {bump} + 0.1 a{k}), u : [0, 1, 12], v : [0, 1, 12];\n"
            )
        })
        .collect()
}

const BACKENDS: [Backend; 2] = [Backend::Software, Backend::Gpu];

fn renderer(backend: Backend) -> Renderer {
    match backend {
        Backend::Gpu => Renderer::on_gpu(Gpu::shared().expect("a GPU or software Vulkan")),
        _ => Renderer::software(),
    }
}

fn image(renderer: &Renderer, drawn: &RenderedImage) -> RgbaImage {
    match (&drawn.image, renderer.gpu()) {
        (Pixels::Image(image), _) => image.clone(),
        (Pixels::Texture(canvas), Some(gpu)) => canvas.read(gpu).expect("the device is there"),
        (Pixels::Texture(_), None) => panic!("a canvas without a device"),
    }
}

/// The picture that is made by itself.
fn alone(backend: Backend, scene: &Arc<Scene>, params: &ParamValues, request: &Wanted) -> Drawn {
    let request = Wanted {
        backend,
        ..request.clone()
    };
    request.draw(scene, params)
}

fn seen_from(eye: [f64; 3]) -> Wanted {
    let mut request = Wanted::space(SIZE);
    request.in_space().camera = Viewpoint::new(eye, [0.0; 3]);
    request
}

/// The difference of two counters.
fn made(before: WorkCounters, after: WorkCounters) -> WorkCounters {
    WorkCounters {
        pictures: after.pictures - before.pictures,
        pipelines: after.pipelines - before.pipelines,
        sampled: after.sampled - before.sampled,
        followed: after.followed - before.followed,
        ends: after.ends - before.ends,
        distances: after.distances - before.distances,
        worlds: after.worlds - before.worlds,
        rays: after.rays - before.rays,
        traced: after.traced - before.traced,
        retraced: after.retraced - before.retraced,
    }
}

/// A small generator (Knuth's constants): the same numbers on every run.
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

#[test]
fn a_stage_draws_what_a_single_picture_shows() {
    for (name, text) in examples() {
        let (scene, params) = compiled(&text);
        let mut requests = vec![Wanted::space(SIZE)];
        let inside = (0..).zip(&scene.objects);
        let inside = inside.filter(|(_, object)| object.shape.manifold().is_some());
        requests.extend(inside.map(|(k, _)| Wanted::geodesic(ObjectId::new(k), [49, 40])));
        for backend in BACKENDS {
            let mut renderer = renderer(backend);
            for request in &requests {
                let drawn = renderer.draw(&request.of(&scene, &params));
                match alone(backend, &scene, &params, request) {
                    Ok(picture) => {
                        let drawn = drawn.unwrap_or_else(|error| panic!("{name}: {error}"));
                        assert_eq!(drawn.notes, picture.notes, "{name}");
                        assert_eq!(drawn.overlays, picture.overlays, "{name}");
                        let same = image(&renderer, &drawn) == picture.image;
                        assert!(same, "{name}, {backend:?}: {:?}", request.view);
                    }
                    Err(error) => assert_eq!(drawn.err(), Some(error), "{name}"),
                }
            }
        }
    }
}

#[test]
fn a_camera_move_and_the_same_request_again_sample_nothing() {
    for backend in BACKENDS {
        let (scene, params) = compiled(&twenty(None));
        let mut renderer = renderer(backend);
        renderer
            .draw(&Wanted::space(SIZE).of(&scene, &params))
            .expect("a picture");
        let before = renderer.counters();
        assert_eq!((before.sampled, before.followed), (20, 0));
        for request in [
            seen_from([30.0, 20.0, 10.0]),
            seen_from([-30.0, 20.0, 10.0]),
            Wanted::space([60, 60]),
            Wanted::space(SIZE),
        ] {
            renderer
                .draw(&request.of(&scene, &params))
                .expect("a picture");
        }
        let expected = WorkCounters {
            pictures: 4,
            ..WorkCounters::default()
        };
        assert_eq!(made(before, renderer.counters()), expected);
    }
}

#[test]
fn a_param_samples_only_what_reads_it() {
    for backend in BACKENDS {
        let (scene, mut params) = compiled(&twenty(None));
        let mut renderer = renderer(backend);
        let request = Wanted::space(SIZE);
        renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture");
        for step in 1..=10 {
            let before = renderer.counters();
            params
                .set(&scene, "a7", &[0.1 * f64::from(step)])
                .expect("inside the interval");
            renderer
                .draw(&request.of(&scene, &params))
                .expect("a picture");
            let expected = WorkCounters {
                pictures: 1,
                sampled: 1,
                ..WorkCounters::default()
            };
            assert_eq!(made(before, renderer.counters()), expected);
        }
    }
}

#[test]
fn an_edit_of_one_of_twenty_surfaces_samples_one() {
    for backend in BACKENDS {
        let (scene, params) = compiled(&twenty(None));
        let (edited, _) = compiled(&twenty(Some(3)));
        // The same surfaces, all further down the text and with other names for what they read.
        let moved = format!(
            "param b : [0, 1], [0, 1]; grid k : [0, 1, 3];\n{}",
            twenty(None)
        );
        let (moved, other) = compiled(&moved);
        let mut renderer = renderer(backend);
        let request = Wanted::space(SIZE);
        renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture");
        for (scene, params, sampled) in [
            (&edited, &params, 1),
            // The old one is still kept.
            (&scene, &params, 0),
            (&moved, &other, 0),
        ] {
            let before = renderer.counters();
            renderer
                .draw(&request.of(scene, params))
                .expect("a picture");
            assert_eq!(made(before, renderer.counters()).sampled, sampled);
        }
    }
}

#[test]
fn equal_objects_are_sampled_once_and_different_ones_apart() {
    for backend in BACKENDS {
        let text = "param a : [0, 1]; param b : [0, 1]; grid k : [0, 1, 3]; grid m : [0, 1, 4];
        point p = (a, 0, 0); point q = (a, 0, 0); point r = (b, 0, 0);
        point s = (k, 0, 0); point n = (m, 0, 0); point h = (k, m, 0); point w = (m, k, 0);
        vector x = (1, 2, 3) @ (4, 5, 6); vector y = (4, 5, 6) @ (1, 2, 3);
        curve c(t) = (t, 0, 0), t : [0, 1, 5]; curve d(t) = (t, 0, 0), t : [0, 1, 6];";
        let (scene, params) = compiled(text);
        let mut renderer = renderer(backend);
        let drawn = renderer
            .draw(&Wanted::space(SIZE).of(&scene, &params))
            .expect("a picture");
        // p, q and r have one value; all others are different.
        assert_eq!(renderer.counters().sampled, 9);
        let picture = alone(backend, &scene, &params, &Wanted::space(SIZE));
        assert!(image(&renderer, &drawn) == picture.expect("a picture").image);
    }
}

#[test]
fn geodesics_are_followed_again_only_for_another_camera_or_another_surface() {
    for backend in BACKENDS {
        let text = "param a : [1, 2]; param b : [0, 1];
        surface s(u, v) = (a cos u, a sin u, v), u : [0, 2pi, 30], v : [-3, 3, 30];
        point p = (b, 0, 0);";
        let (scene, mut params) = compiled(text);
        let mut renderer = renderer(backend);
        let request = Wanted::geodesic(ObjectId::new(0), [40, 40]);
        let walk = |renderer: &mut Renderer, params: &ParamValues, request: &Wanted, followed| {
            let before = renderer.counters();
            let drawn = renderer
                .draw(&request.of(&scene, params))
                .expect("a picture");
            let now = made(before, renderer.counters());
            assert_eq!((now.followed, now.sampled), (followed, 0));
            let picture = alone(backend, &scene, params, request).expect("a picture");
            assert_eq!(drawn.notes, picture.notes);
            assert!(image(renderer, &drawn) == picture.image);
        };
        walk(&mut renderer, &params, &request, 1);
        walk(&mut renderer, &params, &request, 0);
        let mut painted = request.clone();
        painted.colours = vec![(ObjectId::new(0), [255, 0, 0])];
        walk(&mut renderer, &params, &painted, 0);
        params.set(&scene, "b", &[0.5]).expect("inside");
        walk(&mut renderer, &params, &request, 0);
        params.set(&scene, "a", &[1.5]).expect("inside");
        walk(&mut renderer, &params, &request, 1);
        let mut turned = request.clone();
        turned.inside().camera.pose = Pose::At {
            at: None,
            angle: 0.5,
            mirrored: false,
        };
        walk(&mut renderer, &params, &turned, 1);
        walk(&mut renderer, &params, &request, 0);
    }
}

#[test]
fn the_ends_of_a_picture_from_inside_are_computed_once_whatever_lies_over_it() {
    let text = "surface s(u,v) = ((1 + 0.4cos v) cos u, (1 + 0.4cos v) sin u, 0.4sin v), \
                u : [0, 2pi], v : [0, 2pi];\n\
                geodesic g(t) : s = (1, 0.3) @ (1, 1), t : [0, 9];\n";
    let (scene, params) = compiled(text);
    let mut renderer = Renderer::software();
    let mut made = |overlays: Overlays| {
        let request = Wanted {
            overlays,
            ..Wanted::geodesic(ObjectId::new(0), SIZE)
        };
        let before = renderer.counters();
        renderer
            .draw(&request.of(&scene, &params))
            .expect("it can be drawn");
        made(before, renderer.counters())
    };
    let once = u64::from(SIZE[0] * SIZE[1]);
    let plain = made(Overlays::default());
    assert_eq!((plain.followed, plain.ends), (1, once));
    assert!(plain.distances > 0, "no line was drawn");
    let over = made(Overlays {
        legend: true,
        wavefronts: Some(Spacing::Auto),
        error: true,
        ..Overlays::default()
    });
    assert_eq!((over.followed, over.ends), (0, once));
    // These look at places all over the picture: for them all ends are put down once more.
    let global = made(Overlays {
        conjugate_points: true,
        cut_locus: true,
        ..Overlays::default()
    });
    assert_eq!((global.followed, global.ends), (0, 2 * once));
}

#[test]
fn a_view_that_moves_is_coarse_and_at_rest_as_fine_as_if_it_never_had() {
    let text = "surface s(u,v) = ((1 + 0.4cos v) cos u, (1 + 0.4cos v) sin u, 0.4sin v), \
                u : [0, 2pi], v : [0, 2pi];\n\
                geodesic g(t) : s = (1, 0.3) @ (1, 1), t : [0, 9];\n";
    let (scene, params) = compiled(text);
    let fine = Wanted::geodesic(ObjectId::new(0), SIZE);
    let coarse = Wanted {
        moving: true,
        ..fine.clone()
    };
    let mut renderer = Renderer::software();
    let mut draw = |request: &Wanted| {
        let drawn = renderer
            .draw(&request.of(&scene, &params))
            .expect("it can be drawn");
        let (work, estimate) = drawn.geodesics.expect("it is a geodesic view");
        let Pixels::Image(image) = drawn.image else {
            panic!("the software path draws in memory");
        };
        (
            image,
            work.evaluations,
            estimate.expect("a fan tells its error").max,
        )
    };
    let (moving, few, far) = draw(&coarse);
    let (resting, many, near) = draw(&fine);
    assert!(few < many, "{few} evaluations, at rest {many}");
    assert!(far <= 0.5 && near <= 0.1, "{far} pixels, at rest {near}");
    assert!(moving != resting, "coarse and fine are the same picture");
    // Neither takes the other's place among what is kept.
    assert_eq!(draw(&coarse).0, moving);
    assert_eq!(draw(&fine).0, resting);
    let mut other = Renderer::software();
    let alone = other
        .draw(&fine.of(&scene, &params))
        .expect("it can be drawn");
    let Pixels::Image(alone) = alone.image else {
        panic!("the software path draws in memory");
    };
    assert_eq!(alone, resting);
}

#[test]
fn the_first_camera_stays_while_the_scene_moves_a_little_and_follows_when_it_leaves() {
    let text = "param a : [0, 100];
        surface s(u, v) = (u + 0.01 a, v, 0.1 u v), u : [0, 1, 12], v : [0, 1, 12];
        point p = (0.5, 0.5, 0);";
    let (scene, mut params) = compiled(text);
    let mut renderer = Renderer::software();
    let request = Wanted::space(SIZE);
    let first = renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    params.set(&scene, "a", &[10.0]).expect("inside");
    let near = renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    assert_eq!(
        (first.placement, first.eye, first.axes),
        (near.placement, near.eye, near.axes)
    );
    let before = renderer.counters();
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    assert_eq!(made(before, renderer.counters()).sampled, 2);
    params.set(&scene, "a", &[20.0]).expect("inside");
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    assert_eq!(
        made(before, renderer.counters()).sampled,
        3,
        "the point stays"
    );
    let mut far = String::from(text);
    far.push_str("point q = (50, 0, 0);");
    let (scene, params) = compiled(&far);
    let away = renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    assert!(away.placement.radius > 10.0 * near.placement.radius);
    renderer.set_bounds(None);
    let bounds = render::bounds::Bounds::of(&scene, &params);
    renderer
        .camera(&request.of(&scene, &params))
        .expect("a camera");
    assert_eq!(renderer.bounds().as_deref(), Some(&bounds));
}

#[test]
fn a_solid_is_prepared_once_for_its_geodesic_views() {
    let (scene, params) = compiled("solid b(x, y, z) = x^2 + y^2 + z^2 - 1, color : (x^2, 0, 1);");
    let mut renderer = Renderer::software();
    for zoom in [0.5, 0.6, 0.7] {
        let mut inside = Wanted::geodesic(ObjectId::new(0), [40, 30]);
        inside.inside().camera.zoom = Some(zoom);
        renderer
            .draw(&inside.of(&scene, &params))
            .expect("a picture");
        // The 3D view has its own.
        let space = Wanted::space(SIZE).of(&scene, &params);
        renderer.draw(&space).expect("a picture");
        assert_eq!(renderer.counters().worlds, 2, "{zoom}");
    }
}

#[test]
fn after_any_edits_moves_and_values_a_picture_is_the_one_from_scratch() {
    for backend in BACKENDS {
        let pieces = [
            "surface s(u, v) = (cos u cos v, cos u sin v, sin u + 0.2 a), u : [-1.5, 1.5, 20], v : [0, 6, 20];",
            "surface r(u, v) = (u, v, u v b), u : [-1, 1, 5], v : [-1, 1, 7];",
            "curve c(t) = (cos t, sin t, a t / 6), t : [0, 6, 50];",
            "point p = (k_1, k_2, b);",
            "vector w = (0, a, 1) @ (k_1, 0, 0);",
            "metric h(u, v) = (1, 0, 1 + u^2), u : [-1, 1, 10], v : [-1, 1, 10];",
            "geodesic g(t) : s = (1, b) @ (0.1, 1), t : [0, 2];",
            "surface q(u, v) = (u, v, 1 / (u - a)), u : [0, 1, 30], v : [0, 1, 30];",
            "solid d(x, y, z) = (x - 2k_1)^2 + y^2 + (z - k_2)^2 - 0.2 - 0.1b;",
            "function f(x, y, z) = x^2 + y^2 + z^2 - 1; solid j = f @ (2, 0, a) \\ d & f @ (2, 0, 0);",
            "solid m = f & f @ (9, 9, 9);",
            "geodesic i(t) : j = (2, 0, 1) @ (1, b, 0), t : [0, 1];",
            "light l = 1 / 0 (1, 1, 1);",
        ];
        // A piece without another one that it reads is an error.
        let reads = [(6, 0), (9, 8), (10, 9), (11, 9)];
        for seed in 0..8 {
            let mut random = Random(seed);
            let mut renderer = self::renderer(backend);
            let mut kept = [true; 13];
            let (mut before, mut last) = ("", 3);
            let (mut scene, mut params) = (None::<Arc<Scene>>, None::<ParamValues>);
            let mut request = Wanted::space(SIZE);
            for step in 0..25 {
                match (&scene, random.below(4)) {
                    (Some(scene), 0) => {
                        let params = params.as_mut().expect("with its scene");
                        match random.below(3) {
                            0 => params.set(scene, "a", &[random.next()]),
                            1 => params.set(scene, "b", &[random.next()]),
                            _ => params.set(scene, "k", &[random.next(), 1.0]),
                        }
                        .expect("inside");
                    }
                    (Some(_), 1) => {
                        let [x, y, z] = [(); 3].map(|()| 8.0 * random.next() - 4.0);
                        request = seen_from([x, y, z + 3.0]);
                    }
                    (Some(scene), 2) => {
                        let inside = |object: &scene::Object| {
                            object.shape.is_surface() || object.name == "j"
                        };
                        let surfaces: Vec<usize> = (0..)
                            .zip(&scene.objects)
                            .filter(|(_, object)| inside(object))
                            .map(|(k, _)| k)
                            .collect();
                        if !surfaces.is_empty() {
                            let surface = surfaces[random.below(surfaces.len())];
                            request = Wanted::geodesic(ObjectId::new(surface), [40, 30]);
                        }
                    }
                    _ => {
                        match random.below(4) {
                            0 => before = ["", "\n\n", "param o = 0.3 : [0, 1]; "][random.below(3)],
                            1 => last = 2 + random.below(3),
                            _ => {
                                let flipped = random.below(13);
                                kept[flipped] = !kept[flipped];
                            }
                        }
                        let mut on = kept;
                        for (piece, read) in reads {
                            on[piece] &= on[read];
                        }
                        let pieces = pieces.iter().zip(on).filter(|(_, on)| *on);
                        let text: String = pieces.map(|(piece, _)| *piece).collect();
                        let params_of_all = [
                            "param a : [0, 1]; param b : [0, 1];",
                            "param b : [0, 1]; param a : [0, 1];",
                        ];
                        let text = format!(
                            "{before}{} grid k : [0, 1, {last}], [0, 1, 2];{text}",
                            params_of_all[random.below(2)]
                        );
                        let (new, opening) = compiled(&text);
                        (scene, params) = (Some(new), Some(opening));
                        if request.view.object().is_some() {
                            request = Wanted::space(SIZE);
                        }
                    }
                }
                let (Some(scene), Some(params)) = (&scene, &params) else {
                    continue;
                };
                let step = format!("seed {seed}, step {step}: {:?}", request.view);
                let request = request.of(scene, params);
                let drawn = renderer.draw(&request);
                let mut fresh = self::renderer(backend);
                fresh.set_bounds(renderer.bounds());
                let expected = fresh.draw(&request);
                match (drawn, expected) {
                    (Ok(drawn), Ok(expected)) => {
                        assert_eq!(drawn.notes, expected.notes, "{step}");
                        let same = image(&renderer, &drawn) == image(&fresh, &expected);
                        assert!(same, "{step}");
                    }
                    (drawn, expected) => {
                        let errors: [Option<RenderError>; 2] = [drawn.err(), expected.err()];
                        assert_eq!(errors[0], errors[1], "{step}");
                    }
                }
                let [width, height] = request.size.map(f64::from);
                for place in [[0.5, 0.5], [0.4, 0.6], [0.6, 0.4]] {
                    let at = PixelPoint([width * place[0], height * place[1]]);
                    let picked = [&mut renderer, &mut fresh].map(|it| it.pick(&request, at));
                    assert_eq!(picked[0], picked[1], "{step}");
                }
            }
        }
    }
}

#[test]
fn pipelines_are_built_for_kinds_of_objects_and_never_again() {
    let (scene, mut params) = compiled(&twenty(None));
    let (edited, _) = compiled(&twenty(Some(3)));
    let mut renderer = renderer(Backend::Gpu);
    let request = Wanted::space(SIZE);
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    assert_eq!(renderer.counters().pipelines, 1, "surfaces alone");
    for step in 0..5 {
        params
            .set(&scene, "a1", &[0.1 * f64::from(step)])
            .expect("inside");
        renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture");
    }
    renderer
        .draw(&seen_from([30.0, 20.0, 10.0]).of(&scene, &params))
        .expect("a picture");
    renderer
        .draw(&request.of(&edited, &params))
        .expect("a picture");
    renderer
        .draw(&Wanted::space([50, 50]).of(&scene, &params))
        .expect("a picture");
    let now = renderer.counters();
    assert_eq!((now.pipelines, now.followed), (1, 0));
    assert_eq!(now.sampled, 20 + 4 + 1);
    // A geodesic view takes one fixed pass, and no kernel of its own.
    for surface in [0, 1, 0] {
        let inside = Wanted::geodesic(ObjectId::new(surface), [40, 40]);
        renderer
            .draw(&inside.of(&scene, &params))
            .expect("a picture");
    }
    let now = renderer.counters();
    assert_eq!((now.pipelines, now.followed), (2, 2));
    let (curves, params) =
        compiled("curve c(t) = (t, t^2, 0), t : [0, 1, 20]; point p = (1, 0, 0);");
    renderer
        .draw(&request.of(&curves, &params))
        .expect("a picture");
    assert_eq!(renderer.counters().pipelines, 4);
}

#[test]
fn a_large_surface_is_drawn_from_blocks_until_its_kernel_is_ready() {
    let waves: String = (1..60)
        .map(|k| format!("+ 0.001 sin({k} u) cos({k} v)"))
        .collect();
    let text = format!(
        "param a : [0, 1];
        surface s(u, v) = (cos u (2 + cos v), sin u (2 + cos v), sin v + a sin(7 u) / 5 {waves}),
            u : [0, 2pi, 1000], v : [0, 2pi, 700];"
    );
    let (scene, mut params) = compiled(&text);
    let request = seen_from([3.0, -5.0, 3.0]);
    let plan = request.plan(&scene, &params);
    assert_eq!(plan.objects[0].source, render::plan::SampleSource::Kernel);
    let mut renderer = renderer(Backend::Gpu);
    let first = renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    let first = image(&renderer, &first);
    let start = std::time::Instant::now();
    while renderer.counters().pipelines < 2 {
        assert!(
            start.elapsed().as_secs() < 120,
            "no kernel: {:?}",
            renderer.counters()
        );
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    // What is there stays; other values come from the kernel, which is not built again.
    let before = renderer.counters();
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    assert_eq!(made(before, renderer.counters()).sampled, 0);
    params.set(&scene, "a", &[0.5]).expect("inside");
    let bumpy = renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    let bumpy = image(&renderer, &bumpy);
    assert_ne!(first, bumpy);
    params.set(&scene, "a", &[1.0]).expect("inside");
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    params.set(&scene, "a", &[0.5]).expect("inside");
    let now = made(before, renderer.counters());
    assert_eq!((now.sampled, now.pipelines), (2, 0));
    let software = alone(Backend::Software, &scene, &params, &request).expect("a picture");
    let off = software.image.as_raw().iter().zip(bumpy.as_raw());
    let off = off.filter(|(a, b)| a.abs_diff(**b) > 24).count();
    assert!(
        off < software.image.as_raw().len() / 40,
        "{off} bytes are off"
    );
    // Another program that reads other params finds the same kernel.
    let (renamed, mut params) = compiled(&format!("param b : [0, 3], [1, 2]; {text}"));
    params.set(&renamed, "a", &[0.25]).expect("inside");
    renderer
        .draw(&request.of(&renamed, &params))
        .expect("a picture");
    let now = made(before, renderer.counters());
    assert_eq!((now.sampled, now.pipelines), (3, 0));
}

/// Waits until no kernel is being built; what has been made then.
fn built(renderer: &Renderer) -> WorkCounters {
    let start = std::time::Instant::now();
    while renderer.is_building() {
        assert!(start.elapsed().as_secs() < 120, "{:?}", renderer.counters());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    renderer.counters()
}

#[test]
fn of_twenty_surfaces_with_kernels_a_param_builds_none_and_an_edit_the_one_that_it_changes() {
    // As though each were large: small ones share the painters' pipelines, and have no other.
    let mut renderer = renderer(Backend::Gpu).with_kernels_from(1);
    let (scene, mut params) = compiled(&twenty(None));
    let request = Wanted::space(SIZE);
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    let first = built(&renderer);
    // A kernel for each surface, and what draws them all.
    assert_eq!((first.pipelines, first.sampled), (20 + 1, 20));
    for step in 1..=10 {
        let value = [0.1 * f64::from(step)];
        params.set(&scene, "a7", &value).expect("inside");
        renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture");
    }
    let dragged = made(first, built(&renderer));
    assert_eq!((dragged.pipelines, dragged.sampled), (0, 10));
    let (edited, opening) = compiled(&twenty(Some(3)));
    // Drawn from blocks until its kernel is there, and by that as soon as a param moves.
    renderer
        .draw(&request.of(&edited, &opening))
        .expect("a picture");
    let after = built(&renderer);
    assert_eq!(made(first, after).pipelines, 1);
    let mut params = opening;
    params.set(&edited, "a3", &[0.5]).expect("inside");
    let drawn = renderer.draw(&request.of(&edited, &params));
    let drawn = image(&renderer, &drawn.expect("a picture"));
    let now = made(after, built(&renderer));
    assert_eq!((now.pipelines, now.sampled), (0, 1));
    let software = alone(Backend::Software, &edited, &params, &request).expect("a picture");
    let off = software.image.as_raw().iter().zip(drawn.as_raw());
    let off = off.filter(|(a, b)| a.abs_diff(**b) > 24).count();
    assert!(off < drawn.as_raw().len() / 40, "{off} bytes are off");
    // Back, and elsewhere in another text: every kernel is known.
    let (moved, other) = compiled(&format!("param b : [0, 1]; {}", twenty(None)));
    for (scene, params) in [(&scene, &ParamValues::initial(&scene)), (&moved, &other)] {
        renderer
            .draw(&request.of(scene, params))
            .expect("a picture");
    }
    assert_eq!(made(after, built(&renderer)).pipelines, 0);
}

#[test]
fn a_canvas_is_drawn_on_again_once_nobody_looks_at_it() {
    let (scene, params) = compiled("point p = (0, 0, 0);");
    let mut renderer = renderer(Backend::Gpu);
    let mut draw = |colour: [u8; 4]| {
        let mut request = Wanted::space([20, 10]);
        request.in_space().background = Some(colour);
        let drawn = renderer
            .draw(&request.of(&scene, &params))
            .expect("a picture");
        match drawn.image {
            Pixels::Texture(canvas) => canvas,
            Pixels::Image(_) => panic!("a picture in memory"),
        }
    };
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    let red = draw([255, 0, 0, 255]);
    let blue = draw([0, 0, 255, 255]);
    assert!(!red.is(&blue));
    let corner =
        |canvas: &render::gpu::Canvas| canvas.read(&gpu).expect("a picture").get_pixel(0, 0).0;
    assert_eq!(
        (corner(&red), corner(&blue)),
        ([255, 0, 0, 255], [0, 0, 255, 255])
    );
    drop(red);
    let clear = draw([0, 255, 0, 128]);
    let again = draw([1, 2, 3, 255]);
    assert!(!clear.is(&blue) && !again.is(&clear));
    assert_eq!(corner(&blue), [0, 0, 255, 255]);
    let [_, green, _, alpha] = corner(&clear);
    assert!(green >= 253 && alpha == 128, "{green} {alpha}");
}

#[test]
fn a_lost_device_is_an_error_and_a_new_stage_goes_on() {
    let (scene, params) = compiled("surface s(u, v) = (u, v, u v), u : [0, 1], v : [0, 1];");
    let gpu = Arc::new(own_gpu());
    let mut renderer = Renderer::on_gpu(gpu.clone());
    let request = Wanted::space(SIZE);
    renderer
        .draw(&request.of(&scene, &params))
        .expect("a picture");
    assert!(!renderer.is_lost());
    gpu.destroy();
    for request in [request.clone(), Wanted::geodesic(ObjectId::new(0), SIZE)] {
        let error = renderer
            .draw(&request.of(&scene, &params))
            .expect_err("the device has gone");
        assert!(matches!(error, RenderError::Gpu(_)), "{error}");
    }
    assert!(renderer.is_lost());
    let mut other = Renderer::software();
    other.set_bounds(renderer.bounds());
    other.draw(&request.of(&scene, &params)).expect("a picture");
}

#[test]
fn a_renderer_that_is_dropped_while_it_builds_kernels_leaves_no_thread_on_its_gpu() {
    let gpu = Arc::new(own_gpu());
    let left = Arc::downgrade(&gpu);
    let mut renderer = Renderer::on_gpu(gpu).with_kernels_from(1);
    let (scene, params) = compiled(&twenty(None));
    renderer
        .draw(&Wanted::space(SIZE).of(&scene, &params))
        .expect("a picture");
    drop(renderer);
    assert!(left.upgrade().is_none());
}

/// A device that no other test uses.
fn own_gpu() -> Gpu {
    Gpu::open().expect("a GPU or software Vulkan")
}
