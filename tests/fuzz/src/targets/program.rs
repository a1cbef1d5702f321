//! Programs and scripts: reading them, and every feature of an editor on what was read.

use ide::language::Language;
use ide::{Languages, language::Analysis};
use syntax::span::Span;

/// Words and numbers that change how a program is read.
pub(crate) const WORDS: &[&str] = &[
    ";",
    "#",
    ",",
    ":",
    "=",
    "@",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "'",
    "_",
    "^",
    "*",
    "/",
    "+",
    "-",
    "|",
    "\\",
    "&",
    "\n",
    " ",
    "\t",
    "\r\n",
    "\u{FEFF}",
    "é",
    "𝛼",
    "π",
    "param ",
    "grid ",
    "define ",
    "function ",
    "curve ",
    "surface ",
    "point ",
    "vector ",
    "metric ",
    "geodesic ",
    "solid ",
    "light ",
    "camera ",
    "background ",
    "scale ",
    "rotate ",
    "color : ",
    "map ",
    "0",
    "1",
    "-1",
    "2pi",
    "1e308",
    "1e-308",
    "5e-324",
    "1/0",
    "0/0",
    "sqrt(-1)",
    "piv",
    "sin ",
    "cos ",
    "exp ",
    "abs ",
    "max(",
    "min(",
    "f_u",
    "f'",
    "[0, 1]",
    "[0, 1, 3]",
    "[1, 0]",
    "u : [0, 1]",
    "x^(1/3)",
    "((((((((",
    "))))))))",
    "u",
    "v",
    "x",
    "y",
    "z",
    "t",
    "s",
    "f",
];

/// The same for scripts.
pub(crate) const SCRIPT_WORDS: &[&str] = &[
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    "<",
    ">",
    "->",
    "=",
    ",",
    "--",
    "\"",
    "\n",
    " ",
    "é",
    "𝛼",
    "if (",
    "else ",
    "while (",
    "for (",
    "Macro (a) {",
    "Scene {",
    "Settings {",
    "Sphere {",
    "Box {",
    "Camera {",
    "Material {",
    "vec3(0, 1, 2)",
    "rgb(1, 0, 0)",
    "rand()",
    "t",
    "0",
    "1",
    "-1",
    "2147483647",
    "1e308",
    "1 / 0",
    "true",
    "and",
    "or",
    "not",
    "translate",
    "rotate",
    "scale",
];

/// The longest script, in bytes: each is run, and a loop may go round as often as a script may.
const LONGEST_SCRIPT: usize = 4096;

/// Reads a program of Geotrace and asks for everything.
pub(crate) fn geotrace(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let languages = Languages::standard();
    ask_all(&**languages.default_language(), &text, input);
}

/// Reads a script and asks for everything that does not run it.
pub(crate) fn crt(input: &[u8]) {
    let text = String::from_utf8_lossy(&input[..input.len().min(LONGEST_SCRIPT)]);
    let languages = Languages::standard();
    let language = languages.named("crt").expect("a language");
    let program = language.open(&text).expect("it is small");
    if let Some(diagnostics) = program.diagnostics_of_reading() {
        for found in diagnostics.iter() {
            assert_place(&text, found.span, "a finding");
        }
    }
    ask_places(&*program.snapshot(), &text, input);
}

fn ask_all(language: &dyn Language, text: &str, input: &[u8]) {
    let program = language.open(text).expect("it is small");
    let analysis = program.snapshot();
    let mut last = 0;
    for found in analysis.diagnostics().iter() {
        assert_place(text, found.span, "a diagnostic");
        assert!(found.span.start >= last, "diagnostics are sorted by place");
        last = found.span.start;
        assert!(!found.message.is_empty(), "a diagnostic says something");
    }
    let compiled = language.compile(text).expect("it is small");
    assert_eq!(
        compiled.diagnostics,
        *analysis.diagnostics(),
        "compiled at once"
    );
    ask_places(&*analysis, text, input);
    // As much of it as can be shown.
    let _ = program.scene();
}

/// Asks for the features of an editor: over the whole text, and at a few places.
fn ask_places(analysis: &dyn Analysis, text: &str, input: &[u8]) {
    let whole = Span::new(0, analysis.text().len());
    let mut end = 0;
    for token in analysis.semantic_tokens(whole) {
        assert_place(text, token.span, "a token");
        assert!(token.span.start >= end, "tokens do not overlap");
        end = token.span.end;
    }
    for entry in analysis.outline() {
        assert_place(text, entry.span, "an outline entry");
        assert_place(text, entry.name_span, "a name");
    }
    for colour in analysis.colours() {
        assert_place(text, colour.span, "a colour");
    }
    let _ = (
        analysis.folds(),
        analysis.hints(whole),
        analysis.lenses(),
        analysis.links(),
    );
    let (edits, _) = analysis.fix_all();
    let _ = ide::edit::apply(text, &edits);
    for k in 0..4_usize {
        let byte = input.get(k * input.len() / 4).copied().unwrap_or(0);
        let at = (text.len() * usize::from(byte) / 255).min(text.len());
        let at = (0..=at)
            .rev()
            .find(|at| text.is_char_boundary(*at))
            .unwrap_or(0) as u32;
        if let Some((span, _)) = analysis.hover(at) {
            assert_place(text, span, "a hover");
        }
        for span in analysis.selection(at) {
            assert_place(text, span, "a selection");
        }
        for it in analysis.occurrences(at) {
            assert_place(text, it.span, "an occurrence");
        }
        if let Some((name, introduced)) = analysis.definition(at) {
            assert_place(text, name, "a name");
            assert_place(text, introduced, "a definition");
        }
        let _ = (
            analysis.signature(at),
            analysis.completions(at, true),
            analysis.format_on_type(at),
        );
        if let Ok(edits) = analysis.rename(at, "renamed") {
            let _ = ide::edit::apply(text, &edits);
        }
    }
}

/// A place that an editor is told is one of the text, and cuts no character.
fn assert_place(text: &str, span: Span, what: &str) {
    let range = span.start as usize..span.end as usize;
    assert!(
        text.get(range).is_some(),
        "{what} at {span:?} of {} bytes",
        text.len()
    );
}
