//! The images that a program names: `image : WORD` on surfaces, metrics, solids and the background, through the binary.

use std::path::Path;

use image::{Rgba, RgbaImage};
use testing::binary::geotrace;

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];

fn save(path: &Path, [r, g, b]: [u8; 3]) {
    let image = RgbaImage::from_pixel(4, 4, Rgba([r, g, b, 255]));
    image.save(path).expect("written");
}

/// Draws a program in a folder; the picture's middle, and what was said.
fn draw(folder: &Path, program: &str, options: &[&str]) -> ([u8; 3], String) {
    std::fs::write(folder.join("a.gtr"), program).expect("written");
    let out = folder.join("out.png").display().to_string();
    let file = folder.join("a.gtr").display().to_string();
    let words = ["render", &file, "-o", &out, "--size", "16x16"];
    let words = words.iter().chain(options).copied();
    let run = geotrace(words).run();
    run.expect_status(0);
    let picture = image::open(out).expect("a picture").to_rgb8();
    (picture.get_pixel(8, 8).0, run.stderr)
}

/// The part of a colour that is brightest.
fn hue([r, g, b]: [u8; 3]) -> [u8; 3] {
    let most = r.max(g).max(b);
    [r, g, b].map(|part| if part == most && part > 40 { 255 } else { 0 })
}

const SURFACE: &str = "surface s(u, v) = (u, v, 0), u : [-9, 9], v : [-9, 9], image : ground;";
const SOLID: &str = "solid s(x, y, z) = z, uv : (x, y), image : ground;
    camera eye = (0, 0.1, -1) @ (0, 0, 3);";
const SKY: &str = "background sky = 0, image : ground; point p = (9, 9, 9);
    camera eye = (0, 1, 0) @ (0, 0, 0);";

#[test]
fn an_object_shows_the_image_that_it_states_in_every_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    save(&folder.join("ground.png"), RED);
    save(&folder.join("other.png"), BLUE);
    let other = folder.join("other.png").display().to_string();
    for (program, name, view) in [
        (SURFACE, "s", "3d"),
        (SURFACE, "s", "geodesic"),
        (SURFACE, "s", "traced"),
        (SOLID, "s", "3d"),
        (SOLID, "s", "traced"),
        (SKY, "sky", "traced"),
    ] {
        // The ring at the middle of the geodesic view is left out.
        let options = ["--view", view, "--setting", "centre=off"];
        let options = &options[..if view == "geodesic" { 4 } else { 2 }];
        let (middle, said) = draw(folder, program, options);
        assert_eq!(hue(middle), RED, "{view} of {program}: {middle:?}");
        assert!(!said.contains("not shown"), "{said}");
        // An image that is chosen wins.
        let chosen = format!("{name}={other}");
        let (middle, _) = draw(
            folder,
            program,
            &[options, &["--texture", &chosen]].concat(),
        );
        assert_eq!(hue(middle), BLUE, "{view} of {program}: {middle:?}");
    }
}

#[test]
fn an_image_lies_beside_the_program_or_in_the_folder_that_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let elsewhere = tempfile::tempdir().expect("a folder");
    let given = elsewhere.path().display().to_string();
    let (_, said) = draw(folder.path(), SURFACE, &[]);
    assert!(
        said.contains("there is no ground.png, ground.jpg or ground.jpeg beside the program\n"),
        "{said}"
    );
    let (_, said) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert!(
        said.contains(&format!("beside the program or in {given}")),
        "{said}"
    );
    save(&elsewhere.path().join("ground.png"), GREEN);
    let (middle, said) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert_eq!(
        (hue(middle), said.contains("note")),
        (GREEN, false),
        "{said}"
    );
    // A folder is no image, and a file that is none is named.
    std::fs::create_dir(folder.path().join("ground.png")).expect("made");
    std::fs::write(folder.path().join("ground.jpg"), "no image").expect("written");
    let (_, said) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert!(
        said.contains("ground.jpg is not a PNG or JPEG image"),
        "{said}"
    );
}
