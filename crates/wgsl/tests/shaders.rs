//! The hand-written shaders: each joins with the stubs of its contract, each painter validates, mistakes are found
//! before a driver sees them and say where they are.

use wgsl::contract::{fulfils, is_exactly, signatures};
use wgsl::join::join;
use wgsl::library::{self, Piece};
use wgsl::painter;

#[test]
fn every_pass_validates_with_the_stubs_of_its_contract() {
    let samples: &[Piece<'static>] = &[library::NUMBER, library::POWER, library::SAMPLING];
    let surface: &[Piece<'static>] = &[
        library::NUMBER,
        library::POWER,
        library::SAMPLING,
        library::JET,
    ];
    for (libraries, contract, pass) in [
        (samples, library::CONTRACT_POINT, library::PASS_SAMPLE_POINT),
        (
            samples,
            library::CONTRACT_VECTOR,
            library::PASS_SAMPLE_VECTOR,
        ),
        (samples, library::CONTRACT_CURVE, library::PASS_SAMPLE_CURVE),
        (
            surface,
            library::CONTRACT_SURFACE,
            library::PASS_SAMPLE_SURFACE,
        ),
        (samples, library::CONTRACT_EVALUATE, library::PASS_EVALUATE),
    ] {
        let mut pieces = libraries.to_vec();
        pieces.extend([contract, pass]);
        let joined =
            join(&pieces).unwrap_or_else(|error| panic!("{}: {}", pass.origin, error.message));
        assert_eq!(joined.entry_points().count(), 1, "{}", pass.origin);
        fulfils(&pass, &library::CONTRACT_UNIFORMS).expect("the pass gives its uniforms");
    }
}

#[test]
fn every_painter_validates() {
    for (name, joined) in [
        ("points", painter::points()),
        ("vectors", painter::vectors()),
        ("curves", painter::curves()),
        ("surfaces", painter::surfaces()),
        ("resolve piecewise", painter::resolve_piecewise()),
        ("trace scene", wgsl::traced::trace_scene("")),
    ] {
        joined.unwrap_or_else(|error| panic!("{name}: {}", error.message));
    }
}

#[test]
fn a_signature_that_differs_from_its_contract_is_an_error_that_keeps_the_text() {
    for text in [
        "fn point_position(instance: u32) -> vec4f { return vec4f(); }",
        "fn point_position(index: u32) -> vec3f { return vec3f(); }",
        "fn point_place(instance: u32) -> vec3f { return vec3f(); }",
        "fn point_position() -> vec3f { return vec3f(); }",
        "",
    ] {
        let error = is_exactly(
            &Piece {
                origin: "generated",
                text,
            },
            &[library::CONTRACT_POINT],
        )
        .unwrap_err();
        assert!(
            error.message.contains("point_position"),
            "{}",
            error.message
        );
        assert_eq!(error.source, text);
    }
}

#[test]
fn generated_text_holds_nothing_but_the_functions_of_its_contract() {
    let good = "fn point_position(instance: u32) -> vec3f { let a = 1.0; return vec3f(a); }";
    is_exactly(
        &Piece {
            origin: "generated",
            text: good,
        },
        &[library::CONTRACT_POINT],
    )
    .expect("as asked for");
    for extra in [
        "const two = 2.0;",
        "fn helper() { }",
        "var<private> x: f32;",
        "struct S { a: f32 }",
    ] {
        let text = format!("{extra}\n{good}");
        let error = is_exactly(
            &Piece {
                origin: "generated",
                text: &text,
            },
            &[library::CONTRACT_POINT],
        );
        assert!(error.is_err(), "{extra}");
    }
}

#[test]
fn signatures_are_read_across_lines_and_comments() {
    let read = signatures(
        "// fn no() {}\nfn f(\n  a: f32, // first\n  b: vec2f,\n) -> bool { if a > 0.0 { } }\nfn g() {}",
    );
    assert_eq!(read.len(), 2);
    assert_eq!(read[0].name, "f");
    assert_eq!(read[0].parameters[1], ("b".to_owned(), "vec2f".to_owned()));
    assert_eq!(read[0].result, "bool");
    assert_eq!(read[1].result, "");
}

#[test]
fn a_mistake_names_the_piece_and_the_line_in_it() {
    let bad = Piece {
        origin: "generated",
        text: "fn f() -> f32 {\n    return 1.0 + missing;\n}\n",
    };
    let error = join(&[library::NUMBER, bad]).unwrap_err();
    assert!(
        error.message.starts_with("generated:2: "),
        "{}",
        error.message
    );
    assert!(error.source.contains("missing"));
    // Parses, but is not valid: no value at the end.
    let invalid = Piece {
        origin: "generated",
        text: "fn f() -> f32 {\n    let a = 1.0;\n}\n",
    };
    let error = join(&[library::NUMBER, invalid]).unwrap_err();
    assert!(error.message.contains("generated:"), "{}", error.message);
}
