//! What outlives a compile, a name at a time, and what outlives the window.

use egui::{Key, Modifiers, PointerButton, vec2};

use egui::accesskit::Role;

use egui_kittest::kittest::{NodeT, Queryable};

use crate::hand::{Hand, SPHERE};

#[test]
fn what_was_chosen_stays_by_name_when_the_text_changes() {
    let mut hand = Hand::on(SPHERE);
    hand.slide("r", 50.0);
    hand.settings("Objects");
    hand.click("Show p");
    hand.hold(Key::W, 6);
    let (value, eye) = (hand.param("r"), hand.eye());
    assert!(value > 1.1);
    // Another order, another object, another interval that holds the value.
    let text = format!(
        "point q = (1, 1, 1);\nparam a : [0, 1];\n{}",
        SPHERE.replace("[1, 3]", "[0, 4]")
    );
    hand.window_mut().set_text(text);
    hand.until("it is compiled", |hand| {
        hand.window().model().object("q").is_some()
    });
    hand.settle();
    assert_eq!(hand.param("r"), value);
    assert!(hand.window().model().choices.look("p").hidden);
    assert!(!hand.window().model().choices.look("q").hidden);
    assert_eq!(hand.eye(), eye);
    // Gone and back.
    hand.window_mut()
        .set_text("point q = (1, 1, 1);\n".to_owned());
    hand.until("it is compiled", |hand| {
        hand.window().model().object("p").is_none()
    });
    hand.window_mut().set_text(SPHERE.to_owned());
    hand.until("it is compiled", |hand| {
        hand.window().model().object("p").is_some()
    });
    hand.settle();
    assert_eq!(hand.param("r"), value);
    assert!(hand.window().model().choices.look("p").hidden);
}

#[test]
fn what_was_chosen_is_there_again_when_the_window_is_opened_again() {
    let mut hand = Hand::on(SPHERE);
    hand.slide("r", 50.0);
    hand.settings("Objects");
    hand.click("Show p");
    hand.hold(Key::D, 6);
    let middle = hand.inside("s").center();
    hand.drag(
        middle,
        vec2(30.0, 10.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    let (value, eye, camera) = (hand.param("r"), hand.eye(), hand.camera("s"));
    let mut hand = hand.again();
    assert_eq!(hand.param("r"), value);
    assert_eq!(hand.eye(), eye);
    assert!(hand.window().model().choices.look("p").hidden);
    let again = hand.camera("s");
    for k in 0..2 {
        assert!(
            (again.at[k] - camera.at[k]).abs() < 1e-12,
            "{again:?} is not {camera:?}"
        );
        assert!(
            (again.x[k] - camera.x[k]).abs() < 1e-9,
            "{again:?} is not {camera:?}"
        );
    }
}

#[test]
fn a_window_that_was_only_looked_at_remembers_nothing() {
    let mut hand = Hand::on(SPHERE);
    hand.settle();
    let path = hand.path.clone();
    let folder = hand.close();
    let files = std::fs::read_dir(path.parent().expect("a folder")).expect("readable");
    assert_eq!(files.count(), 1, "nothing but the program is there");
    drop(folder);
}

#[test]
fn the_panes_are_where_they_were_when_the_window_is_opened_again() {
    let two = format!("{SPHERE}surface t(u,v) = (u, v, 2), u : [0, 1], v : [0, 1];\n");
    let mut hand = Hand::on(&two);
    // The line between what is written and the pictures.
    let at = hand.space().left_center() - vec2(2.0, 0.0);
    let before = hand.space().left();
    hand.drag(
        at,
        vec2(-120.0, 0.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    assert!((hand.space().left() - (before - 120.0)).abs() < 3.0);
    hand.click("View");
    hand.click_on(Role::CheckBox, "Settings");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    let places = |hand: &Hand| [hand.space(), hand.inside("s")];
    let rects = places(&hand);
    let mut hand = hand.again();
    for (now, then) in places(&hand).into_iter().zip(rects) {
        let off = (now.min - then.min).length() + (now.max - then.max).length();
        assert!(off < 2.0, "{now:?} is not {then:?}");
    }
    assert!(!hand.shows("Preferences"), "the settings are closed");
    // A surface that is no more takes its pane with it, and the others stay.
    let path = hand.path.clone();
    std::fs::write(&path, SPHERE).expect("written");
    hand.until("it is read", |hand| {
        hand.window().model().object("t").is_none()
    });
    hand.settle();
    let hand = hand.again();
    assert!(hand.shows("Geodesic view of s") && !hand.shows("Geodesic view of t"));
    assert!((hand.space().left() - rects[0].left()).abs() < 2.0);
}

#[test]
fn the_tab_in_front_is_in_front_when_the_window_is_opened_again() {
    let two = format!("{SPHERE}surface t(u,v) = (u, v, 2), u : [0, 1], v : [0, 1];\n");
    let mut hand = Hand::on(&two);
    let shown = |hand: &Hand, name: &str| hand.shows(&format!("Geodesic view of {name} from"));
    let [front, behind] = if shown(&hand, "s") {
        ["s", "t"]
    } else {
        ["t", "s"]
    };
    assert!(shown(&hand, front) && !shown(&hand, behind));
    hand.click(&format!("Geodesic view – {behind}"));
    hand.settle();
    assert!(shown(&hand, behind) && !shown(&hand, front));
    let hand = hand.again();
    assert!(shown(&hand, behind) && !shown(&hand, front));
}

#[test]
fn a_layout_that_makes_no_sense_is_reported_and_the_view_is_kept() {
    for layout in [r#"42"#, r#"{"row": []}"#, r#"{"pane": {"cellar": 1}}"#] {
        let mut hand = Hand::on(SPHERE);
        hand.settings("Objects");
        hand.click("Show p");
        let beside = hand.path.with_file_name(".program.gtr.geotrace.json");
        hand.until("it is remembered", |_| beside.exists());
        let path = hand.path.clone();
        let folder = hand.close();
        let text = std::fs::read_to_string(&beside).expect("written");
        let mut known: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        known["layouts"]["alone"] = serde_json::from_str(layout).expect("JSON");
        std::fs::write(&beside, known.to_string()).expect("written");
        let hand = Hand::opened(path, folder);
        assert!(
            hand.shows("is invalid and is not used"),
            "{layout}: {:?}",
            hand.names()
        );
        assert!(hand.window().model().choices.look("p").hidden);
        assert!(hand.shows("3D view of") && hand.shows("Preferences"));
    }
}

/// What version 0.1 remembered of a window whose panes had been moved: a pane is `space` or `inside`, a view that was
/// closed is the name of its surface, and the ring at the centre stands with the overlays of all views.
const OF_VERSION_0_1: &str = r#"{
  "format": 1,
  "view": {
    "looks": { "p": { "hidden": true } },
    "closed": ["t"],
    "preferences": { "spaceSize": 300, "marks": { "centre": false, "legend": true } }
  },
  "layouts": { "alone": { "row": [
    { "share": 2.0, "content": { "tabs": { "children": [{ "pane": { "inside": "s" } }], "active": 0 } } },
    { "share": 1.0, "content": { "column": [
      { "share": 1.0, "content": { "pane": "space" } },
      { "share": 1.0, "content": { "pane": "program" } }
    ] } }
  ] } }
}"#;

#[test]
fn a_file_of_version_0_1_is_read_and_written_anew_and_nothing_is_lost() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("program.gtr");
    let beside = folder.path().join(".program.gtr.geotrace.json");
    let two = format!("{SPHERE}surface t(u,v) = (u, v, 2), u : [0, 1], v : [0, 1];\n");
    std::fs::write(&path, two).expect("written");
    std::fs::write(&beside, OF_VERSION_0_1).expect("written");
    let as_remembered = |hand: &Hand| {
        assert!(hand.inside("s").right() < hand.space().left());
        assert!(hand.inside("s").width() > 1.5 * hand.space().width());
        let closed = ["Geodesic view of t from", "Preferences", "make no sense"];
        assert!(closed.iter().all(|part| !hand.shows(part)));
        let choices = &hand.window().model().choices;
        assert!(choices.look("p").hidden && choices.preferences.marks.legend);
        assert_eq!(choices.preferences.space_size, Some(300));
    };
    let is_ringed = |hand: &mut Hand| {
        hand.click("Overlays");
        let ring = hand
            .harness
            .get_by_role_and_label(Role::CheckBox, "Ring at the centre");
        let is_on = ring.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True);
        hand.press(Modifiers::NONE, Key::Escape);
        is_on
    };
    let mut hand = Hand::opened(path, folder);
    as_remembered(&hand);
    assert!(!is_ringed(&mut hand));
    hand.click("Overlays");
    hand.click("Cut locus");
    let mut hand = hand.again();
    let text = std::fs::read_to_string(&beside).expect("written");
    assert!(
        text.contains("\"geodesic:s\"") && !text.contains("inside\": \"s\""),
        "{text}"
    );
    as_remembered(&hand);
    assert!(!is_ringed(&mut hand));
}
