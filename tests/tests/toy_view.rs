//! A third view that is registered in one place is offered by the command line and drawn by the renderer.

use std::process::Command;
use std::sync::Arc;

use render::gpu::Pixels;
use render::{PictureRequest, Renderer, Views};
use scene::ParamValues;
use testing::examples;
use testing::toy_view::BandsView;

fn toy(arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_toy-geotrace"))
        .args(arguments)
        .output()
        .expect("it starts");
    let text = [output.stdout, output.stderr].concat();
    (
        output.status.code(),
        String::from_utf8_lossy(&text).into_owned(),
    )
}

#[test]
fn the_command_line_offers_it_draws_it_and_explains_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("a.png");
    let (picture_text, example) = (picture.display().to_string(), examples::one("circle").path);
    let example = example.display().to_string();
    for backend in ["software", "auto"] {
        let arguments = [
            "render",
            &example,
            "-o",
            &picture_text,
            "--view",
            "bands",
            "--size",
            "30x40",
        ];
        let (status, text) = toy(&[&arguments[..], &["--backend", backend]].concat());
        assert_eq!(status, Some(0), "{text}");
        let image = image::open(&picture).expect("a picture").to_rgba8();
        assert_eq!(image.dimensions(), (30, 40));
        assert!(image.get_pixel(0, 0).0[0] < image.get_pixel(0, 39).0[0]);
    }
    assert!(toy(&["render", "--help"]).1.contains("bands"));
    let (status, text) = toy(&["explain", &example]);
    assert_eq!(status, Some(0));
    assert!(text.contains("View bands"), "{text}");
    let (status, text) = toy(&["render", &example, "-o", &picture_text, "--view", "stripes"]);
    assert_eq!(status, Some(2));
    assert!(text.contains("bands"), "{text}");
}

#[test]
fn a_renderer_draws_it_beside_the_others_and_keeps_each() {
    let compiled = scene::geotrace::compile(&examples::one("sphere").source);
    let scene = Arc::new(compiled.scene.expect("no errors"));
    let settings = Arc::new(ParamValues::initial(&scene));
    let views = Views::standard().with(BandsView);
    let mut renderer = Renderer::software().with_views(views.clone());
    let mut draw = |name: &str, upside_down: bool| {
        let view = views.get(name).expect("it is registered");
        let surface = scene
            .numbered()
            .find(|(_, object)| view.shows(&scene, object));
        let mut part = view.options(surface.map(|(id, _)| id).filter(|_| view.is_of_object()));
        assert_eq!(part.set("upside-down", upside_down), name == "bands");
        let request = PictureRequest::new(scene.clone(), settings.clone(), part, [24, 24]);
        match renderer.draw(&request).expect("a picture").image {
            Pixels::Image(image) => image,
            Pixels::Texture(_) => panic!("drawn on a GPU"),
        }
    };
    let bands = draw("bands", false);
    assert_ne!(draw("bands", true), bands);
    for name in ["3d", "geodesic"] {
        let first = draw(name, false);
        assert_ne!(first, bands);
        assert_eq!(draw("bands", false), bands);
        assert_eq!(draw(name, false), first);
    }
}
