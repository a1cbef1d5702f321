//! Solids: in the 3D view on both backends, and traced.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use expr::{Graph, Input, NodeId};
use glam::DVec3;
use image::RgbaImage;
use render::counters::WorkCounters;
use render::gpu::{Gpu, Pixels};
use render::point::PixelPoint;
use render::request::part::SpaceOptions;
use render::texture::Texture;
use render::view::Interrupt;
use render::view::traced::TracedOptions;
use render::viewpoint::{Projection, Viewpoint};
use render::{Note, PictureRequest, RenderError, Renderer};
use scene::{
    AffineNodes, Attribute, AttributeValue, Object, ObjectId, ParamValues, Scene, Shape, Solid,
    SolidLeaf, SolidStep,
};

const SIZE: [u32; 2] = [160, 120];

/// A curve through the solids, a point before them and a surface that cuts them.
const OTHERS: &str = "
    curve c(t) = (1.6 cos t, 1.6 sin t, 0.4 sin(3t)), t : [0, 2pi, 200];
    point p = (0, -1.5, 0);
    surface s(u,v) = (u, v, 0.1), u : [-1.2, 1.2, 9], v : [-1.2, 1.2, 9];
";

/// Adds solids to a scene.
struct Builder {
    scene: Scene,
    /// Another object, with a place in a text.
    other: Object,
    spans: u32,
}

impl Builder {
    fn of(text: &str) -> Self {
        let scene = Arc::unwrap_or_clone(crate::scenes::scene(text));
        let other = crate::scenes::scene("point p = (0, 0, 0);").objects[0].clone();
        Self {
            scene,
            other,
            spans: 0,
        }
    }

    fn graph(&mut self) -> &mut Graph {
        &mut self.scene.graph
    }

    /// Σ (x − c)² − r² over the axes.
    fn round(&mut self, axes: &[u32], centre: [f64; 3], radius: f64) -> NodeId {
        let graph = self.graph();
        let mut sum = graph.constant(-radius * radius);
        for &axis in axes {
            let x = graph.input(Input::Variable(axis));
            let c = graph.constant(centre[axis as usize]);
            let x = graph.sub(x, c);
            let xx = graph.mul(x, x);
            sum = graph.add(sum, xx);
        }
        sum
    }

    /// A coordinate minus a number.
    fn half_space(&mut self, axis: u32, edge: f64) -> NodeId {
        let graph = self.graph();
        let x = graph.input(Input::Variable(axis));
        let edge = graph.constant(edge);
        graph.sub(x, edge)
    }

    fn leaf(&mut self, name: &str, field: NodeId, colour: Option<[f64; 3]>) -> SolidLeaf {
        // Each leaf has a place of its own.
        self.spans += 1;
        let mut span = self.other.name_span;
        (span.start, span.end) = (self.spans, self.spans + 1);
        let graph = self.graph();
        let [zero, one] = [0.0, 1.0].map(|x| graph.constant(x));
        let row = |k: usize| std::array::from_fn(|j| if j == k { one } else { zero });
        let colour = colour.map(|colour| Attribute {
            word: "color",
            span,
            value: AttributeValue::Numbers(colour.map(|c| graph.constant(c)).to_vec()),
            map: None,
        });
        SolidLeaf {
            name: name.to_owned(),
            name_span: span,
            field,
            cuts: [const { None }; 3],
            map: AffineNodes([row(0), row(1), row(2)]),
            attributes: Arc::new(colour.into_iter().collect()),
        }
    }

    fn solid(&mut self, name: &str, leaves: Vec<SolidLeaf>, joins: &[SolidStep]) -> ObjectId {
        let mut steps = vec![SolidStep::Leaf(0)];
        for (k, join) in joins.iter().enumerate() {
            steps.push(SolidStep::Leaf(k as u32 + 1));
            steps.push(join.clone());
        }
        self.scene.objects.push(Object {
            name: name.to_owned(),
            name_span: self.other.name_span,
            shape: Shape::Solid(
                Solid {
                    leaves,
                    steps,
                    ..Solid::default()
                }
                .into(),
            ),
            params: Vec::new(),
            grids: Vec::new(),
            geodesic_values: Vec::new(),
            attributes: Vec::new(),
        });
        ObjectId::new(self.scene.objects.len() - 1)
    }

    /// A ball of radius 1 with a round hole along z.
    fn bead(&mut self) -> ObjectId {
        let ball = self.round(&[0, 1, 2], [0.0; 3], 1.0);
        let hole = self.round(&[0, 1], [0.2, 0.0, 0.0], 0.4);
        let leaves = vec![
            self.leaf("ball", ball, Some([0.9, 0.3, 0.2])),
            self.leaf("hole", hole, None),
        ];
        self.solid("bead", leaves, &[SolidStep::Difference])
    }
}

fn request(scene: Scene, options: SpaceOptions) -> PictureRequest {
    let params = ParamValues::initial(&scene);
    PictureRequest::new(scene, params, options, SIZE)
}

fn drawn(renderer: &mut Renderer, request: &PictureRequest) -> RgbaImage {
    let drawn = renderer.draw(request).expect("a picture");
    renderer.read(drawn.image).expect("pixels")
}

/// The mean difference of two pictures' bytes, and the share of pixels that differ by more than 24 in a channel.
fn difference(a: &RgbaImage, b: &RgbaImage) -> (f64, f64) {
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

/// Writes a picture where `GEOTRACE_TEST_PICTURES` says, to be looked at.
fn keep(name: &str, image: &RgbaImage) {
    if let Some(folder) = std::env::var_os("GEOTRACE_TEST_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        image.save(path).expect("written");
    }
}

fn views() -> [SpaceOptions; 3] {
    let seen = |projection| SpaceOptions {
        camera: Viewpoint {
            projection,
            ..Viewpoint::new([3.0, -5.0, 3.0], [0.0; 3])
        },
        ..SpaceOptions::default()
    };
    [
        SpaceOptions::default(),
        seen(Projection::Perspective),
        seen(Projection::Orthographic),
    ]
}

#[test]
fn both_backends_draw_solids_among_surfaces_curves_and_points_alike() {
    let gpu = Arc::new(Gpu::open().expect("a GPU or software Vulkan"));
    for (number, options) in views().into_iter().enumerate() {
        let mut builder = Builder::of(OTHERS);
        let bead = builder.bead();
        let options = SpaceOptions {
            highlight: (number == 1).then_some(bead),
            ..options
        };
        let request = request(builder.scene, options);
        let software = drawn(&mut Renderer::software(), &request);
        let on_gpu = drawn(&mut Renderer::on_gpu(gpu.clone()), &request);
        keep(&format!("software-{number}"), &software);
        keep(&format!("gpu-{number}"), &on_gpu);
        let (mean, far) = difference(&software, &on_gpu);
        assert!(mean < 1.0 && far < 0.01, "{number}: {mean}, {far}");
        // In parts, for a file.
        let in_parts = Renderer::on_gpu(gpu.clone()).draw_once(&request, &|_| {});
        let (mean, far) = difference(&on_gpu, &in_parts.expect("a picture").image);
        assert!(mean < 0.1 && far < 0.001, "{number}: {mean}, {far}");
    }
}

#[test]
fn a_ball_looks_as_the_surface_of_the_same_shape() {
    let sphere = "surface s(u,v) = (cos v cos u, cos v sin u, sin v),
        u : [0, 2pi, 300], v : [-pi/2, pi/2, 150];";
    for options in views().into_iter().skip(1) {
        let mut as_surface = request(Builder::of(sphere).scene, options.clone());
        let plain = render::texture::Texture::plain();
        as_surface.textures.push((ObjectId::new(0), plain.into()));
        as_surface
            .colours
            .push((ObjectId::new(0), render::style::SOLID_COLOUR));
        let mut builder = Builder::of("");
        let ball = builder.round(&[0, 1, 2], [0.0; 3], 1.0);
        let leaf = builder.leaf("ball", ball, None);
        builder.solid("ball", vec![leaf], &[]);
        let as_solid = request(builder.scene, options);
        let mut renderer = Renderer::software();
        let [a, b] = [as_surface, as_solid].map(|request| drawn(&mut renderer, &request));
        keep("as-surface", &a);
        keep("as-solid", &b);
        let (mean, far) = difference(&a, &b);
        assert!(mean < 0.5 && far < 0.002, "{mean}, {far}");
    }
}

#[test]
fn a_surface_in_the_face_of_a_solid_is_seen_from_any_distance() {
    let text = "solid box(x, y, z) = max(abs x, abs y, abs z) - 1, color : (1, 0, 0);
        surface s(u, v) = (u, v, 1), u : [-1, 1], v : [-1, 1], color : (0, 0, 1);
        surface below(u, v) = (u, v, 0.9), u : [-1, 1], v : [-1, 1], color : (0, 1, 0);";
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for distance in [1.0, 3.0, 8.0] {
            let eye = [1.9, -2.6, 1.7].map(|x| distance * x);
            let options = SpaceOptions {
                camera: Viewpoint {
                    projection,
                    ..Viewpoint::new(eye, [0.0, 0.0, 1.0])
                },
                ..SpaceOptions::default()
            };
            let scene = scene::geotrace::compile(text).scene.expect("no errors");
            let request = request(scene, options);
            let picture = drawn(&mut Renderer::software(), &request);
            keep(&format!("face-{projection:?}-{distance}"), &picture);
            // Away from the edges of the face, which is seen as a parallelogram about the middle of the picture.
            let [width, height] = SIZE;
            let across = (0.1 * f64::from(width) / distance) as u32;
            let (left, right) = (width / 2 - across, width / 2 + across);
            for x in left..=right {
                let [r, g, b, _] = picture.get_pixel(x, height / 2).0;
                assert!(
                    r < 20 && g < 20 && b > 60,
                    "{projection:?} {distance} {x}: {r} {g} {b}"
                );
            }
        }
    }
}

#[test]
fn a_pattern_finer_than_pixels_has_its_mean_colour() {
    let text = "solid floor(x, y, z) = z, z : [-1, 0], x : [-40, 40], y : [-40, 40],
        color : 0.5 + 0.45 sin(6x) sin(6y);";
    let scene = scene::geotrace::compile(text).scene.expect("no errors");
    let options = SpaceOptions::seen_from([0.0, -38.0, 2.0], [0.0; 3]);
    let picture = drawn(&mut Renderer::software(), &request(scene, options));
    keep("floor", &picture);
    // Rows of the middle of the floor, where a pixel has about one period across and many along.
    let row = SIZE[1] / 2;
    let bytes: Vec<f64> = (0..SIZE[0])
        .map(|x| f64::from(picture.get_pixel(x, row).0[1]))
        .collect();
    let mean = bytes.iter().sum::<f64>() / bytes.len() as f64;
    let squares = bytes.iter().map(|byte| (byte - mean).powi(2));
    let deviation = (squares.sum::<f64>() / bytes.len() as f64).sqrt();
    assert!(deviation < 20.0, "{deviation} about {mean}");
}

#[test]
fn colours_that_are_defined_on_the_faces_alone_are_seen_without_a_note() {
    let options = SpaceOptions::seen_from([0.0, -4.0, 0.4], [0.0; 3]);
    let picture = |text: &str| {
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let mut renderer = Renderer::software();
        let drawn = renderer.draw(&request(scene, options.clone()));
        let drawn = drawn.expect("a picture");
        assert_eq!(drawn.notes, [], "{text}");
        renderer.read(drawn.image).expect("pixels")
    };
    let ball = "solid a(x,y,z) = x^2 + y^2 + z^2 - 1";
    let root = picture(&format!("{ball}, color : (sqrt(1 - x^2 - y^2), 0, 0);"));
    let same = picture(&format!("{ball}, color : (abs z, 0, 0);"));
    keep("root", &root);
    let (mean, far) = difference(&root, &same);
    assert!(mean < 0.2 && far == 0.0, "{mean}, {far}");
    picture(&format!("{ball}, color : ((1+x)/2, (1+y)/2, (1+z)/2);"));
    picture(&format!("{ball}, color : abs x;"));
    picture("solid a(x,y,z) = x^2 + y^2 - 1, z : [0,1], color : (z, 1-z, 0);");
    picture("solid a(x,y,z) = max(abs x, abs y, abs z) - 1, color : (1+x)/2;");
}

#[test]
fn what_lies_behind_a_solid_is_hidden_and_what_lies_before_it_is_seen() {
    let text = "point near = (0, -2, 0); point far = (0, 2, 0);";
    let eye = SpaceOptions::seen_from([0.0, -9.0, 0.0], [0.0; 3]);
    let middle = |text: &str, hidden: Vec<ObjectId>| {
        let mut builder = Builder::of(text);
        let ball = builder.round(&[0, 1, 2], [0.0; 3], 1.0);
        let leaf = builder.leaf("ball", ball, Some([0.0, 0.0, 1.0]));
        builder.solid("ball", vec![leaf], &[]);
        let options = SpaceOptions {
            hidden,
            ..eye.clone()
        };
        let mut request = request(builder.scene, options);
        request.colours = vec![
            (ObjectId::new(0), [255, 0, 0]),
            (ObjectId::new(1), [0, 255, 0]),
        ];
        let picture = drawn(&mut Renderer::software(), &request);
        picture.get_pixel(SIZE[0] / 2, SIZE[1] / 2).0
    };
    let brightest = |[r, g, b, _]: [u8; 4]| {
        let all = [r, g, b];
        all.iter()
            .position(|c| c == all.iter().max().expect("three"))
    };
    assert_eq!(brightest(middle(text, vec![])), Some(0), "before it");
    assert_eq!(
        brightest(middle(text, vec![ObjectId::new(0)])),
        Some(2),
        "the ball"
    );
    let all = vec![ObjectId::new(0), ObjectId::new(2)];
    assert_eq!(brightest(middle(text, all)), Some(1), "the ball is hidden");
}

#[test]
fn a_place_on_a_solid_is_picked_with_its_leaf() {
    let mut builder = Builder::of("point p = (0, 0, -9);");
    let bead = builder.bead();
    let options = SpaceOptions {
        hidden: vec![ObjectId::new(0)],
        ..SpaceOptions::seen_from([0.2, -2.0, 9.0], [0.2, 0.0, 0.0])
    };
    for traced in [false, true] {
        let mut request = request(builder.scene.clone(), options.clone());
        if traced {
            let space = options.clone();
            request.view = TracedOptions {
                space,
                ..TracedOptions::default()
            }
            .into();
        }
        let mut renderer = Renderer::software();
        let mut at = |place: [f64; 3]| {
            let camera = renderer.camera(&request).expect("a camera");
            let pixel = camera.pixel_of(camera.placement.local(place.into()));
            let pixel = pixel.expect("before the eye");
            renderer.pick(&request, pixel).expect("no error")
        };
        let top = at([-0.6, 0.0, 0.8]).expect("the ball");
        assert_eq!((top.object, top.leaf), (bead, Some(0)), "{traced}");
        let place = DVec3::from(top.position.expect("in space").0);
        assert!(
            (place - DVec3::new(-0.6, 0.0, 0.8)).length() < 1e-6,
            "{place}"
        );
        let inside = at([0.2, 0.4, 0.2]).expect("the hole");
        assert_eq!((inside.object, inside.leaf), (bead, Some(1)), "{traced}");
        let far = renderer
            .pick(&request, PixelPoint([1.0, 1.0]))
            .expect("no error");
        assert!(far.is_none());
    }
}

#[test]
fn endless_solids_do_not_frame_the_view_and_bounded_ones_do() {
    let framed = |with_ball: bool, with_ground: bool| {
        let mut builder = Builder::of("point p = (5, 5, 5);");
        if with_ball {
            let ball = builder.round(&[0, 1, 2], [0.0; 3], 2.0);
            let leaf = builder.leaf("ball", ball, None);
            builder.solid("ball", vec![leaf], &[]);
        }
        if with_ground {
            let ground = builder.half_space(2, -3.0);
            let leaf = builder.leaf("ground", ground, None);
            builder.solid("ground", vec![leaf], &[]);
        }
        let request = request(builder.scene, SpaceOptions::default());
        render::view::space::bounds(&request).placement
    };
    assert_eq!(framed(false, true), framed(false, false));
    assert_eq!(framed(true, true), framed(true, false));
    let ball = framed(true, false);
    let radius = (7.0_f64.powi(2) * 3.0).sqrt() / 2.0;
    assert!((ball.radius - radius).abs() < 0.1, "{ball:?}");
}

#[test]
fn a_world_is_prepared_once_and_each_pixel_of_a_moving_picture_takes_a_ray() {
    let mut builder = Builder::of("");
    builder.bead();
    let mut renderer = Renderer::software();
    let mut counts = Vec::new();
    for eye in [[0.0, -1.2, 0.0], [0.3, -1.2, 0.0]] {
        // So near that the solid fills the picture.
        let options = SpaceOptions::seen_from(eye, [0.0; 3]);
        let mut request = request(builder.scene.clone(), options);
        request.moving = true;
        renderer.draw(&request).expect("a picture");
        let WorkCounters { worlds, rays, .. } = renderer.counters();
        counts.push((worlds, rays));
    }
    let pixels = u64::from(SIZE[0] * SIZE[1]);
    assert_eq!(counts, [(1, pixels), (1, 2 * pixels)]);
}

fn traced(scene: &Scene, samples: u32) -> PictureRequest {
    let options = TracedOptions {
        space: SpaceOptions::seen_from([3.0, -5.0, 3.0], [0.0; 3]),
        samples: Some(samples),
        ..TracedOptions::default()
    };
    let params = ParamValues::initial(scene);
    PictureRequest::new(scene.clone(), params, options, SIZE)
}

#[test]
fn a_traced_picture_is_refined_by_the_samples_that_are_missing() {
    let mut builder = Builder::of(OTHERS);
    builder.bead();
    let scene = Arc::new(builder.scene);
    let request = |samples| {
        let mut request = traced(&scene, samples);
        request.scene = scene.clone().into();
        request
    };
    let pixels = u64::from(SIZE[0] * SIZE[1]);
    let mut renderer = Renderer::software();
    let first = renderer.draw(&request(1)).expect("a picture");
    assert_eq!(first.samples, Some([1, 1]));
    let refined = renderer.draw(&request(4)).expect("a picture");
    assert_eq!(refined.samples, Some([4, 3]));
    assert_eq!(renderer.counters().traced, 4 * pixels);
    assert_eq!(renderer.counters().worlds, 1);
    let at_once = drawn(&mut Renderer::software(), &request(4));
    keep("traced", &at_once);
    let Pixels::Image(refined) = refined.image else {
        panic!("in memory");
    };
    assert!(difference(&refined, &at_once).0 < 1e-3);
    // Fewer samples are another picture.
    renderer.draw(&request(2)).expect("a picture");
    assert_eq!(renderer.counters().traced, 6 * pixels);
}

#[test]
fn a_target_alone_turns_a_declared_camera() {
    let scene = crate::scenes::scene(
        "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;
        camera eye = (0, 1, 0) @ (0, -6, 0);",
    );
    let seen = |target: Option<[f64; 3]>| {
        let mut options = TracedOptions::default();
        options.space.camera.target = target.map(Into::into);
        let params = ParamValues::initial(&scene);
        let request = PictureRequest::new(&scene, Arc::new(params), options, SIZE);
        let hit = Renderer::software().pick(&request, PixelPoint([80.0, 60.0]));
        hit.expect("a picture").map(|hit| hit.object)
    };
    let ball = Some(ObjectId::new(0));
    assert_eq!(
        [
            seen(None),
            seen(Some([0.0; 3])),
            seen(Some([4.0, 0.0, 0.0]))
        ],
        [ball, ball, None]
    );
}

#[test]
fn a_camera_may_be_near_its_target_in_a_very_large_scene() {
    let scene = crate::scenes::scene(
        "solid far(x, y, z) = (x - 10^12)^2 + y^2 + z^2 - 1;
        solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;
        camera eye = (0, 1, 0) @ (0, -6, 0);",
    );
    let params = ParamValues::initial(&scene);
    let request = PictureRequest::new(&scene, Arc::new(params), TracedOptions::default(), SIZE);
    let hit = Renderer::software().pick(&request, PixelPoint([80.0, 60.0]));
    let object = hit.expect("a picture").map(|hit| hit.object);
    assert_eq!(object, Some(ObjectId::new(1)));
}

#[test]
fn a_traced_picture_that_takes_too_much_work_is_refused() {
    let mut builder = Builder::of(OTHERS);
    builder.bead();
    let limited = |most: Option<u64>| {
        let mut request = traced(&builder.scene, 4);
        let options = request.view.get_mut::<TracedOptions>().expect("traced");
        options.max_operations = most;
        request
    };
    let mut renderer = Renderer::software();
    let refused = renderer.draw(&limited(Some(1_000))).map(|_| ());
    assert_eq!(refused, Err(RenderError::TooMuchWork(1_000)));
    assert_eq!(renderer.counters().traced, 0);
    let most = render::most_traced_operations(SIZE);
    let drawn = [Some(most), None].map(|most| drawn(&mut Renderer::software(), &limited(most)));
    assert_eq!(drawn[0], drawn[1], "the same bytes");
}

#[test]
fn a_traced_picture_is_given_up_when_something_newer_waits_unless_it_moves() {
    let mut builder = Builder::of("");
    builder.bead();
    let asked = Arc::new(AtomicU32::new(0));
    let counter = asked.clone();
    let interrupt = Interrupt::new(move || counter.fetch_add(1, Ordering::Relaxed) >= 2);
    let mut renderer = Renderer::software().with_interrupt(interrupt);
    let mut request = traced(&builder.scene, 4);
    let refused = renderer.draw(&request).map(|_| ());
    assert!(
        matches!(refused, Err(RenderError::Interrupted)),
        "{refused:?}"
    );
    assert!(asked.load(Ordering::Relaxed) >= 3);
    assert_eq!(renderer.counters().traced, 0);
    request.moving = true;
    renderer.draw(&request).expect("a picture");
}

#[test]
fn a_stated_colour_wins_over_a_chosen_one_and_is_dim_with_it() {
    let text = "param a = 1 : [0, 1];
        curve c(t) = (t, 0, 0), t : [0, 1], color : (a, 0, 0);
        surface s(u,v) = (u, v, 0), u : [0, 1], v : [0, 1], color : 0.5;
        point p = (0, 0, 1);";
    let mut request = request(Builder::of(text).scene, SpaceOptions::default());
    let point = render::style::POINT_COLOUR;
    let stated = [[255, 0, 0], [128; 3], point];
    assert_eq!(request.object_colours(), stated);
    request.colours = vec![
        (ObjectId::new(0), [0, 255, 0]),
        (ObjectId::new(1), [102; 3]),
    ];
    let dim = [[255, 0, 0], [51; 3], point];
    assert_eq!(request.object_colours(), dim);
    // Nothing is written on it.
    let texture = request.texture(ObjectId::new(1));
    assert!(Arc::ptr_eq(&texture, &render::texture::Texture::plain()));
}

#[test]
fn an_image_that_is_chosen_for_a_solid_without_places_is_noted() {
    let scene = crate::scenes::scene(
        "solid b(x,y,z) = x^2 + y^2 + z^2 - 1;
        solid c(x,y,z) = x^2 + y^2 + (z - 3)^2 - 1, uv : (x, y);",
    );
    let traced = TracedOptions {
        samples: Some(1),
        ..TracedOptions::default()
    };
    let space = request(Scene::clone(&scene), SpaceOptions::default());
    let mut seen = [space.clone(), space];
    seen[1].view = traced.into();
    for request in &mut seen {
        let mut renderer = Renderer::software();
        let drawn = renderer.draw(request).expect("a picture");
        assert_eq!(drawn.notes, []);
        let image = Arc::new(Texture::from_image(RgbaImage::new(2, 2)));
        for id in [0, 1] {
            let object = ObjectId::new(id);
            request.textures.push((object, (&image).into()));
        }
        let drawn = renderer.draw(request).expect("a picture");
        let note = "`b` has no `uv`, so its image is not shown".to_owned();
        assert_eq!(drawn.notes, [Note::Remark(note)]);
    }
}

/// Returns requests for the 3D view and for the traced view of a scene.
fn in_both_views(scene: &Scene) -> [PictureRequest; 2] {
    let space = request(scene.clone(), SpaceOptions::default());
    let mut traced = space.clone();
    traced.view = TracedOptions {
        samples: Some(1),
        ..TracedOptions::default()
    }
    .into();
    [space, traced]
}

#[test]
fn a_solid_that_no_ray_meets_is_noted() {
    let balls = "solid a(x,y,z) = x^2 + y^2 + (z + 0.8)^2 - 1;
        solid b(x,y,z) = x^2 + y^2 + (z - 0.8)^2 - 1;
        solid c(x,y,z) = x^2 + y^2 + z^2 - 0.01;";
    let note = "`lens` may contain no point: no ray that looks for it meets it";
    for (lens, is_noted) in [
        // The map moves `b` alone.
        ("a & b @ rotate (pi/2, 0, 0) @ (1.5, -1, 0.6)", true),
        ("(a & b) @ rotate (pi/2, 0, 0) @ (1.5, -1, 0.6)", false),
        ("a & b", false),
    ] {
        let scene = crate::scenes::scene(&format!("{balls} solid lens = {lens};"));
        for request in in_both_views(&scene) {
            let drawn = Renderer::software().draw(&request).expect("a picture");
            let expected = is_noted.then(|| Note::Remark(note.to_owned()));
            assert_eq!(drawn.notes, Vec::from_iter(expected), "{lens}");
        }
    }
}

#[test]
fn a_camera_without_a_direction_is_noted_in_each_view() {
    let camera = "solid b(x,y,z) = x^2 + y^2 + z^2 - 1; camera c = (0, a, 0) @ (1, 2, 3);";
    let note = "`c` is left out: its position or direction is undefined, or the direction's length is 0 or too large";
    for (a, is_noted) in [("0", true), ("1e200", true), ("-2", false)] {
        let scene = crate::scenes::scene(&format!("define a = {a}; {camera}"));
        for request in in_both_views(&scene) {
            let drawn = Renderer::software().draw(&request).expect("a picture");
            let expected = is_noted.then(|| Note::Remark(note.to_owned()));
            assert_eq!(drawn.notes, Vec::from_iter(expected), "{a}");
        }
    }
}

#[test]
fn an_endless_solid_that_nothing_frames_is_noted() {
    let note = "`s` may be unbounded, so the picture does not frame it: no bound was found along z; cut it by \
                `z : [-3, 3]`, which needs the parameter z: `solid s(x, y, z)`";
    let endless = "solid s(x,y) = x^2 + y^2 - 1;";
    let cases = [
        (endless.to_owned(), true),
        (
            "solid s(x,y,z) = x^2 + y^2 - 1, z : [-1, 1];".to_owned(),
            false,
        ),
        (
            format!("{endless} solid b(x,y,z) = x^2 + y^2 + z^2 - 1;"),
            false,
        ),
        (format!("{endless} point p = (1, 2, 3);"), false),
    ];
    for (program, is_noted) in cases {
        let space = request(
            Scene::clone(&crate::scenes::scene(&program)),
            SpaceOptions::default(),
        );
        let mut placed = space.clone();
        placed.view = SpaceOptions::seen_from([5.0, 0.0, 0.0], [0.0; 3]).into();
        let mut renderer = Renderer::software();
        let drawn = renderer.draw(&space).expect("a picture");
        let expected = is_noted.then(|| Note::Remark(note.to_owned()));
        assert_eq!(drawn.notes, Vec::from_iter(expected), "{program}");
        let drawn = renderer.draw(&placed).expect("a picture");
        assert_eq!(drawn.notes, [], "{program}");
    }
}
