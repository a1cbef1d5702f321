//! What helps to read a picture: labels, axes, colours that stay apart, lines over lines, the first camera's side, images
//! that are turned over.

use std::sync::Arc;

use crate::scenes::Wanted;
use image::{Rgba, RgbaImage};
use render::gpu::Gpu;
use render::layers::Stroke;
use render::point::WorldPoint;
use render::request::Overlays;
use render::shared::Shared;
use render::texture::{Proportions, Texture};
use render::view::geodesic::GeodesicOptions;
use render::viewpoint::{GeodesicCamera, Projection, Viewpoint};
use render::{Backend, BackendUsed, PictureRequest, RenderError, Renderer, Views, style};
use scene::{ObjectId, ParamValues};

const SIZE: [u32; 2] = [320, 240];
const POLAR: &str =
    "surface s(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v)), u : [-pi, pi], v : [0, pi];";

fn request(text: &str, wanted: &Wanted) -> PictureRequest {
    let scene = crate::scenes::scene(text);
    wanted.of(&scene, &ParamValues::initial(&scene))
}

fn draw(request: &PictureRequest, backend: Backend) -> RgbaImage {
    let picture = render::render(&Views::standard(), request, backend, &|_| {});
    picture.expect("a picture").image
}

fn software(request: &PictureRequest) -> RgbaImage {
    draw(request, Backend::Software)
}

/// The pixels in which two pictures differ.
fn changed(a: &RgbaImage, b: &RgbaImage) -> Vec<[u32; 2]> {
    let pixels = a.enumerate_pixels().zip(b.pixels());
    let pixels = pixels.filter(|((_, _, a), b)| a != b);
    pixels.map(|((x, y, _), _)| [x, y]).collect()
}

#[test]
fn a_label_lies_beside_what_it_names_on_both_backends() {
    let text = "point first = (-1, 0, 0); point second = (1, 0, 0);";
    let plain = request(text, &Wanted::space(SIZE));
    let labelled = PictureRequest {
        overlays: Overlays {
            labels: true,
            ..Overlays::default()
        },
        ..plain.clone()
    };
    let camera = Renderer::software().camera(&plain).expect("a camera");
    for backend in [Backend::Software, Backend::Gpu] {
        let words = changed(&draw(&plain, backend), &draw(&labelled, backend));
        assert!(words.len() > 300, "{backend:?}: {} pixels", words.len());
        let near = |place: [f64; 3]| {
            let place = camera.placement.local(WorldPoint(place));
            let [x, y] = camera.pixel_of(place).expect("in front").0;
            let off = |[a, b]: &[u32; 2]| (f64::from(*a) - x).hypot(f64::from(*b) - y);
            words.iter().filter(|pixel| off(pixel) < 90.0).count()
        };
        let counts = [near([-1.0, 0.0, 0.0]), near([1.0, 0.0, 0.0])];
        assert!(
            counts.iter().all(|count| *count > 100),
            "{backend:?}: {counts:?}"
        );
        assert_eq!(
            counts[0] + counts[1],
            words.len(),
            "{backend:?}: words elsewhere"
        );
    }
}

#[test]
fn what_is_seen_in_part_has_its_name() {
    let torus = "surface s(u, v) = ((1 + 0.4 cos v) cos u, (1 + 0.4 cos v) sin u, 0.4 sin v),
        u : [0, 2 pi], v : [0, 2 pi];";
    for (text, eye, target) in [
        (
            "curve line(t) = (t, 0, 0.2), t : [-10, 10];",
            [6.0, -8.0, 3.0],
            [7.0, 0.0, 0.0],
        ),
        (torus, [1.6, 0.0, 0.2], [1.0, 0.0, 0.0]),
        (
            "vector w = (9, 0, 0) @ (0, 0, 0);",
            [1.0, -4.0, 1.0],
            [1.0, 0.0, 0.0],
        ),
    ] {
        let wanted =
            Wanted::space(SIZE).with_space(|space| space.camera = Viewpoint::new(eye, target));
        let plain = request(text, &wanted);
        let mut named = plain.clone();
        named.overlays.labels = true;
        let words = changed(&software(&plain), &software(&named));
        assert!(words.len() > 30, "{text}: {} pixels", words.len());
    }
}

#[test]
fn the_name_of_a_curve_that_is_interrupted_in_its_middle_lies_beside_it() {
    // The second curve has its middle far outside of the picture.
    for (y, heights) in [("x/abs x", [1.0, -1.0]), ("1/x", [1.9, -1.9])] {
        let text = format!("curve c(x) = (x, {y}, 0), x : [-2, 2];");
        let wanted = Wanted::space(SIZE)
            .with_space(|space| space.camera = Viewpoint::new([0.0, -0.001, 6.0], [0.0; 3]));
        let plain = request(&text, &wanted);
        let mut named = plain.clone();
        named.overlays.labels = true;
        let words = changed(&software(&plain), &software(&named));
        assert!(!words.is_empty(), "{y}: no name");
        let camera = Renderer::software().camera(&plain).expect("a camera");
        let row = |y: f64| {
            let place = camera.placement.local(WorldPoint([0.0, y, 0.0]));
            camera.pixel_of(place).expect("in front").0[1]
        };
        let middle = words.iter().map(|[_, y]| f64::from(*y)).sum::<f64>() / words.len() as f64;
        let off = heights.map(|y| (row(y) - middle).abs());
        let unit = (row(1.0) - row(0.0)).abs();
        assert!(
            off[0].min(off[1]) < 0.7 * unit,
            "{y}: the name is in row {middle}, off by {off:?}"
        );
    }
}

#[test]
fn names_stand_out_from_a_dark_image_by_a_solid_halo() {
    let plane =
        "surface s(u, v) = (u, v, 0), u : [-1, 1, 20], v : [-1, 1, 20]; point p = (0, 0, 0.5);";
    let wanted = Wanted::space(SIZE)
        .with_space(|space| space.camera = Viewpoint::new([0.1, 0.0, 4.0], [0.0; 3]));
    let black = RgbaImage::from_pixel(1, 1, Rgba([0, 0, 0, 255]));
    let mut plain = request(plane, &wanted);
    if let Some(space) = plain.view.space_mut() {
        space.background = Some([255; 4]);
    }
    plain.textures = vec![(
        ObjectId::new(0),
        Shared::from(Arc::new(Texture::from_image(black))),
    )];
    let mut named = plain.clone();
    named.overlays.labels = true;
    let (plain, named) = (software(&plain), software(&named));
    let words = changed(&plain, &named);
    let dark = |[x, y]: &&[u32; 2]| plain.get_pixel(*x, *y).0[1] < 60;
    let light = |[x, y]: &&[u32; 2]| named.get_pixel(*x, *y).0[1] > 240;
    let halo = words.iter().filter(dark).filter(light).count();
    assert!(halo > 20, "{halo} of {} pixels", words.len());
}

#[test]
fn the_name_of_what_a_surface_hides_is_dim() {
    let plane = "surface s(u, v) = (u, v, 0), u : [-1, 1, 20], v : [-1, 1, 20];";
    let black = Arc::new(Texture::from_image(RgbaImage::from_pixel(
        1,
        1,
        Rgba([0, 0, 0, 255]),
    )));
    for backend in [Backend::Software, Backend::Gpu] {
        let brightest = |place: &str| {
            let text = format!("{plane} point p = {place};");
            let wanted = Wanted::space(SIZE)
                .with_space(|space| space.camera = Viewpoint::new([0.1, 0.0, 4.0], [0.0; 3]));
            let mut plain = request(&text, &wanted);
            plain.textures = vec![(ObjectId::new(0), Shared::from(black.clone()))];
            plain.scale = 2.0;
            let mut named = plain.clone();
            named.overlays.labels = true;
            let (plain, named) = (draw(&plain, backend), draw(&named, backend));
            let words = changed(&plain, &named);
            let near = words.iter().filter(|[x, y]| {
                // The name of the surface lies at its corner.
                (100..220).contains(x) && (70..170).contains(y)
            });
            near.map(|[x, y]| named.get_pixel(*x, *y).0[1]).max()
        };
        let (before, behind) = (brightest("(0, 0, 0.5)"), brightest("(0, 0, -0.5)"));
        assert!(before > Some(220), "{backend:?}: {before:?}");
        assert!(
            behind > Some(100) && behind < Some(190),
            "{backend:?}: {behind:?}"
        );
    }
}

#[test]
fn words_and_lines_are_as_large_as_the_scale_says() {
    let text = "curve line(t) = (t, 0, 0), t : [-1, 1];";
    let with = |scale: f32, labels: bool| {
        let mut request = request(text, &Wanted::space(SIZE));
        request.scale = scale;
        request.overlays.labels = labels;
        software(&request)
    };
    let thickness = |image: &RgbaImage| {
        let column = |y: &u32| image.get_pixel(80, *y).0[..3] != style::BACKGROUND;
        (0..SIZE[1]).filter(column).count()
    };
    let [one, three] = [with(1.0, false), with(3.0, false)];
    let [thin, thick] = [thickness(&one), thickness(&three)];
    assert!((2 * thin..=4 * thin).contains(&thick), "{thin} and {thick}");
    let words = [
        changed(&one, &with(1.0, true)).len(),
        changed(&three, &with(3.0, true)).len(),
    ];
    assert!(words[1] > 3 * words[0], "larger words: {words:?}");
    let mut request = request(text, &Wanted::space(SIZE));
    request.scale = 0.0;
    assert_eq!(request.check(), Err(RenderError::Scale(0.0)));
}

#[test]
fn axes_are_a_box_behind_the_scene_with_numbers() {
    let text = "surface s(u, v) = (u, v, u v), u : [-1, 1, 20], v : [-1, 1, 20];";
    let plain = request(text, &Wanted::space(SIZE));
    let mut axes = plain.clone();
    axes.overlays.axes = true;
    for backend in [Backend::Software, Backend::Gpu] {
        let added = changed(&draw(&plain, backend), &draw(&axes, backend));
        assert!(added.len() > 1500, "{backend:?}: {}", added.len());
    }
    // A scene that nothing is in has no box.
    let empty = request("function f(x) = x;", &Wanted::space(SIZE));
    let mut boxed = empty.clone();
    boxed.overlays.axes = true;
    assert_eq!(software(&empty), software(&boxed));
}

#[test]
fn the_observer_is_marked_in_both_views() {
    let camera = GeodesicCamera::new(ObjectId::new(0));
    let space = Wanted::space(SIZE).with_space(|space| space.show_camera = Some(camera));
    let inside = Wanted::new(GeodesicOptions::new(ObjectId::new(0)), SIZE);
    for wanted in [space, inside] {
        let plain = request(POLAR, &wanted);
        let mut marked = plain.clone();
        marked.overlays.labels = true;
        let words = changed(&software(&plain), &software(&marked));
        assert!(
            words.len() > 300,
            "{:?}: {}",
            plain.view.name(),
            words.len()
        );
    }
}

#[test]
fn a_geodesic_has_its_name_beside_it_where_it_is_seen_from_within() {
    // Along the equator to the right and the left; the other is never seen.
    let text = format!(
        "{POLAR} geodesic along(t) : s = (1, 0) @ (-2, pi/2), t : [0, 4];
        surface other(u, v) = (u, v, 0), u : [0, 1], v : [0, 1];
        geodesic elsewhere(t) : other = (1, 0) @ (0, 0), t : [0, 1];"
    );
    let mut options = GeodesicOptions::new(ObjectId::new(0));
    options.camera = options.camera.at([0.0, std::f64::consts::FRAC_PI_2]);
    let plain = request(&text, &Wanted::new(options, SIZE));
    let mut named = plain.clone();
    named.overlays.labels = true;
    for backend in [Backend::Software, Backend::Gpu] {
        let words = changed(&draw(&plain, backend), &draw(&named, backend));
        // The observer's name is beside the middle, the geodesic's to the right of it and beside the line.
        let [x, y] = SIZE.map(|side| side / 2);
        let beside = words
            .iter()
            .filter(|[a, b]| *a > x + 60 && b.abs_diff(y) < 40);
        let count = beside.count();
        assert!((60..900).contains(&count), "{backend:?}: {count} pixels");
        let far = words.iter().filter(|[_, b]| b.abs_diff(y) > 60).count();
        assert_eq!(far, 0, "{backend:?}: words elsewhere");
    }
}

#[test]
fn the_first_camera_sees_the_middle_of_a_closed_surface() {
    let eye = |text: &str| {
        let request = request(text, &Wanted::space(SIZE));
        Renderer::software().camera(&request).expect("a camera").eye
    };
    let half_turn = POLAR.replace("[-pi, pi]", "[0, 2 pi]");
    assert!(eye(POLAR).x > 1.0, "{}", eye(POLAR));
    assert!(eye(&half_turn).x < -1.0, "{}", eye(&half_turn));
    // An open surface is seen from where it always was.
    let open = eye("surface s(u, v) = (u, v, u v), u : [-1, 1], v : [-1, 1];");
    assert!(
        (open.y.atan2(open.x) - style::AZIMUTH).abs() < 0.05,
        "{open}"
    );
}

#[test]
fn letters_are_read_from_the_outside_of_closed_surfaces() {
    let shown = |text: &str, texture: Option<Arc<Texture>>, flip: bool| {
        let mut request = request(text, &Wanted::space(SIZE));
        request.textures = texture
            .map(|it| (ObjectId::new(0), Shared::from(it)))
            .into_iter()
            .collect();
        if flip {
            request.flipped.push(ObjectId::new(0));
        }
        software(&request)
    };
    let latitude = "surface s(u, v) = (cos(v) cos(u), cos(v) sin(u), sin(v)), u : [-pi, pi], v : [-pi/2, pi/2];";
    let [front, behind] = [
        Texture::orientation(Proportions::Even, false),
        Texture::orientation(Proportions::Even, true),
    ];
    assert_ne!(front, behind);
    // σu×σv points into the one sphere, and out of the other.
    assert_eq!(
        shown(POLAR, None, false),
        shown(POLAR, Some(behind.clone()), false)
    );
    assert_eq!(
        shown(latitude, None, false),
        shown(latitude, Some(front.clone()), false)
    );
    // *Flip* turns them over.
    assert_eq!(shown(POLAR, None, true), shown(POLAR, Some(front), false));
    assert_eq!(
        shown(latitude, None, true),
        shown(latitude, Some(behind), false)
    );
}

#[test]
fn a_flipped_image_is_the_image_upside_down_in_both_views() {
    let mut image = RgbaImage::from_pixel(8, 8, Rgba([200, 30, 30, 255]));
    for x in 0..8 {
        image.put_pixel(x, 0, Rgba([20, 30, 240, 255]));
    }
    let mut turned = image.clone();
    image::imageops::flip_vertical_in_place(&mut turned);
    let inside = Wanted::new(GeodesicOptions::new(ObjectId::new(0)), SIZE);
    for wanted in [Wanted::space(SIZE), inside] {
        let shown = |image: &RgbaImage, flip: bool| {
            let mut request = request(POLAR, &wanted);
            let texture = Arc::new(Texture::from_image(image.clone()));
            request.textures = vec![(ObjectId::new(0), Shared::from(texture))];
            if flip {
                request.flipped.push(ObjectId::new(0));
            }
            software(&request)
        };
        assert_eq!(shown(&image, true), shown(&turned, false));
        assert_ne!(shown(&image, true), shown(&image, false));
    }
}

#[test]
fn the_edge_of_a_surface_is_no_wavefront() {
    let text = "surface s(u, v) = (u, v, 0), u : [-1, 1, 20], v : [-1, 1, 20];";
    let wanted = Wanted::space(SIZE).with_space(|space| {
        space.show_camera = Some(GeodesicCamera {
            zoom: Some(2.0),
            ..GeodesicCamera::new(ObjectId::new(0)).at([0.5, 0.0])
        });
        space.camera = Viewpoint::new([0.0, -0.01, 5.0], [0.0; 3]);
    });
    let plain = request(text, &wanted);
    let mut waves = plain.clone();
    waves.overlays.wavefronts = Some(render::request::Spacing::Every(0.5));
    let lines = changed(&software(&plain), &software(&waves));
    let camera = Renderer::software().camera(&plain).expect("a camera");
    let is_drawn = |place: [f64; 3]| {
        let [x, y] = camera
            .pixel_of(camera.placement.local(WorldPoint(place)))
            .expect("in front")
            .0;
        let is_near = |[a, b]: &[u32; 2]| (f64::from(*a) - x).hypot(f64::from(*b) - y) < 4.0;
        lines.iter().any(is_near)
    };
    assert!(is_drawn([-0.5, 0.0, 0.0]) && is_drawn([0.5, 0.5, 0.0]));
    for k in 0..100 {
        let t = -1.0 + 0.02 * f64::from(k);
        for [x, y] in [[t, -1.0], [1.0, t], [-t, 1.0], [-1.0, -t]] {
            let share = 2.0 * (x - 0.5).hypot(y);
            if (share - share.round()).abs() > 0.2 {
                assert!(!is_drawn([x, y, 0.0]), "at {x}, {y}");
            }
        }
    }
}

#[test]
fn of_lines_that_coincide_one_is_seen_without_gaps() {
    // Both run along the equator, by different samples.
    let text = format!(
        "{POLAR} curve c(t) = (cos t, sin t, 0), t : [-1, 1, 37];
        geodesic g(t) : s = (1, 0) @ (-1, pi/2), t : [0, 2];"
    );
    let camera = GeodesicCamera::new(ObjectId::new(0)).at([0.0, std::f64::consts::FRAC_PI_2]);
    let wanted = Wanted::space(SIZE).with_space(|space| {
        space.show_camera = Some(camera);
        space.camera = Viewpoint::new([4.0, 0.3, 1.5], [0.0; 3]);
    });
    let mut request = request(&text, &wanted);
    request.overlays.wavefronts = Some(render::request::Spacing::Every(0.5));
    let white = Arc::new(Texture::from_image(RgbaImage::from_pixel(
        1,
        1,
        Rgba([255; 4]),
    )));
    request.textures = vec![(ObjectId::new(0), Shared::from(white))];
    // The camera shows its own axis there too.
    let green = [20, 255, 20];
    request.colours.push((ObjectId::new(1), green));
    let camera = Renderer::software().camera(&request).expect("a camera");
    let blue = style::CURVE_COLOURS[1];
    for backend in [Backend::Software, Backend::Gpu] {
        let image = draw(&request, backend);
        let mut seen = [0, 0];
        for k in 0..400 {
            let t = -0.95 + 1.9 * f64::from(k) / 399.0;
            let place = camera.placement.local(WorldPoint([t.cos(), t.sin(), 0.0]));
            let [x, y] = camera.pixel_of(place).expect("in front").0;
            let pixel = image.get_pixel(x as u32, y as u32).0;
            let like = |colour: [u8; 3]| (0..3).all(|n| pixel[n].abs_diff(colour[n]) < 60);
            seen[0] += u32::from(like(blue));
            seen[1] += u32::from(like(green));
        }
        // The arrow of the camera hides a little of it; the curve below is seen nowhere.
        assert!(seen[0] > 330 && seen[1] == 0, "{backend:?}: {seen:?}");
    }
}

/// Colours in linear light as somebody without one kind of cones sees them (G. Machado, M. Oliveira, L. Fernandes, 2009).
fn seen_by([r, g, b]: [u8; 3], kind: &[[f32; 3]; 3]) -> [f32; 3] {
    let light = style::linear([r, g, b]);
    kind.map(|row| {
        (0..3)
            .map(|k| row[k] * light[k])
            .sum::<f32>()
            .clamp(0.0, 1.0)
    })
}

const TYPICAL: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const NO_RED: [[f32; 3]; 3] = [
    [0.152_286, 1.052_583, -0.204_868],
    [0.114_503, 0.786_281, 0.099_216],
    [-0.003_882, -0.048_116, 1.051_998],
];
const NO_GREEN: [[f32; 3]; 3] = [
    [0.367_322, 0.860_646, -0.227_968],
    [0.280_085, 0.672_501, 0.047_413],
    [-0.011_820, 0.042_940, 0.968_881],
];

#[test]
fn colours_of_lines_stay_apart_for_the_colour_blind_and_on_curvature() {
    let apart = |a: [u8; 3], b: [u8; 3], kind: &[[f32; 3]; 3]| -> f32 {
        // Lightness as it is perceived, channel by channel.
        let [a, b] = [a, b].map(|it| seen_by(it, kind).map(|x| x.powf(1.0 / 2.4)));
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f32>().sqrt()
    };
    let groups: [&[[u8; 3]]; 6] = [
        &style::VECTOR_COLOURS,
        &style::CURVE_COLOURS,
        &style::CURVE_COLOURS_ON_CURVATURE,
        &style::VECTOR_COLOURS_ON_PAPER,
        &style::CURVE_COLOURS_ON_PAPER,
        &style::CURVE_COLOURS_ON_CURVATURE_ON_PAPER,
    ];
    for colour in style::CURVE_COLOURS_ON_PAPER {
        let contrast = contrast_with_white(colour);
        assert!(contrast >= 4.5, "{colour:?}: {contrast}");
    }
    for kind in [&TYPICAL, &NO_RED, &NO_GREEN] {
        for group in groups {
            for (k, a) in group.iter().enumerate() {
                for b in &group[k + 1..] {
                    let apart = apart(*a, *b, kind);
                    assert!(apart > 0.2, "{a:?} and {b:?}: {apart}, {kind:?}");
                }
            }
        }
        // The scale goes from blue over white to red.
        let scale = Texture::curvature(
            &crate::scenes::scene(POLAR),
            &ParamValues::initial(&crate::scenes::scene(POLAR)),
            ObjectId::new(0),
        );
        let scale = scale
            .expect("curvature")
            .curvature_scale()
            .expect("a scale");
        for share in [-1.0, -0.5, 0.0, 0.5, 1.0] {
            let ground = scale.colour(share * scale.most);
            let best = style::CURVE_COLOURS_ON_CURVATURE[0];
            let apart = apart(best, ground, kind);
            assert!(apart > 0.2, "{best:?} on {ground:?}: {apart}, {kind:?}");
        }
    }
}

#[test]
fn the_vectors_of_a_frame_have_three_colours_and_a_geodesic_on_curvature_none_of_its_scale() {
    let frame = "vector t = (1, 0, 0) @ (0, 0, 0); vector n = (0, 1, 0) @ (0, 0, 0); vector b = (0, 0, 1) @ (0, 0, 0);";
    let colours = request(frame, &Wanted::space(SIZE)).object_colours();
    assert_eq!(colours, style::VECTOR_COLOURS[..3]);
    let text = format!("{POLAR} geodesic g(t) : s = (1, 0) @ (0, 1), t : [0, 1];");
    let mut curved = request(&text, &Wanted::space(SIZE));
    assert_eq!(curved.srgb(ObjectId::new(1)), style::CURVE_COLOURS[0]);
    curved.curved.push(ObjectId::new(0));
    assert_eq!(
        curved.srgb(ObjectId::new(1)),
        style::CURVE_COLOURS_ON_CURVATURE[0]
    );
    curved.colours.push((ObjectId::new(1), [1, 2, 3]));
    assert_eq!(curved.srgb(ObjectId::new(1)), [1, 2, 3]);
}

#[test]
fn a_driver_that_draws_on_the_processor_is_no_gpu_unless_it_is_asked_for() {
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    let request = request("point p = (0, 0, 0);", &Wanted::space([16, 16]));
    let auto = render::render(&Views::standard(), &request, Backend::Auto, &|_| {});
    let backend = auto.expect("a picture").backend.to_string();
    if gpu.is_emulated() {
        assert!(Gpu::shared_real().is_err());
        // No driver is loaded where the kernel has no device.
        let reasons = [
            "software, because the only driver",
            "software, because this machine has no GPU",
        ];
        assert!(
            reasons.iter().any(|reason| backend.starts_with(reason)),
            "{backend}"
        );
    } else {
        assert!(backend.starts_with("GPU: "), "{backend}");
    }
    let asked = render::render(&Views::standard(), &request, Backend::Gpu, &|_| {});
    assert!(matches!(
        asked.expect("a picture").backend,
        BackendUsed::Gpu(_)
    ));
}

#[test]
fn a_picture_whose_pixels_the_processor_follows_is_not_said_to_be_the_gpus() {
    let mut wanted = Wanted::new(GeodesicOptions::new(ObjectId::new(0)), [24, 24]);
    wanted.inside().method = render::PictureMethod::Adaptive;
    let followed = request(POLAR, &wanted);
    let picture = render::render(&Views::standard(), &followed, Backend::Gpu, &|_| {});
    let backend = picture.expect("a picture").backend.to_string();
    assert!(backend.starts_with("software, because"), "{backend}");
    wanted.inside().method = render::PictureMethod::Fan;
    let fan = request(POLAR, &wanted);
    let picture = render::render(&Views::standard(), &fan, Backend::Gpu, &|_| {});
    assert!(matches!(
        picture.expect("a picture").backend,
        BackendUsed::Gpu(_)
    ));
}

/// The share of light that white has more than a colour (WCAG 2, contrast ratio).
fn contrast_with_white(colour: [u8; 3]) -> f32 {
    let [r, g, b] = style::linear(colour);
    1.05 / (0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05)
}

#[test]
fn colours_for_print_stand_out_from_white() {
    let text = format!(
        "{POLAR}
curve a(t) = (t, 0, 0), t : [0, 1];
curve b(t) = (t, 1, 0), t : [0, 1];
curve c(t) = (t, 2, 0), t : [0, 1];
geodesic d(t) : s = (0, 1) @ (1, 0), t : [0, 1];
point p = (0, 0, 2);
vector v = (1, 0, 0) @ p;
vector w = (0, 1, 0) @ p;
vector x = (0, 0, 1) @ p;
vector y = (1, 1, 1) @ p;
"
    );
    let mut print = request(&text, &Wanted::space(SIZE));
    print.theme = style::Theme::Print;
    for shows_curvature in [false, true] {
        if shows_curvature {
            print.curved.push(ObjectId::new(0));
        }
        for colour in &print.object_colours()[1..] {
            let contrast = contrast_with_white(*colour);
            assert!(contrast >= 4.5, "{colour:?}: {contrast}");
        }
    }
    assert!(
        contrast_with_white(style::POINT_COLOUR) < 2.0,
        "that of a screen does not"
    );
}

fn strokes(request: &PictureRequest) -> Vec<Stroke> {
    let layers = render::render_layers(&Views::standard(), request, &|_| {});
    layers.expect("a picture").strokes
}

#[test]
fn a_curve_that_is_a_single_place_is_a_dot() {
    let text = "curve c(t) = (0, 0, 0), t : [0, 1]; point p = (1, 1, 1);";
    let strokes = strokes(&request(text, &Wanted::space(SIZE)));
    assert_eq!(strokes.len(), 1, "{strokes:?}");
    let points = &strokes[0].points;
    assert!(points.len() == 2 && points[0] == points[1], "{points:?}");
}

#[test]
fn of_two_strokes_the_one_that_is_nearer_where_they_cross_lies_above() {
    // From the front, the slanting line is behind the upright one as a whole, and before it where they cross.
    let text = "curve slanting(t) = (t, 5 t, 0), t : [-1, 1, 3];
        curve upright(t) = (-0.8, -1, t), t : [-1, 1, 3];";
    let wanted = Wanted::space(SIZE).with_space(|space| {
        space.camera = Viewpoint {
            projection: Projection::Orthographic,
            ..Viewpoint::new([0.0, -9.0, 0.0], [0.0; 3])
        };
    });
    let request = request(text, &wanted);
    let camera = Renderer::software().camera(&request).expect("a camera");
    let crossing = camera.placement.local(WorldPoint([-0.8, -4.0, 0.0]));
    let crossing = camera.pixel_of(crossing).expect("in front").0;
    let covers = |stroke: &&Stroke| {
        (0..2).all(|k| {
            let places = stroke.points.iter().map(|place| f64::from(place[k]));
            let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            (low - 1.0..high + 1.0).contains(&crossing[k])
        })
    };
    let strokes = strokes(&request);
    let there: Vec<&Stroke> = strokes.iter().filter(covers).collect();
    assert!(there.len() >= 2, "{strokes:?}");
    let top = there.last().map(|stroke| stroke.colour);
    assert_eq!(top, Some(request.object_colours()[0]));
    // A line that is as deep everywhere is one stroke.
    let upright = strokes.iter().filter(|it| Some(it.colour) != top);
    assert_eq!(upright.count(), 1);
}
