//! The scene of a program with errors, text by text: what stands in for what, what is stale, and what is not shown.

use scene::ProgramScene;
use scene::geotrace::Document;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

/// A document that is given one text after the other.
#[derive(Default)]
struct Reader(Option<Document>);

struct Read {
    diagnostics: Vec<Diagnostic>,
    program: ProgramScene,
}

impl Reader {
    /// Replaces what differs from the last text.
    fn read(&mut self, text: &str) -> Read {
        let document = self
            .0
            .get_or_insert_with(|| Document::new("").expect("a text"));
        let old = document.text().text();
        let pairs = old.bytes().zip(text.bytes());
        let front = pairs.take_while(|(a, b)| a == b).count();
        let pairs = old[front..].bytes().rev().zip(text[front..].bytes().rev());
        let back = pairs.take_while(|(a, b)| a == b).count();
        let range = Span::new(front as u32, (old.len() - back) as u32);
        let edit = document.edit(range, &text[front..text.len() - back]);
        edit.expect("an edit");
        Read {
            diagnostics: document.diagnostics(),
            program: document.scene_with_last_good().clone(),
        }
    }
}

const GOOD: &str = "point p = (1,2,3);\npoint q = (0,0,0);\nvector v = (1,0,0) @ q;\n";

#[test]
fn a_declaration_with_an_error_is_shown_as_it_last_was_while_others_move_on() {
    let mut reader = Reader::default();
    assert!(reader.read(GOOD).program.stale.is_empty());
    let broken = "point p = (1,2,;\npoint qq = (0,0,0);\nvector v = (1,0,0) @ qq;\n";
    let read = reader.read(broken);
    assert!(!read.diagnostics.is_empty());
    assert_eq!(read.program.stale, ["p"]);
    let scene = read.program.scene.expect("a scene");
    let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["p", "qq", "v"]);
    assert_eq!(scene.objects[1].name_span.text(broken), "qq");
}

#[test]
fn what_needs_a_declaration_that_was_never_good_is_left_out() {
    let text = "point q = (0,0;\nvector v = (1,0,0) @ q;\npoint r = (1,1,1);";
    let read = Reader::default().read(text);
    let scene = read.program.scene.expect("a scene");
    let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["r"]);
}

fn names(read: &Read) -> Vec<&str> {
    let scene = read.program.scene.as_ref().expect("a scene");
    scene.objects.iter().map(|it| it.name.as_str()).collect()
}

/// The value that a param opens with.
fn opening(read: &Read, name: &str) -> f64 {
    let params = &read.program.scene.as_ref().expect("a scene").params;
    let param = params.iter().find(|param| param.name == name);
    param.expect("there").initial[0]
}

#[test]
fn what_has_become_good_beside_an_error_is_what_stands_in_later() {
    let mut reader = Reader::default();
    reader.read("param y = 1 : [0, 9]; point x = (1, 2, 3);");
    assert_eq!(
        opening(&reader.read("param y = 2 : [0, 9]; point x = (1, 2, "), "y"),
        2.0
    );
    // The same with a declaration that is new, and both are incomplete for a key.
    let read = reader.read("param y = 2 : [0, 9]; param z = 5 : [0, 9]; point x = (1, 2, ");
    assert_eq!(opening(&read, "z"), 5.0);
    let read = reader.read("param y = : [0, 9]; param z = : [0, 9]; point x = (1, 2, ");
    assert_eq!((opening(&read, "y"), opening(&read, "z")), (2.0, 5.0));
    assert_eq!(names(&read), ["x"]);
    assert!(!read.program.incomplete);
}

#[test]
fn a_declaration_that_loses_its_end_takes_none_with_it() {
    let mut reader = Reader::default();
    reader.read(GOOD);
    let read = reader.read(&GOOD.replace("3);", "3)"));
    assert_eq!(names(&read), ["p", "q", "v"]);
    assert_eq!(
        read.program.stale,
        ["p", "q", "v"],
        "v stands on q, which is read with p"
    );
    assert!(!read.program.incomplete);
    // A new one that is begun above another one hides nothing but itself.
    let read = reader.read(&format!("point n\n{GOOD}"));
    assert_eq!(names(&read), ["p", "q", "v"]);
    assert!(read.program.incomplete);
}

#[test]
fn what_reads_a_name_that_is_gone_is_shown_as_it_was() {
    let good =
        "param a : [1, 2];\nfunction f(x) = a x;\npoint p = (f(1), 0, 0);\npoint q = (0, 0, 0);\n";
    let mut reader = Reader::default();
    reader.read(good);
    // Renamed where it is declared, and not yet where it is used.
    let renamed = good.replace("param a", "param b");
    let read = reader.read(&renamed);
    assert!(!read.diagnostics.is_empty());
    assert_eq!(names(&read), ["p", "q"]);
    assert_eq!(read.program.stale, ["p"]);
    assert!(!read.program.incomplete);
    let read = reader.read(&renamed.replace("function f", "function h"));
    assert_eq!(names(&read), ["p", "q"]);
    // Several may need it.
    let two = format!("{good}point r = (a, f(2), 0);\n");
    reader.read(&two);
    let read = reader.read(&two.replace("param a", "param b"));
    assert_eq!(names(&read), ["p", "q", "r"]);
    assert_eq!(read.program.stale, ["p", "r"]);
    assert!(!read.program.incomplete);
    // What nobody declares and nobody needs any more is gone.
    assert_eq!(
        names(&reader.read("point q = (0, 0, 0);\npoint z = (")),
        ["q"]
    );
}

#[test]
fn a_text_that_is_repaired_has_no_stale_objects() {
    let mut reader = Reader::default();
    reader.read(GOOD);
    reader.read("point p = ");
    let read = reader.read(GOOD);
    assert!(read.diagnostics.is_empty() && read.program.stale.is_empty());
    assert_eq!(read.program.scene.expect("good").objects.len(), 3);
}

#[test]
fn what_is_put_back_stands_behind_what_it_needs_itself() {
    let good = "param a : [1, 2];\ndefine b = 2a;\ndefine c = a + b;\npoint p = (b, a, c);\npoint q = (0, 0, 0);\n";
    let mut reader = Reader::default();
    reader.read(good);
    let read = reader.read("point p = (b, a, c);\npoint q = (0, 0, 0);\n");
    assert_eq!(names(&read), ["p", "q"]);
    assert_eq!(read.program.stale, ["p"]);
    assert!(!read.program.incomplete);
}

#[test]
fn what_has_changed_its_kind_does_not_stand_in_for_what_it_was() {
    let good = "define a = 2;\npoint p = (a, 0, 0);\npoint q = (0, 0, 0);\n";
    let mut reader = Reader::default();
    reader.read(good);
    let read = reader.read("function a(x) = x;\npoint p = (a, 0, 0);\npoint q = (0, 0, 1);\n");
    assert_eq!(names(&read), ["q"]);
    assert!(read.program.incomplete);
}

#[test]
fn a_declaration_that_is_too_large_is_shown_as_it_last_was() {
    let mut functions = "function f0(x) = sin(x exp x) tan(x^2)/log x;\n".to_owned();
    for level in 0..40 {
        functions += &format!(
            "function f{}(x) = f{level}'(x) f{level}(x^2 + 1);\n",
            level + 1
        );
    }
    let good = format!("{functions}point p = (f0 2, 0, 0);\npoint q = (1, 1, 1);\n");
    let mut reader = Reader::default();
    assert!(reader.read(&good).diagnostics.is_empty());
    let read = reader.read(&good.replace("f0 2", "f40 2").replace("1, 1)", "1, 2)"));
    assert!(!read.diagnostics.is_empty());
    assert_eq!(names(&read), ["p", "q"]);
    assert_eq!(read.program.stale, ["p"]);
}

#[test]
fn only_what_depends_on_something_stale_is_stale() {
    let good = "param a = 1 : [0, 4]; function f(x) = a x;
        surface s(u,v) = (u, v, f(u)), u : [0,1], v : [0,1];
        surface t(u,v) = (u, v, 2), u : [0,1], v : [0,1];
        metric m(u,v) = (1, 0, 1 + u^2), u : [0,1], v : [0,1];
        geodesic g(l) : t = (1, 0) @ (0.5, 0.5), l : [0, 0.2];
        curve c(x) = (x, 1, 1), x : [0, 1];";
    let stale = |broken: &str| {
        let mut reader = Reader::default();
        reader.read(good);
        let read = reader.read(broken);
        assert!(!read.diagnostics.is_empty());
        (read.program.stale, read.program.incomplete)
    };
    for (from, to, names) in [
        ("(x, 1, 1)", "(x, 1, ", &["c"][..]),
        ("= a x", "= a +", &["s"]),
        ("a = 1 :", "a = :", &["s"]),
        ("(0.5, 0.5)", "(0.5", &["g"]),
        ("1 + u^2", "1 + ", &["m"]),
        ("(u, v, 2)", "(u, v, ", &["t", "g"]),
    ] {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        assert_eq!(stale(&good.replace(from, to)), (names, false), "{to}");
    }
    let new = format!("{good} point p = (1, ");
    assert_eq!(stale(&new), (Vec::new(), true));
}
