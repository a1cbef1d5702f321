//! Renaming in a script does not change its meaning.

use std::sync::Arc;

use ide::crt::Crt;
use ide::edit::apply;
use ide::rename::RenameError;
use ide::{Analysis, Language};

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
