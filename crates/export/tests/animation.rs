//! Animations: what moves, and files read back.

#[path = "../../render/tests/suite/scenes/mod.rs"]
mod scenes;

use std::io::Cursor;

use export::animation::{
    AnimationFormat, Clip, Course, ParamChange, Recorder, Script, ScriptError,
};
use gif::ColorOutput;
use glam::DVec3;
use image::{AnimationDecoder, Rgba, RgbaImage};
use render::PictureRequest;
use render::bounds::Bounds;
use render::camera::Camera;
use render::geodesic_view::PlacedCamera;
use render::point::{DrawingPoint, WorldPoint};
use render::viewpoint::Viewpoint;
use render::viewpoint::{Pose, Projection};
use scene::ObjectId;
use scene::ParamValues;
use scenes::{Wanted, scene};

const SPHERE: &str =
    "param r : [1, 3]; surface s(u,v) = r(cosu sinv, sinu sinv, cosv), u : [0,2pi], v : [0,pi];";

/// Pictures that say their number: a grey, a gradient, a transparent corner.
fn pictures(count: u8) -> Vec<RgbaImage> {
    (0..count)
        .map(|number| {
            RgbaImage::from_fn(64, 48, |x, y| match (x, y) {
                (..8, ..8) => Rgba([0; 4]),
                (_, ..24) => Rgba([20 * number, 20 * number, 20 * number, 255]),
                _ => Rgba([40 + 2 * x as u8, 200 - 2 * x as u8, 100 + y as u8, 255]),
            })
        })
        .collect()
}

fn recorded(format: AnimationFormat, pictures: &[RgbaImage], rate: f64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let clip = Clip {
        frames: pictures.len() as u32,
        size: pictures[0].dimensions().into(),
        rate,
    };
    let mut recorder = Recorder::new(format, clip, &mut bytes).expect("a recorder");
    for picture in pictures {
        recorder.add(picture).expect("a picture");
    }
    recorder.finish().expect("a file");
    bytes
}

#[test]
fn animated_png_gives_back_every_pixel_and_repeats() {
    let pictures = pictures(7);
    let bytes = recorded(AnimationFormat::Apng, &pictures, 30.0);
    let decoder = image::codecs::png::PngDecoder::new(Cursor::new(&bytes)).expect("a PNG");
    assert!(decoder.is_apng().expect("a header"));
    let frames = decoder.apng().expect("animated").into_frames();
    let frames = frames.collect_frames().expect("frames");
    assert_eq!(frames.len(), 7);
    let mut milliseconds = 0.0;
    for (frame, picture) in frames.iter().zip(&pictures) {
        assert_eq!(frame.buffer(), picture);
        let (numerator, denominator) = frame.delay().numer_denom_ms();
        milliseconds += f64::from(numerator) / f64::from(denominator);
    }
    assert!((milliseconds - 7000.0 / 30.0).abs() < 0.6, "{milliseconds}");
}

#[test]
fn gif_keeps_time_transparency_and_nearly_the_colours() {
    let pictures = pictures(9);
    let bytes = recorded(AnimationFormat::Gif, &pictures, 30.0);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(&bytes[..]).expect("a GIF");
    assert_eq!((decoder.width(), decoder.height()), (64, 48));
    let (mut count, mut hundredths) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        let picture = &pictures[count];
        // Sums over the squares of the pattern: it gives back on the whole what it takes from each pixel.
        let mut squares = [[[0_i32; 3]; 16]; 12];
        for (index, (pixel, original)) in frame.buffer.chunks(4).zip(picture.pixels()).enumerate() {
            assert_eq!(pixel[3], original.0[3]);
            if pixel[3] > 0 {
                let square = &mut squares[index / 64 / 4][index % 64 / 4];
                for k in 0..3 {
                    let off = i32::from(pixel[k]) - i32::from(original.0[k]);
                    assert!(off.abs() < 80, "frame {count}: off by {off}");
                    square[k] += off;
                }
            }
        }
        let sums = squares.as_flattened().as_flattened().iter();
        let worst = sums.clone().map(|sum| sum.abs()).max();
        assert!(
            worst < Some(16 * 16),
            "frame {count}: off by {worst:?} / 16"
        );
        let mean = sums.map(|sum| f64::from(sum.abs()) / 16.0).sum::<f64>() / (3.0 * 16.0 * 12.0);
        assert!(mean < 1.5, "frame {count}: off by {mean}");
        hundredths += u32::from(frame.delay);
        count += 1;
    }
    assert_eq!((count, hundredths), (9, 30));
}

#[test]
fn a_gif_of_few_colours_has_them_exactly() {
    let picture = RgbaImage::from_fn(30, 30, |x, y| {
        Rgba([8 * x as u8, 0, 50 * (y as u8 / 6), 255])
    });
    let bytes = recorded(AnimationFormat::Gif, std::slice::from_ref(&picture), 10.0);
    let decoded = image::load_from_memory(&bytes).expect("a GIF").into_rgba8();
    assert_eq!(decoded, picture);
}

/// The pixels of the first picture of a GIF.
fn first_of_gif(picture: &RgbaImage) -> RgbaImage {
    let bytes = recorded(AnimationFormat::Gif, std::slice::from_ref(picture), 10.0);
    image::load_from_memory(&bytes).expect("a GIF").into_rgba8()
}

#[test]
fn small_parts_of_a_gif_keep_their_colours() {
    // A gradient with ten thousand colours, and a few pixels of others.
    let picture = RgbaImage::from_fn(100, 100, |x, y| match (x, y) {
        (50..53, 50..53) => Rgba([255; 4]),
        (20..22, 70..72) => Rgba([0, 0, 255, 255]),
        _ => Rgba([(x * 255 / 99) as u8, (y * 255 / 99) as u8, 60, 255]),
    });
    let found = first_of_gif(&picture);
    for (place, pixel) in [
        ([51, 51], [255; 3]),
        ([52, 50], [255; 3]),
        ([21, 71], [0, 0, 255]),
    ] {
        assert_eq!(
            found.get_pixel(place[0], place[1]).0[..3],
            pixel,
            "{place:?}"
        );
    }
    for (x, y, pixel) in found.enumerate_pixels() {
        let original = picture.get_pixel(x, y);
        let off = (0..3).map(|k| pixel.0[k].abs_diff(original.0[k])).max();
        assert!(off < Some(40), "({x}, {y}): {pixel:?} for {original:?}");
    }

    // One more colour than the palette has.
    let picture = RgbaImage::from_fn(16, 16, |x, y| {
        Rgba([17 * x as u8, 17 * y as u8, (x * y) as u8, 255])
    });
    let found = first_of_gif(&picture);
    let pairs = found.pixels().zip(picture.pixels());
    let wrong = pairs.filter(|(found, original)| found != original);
    assert!(wrong.count() <= 2);
}

#[test]
fn slow_animations_keep_their_time() {
    for rate in [0.01, 0.0152, 0.0153, 0.1] {
        let pictures = pictures(3);
        let bytes = recorded(AnimationFormat::Apng, &pictures, rate);
        let decoder = image::codecs::png::PngDecoder::new(Cursor::new(&bytes)).expect("a PNG");
        let frames = decoder.apng().expect("animated").into_frames();
        let seconds = frames.map(|frame| {
            let (numerator, denominator) = frame.expect("a frame").delay().numer_denom_ms();
            f64::from(numerator) / f64::from(denominator) / 1000.0
        });
        let seconds: f64 = seconds.sum();
        assert!((seconds - 3.0 / rate).abs() < 0.02, "{rate}: {seconds}");
        let clip = Clip {
            frames: 3,
            size: [1; 2],
            rate,
        };
        let stated = clip.seconds(AnimationFormat::Apng);
        assert!((stated - seconds).abs() < 0.02, "{rate}: {stated}");
    }
}

#[test]
fn too_few_or_other_pictures_are_no_animation() {
    let clip = Clip {
        frames: 2,
        size: [4, 4],
        rate: 10.0,
    };
    for format in [AnimationFormat::Gif, AnimationFormat::Apng] {
        let mut recorder = Recorder::new(format, clip, Vec::new()).expect("a recorder");
        assert!(recorder.add(&RgbaImage::new(5, 4)).is_err());
        recorder.add(&RgbaImage::new(4, 4)).expect("a picture");
        assert!(recorder.finish().is_err());
        assert!(Recorder::new(format, Clip { rate: 0.0, ..clip }, Vec::new()).is_err());
    }
}

#[test]
fn params_run_from_one_end_to_the_other() {
    let scene = scene(SPHERE);
    let params = ParamValues::initial(&scene);
    let request = Wanted::space([8, 8]).of(&scene, &params);
    let script = Script {
        changes: vec![ParamChange {
            name: "r".into(),
            from: vec![3.0],
            to: vec![1.0],
        }],
        ..Script::default()
    };
    let values = (0..5).map(|frame| {
        let share = Course::Once.share(frame, 5);
        let frame = script.frame_at(&request, share).expect("params");
        frame.params.param(&scene.params[0])[0]
    });
    assert_eq!(values.collect::<Vec<_>>(), [3.0, 2.5, 2.0, 1.5, 1.0]);
    let mut wrong = script.clone();
    wrong.changes[0].to = vec![9.0];
    let refused = wrong.frame_at(&request, 1.0);
    assert!(matches!(refused, Err(ScriptError::Set(_))), "{refused:?}");
}

#[test]
fn a_param_runs_through_an_interval_longer_than_the_largest_number() {
    let scene = scene("param k : [-1e308, 1e308]; point p = (k, 0, 0);");
    let params = ParamValues::initial(&scene);
    let request = Wanted::space([8, 8]).of(&scene, &params);
    let script = Script {
        changes: vec![ParamChange {
            name: "k".into(),
            from: vec![-1e308],
            to: vec![1e308],
        }],
        ..Script::default()
    };
    let frame = script.frame_at(&request, 0.75).expect("in its interval");
    assert_eq!(frame.params.param(&scene.params[0]), [0.5e308]);
}

#[test]
fn courses_have_their_ends_where_they_say() {
    let shares = |course: Course, frames: u32| -> Vec<f64> {
        (0..frames).map(|k| course.share(k, frames)).collect()
    };
    assert_eq!(shares(Course::Once, 3), [0.0, 0.5, 1.0]);
    assert_eq!(shares(Course::Loop, 4), [0.0, 0.25, 0.5, 0.75]);
    assert_eq!(shares(Course::BackAndForth, 4), [0.0, 0.5, 1.0, 0.5]);
    assert_eq!(shares(Course::Once, 1), [0.0]);
}

#[test]
fn a_turntable_goes_round_the_middle_and_sees_everything() {
    // A bar along x, whose middle is (3, 0, 1).
    let scene = scene("curve c(t) = (3 + 2t, 0, 1 + sin(3t)/9), t : [-1, 1];");
    let params = ParamValues::initial(&scene);
    let script = Script {
        turntable: true,
        ..Script::default()
    };
    for is_orthographic in [false, true] {
        let mut request = Wanted::space([64, 48]);
        if is_orthographic {
            request.in_space().camera.projection = Projection::Orthographic;
        }
        let request = request.of(&scene, &params);
        let steady = script.steady(&request).expect("a camera");
        let size = |share: f64| {
            let frame = script.frame_at(&steady, share).expect("a frame");
            let camera = frame.view.space().expect("a view in space").camera;
            let [eye, target] = [camera.eye, camera.target].map(|place| place.expect("given").0);
            let target = DVec3::from(target);
            assert!(
                (target.truncate() - glam::DVec2::new(3.0, 0.0)).length() < 0.01,
                "{target}"
            );
            let bounds = Bounds::of(&scene, &params);
            let placed = Camera::new(&bounds, &camera, [64, 48]).expect("a camera");
            for end in [-1.0, 1.0] {
                let place = bounds
                    .placement
                    .local(WorldPoint([3.0 + 2.0 * end, 0.0, 1.0]));
                let seen = DVec3::from(place.0) - placed.eye;
                let [right, up, back] = placed.axes.map(|axis| axis.dot(seen));
                assert!(back < 0.0);
                let tangent = f64::tan(0.5 * render::style::FIELD_OF_VIEW);
                let far = placed.parallel.map_or(-back, |parallel| parallel.distance);
                assert!(up.abs() < far * tangent && right.abs() < far * tangent * 64.0 / 48.0);
            }
            DVec3::from(eye) - target
        };
        let start = size(0.0);
        for (share, [x, y]) in [(0.25, [-start.y, start.x]), (0.5, [-start.x, -start.y])] {
            let turned = size(share);
            let off = (turned - DVec3::new(x, y, start.z)).length();
            assert!(off < 1e-9 * start.length(), "{share}: {turned}");
        }
    }
    let mut placed = Wanted::space([8, 8]);
    placed.in_space().camera =
        Viewpoint::new(WorldPoint([5.0, 0.0, 2.0]), WorldPoint([1.0, 0.0, 0.0]));
    let request = placed.of(&scene, &params);
    let steady = script.steady(&request).expect("a camera");
    let half = script.frame_at(&steady, 0.5).expect("a frame");
    let eye = half.view.space().and_then(|space| space.camera.eye);
    let eye = DVec3::from(eye.expect("given").0);
    assert!((eye - DVec3::new(-3.0, 0.0, 2.0)).length() < 1e-12, "{eye}");
}

#[test]
fn the_camera_in_space_stands_still_and_sees_everything() {
    let scene = scene(SPHERE);
    let mut params = ParamValues::initial(&scene);
    let request = Wanted::space([64, 64]).of(&scene, &params);
    let script = Script {
        changes: vec![ParamChange {
            name: "r".into(),
            from: vec![1.0],
            to: vec![3.0],
        }],
        ..Script::default()
    };
    let steady = script.steady(&request).expect("a camera");
    let camera = steady.view.space().expect("a view in space").camera;
    let (Some(eye), Some(target)) = (camera.eye, camera.target) else {
        panic!("{camera:?}")
    };
    // It stands where the largest sphere wants it, and looks at its centre.
    params.set(&scene, "r", &[3.0]).expect("in range");
    let bounds = Bounds::of(&scene, &params);
    let camera = Camera::new(&bounds, &Viewpoint::default(), [64, 64]).expect("a camera");
    let wanted = DVec3::from(
        bounds
            .placement
            .world(DrawingPoint(camera.eye.to_array()))
            .0,
    );
    let eye = DVec3::from(eye.0);
    assert!((eye - wanted).length() < 0.01 * wanted.length(), "{eye}");
    let ahead = (DVec3::from(target.0) - eye).normalize();
    assert!(ahead.dot(-eye.normalize()) > 0.9999, "{ahead}");
    let steady = Script::default().steady(&request).expect("a camera");
    assert_eq!(steady.view, request.view);
}

#[test]
fn a_declared_camera_moves_as_the_program_says() {
    let scene = scene(
        "param t : [0, 5]; solid b(x, y, z) = x^2 + y^2 + z^2 - 1; camera eye = (-t, 8, 0) @ (t, -8, 0);",
    );
    let params = ParamValues::initial(&scene);
    let request = Wanted::space([64, 64]).of(&scene, &params);
    let mut script = Script {
        changes: vec![ParamChange {
            name: "t".into(),
            from: vec![0.0],
            to: vec![5.0],
        }],
        ..Script::default()
    };
    let steady = script.steady(&request).expect("a camera");
    assert_eq!(steady.view, request.view);
    // One that is turned stands still but for that.
    script.turntable = true;
    let turned = script.steady(&request).expect("a camera");
    assert!(turned.view != request.view);
}

#[test]
fn a_walk_round_a_great_circle_comes_back_with_its_length() {
    let scene = scene(SPHERE);
    let params = ParamValues::initial(&scene);
    let mut request = Wanted::geodesic(ObjectId::new(0), [64, 64]);
    request.inside().camera.pose = Pose::At {
        at: Some([1.0, 1.2]),
        angle: 0.7,
        mirrored: false,
    };
    let request = request.of(&scene, &params);
    let script = Script {
        walk: Some(std::f64::consts::TAU),
        trail: true,
        ..Script::default()
    };
    let frame = |request: &PictureRequest| {
        let camera = request.view.geodesic_camera().expect("a geodesic view");
        let placed = PlacedCamera::new(&scene, &params, camera, request.size);
        placed.expect("a camera").frame
    };
    let start = frame(&request);
    let half = script.frame_at(&request, 0.5).expect("a walk");
    let whole = script.frame_at(&request, 1.0).expect("a walk");
    let middle = frame(&half).uv;
    assert!(
        (middle[1] - (std::f64::consts::PI - 1.2)).abs() < 1e-7,
        "{middle:?}"
    );
    let end = frame(&whole);
    for k in 0..2 {
        assert!((end.uv[k] - start.uv[k]).abs() < 1e-7, "{end:?}");
        assert!((end.x[k] - start.x[k]).abs() < 1e-7, "{end:?}");
        assert!((end.y[k] - start.y[k]).abs() < 1e-7, "{end:?}");
    }
    let trail = &whole.trails[0];
    assert!((trail.length - std::f64::consts::TAU).abs() < 1e-9);
    assert_eq!(trail.points[0], start.uv.0);
    // The polyline's own length, by the metric in the middle of each piece.
    let mut length = 0.0;
    for pair in trail.points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let du = (b[0] - a[0] + 3.0 * std::f64::consts::PI).rem_euclid(std::f64::consts::TAU)
            - std::f64::consts::PI;
        let sin = (0.5 * (a[1] + b[1])).sin();
        length += (du * sin).hypot(b[1] - a[1]);
    }
    assert!((length - trail.length).abs() < 1e-2, "{length}");
}
