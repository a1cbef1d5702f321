//! Pictures for papers, by the binary: as the window remembers them, and for print.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

const PROGRAM: &str = "\
param a : [1, 3];
surface s(u, v) = a(sin v cos u, sin v sin u, cos v), u : [0, 2pi], v : [0, pi];
curve c(t) = (2a cos t, 2a sin t, 0), t : [0, 2pi];
";

/// The file in which the window remembers a view.
const REMEMBERED: &str = r#"{
    "format": 1,
    "view": {
        "params": {"a": [2.5]},
        "looks": {"s": {"colour": [10, 200, 30], "texture": "plain"}, "c": {"hidden": true}},
        "space": {"eye": [3, 4, 5], "target": [0, 0, 1], "radius": 3, "moved": true},
        "preferences": {"background": [1, 2, 3], "orthographic": true,
            "marks": {"axes": true, "labels": true, "cameras": false}}
    }
}"#;

fn folder() -> TempDir {
    let folder = TempDir::new().expect("a temporary directory");
    std::fs::write(folder.path().join("a.gtr"), PROGRAM).expect("writing");
    folder
}

fn render(folder: &Path, options: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_geotrace"))
        .current_dir(folder)
        .args([
            "render",
            "a.gtr",
            "--backend",
            "software",
            "--size",
            "60x50",
        ])
        .args(options.split_whitespace())
        .output()
        .expect("the binary starts")
}

/// The bytes of the picture that some options draw.
fn picture(folder: &Path, options: &str) -> Vec<u8> {
    let output = render(folder, &format!("-o out.png {options}"));
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{options}: {printed}");
    assert!(!printed.contains("belongs to"), "{options}: {printed}");
    std::fs::read(folder.join("out.png")).expect("a picture")
}

#[test]
fn a_picture_is_as_the_window_shows_it_and_options_beside_it_win() {
    let folder = folder();
    let folder = folder.path();
    let beside = folder.join(".a.gtr.geotrace.json");
    std::fs::write(&beside, REMEMBERED).expect("writing");
    let space = "--eye 3,4,5 --target 0,0,1 --orthographic --hide c --axes --labels";
    let looks = "--texture s=plain --background 010203";
    let all = format!("{space} {looks} --set a=2.5 --colour s=0ac81e");
    assert!(picture(folder, "--like-window") == picture(folder, &all));
    let given = "--colour s=white --set a=1.5 --eye 9,0,0";
    let own = format!(
        "--eye 9,0,0 --target 0,0,1 --orthographic --hide c --axes --labels {looks} --set a=1.5 --colour s=ffffff"
    );
    assert!(picture(folder, &format!("--like-window {given}")) == picture(folder, &own));
    // Another view of the same program.
    let inside = picture(folder, "--like-window --view geodesic");
    let own = "--view geodesic:s --set a=2.5 --texture s=plain --colour s=0ac81e --labels";
    assert!(inside == picture(folder, own));
    let kept = std::fs::read_to_string(&beside).expect("still there");
    assert_eq!(kept, REMEMBERED, "reading changes nothing");
}

#[test]
fn without_a_memory_there_is_a_sentence() {
    let folder = folder();
    let failed = |wanted: &str| {
        let output = render(folder.path(), "-o out.png --like-window");
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{printed}");
        assert!(printed.contains(wanted), "{printed}");
        assert!(printed.contains("geotrace show a.gtr"), "{printed}");
        assert!(!folder.path().join("out.png").exists());
    };
    failed("the window has no saved view of this program");
    let beside = folder.path().join(".a.gtr.geotrace.json");
    std::fs::write(&beside, "{").expect("writing");
    failed("the saved view cannot be used");
    assert!(beside.is_file(), "it stays where it is");
}

#[test]
fn an_option_that_is_given_twice_is_refused() {
    let folder = folder();
    let output = render(folder.path(), "-o out.png --zoom 1 --zoom 2");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_picture_for_print_is_white_where_nothing_is() {
    let folder = folder();
    let bytes = picture(folder.path(), "--theme print --hide s");
    let image = image::load_from_memory(&bytes).expect("a PNG").into_rgba8();
    assert_eq!(image.get_pixel(0, 0).0, [255; 4]);
    let red = image
        .pixels()
        .filter(|it| it.0[0] > it.0[2] && it.0[1] < 120);
    assert!(red.count() > 40, "the curve is dark red");
    let is_other = |it: &&image::Rgba<u8>| it.0[0] < it.0[1] || it.0[0] < it.0[2];
    let others = image.pixels().filter(is_other).count();
    assert_eq!(others, 0, "nothing else is there");
    let other = picture(folder.path(), "--theme print --background 0000ff");
    let image = image::load_from_memory(&other).expect("a PNG").into_rgba8();
    assert_eq!(image.get_pixel(0, 0).0, [0, 0, 255, 255]);
}

/// A figure and a walk, as the window remembers them.
const DRAWN: &str = r#"{
    "format": 1,
    "view": {"preferences": {"background": [1, 2, 3]}},
    "drawn": {
        "figure": {"surface": "s", "kind": "triangle", "places": [[0.5, 1], [1, 1], [0.7, 1.5]]},
        "paths": {"s": [[0.5, 1.2], [0.6, 1.3], [0.7, 1.6]]}
    }
}"#;

#[test]
fn figures_and_paths_are_drawn_as_the_window_shows_them() {
    let folder = folder();
    let folder = folder.path();
    std::fs::write(folder.join(".a.gtr.geotrace.json"), DRAWN).expect("writing");
    let figure = "--figure s=triangle:0.5,1:1,1:0.7,1.5";
    let path = "--path s=0.5,1.2:0.6,1.3:0.7,1.6";
    for view in [
        "--labels --eye 4,3,2 --background 010203",
        "--labels --view geodesic --at 0.7,1.2 --zoom 1",
    ] {
        let plain = match view.contains("--view") {
            true => picture(folder, view),
            false => picture(folder, &format!("{view} --show-camera s")),
        };
        let camera = match view.contains("--view") {
            true => "",
            false => "--show-camera s",
        };
        let remembered = picture(folder, &format!("--like-window {view}"));
        let stated = picture(folder, &format!("{view} {camera} {figure} {path}"));
        assert!(remembered == stated, "{view}");
        assert!(stated != plain, "{view}");
        let alone = picture(folder, &format!("{view} {camera} {figure}"));
        assert!(alone != stated && alone != plain, "{view}");
    }
    let refused = |options: &str, wanted: &str| {
        let output = render(folder, &format!("-o out.png {options}"));
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{printed}");
        assert!(printed.contains(wanted), "{printed}");
    };
    refused("--figure c=place:0,0", "c");
    refused("--figure s=place:0,9", "--figure s=place");
    refused("--path s=0,0", "two places or more");
    refused("--path s=0,0:0,9", "lies outside the domain");
}

#[test]
fn a_figure_that_is_not_finished_or_not_whole_is_noted() {
    let folder = folder();
    let noted = |figure: &str| {
        let output = render(folder.path(), &format!("-o out.png --figure {figure}"));
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{printed}");
        printed
    };
    for (figure, wanted) in [
        ("s=triangle:0.5,1:1,1", "s=triangle: it has 2 places of 3"),
        ("s=distance:0.5,1", "s=distance: it has 1 place of 2, so"),
        ("s=circle:0.5,1", "1 place of 2 and no radius"),
    ] {
        let printed = noted(figure);
        assert!(printed.contains(wanted), "{figure}: {printed}");
    }
    for whole in [
        "s=triangle:0.5,1:1,1:0.7,1.5",
        "s=circle:0.5,1:0.3",
        "s=place:0.5,1",
    ] {
        let printed = noted(whole);
        assert!(!printed.contains("note: --figure"), "{whole}: {printed}");
    }
    let plane = "surface s(u, v) = (u, v, 0), u : [-1, 1], v : [-1, 1];";
    std::fs::write(folder.path().join("a.gtr"), plane).expect("writing");
    let printed = noted("s=circle:0,0:5");
    assert!(
        printed.contains("the circle is not complete: the ray"),
        "{printed}"
    );
}

#[test]
fn colours_of_curvature_stand_and_a_chosen_one_is_noted() {
    let folder = folder();
    let curved = "--texture s=curvature --hide c";
    let plain = picture(folder.path(), curved);
    assert!(plain == picture(folder.path(), &format!("{curved} --colour s=#000080")));
    let output = render(
        folder.path(),
        &format!("-o out.png {curved} --colour s=#000080"),
    );
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let wanted = "--colour s: `s` has the colours of its curvature";
    assert!(printed.contains(wanted), "{printed}");
}

#[test]
fn a_path_is_as_long_as_it_is_on_the_surface_of_each_frame() {
    let folder = folder();
    let folder = folder.path();
    let shown = "--labels --path s=0.5,1.2:0.6,1.3:0.7,1.6";
    let camera = "--view geodesic --at 0.7,1.2 --zoom 1";
    let output = render(
        folder,
        &format!("-o f.png {shown} {camera} --animate a=1:3 --frames 2"),
    );
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}");
    let still = picture(folder, &format!("{shown} {camera} --set a=3"));
    assert!(std::fs::read(folder.join("f-0002.png")).expect("a frame") == still);
}

#[test]
fn a_camera_on_a_solid_is_shown_and_its_way_is_refused() {
    let folder = folder();
    let folder = folder.path();
    let solid = "solid q(x, y, z) = x^4 + y^4 + z^4 - 1;";
    std::fs::write(folder.join("a.gtr"), solid).expect("writing");
    assert!(picture(folder, "--show-camera q") != picture(folder, ""));
    std::fs::write(folder.join(".a.gtr.geotrace.json"), REMEMBERED).expect("writing");
    picture(folder, "--view geodesic:q --like-window");
    let output = render(folder, "-o out.png --view geodesic:q --walk 1 --trail");
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{printed}");
    assert!(printed.contains("--trail"), "{printed}");
}
