//! Figures and videos by the binary: SVG and PDF whose vectors lie on the pixels, and what `ffmpeg` is asked for.

use std::path::Path;
use std::process::{Command, Output};

use image::{Rgba, RgbaImage};
use tempfile::TempDir;

/// A curve that a plane hides where x < 0, and one that lies on the plane.
const PROGRAM: &str = "\
param a : [0, 1];
surface wall(u, v) = (u, 0, v), u : [-2, 0], v : [-2, 2];
curve behind(t) = (t, 1, 0), t : [-1.5, 1.5];
curve on(t) = (t, 0, 1), t : [-1.5, 1.5];
";
const VIEW: &str = "--theme print --eye 0,-9,0 --target 0,0,0 --orthographic --size 300x300 --texture wall=plain \
    --colour wall=00ff00 --colour behind=ff0000 --colour on=0000ff --scale 2";

fn folder() -> TempDir {
    let folder = TempDir::new().expect("a temporary directory");
    std::fs::write(folder.path().join("a & b.gtr"), PROGRAM).expect("writing");
    folder
}

fn geotrace(folder: &Path, options: &str, path: Option<&Path>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_geotrace"));
    if let Some(path) = path {
        command.env("PATH", path);
    }
    command
        .current_dir(folder)
        .args(["render", "a & b.gtr"])
        .args(options.split_whitespace())
        .output()
        .expect("the binary starts")
}

fn printed(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The paths of an SVG: their colour, their width, and their places.
fn paths(svg: &str) -> Vec<(String, f32, Vec<[f32; 2]>)> {
    let attribute = |line: &str, name: &str| -> String {
        let begin = line.find(&format!(" {name}=\"")).expect("an attribute") + name.len() + 3;
        let end = line[begin..].find('"').expect("its end");
        line[begin..begin + end].to_owned()
    };
    let lines = svg.lines().filter(|line| line.starts_with("<path"));
    let path = |line: &str| {
        let d = attribute(line, "d");
        let places = d.split(['M', 'L']).filter(|it| !it.trim().is_empty());
        let place = |place: &str| {
            let mut numbers = place.split_whitespace();
            [0, 1].map(|_| numbers.next().expect("a number").parse().expect("one"))
        };
        let width = attribute(line, "stroke-width").parse().expect("a number");
        (
            attribute(line, "stroke"),
            width,
            places.map(place).collect(),
        )
    };
    lines.map(path).collect()
}

#[test]
fn the_lines_of_a_figure_lie_on_those_of_the_picture_and_end_where_they_are_hidden() {
    let folder = folder();
    for file in ["out.svg", "out.png"] {
        let output = geotrace(
            folder.path(),
            &format!("-o {file} --backend software {VIEW}"),
            None,
        );
        assert!(output.status.success(), "{}", printed(&output));
    }
    let svg = std::fs::read_to_string(folder.path().join("out.svg")).expect("a text");
    assert!(svg.contains("<title>a &amp; b.gtr</title>"));
    let picture = image::open(folder.path().join("out.png"))
        .expect("a picture")
        .into_rgba8();
    let is = |pixel: &Rgba<u8>, strong: usize| {
        let weak: Vec<usize> = (0..3).filter(|k| *k != strong).collect();
        weak.iter()
            .all(|k| i32::from(pixel.0[strong]) - i32::from(pixel.0[*k]) > 90)
    };
    let columns = |picture: &RgbaImage, strong: usize| -> Vec<f32> {
        let hits = picture
            .enumerate_pixels()
            .filter(|(_, _, pixel)| is(pixel, strong));
        hits.map(|(x, _, _)| x as f32 + 0.5).collect()
    };
    for (colour, strong) in [("#ff0000", 0), ("#0000ff", 2)] {
        let all = paths(&svg);
        let own: Vec<_> = all.iter().filter(|(it, _, _)| it == colour).collect();
        assert_eq!(own.len(), 1, "{colour} is one line: {own:?}");
        let (_, width, places) = own[0];
        let [low, high] = [f32::min, f32::max].map(|pick| {
            let places = places.iter().map(|[x, _]| *x);
            places.reduce(pick).expect("a place")
        });
        let seen = columns(&picture, strong);
        let left = seen.iter().copied().fold(f32::INFINITY, f32::min);
        let right = seen.iter().copied().fold(0.0, f32::max);
        // The ends are round: half a width beyond the last place, unless something hides them.
        assert!(
            (low - left).abs() <= 0.5 * width + 1.0,
            "{colour}: {low}, {left}"
        );
        assert!(
            (right - high).abs() <= 0.5 * width + 1.0,
            "{colour}: {high}, {right}"
        );
        // In the middle of the stroke the picture has its colour.
        for [x, y] in places {
            let inside = x.clamp(low + 2.0, high - 2.0);
            let pixel = picture.get_pixel(inside as u32, *y as u32);
            assert!(is(pixel, strong), "{colour}, ({x}, {y}): {pixel:?}");
        }
    }
    let red = paths(&svg).into_iter().find(|(it, _, _)| it == "#ff0000");
    let (_, _, places) = red.expect("the line behind");
    assert!(
        places.iter().all(|[x, _]| *x > 149.0),
        "the wall hides its left half: {places:?}"
    );
}

#[test]
fn lines_for_print_contrast_with_white_paper_and_marks_are_rings() {
    let folder = folder();
    let lines = "--show-camera wall --path wall=-1,0:0,0 --figure wall=distance:-1,1:-1.5,-1 --wavefronts 0.3";
    let view = "--theme print --eye 1,-9,0 --target -1,0,0 --size 600x600 --texture wall=plain --zoom 0.8 --at -1,0";
    let output = geotrace(
        folder.path(),
        &format!("-o out.svg --backend software {view} {lines}"),
        None,
    );
    assert!(output.status.success(), "{}", printed(&output));
    let svg = std::fs::read_to_string(folder.path().join("out.svg")).expect("a text");
    let all = paths(&svg);
    assert!(all.len() > 8, "{all:?}");
    let decode = |byte: u8| {
        let x = f64::from(byte) / 255.0;
        if x <= 0.04045 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    };
    for (colour, width, places) in &all {
        let part =
            |k: usize| u8::from_str_radix(&colour[2 * k + 1..2 * k + 3], 16).expect("a byte");
        let [r, g, b] = [0, 1, 2].map(|k| decode(part(k)));
        let contrast = 1.05 / (0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05);
        assert!(contrast >= 4.5, "{colour}: {contrast}");
        let xs = || places.iter().map(|[x, _]| *x);
        let wide = xs().fold(0.0, f32::max) - xs().fold(f32::INFINITY, f32::min);
        // A small closed line is a mark: there is paper within it.
        let is_closed = places.len() > 8 && places.first() == places.last();
        assert!(
            !(is_closed && wide < 60.0) || wide > 3.0 * width,
            "{width}, {wide}"
        );
    }
}

#[test]
fn a_figure_is_whole_as_pdf_and_names_are_text_in_svg() {
    let folder = folder();
    for file in ["out.pdf", "out.svg"] {
        let options = format!("-o {file} {VIEW} --labels --axes --background transparent");
        let output = geotrace(folder.path(), &options, None);
        assert!(output.status.success(), "{}", printed(&output));
    }
    let svg = std::fs::read_to_string(folder.path().join("out.svg")).expect("a text");
    for name in ["wall", "behind", "on", "x", "z"] {
        assert!(svg.contains(&format!(">{name}</text>")), "{name}");
    }
    // A browser paints words letter by letter: rims that came with the letters would cover those before.
    let words: Vec<&str> = svg
        .lines()
        .filter(|line| line.starts_with("<text"))
        .collect();
    for pair in words.chunks(2) {
        assert!(pair[0].contains(" fill=\"none\" stroke=\"#"), "{}", pair[0]);
        assert!(!pair[1].contains("stroke"), "{}", pair[1]);
    }
    let pdf = std::fs::read(folder.path().join("out.pdf")).expect("a file");
    assert!(pdf.starts_with(b"%PDF-"));
    assert!(pdf.trim_ascii_end().ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf);
    assert!(
        text.contains("/MediaBox [0 0 225 225]"),
        "300 pixels at 96 to the inch"
    );
    assert!(text.contains("/SMask"), "the background is transparent");
    assert!(
        svg.contains("fill=\"#") && !svg.contains("fill=\"#f"),
        "words on paper are dark"
    );
}

#[test]
fn names_of_hidden_objects_are_as_translucent_as_in_a_picture() {
    let folder = TempDir::new().expect("a temporary directory");
    let program = "surface s(u, v) = (cosu cosv, sinu cosv, sinv), u : [0, 2pi], v : [-pi/2, pi/2]; \
        point back = (0, 1.2, 0); point front = (0, -1.2, 0);";
    std::fs::write(folder.path().join("a & b.gtr"), program).expect("writing");
    for file in ["out.svg", "out.pdf"] {
        let options = format!("-o {file} --eye 0,-5,0 --target 0,0,0 --labels --backend software");
        let output = geotrace(folder.path(), &options, None);
        assert!(output.status.success(), "{}", printed(&output));
    }
    let svg = std::fs::read_to_string(folder.path().join("out.svg")).expect("a text");
    let paints = |name: &str| -> Vec<String> {
        let lines = svg
            .lines()
            .filter(|line| line.contains(&format!(">{name}<")));
        let paint = |line: &str| line[line.find("fill=").expect("a paint")..].to_owned();
        lines.map(paint).collect()
    };
    let (back, front) = (paints("back"), paints("front"));
    assert_eq!([back.len(), front.len()], [2, 2]);
    for (back, front) in back.iter().zip(front) {
        // The same colours, but thinner.
        let front = front.replace(">front<", " opacity=\"0.45\">back<");
        assert_eq!(*back, front);
    }
    let pdf = std::fs::read(folder.path().join("out.pdf")).expect("a file");
    let pdf = String::from_utf8_lossy(&pdf);
    assert!(pdf.contains("/CA 0.45") && pdf.contains("/ca 0.45") && pdf.contains("/Opacity45"));
}

#[test]
fn a_figure_is_one_picture_and_has_its_own_backend() {
    let folder = folder();
    let refused = |options: &str, wanted: &str| {
        let output = geotrace(folder.path(), options, None);
        assert_eq!(
            output.status.code(),
            Some(2),
            "{options}: {}",
            printed(&output)
        );
        assert!(
            printed(&output).contains(wanted),
            "{options}: {}",
            printed(&output)
        );
    };
    refused(
        "-o out.svg --animate a=0:1 --frames 4",
        "is a single picture",
    );
    refused("-o out.pdf --animate a=0:1", "is a single picture");
    refused("-o out.svg --backend gpu", "software path");
    let inside = geotrace(
        folder.path(),
        "-o in.svg --view geodesic --size 40x40",
        None,
    );
    assert!(
        printed(&inside).contains("the file contains its pixels"),
        "{}",
        printed(&inside)
    );
    assert!(inside.status.success());
}

/// A folder with an `ffmpeg` that does what a script says.
#[cfg(unix)]
fn with_ffmpeg(script: &str) -> TempDir {
    use std::os::unix::fs::PermissionsExt;

    let folder = TempDir::new().expect("a temporary directory");
    let file = folder.path().join("ffmpeg");
    std::fs::write(&file, format!("#!/bin/sh\nPATH=/usr/bin:/bin\n{script}\n")).expect("writing");
    let executable = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(&file, executable).expect("allowed");
    folder
}

#[cfg(unix)]
fn names(folder: &TempDir) -> Vec<String> {
    let entries = std::fs::read_dir(folder.path()).expect("the directory");
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<String> = entries
        .map(|it| name(it).to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn ffmpeg_receives_every_picture_and_what_to_do_with_them() {
    let folder = folder();
    // Keeps its arguments and its input where the video would be.
    let tools = with_ffmpeg(
        "for last; do :; done; file=${last#file:}; { echo \"$*\" | sed 's/ file:.*//'; cat; } > \"$file\"",
    );
    for (name, codec) in [("out.mp4", "libx264"), ("out.webm", "libvpx-vp9")] {
        let options = format!("-o {name} --size 15x10 --animate a=0:1 --frames 4 --fps 12.5");
        let output = geotrace(folder.path(), &options, Some(tools.path()));
        assert!(output.status.success(), "{}", printed(&output));
        assert!(
            printed(&output).contains("4 frames, 0.32 s long"),
            "{}",
            printed(&output)
        );
        let written = std::fs::read(folder.path().join(name)).expect("a file");
        let end = written
            .iter()
            .position(|byte| *byte == b'\n')
            .expect("a line");
        let words = String::from_utf8_lossy(&written[..end]);
        for part in [
            "-video_size 15x10",
            "-framerate 12.5",
            "-pixel_format rgb24",
            codec,
        ] {
            assert!(words.contains(part), "{part}: {words}");
        }
        assert_eq!(written.len() - end - 1, 4 * 15 * 10 * 3);
    }
    assert_eq!(names(&folder), ["a & b.gtr", "out.mp4", "out.webm"]);
}

#[cfg(unix)]
#[test]
fn a_video_that_fails_leaves_nothing_and_says_why() {
    let folder = folder();
    let run = |path: &Path| {
        let options = "-o out.mp4 --size 15x10 --animate a=0:1 --frames 4";
        let output = geotrace(folder.path(), options, Some(path));
        assert_eq!(output.status.code(), Some(1), "{}", printed(&output));
        assert_eq!(names(&folder), ["a & b.gtr"]);
        printed(&output)
    };
    let tools = with_ffmpeg("cat > /dev/null; echo 'Unknown encoder libx264' >&2; exit 1");
    assert!(run(tools.path()).contains("Unknown encoder libx264"));
    let none = TempDir::new().expect("a temporary directory");
    let sentence = run(none.path());
    assert!(
        sentence.contains("which is not installed here"),
        "{sentence}"
    );
    assert!(sentence.contains("https://ffmpeg.org"), "{sentence}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_no_part_of_a_video() {
    let folder = folder();
    let tools = with_ffmpeg(
        "for last; do :; done; : > \"${0%/*}/started\"; cat > /dev/null; echo late > \"${last#file:}\"",
    );
    let options = "-o out.mp4 --size 15x10 --animate a=0:1 --frames 100000";
    let mut drawing = Command::new(env!("CARGO_BIN_EXE_geotrace"))
        .env("PATH", tools.path())
        .current_dir(folder.path())
        .args(["render", "a & b.gtr"])
        .args(options.split_whitespace())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the binary starts");
    while !tools.path().join("started").exists() {
        assert!(
            drawing.try_wait().expect("a process").is_none(),
            "it has ended"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let kill = Command::new("kill")
        .args(["-INT", &drawing.id().to_string()])
        .status();
    assert!(kill.expect("it runs").success());
    assert!(!drawing.wait().expect("it ends").success());
    assert_eq!(names(&folder), ["a & b.gtr"]);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_gpu_nothing_but_the_summary_is_printed() {
    let folder = folder();
    let output = Command::new(env!("CARGO_BIN_EXE_geotrace"))
        .current_dir(folder.path())
        .env_remove("XDG_RUNTIME_DIR")
        // Where there is a GPU, its driver is not found.
        .env("VK_DRIVER_FILES", "/nonexistent/driver.json")
        .env("VK_ICD_FILENAMES", "/nonexistent/driver.json")
        .args(["render", "a & b.gtr", "-o", "out.png", "--size", "20x20"])
        .output()
        .expect("the binary starts");
    let printed = printed(&output);
    assert!(output.status.success(), "{printed}");
    assert!(printed.starts_with("out.png: 3D view"), "{printed}");
    assert_eq!(printed.lines().count(), 1, "{printed}");
}

#[test]
fn nothing_of_a_figure_lies_over_its_legend() {
    let folder = folder();
    // The scene is in all corners, and so behind the legend too.
    let wide = "surface far(u, v) = (u, 3, v), u : [-20, 20], v : [-20, 20];
curve rising(t) = (t, 2, t), t : [-20, 20]; curve falling(t) = (t, 2, 1 - t), t : [-20, 20];";
    let program = format!("{PROGRAM}{wide}");
    std::fs::write(folder.path().join("a & b.gtr"), program).expect("writing");
    let view = "--theme print --eye 3,-9,4 --target 0.8,0,0.8 --size 400x300 --texture wall=curvature --axes --labels";
    let draw = |file: &str, legend: &str| {
        let output = geotrace(folder.path(), &format!("-o {file} {view} {legend}"), None);
        assert!(output.status.success(), "{}", printed(&output));
        folder.path().join(file)
    };
    let [without, with] = ["", "--legend"].map(|legend| {
        let file = format!("out{}.svg", legend.len());
        std::fs::read_to_string(draw(&file, legend)).expect("a text")
    });
    let [plain, key] = ["", "--legend"].map(|legend| {
        let file = format!("out{}.png", legend.len());
        image::open(draw(&file, legend))
            .expect("a picture")
            .into_rgba8()
    });
    let is_key = |x: u32, y: u32| plain.get_pixel(x, y) != key.get_pixel(x, y);
    let right = (0..400).take_while(|x| is_key(*x, 299)).count() as f32;
    let height = (0..300).rev().take_while(|y| is_key(0, *y)).count() as f32;
    assert!(right > 50.0 && height > 20.0, "{right}, {height}");
    let is_covered = |[x, y]: [f32; 2]| x < right - 1.0 && y > 301.0 - height && y < 300.0;
    let covered = |svg: &str| {
        let lines = paths(svg).into_iter();
        let pieces = lines.flat_map(|(_, _, places)| {
            let pieces = places.windows(2).map(|ends| [ends[0], ends[1]]);
            pieces.collect::<Vec<_>>()
        });
        let along = pieces.flat_map(|[a, b]| {
            (0..=100_u8).map(move |k| {
                let share = f32::from(k) / 100.0;
                [0, 1].map(|i| a[i] + share * (b[i] - a[i]))
            })
        });
        along.filter(|place| is_covered(*place)).count()
    };
    assert!(covered(&without) > 0, "the scene reaches there");
    assert_eq!(covered(&with), 0);
}

#[test]
fn hidden_parts_of_lines_are_dashed_where_they_are_wanted() {
    let folder = folder();
    let draw = |file: &str, options: &str| {
        geotrace(
            folder.path(),
            &format!("-o {file} {VIEW} --axes {options}"),
            None,
        )
    };
    for (file, options) in [
        ("plain.svg", ""),
        ("dashed.svg", "--hidden-lines"),
        ("dashed.pdf", "--hidden-lines"),
    ] {
        let output = draw(file, options);
        assert!(output.status.success(), "{}", printed(&output));
    }
    let read = |file: &str| std::fs::read_to_string(folder.path().join(file)).expect("a text");
    let [plain, dashed] = ["plain.svg", "dashed.svg"].map(read);
    assert!(!plain.contains("stroke-dasharray"));
    let hidden: String = dashed
        .lines()
        .filter(|line| line.contains("stroke-dasharray"))
        .collect();
    // The wall hides the left half of the line behind it, and nothing of the line on it; the box is no line of the program.
    let all = paths(&hidden);
    let [(colour, _, places)] = &all[..] else {
        panic!("one line: {all:?}");
    };
    assert_eq!(colour, "#ff0000");
    assert!(places.iter().all(|[x, _]| *x < 151.0), "{places:?}");
    assert!(places.iter().any(|[x, _]| *x < 120.0), "{places:?}");
    assert_eq!(
        dashed.replace(&hidden, "").replace('\n', ""),
        plain.replace('\n', "")
    );
    let refused = draw("dashed.png", "--hidden-lines");
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        printed(&refused).contains(".svg or a .pdf"),
        "{}",
        printed(&refused)
    );
}
