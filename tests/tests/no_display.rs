//! A machine without a display: the window says so, and a newcomer's first command makes pictures instead.

use testing::binary::{Geotrace, geotrace};
use testing::examples;

const SCRIPT: &str = "Scene { Sphere { center -> vec3(0, 0, 0)  radius -> 1 } }\n";

fn without_display(arguments: &[&str]) -> Geotrace {
    geotrace(arguments)
        .environment("DISPLAY", "")
        .environment("WAYLAND_DISPLAY", "")
        .environment("WAYLAND_SOCKET", "")
}

#[test]
fn the_window_ends_with_a_sentence_and_status_1() {
    let run = without_display(&["preview"])
        .argument(examples::one("torus").path)
        .run();
    run.expect_status(1).expect_text("no display");
    assert!(!run.stderr.contains(".rs:"), "{}", run.stderr);
    assert_eq!(run.stdout, "");
}

#[test]
fn geotrace_alone_prints_help_and_preview_alone_says_that_there_is_no_display() {
    let help = without_display(&[]).run();
    help.expect_status(0);
    for part in ["geotrace [FILE]", "render", "What to do with it"] {
        assert!(help.stdout.contains(part), "{}", help.stdout);
    }
    let run = without_display(&["preview"]).run();
    run.expect_status(1).expect_text("no display");
}

#[test]
fn show_makes_both_pictures_instead() {
    // A file in the place of a command is shown.
    for command in [&["show"][..], &[]] {
        let folder = tempfile::tempdir().expect("a folder");
        let run = without_display(command)
            .argument(examples::one("torus").path)
            .folder(folder.path())
            .run();
        run.expect_status(0).expect_text("no display");
        for name in ["torus.png", "torus-inside.png"] {
            let image = image::open(folder.path().join(name)).expect("a picture");
            assert_eq!(image.to_rgba8().dimensions(), (800, 800), "{name}");
        }
    }
}

#[test]
fn show_makes_no_empty_picture_of_a_metric() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = without_display(&["show"])
        .argument(examples::one("flat").path)
        .folder(folder.path())
        .run();
    run.expect_status(0);
    let files = std::fs::read_dir(folder.path()).expect("the folder");
    let names: Vec<_> = files
        .map(|file| file.expect("a file").file_name())
        .collect();
    assert_eq!(names, ["flat-inside.png"], "{}", run.stderr);
}

#[test]
fn show_replaces_no_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = "surface s(u,v) = (u, v, u v), u : [0, 1], v : [0, 1], image : earth;";
    std::fs::write(folder.path().join("earth.gtr"), program).expect("written");
    let path = |name: &str| folder.path().join(name);
    // The image of the program has the program's name.
    let image = image::RgbaImage::from_pixel(4, 2, image::Rgba([0, 0, 255, 255]));
    image.save(path("earth.png")).expect("written");
    std::fs::write(path("earth-inside.png"), "of somebody").expect("written");
    for number in 2..4 {
        let run = without_display(&["earth.gtr"]).folder(folder.path()).run();
        run.expect_status(0);
        for name in ["earth", "earth-inside"] {
            let name = format!("{name}-{number}.png");
            assert!(image::open(path(&name)).is_ok(), "{name}: {run:?}");
        }
    }
    assert_eq!(
        image::open(path("earth.png")).expect("it").to_rgba8(),
        image
    );
    let other = std::fs::read(path("earth-inside.png"));
    assert_eq!(other.expect("it is there"), b"of somebody");
}

#[test]
fn show_takes_a_program_whose_name_begins_with_a_dash() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("-y.gtr"), "point p = (1, 2, 3);").expect("written");
    let run = without_display(&["show", "./-y.gtr"])
        .folder(folder.path())
        .run();
    run.expect_status(0).expect_text("no display");
    assert!(folder.path().join("-y.png").is_file(), "{run:?}");
}

#[test]
fn show_draws_the_view_that_a_language_has_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = folder.path().join("ball.crt");
    std::fs::write(&script, SCRIPT).expect("written");
    let run = without_display(&["show"])
        .argument(&script)
        .folder(folder.path())
        .run();
    run.expect_status(0).expect_text("ball.png: traced view");
}

#[test]
fn a_file_that_does_not_exist_is_named_and_a_misspelt_command_is_mended() {
    without_display(&["no-such.gtr"])
        .run()
        .expect_status(2)
        .expect_text("no-such.gtr");
    without_display(&["rendr", "a.gtr"])
        .run()
        .expect_status(2)
        .expect_text("render");
}

#[test]
fn what_is_wrong_with_the_program_or_the_file_is_reported_all_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("broken.gtr");
    std::fs::write(&broken, "define a = sinn 1;").expect("a file");
    let run = without_display(&["show"])
        .argument(&broken)
        .folder(folder.path())
        .run();
    run.expect_status(1).expect_text("undefined-name");
    for command in ["show", "preview"] {
        without_display(&[command, "/no/such.gtr"])
            .run()
            .expect_status(2)
            .expect_text("/no/such.gtr");
    }
    without_display(&["preview", "-"]).run().expect_status(2);
}
