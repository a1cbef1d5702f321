//! The editor's help with what is typed: completion, descriptions, the search, comments, brackets and indentation.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable;

use crate::hand::{Hand, SPHERE};

/// Types letter by letter.
fn types(hand: &mut Hand, text: &str) {
    for letter in text.chars() {
        hand.harness.event(Event::Text(letter.to_string()));
        hand.harness.step();
    }
    hand.settle();
}

/// The events of letters that are typed.
fn letters(text: &str) -> impl Iterator<Item = Event> {
    text.chars().map(|letter| Event::Text(letter.to_string()))
}

/// The event of a key that goes down.
fn key(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

/// What the text has beyond that of the file.
fn typed(hand: &Hand) -> &str {
    let text = hand.window().text().unwrap_or_default();
    text.strip_prefix(SPHERE).unwrap_or(text)
}

/// Returns whether the list of completions has an entry.
fn offers(hand: &Hand, name: &str) -> bool {
    let found = hand.harness.query_by_role_and_label(Role::Button, name);
    found.is_some()
}

#[test]
fn a_word_is_completed_from_a_list() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "su");
    assert!(offers(&hand, "surface") && !offers(&hand, "curve"));
    hand.press(Modifiers::NONE, Key::Tab);
    hand.settle();
    assert_eq!(typed(&hand), "surface ");
    assert!(!offers(&hand, "surface"));
    // The cursor is behind the word, and the text still has the keys.
    types(&mut hand, "x");
    assert_eq!(typed(&hand), "surface x");
    // One step back takes the completion away.
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert!(!typed(&hand).contains('x'), "{:?}", typed(&hand));
}

#[test]
fn a_completion_takes_the_place_of_all_that_is_typed_of_the_word() {
    // The list was made of "su"; the letters behind that have not been read when the key comes, or come with it.
    for is_one_frame in [false, true] {
        let mut hand = Hand::on(SPHERE);
        hand.write_at_end();
        types(&mut hand, "su");
        assert!(offers(&hand, "surface"));
        let tab = key(Key::Tab, Modifiers::NONE);
        if is_one_frame {
            hand.in_one_frame(letters("rf").chain([tab]).chain(letters("x")));
        } else {
            hand.in_one_frame(letters("rf"));
            hand.in_one_frame([tab].into_iter().chain(letters("x")));
        }
        hand.settle();
        assert_eq!(typed(&hand), "surface x", "in one frame: {is_one_frame}");
    }
}

#[test]
fn a_list_that_does_not_fit_what_is_typed_leaves_the_key_to_the_text() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "su");
    assert!(offers(&hand, "surface"));
    hand.in_one_frame(letters("zz").chain([key(Key::Tab, Modifiers::NONE)]));
    hand.settle();
    assert!(typed(&hand).starts_with("suzz"), "{:?}", typed(&hand));
}

#[test]
fn what_is_saved_is_what_was_typed_before_the_key() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    let save = key(Key::S, Modifiers::COMMAND);
    hand.in_one_frame(letters("# a").chain([save]).chain(letters("b")));
    hand.settle();
    let saved = std::fs::read_to_string(&hand.path).expect("it is there");
    assert_eq!(saved.strip_prefix(SPHERE), Some("# a"));
    assert_eq!(typed(&hand), "# ab");
}

#[test]
fn a_list_that_is_not_used_leaves_the_keys_to_the_text() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "su");
    assert!(offers(&hand, "surface"));
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert_eq!(typed(&hand), "su\n", "Enter ends the line");
    assert!(!offers(&hand, "surface"));
    for _ in 0..3 {
        hand.press(Modifiers::NONE, Key::Backspace);
    }
    types(&mut hand, "cu");
    assert!(offers(&hand, "curve"));
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(!offers(&hand, "curve"));
    hand.press(Modifiers::NONE, Key::ArrowUp);
    types(&mut hand, "x");
    let text = hand.window().text().unwrap_or_default();
    assert!(text.ends_with("cu") && text.contains("pox"), "{text}");
}

#[test]
fn a_list_is_requested_by_a_key_and_gone_through_by_arrows() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    hand.press(Modifiers::COMMAND, Key::Space);
    hand.settle();
    assert!(offers(&hand, "curve") && offers(&hand, "surface"));
    hand.press(Modifiers::NONE, Key::ArrowDown);
    hand.press(Modifiers::NONE, Key::ArrowUp);
    types(&mut hand, "ge");
    assert!(offers(&hand, "geodesic") && !offers(&hand, "curve"));
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert_eq!(typed(&hand), "geodesic ");
    for _ in 0.."geodesic ".len() {
        hand.press(Modifiers::NONE, Key::Backspace);
    }
    types(&mut hand, "me");
    hand.click_on(Role::Button, "metric");
    hand.settle();
    assert_eq!(typed(&hand), "metric ");
    types(&mut hand, "m");
    assert_eq!(typed(&hand), "metric m", "the text has the keys");
}

#[test]
fn tab_indents_while_one_writes_and_goes_on_before() {
    let mut hand = Hand::on(SPHERE);
    hand.tab_to("Program text");
    hand.press(Modifiers::NONE, Key::Tab);
    let place = hand.focused().map(|(_, name)| name);
    assert_ne!(place.as_deref(), Some("Program text"));
    hand.write_at_end();
    types(&mut hand, "# a");
    hand.press(Modifiers::NONE, Key::Tab);
    types(&mut hand, "b ");
    hand.press(Modifiers::NONE, Key::Enter);
    types(&mut hand, "c");
    assert_eq!(typed(&hand), "# a    b \nc");
    hand.press(Modifiers::SHIFT, Key::ArrowUp);
    hand.press(Modifiers::NONE, Key::Tab);
    hand.settle();
    assert_eq!(typed(&hand), "    # a    b \n    c");
    hand.press(Modifiers::SHIFT, Key::Tab);
    hand.settle();
    assert_eq!(typed(&hand), "# a    b \nc");
}

#[test]
fn brackets_come_and_go_in_pairs() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "point q = (");
    assert_eq!(typed(&hand), "point q = ()");
    types(&mut hand, "1, 2, f(3)");
    assert_eq!(typed(&hand), "point q = (1, 2, f(3))");
    types(&mut hand, ");");
    assert_eq!(typed(&hand), "point q = (1, 2, f(3));");
    types(&mut hand, "(");
    hand.press(Modifiers::NONE, Key::Backspace);
    hand.settle();
    assert_eq!(typed(&hand), "point q = (1, 2, f(3));", "both are gone");
    // In front of a word no bracket is closed, and a selection is put between brackets.
    hand.press(Modifiers::NONE, Key::Home);
    types(&mut hand, "(");
    assert_eq!(typed(&hand), "(point q = (1, 2, f(3));");
    hand.press(Modifiers::NONE, Key::Backspace);
    hand.press(Modifiers::SHIFT, Key::End);
    types(&mut hand, "[");
    assert_eq!(typed(&hand), "[point q = (1, 2, f(3));]");
    // All in one frame, as a fast machine or a paste of keys has it.
    hand.press(Modifiers::COMMAND, Key::End);
    hand.in_one_frame(letters("(a(b))"));
    hand.settle();
    assert!(typed(&hand).ends_with("];(a(b))") || typed(&hand).ends_with("](a(b))"));
}

#[test]
fn a_new_line_is_indented_and_lines_become_comments() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "  a");
    hand.press(Modifiers::NONE, Key::Enter);
    types(&mut hand, "b");
    assert_eq!(typed(&hand), "  a\n  b");
    hand.press(Modifiers::COMMAND, Key::Slash);
    hand.settle();
    assert_eq!(typed(&hand), "  a\n  # b");
    hand.press(Modifiers::COMMAND, Key::Slash);
    hand.settle();
    assert_eq!(typed(&hand), "  a\n  b");
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(typed(&hand), "  a\n  # b", "a step that can be undone");
    hand.click("Edit");
    hand.click("Comment or uncomment lines");
    hand.settle();
    assert_eq!(typed(&hand), "  a\n  b");
}

#[test]
fn a_text_is_found_and_replaced() {
    let mut hand = Hand::on(SPHERE);
    hand.press(Modifiers::COMMAND, Key::F);
    hand.settle();
    assert_eq!(hand.focused(), Some((Role::TextInput, "Find".to_owned())));
    types(&mut hand, "cos");
    assert!(hand.shows("1 of 3"), "{:?}", hand.names());
    hand.press(Modifiers::NONE, Key::F3);
    hand.settle();
    assert!(hand.shows("2 of 3"));
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert!(hand.shows("3 of 3"));
    hand.press(Modifiers::SHIFT, Key::Enter);
    hand.settle();
    assert!(hand.shows("2 of 3"), "{:?}", hand.names());
    let by = hand
        .harness
        .get_by_role_and_label(Role::TextInput, "Replace by");
    by.focus();
    hand.harness.run_steps(2);
    types(&mut hand, "sin");
    hand.click_on(Role::Button, "Replace");
    hand.settle();
    let once = SPHERE.replacen("cos v sin u", "sin v sin u", 1);
    let second = SPHERE.replacen("cos v cos u", "cos v sin u", 1);
    assert_eq!(hand.window().text(), Some(second.as_str()), "not {once}");
    hand.click_on(Role::Button, "Replace all");
    hand.settle();
    let all = SPHERE.replace("cos", "sin");
    assert_eq!(hand.window().text(), Some(all.as_str()));
    assert!(hand.shows("not found"));
    hand.click("Close the search");
    hand.settle();
    assert!(!hand.shows("not found"));
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.window().text(), Some(second.as_str()), "one step back");
}

#[test]
fn a_replacement_that_holds_the_word_is_not_replaced_again() {
    let mut hand = Hand::on("define a = r + r;");
    hand.press(Modifiers::COMMAND, Key::F);
    hand.settle();
    types(&mut hand, "r");
    let by = hand
        .harness
        .get_by_role_and_label(Role::TextInput, "Replace by");
    by.focus();
    hand.harness.run_steps(2);
    types(&mut hand, "radius");
    for text in ["define a = radius + r;", "define a = radius + radius;"] {
        hand.click_on(Role::Button, "Replace");
        hand.settle();
        assert_eq!(hand.window().text(), Some(text));
    }
}

#[test]
fn after_a_replacement_the_keys_are_those_of_the_text() {
    let mut hand = Hand::on(SPHERE);
    hand.press(Modifiers::COMMAND, Key::F);
    hand.settle();
    types(&mut hand, "cos");
    hand.click_on(Role::Button, "Replace all");
    hand.settle();
    let text = Some((Role::MultilineTextInput, "Program text".to_owned()));
    assert_eq!(hand.focused(), text);
    let without = SPHERE.replace("cos", "");
    assert_eq!(hand.window().text(), Some(without.as_str()));
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.window().text(), Some(SPHERE));
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(!hand.shows("Close the search"), "{:?}", hand.names());
    assert_eq!(hand.focused(), text);
    // What is typed takes the place of the word that was sought.
    hand.press(Modifiers::COMMAND, Key::F);
    hand.settle();
    types(&mut hand, "point");
    assert!(hand.shows("1 of 1"), "{:?}", hand.names());
}

#[test]
fn the_cursor_goes_to_what_is_undone() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    hand.press(Modifiers::COMMAND, Key::Home);
    hand.harness.run_steps(90);
    hand.press(Modifiers::COMMAND, Key::End);
    types(&mut hand, "# one");
    hand.harness.run_steps(90);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(typed(&hand), "");
    types(&mut hand, "# two");
    assert_eq!(typed(&hand), "# two", "{:?}", hand.window().text());
}

#[test]
fn a_word_under_the_pointer_is_described() {
    let mut hand = Hand::on(SPHERE);
    let text = hand
        .harness
        .get_by_role_and_label(Role::MultilineTextInput, "Program text");
    let begin = text.rect().left_top();
    let mut described = false;
    // Somewhere in the second line stands the surface's name.
    for step in 0..24 {
        hand.harness
            .hover_at(begin + vec2(6.0 + 5.0 * step as f32, 26.0));
        hand.harness.run_steps(60);
        described |= hand.names().iter().any(|name| name.contains("are glued"));
    }
    assert!(described, "{:?}", hand.names());
}

#[test]
fn a_fix_below_a_diagnostic_corrects_the_text() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "define a = sin 2r");
    // A mistake is shown after a pause.
    hand.until("a fix is offered", |hand| offers(hand, "Write `sin(2r)`"));
    hand.click_on(Role::Button, "Write `sin(2r)`");
    hand.settle();
    assert_eq!(typed(&hand), "define a = sin(2r)");
    // A text that has stood for a second is a step of its own, however many frames the window took to come to rest.
    hand.harness.run_steps(60);
    // The text has the keys, with the cursor behind what was corrected.
    types(&mut hand, ";");
    assert_eq!(typed(&hand), "define a = sin(2r);");
    for (step, before) in ["define a = sin(2r)", "define a = sin 2r"]
        .into_iter()
        .enumerate()
    {
        hand.press(Modifiers::COMMAND, Key::Z);
        hand.settle();
        assert_eq!(typed(&hand), before, "{} steps back", step + 1);
    }
}

#[test]
fn errors_are_listed_before_warnings() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "define a = sin 2r; define b = ln(r);");
    hand.until("both are listed", |hand| {
        hand.shows("`ln` is not defined") && offers(hand, "Write `sin(2r)`")
    });
    let [error, warning] =
        ["`ln` is not defined", "Write `sin(2r)`"].map(|part| hand.rects(part)[0].top());
    assert!(error < warning, "{error}, {warning}");
}

#[test]
fn a_name_is_changed_wherever_it_is_used() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "define a = 2r;");
    // Behind the `r` of that line.
    hand.press(Modifiers::NONE, Key::ArrowLeft);
    hand.press(Modifiers::NONE, Key::F2);
    hand.settle();
    assert_eq!(
        hand.focused(),
        Some((Role::TextInput, "Rename `r` to".to_owned()))
    );
    types(&mut hand, "sin");
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    assert!(
        hand.shows("`sin` is the name of a builtin"),
        "{:?}",
        hand.names()
    );
    types(&mut hand, "radius");
    hand.press(Modifiers::NONE, Key::Enter);
    hand.settle();
    let text = format!("{SPHERE}define a = 2r;");
    let renamed = text
        .replace("param r", "param radius")
        .replace("= r(", "= radius(");
    let renamed = renamed
        .replace(", r +", ", radius +")
        .replace("2r;", "2radius;");
    assert_eq!(hand.window().text(), Some(renamed.as_str()));
    // The bar is gone, and the cursor is still behind the name.
    types(&mut hand, "z");
    let typed = renamed.replace("2radius;", "2radiusz;");
    assert_eq!(hand.window().text(), Some(typed.as_str()));
}

#[test]
fn a_refused_renaming_is_reported_until_the_next_edit() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    hand.press(Modifiers::NONE, Key::F2);
    hand.settle();
    assert!(hand.shows("not renamed: there is no name here"));
    types(&mut hand, "# a comment");
    hand.settle();
    assert!(!hand.shows("not renamed"), "{:?}", hand.names());
}

#[test]
fn a_text_is_laid_out_and_fixed_by_keys() {
    let mut hand = Hand::on(SPHERE);
    hand.write_at_end();
    types(&mut hand, "define   a=sin 2r;define b=cos 3r;");
    // The letter comes with the key.
    let format = key(Key::F, Modifiers::SHIFT | Modifiers::ALT);
    hand.in_one_frame([format].into_iter().chain(letters("F")));
    hand.settle();
    let laid_out = SPHERE.replace("s(u,v)", "s(u, v)");
    let text = format!("{laid_out}define a = sin 2r;\ndefine b = cos 3r;\n");
    assert_eq!(hand.window().text(), Some(text.as_str()));
    types(&mut hand, "define c = ln(r);");
    hand.press(Modifiers::COMMAND, Key::Period);
    hand.settle();
    let fixed = format!("{text}define c = log(r);");
    assert_eq!(hand.window().text(), Some(fixed.as_str()));
}
