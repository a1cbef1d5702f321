//! Texts that are being written: incomplete, empty, of one long line, with marks of other systems.

use ide::edit::apply;
use ide::fix;
use ide::geotrace::completion::completions;
use ide::geotrace::edit_camera::edit_camera;
use ide::geotrace::{
    GeotraceAnalysis, colour, format, hints, hover, lens, navigation, outline, rename, semantic,
    signature,
};
use syntax::span::Span;

/// The text without its mark, and where the mark stood.
fn marked(text: &str) -> (GeotraceAnalysis, u32) {
    let at = text.find('|').expect("a mark");
    let text = format!("{}{}", &text[..at], &text[at + 1..]);
    (GeotraceAnalysis::new(text), at as u32)
}

fn labels(text: &str) -> Vec<String> {
    let (analysis, offset) = marked(text);
    let list = completions(&analysis, offset, true).list;
    list.into_iter().map(|c| c.label).collect()
}

fn offers(text: &str, label: &str) -> bool {
    labels(text).iter().any(|l| l == label)
}

#[test]
fn values_are_told_while_another_declaration_is_being_written() {
    for unfinished in [
        "define c = sinn 2;",
        "define c = ",
        "define c = (1,",
        "nonsense",
        "define c = 1 + (1, 2);",
        "surface q(u) = u;",
    ] {
        let text = format!("define a = 2pi;\ndefine b = a/2;\n{unfinished}");
        let (analysis, offset) = marked(&text.replace("a/2", "|a/2"));
        let (_, told) = hover::hover(&analysis, offset).expect("a name");
        assert_eq!(told.text, ["= 6.2832"], "{unfinished}");
        let all = Span::new(0, analysis.text().len() as u32);
        let values: Vec<String> = hints::hints(&analysis, all)
            .into_iter()
            .filter(|hint| hint.apart)
            .map(|hint| hint.label)
            .collect();
        assert_eq!(values, ["= 6.2832", "= 3.1416"], "{unfinished}");
    }
}

#[test]
fn what_uses_a_wrong_declaration_has_no_value() {
    // Without `ab`, the word would be read as the product of `a` and `b`.
    let text = "define a = 2; define b = 3; define ab = sinn 1; define c = |ab + 1; define d = c;";
    let (analysis, offset) = marked(text);
    let (_, told) = hover::hover(&analysis, offset).expect("a name");
    assert!(
        !told.text.iter().any(|text| text.starts_with('=')),
        "{told:?}"
    );
    let all = Span::new(0, analysis.text().len() as u32);
    let values = hints::hints(&analysis, all).into_iter();
    assert_eq!(values.filter(|hint| hint.apart).count(), 0);
}

#[test]
fn completion_knows_what_is_being_written_at_the_end_of_a_text() {
    assert!(offers("define tau = 1;\nfunction f(x) = t|", "tau"));
    assert!(offers("define tau = 1;\nfunction f(xs) = x|", "xs"));
    assert!(offers("define tau = 1;\nfunction f(x) = |", "tau"));
    assert!(offers(
        "surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];\ngeodesic g(t) : |",
        "s"
    ));
    assert!(offers("curve c(t) = (t, t, t), |", "t"));
    assert!(offers("def|", "define"));
    assert!(offers("define a = 1;\n|", "surface"));
    assert!(offers("|", "surface"));
    assert!(offers("\u{FEFF}|", "surface"));
    assert_eq!(labels("define |"), Vec::<String>::new());
    assert_eq!(labels("define a|"), Vec::<String>::new());
    assert_eq!(labels("# def|"), Vec::<String>::new());
    assert!(offers("# def\n|", "define"));
}

#[test]
fn a_comma_of_one_declaration_says_nothing_of_the_next() {
    for text in [
        "define a = 1, |curve c(t) = (t, t, t), t : [0, 1];",
        "x, |metric m(x, y) = (1, 0, 1), x : [0, 1], y : [1, 2];",
        "point p = (1, |surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];",
    ] {
        labels(text);
    }
}

#[test]
fn every_feature_answers_at_every_place_of_any_text() {
    let long = format!("define a = {};", "sin(2piu) + ".repeat(300));
    for text in [
        "",
        "\u{FEFF}",
        "\n",
        "\r\n",
        "#",
        ";",
        "define",
        "define a",
        "surface s(",
        "\u{FEFF}define a = 1;\r\ndefine b = a;\r\n# é 𝛼\r\n",
        "geodesic g(t) : s = (1, 0) @",
        "function f(x) = f_",
        "function f(x, x) = f'_x(",
        "define a = 1;;; define a = 2",
        ") ] } ( [ {",
        "vector v = (1,0,0) @ @ p",
        "param p : [0,1], [",
        "solid",
        "solid s = ",
        "solid s(x,y) = x, x : [0,",
        "solid s(x,y,z) = x, mirror : ; solid t = (s | s @ scale",
        "solid t = t @ rotate (0,0,1) @ @ & | \\ ) } ]",
        "function f(x,y,z) = x; solid s = f & f @ f(1, 2, 3) @ f \\ (f), color : (x, y",
        "light l = @ ; light m = , power; light n = (0,0,1) @ (0,0,0), power : power",
        "camera c = (1,0,0) @ (0,0,0), bokeh : , bokeh : st, fov",
        "background b(x) = ; background = (1,0,0); background c = (0,0,0), turn : [0,1]",
        "point light = (0,0,0), , color : (1, 0.5, 0), color",
        long.as_str(),
    ] {
        let analysis = GeotraceAnalysis::new(text);
        let end = text.len() as u32;
        let whole = Span::new(0, end);
        outline::outline(&analysis);
        outline::folds(&analysis);
        lens::lenses(&analysis);
        for stated in colour::colours(&analysis) {
            assert!(!stated.span.text(text).is_empty());
        }
        let written = edit_camera(&analysis, "eye", [0.0, 1.0, 0.0], [0.0; 3], 0.6);
        assert_eq!(written.expect("a free name").span, Span::new(end, end));
        fix::fixes(analysis.diagnostics(), whole);
        let laid_out = apply(text, &format::format(&analysis, None));
        let again = GeotraceAnalysis::new(laid_out.as_str());
        assert_eq!(
            apply(&laid_out, &format::format(&again, None)),
            laid_out,
            "laid out twice: {text:?}"
        );
        let places = (0..=end).filter(|&at| text.is_char_boundary(at as usize));
        let step = 1 + text.len() / 200;
        for offset in places.step_by(step) {
            hover::hover(&analysis, offset);
            signature::signature(&analysis, offset);
            navigation::definition(&analysis, offset);
            navigation::occurrences(&analysis, offset);
            let _ = rename::rename(&analysis, offset, "zq9");
            hints::hints(&analysis, Span::new(offset, end));
            semantic::semantic_tokens(&analysis, Span::new(offset, offset));
            format::format(&analysis, Some(Span::new(offset, offset)));
            let range = completions(&analysis, offset, true).range;
            assert!(range.end == offset && range.start <= offset, "{text:?}");
            let chain = outline::selection(&analysis, offset);
            assert_eq!(chain.last(), Some(&whole), "{text:?} at {offset}");
            for pair in chain.windows(2) {
                let [inner, outer] = pair else { continue };
                assert!(outer.start <= inner.start && inner.end <= outer.end);
            }
        }
    }
}

#[test]
fn names_are_renamed_into_words_of_other_declarations_or_refused() {
    // `ab` is the product of `a` and `b`: as the new name of `c` it would swallow them.
    let (analysis, offset) =
        marked("define a = 2; define b = 3; define |c = 5; define d = ab + c;");
    let edits = rename::rename(&analysis, offset, "ab").expect("a space helps");
    assert_eq!(
        apply(analysis.text(), &edits),
        "define a = 2; define b = 3; define ab = 5; define d = a b + ab;"
    );
    // A parameter that is renamed into part of a word.
    let (analysis, offset) = marked("define a = 2; function f(|x) = x a + ax;");
    let edits = rename::rename(&analysis, offset, "xa").expect("it is free");
    let renamed = GeotraceAnalysis::new(apply(analysis.text(), &edits));
    assert_eq!(
        renamed.compilation().diagnostics.len(),
        0,
        "{}",
        renamed.text()
    );
    // A use before a name that exists only below stays an error of the same kind.
    let (analysis, offset) = marked("define x = qq; define |a = 1; define b = a;");
    match rename::rename(&analysis, offset, "q") {
        Ok(edits) => {
            let text = apply(analysis.text(), &edits);
            assert!(text.starts_with("define x = qq; define q = 1;"), "{text}");
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn lines_of_other_systems_stay_lines_when_a_text_is_laid_out() {
    let analysis = GeotraceAnalysis::new("define  a=1;\r\n\r\n# é\r\ndefine b = a\r\n+ 1;\r\n");
    let laid_out = apply(analysis.text(), &format::format(&analysis, None));
    assert_eq!(
        laid_out,
        "define a = 1;\r\n\r\n# é\r\ndefine b = a\r\n    + 1;\r\n"
    );
    let again = GeotraceAnalysis::new(laid_out);
    assert_eq!(format::format(&again, None), []);
}
