//! The program's pane: the editor, and what is wrong with the text.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;

use crate::hand::{FRAME, Hand, SPHERE};

/// The frames of the pause in typing after which faults are shown.
const PAUSE: usize = (0.5 / FRAME) as usize;

/// Types a text and waits until it is compiled.
fn types(hand: &mut Hand, text: &str) {
    let version = hand.window().model().program.version;
    hand.harness.event(Event::Text(text.to_owned()));
    hand.until("it is compiled", |hand| {
        hand.window().model().program.version > version
    });
}

#[test]
fn the_editor_fills_its_pane() {
    for size in [[800.0, 600.0], [1440.0, 900.0]] {
        let hand = Hand::with(SPHERE, |builder| builder.with_size(size));
        let text = hand
            .harness
            .get_by_role_and_label(Role::MultilineTextInput, "Program text");
        let below = hand.rects("Settings")[0].top();
        let free = below - text.rect().bottom();
        assert!((0.0..24.0).contains(&free), "{free} points in {size:?}");
    }
}

#[test]
fn an_error_is_shown_after_a_pause_in_typing_and_its_end_at_once() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    for letter in ["p", "o", "i", "n"] {
        types(&mut hand, letter);
        hand.harness.run_steps(PAUSE / 2);
        assert!(!hand.window().model().program.ok, "it has an error");
        assert!(!hand.window().model().is_stale(), "that is not shown");
        assert!(hand.shows("Status: no errors") && !hand.shows("out of date"));
    }
    hand.harness.run_steps(PAUSE);
    assert!(hand.window().model().is_stale());
    assert!(hand.shows("Status: 1 error") && hand.shows("Line 4: "));
    // What is shown stays while more is typed; what is mended goes in the same frame.
    types(&mut hand, "t");
    types(&mut hand, " q = (0, 0, 0);");
    assert!(!hand.window().model().is_stale());
    assert!(hand.shows("Status: no errors") && !hand.shows("Line 4: "));
}

#[test]
fn a_click_on_an_error_puts_the_cursor_there() {
    let mut hand = Hand::on(&SPHERE.replace("r + 1)", "rr + wrong)"));
    assert!(hand.shows("Status: 1 error"), "{:?}", hand.names());
    assert_eq!(hand.rects("wrong`").len(), 1, "each error once");
    hand.click_like("Line 3: ");
    hand.settle();
    let text = (Role::MultilineTextInput, "Program text".to_owned());
    assert_eq!(hand.focused(), Some(text));
    hand.harness.event(Event::Text("2".to_owned()));
    hand.settle();
    let text = hand.window().text().unwrap_or_default().to_owned();
    assert_eq!(text, SPHERE.replace("r + 1)", "rr + 2)"));
    assert!(hand.shows("Status: no errors"));
}

#[test]
fn what_is_declared_at_the_cursor_is_set_off_in_space_for_a_second() {
    let mut hand = Hand::on(SPHERE);
    let pictures = hand.window().counters().pictures;
    hand.write_at_end();
    hand.press(Modifiers::NONE, Key::ArrowUp);
    hand.until("the point is set off", |hand| {
        hand.window().counters().pictures > pictures
    });
    assert!(!hand.window().is_settled());
    let pictures = hand.window().counters().pictures;
    hand.harness.run_steps((1.0 / FRAME) as usize);
    hand.until("it has its own colour again", |hand| {
        hand.window().counters().pictures > pictures
    });
    hand.settle();
    assert_eq!(hand.window().model().highlighted.as_deref(), Some("p"));
}
