//! Typing: what is redone, what is marked as stale, what is kept.

use egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable;

use crate::hand::{Hand, SPHERE};

#[test]
fn a_window_at_rest_draws_nothing() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.window().counters().clone();
    // The harness steps whether it is asked to or not; the window asks for no frame and for no picture.
    let delay =
        |hand: &Hand| hand.harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay;
    for _ in 0..20 {
        hand.harness.step();
        assert_eq!(
            delay(&hand),
            std::time::Duration::MAX,
            "it asks for another frame"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let after = hand.window().counters().clone();
    assert_eq!(after.pictures, before.pictures);
    assert_eq!(
        (after.sampled, after.followed, after.pipelines),
        (before.sampled, before.followed, before.pipelines)
    );
}

#[test]
fn what_is_typed_is_shown_and_saved_with_ctrl_s() {
    let mut hand = Hand::on("point p = (0, 0, 1);\n");
    hand.write_at_end();
    hand.harness
        .event(egui::Event::Text("point q = (1, 0, 0);".to_owned()));
    hand.harness.run_steps(2);
    hand.settle();
    assert_eq!(
        hand.window()
            .model()
            .scene
            .as_ref()
            .expect("a scene")
            .objects
            .len(),
        2
    );
    assert!(hand.shows("not saved"));
    hand.press(Modifiers::COMMAND, Key::S);
    hand.settle();
    assert!(hand.shows("Saved") && !hand.shows("not saved"));
    let saved = std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(saved, "point p = (0, 0, 1);\npoint q = (1, 0, 0);");
}

#[test]
fn a_view_of_a_surface_that_the_text_no_longer_declares_says_so() {
    let mut hand = Hand::on(&SPHERE.replace("s(u", "other(u"));
    assert!(hand.shows("Geodesic view of other"), "{:?}", hand.names());
    hand.window_mut().set_text(SPHERE.replace("r + 1", "r + "));
    hand.until("the error is shown", |hand| {
        hand.window().model().is_stale() && hand.shows("the program no longer declares other")
    });
    assert!(hand.shows("3D view of"), "{:?}", hand.names());
}

#[test]
fn a_broken_text_keeps_the_picture_marks_it_stale_and_a_mended_one_takes_the_mark_away() {
    let mut hand = Hand::on(SPHERE);
    assert!(hand.shows("Status: no errors") && !hand.shows("out of date"));
    let pictures = hand.window().counters().pictures;
    let (eye, panes) = (hand.eye(), hand.window().counters().panes.clone());
    hand.window_mut().set_text(SPHERE.replace("r + 1", "r + "));
    hand.until("the error is shown", |hand| {
        hand.window().model().is_stale()
    });
    assert!(hand.shows("Status: 1 error"), "{:?}", hand.names());
    assert!(hand.shows("out of date until the error is fixed"));
    assert_eq!(hand.rects("Line 3: ").len(), 1, "once in the window");
    // In the same frame, and with the picture still there.
    assert!(hand.shows("3D view of 2 objects"), "{:?}", hand.names());
    assert!(hand.window().counters().pictures >= pictures);
    assert_eq!(
        hand.window().counters().panes,
        panes,
        "a sentence moves no pane"
    );
    hand.window_mut().set_text(SPHERE.to_owned());
    hand.until("the mark goes", |hand| !hand.window().model().is_stale());
    assert!(hand.shows("Status: no errors") && !hand.shows("out of date"));
    hand.settle();
    assert_eq!(hand.eye(), eye);
    assert_eq!(hand.window().counters().panes, panes);
}

#[test]
fn no_sentence_moves_the_pictures_even_in_a_narrow_window() {
    let mut hand = Hand::with(SPHERE, |builder| builder.with_size([480.0, 320.0]));
    let panes = hand.window().counters().panes.clone();
    let broken = SPHERE.replace("r + 1", "nothing_of_this_name_is_there + nor_of_this_one");
    hand.window_mut().set_text(broken);
    hand.until("the error is shown", |hand| {
        hand.window().model().is_stale()
    });
    hand.settle();
    assert_eq!(hand.window().counters().panes, panes);
}

#[test]
fn the_others_keep_moving_while_one_declaration_is_broken() {
    let mut hand = Hand::on(SPHERE);
    let text = SPHERE
        .replace("(0, 0, r + 1)", "(0, 0,")
        .replace("[1, 3]", "[2, 3]");
    hand.window_mut().set_text(text);
    hand.until("the error is shown", |hand| {
        hand.window().model().is_stale()
    });
    hand.settle();
    let range = hand
        .window()
        .model()
        .scene
        .as_ref()
        .expect("a scene")
        .params[0]
        .ranges[0];
    assert_eq!(range.min, 2.0, "the good declaration is the new one");
    let stale: Vec<String> = hand
        .window()
        .model()
        .faults
        .stale()
        .iter()
        .cloned()
        .collect();
    assert_eq!(stale, ["p"], "only the broken one is as it was");
}

#[test]
fn a_view_that_shows_nothing_of_an_error_is_not_marked() {
    let text = format!(
        "{SPHERE}surface t(u,v) = (u, v, r), u : [0, 1], v : [0, 1];
metric m(u,v) = (1, 0, 1 + u^2), u : [0, 1], v : [0, 1];\n"
    );
    let mut hand = Hand::on(&text);
    let stale = |hand: &Hand, view: &str| {
        let all = hand.names();
        let words = all.iter().find(|name| name.starts_with(view));
        words.expect("it is seen").contains("; out of date")
    };
    let broken = |hand: &mut Hand, from: &str, to: &str| {
        let front = format!("Geodesic view – {}", &from[..1]);
        hand.window_mut().set_text(text.clone());
        hand.settle();
        hand.click(&front);
        hand.settle();
        let version = hand.window().model().program.version;
        hand.window_mut().set_text(text.replace(&from[2..], to));
        hand.until("the error is shown", |hand| {
            hand.window().model().program.version > version && hand.window().model().is_stale()
        });
        // In the frame in which the status line tells it.
        assert!(hand.shows("Status: 1 error"), "{:?}", hand.names());
        let inside = format!("Geodesic view of {}", &from[..1]);
        [stale(hand, "3D view of"), stale(hand, &inside)]
    };
    assert_eq!(broken(&mut hand, "s r + 1)", "r + )"), [true, false]);
    assert_eq!(broken(&mut hand, "s r(cos v", "r((cos v"), [true, true]);
    assert_eq!(broken(&mut hand, "t r(cos v", "r((cos v"), [true, false]);
    assert_eq!(broken(&mut hand, "t (u, v, r)", "(u, v, )"), [true, true]);
    assert_eq!(broken(&mut hand, "t param r :", "param r "), [true, true]);
    assert_eq!(broken(&mut hand, "m 1 + u^2", "1 + "), [false, true]);
    assert_eq!(broken(&mut hand, "t 1 + u^2", "1 + "), [false, false]);
    hand.window_mut().set_text(text.clone());
    hand.settle();
    assert!(hand.shows("Status: no errors") && !stale(&hand, "3D view of"));
}

#[test]
fn the_geodesic_view_of_what_is_declared_at_the_cursor_is_set_off() {
    let mut hand = Hand::on("metric m(u,v) = (1, 0, 1 + u^2), u : [0, 1], v : [0, 1];\n");
    assert!(!hand.shows("declared at the cursor"));
    let text = hand
        .harness
        .get_by_role_and_label(Role::MultilineTextInput, "Program text");
    text.focus();
    hand.harness.run_steps(2);
    hand.press(Modifiers::NONE, Key::ArrowUp);
    hand.settle();
    assert!(hand.shows("declared at the cursor"), "{:?}", hand.names());
}

#[test]
fn a_file_that_changes_on_disk_is_followed_also_when_it_is_replaced() {
    let mut hand = Hand::on(SPHERE);
    let version = hand.window().model().program.version;
    std::fs::write(&hand.path, "point a = (1, 2, 3);\n").expect("written");
    hand.until("the new text is shown", |hand| {
        hand.window().model().program.version > version
            && hand.window().model().object("a").is_some()
    });
    let other = hand.path.with_file_name("other");
    std::fs::write(&other, "point b = (1, 2, 3);\n").expect("written");
    std::fs::rename(&other, &hand.path).expect("renamed");
    hand.until("the file in its place is shown", |hand| {
        hand.window().model().object("b").is_some()
    });
    assert_eq!(hand.window().text(), Some("point b = (1, 2, 3);\n"));
}

#[test]
fn two_texts_that_differ_are_a_question_and_nothing_is_lost() {
    let mut hand = Hand::on("point a = (1, 2, 3);\n");
    let mine = "point mine = (1, 2, 3);\n";
    hand.window_mut().set_text(mine.to_owned());
    hand.settle();
    std::fs::write(&hand.path, "point theirs = (1, 2, 3);\n").expect("written");
    hand.until("it asks", |hand| {
        hand.shows("Both the file on disk and this text have changed.")
    });
    assert_eq!(hand.window().text(), Some(mine));
    hand.press(Modifiers::COMMAND, Key::S);
    let on_disk = std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(
        on_disk, "point theirs = (1, 2, 3);\n",
        "not written over unseen"
    );
    hand.click("Reload from disk");
    hand.settle();
    assert!(hand.window().model().object("theirs").is_some());
    assert!(!hand.shows("Both the file on disk and this text have changed"));
}

#[test]
fn a_file_that_is_not_watched_is_not_written_over_unseen() {
    let mut hand = Hand::unwatched("point a = (1, 2, 3);\n");
    let theirs = "point theirs = (1, 2, 3);\n";
    let mine = "point mine = (1, 2, 3);\n";
    hand.window_mut().set_text(mine.to_owned());
    std::fs::write(&hand.path, theirs).expect("written");
    hand.press(Modifiers::COMMAND, Key::S);
    hand.settle();
    let on_disk = |hand: &Hand| std::fs::read_to_string(&hand.path).expect("a file");
    assert_eq!(on_disk(&hand), theirs);
    assert!(hand.shows("Both the file on disk and this text have changed."));
    hand.click("Keep my text");
    hand.press(Modifiers::COMMAND, Key::S);
    assert!(hand.shows("Saved"), "{:?}", hand.names());
    assert_eq!(on_disk(&hand), mine);
    // Where nothing was written here, the file's text is shown.
    std::fs::write(&hand.path, theirs).expect("written");
    hand.press(Modifiers::COMMAND, Key::S);
    hand.settle();
    assert_eq!(hand.window().text(), Some(theirs));
    assert!(hand.window().model().object("theirs").is_some());
    assert_eq!(on_disk(&hand), theirs);
}

/// Undoes in the pane with the text, which need not have had the keys before.
fn undo_in_text(hand: &mut Hand, key: Key) {
    let text = hand
        .harness
        .get_by_role_and_label(Role::MultilineTextInput, "Program text");
    text.focus();
    hand.harness.run_steps(2);
    hand.press(Modifiers::COMMAND, key);
    hand.settle();
}

#[test]
fn a_value_that_is_written_into_the_text_is_one_step_back() {
    let mut hand = Hand::on(SPHERE);
    let written = SPHERE.replace("param r :", "param r = 1 :");
    for _ in 0..2 {
        hand.update_text("r");
        hand.settle();
        assert_eq!(hand.window().text(), Some(written.as_str()));
        undo_in_text(&mut hand, Key::Z);
        assert_eq!(hand.window().text(), Some(SPHERE));
        let model = hand.window().model();
        assert_eq!(&*model.program.text, SPHERE, "it is compiled");
    }
    undo_in_text(&mut hand, Key::Y);
    assert_eq!(hand.window().text(), Some(written.as_str()), "and forward");
}

#[test]
fn a_text_that_the_files_has_replaced_comes_back_by_undo() {
    let mut hand = Hand::on("point a = (1, 2, 3);\n");
    let mine = "point mine = (1, 2, 3);\n";
    hand.window_mut().set_text(mine.to_owned());
    hand.settle();
    std::fs::write(&hand.path, "point theirs = (1, 2, 3);\n").expect("written");
    hand.until("it asks", |hand| hand.shows("Reload from disk"));
    hand.click("Reload from disk");
    hand.settle();
    assert!(hand.window().model().object("theirs").is_some());
    undo_in_text(&mut hand, Key::Z);
    assert_eq!(hand.window().text(), Some(mine));
    assert!(hand.window().model().object("mine").is_some());
    assert!(hand.shows("not saved"));
}

#[test]
fn an_edit_of_one_of_twenty_surfaces_samples_that_one() {
    let mut text = String::new();
    for k in 0..20 {
        text.push_str(&format!(
            "surface s{k}(u,v) = (u + {k}, v, sin(u v)), u : [0, 1], v : [0, 1];\n"
        ));
    }
    let mut hand = Hand::on(&text);
    let before = hand.window().counters().clone();
    hand.window_mut()
        .set_text(text.replace("(u + 7, v, sin(u v))", "(u + 7, v, cos(u v))"));
    hand.until("it is compiled", |hand| {
        hand.window().counters().compiled > before.compiled
    });
    hand.settle();
    let after = hand.window().counters().clone();
    assert_eq!(after.sampled - before.sampled, 1);
    assert_eq!(
        after.pipelines - before.pipelines,
        0,
        "blocks serve: the processor draws"
    );
}

#[test]
fn the_status_line_states_what_the_view_in_use_has_cost_and_how_exact_it_is() {
    let mut hand = Hand::on(SPHERE);
    assert!(
        !hand.shows(" ms, frame "),
        "a reader of pictures has no use for it"
    );
    hand.settings("Preferences");
    hand.click("Show run times");
    assert!(hand.shows("picture ") && hand.shows(" ms, frame "));
    assert!(!hand.shows(" evaluations"), "of no use in space");
    hand.press(Modifiers::NONE, Key::F6);
    hand.settle();
    let names = hand.names();
    let line = names.iter().find(|name| name.contains(" evaluations"));
    let line = line.expect("a line of numbers").clone();
    let numbers = line.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    let numbers: Vec<f64> = numbers.filter_map(|it| it.parse().ok()).collect();
    let [steps, evaluations, error] = numbers[..] else {
        panic!("three numbers: {line}");
    };
    // Each step of a method of order five or more takes several evaluations.
    assert!(steps >= 1.0 && evaluations > 4.0 * steps, "{line}");
    assert!(
        (0.0..=0.1).contains(&error),
        "a tenth of a pixel is asked for: {line}"
    );
}
