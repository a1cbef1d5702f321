//! Animations that are recorded from the window: what is in their files, and what is not there when one is called off.

use std::fs::File;
use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use image::RgbaImage;

use crate::hand::{Hand, SPHERE};

/// Opens the dialog for the active view, and asks for so many pictures of a size.
fn ask(hand: &mut Hand, frames: f64, [width, height]: [f64; 2]) {
    hand.click_on(Role::Button, "File");
    hand.click("Record…");
    hand.harness.run_steps(3);
    for (field, value) in [("Frames", frames), ("Width", width), ("Height", height)] {
        set(hand, field, value);
    }
}

fn set(hand: &mut Hand, field: &str, value: f64) {
    let field = hand.harness.get_by_role_and_label(Role::SpinButton, field);
    field.set_value_accesskit(value);
    hand.harness.run_steps(2);
}

fn choose_what_moves(hand: &mut Hand, part: &str) {
    hand.click_on(Role::ComboBox, "What moves");
    hand.click_like(part);
    hand.harness.run_steps(2);
}

/// Presses the dialog's button, and waits for the sentence that says where the pictures are.
fn record(hand: &mut Hand) {
    hand.click_on(Role::Button, "Record");
    hand.until("the window says where it is", |hand| {
        hand.shows("s long, were saved in") || hand.shows("and so on")
    });
    hand.settle();
}

/// All files beside the program that are no memory of the window.
fn files(program: &Path) -> Vec<PathBuf> {
    let folder = std::fs::read_dir(program.parent().expect("a folder")).expect("readable");
    let mut files: Vec<PathBuf> = folder.map(|entry| entry.expect("one").path()).collect();
    files.retain(|file| file != program && file.extension() != Some("json".as_ref()));
    files.sort();
    files
}

fn gif(path: &Path) -> Vec<gif::Frame<'static>> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options
        .read_info(File::open(path).expect("there"))
        .expect("a GIF");
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("whole") {
        frames.push(frame.clone());
    }
    frames
}

#[test]
fn a_param_is_recorded_in_as_many_pictures_as_were_asked_for() {
    let mut hand = Hand::on(SPHERE);
    ask(&mut hand, 5.0, [64.0, 48.0]);
    choose_what_moves(&mut hand, "Param r");
    set(&mut hand, "To", 1.4);
    record(&mut hand);
    let target = hand.path.with_file_name("program-3d.gif");
    assert_eq!(
        files(&hand.path),
        std::slice::from_ref(&target),
        "and no other file"
    );
    let frames = gif(&target);
    assert_eq!(frames.len(), 5);
    assert!(frames.iter().all(|it| (it.width, it.height) == (64, 48)));
    // 25 pictures a second, in hundredths.
    assert!(frames.iter().all(|it| it.delay == 4));
    // The sphere grows to 1.4 times its radius before a camera that stands still: ever less is background.
    let background = |frame: &gif::Frame<'_>| {
        let near = |pixel: &&[u8]| {
            let [r, g, b] = render::style::BACKGROUND;
            let pairs = pixel.iter().zip([r, g, b]);
            pairs.into_iter().all(|(a, b)| a.abs_diff(b) < 8)
        };
        frame.buffer.chunks(4).filter(near).count()
    };
    let counts: Vec<usize> = frames.iter().map(background).collect();
    assert!(counts.is_sorted_by(|a, b| a > b), "{counts:?}");
    // The window's own param is where it was.
    assert_eq!(hand.param("r"), 1.0);
}

#[test]
fn a_turntable_and_a_param_that_comes_back_repeat_without_a_pause() {
    let program = "curve c(t) = (2t, 0, t^2), t : [0, 1]; param r : [0, 2]; point p = (r, 0, 1/2);";
    let recorded = |choose: &dyn Fn(&mut Hand)| {
        let mut hand = Hand::on(program);
        ask(&mut hand, 4.0, [48.0, 48.0]);
        choose(&mut hand);
        hand.click("PNG sequence");
        record(&mut hand);
        [1, 2, 3, 4].map(|k| {
            let path = hand.path.with_file_name(format!("program-3d-000{k}.png"));
            image::open(path).expect("a picture").to_rgba8()
        })
    };
    let turned = recorded(&|_| {});
    for (a, b) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        assert!(turned[a] != turned[b], "a quarter of a turn");
    }
    let [first, second, third, fourth] = recorded(&|hand| {
        choose_what_moves(hand, "Param r");
        hand.click("back and forth");
    });
    assert!(second == fourth, "the way back");
    assert!(first != second && second != third);
}

#[test]
fn a_recording_that_is_called_off_leaves_no_file() {
    for format in ["GIF", "APNG", "PNG sequence"] {
        let mut hand = Hand::on(SPHERE);
        ask(&mut hand, 100_000.0, [32.0, 32.0]);
        hand.click(format);
        hand.click_on(Role::Button, "Record");
        hand.until("it has begun", |hand| {
            hand.shows("of 100000") && !hand.shows("picture 1 of")
        });
        hand.click("Cancel the recording");
        hand.until("it is reported", |hand| hand.shows("was cancelled"));
        assert_eq!(files(&hand.path), Vec::<PathBuf>::new(), "{format}");
        assert!(!hand.shows("Cancel the recording"));
    }
    // A window that is closed calls its recording off.
    let mut hand = Hand::on(SPHERE);
    ask(&mut hand, 100_000.0, [32.0, 32.0]);
    hand.click_on(Role::Button, "Record");
    hand.until("it has begun", |hand| {
        hand.shows("of 100000") && !hand.shows("picture 1 of")
    });
    let path = hand.path.clone();
    let folder = hand.close();
    assert_eq!(files(&path), Vec::<PathBuf>::new());
    drop(folder);
}

#[test]
fn a_walk_around_the_sphere_is_recorded_and_comes_back() {
    let mut hand = Hand::on(SPHERE);
    let at = hand.inside("s").center();
    hand.click_at(at);
    hand.settle();
    ask(&mut hand, 5.0, [40.0, 40.0]);
    choose_what_moves(&mut hand, "Walk on s, forward");
    set(&mut hand, "Arc length", 2.0 * std::f64::consts::PI);
    hand.click("Draw the trail");
    hand.click("PNG sequence");
    record(&mut hand);
    let expected: Vec<PathBuf> = (1..=5)
        .map(|k| hand.path.with_file_name(format!("program-s-000{k}.png")))
        .collect();
    assert_eq!(files(&hand.path), expected);
    let pictures: Vec<RgbaImage> = expected
        .iter()
        .map(|path| image::open(path).expect("a picture").to_rgba8())
        .collect();
    let apart = |a: &RgbaImage, b: &RgbaImage| {
        let differences = a.as_raw().iter().zip(b.as_raw());
        let sum: u64 = differences.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        sum as f64 / a.as_raw().len() as f64
    };
    assert!(pictures.iter().all(|it| it.dimensions() == (40, 40)));
    let (around, half) = (
        apart(&pictures[0], &pictures[4]),
        apart(&pictures[0], &pictures[2]),
    );
    assert!(around < 0.5, "after a great circle: {around}");
    assert!(half > 10.0, "on the other side: {half}");
}

#[test]
fn a_name_that_is_no_animation_is_not_taken_and_a_folder_that_is_not_there_is_reported() {
    let mut hand = Hand::on(SPHERE);
    ask(&mut hand, 3.0, [32.0, 32.0]);
    hand.enter("3d.gif", "/no/such/folder/3d.bmp");
    assert!(hand.shows("must end in gif, apng, mp4, webm or png"));
    hand.click_on(Role::Button, "Record");
    assert!(hand.shows("Frames per second"), "the dialog stays open");
    hand.enter("3d.bmp", "/no/such/folder/3d.gif");
    hand.click_on(Role::Button, "Record");
    hand.until("it is reported", |hand| {
        hand.shows("cannot write `/no/such/folder/3d.gif`")
    });
}
