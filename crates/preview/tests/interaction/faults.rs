//! What can go wrong: no panic, a sentence, nothing lost.

use crate::hand::{Hand, SPHERE};

#[test]
fn a_file_that_goes_is_reported_and_its_text_and_picture_stay() {
    let mut hand = Hand::on(SPHERE);
    std::fs::remove_file(&hand.path).expect("removed");
    hand.until("it is reported", |hand| {
        hand.shows("the file cannot be read")
    });
    assert_eq!(hand.window().text(), Some(SPHERE));
    assert!(hand.shows("3D view of 2 objects"));
    // And it may come back.
    std::fs::write(&hand.path, "point back = (0, 0, 0);\n").expect("written");
    hand.until("it is back", |hand| {
        hand.window().model().object("back").is_some()
    });
    assert!(!hand.shows("the file cannot be read"));
}

#[test]
fn a_file_that_is_no_text_is_reported_and_the_last_one_stays() {
    let mut hand = Hand::on(SPHERE);
    std::fs::write(&hand.path, [0x70, 0xff, 0xfe, 0x00]).expect("written");
    hand.until("it is reported", |hand| hand.shows("it is not UTF-8"));
    assert_eq!(hand.window().text(), Some(SPHERE));
    std::fs::write(&hand.path, "point back = (0, 0, 0);\n").expect("written");
    hand.until("it is back", |hand| {
        hand.window().model().object("back").is_some()
    });
}

#[test]
fn what_was_remembered_and_is_broken_is_reported_and_kept() {
    let mut hand = Hand::on(SPHERE);
    let beside = hand.path.with_file_name(".program.gtr.geotrace.json");
    hand.settings("Objects");
    hand.click("Show p");
    hand.settle();
    hand.until("it is remembered", |_| beside.exists());
    let path = hand.path.clone();
    let folder = hand.close();
    // Behind the window that has closed, which writes nothing more.
    std::fs::write(&beside, "{ not json").expect("written");
    let hand = Hand::opened(path, folder);
    assert!(hand.shows("it is kept as"), "{:?}", hand.names());
    let kept = beside.with_file_name(".program.gtr.geotrace.json.unreadable");
    assert_eq!(std::fs::read_to_string(kept).expect("kept"), "{ not json");
    assert!(!hand.window().model().choices.look("p").hidden);
}

#[test]
fn a_text_of_many_lines_is_edited_without_a_halt() {
    let mut text = String::from(SPHERE);
    for k in 0..5_000 {
        text.push_str(&format!("# line {k}\n"));
    }
    let mut hand = Hand::on(&text);
    assert!(hand.shows("Status: "));
    text.push_str("point q = (1, 0, 0);\n");
    hand.window_mut().set_text(text);
    hand.until("the last line is read", |hand| {
        hand.window().model().object("q").is_some()
    });
}

#[test]
fn a_scene_beyond_its_limits_is_a_sentence() {
    let mut hand = Hand::on(SPHERE);
    let text = "grid g : [0, 1, 100000], [0, 1, 100000];\npoint p = (g_1, g_2, 0);\n";
    hand.window_mut().set_text(text.to_owned());
    hand.until("it is read", |hand| {
        hand.window().model().program.text.as_ref() == text
    });
    hand.settle();
    let words = hand.names().join("\n");
    assert!(
        words.contains("Line 1: ") || words.contains("limit") || words.contains("too many"),
        "{words}"
    );
}
