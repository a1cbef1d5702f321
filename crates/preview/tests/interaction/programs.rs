//! The programs of a window: none yet, new ones, files, examples, and those that were opened last.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use session::Theme;

use crate::hand::{Hand, SPHERE};

/// Enters the file of a dialog whose path ends so, and lets a button take it.
fn enter_file(hand: &mut Hand, end: &str, path: &Path, button: &str) {
    hand.enter(end, &path.display().to_string());
    hand.click_on(Role::Button, button);
    hand.settle();
}

/// The names of the programs that a menu offers to be opened again.
fn recent(hand: &mut Hand) -> Vec<String> {
    hand.click("File");
    hand.click_like("Open recent");
    let buttons = hand.harness.get_all_by_role(Role::Button);
    let names = buttons.filter_map(|node| node.accesskit_node().label());
    let names: Vec<String> = names.filter(|name| name.ends_with(".gtr")).collect();
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    names
}

#[test]
fn the_welcome_begins_a_program_that_is_saved_and_offered_again() {
    let state = tempfile::tempdir().expect("a folder");
    let mut hand = Hand::welcome(state.path());
    assert_eq!(hand.window().title(), "Geotrace");
    for part in [
        "New program",
        "Curve",
        "Surface",
        "Metric",
        "Solid",
        "Example torus: ",
    ] {
        assert!(hand.shows(part), "{part}: {:?}", hand.names());
    }
    hand.click_on(Role::Button, "Surface");
    hand.until("the template is shown", |hand| {
        hand.window().model().object("g").is_some()
    });
    hand.settle();
    assert!(hand.shows("Status: no errors") && hand.shows("3D view of 2 objects"));
    assert_eq!(hand.window().title(), "Untitled.gtr – Geotrace");
    hand.press(Modifiers::COMMAND, Key::S);
    hand.settle();
    let path = hand.path.clone();
    enter_file(&mut hand, "Untitled.gtr", &path, "Save");
    assert!(hand.shows("Saved"), "{:?}", hand.names());
    assert_eq!(hand.window().title(), "program.gtr – Geotrace");
    let text = std::fs::read_to_string(&path).expect("a file");
    assert_eq!(hand.window().text(), Some(text.as_str()));
    assert!(text.contains("surface s"), "{text}");

    let mut again = Hand::welcome(state.path());
    again.click("program.gtr");
    again.settle();
    assert_eq!(again.window().text(), Some(text.as_str()));
    assert_eq!(again.window().title(), "program.gtr – Geotrace");
    let folder = hand.close();
    drop(folder);

    // A file that is gone is a sentence, and no longer offered; what is shown stays.
    let mut last = Hand::welcome(state.path());
    last.click("program.gtr");
    last.settle();
    assert!(last.shows("cannot read `"), "{:?}", last.names());
    assert_eq!(last.window().title(), "Geotrace");
    assert!(!last.names().contains(&"program.gtr".to_owned()));
}

#[test]
fn another_program_takes_the_place_of_one_that_is_not_saved_only_by_consent() {
    let mut hand = Hand::on(SPHERE);
    hand.window_mut()
        .set_text("point mine = (1, 2, 3);\n".to_owned());
    hand.settle();
    hand.press(Modifiers::COMMAND, Key::N);
    hand.settle();
    assert!(hand.shows("The program is not saved"));
    hand.click("Cancel");
    hand.settle();
    assert!(hand.window().model().object("mine").is_some());
    hand.press(Modifiers::COMMAND, Key::N);
    hand.settle();
    hand.click("Do not save");
    hand.settle();
    assert_eq!(hand.window().text(), Some(""));
    let on_disk = std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(on_disk, SPHERE, "not written");
    assert_eq!(hand.window().model().history.last(), None);

    // A blank program offers templates, which an undo takes away.
    assert!(hand.shows("The program is empty"), "{:?}", hand.names());
    hand.click_on(Role::Button, "Curve");
    hand.settle();
    assert!(hand.shows("3D view of 3 objects") && !hand.shows("The program is empty"));
    hand.click("Edit");
    hand.click("Undo in the text");
    hand.settle();
    assert_eq!(hand.window().text(), Some(""));
    hand.click("Edit");
    hand.click("Redo in the text");
    hand.settle();
    assert!(hand.window().model().object("c").is_some());
}

#[test]
fn a_program_is_saved_before_another_one_takes_its_place() {
    let mut hand = Hand::on(SPHERE);
    let mine = "point mine = (1, 2, 3);\n";
    hand.window_mut().set_text(mine.to_owned());
    hand.settle();
    hand.click("Help");
    hand.click("Examples…");
    hand.settle();
    hand.click_like("Example circle: ");
    hand.settle();
    hand.click_on(Role::Button, "Save");
    hand.settle();
    let on_disk = std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(on_disk, mine);
    assert_eq!(hand.window().title(), "circle.gtr – Geotrace");
    let example = include_str!("../../../../examples/circle.gtr");
    assert_eq!(hand.window().text(), Some(example));
    assert!(hand.shows("Status: no errors") && !hand.shows("Example circle: "));
}

#[test]
fn a_file_is_opened_by_its_name_and_nothing_of_the_one_before_stays() {
    let state = tempfile::tempdir().expect("a folder");
    let mut hand = Hand::on(SPHERE);
    hand.window_mut().remember_paths_in(state.path());
    hand.slide("r", 40.0);
    let other = hand.path.with_file_name("other.gtr");
    std::fs::write(&other, "param r : [5, 6];\npoint o = (r, 0, 0);\n").expect("written");
    hand.press(Modifiers::COMMAND, Key::O);
    // There is no desktop here.
    hand.until("a name can be entered", |hand| hand.shows("Open program"));
    let end = std::path::MAIN_SEPARATOR.to_string();
    enter_file(&mut hand, &end, &other, "Open");
    assert!(hand.window().model().object("o").is_some());
    assert!(hand.window().model().object("s").is_none());
    assert!(hand.window().model().choices.params.is_empty());
    assert_eq!(hand.window().title(), "other.gtr – Geotrace");
    assert!(!hand.shows("Geodesic view"), "{:?}", hand.names());
    assert_eq!(recent(&mut hand), ["other.gtr", "program.gtr"]);
    // The one before is watched no more.
    std::fs::write(&hand.path, "point late = (0, 0, 0);\n").expect("written");
    hand.harness.run_steps(30);
    hand.settle();
    assert!(hand.window().model().object("late").is_none());
    let text = (Role::MultilineTextInput, "Program text");
    assert!(
        hand.harness
            .query_by_role_and_label(text.0, text.1)
            .is_some()
    );
}

#[test]
fn a_name_typed_in_the_dialog_takes_the_place_of_the_one_before_and_enter_saves() {
    let mut hand = Hand::on(SPHERE);
    hand.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    hand.settle();
    assert!(hand.shows("Save program"));
    // A click beside the dialog loses nothing.
    let corner = hand.space().left_bottom() + egui::vec2(4.0, -4.0);
    hand.click_at(corner);
    assert!(hand.shows("This file exists"), "{:?}", hand.names());
    hand.press(Modifiers::NONE, Key::Escape);
    hand.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    hand.settle();
    hand.harness.event(egui::Event::Text("other".to_owned()));
    hand.harness.run_steps(2);
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert_eq!(hand.window().title(), "other.gtr – Geotrace");
    let other = hand.path.with_file_name("other.gtr");
    assert_eq!(std::fs::read_to_string(other).expect("a file"), SPHERE);
}

#[test]
fn the_dialogs_for_files_begin_in_the_name_and_enter_saves() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    hand.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    hand.harness.event(egui::Event::Text("other".to_owned()));
    hand.harness.run_steps(2);
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert_eq!(hand.window().title(), "other.gtr – Geotrace");
    for (key, name) in [
        (Key::E, "picture.png"),
        (Key::M, "mesh.glb"),
        (Key::R, "record.gif"),
    ] {
        hand.press(Modifiers::COMMAND, key);
        hand.harness.run_steps(3);
        let name = hand.path.with_file_name(name);
        let stem = name.file_stem().expect("a name").to_string_lossy();
        hand.harness.event(egui::Event::Text(stem.into_owned()));
        hand.harness.run_steps(2);
        if key == Key::R {
            assert!(
                hand.names().contains(&name.display().to_string()),
                "{:?}",
                hand.names()
            );
            hand.press(Modifiers::NONE, Key::Escape);
            continue;
        }
        hand.press(Modifiers::NONE, Key::Enter);
        hand.until("it is there", |_| name.is_file());
    }
}

#[test]
fn the_buttons_of_dialogs_are_visible_in_a_small_window() {
    let mut hand = Hand::with(SPHERE, |builder| builder.with_size([400.0, 300.0]));
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(400.0, 300.0));
    for (key, verb) in [(Key::E, "Save"), (Key::M, "Save"), (Key::R, "Record")] {
        hand.press(Modifiers::COMMAND, key);
        hand.harness.run_steps(20);
        for name in [verb, "Cancel"] {
            let button = hand.harness.get_by_role_and_label(Role::Button, name);
            let place = button.rect();
            assert!(screen.contains_rect(place), "{key:?}, {name}: {place}");
        }
        hand.press(Modifiers::NONE, Key::Escape);
        hand.harness.run_steps(3);
    }
}

#[test]
fn a_picture_does_not_take_the_place_of_a_program() {
    let mut hand = Hand::on(SPHERE);
    hand.press(Modifiers::COMMAND, Key::E);
    hand.harness.run_steps(3);
    let program = hand.path.display().to_string();
    hand.enter("3d.png", &program);
    assert!(hand.shows("This file exists") && hand.shows("Replace"));
    hand.press(Modifiers::NONE, Key::Enter);
    hand.until("it is refused", |hand| {
        hand.shows("does not end in one of png, svg, pdf")
    });
    let kept = std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(kept, SPHERE);
}

#[test]
fn the_theme_is_that_of_all_programs() {
    let state = tempfile::tempdir().expect("a folder");
    let mut hand = Hand::on(SPHERE);
    hand.window_mut().remember_paths_in(state.path());
    hand.settings("Preferences");
    hand.click_on(Role::ComboBox, "Theme");
    hand.click("Light");
    hand.settle();
    let theme = |hand: &Hand| hand.window().model().choices.preferences.theme;
    assert_eq!(theme(&hand), Theme::Light);
    // It holds for a program that had another one, …
    let other = hand.path.with_file_name("other.gtr");
    std::fs::write(&other, "point o = (1, 0, 0);\n").expect("written");
    let beside = hand.path.with_file_name(".other.gtr.geotrace.json");
    let dark = r#"{"format": 1, "view": {"preferences": {"theme": "dark"}}}"#;
    std::fs::write(&beside, dark).expect("written");
    hand.press(Modifiers::COMMAND, Key::O);
    hand.until("a name can be entered", |hand| hand.shows("Open program"));
    let end = std::path::MAIN_SEPARATOR.to_string();
    enter_file(&mut hand, &end, &other, "Open");
    assert!(hand.window().model().object("o").is_some());
    assert_eq!(theme(&hand), Theme::Light);
    // … and in the next window.
    let folder = hand.close();
    std::fs::write(&beside, dark).expect("written");
    let mut hand = Hand::opened(other, folder);
    assert_eq!(theme(&hand), Theme::Dark, "what is beside it");
    hand.window_mut().remember_paths_in(state.path());
    hand.settle();
    assert_eq!(theme(&hand), Theme::Light);
}

#[test]
fn nothing_is_remembered_beside_programs_where_that_is_switched_off() {
    let state = tempfile::tempdir().expect("a folder");
    let mut hand = Hand::on(SPHERE);
    hand.window_mut().remember_paths_in(state.path());
    let beside = hand.path.with_file_name(".program.gtr.geotrace.json");
    hand.settings("Preferences");
    hand.click("Remember views beside programs");
    hand.window_mut().set_text(SPHERE.replace("r + 1", "r + 2"));
    hand.settle();
    hand.press(Modifiers::NONE, Key::Num7);
    hand.harness.run_steps(30);
    hand.settle();
    let path = hand.path.clone();
    let folder = hand.close();
    assert!(!beside.exists(), "switched off");
    // The next window knows it too, and reads nothing.
    std::fs::write(
        &beside,
        r#"{"format": 1, "view": {"params": {"r": [2.5]}}}"#,
    )
    .expect("written");
    let mut hand = Hand::opened(path, folder);
    hand.window_mut().remember_paths_in(state.path());
    hand.settle();
    assert_eq!(hand.param("r"), 1.0);
    hand.settings("Preferences");
    hand.click("Remember views beside programs");
    hand.settle();
}

#[test]
fn help_has_the_language_on_one_page_and_says_what_this_is() {
    let mut hand = Hand::on(SPHERE);
    hand.click("Help");
    hand.click("Language on one page");
    hand.settle();
    for part in ["surface s(u,v) = ", "geodesic g(t) : s", "sin cos tan"] {
        assert!(hand.shows(part), "{part}: {:?}", hand.names());
    }
    hand.keep("language");
    // Samples have letters about as large as those of the text beside them.
    let [sample, text] = ["pi   e", "constants"].map(|part| hand.rects(part)[0].height());
    assert!((sample - text).abs() < 2.0, "{sample}, {text}");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(!hand.shows("sin cos tan"));
    hand.click("Help");
    hand.click("About Geotrace");
    hand.settle();
    assert!(hand.shows(&format!("Geotrace {}", env!("CARGO_PKG_VERSION"))));
}

#[test]
fn the_views_are_shown_alone_until_the_program_is_wanted() {
    let mut hand = Hand::on(SPHERE);
    let beside = hand.space();
    hand.press(Modifiers::COMMAND, Key::B);
    hand.settle();
    assert!(hand.space().left() < 20.0, "{}", hand.space());
    assert!(!hand.shows("Program text") && !hand.shows("Camera speed"));
    hand.press(Modifiers::COMMAND, Key::F);
    hand.settle();
    assert!(hand.shows("Program text"));
    assert!((hand.space().left() - beside.left()).abs() < 1.0);
}
