//! The layout: canonical, stable, and without influence on what a text means.

use ide::edit;
use ide::geotrace::GeotraceAnalysis;
use ide::geotrace::format::format;
use syntax::span::Span;

fn formatted(text: &str) -> String {
    edit::apply(text, &format(&GeotraceAnalysis::new(text), None))
}

#[test]
fn texts_are_laid_out() {
    assert_eq!(
        formatted("param r:[ 0 ,1 ];  define a=2pi ;\n\n\n\ndefine b = a+r - -1;"),
        "param r : [0, 1];\ndefine a = 2pi;\n\ndefine b = a + r - -1;\n"
    );
    assert_eq!(
        formatted("  # one\nsurface s(u,v)=(u,\nv,0),u:[0,1],\n      v:[0,1];# two"),
        "# one\nsurface s(u, v) = (u,\n    v, 0), u : [0, 1],\n    v : [0, 1]; # two\n"
    );
    assert_eq!(formatted(""), "");
    assert_eq!(formatted("vector v=c'2@p;"), "vector v = c'2 @ p;\n");
}

#[test]
fn words_stay_as_they_are_joined() {
    let text = "function f(x) = 2pix + sin x^2 / cosx - x_1*x;\n";
    assert_eq!(formatted(text), text);
}

#[test]
fn what_is_laid_out_stays_and_compiles_to_the_same() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "gtr") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a text");
        let once = formatted(&text);
        assert_eq!(formatted(&once), once, "{}", path.display());
        let words = |text: &str| -> Vec<String> {
            let analysis = GeotraceAnalysis::new(text);
            let tokens = analysis.tokens(0..analysis.token_count());
            tokens.map(|t| t.text.trim_end().to_owned()).collect()
        };
        assert_eq!(words(&text), words(&once));
        let diagnostics = |text: &str| -> Vec<String> {
            let compilation = scene::geotrace::compile(text);
            compilation
                .diagnostics
                .iter()
                .map(|d| d.message.clone())
                .collect()
        };
        assert_eq!(diagnostics(&text), diagnostics(&once));
        count += 1;
    }
    assert!(count >= 16);
}

#[test]
fn faulty_texts_are_laid_out_too_without_losing_a_token() {
    for text in [
        "define a = (1 +;  define b=2;",
        "define = ;;; define",
        "€ define a=1;",
        "define a=1 # no semicolon",
        "\u{FEFF}define a=1;",
        "a b c",
        "define a = 1.;define b=.5;define c=1 .5;",
        "define x = 2e -3; define y=2e-3;",
    ] {
        let once = formatted(text);
        let letters = |text: &str| {
            text.chars()
                .filter(|c| !c.is_whitespace())
                .collect::<String>()
        };
        assert_eq!(letters(text), letters(&once), "{text:?} became {once:?}");
        assert_eq!(formatted(&once), once, "{text:?}");
    }
}

#[test]
fn what_cannot_be_read_stays_as_it_is() {
    for (text, expected) in [
        (
            "point p=(1,2,3); // the point of the curve, here\ndefine a=2;\ndefine b=a;",
            "point p = (1, 2, 3); // the point of the curve, here\ndefine a=2;\ndefine b = a;\n",
        ),
        (
            "/* radius; in  metres */\ndefine a=2;define b=a;",
            "/* radius; in  metres */\ndefine a=2;\ndefine b = a;\n",
        ),
        (
            "curve c(t)=(cos t,sin t,0),0 <= t <= 2pi;define b=2;",
            "curve c(t)=(cos t,sin t,0),0 <= t <= 2pi;\ndefine b = 2;\n",
        ),
        ("function f(x) -> x^2;", "function f(x) -> x^2;\n"),
        (
            "define a=1 ;define  b=2+;  define c=3;",
            "define a = 1;\ndefine  b=2+;\ndefine c = 3;\n",
        ),
        ("label \"a  b\";", "label \"a  b\";\n"),
        // What is unknown can be read.
        ("define a=b+c;", "define a = b + c;\n"),
        ("define a=b==c;", "define a = b == c;\n"),
    ] {
        assert_eq!(formatted(text), expected);
        assert_eq!(formatted(expected), expected);
    }
}

#[test]
fn a_range_touches_only_its_declarations() {
    let text = "define a=1;\ndefine b=2;\ndefine c=3;";
    let analysis = GeotraceAnalysis::new(text);
    let edits = format(&analysis, Some(Span::new(14, 15)));
    assert_eq!(
        edit::apply(text, &edits),
        "define a=1;\ndefine b = 2;\ndefine c=3;"
    );
}

#[test]
fn the_first_line_of_a_range_is_indented_and_those_above_stay() {
    let text = "define a=1;  \n\n\n   define b=2;\ndefine c=3;";
    let analysis = GeotraceAnalysis::new(text);
    let start = text.find("   define").expect("there") as u32;
    let end = start + 14;
    for start in [start, start + 5] {
        let edits = format(&analysis, Some(Span::new(start, end)));
        assert_eq!(
            edit::apply(text, &edits),
            "define a=1;  \n\n\ndefine b = 2;\ndefine c=3;"
        );
    }
    // A declaration that shares its line with another one stays there.
    let text = "define a=1;   define b=2;";
    let edits = format(&GeotraceAnalysis::new(text), Some(Span::new(18, 25)));
    assert_eq!(edit::apply(text, &edits), "define a=1;   define b = 2;");
}
