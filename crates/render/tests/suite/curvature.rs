//! The colours of curvature against closed forms.

use std::sync::Arc;

use crate::scenes::{Wanted, scene};
use render::Backend;
use render::texture::Texture;
use scene::ObjectId;
use scene::ParamValues;

fn curvature(source: &str) -> Arc<Texture> {
    let scene = scene(source);
    Texture::curvature(&scene, &ParamValues::initial(&scene), ObjectId::new(0)).expect("a texture")
}

/// That each texel, but for those at the border, has the colour of the closed form at its (u, v) in [0, 1]²; a byte may
/// round the other way.
fn assert_shows(source: &str, form: impl Fn(f64, f64) -> f64) {
    let texture = curvature(source);
    let scale = texture.curvature_scale().expect("a scale");
    let level = &texture.levels()[0];
    let [width, height] = level.size;
    for (index, texel) in level.texels.iter().enumerate() {
        let (i, j) = (index as u32 % width, index as u32 / width);
        let share = |n: u32, of: u32| (f64::from(n) + 0.5) / f64::from(of);
        let (u, v) = (share(i, width), share(j, height));
        let expected = scale.colour(form(u, v));
        let off = (0..3).map(|k| expected[k].abs_diff(texel[k])).max();
        assert!(off <= Some(1), "({u}, {v}): {texel:?}, not {expected:?}");
    }
}

#[test]
fn a_sphere_has_one_over_its_radius_squared_everywhere() {
    let source = "surface s(u,v) = 2(cosu sinv, sinu sinv, cosv), u : [0,2pi], v : [0,pi];";
    let scale = curvature(source).curvature_scale().expect("a scale");
    assert!((scale.most - 0.25).abs() < 1e-9, "{scale:?}");
    assert_shows(source, |_, _| 0.25);
}

#[test]
fn a_torus_is_curved_both_ways() {
    let source = "surface s(u,v) = ((3+cosv)cosu, (3+cosv)sinu, sinv), u : [0,2pi], v : [0,2pi];";
    let form = |_: f64, v: f64| {
        let cos = (2.0 * std::f64::consts::PI * v).cos();
        cos / (3.0 + cos)
    };
    assert_shows(source, form);
    // The inner equator, on which no texel has its middle, has −1/2.
    let scale = curvature(source).curvature_scale().expect("a scale");
    assert!((scale.most - 0.5).abs() < 1e-9, "{scale:?}");
    assert!(!scale.is_clipped);
}

#[test]
fn the_scale_ends_at_the_largest_curvature_unless_that_would_take_the_colours_of_the_rest() {
    // In the middle of its domain the paraboloid has 4, at the tips of its longest axis the ellipsoid 9.
    let paraboloid = "surface s(u,v) = (u, v, u^2 + v^2), u : [-1,1.1], v : [-1,1.3];";
    let ellipsoid = "surface s(u,v) = (1.5 sinv cosu, sinv sinu, cosv), u : [0,2pi], v : [0,pi];";
    for (source, most) in [(paraboloid, 4.0), (ellipsoid, 2.25)] {
        let scale = curvature(source).curvature_scale().expect("a scale");
        assert!(
            (scale.most - most).abs() < 1e-9 * most,
            "{source}: {scale:?}"
        );
        assert!(!scale.is_clipped, "{source}: {scale:?}");
    }
    // A needle's tip, with 1e6, would make all of it white.
    let needle =
        "surface s(u,v) = (0.1 sinv cosu, 0.1 sinv sinu, 10 cosv), u : [0,2pi], v : [0,pi];";
    let scale = curvature(needle).curvature_scale().expect("a scale");
    assert!(scale.is_clipped && scale.most < 1e5, "{scale:?}");
}

#[test]
fn pseudosphere_and_half_plane_have_minus_one() {
    let pseudosphere =
        "surface s(u,v) = (cosu/cosh v, sinu/cosh v, v - sinh v/cosh v), u : [0,2pi], v : [0.1,3];";
    let half_plane = "metric h(x,y) = (1, 0, 1)/y^2, x : [-2, 2], y : [1, 4];";
    for source in [pseudosphere, half_plane] {
        let most = curvature(source).curvature_scale().expect("a scale").most;
        assert!((most - 1.0).abs() < 1e-6, "{most}");
        assert_shows(source, |_, _| -1.0);
    }
}

#[test]
fn what_is_flat_is_white_and_what_is_undefined_grey() {
    let cylinder = "surface s(u,v) = (cosu, sinu, v), u : [0,2pi], v : [0,3];";
    assert_shows(cylinder, |_, _| 0.0);
    let half = "surface s(u,v) = (u, v, sqrt u), u : [-1,1], v : [0,1];";
    assert_shows(half, |u, _| if u < 0.5 { f64::NAN } else { 0.0 });
}

#[test]
fn the_legend_has_the_scale_only_where_colours_show_curvature() {
    let scene = scene("surface s(u,v) = (u,v,u^2-v^2), u : [-1,1], v : [-1,1];");
    let params = ParamValues::initial(&scene);
    let texture = Texture::curvature(&scene, &params, ObjectId::new(0)).expect("a texture");
    for view in ["inside", "space"] {
        let draw = |textures, legend| {
            let base = match view {
                "inside" => Wanted::geodesic(ObjectId::new(0), [300, 200]),
                _ => Wanted::space([300, 200]),
            };
            let mut request = Wanted {
                backend: Backend::Software,
                textures,
                ..base
            };
            request.overlays.legend = legend;
            if view == "inside" {
                request.inside().camera.zoom = Some(0.5);
            }
            request.draw(&scene, &params).expect("a picture")
        };
        let shown = vec![(ObjectId::new(0), texture.clone())];
        let (plain, with) = (draw(shown.clone(), false), draw(shown, true));
        assert_eq!(plain.overlays, Vec::<&str>::new(), "{view}");
        assert_eq!(with.overlays, ["legend"], "{view}");
        // Its corner is one of the picture's.
        let corners = [[1, 198], [298, 198], [1, 1], [298, 1]];
        let differs = |[x, y]: [u32; 2]| plain.image.get_pixel(x, y) != with.image.get_pixel(x, y);
        let differing = corners.into_iter().filter(|corner| differs(*corner));
        assert_eq!(differing.count(), 1, "{view}");
        // Without the colours, there is nothing to be explained.
        let (plain, with) = (draw(Vec::new(), false), draw(Vec::new(), true));
        assert_eq!(plain.image, with.image, "{view}");
    }
    // Nor is there where the surface is hidden.
    let hidden =
        Wanted::space([300, 200]).with_space(|space| space.hidden = vec![ObjectId::new(0)]);
    let mut request = Wanted {
        backend: Backend::Software,
        textures: vec![(ObjectId::new(0), texture)],
        ..hidden
    };
    request.overlays.legend = true;
    let hidden = request.draw(&scene, &params).expect("a picture");
    assert_eq!(hidden.overlays, Vec::<&str>::new());
}
