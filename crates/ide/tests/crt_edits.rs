//! Renaming in a script and its layout change neither its meaning nor its diagnostics.

use std::sync::Arc;

use ide::crt::Crt;
use ide::edit::apply;
use ide::rename::RenameError;
use ide::{Analysis, Language};
use syntax::crt::codes::CONTINUES_LINE;
use syntax::crt::document::Document;
use syntax::diagnostic::Severity;

fn read(text: &str) -> Arc<dyn Analysis> {
    Crt.read(text)
}

/// Renames the variable behind the mark `|` to `q`.
fn renamed(text: &str) -> Result<String, RenameError> {
    let at = text.find('|').expect("a mark");
    let text = text.replacen('|', "", 1);
    let edits = read(&text).rename(at as u32, "q")?;
    Ok(apply(&text, &edits))
}

#[test]
fn a_call_of_a_function_is_no_use_of_a_variable_without_a_macro() {
    let plane = "Plane { normal -> vec3(0, 1, 0) position -> vec3(0, 0, 0) }";
    assert_eq!(
        renamed(&format!("|floor = {plane}\nk = floor(2.5)\nb = floor\n")),
        Ok(format!("q = {plane}\nk = floor(2.5)\nb = q\n"))
    );
    assert_eq!(
        renamed("sq|rt = 3\na = sqrt(4.0) + sqrt\n"),
        Ok("q = 3\na = sqrt(4.0) + q\n".to_owned())
    );
    let call = renamed("floor = 3\nk = flo|or(2.5)\n");
    assert_eq!(call, Err(RenameError::Builtin("floor".to_owned())));
    // A macro of the name is called.
    assert_eq!(
        renamed("s|in = Macro (x) { x }\na = sin(1)\n"),
        Ok("q = Macro (x) { x }\na = q(1)\n".to_owned())
    );
    // An inner variable without a macro does not hide the function, nor does an outer macro replace it.
    assert_eq!(
        renamed("s|in = Macro (x) { x }\nm = Macro () { sin = 2 sin(1) }\n"),
        Ok("q = Macro (x) { x }\nm = Macro () { sin = 2 sin(1) }\n".to_owned())
    );
}

#[test]
fn a_variable_that_may_be_builtin_where_it_is_used_is_not_renamed() {
    for (text, name) in [
        ("a = sin(1.0)\n|sin = Macro (x) { x }\n", "sin"),
        ("m = Macro (x) { x }\n|sin = m\na = sin(1.0)\n", "sin"),
        ("m = Macro (|abs) { abs(1) }\n", "abs"),
        ("|abs = Macro (x) { x }\nabs = 2\na = abs(1)\n", "abs"),
        ("a = t + 1\n|t = 5\n", "t"),
        ("m = Macro (k) { if (k > 0) { |t = 2 } a = t }\n", "t"),
    ] {
        let expected = Err(RenameError::Builtin(name.to_owned()));
        assert_eq!(renamed(text), expected, "{text}");
    }
    assert_eq!(
        renamed("|t = 5\na = t + 1\n"),
        Ok("q = 5\na = q + 1\n".to_owned())
    );
}

#[test]
fn the_command_of_a_converted_script_is_one_line_that_a_shell_reads() {
    let script = read("Scene { Sphere { center -> vec3(0, 0, 0) radius -> 1 } }");
    for (file, words) in [
        ("a.gtr", "a.gtr -o a.png"),
        ("-d.gtr", "./-d.gtr -o ./-d.png"),
        ("a b's.gtr", r"'a b'\''s.gtr' -o 'a b'\''s.png'"),
        (
            "a\n'b\r.gtr",
            r"$'a\u000a\'b\u000d.gtr' -o $'a\u000a\'b\u000d.png'",
        ),
    ] {
        let text = script.convert(&[0.0], file).expect("a program");
        let expected = format!("# geotrace render {words} --view=traced");
        assert!(text.starts_with(&expected), "{text}");
        let errors = ide::geotrace::Geotrace.read(&text);
        assert_eq!(errors.diagnostics().len(), 0, "{text}");
    }
}

/// Returns the number of lines with the warning that they continue the line above, in a text that can be read.
fn continued_lines(text: &str) -> usize {
    let document = Document::new(text, &()).expect("a short text");
    let found = document.all_diagnostics();
    let is_sound = found.iter().all(|it| it.severity != Severity::Error);
    assert!(is_sound, "{text}");
    let continued = found.iter().filter(|it| it.code == CONTINUES_LINE);
    continued.count()
}

fn laid_out(text: &str) -> String {
    apply(text, &read(text).format(None))
}

#[test]
fn the_layout_keeps_the_warnings_of_lines_that_continue_others() {
    for (text, expected) in [
        ("Scene { a\n- b }\n", "Scene { a\n- b }\n"),
        (
            "Scene {\n  x = [\n    a] y = a\n      - b\n}\n",
            "Scene {\n    x = [\n        a] y = a\n            - b\n}\n",
        ),
    ] {
        let solids = "a = Sphere {\n    center -> vec3(0, 0, 0)\n    radius -> 1\n}\nb = a\n";
        let text = format!("{solids}{text}");
        let once = laid_out(&text);
        assert_eq!(once, format!("{solids}{expected}"));
        assert_eq!(laid_out(&once), once);
    }
}

#[test]
fn the_layout_of_scripts_with_any_line_breaks_is_stable_and_keeps_their_warnings() {
    let pieces = [
        "a = Sphere { center -> vec3 ( 0 , 0 , 0 ) + vec3 ( 1 , 1 , 1 ) radius -> 2 - 1 }",
        "b = [ a , a ] [ 0 ]",
        "m = Macro ( q ) { q - a b - a c = [ a ] }",
        "if ( true ) { c = a + b } else { c = a ( 0 ) - b }",
        "while ( false ) { a - b <scale 2 > + c }",
    ];
    let mut seed = 5_u64;
    let mut random = |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % below
    };
    let mut warned = 0;
    for _ in 0..400 {
        let mut text = String::new();
        for _ in 0..3 {
            for word in pieces[random(pieces.len())].split(' ') {
                text += word;
                text += [" ", " ", " ", "\n", "\n  ", "\n      "][random(6)];
            }
        }
        let before = continued_lines(&text);
        let once = laid_out(&text);
        assert_eq!(laid_out(&once), once, "{text}");
        assert_eq!(continued_lines(&once), before, "{text}\n{once}");
        warned += before;
    }
    assert!(warned > 100, "{warned}");
}
