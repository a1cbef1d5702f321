//! Images on surfaces: where they end, whose colour they have, and those of instances, in all views.

use std::sync::Arc;

use image::{Rgba, RgbaImage};
use render::gpu::Gpu;
use render::point::WorldPoint;
use render::request::part::SpaceOptions;
use render::texture::Texture;
use render::view::geodesic::GeodesicOptions;
use render::view::traced::TracedOptions;
use render::viewpoint::GeodesicCamera;
use render::{PictureRequest, Renderer};
use scene::{ObjectId, ParamValues};

const SIDE: u32 = 96;
const FIRST: ObjectId = ObjectId::new(0);

/// A picture from space, by each of the two views and backends.
fn pictures(request: &PictureRequest, eye: [f64; 3]) -> Vec<(&'static str, RgbaImage)> {
    let space = SpaceOptions::seen_from(eye, [0.0; 3]);
    let traced = TracedOptions {
        space: space.clone(),
        ..TracedOptions::default()
    };
    let mut request = request.clone();
    request.view = space.into();
    let gpu = Gpu::shared().expect("a GPU or software Vulkan");
    let draw = |mut renderer: Renderer, request: &PictureRequest| {
        let drawn = renderer.draw(request).expect("a picture");
        renderer.read(drawn.image).expect("the device is there")
    };
    let software = draw(Renderer::software(), &request);
    let by_gpu = draw(Renderer::on_gpu(gpu), &request);
    request.view = traced.into();
    let traced = draw(Renderer::software(), &request);
    vec![("software", software), ("GPU", by_gpu), ("traced", traced)]
}

fn request(text: &str) -> PictureRequest {
    let scene = crate::scenes::scene(text);
    let params = Arc::new(ParamValues::initial(&scene));
    PictureRequest::new(&scene, params, SpaceOptions::default(), [SIDE; 2])
}

/// An image whose upper half is red, and whose lower half is blue.
fn two_halves() -> Arc<Texture> {
    let colour = |y: u32| match y < 16 {
        true => Rgba([255, 0, 0, 255]),
        false => Rgba([0, 0, 255, 255]),
    };
    Arc::new(Texture::from_image(RgbaImage::from_fn(64, 32, |_, y| {
        colour(y)
    })))
}

/// The largest part of blue in red pixels, and of red in blue ones, within some pixels of the middle.
fn mixed(image: &RgbaImage, reach: u32) -> u8 {
    let middle = SIDE / 2 - reach..SIDE / 2 + reach;
    let places = middle
        .clone()
        .flat_map(|y| middle.clone().map(move |x| (x, y)));
    let least = places
        .map(|(x, y)| image.get_pixel(x, y).0)
        .map(|it| it[0].min(it[2]));
    least.max().expect("pixels")
}

#[test]
fn an_image_ends_at_poles_and_open_sides() {
    let sphere =
        "surface s(u, v) = (cosu cosv, sinu cosv, sinv), u : [-pi, pi, 60], v : [-pi/2, pi/2, 31];";
    let cases = [
        (sphere, [0.01, 0.0, 4.0]),
        (sphere, [0.01, 0.0, -4.0]),
        // The lower side of a square is in the middle of the picture, and its upper one.
        (
            "surface s(u, v) = (u, v, 0), u : [-1, 1, 9], v : [0, 1, 9];",
            [0.0, 0.01, 4.0],
        ),
        (
            "surface s(u, v) = (u, v, 0), u : [-1, 1, 9], v : [-1, 0, 9];",
            [0.0, -0.01, 4.0],
        ),
    ];
    for (text, eye) in cases {
        let mut request = request(text);
        request.textures = vec![(FIRST, two_halves().into())];
        for (how, image) in pictures(&request, eye) {
            // A highlight is a little white.
            let mixed = mixed(&image, 3);
            assert!(mixed < 90, "{text} from {eye:?}, {how}: {mixed}");
        }
    }
}

#[test]
fn an_image_goes_on_across_glued_sides_and_where_its_place_is_stated() {
    // Texels are black and white columns: across the seam, at y = 0, there is grey.
    let half = RgbaImage::from_fn(8, 8, |x, _| match x < 4 {
        true => Rgba([0, 0, 0, 255]),
        false => Rgba([255; 4]),
    });
    let torus = "surface s(u, v) = ((2 + cosv) cosu, (2 + cosv) sinu, sinv), u : [0, 2pi, 61], v : [0, 2pi, 31];";
    let mut request = request(torus);
    request.textures = vec![(FIRST, Arc::new(Texture::from_image(half.clone())).into())];
    let across = |image: &RgbaImage| {
        let column = (0..SIDE).map(|y| image.get_pixel(SIDE - 28, y).0[0]);
        column.filter(|byte| (70..=170).contains(byte)).count()
    };
    for (how, image) in pictures(&request, [0.0, -0.01, 9.0]) {
        assert!(across(&image) >= 2, "{how}");
    }
    // A plane with two widths of the image: in its middle the second one begins.
    let plane = "surface s(u, v) = (u, v, 0), u : [-1, 1, 9], v : [-1, 1, 9], uv : (u + 1, v);";
    let mut request = self::request(plane);
    request.textures = vec![(FIRST, Arc::new(Texture::from_image(half)).into())];
    let (_, traced) = pictures(&request, [0.0, -0.01, 4.0]).pop().expect("traced");
    let row = (0..SIDE).map(|x| traced.get_pixel(x, SIDE / 2).0[0]);
    let row: Vec<bool> = row.map(|byte| byte > 128).collect();
    let changes = row.windows(2).filter(|pair| pair[0] != pair[1]).count();
    // Black, white, black, white, then the background.
    assert!(changes >= 4, "{row:?}");
}

#[test]
fn the_image_of_a_background_ends_at_the_zenith() {
    let mut request = request("background sky = 1; point p = (9, 0, 0);");
    request.background_image = Some(two_halves().into());
    for up in [1.0, -1.0] {
        let space = SpaceOptions::seen_from([0.0, 0.001 * up, -0.5 * up], [0.0, 0.0, up]);
        request.view = TracedOptions {
            space,
            ..TracedOptions::default()
        }
        .into();
        let mut renderer = Renderer::software();
        let drawn = renderer.draw(&request).expect("a picture");
        let image = renderer.read(drawn.image).expect("in memory");
        let [red, _, blue, _] = image.get_pixel(SIDE / 2, SIDE / 2).0;
        assert!(red.max(blue) > 200, "{up}: {red}, {blue}");
        let mixed = mixed(&image, 12);
        assert!(mixed < 9, "{up}: {mixed}");
    }
}

#[test]
fn colours_of_curvature_are_not_multiplied_by_that_of_the_surface() {
    let saddle = "surface s(u, v) = (u, v, u^2 - v^2), u : [-1, 1, 21], v : [-1, 1, 21]";
    let attributes = ["", ", color : (0.9, 0.1, 0.1)", ", color : (abs u, 0, 0)"];
    let mut seen: Vec<Vec<[u8; 4]>> = Vec::new();
    for attribute in attributes {
        let mut request = request(&format!("{saddle}{attribute};"));
        request.curved = vec![FIRST];
        for chosen in [false, true] {
            if chosen {
                request.colours = vec![(FIRST, [255, 255, 0])];
            }
            let all = pictures(&request, [0.0, -0.01, 4.0]);
            let middle = |image: &RgbaImage| image.get_pixel(SIDE / 2, SIDE / 2).0;
            let mut colours: Vec<[u8; 4]> = all.iter().map(|(_, image)| middle(image)).collect();
            let mut inside = request.clone();
            let camera = GeodesicCamera::new(FIRST).at([0.0, 0.0]).zoomed(0.5);
            inside.view = GeodesicOptions {
                mark_centre: false,
                ..camera.into()
            }
            .into();
            let mut renderer = Renderer::software();
            let drawn = renderer.draw(&inside).expect("a picture");
            colours.push(middle(&renderer.read(drawn.image).expect("in memory")));
            seen.push(colours);
        }
    }
    let [red, _, blue, _] = seen[0][0];
    assert!(blue > red + 60, "{seen:?}");
    assert!(seen.iter().all(|colours| *colours == seen[0]), "{seen:?}");
    let dark = "metric h(x, y) = (1, 0, 1)/y^2, x : [-2, 2], y : [1, 4], color : (0.9, 0.2, 0.2);";
    let mut inside = request(dark);
    inside.curved = vec![FIRST];
    assert_eq!(inside.srgb(FIRST), [255; 3]);
}

/// Three spheres from left to right, of the curvatures 1, 1/4 and 1/9.
const SPHERES: &str = "grid k : [1, 3, 3];
    surface s(u, v) = (6k - 12, 0, 0) + k (cosu cosv, sinu cosv, sinv), u : [-pi, pi, 41], v : [-pi/2, pi/2, 21];";

#[test]
fn each_instance_has_the_colours_of_its_curvature() {
    let mut request = request(SPHERES);
    request.curved = vec![FIRST];
    request.size = [3 * SIDE, SIDE];
    let texture = request.clone().with_curvatures().texture(FIRST);
    let scale = texture.curvature_scale().expect("a scale");
    let expected: Vec<[u8; 3]> = [1.0, 0.25, 1.0 / 9.0].map(|k| scale.colour(k)).to_vec();
    assert_eq!(texture.instances().count(), 3);
    for (instance, colour) in (0..).zip(&expected) {
        let image = texture.of_instance(instance);
        let texel = image.levels()[0].texels[image.levels()[0].texels.len() / 2];
        assert!(
            (0..3).all(|k| texel[k].abs_diff(colour[k]) <= 2),
            "{instance}: {texel:?}"
        );
        assert_eq!(image.curvature_scale(), Some(scale));
    }
    let eye = [0.0, -40.0, 0.01];
    for (how, image) in pictures(&request, eye) {
        request.view = SpaceOptions::seen_from(eye, [0.0; 3]).into();
        let camera = Renderer::software().camera(&request).expect("a camera");
        // The share of green in red falls as the curvature grows.
        let shares: Vec<f64> = [-6.0, 0.0, 6.0]
            .map(|x| {
                let place = camera.placement.local(WorldPoint([x, 0.0, 0.0]));
                let [x, y] = camera.pixel_of(place).expect("in front").0;
                let [red, green, _, _] = image.get_pixel(x as u32, y as u32).0;
                f64::from(green) / f64::from(red)
            })
            .to_vec();
        assert!(
            shares[0] + 0.1 < shares[1] && shares[1] + 0.03 < shares[2],
            "{how}: {shares:?}"
        );
    }
}

#[test]
fn instances_with_equal_colours_share_one_image() {
    let mut request = request(&SPHERES.replace("+ k (cosu", "+ (cosu"));
    request.curved = vec![FIRST];
    let texture = request.with_curvatures().texture(FIRST);
    assert_eq!(texture.instances().count(), 1);
}
