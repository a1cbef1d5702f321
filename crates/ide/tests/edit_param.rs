//! Values written into the text: the text read again opens with them.

use ide::edit::apply;
use ide::edit_param::EditParamError;
use ide::geotrace::edit_param::edit_param;
use ide::geotrace::{GeotraceAnalysis, hover};
use scene::{ParamValues, SetError};

/// The text with a value written, which compiles and opens with exactly that value.
fn written(text: &str, param: &str, values: &[f64]) -> String {
    let edit = edit_param(&GeotraceAnalysis::new(text), param, values).expect("an edit");
    let text = apply(text, &[edit]);
    let compilation = scene::geotrace::compile(&text);
    let scene = compilation.scene.as_ref().expect("no errors");
    let params = ParamValues::initial(scene);
    let read = scene.params.iter().find(|it| it.name == param).expect("it");
    assert_eq!(params.param(read), values, "{text}");
    // Written twice it is as it was.
    let again = edit_param(&GeotraceAnalysis::new(&*text), param, values).expect("an edit");
    assert_eq!(apply(&text, &[again]), text);
    text
}

#[test]
fn a_value_is_put_before_the_intervals_or_in_place_of_the_one_that_is_there() {
    for (text, values, expected) in [
        (
            "param r : [0, 1]; # wide",
            &[0.3][..],
            "param r = 0.3 : [0, 1]; # wide",
        ),
        ("param r:[0,1];", &[0.25], "param r = 0.25:[0,1];"),
        ("param r = 1/2 : [0, 1];", &[1.0], "param r = 1 : [0, 1];"),
        (
            "param r = # now\n  1/2 # half\n : [0, 1];",
            &[0.0],
            "param r = # now\n  0 # half\n : [0, 1];",
        ),
        (
            "define a = 2pi;\nparam r : [-1, 1], [0, a];\npoint p = (r_1, r_2, 0);",
            &[-0.123_456, 6.25],
            "define a = 2pi;\nparam r = (-0.123456, 6.25) : [-1, 1], [0, a];\npoint p = (r_1, r_2, 0);",
        ),
        (
            "param r : [0, 100];",
            &[0.1234],
            "param r = 0.1234 : [0, 100];",
        ),
        (
            "param r : [0, 1e9];",
            &[123_500_000.0],
            "param r = 1.235e8 : [0, 1e9];",
        ),
        (
            "param r : [0, 1000pi];",
            &[std::f64::consts::TAU],
            "param r = 6.283185307179586 : [0, 1000pi];",
        ),
        // The text states this value already.
        (
            "param r = 2pi : [0, 1000pi];",
            &[std::f64::consts::TAU],
            "param r = 2pi : [0, 1000pi];",
        ),
        ("param r : [-1, 1];", &[-1.0], "param r = -1 : [-1, 1];"),
        (
            "define oops = ;\nparam r : [0, 1];",
            &[0.5],
            "define oops = ;\nparam r = 0.5 : [0, 1];",
        ),
    ] {
        if text.contains("oops") {
            let edit = edit_param(&GeotraceAnalysis::new(text), "r", values).expect("an edit");
            assert_eq!(apply(text, &[edit]), expected);
        } else {
            assert_eq!(written(text, "r", values), expected);
        }
    }
}

#[test]
fn what_cannot_be_written_is_refused_with_the_reason() {
    let refusal = |text: &str, param: &str, values: &[f64]| {
        edit_param(&GeotraceAnalysis::new(text), param, values).expect_err("a refusal")
    };
    let text =
        "param r : [0, 1]; grid k : [0, 1, 3]; param q = ; param o = 1 + # one\n 1 : [0, 2];";
    let none = |name: &str| EditParamError::NoParam { name: name.into() };
    assert_eq!(refusal(text, "z", &[0.0]), none("z"));
    assert_eq!(refusal(text, "k", &[0.0]), none("k"));
    assert_eq!(refusal(text, "q", &[0.0]), none("q"));
    assert_eq!(
        refusal(text, "r", &[0.0, 1.0]).to_string(),
        "`r` is one number, but 2 were given"
    );
    assert_eq!(
        refusal(text, "r", &[1.5]).to_string(),
        "`r` = 1.5 lies outside its interval [0, 1]"
    );
    assert!(matches!(
        refusal(text, "r", &[f64::NAN]),
        EditParamError::Set(SetError::OutOfRange { .. })
    ));
    assert!(matches!(
        refusal(text, "o", &[1.0]),
        EditParamError::Comment { .. }
    ));
}

#[test]
fn hover_tells_what_a_param_opens_with() {
    let told = |text: &str| {
        let (_, description) = hover::hover(&GeotraceAnalysis::new(text), 6).expect("a param");
        description.text.join(" ")
    };
    assert_eq!(
        told("param r = 2/4 : [0, 1];"),
        "a slider over `[0, 1]`; it starts at `2/4`"
    );
    assert_eq!(
        told("param r : [0, 1];"),
        "a slider over `[0, 1]`; it starts at its minimum"
    );
    assert_eq!(
        told("param r : [0, 3], [0, 4];"),
        "sliders over `[0, 3]` × `[0, 4]`; they start at their minima"
    );
}
