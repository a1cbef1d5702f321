//! Traced pictures: the GPU's pass against f64. These tests need a GPU or software Vulkan; without it they fail rather than
//! pass unrun.

mod expressions;
mod fields;

use std::path::PathBuf;
use std::sync::Arc;

use image::RgbaImage;
use render::gpu::Gpu;
use render::view::traced::TracedOptions;
use render::{Backend, BackendUsed, PictureRequest, RenderedImage, Renderer, Views};
use scene::{ParamValues, Scene};
use testing::draw::scene;
use testing::examples::repository;

/// The share of pixels that may differ by more than two steps in a channel.
const BOUND: f64 = 0.002;

fn example(name: &str) -> Arc<Scene> {
    let path = repository().join("examples").join(name);
    let text = std::fs::read_to_string(path).expect("an example is readable");
    if name.ends_with(".crt") {
        script(&text)
    } else {
        scene(&text)
    }
}

/// The scene of a script.
fn script(text: &str) -> Arc<Scene> {
    let document = syntax::crt::document::Document::new(text, &()).expect("short");
    Arc::new(scene::crt::run(&document.snapshot().script(), text).scene)
}

fn request(scene: &Arc<Scene>, size: [u32; 2], samples: u32) -> PictureRequest {
    let params = ParamValues::initial(scene);
    let options = TracedOptions {
        samples: Some(samples),
        ..TracedOptions::default()
    };
    PictureRequest::new(scene.clone(), params, options, size)
}

/// Waits until the pass with the functions of a request's scene is ready.
fn wait_for(renderer: &mut Renderer, request: &PictureRequest) {
    // One that has been given up may be made first.
    for _ in 0..2 {
        renderer.draw(request).expect("a picture");
        while renderer.is_building() {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
    }
}

/// A renderer whose pass is ready: live pictures do not wait for it.
fn on_gpu() -> Renderer {
    let mut renderer = Renderer::on_gpu(Gpu::shared().expect("a GPU or software Vulkan"));
    let first = request(&scene(BASE), [8, 8], 1);
    let drawn = renderer.draw(&first).expect("a picture");
    assert!(
        matches!(drawn.backend, BackendUsed::Gpu(_))
            || drawn
                .backend
                .to_string()
                .ends_with("its shader is being built"),
        "{}",
        drawn.backend
    );
    while renderer.is_building() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    renderer
}

fn drawn(renderer: &mut Renderer, request: &PictureRequest) -> RenderedImage<RgbaImage> {
    let drawn = renderer.draw(request).expect("a picture");
    let pixels = renderer.read(drawn.image.clone()).expect("pixels");
    drawn.with_pixels(pixels)
}

/// The share of pixels that differ by more than two steps, and the greatest difference.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (f64, u8) {
    let apart = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| {
        let channels = a.0.iter().zip(&b.0);
        channels.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
    };
    let apart: Vec<u8> = a.pixels().zip(b.pixels()).map(apart).collect();
    let far = apart.iter().filter(|apart| **apart > 2).count();
    let most = apart.iter().max().copied().unwrap_or(0);
    (far as f64 / apart.len() as f64, most)
}

/// Writes pictures into the folder `TRACED_PICTURES`, to be looked at.
fn keep(name: &str, picture: &RgbaImage) {
    if let Some(folder) = std::env::var_os("TRACED_PICTURES") {
        let path = PathBuf::from(folder).join(format!("{name}.png"));
        picture.save(path).expect("the folder is writable");
    }
}

/// Draws on both backends, and holds the GPU to the bound. Returns the share of samples that f64 has traced again.
#[track_caller]
fn assert_same(gpu: &mut Renderer, name: &str, request: &PictureRequest) -> f64 {
    let start = std::time::Instant::now();
    let by_f64 = drawn(&mut Renderer::software(), request);
    wait_for(
        gpu,
        &PictureRequest {
            size: [8, 8],
            ..request.clone()
        },
    );
    let middle = start.elapsed();
    let before = gpu.counters().retraced;
    // In the bounds of its own scene.
    gpu.set_bounds(None);
    let by_gpu = drawn(gpu, request);
    let end = start.elapsed() - middle;
    assert!(
        matches!(by_gpu.backend, BackendUsed::Gpu(_)),
        "{name}: {}",
        by_gpu.backend
    );
    let retraced = gpu.counters().retraced - before;
    let (share, most) = difference(&by_f64.image, &by_gpu.image);
    println!(
        "{name}: {:.4} % of pixels differ, by {most} at most; {retraced} samples by f64; {middle:.2?} and {end:.2?}",
        100.0 * share
    );
    keep(&format!("{name}-f64"), &by_f64.image);
    keep(&format!("{name}-gpu"), &by_gpu.image);
    assert!(share <= BOUND, "{name}: {share} of all pixels differ");
    let options = request.view.get::<TracedOptions>().expect("its options");
    let pixels = request.size[0] * request.size[1];
    retraced as f64 / f64::from(pixels * options.samples.expect("stated"))
}

/// The examples that are data to the pass.
const FITTING: [&str; 18] = [
    "bokeh.crt",
    "carved_box.crt",
    "circle.gtr",
    "cushion.gtr",
    "dice.gtr",
    "disc.gtr",
    "field.gtr",
    "flat.gtr",
    "forest.crt",
    "gears.crt",
    "gyroid.gtr",
    "halfplane.gtr",
    "lens.gtr",
    "mirror_room.crt",
    "ring.gtr",
    "sextic.gtr",
    "spheres.crt",
    "zoll.gtr",
];

/// A clause about what of a request the pass cannot draw.
fn misfit(request: &PictureRequest) -> Option<String> {
    let plan = Views::standard().plan(request, Backend::Gpu);
    let clause = |sentence: &String| Some(sentence.split_once("in f64, because ")?.1.to_owned());
    let clause = plan.left_out.iter().find_map(clause);
    assert_eq!(plan.built().trace_pipelines, u32::from(clause.is_none()));
    clause
}

#[test]
fn the_examples_that_fit_are_known() {
    let folder = std::fs::read_dir(repository().join("examples")).expect("readable");
    let names = folder.map(|entry| entry.expect("readable").file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    let mut names: Vec<String> = names
        .filter(|name| name.ends_with(".gtr") || name.ends_with(".crt"))
        .collect();
    names.sort();
    names.retain(|name| {
        let clause = misfit(&request(&example(name), [8, 8], 1));
        if let Some(clause) = &clause {
            println!("{name}: {clause}");
        }
        clause.is_none()
    });
    assert_eq!(names, FITTING);
}

#[test]
fn examples_that_fit_are_drawn_as_by_f64() {
    let mut gpu = on_gpu();
    for name in FITTING {
        let scene = example(name);
        assert_same(&mut gpu, name, &request(&scene, [200, 150], 2));
    }
}

/// A scene that has most of what the pass draws.
const BASE: &str = "
    param h : [0, 1];
    function ball(x, y, z) = x^2 + y^2 + z^2 - 1;
    solid cube(x, y, z) = max(abs x, abs y, abs z) - 0.8, color : (0.8, 0.3, 0.2);
    solid die = cube \\ ball @ scale 0.5 @ (0, 0, 0.8) @ rotate (0, 0, h);
    solid drop = ball @ scale 0.5 @ (1.4, -0.6, 0), mirror : 0.4;
    solid ground(x, y, z) = z + 1, color : 0.5;
    light lamp = @ (3, -4, 5);
    camera eye = (-0.2, 5, -2) @ (0.4, -6, 2);
";

#[test]
fn an_edit_builds_no_pipeline() {
    let mut renderer = on_gpu();
    let base = request(&scene(BASE), [40, 30], 1);
    drawn(&mut renderer, &base);
    let built = renderer.counters().pipelines;
    assert_eq!(built, 1, "one fixed pass");
    for (old, new) in [
        // A constant, another shape, another leaf, a light that moves and one more, another colour, glass.
        ("scale 0.5 @ (1.4", "scale 0.4 @ (1.4"),
        ("max(abs x, abs y, abs z) - 0.8", "x^4 + y^4 + z^4 - 0.4"),
        (
            "\\ ball @ scale 0.5",
            "\\ ball @ (0.9, 0, 0) \\ ball @ scale 0.5",
        ),
        (
            "@ (3, -4, 5)",
            "@ (-3, -4, 5), size : 0.3; light sun = (0, 1, -1)",
        ),
        ("color : 0.5", "color : (0.2, 0.4, 0.3), mirror : 0.2"),
        ("mirror : 0.4", "glass : 0.9"),
        ("\\ ball", "| ball"),
    ] {
        let edited = BASE.replace(old, new);
        assert_ne!(edited, BASE, "{old}");
        let edited = request(&scene(&edited), [40, 30], 1);
        let drawn = drawn(&mut renderer, &edited);
        assert!(
            matches!(drawn.backend, BackendUsed::Gpu(_)),
            "{new}: {}",
            drawn.backend
        );
        assert_eq!(renderer.counters().pipelines, built, "{new}");
    }
    let mut moved = base.clone();
    let mut params = (*base.params).clone();
    params.set(&base.scene, "h", &[0.7]).expect("a param");
    moved.params = params.into();
    drawn(&mut renderer, &moved);
    assert_eq!(renderer.counters().pipelines, built, "a param");
}

#[test]
fn a_scene_that_does_not_fit_is_drawn_by_f64_and_says_why() {
    for (text, clause) in [
        (
            "solid g(x, y, z) = max(x^6 + y^6 + z^6 - 1, x);",
            "`g` joins polynomials, one of them of degree 6",
        ),
        (
            "solid g(x, y, z) = x^3 + y^2 + z^2 - 1;",
            "`g` has an unbounded surface",
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];",
            "parametric surfaces",
        ),
        (
            "solid g(x, y, z) = x^2 + y^2 + z^2 - 1, color : (0.5 + 0.4sin(9x), 1, 1), uv : (x, y);",
            "`g` have places of an image",
        ),
        (
            "solid g(x, y, z) = x^2 + y^2 + z^2 - 1; background b(x, y, z) = (abs x, 1, 1);",
            "the background differs",
        ),
    ] {
        let request = request(&scene(text), [24, 18], 1);
        let mut renderer = Renderer::on_gpu(Gpu::shared().expect("a GPU or software Vulkan"));
        let by_gpu = drawn(&mut renderer, &request);
        let backend = by_gpu.backend.to_string();
        assert!(backend.starts_with("software, because"), "{backend}");
        assert!(backend.contains(clause), "{backend}");
        assert_eq!(renderer.counters().pipelines, 0, "{text}");
        let by_f64 = drawn(&mut Renderer::software(), &request);
        assert!(by_gpu.image == by_f64.image, "{text}: another picture");
        let why = misfit(&request).expect("it does not fit");
        assert!(why.contains(clause), "{why}");
    }
    assert_eq!(misfit(&request(&scene(BASE), [24, 18], 1)), None);
}

#[test]
fn mirrors_that_face_each_other_end() {
    let scene = scene(
        "solid left(x, y, z) = x + 1, mirror : 1;
         solid right(x, y, z) = 1 - x, mirror : 1;
         solid ball(x, y, z) = x^2 + y^2 + z^2 - 0.1, glass : 1;
         light lamp = @ (0, -1, 1);
         camera eye = (1, 1, 0) @ (0, -2, 0);",
    );
    let mut request = request(&scene, [60, 45], 1);
    request
        .view
        .get_mut::<TracedOptions>()
        .expect("its options")
        .bounces = Some(64);
    let mut gpu = on_gpu();
    assert_same(&mut gpu, "facing", &request);
}

#[test]
fn glass_lights_lenses_and_quartics_are_drawn_as_by_f64() {
    let ground = "solid ground(x, y, z) = z + 1, color : (0.6, 0.5, 0.4);
         solid post(x, y, z) = x^2 + (y - 1.5)^2 - 0.1, z : [-1, 1], color : (0.2, 0.4, 0.8);";
    let camera = "camera eye = (0, 4, -1) @ (0, -4, 1)";
    let lamp = "light lamp = @ (2, -3, 4);";
    let ball = "function ball(x, y, z) = x^2 + y^2 + z^2 - 1;";
    let torus = "(x^2 + y^2 + z^2 + 0.75)^2 - 4(x^2 + y^2)";
    let mut gpu = on_gpu();
    for (name, text) in [
        (
            "lens",
            format!(
                "{ball} solid a = ball @ (0, 0.6, 0) & ball @ (0, -0.6, 0), glass : 0.95;
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "overlapping glass",
            format!(
                "{ball} solid a = ball @ scale 0.6 @ (-0.3, 0, 0) | ball @ scale 0.6 @ (0.3, 0, 0),
                     glass : 0.9, color : (0.8, 1, 0.9), depth : 0.5;
                 solid b = ball @ scale 0.2, color : (0.9, 0.2, 0.1);
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "flush glass",
            format!(
                "function box(x, y, z) = max(abs x, abs y, abs z) - 0.5;
                 solid a = box @ (-0.5, 0, -0.5), glass : 0.9, color : (1, 0.8, 0.8);
                 solid b = box @ (0.5, 0, -0.5), glass : 0.9, color : (0.8, 1, 0.8), ior : 1.3;
                 solid c = box @ (0, 0, 0.5) | box @ scale (3, 1, 1) @ (0, 0.4, 0.5);
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "inside",
            format!(
                "{ball} solid a = ball @ scale 5 | ball @ scale 5 @ (0, 0.5, 0), glass : 0.8, ior : 1.2;
                 solid b = ball @ scale 0.5;
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "inside colour",
            format!(
                "{ball} solid a = ball @ scale 5, glass : 0.8, color : (0.9, 0.7, 0.5), depth : 3;
                 solid b = ball @ scale 0.5; solid c = ball @ scale 0.4 @ (1, 0, 0), glass : 1;
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "glass on the ground",
            format!(
                "function box(x, y, z) = max(abs x, abs y, abs(z + 0.5)) - 0.5;
                 solid a = box, glass : 0.9, color : (0.9, 0.6, 0.3), depth : 0.7;
                 solid b = box @ (1, 0, 0), glass : 0.8, color : (0.4, 0.8, 0.8);
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "torus",
            format!("solid t(x, y, z) = {torus}, mirror : 0.2; {ground} {lamp} {camera};"),
        ),
        (
            "carved torus",
            format!(
                "{ball} solid t(x, y, z) = (sqrt(x^2 + y^2) - 1)^2 + z^2 - 0.25;
                 solid c = t @ rotate (1, 0, 0) \\ ball @ scale 0.4 @ (0, -1, 0.5), glass : 0.5;
                 {ground} {lamp} {camera};"
            ),
        ),
        (
            "lights",
            format!(
                "{ball} solid b = ball @ scale 0.7; {ground}
                 light round = @ (2, -3, 4), size : 0.8, falloff : 4;
                 light sun = (1, 2, -2), ambient : 0.1, power : 0.3;
                 light spot = (0, 1, -1.5) @ (-1, -2, 2), angle : 0.7, color : (1, 0.6, 0.2);
                 light beam = (-0.2, 1, -1) @ (0.6, -2, 2), radius : 0.3, soft : 0.5;
                 {camera}, aperture : 0.1, bokeh : hexagon;"
            ),
        ),
        (
            "star",
            format!(
                "{ball} solid b = ball @ scale 0.7, specular : 1; {ground} {lamp}
                 {camera}, aperture : 0.2, focus : 6, bokeh : star, projection : spherical, fov : 1.4;"
            ),
        ),
        (
            "gaussian",
            format!(
                "{ball} solid b = ball @ scale 0.7; {ground}
                 {camera}, aperture : 0.1, focus : 3, bokeh : gaussian, roll : 0.4;"
            ),
        ),
    ] {
        assert_same(&mut gpu, name, &request(&scene(&text), [100, 75], 2));
    }
}

#[test]
fn samples_add_up_to_the_picture_that_has_them_at_once() {
    let scene = scene(BASE);
    let mut renderer = on_gpu();
    for samples in [1, 3, 30] {
        drawn(&mut renderer, &request(&scene, [40, 30], samples));
    }
    let added = drawn(&mut renderer, &request(&scene, [40, 30], 40));
    assert_eq!(added.samples, Some([40, 10]));
    let at_once = drawn(&mut on_gpu(), &request(&scene, [40, 30], 40));
    let (share, most) = difference(&added.image, &at_once.image);
    assert!(share == 0.0, "{most}");
}

#[test]
fn the_shader_has_the_limits_of_the_tables() {
    let text = wgsl::library::PASS_TRACE_CROSSINGS.text;
    let nodes = format!("const MOST_NODES: u32 = {}u;", tracer::tables::MOST_NODES);
    assert!(text.contains(&nodes), "{nodes}");
    let line = wgsl::library::LINE.text;
    let terms = format!("terms: array<f32, {}>,", tracer::tables::HIGHEST_DEGREE + 1);
    assert!(line.contains(&terms), "{terms}");
}
