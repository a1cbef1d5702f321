//! Views written into the text as cameras.

use ide::edit::apply;
use ide::edit_camera::EditCameraError;
use ide::geotrace::GeotraceAnalysis;
use ide::geotrace::edit_camera::edit_camera;

const DIRECTION: [f64; 3] = [0.0, 1.0, -0.25];
const FOV: f64 = 0.6;
const POSITION: [f64; 3] = [0.0, -3.0, 2.0 / 3.0];

fn written(text: &str, name: &str) -> Result<String, EditCameraError> {
    let edit = edit_camera(&GeotraceAnalysis::new(text), name, DIRECTION, POSITION, FOV)?;
    Ok(apply(text, &[edit]))
}

#[test]
fn the_place_of_a_camera_is_replaced_and_its_attributes_stay() {
    let text = "point p = (0,0,1);\ncamera eye =\n  (p - (0,4,1)) @ (0,-4,1), fov : pi/3; # the first\ncamera b = (0,1,0) @ p;\n";
    assert_eq!(
        written(text, "eye").expect("an edit"),
        "point p = (0,0,1);\ncamera eye =\n  (0, 1, -0.25) @ (0, -3, 0.6667), fov : pi/3; # the first\ncamera b = (0,1,0) @ p;\n"
    );
    let again = written(&written(text, "eye").expect("an edit"), "b").expect("an edit");
    assert!(
        again.ends_with("camera b = (0, 1, -0.25) @ (0, -3, 0.6667);\n"),
        "{again}"
    );
    let compiled = scene::geotrace::compile(&again);
    assert!(compiled.scene.is_some(), "{:?}", compiled.diagnostics);
}

#[test]
fn a_camera_that_is_not_declared_stands_at_the_end() {
    let wanted = "camera eye = (0, 1, -0.25) @ (0, -3, 0.6667), fov : 0.6;\n";
    for (text, before) in [
        ("", ""),
        ("define a = 1;", "define a = 1;\n"),
        ("define a = 1;\n", "define a = 1;\n"),
        ("# für später: ü", "# für später: ü\n"),
    ] {
        assert_eq!(written(text, "eye"), Ok(format!("{before}{wanted}")));
    }
}

#[test]
fn what_cannot_be_written_is_refused_with_a_sentence() {
    let text =
        "point p = (0,0,0); camera faulty = nothing @ p; camera c = (0,1,0) @ # from here\n p;";
    for name in ["p", "pi", "surface", "a b", "", "é"] {
        let name = name.to_owned();
        assert_eq!(
            written(text, &name),
            Err(EditCameraError::NotACamera { name })
        );
    }
    let name = "faulty".to_owned();
    assert_eq!(written(text, &name), Err(EditCameraError::Faulty { name }));
    let name = "c".to_owned();
    let comment = written(text, &name).expect_err("a refusal");
    assert!(comment.to_string().contains("comment"), "{comment}");
    assert_eq!(comment, EditCameraError::Comment { name });
    let analysis = GeotraceAnalysis::new("");
    for (direction, position) in [
        ([0.0; 3], POSITION),
        ([f64::NAN, 1.0, 1.0], POSITION),
        ([f64::MAX; 3], POSITION),
        (DIRECTION, [0.0, f64::INFINITY, 0.0]),
    ] {
        let refused = edit_camera(&analysis, "eye", direction, position, FOV);
        assert_eq!(refused, Err(EditCameraError::NotAPlace));
    }
}

#[test]
fn numbers_have_the_digits_that_the_direction_needs() {
    let analysis = GeotraceAnalysis::new("");
    for (direction, position, wanted) in [
        (
            [0.0, 400.0, -0.004],
            [1e6 + 1.0 / 3.0, -0.0001, 2.0],
            "(0, 400, 0) @ (1000000.33, 0, 2)",
        ),
        (
            [1e-3, 0.0, 0.0],
            [1.0, 0.000_012_34, 0.0],
            "(0.001, 0, 0) @ (1, 0.0000123, 0)",
        ),
        (
            [1e-20, 0.0, 0.0],
            [1.0, 0.0, 3e15],
            "(1e-20, 0e0, 0e0) @ (1e0, 0e0, 3e15)",
        ),
    ] {
        let edit = edit_camera(&analysis, "eye", direction, position, FOV).expect("an edit");
        assert_eq!(edit.text, format!("camera eye = {wanted}, fov : 0.6;\n"));
        let compiled = scene::geotrace::compile(&edit.text);
        assert!(compiled.scene.is_some(), "{:?}", compiled.diagnostics);
    }
}
