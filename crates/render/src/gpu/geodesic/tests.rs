//! The generated kernel's maps against closed forms.

use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::map::Map;
use geodesic::surface::Sides;
use scene::{ObjectId, Shape};

use super::chart::CONE;
use super::*;
use crate::gpu::device;
use crate::request::View;

/// The numbers of sides in lib/chart.wgsl.
const EDGE: u32 = 0;
const WRAP: u32 = 1;
const FLIP: u32 = 2;
const POLE: u32 = 3;

/// The map of a surface with sides of the caller's choice.
fn map(
    text: &str,
    at: [f64; 2],
    tangents: [[f64; 2]; 2],
    sides: [u32; 4],
    zoom: f64,
    size: u32,
) -> Map {
    let scene = scene::geotrace::compile(text).scene.expect("no errors");
    let Some(Shape::Surface {
        position, domain, ..
    }) = scene.objects.last().map(|object| &object.shape)
    else {
        panic!("no surface");
    };
    let gpu = device::open().expect("a GPU or software Vulkan");
    let kernel = wgsl::kernel::geodesic(&scene.graph, *position).expect("small");
    let domain = [0, 1].map(|k| [domain[k].range.min, domain[k].range.max]);
    let [x, y] = tangents.map(|t| t.map(|c| c * zoom));
    gpu.guarded(|| {
        let mut workshop = Workshop::new(gpu);
        let source = MapSource::kernel(&mut workshop, &kernel, &[]);
        let chart = Chart {
            sides,
            ..Chart::new(
                &Frame {
                    uv: at.into(),
                    coordinates: Coordinates::Plain,
                    x: x.into(),
                    y: y.into(),
                },
                domain,
                Sides::default(),
                zoom,
            )
        };
        source.whole(&workshop, &chart, [size, size])
    })
    .expect("a map")
}

/// For each pixel its index, (x, y) in [−1,1]² and its (u, v).
fn pixels(map: &Map) -> impl Iterator<Item = (usize, [f64; 2], [f64; 2])> {
    let size = map.size[0] as usize;
    (0..map.offset.len()).map(move |index| {
        let [x, y] = [index % size, index / size].map(|k| (2 * k + 1) as f64 / size as f64 - 1.0);
        (index, [x, -y], map.uv(index).0)
    })
}

const SPHERE: &str =
    "surface s(u, v) = (cos u cos v, sin u cos v, sin v), u : [-pi, pi], v : [-pi/2, pi/2];";

#[test]
fn the_whole_sphere_is_seen_through_its_poles() {
    let sides = [WRAP, WRAP, POLE, POLE];
    let zoom = 1.1 * std::f64::consts::PI;
    let map = map(
        SPHERE,
        [0.3, 0.2],
        [[1.0 / 0.2f64.cos(), 0.0], [0.0, 1.0]],
        sides,
        zoom,
        128,
    );
    let (sin_u, cos_u) = 0.3f64.sin_cos();
    let (sin_v, cos_v) = 0.2f64.sin_cos();
    let eye = [cos_u * cos_v, sin_u * cos_v, sin_v];
    let east = [-sin_u, cos_u, 0.0];
    let north = [-cos_u * sin_v, -sin_u * sin_v, cos_v];
    let mut errors: Vec<f64> = Vec::new();
    for (index, [x, y], [u, v]) in pixels(&map) {
        assert_eq!(map.status[index], Status::Complete, "pixel {index}");
        let r = zoom * x.hypot(y);
        let (sin, cos) = r.sin_cos();
        let expected =
            [0, 1, 2].map(|k| eye[k] * cos + (x * east[k] + y * north[k]) * zoom / r * sin);
        let found = [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()];
        errors.push(
            found
                .iter()
                .zip(expected)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt(),
        );
    }
    errors.sort_by(f64::total_cmp);
    let pixel = zoom / 64.0;
    let worst = errors[errors.len() - 1] / pixel;
    println!(
        "worst {worst:.4} pixels, median {:.5}",
        errors[errors.len() / 2] / pixel
    );
    assert!(worst < 0.2, "{worst} pixels");
}

/// The camera of the sphere so far from its pole, and what the kernel makes of it.
fn beside_the_pole(from_pole: f64) -> (geodesic_view::Inside, Option<Map>) {
    let scene = scene::geotrace::compile(SPHERE).scene.expect("no errors");
    let settings = ParamValues::initial(&scene);
    let mut request = Request::geodesic(ObjectId(0), [48, 48]);
    if let View::Geodesic { at, zoom, .. } = &mut request.view {
        *at = Some([0.3, std::f64::consts::FRAC_PI_2 - from_pole]);
        *zoom = Some(1.0);
    }
    let gpu = device::open().expect("a GPU or software Vulkan");
    let inside = geodesic_view::Inside::new(&scene, &settings, &request).expect("a camera");
    let kernel = gpu.guarded(|| {
        let mut workshop = Workshop::new(gpu);
        super::map(&mut workshop, &scene, &settings, &request)
    });
    (inside, kernel.expect("a device"))
}

#[test]
fn a_camera_beside_a_pole_sees_the_same_by_the_kernel_as_by_the_fan() {
    for from_pole in [0.3, 0.1, 1e-2] {
        let (inside, kernel) = beside_the_pole(from_pole);
        let kernel = kernel.expect("a small kernel");
        let fan = inside.map(&|_| {});
        let place = |[u, v]: [f64; 2]| [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()];
        let mut worst = 0.0_f64;
        for (index, _, uv) in pixels(&kernel) {
            assert_eq!(kernel.status[index], Status::Complete, "pixel {index}");
            let pairs = place(uv).into_iter().zip(place(fan.uv(index).0));
            let square: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            worst = worst.max(24.0 * square.sqrt());
        }
        assert!(worst < 0.1, "{from_pole} from the pole: {worst} pixels");
    }
}

#[test]
fn at_a_pole_the_kernel_leaves_the_picture_to_what_has_coordinates_there() {
    for from_pole in [0.0, 1e-9, 1e-3] {
        let (inside, kernel) = beside_the_pole(from_pole);
        assert!(inside.frame.coordinates != Coordinates::Plain);
        assert!(kernel.is_none(), "{from_pole} from the pole");
    }
}

#[test]
fn a_sphere_of_any_size_and_chart_gives_the_same_picture() {
    let sides = [WRAP, WRAP, POLE, POLE];
    let plain = map(
        SPHERE,
        [0.3, 0.2],
        [[1.0 / 0.2f64.cos(), 0.0], [0.0, 1.0]],
        sides,
        2.0,
        48,
    );
    let scaled = "surface s(u, v) = 10^6 (cos(10^10 u) cos v, sin(10^10 u) cos v, sin v),
        u : [-pi/10^10, pi/10^10], v : [-pi/2, pi/2];";
    let tangents = [[1e-16 / 0.2f64.cos(), 0.0], [0.0, 1e-6]];
    let scaled = map(scaled, [0.3e-10, 0.2], tangents, sides, 2e6, 48);
    for index in 0..plain.offset.len() {
        let (a, b) = (plain.uv(index), scaled.uv(index));
        assert_eq!(plain.status[index], scaled.status[index]);
        let turns = (a[0] - b[0] * 1e10) / std::f64::consts::TAU;
        assert!(
            (turns - turns.round()).abs() < 1e-3 && (a[1] - b[1]).abs() < 2e-3,
            "{a:?} {b:?}"
        );
    }
}

#[test]
fn a_torus_repeats_and_keeps_clairaut_in_every_pixel() {
    let text = "surface s(u, v) = ((1 + 0.4 cos v) cos u, (1 + 0.4 cos v) sin u, 0.4 sin v),
        u : [0, 2pi], v : [0, 2pi];";
    let sides = [WRAP; 4];
    let map = map(
        text,
        [1.0, 3.0],
        [[1.0 / (1.0 + 0.4 * 3f64.cos()), 0.0], [0.0, 2.5]],
        sides,
        3.0,
        64,
    );
    for (index, _, uv) in pixels(&map) {
        assert_eq!(map.status[index], Status::Complete);
        assert!(
            uv.iter()
                .all(|&c| (-1e-4..=std::f64::consts::TAU + 1e-4).contains(&c)),
            "{uv:?}"
        );
    }
    // There and back: a geodesic along the meridian v returns after its length.
    let whole = std::f64::consts::TAU * 0.4;
    let middle = super::tests::map(
        text,
        [1.0, 3.0],
        [[0.7, 0.0], [0.0, 2.5]],
        sides,
        2.0 * whole,
        1,
    );
    assert!((middle.uv(0)[0] - 1.0).abs() < 1e-6 && (middle.uv(0)[1] - 3.0).abs() < 1e-6);
}

#[test]
fn a_cone_is_unrolled_and_its_tip_ends_what_hits_it() {
    // Slope 45°: the angle around the tip is u / √2; v is the distance from the tip over √2.
    let text = "surface s(u, v) = (v cos u, v sin u, v), u : [-pi, pi], v : [0, 10];";
    let sides = [WRAP, WRAP, CONE, EDGE];
    let root = std::f64::consts::SQRT_2;
    let map = map(
        text,
        [0.0, 1.0],
        [[1.0, 0.0], [0.0, 1.0 / root]],
        sides,
        1.3,
        64,
    );
    for (index, [x, y], [u, v]) in pixels(&map) {
        // Unrolled: the camera at (√2, 0), X is across, Y away from the tip.
        let place = [root + 1.3 * y, 1.3 * x];
        let (distance, angle) = (place[0].hypot(place[1]), place[1].atan2(place[0]));
        if map.status[index] != Status::Complete {
            assert_eq!(map.status[index], Status::ConePoint);
            continue;
        }
        assert!((v * root - distance).abs() < 2e-3, "{x} {y}: {v}");
        let turn = (u - angle * root) / std::f64::consts::TAU;
        assert!((turn - turn.round()).abs() < 2e-3, "{x} {y}: {u}");
    }
}

#[test]
fn a_moebius_strip_is_passed_with_a_flip_and_left_at_its_edge() {
    let text = "surface s(u, v) = ((2 + v cos(u/2)) cos u, (2 + v cos(u/2)) sin u, v sin(u/2)),
        u : [0, 2pi], v : [-1, 1];";
    let sides = [FLIP, FLIP, EDGE, EDGE];
    let map = map(
        text,
        [0.1, 0.5],
        [[-1.0 / 2.5, 0.0], [0.0, 1.0]],
        sides,
        0.8,
        32,
    );
    let mut flipped = 0;
    for (index, [_, y], [u, v]) in pixels(&map) {
        match map.status[index] {
            Status::Complete => {
                assert!(
                    v.abs() <= 1.0 + 1e-4 && (-1e-4..=6.2833).contains(&u),
                    "{u} {v}"
                );
                if u > 3.0 {
                    flipped += 1;
                    let unfolded = 0.5 + 0.8 * y;
                    assert!(
                        (v + unfolded).abs() < 0.3,
                        "what was above is below: {v}, {unfolded}"
                    );
                }
            }
            Status::LeftDomain => assert!(y > 0.3, "{y}"),
            other => panic!("{other:?}"),
        }
    }
    assert!(flipped > 100, "{flipped}");
}

#[test]
fn what_is_undefined_degenerate_or_endless_ends_with_its_status() {
    // Defined for v ≤ 0.5 only, inside its domain.
    let hole = "surface s(u, v) = (u, v, sqrt(0.5 - v)), u : [-1, 1], v : [-1, 1];";
    let edges = [EDGE; 4];
    let found = map(hole, [0.0, 0.0], [[1.0, 0.0], [0.0, 0.8]], edges, 0.9, 32);
    assert!(found.status.contains(&Status::Complete));
    assert!(
        found
            .status
            .iter()
            .all(|s| *s != Status::WorkLimit && *s != Status::ConePoint),
        "{:?}",
        found.status
    );
    // A cuspidal edge at u = 0.
    let cusp = "surface s(u, v) = (u^2, u^3, v), u : [-1, 1], v : [-1, 1];";
    let found = map(cusp, [0.5, 0.0], [[0.8, 0.0], [0.0, 1.0]], edges, 0.5, 32);
    assert!(found.status.contains(&Status::Degenerate));
    assert!(found.status.contains(&Status::Complete));
    for (index, offset) in found.offset.iter().enumerate() {
        assert!(offset.iter().all(|c| c.is_finite()), "pixel {index}");
    }
}

#[test]
fn the_pass_reads_a_table_of_the_layout_that_is_written() {
    use geodesic::patchwork::table::{APEX_WORDS, PATCH_WORDS, SINGLE_WORDS};
    use geodesic::patchwork::{ARC_TANGENT, BLOCK, DEGREE};
    let joined = wgsl::painter::resolve_patchwork().expect("valid");
    let text = joined.source();
    for (name, value) in [
        ("APEX_WORDS", APEX_WORDS),
        ("PATCH_WORDS", PATCH_WORDS),
        ("SINGLE_WORDS", SINGLE_WORDS),
        ("DEGREE", DEGREE),
    ] {
        let line = format!("const {name}: u32 = {value}u;");
        assert!(text.contains(&line), "{line}");
    }
    assert_eq!(BLOCK, 8, "a workgroup is a block");
    for coefficient in ARC_TANGENT {
        let number = coefficient.abs().to_string();
        assert!(text.contains(&number), "{number}");
    }
}
