//! The incremental document: diagnostics and scene are those of compiling the whole text after every edit,
//! and no more is checked than can notice it.

use std::fmt::Write as _;

#[path = "random/programs.rs"]
mod programs;

use programs::{Check, describe, edit_count, storms};
use scene::ParamValues;
use scene::geotrace::{Document, compile};
use syntax::span::Span;

/// Holds a document to what compiling its whole text gives.
fn check(document: &Document, text: &str) {
    let whole = compile(text);
    assert_eq!(document.diagnostics(), whole.diagnostics, "{text}");
    let own = &document.compilation();
    assert_eq!(own.diagnostics, whole.diagnostics, "{text}");
    let described = own.scene.as_ref().map(describe);
    assert_eq!(described, whole.scene.as_ref().map(describe), "{text}");
    if let Some(scene) = &whole.scene {
        let params = ParamValues::initial(scene);
        for name in ["a", "f(1)", "g(1, 2)", "b + c"] {
            let evaluate = |compilation: &scene::geotrace::Compilation| {
                format!("{:?}", compilation.evaluate(name, &params))
            };
            assert_eq!(evaluate(own), evaluate(&whole), "{name} in {text}");
        }
    }
}

/// Diagnostics and scene are those of the whole text.
#[derive(Default)]
struct Whole;

impl Check for Whole {
    fn check(&mut self, document: &Document, text: &str) {
        check(document, text);
    }
}

#[test]
fn random_edits_give_what_compiling_the_whole_text_gives() {
    let sound = storms::<Whole>(edit_count());
    // Most programs are of use, or scenes would hardly be compared.
    assert!(
        4 * sound > edit_count(),
        "{sound} of {} are sound",
        edit_count()
    );
}

/// Makes one edit in the place of a text and says how many chunks were read, and how many checked.
fn redone(text: &str, old: &str, new: &str) -> (usize, u64) {
    let mut document = Document::new(text).expect("a small text");
    let start = text.find(old).expect("the place of the edit") as u32;
    let before = document.counters().checked;
    let range = Span::new(start, start + old.len() as u32);
    let change = document.edit(range, new).expect("an edit");
    check(&document, &text.replacen(old, new, 1));
    (change.read.len(), document.counters().checked - before)
}

#[test]
fn only_what_can_notice_an_edit_is_checked_again() {
    let text = "param p : [0, 2]; grid k : [0, 1, 3]; define a = 1 + 1; define b = a p; \
        function f(x) = b x; point q = (f 1, k, 0); metric m(u, v) = (1, 0, 1 + p), u : [0, 1], v : [0, 1]; \
        curve c(t) = (t, f t, b), t : [0, a]; define d = c_t 1;";
    // The same value, written otherwise: nobody else is checked.
    assert_eq!(redone(text, "1 + 1", "2"), (1, 1));
    assert_eq!(redone(text, "b x", "b  (x)"), (1, 3 + 1));
    // Another value: who reads it, who reads those, and so on; not the point's neighbours.
    assert_eq!(redone(text, "1 + 1", "3"), (1, 6));
    // A slider's end is seen by the metric alone, which is checked where the params start.
    assert_eq!(redone(text, "[0, 2]", "[0, 3]"), (1, 2));
    assert_eq!(redone(text, "p : [0, 2]", "p = 1 : [0, 2]"), (1, 2));
    // A grid's count is seen by what is drawn once for each of its values.
    assert_eq!(redone(text, "0, 1, 3", "0, 1, 4"), (1, 2));
    // A curve's interval is seen by nobody: its body is what it was.
    assert_eq!(redone(text, "[0, a]", "[0, 7a]"), (1, 1));
    // A comment moves the rest of its chunk, and nobody notices.
    assert_eq!(redone(text, " function", "# f\n function"), (1, 1));
}

#[test]
fn an_edit_of_a_solid_or_of_the_stage_is_noticed_by_those_who_use_it_alone() {
    let text = "param r : [0, 2]; grid k : [0, 1, 3]; solid a(x, y, z) = x - r, color : x; \
        solid b = a | a @ (k, 0, 0), y : [0, 1]; light l = @ (0, 0, r), power : 2; \
        point p = (b(1, 2, 3), 0, 0); solid c = b \\ a; background d = 0.5, turn : 1;";
    assert_eq!(redone(text, "power : 2", "power : r"), (1, 1));
    assert_eq!(redone(text, "turn : 1", "turn : 2"), (1, 1));
    assert_eq!(redone(text, "d = 0.5", "d = 0.6"), (1, 1));
    // A solid that stays what it is, at another place of the text.
    assert_eq!(redone(text, "x - r", "x  - (r)"), (1, 1));
    assert_eq!(redone(text, "a | a", "a  |  (a)"), (1, 1));
    // A part's attribute is seen by the sets that name it, and by who reads those.
    assert_eq!(redone(text, "color : x", "color : y"), (1, 4));
    assert_eq!(redone(text, "y : [0, 1]", "y : [0, 2]"), (1, 3));
    // A slider's end is seen by nobody, a grid's by the solid that closes at it, and by who reads that.
    assert_eq!(redone(text, "[0, 2]", "[0, 3]"), (1, 1));
    assert_eq!(redone(text, "0, 1, 3", "0, 1, 4"), (1, 4));
}

#[test]
fn leaves_and_backgrounds_are_limited_for_the_whole_program() {
    let mut text = String::from("grid k : [0, 1, 900];\ngrid l : [0, 1, 900];\n");
    for name in ["r", "s"] {
        let _ = writeln!(text, "solid {name}(x, y, z) = x - k - l;");
    }
    text.push_str("background i = 0;\nbackground j = 1;\n");
    let mut document = Document::new(&text).expect("a small text");
    for (old, new) in [
        ("900]", "500]"),
        ("background j = 1;", ""),
        ("500]", "2000]"),
        ("2000]", "10]"),
        ("i = 0;", "i = 0; background j = 2;"),
        ("i = 0;", "i = (1, 2);"),
    ] {
        check(&document, &text);
        let start = text.find(old).expect("it is there") as u32;
        let range = Span::new(start, start + old.len() as u32);
        document.edit(range, new).expect("an edit");
        text = text.replacen(old, new, 1);
    }
    check(&document, &text);
}

#[test]
fn what_is_not_in_use_any_more_does_not_pile_up() {
    let mut text = String::from("function f(x) = x^2;\n");
    for k in 0..40 {
        let _ = writeln!(text, "curve c{k}(t) = (f t, {k}, t), t : [0, 1];");
    }
    let mut document = Document::new(&text).expect("a small text");
    let at = text.find("x^2").expect("the body") as u32;
    // Each edit gives 41 symbols new meanings.
    for k in 0..2_000 {
        let (end, inserted) = if k % 2 == 0 { (at, "3") } else { (at + 1, "") };
        let range = Span::new(at, end);
        document.edit(range, inserted).expect("an edit");
    }
    let renewed = document.counters().renewed;
    assert!(
        (5..100).contains(&renewed),
        "everything was checked anew {renewed} times"
    );
    check(&document, &text);
}

#[test]
fn limits_of_the_whole_program_are_those_of_compiling_it() {
    let mut text = String::from("grid k : [0, 1, 900];\n");
    for name in ["r", "s", "t"] {
        let _ = writeln!(
            text,
            "surface {name}(u, v) = (u, v, k), u : [0, 1, 100], v : [0, 1, 100];"
        );
    }
    let mut document = Document::new(&text).expect("a small text");
    for (old, new) in [
        ("900]", "700]"),
        ("700]", "600]"),
        ("600]", "5000]"),
        ("5000]", "9]"),
    ] {
        check(&document, &text);
        let start = text.find(old).expect("it is there") as u32;
        let range = Span::new(start, start + old.len() as u32);
        document.edit(range, new).expect("an edit");
        text = text.replacen(old, new, 1);
    }
    check(&document, &text);
    let mut text = String::new();
    for k in 0..20 {
        let intervals = vec!["[0, 1]"; 900].join(", ");
        let _ = writeln!(text, "param p{k} : {intervals};");
    }
    let mut document = Document::new(&text).expect("a text");
    check(&document, &text);
    let third = text.match_indices("param").nth(3).expect("it is there").0;
    let range = Span::new(third as u32, text.len() as u32);
    document.edit(range, "").expect("an edit");
    text.truncate(third);
    check(&document, &text);
}
