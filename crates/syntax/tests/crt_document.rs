//! A script that is edited equals one that is read at once, and only what an edit changes is read again.

use syntax::crt::document::Document;
use syntax::crt::tree::{BlockKind, StatementKind};
use syntax::span::Span;

/// All that a document says of its text.
fn describe(document: &Document) -> Vec<String> {
    let mut lines = Vec::new();
    for chunk in document.chunks() {
        lines.push(format!(
            "{} {:?}",
            document.start(chunk),
            document.chunk_text(chunk)
        ));
    }
    let all = Span::new(0, document.len());
    lines.extend(document.tokens(all).map(|token| format!("{token:?}")));
    lines.push(format!("{:?}", document.script()));
    lines.extend(
        document
            .all_diagnostics()
            .iter()
            .map(|it| format!("{it:?}")),
    );
    lines
}

fn open(text: &str) -> Document {
    Document::new(text, &()).expect("a small text")
}

struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as usize % bound
    }
}

const PIECES: &[&str] = &[
    "\n",
    "\n",
    " ",
    "a",
    "b = a",
    "= ",
    "1",
    "1.",
    "2",
    "\"s\"",
    "\"",
    "\\",
    "--",
    "-",
    "+ 1",
    "^",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "<scale 2>",
    "scale",
    "while (a < 1) { a = a + 1 }",
    "while",
    "if (true) { a }",
    " else { b }",
    "else",
    " else if (b) { 1 }",
    "Macro (a) { a }",
    "Macro",
    "Sphere { radius -> 1 }\n",
    "Settings { gamma -> 2 }\n",
    "Scene { a\n b }\n",
    "Scene",
    "Settings",
    "!",
    "=",
    "&",
    "|",
    "é",
    "@",
    "->",
    "?",
    ":",
    ",",
    "-----BEGIN",
    "\u{FEFF}",
    "t",
    "\t",
    "\r\n",
    "vec3(1, 2, 3)",
    "rotate",
    " - b\n",
];

/// The number of edits: `EDITS=100000` runs as many.
fn edits() -> usize {
    let wanted = std::env::var("EDITS").ok();
    wanted.and_then(|text| text.parse().ok()).unwrap_or(20_000)
}

#[test]
fn random_edits_give_what_reading_the_whole_text_gives() {
    let mut random = Random(11);
    for _ in 0..edits() / 100 {
        let mut text = String::new();
        let mut document = open(&text);
        for _ in 0..100 {
            let boundary = |mut at: usize| {
                while !text.is_char_boundary(at) {
                    at -= 1;
                }
                at
            };
            let start = boundary(random.below(text.len() + 1));
            let end = boundary((start + random.below(7)).min(text.len())).max(start);
            let inserted = match text.len() < 250 {
                true => PIECES[random.below(PIECES.len())],
                false => "",
            };
            let range = Span::new(start as u32, end as u32);
            document.edit(range, inserted).expect("an edit");
            text.replace_range(start..end, inserted);
            assert_eq!(document.text(), text);
            assert_eq!(describe(&document), describe(&open(&text)), "{text:?}");
        }
    }
}

#[test]
fn an_edit_reads_its_statement_and_no_other() {
    let lines = (0..500).map(|k| format!("ball{k} = Sphere {{\n    radius -> {k}\n}}\n\n"));
    let text = lines.collect::<String>();
    let mut document = open(&text);
    assert_eq!(document.chunks().count(), 500);
    let before = document.counters();
    let at = text.find("radius -> 250").expect("there") as u32;
    let change = document
        .edit(Span::new(at + 10, at + 13), "2.5")
        .expect("an edit");
    assert_eq!(change.read.len(), 1);
    let after = document.counters();
    assert_eq!(after.edited - before.edited, 1);
    // The chunk above is read where the edit may make it longer, and the one below.
    assert!(after.cut - before.cut < 300, "{after:?}");
    let at = document.text().find("ball250").expect("there") as u32;
    let change = document.edit(Span::new(at, at), "- ").expect("an edit");
    assert_eq!((change.read.len(), change.removed.len()), (1, 1));
    assert_eq!(document.chunks().count(), 499);
}

#[test]
fn chunks_are_blocks_and_statements() {
    let text = "-- begins\na = 1 b = 2\n  - 3\nwhile (a < 2) { a = 3 }\n(a)\nif (a) { } else if (b) { 1 }\nelse\n{ 2 }\n\
        m = Macro (x) { x } f = a <scale 2> g\nc = [1,\n2] \"s\" !true\nSettings { }\nScene { a }\n";
    let document = open(text);
    let chunks: Vec<_> = document
        .chunks()
        .map(|chunk| document.chunk_text(chunk))
        .collect();
    let expected = [
        "-- begins\na = 1 ",
        "b = 2\n  - 3\n",
        "while (a < 2) { a = 3 }\n",
        "(a)\n",
        "if (a) { } else if (b) { 1 }\nelse\n{ 2 }\n",
        "m = Macro (x) { x } ",
        "f = a <scale 2> ",
        "g\n",
        "c = [1,\n2] ",
        "\"s\" ",
        "!true\n",
        "Settings { }\n",
        "Scene { a }\n",
    ];
    assert_eq!(chunks, expected);
    for piece in document.script().pieces.iter() {
        assert_eq!(piece.blocks.len(), 1);
    }
    // Each block is a declaration to those who look for places.
    assert_eq!(document.declaration_count(), 13);
    let second = text.find("b = 2").expect("there") as u32;
    let [above, from] = [second - 1, second].map(|at| document.declarations_begun(at));
    assert_eq!([above, from], [1, 2]);
    let third = text.find("while").expect("there") as u32;
    assert_eq!(document.declarations_ended(third), 2);
}

#[test]
fn a_statement_ends_behind_all_of_its_brackets() {
    for count in [1, 255, 256, 257, 400] {
        let [opened, closed] = ["(", ")"].map(|bracket| bracket.repeat(count));
        let text = format!("a = {opened}1{closed}\nb = 2\n");
        let document = open(&text);
        assert_eq!(document.chunks().count(), 2, "{count}");
    }
}

#[test]
fn a_certificate_is_left_alone() {
    let text = "-----BEGIN CERTIFICATE-----\nMIIB@@==\n-----END CERTIFICATE-----\n";
    let mut document = open(text);
    assert!(document.script().is_certificate);
    assert_eq!(document.all_diagnostics(), []);
    assert_eq!(document.tokens(Span::new(0, 60)).count(), 0);
    document.edit(Span::new(0, 0), "a = 1\n").expect("an edit");
    assert!(!document.script().is_certificate && !document.all_diagnostics().is_empty());
}

#[test]
fn a_word_starts_behind_the_last_character_that_is_none_of_its() {
    let text = "ab = 1\ncd = ef2gh + é";
    let document = open(text);
    assert_eq!(document.chunks().count(), 2);
    let snapshot = document.snapshot();
    let start = |before: &str| snapshot.word_start(text.find(before).expect("a place") as u32);
    assert_eq!([start("b ="), start(" = 1"), start("= 1")], [0, 0, 3]);
    assert_eq!([start("f2"), start("h +"), start(" + é")], [12, 12, 12]);
    let length = text.len() as u32;
    assert_eq!(snapshot.word_start(length), length);
}

#[test]
fn a_line_that_is_indented_deeper_goes_on_without_a_warning() {
    let codes = |text: &str| -> Vec<&str> {
        let found = open(text).diagnostics();
        found.iter().map(|it| it.code.0).collect()
    };
    assert_eq!(codes("a = 1\n- 2"), ["continues-line"]);
    assert_eq!(codes("a = 1\n    - 2"), [] as [&str; 0]);
    assert_eq!(
        codes("a = b\n(c)\n[d]"),
        ["continues-line", "continues-line"]
    );
    assert_eq!(codes("Scene {\n  a\n  ^ b\n}"), ["continues-line"]);
    assert_eq!(codes("a = f(1\n- 2)"), [] as [&str; 0]);
    assert_eq!(codes("a = 1 -\n2"), [] as [&str; 0]);
}

#[test]
fn a_chain_of_any_length_is_flat_and_nesting_is_limited() {
    let long = format!("a = 1{}", " + 1".repeat(100_000));
    let document = open(&long);
    assert_eq!(document.diagnostics(), []);
    for (open_text, close) in [
        ("(", ")"),
        ("[", "]"),
        ("- ", ""),
        ("a = ", ""),
        ("a ? 1 : ", ""),
        ("Macro () { ", " }"),
        ("Material { color -> ", " }"),
        ("f(", ")"),
        ("a <scale ", ">"),
        ("a[", "]"),
        ("if (a) { ", " }"),
    ] {
        let text = format!("{}1{}", open_text.repeat(10_000), close.repeat(10_000));
        let found = open(&text).diagnostics();
        let deep = found.iter().filter(|it| it.code.0 == "too-deep").count();
        assert_eq!(deep, 1, "{open_text} {:?}", found.first());
        assert_eq!(found.len(), 1, "{open_text} {:?}", found.get(1));
    }
    let suffixes = format!("a{}", "[0](1)".repeat(50_000));
    assert_eq!(open(&suffixes).diagnostics(), []);
    let arms = format!("if (a) {{ }}{}", " else if (a) { }".repeat(50_000));
    let document = open(&arms);
    assert_eq!(document.diagnostics(), []);
    let script = document.script();
    let (_, block) = script.blocks().next().expect("a block");
    let BlockKind::Statement(statement) = &block.kind else {
        panic!("no statement");
    };
    assert!(matches!(&statement.kind, StatementKind::If(arms, None) if arms.len() == 50_001));
}
