//! The images that a program names: `image : WORD` on surfaces, metrics, solids and the background, through the binary.

use std::f64::consts::PI;
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

/// Draws a program in a folder; the picture's middle, and what was printed.
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
        let (middle, printed) = draw(folder, program, options);
        assert_eq!(hue(middle), RED, "{view} of {program}: {middle:?}");
        assert!(!printed.contains("not shown"), "{printed}");
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
fn an_image_that_is_replaced_by_an_option_is_not_missed() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    save(&folder.join("other.png"), BLUE);
    let other = folder.join("other.png").display().to_string();
    for (program, name) in [(SURFACE, "s"), (SOLID, "s"), (SKY, "sky")] {
        let chosen = format!("{name}={other}");
        let options = ["--view", "traced", "--texture", &chosen];
        let (middle, printed) = draw(folder, program, &options);
        assert_eq!(hue(middle), BLUE, "{program}");
        assert!(!printed.contains("ground"), "{printed}");
    }
    // Another object still misses it.
    let two =
        format!("{SURFACE} surface t(u, v) = (u, v, 1), u : [-1, 1], v : [-1, 1], image : ground;");
    let chosen = format!("s={other}");
    let (_, printed) = draw(folder, &two, &["--texture", &chosen]);
    assert!(printed.contains("there is no ground.png"), "{printed}");
}

#[test]
fn an_image_is_for_a_surface_a_metric_a_solid_or_the_background() {
    let program =
        "solid ball(x,y,z) = x^2+y^2+z^2-1; solid half = ball, z : [0, 1]; background sky = 0;
                   curve c(t) = (t,t,t), t : [0,1];";
    for (texture, message) in [
        (
            "zz=sky.png",
            "declares no surface, metric, solid or background `zz`",
        ),
        (
            "c=sky.png",
            "is a curve, not a surface, metric, solid or background",
        ),
        (
            "ball=sky.png",
            "`ball` is a part of another solid, and is not drawn itself",
        ),
        (
            "half=plain",
            "`half` is a solid, but `plain` is for a surface or a metric",
        ),
        (
            "sky=curvature",
            "`sky` is a background, but `curvature` is for a surface or a metric",
        ),
    ] {
        let run = geotrace(["render", "-", "-o", "out.png", "--texture", texture])
            .input(program)
            .run();
        run.expect_status(2).expect_text(message);
    }
}

#[test]
fn an_image_lies_beside_the_program_or_in_the_folder_that_is_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let elsewhere = tempfile::tempdir().expect("a folder");
    let given = elsewhere.path().display().to_string();
    let (_, printed) = draw(folder.path(), SURFACE, &[]);
    assert!(
        printed.contains("there is no ground.png, ground.jpg or ground.jpeg beside the program\n"),
        "{printed}"
    );
    let (_, printed) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert!(
        printed.contains(&format!("beside the program or in {given}")),
        "{printed}"
    );
    save(&elsewhere.path().join("ground.png"), GREEN);
    let (middle, printed) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert_eq!(
        (hue(middle), printed.contains("note")),
        (GREEN, false),
        "{printed}"
    );
    // A folder is no image, and a file that is none is named.
    std::fs::create_dir(folder.path().join("ground.png")).expect("made");
    let (_, printed) = draw(folder.path(), SURFACE, &[]);
    assert!(
        printed.contains("ground.png is not a regular file\n"),
        "{printed}"
    );
    std::fs::write(folder.path().join("ground.jpg"), "no image").expect("written");
    let (_, printed) = draw(folder.path(), SURFACE, &["--images", &given]);
    assert!(
        printed.contains("ground.jpg is not a PNG or JPEG image"),
        "{printed}"
    );
}

/// The colour that CRT.md gives for a unit direction of a script: column W(1 − ((angle + atan2(−x, z) + π) mod 2π)/2π), row
/// H(½ − y/2), bilinear between whole numbers, wrapping.
fn formula(image: &RgbaImage, angle: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let turned = (angle + (-x).atan2(z) + PI).rem_euclid(2.0 * PI);
    let column = f64::from(image.width()) * (1.0 - turned / (2.0 * PI));
    let row = f64::from(image.height()) * (0.5 - y / 2.0);
    let pixel = |i: f64, j: f64| {
        let i = (i as i64).rem_euclid(i64::from(image.width())) as u32;
        let j = (j as i64).rem_euclid(i64::from(image.height())) as u32;
        image.get_pixel(i, j).0
    };
    let (i, j) = (column.floor(), row.floor());
    let (s, t) = (column - i, row - j);
    [0, 1, 2].map(|k| {
        let [a, b] = [0.0, 1.0].map(|down| {
            let [a, b] = [0.0, 1.0].map(|right| f64::from(pixel(i + right, j + down)[k]));
            a + s * (b - a)
        });
        a + t * (b - a)
    })
}

#[test]
fn the_background_of_a_script_is_its_image_to_the_formula() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::create_dir(folder.join("skies")).expect("made");
    let image = RgbaImage::from_fn(12, 6, |x, y| {
        let at = x * 37 + y * 101;
        Rgba([
            (at % 251) as u8,
            (at * 7 % 253) as u8,
            (at * 3 % 255) as u8,
            255,
        ])
    });
    image.save(folder.join("skies/dusk.png")).expect("written");
    let angle = 0.7;
    let script = format!(
        "Settings {{
    background -> Background {{ image -> \"/skies/dusk.png\"  angle -> {angle} }}
    camera -> Camera {{ position -> vec3(1, 2, 3)  pointing -> vec3(2, 2.5, 1)  fov -> 110 }}
}}
Scene {{ }}
"
    );
    std::fs::write(folder.join("a.crt"), script).expect("written");
    let out = folder.join("out.png").display().to_string();
    let file = folder.join("a.crt").display().to_string();
    let [width, height] = [24u32, 16u32];
    let run = geotrace(["render", &file, "-o", &out, "--size", "24x16"]).run();
    run.expect_status(0);
    assert!(!run.stderr.contains("not shown"), "{}", run.stderr);
    let drawn = image::open(&out).expect("a picture").to_rgb8();
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let ahead = unit([1.0, 0.5, -2.0]);
    let right = unit(cross(ahead, [0.0, 1.0, 0.0])).map(|x| -x);
    let up = cross(ahead, right);
    let tangent = 55f64.to_radians().tan();
    for (i, j, pixel) in drawn.enumerate_pixels() {
        let x = 2.0 * (f64::from(i) + 0.5) / f64::from(width) - 1.0;
        let y = 1.0 - 2.0 * (f64::from(j) + 0.5) / f64::from(height);
        let across = x * tangent * f64::from(width) / f64::from(height);
        let direction: [f64; 3] =
            std::array::from_fn(|k| ahead[k] + across * right[k] + y * tangent * up[k]);
        let expected = formula(&image, angle, unit(direction));
        for (channel, light) in pixel.0.iter().zip(expected) {
            // A whole number of light may be cut off below it by rounding.
            let bytes = [(light - 1e-9).floor() as u8, (light + 1e-9).floor() as u8];
            assert!(
                bytes.contains(channel),
                "({i}, {j}): {channel}, not {light}"
            );
        }
    }
    // Without the file the background is white, and a sentence says so.
    std::fs::remove_file(folder.join("skies/dusk.png")).expect("removed");
    let run = geotrace(["render", &file, "-o", &out, "--size", "24x16"]).run();
    assert!(
        run.stderr.contains("there is no skies/dusk.png"),
        "{}",
        run.stderr
    );
    let drawn = image::open(&out).expect("a picture").to_rgb8();
    assert!(drawn.pixels().all(|pixel| pixel.0 == [255; 3]));
    // A path that leads out of the folder is not followed.
    let text = std::fs::read_to_string(&file)
        .expect("read")
        .replace("/skies/", "../");
    std::fs::write(&file, text).expect("written");
    let run = geotrace(["render", &file, "-o", &out, "--size", "24x16"]).run();
    assert!(
        run.stderr.contains("leads out of the program's folder"),
        "{}",
        run.stderr
    );
    // The empty path names nothing.
    let text = "Settings { background -> Background { image -> \"\" } }\nScene { }";
    std::fs::write(&file, text).expect("written");
    let run = geotrace(["render", &file, "-o", &out, "--size", "24x16"]).run();
    run.expect_text("is not shown: its path names no file");
}
