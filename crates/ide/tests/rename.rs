//! Renaming never changes what any other word means.

use ide::edit;
use ide::geotrace::GeotraceAnalysis;
use ide::geotrace::rename::rename;
use ide::rename::RenameError;
use syntax::diagnostic::Severity;
use syntax::geotrace::token::TokenKind;

fn renamed(text: &str, name: &str) -> Result<String, RenameError> {
    let at = text.find('|').expect("a mark");
    let text = format!("{}{}", &text[..at], &text[at + 1..]);
    let analysis = GeotraceAnalysis::new(text.as_str());
    let edits = rename(&analysis, at as u32, name)?;
    Ok(edit::apply(&text, &edits))
}

#[test]
fn every_use_gets_the_new_name() {
    assert_eq!(
        renamed("define |a = 1;\nfunction f(x) = a x + 2a;", "radius"),
        Ok("define radius = 1;\nfunction f(x) = radius x + 2radius;".to_owned())
    );
    assert_eq!(
        renamed("function f(|x,y) = x y;\ndefine d = f_x(1,2);", "t"),
        Ok("function f(t,y) = t y;\ndefine d = f_t(1,2);".to_owned())
    );
}

#[test]
fn words_that_would_be_read_otherwise_are_written_apart() {
    // `pix` would be π·x; as `pir` it still is, but `r2` would be one name.
    assert_eq!(
        renamed(
            "define r2 = 1; define |a = 2; function f(x) = a 2 + xa;",
            "r"
        ),
        Ok("define r2 = 1; define r = 2; function f(x) = r 2 + xr;".to_owned())
    );
    // `2xa` renamed to `2xe`; `e` is builtin, so another: `ab` with `abs` at hand.
    assert_eq!(
        renamed("define |c = 2; function f(s) = cs;", "ab"),
        Ok("define ab = 2; function f(s) = ab s;".to_owned())
    );
    // The name of another word changes under it: `six` was `s i x`.
    assert_eq!(
        renamed(
            "define |a = 1; define s = 2; define i = 3; function f(x) = six + a;",
            "si"
        ),
        Ok("define si = 1; define s = 2; define i = 3; function f(x) = s i x + si;".to_owned())
    );
}

#[test]
fn names_that_cannot_be_are_refused_with_the_reason() {
    let refused = |text: &str, name: &str| renamed(text, name).expect_err("refused").to_string();
    assert_eq!(
        refused("define |a = 1;", "sin"),
        "`sin` is the name of a builtin"
    );
    assert_eq!(
        refused("define b = 1;\ndefine |a = 1;", "b"),
        "`b` is already declared in line 1"
    );
    assert_eq!(
        refused("define |a = 1;", "param"),
        "`param` is a keyword: it cannot be a name"
    );
    assert!(refused("define |a = 1;", "2a").contains("is not a name"));
    assert!(refused("define |a = 1;", "").contains("is not a name"));
    assert!(refused("define |a = 1;", "α").contains("is not a name"));
    assert_eq!(
        refused("define |a = 1;\nfunction f(x) = x;", "x"),
        "`x` is already declared in line 2"
    );
    assert_eq!(
        refused("define x = si|n 1;", "f"),
        "`sin` is builtin and cannot be renamed"
    );
    assert_eq!(refused("define x = 1 |+ 1;", "f"), "there is no name here");
}

#[test]
fn a_name_that_is_declared_twice_keeps_its_error() {
    let error = renamed("define |a = 1;\ndefine a = 2;", "b").expect_err("refused");
    assert!(
        matches!(error, RenameError::ReadOtherwise { .. }),
        "{error}"
    );
}

/// A token's text, and what it means: the number of a declaration, or its own kind.
fn meanings(analysis: &GeotraceAnalysis) -> Vec<(String, String)> {
    let tokens = analysis.tokens(0..analysis.token_count());
    tokens
        .map(|token| {
            let item = match token.kind {
                TokenKind::Constant(id) | TokenKind::Function(id) => analysis.item_of(id),
                _ => None,
            };
            let meaning = match item {
                Some(item) => format!("declaration {item}"),
                None => format!("{:?}", token.kind),
            };
            (token.text.to_owned(), meaning)
        })
        .collect()
}

#[test]
fn what_is_renamed_means_what_it_meant_in_programs_of_names_that_begin_with_each_other() {
    let names = ["s", "si", "six", "x", "xs", "a", "ab", "pis", "t"];
    let mut seed = 11_u64;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % below
    };
    let (mut done, mut apart, mut refused) = (0, 0, 0);
    for _ in 0..400 {
        let mut text = String::new();
        for _ in 0..2 + random(6) {
            let [name, one, other] = [(); 3].map(|()| names[random(names.len())]);
            text += &match random(4) {
                0 => format!("define {name} = 2{one}{other};\n"),
                1 => format!("function {name}({one}) = {one}{other} + {other} 2;\n"),
                2 => format!("define {name} = {one}_{other}(1) + pi{other}{one};\n"),
                _ => format!("define {name} = 1; # {one}\n"),
            };
        }
        let analysis = GeotraceAnalysis::new(text.as_str());
        let old = meanings(&analysis);
        let errors = |analysis: &GeotraceAnalysis| {
            let found = analysis.diagnostics().iter();
            let errors = found.filter(|found| found.severity == Severity::Error);
            errors.map(|error| error.code).collect::<Vec<_>>()
        };
        for (k, token) in analysis.tokens(0..analysis.token_count()).enumerate() {
            let name = ["s", "ix", "xsi", "b", "is"][random(5)];
            let Some(target) = analysis.target(k) else {
                continue;
            };
            let Ok(edits) = rename(&analysis, token.span.start, name) else {
                refused += 1;
                continue;
            };
            let changed = GeotraceAnalysis::new(edit::apply(&text, &edits));
            let mut expected = old.clone();
            if !edits.is_empty() {
                for occurrence in analysis.occurrences(target) {
                    expected[occurrence].0 = name.to_owned();
                }
            }
            assert_eq!(meanings(&changed), expected, "{name} at {k} of\n{text}");
            assert_eq!(
                errors(&changed),
                errors(&analysis),
                "{name} at {k} of\n{text}"
            );
            done += 1;
            apart += usize::from(edits.iter().any(|edit| edit.text == " "));
        }
    }
    assert!(
        done > 500 && apart > 20 && refused > 100,
        "{done} {apart} {refused}"
    );
}
