//! The features of an editor on CRT scripts.

use std::sync::Arc;

use ide::crt::Crt;
use ide::edit::apply;
use ide::rename::RenameError;
use ide::{Analysis, Language};
use syntax::span::Span;

const SCRIPT: &str = "\
sphere1 = Sphere { center -> vec3(0, 0.5, 0)  radius -> 0.5 material -> Material { color -> rgb(1, 0.5, 0) } }
n = 18
max = (3 * n) / 4 + 5
myMacro = Macro (arg1) {
    i = 0
    while (i < max) {
        sphere1 <translate vec3(i*1.0, 0.0, -arg1)>
        i = i + 1        -- the next one
    }
}
Scene { myMacro(1) }
";

fn read(text: &str) -> Arc<dyn Analysis> {
    Crt.read(text)
}

fn at(text: &str, word: &str) -> u32 {
    text.find(word).expect("the word") as u32
}

#[test]
fn a_sound_script_has_no_diagnostics_and_an_outline() {
    let analysis = read(SCRIPT);
    assert_eq!(
        analysis.diagnostics().len(),
        0,
        "{:?}",
        analysis.diagnostics()
    );
    let outline = analysis.outline();
    let names: Vec<_> = outline
        .iter()
        .map(|it| format!("{} {}{}", it.keyword, it.name, it.detail))
        .collect();
    assert_eq!(
        names,
        ["Sphere sphere1", "Macro myMacro(arg1)", "Scene Scene"]
    );
    assert_eq!(analysis.folds().len(), 2);
}

#[test]
fn variables_are_renamed_in_their_scope() {
    let text =
        "i = 1\nm = Macro (a) {\n    i = 0\n    i = i + a\n    i\n}\nk = Macro (i) { i }\ni\n";
    let analysis = read(text);
    let edits = analysis.rename(0, "count").expect("a new name");
    let expected = "count = 1\nm = Macro (a) {\n    i = 0\n    i = i + a\n    i\n}\nk = Macro (i) { i }\ncount\n";
    assert_eq!(apply(text, &edits), expected);
    let inner = at(text, "i = 0");
    assert_eq!(analysis.occurrences(inner).len(), 4);
    // What may see either variable makes them one.
    let text = "i = 1\nm = Macro () { i = i + 1 }\n";
    assert_eq!(read(text).occurrences(0).len(), 3);
    let analysis = read(SCRIPT);
    let taken = analysis.rename(at(SCRIPT, "n = 18"), "max");
    assert!(matches!(
        taken,
        Err(RenameError::Taken { line: Some(3), .. })
    ));
    let keyword = analysis.rename(at(SCRIPT, "n = 18"), "while");
    assert!(matches!(keyword, Err(RenameError::Keyword(_))));
    assert_eq!(
        analysis.definition(at(SCRIPT, "max) {")),
        Some((
            Span::new(at(SCRIPT, "max) {"), at(SCRIPT, "max) {") + 3),
            Span::new(at(SCRIPT, "max ="), at(SCRIPT, "max =") + 3),
        ))
    );
}

#[test]
fn words_are_described() {
    let hover = |word: &str| {
        let (_, description) = read(SCRIPT).hover(at(SCRIPT, word)).expect("a description");
        description.plain()
    };
    assert!(hover("Sphere").contains("A ball"));
    assert!(hover("radius").contains("radius -> Float") && hover("radius").contains("Required"));
    assert!(hover("vec3").contains("vec3(x, y, z)"));
    assert!(hover("max").contains("max = (3 * n) / 4 + 5"));
    assert!(hover("myMacro").contains("A macro"));
    assert!(hover("while").contains("Repeats"));
}

#[test]
fn attributes_objects_and_variables_are_completed() {
    let labels = |text: &str| -> Vec<String> {
        let list = read(text).completions(text.len() as u32, false).list;
        list.into_iter().map(|it| it.label).collect()
    };
    let attributes = labels("a = Torus { radius -> 1 ");
    assert_eq!(attributes, ["center", "tube", "normal", "material"]);
    assert_eq!(labels("a = Camera { projection -> ")[1], "\"spherical\"");
    let values = labels("ball = 3\na = Torus { radius -> b");
    assert!(values.contains(&"ball".to_owned()) && values.contains(&"Sphere".to_owned()));
    assert!(labels("").contains(&"Scene".to_owned()));
    assert!(!labels("Scene { ").contains(&"Settings".to_owned()));
    assert_eq!(labels("-- a"), [] as [String; 0]);
}

#[test]
fn a_colour_is_picked() {
    let analysis = read(SCRIPT);
    let colors = analysis.colors();
    assert_eq!(colors.len(), 1);
    assert_eq!(
        analysis.text().slice(colors[0].span).as_deref(),
        Some("rgb(1, 0.5, 0)")
    );
    assert_eq!(
        analysis.color_texts(colors[0].span, [0.25, 1.0, 0.0]),
        ["rgb(0.25, 1, 0)"]
    );
}

#[test]
fn the_layout_has_one_attribute_a_line_and_is_stable() {
    let text = "a=Sphere{center->vec3( 0,1 ,-2 ) radius->- -1}  -- c\nb = 1 c = 2\n\n\n\nScene{\na<scale 2,rotate v>\n  +b\nif(c==2){a}\nelse {b [0](1)}\n}";
    let expected = "\
a = Sphere {
    center -> vec3(0, 1, -2)
    radius -> - -1
}  -- c
b = 1 c = 2

Scene {
    a <scale 2, rotate v>
        + b
    if (c == 2) { a }
    else { b[0](1) }
}
";
    let once = apply(text, &read(text).format(None));
    assert_eq!(once, expected);
    assert_eq!(apply(&once, &read(&once).format(None)), once);
    let faulty = "a = Sphere { radius -> }";
    assert_eq!(read(faulty).format(None), []);
}

#[test]
fn a_certificate_is_left_alone() {
    let analysis = read("-----BEGIN CERTIFICATE-----\nMIIB==\n");
    assert_eq!(analysis.diagnostics().len(), 0);
    assert_eq!(analysis.semantic_tokens(Span::new(0, 20)), []);
    assert_eq!(analysis.format(None), []);
}
