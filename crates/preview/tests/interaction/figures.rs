//! Pictures that can be had again: the command that the window copies, and the dialog in which a picture is saved.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, OutputCommand};
use egui_kittest::kittest::Queryable;
use export::command_line::{command, options};
use preview::remembered;
use render::{ViewId, Views};

use crate::hand::{Hand, SPHERE};

/// Clicks on the entry or the button that copies a command, and returns the command.
fn copied(hand: &mut Hand) -> String {
    hand.harness.get_by_label("Copy as command").click();
    text_copied(hand)
}

/// The text that is copied within the next frames.
fn text_copied(hand: &mut Hand) -> String {
    for _ in 0..8 {
        hand.harness.step();
        let commands = &hand.harness.output().platform_output.commands;
        let text = commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        if let Some(text) = text {
            hand.harness.run_steps(3);
            return text;
        }
    }
    panic!("no text was copied")
}

/// The size in the command.
fn size(line: &str) -> [u32; 2] {
    let size = line.split("--size=").nth(1).expect("a size");
    let size = size.split(' ').next().expect("a word");
    let (width, height) = size.split_once('x').expect("two sides");
    [width, height].map(|side| side.parse().expect("a number"))
}

#[test]
fn the_command_of_a_view_is_that_of_what_is_remembered() {
    let mut hand = Hand::on(SPHERE);
    // Both cameras are moved before the first command is copied: the 3D view shows the other one.
    for _ in 0..2 {
        hand.press(Modifiers::NONE, Key::F6);
        for key in [Key::ArrowLeft, Key::ArrowUp] {
            hand.press(Modifiers::NONE, key);
        }
        hand.settle();
    }
    let mut lines = Vec::new();
    for _ in 0..2 {
        hand.press(Modifiers::NONE, Key::F6);
        hand.settle();
        hand.click_on(Role::Button, "File");
        lines.push(copied(&mut hand));
        hand.settle();
    }
    assert!(hand.shows("The command for this picture was copied"));
    let path = hand.path.clone();
    let _folder = hand.close();
    let languages = ide::Languages::standard();
    let compiled = languages.for_path(&path).compile(SPHERE).expect("short");
    let scene = compiled.scene.expect("a scene");
    let views = Views::standard();
    let ids = [ViewId::of_scene("3d"), ViewId::of_object("geodesic", "s")];
    lines.sort_by_key(|line| line.contains("--view=geodesic"));
    for (id, line) in ids.iter().zip(lines) {
        let request = remembered(&path, &Arc::clone(&scene), &views, id, size(&line));
        let request = request.expect("remembered");
        let output = match &id.object {
            None => "program-3d.png",
            Some(_) => "program-s.png",
        };
        let expected = command(&path, output.as_ref(), &options(&request, &views));
        assert_eq!(line, expected);
    }
}

#[test]
fn the_keys_of_the_entry_copy_the_command() {
    let mut hand = Hand::on(SPHERE);
    hand.click_on(Role::Button, "File");
    let line = copied(&mut hand);
    hand.settle();
    // What egui-winit sends: `Event::Copy` for Ctrl+C alone, the key itself with Shift.
    let modifiers = Modifiers {
        ctrl: true,
        command: true,
        shift: true,
        ..Modifiers::NONE
    };
    hand.harness.event(Event::Key {
        key: Key::C,
        physical_key: Some(Key::C),
        pressed: true,
        repeat: false,
        modifiers,
    });
    assert_eq!(text_copied(&mut hand), line);
}

#[test]
fn the_dialog_saves_finer_pictures_for_print() {
    let mut hand = Hand::on(SPHERE);
    hand.click_on(Role::Button, "File");
    hand.click("Save picture…");
    hand.harness.run_steps(3);
    for (field, value) in [("Width", 120.0), ("Height", 90.0), ("Lines and text", 2.0)] {
        let field = hand.harness.get_by_role_and_label(Role::SpinButton, field);
        field.set_value_accesskit(value);
        hand.harness.run_steps(2);
    }
    hand.click("2×");
    hand.click("White, for print");
    hand.harness.run_steps(2);
    assert!(hand.shows("240×180 pixels"));
    let line = copied(&mut hand);
    let target = hand.path.with_file_name("program-3d.png");
    assert!(line.contains(&format!("-o {}", target.display())), "{line}");
    for option in [
        "--size=240x180",
        "--theme=print",
        "--background=ffffff",
        "--scale=2",
    ] {
        assert!(line.contains(option), "{option}: {line}");
    }
    let save = hand.harness.get_all_by_role_and_label(Role::Button, "Save");
    save.last().expect("a button").click_accesskit();
    hand.until("the picture is there", |_| target.is_file());
    let image = image::open(&target).expect("a picture").into_rgba8();
    assert_eq!(image.dimensions(), (240, 180));
    assert_eq!(image.get_pixel(0, 0).0, [255; 4]);
}

#[test]
fn a_program_without_a_file_has_no_command() {
    let mut hand = Hand::unwatched(SPHERE);
    std::fs::remove_file(&hand.path).expect("removed");
    hand.click_on(Role::Button, "File");
    hand.click("Copy as command");
    hand.harness.run_steps(2);
    assert!(hand.shows("The command needs a file: save the program first"));
}
