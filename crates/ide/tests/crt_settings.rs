//! Cameras and numbers written into the settings of scripts.

use ide::Language;
use ide::crt::Crt;
use ide::edit::apply;
use ide::edit_camera::EditCameraError;
use ide::edit_param::EditParamError;
use scene::SetError;

const POSITION: [f64; 3] = [1.0, 2.0 / 3.0, -5.0];
const DIRECTION: [f64; 3] = [0.0, -0.25, 4.0];

fn camera(text: &str) -> Result<String, EditCameraError> {
    let edit = Crt
        .read(text)
        .edit_camera("camera", DIRECTION, POSITION, 0.6)?;
    Ok(apply(text, &[edit]))
}

fn number(text: &str, word: &str, value: f64) -> Result<String, EditParamError> {
    let edit = Crt.read(text).edit_param(word, &[value])?;
    Ok(apply(text, &[edit]))
}

/// The text has no errors, and the camera stands where it was put.
fn expect_camera(text: &str) {
    let analysis = Crt.read(text);
    assert_eq!(
        analysis.diagnostics().len(),
        0,
        "{text}\n{:?}",
        analysis.diagnostics()
    );
    assert!(text.contains("position -> vec3(1, 0.6667, -5)"), "{text}");
    assert!(text.contains("pointing -> vec3(1, 0.4167, -1)"), "{text}");
}

#[test]
fn the_camera_of_the_settings_is_moved_and_keeps_the_rest() {
    for text in [
        "Settings {\n    camera -> Camera {\n        pointing -> vec3(0, 0, 0)  -- here\n        fov -> 40\n        position -> vec3(0, t, -1)\n    }\n}\nScene { }\n",
        "eye = Camera { position -> vec3(0, 0, -1) pointing -> vec3(0, 0, 0) roll -> 3 fov -> 40 }\nSettings { gamma -> 2 camera -> eye }\nScene { }\n",
    ] {
        let moved = camera(text).expect("an edit");
        expect_camera(&moved);
        assert!(moved.contains("fov -> 40"), "{moved}");
        assert_eq!(
            moved.contains("-- here"),
            text.contains("-- here"),
            "{moved}"
        );
        assert_eq!(moved.matches('\n').count(), text.matches('\n').count());
        // Writing it again changes nothing.
        assert_eq!(camera(&moved).expect("an edit"), moved);
    }
}

#[test]
fn a_script_without_a_camera_gets_one() {
    for (text, before) in [
        ("Scene { }\n", "Settings {\n    camera -> Camera {"),
        ("a = 1", "a = 1\nSettings {\n    camera -> Camera {"),
        (
            "-- für später: ü",
            "-- für später: ü\nSettings {\n    camera -> Camera {",
        ),
        (
            "-- first\na = 1\nScene { }\n",
            "-- first\na = 1\nSettings {",
        ),
        (
            "Settings { gamma -> 2 }\nScene { }\n",
            "Settings {\n    camera -> Camera {",
        ),
        (
            "Settings {}\nScene { }\n",
            "Settings {\n    camera -> Camera {",
        ),
    ] {
        let written = camera(text).expect("an edit");
        assert!(written.starts_with(before), "{written}");
        assert!(written.contains("fov -> 60"), "{written}");
        if text.contains("Scene") {
            expect_camera(&written);
        }
    }
}

#[test]
fn a_camera_that_is_computed_is_left_alone() {
    for text in [
        "a = Camera { position -> vec3(0, 0, -1) pointing -> vec3(0, 0, 0) fov -> 40 }\nSettings { camera -> [a][0] }\nScene { }\n",
        "a = Camera { position -> vec3(0, 0, -1) pointing -> vec3(0, 0, 0) fov -> 40 }\na = a\nSettings { camera -> a }\nScene { }\n",
        "Settings { camera -> nothing }\nScene { }\n",
        "Settings { camera -> }\nScene { }\n",
    ] {
        assert_eq!(camera(text), Err(EditCameraError::NotStated), "{text}");
    }
    let comment = "Settings { camera -> Camera { position -> vec3(0, -- up\n 0, -1) pointing -> vec3(0, 0, 0) fov -> 40 } }";
    assert!(matches!(
        camera(comment),
        Err(EditCameraError::Comment { .. })
    ));
    let nowhere = Crt
        .read("Scene { }")
        .edit_camera("camera", [0.0; 3], POSITION, 0.6);
    assert_eq!(nowhere, Err(EditCameraError::NotAPlace));
}

#[test]
fn numbers_have_no_exponents_and_integers_fit() {
    let edit = Crt
        .read("Scene { }")
        .edit_camera("camera", [0.0, 0.0, 3e12], [4e9, 0.0, 1e-9], 0.6);
    let text = apply("Scene { }", &[edit.expect("an edit")]);
    let analysis = Crt.read(&text);
    assert_eq!(
        analysis.diagnostics().len(),
        0,
        "{text}\n{:?}",
        analysis.diagnostics()
    );
}

#[test]
fn a_number_of_the_settings_is_written_in_its_range() {
    let text = "Settings {\n    gamma -> 1.5 -- dark\n    dofsamples -> 4\n}\nScene { }\n";
    let written = number(text, "gamma", 2.2).expect("an edit");
    assert!(
        written.contains("    gamma -> 2.2 -- dark\n    dofsamples -> 4"),
        "{written}"
    );
    let written = number(text, "recursiondepth", 6.0).expect("an edit");
    assert!(
        written.contains("Settings {\n    recursiondepth -> 6\n    gamma"),
        "{written}"
    );
    let written = number("Scene { }", "supersampling", 3.0).expect("an edit");
    assert_eq!(
        written,
        "Settings {\n    supersampling -> 3\n}\n\nScene { }"
    );
    for (word, value) in [
        ("gamma", 0.0),
        ("gamma", f64::NAN),
        ("dofsamples", 1.5),
        ("dofsamples", 0.0),
    ] {
        let refused = number(text, word, value);
        assert!(
            matches!(
                refused,
                Err(EditParamError::Set(SetError::OutOfRange { .. }))
            ),
            "{word} {value}: {refused:?}"
        );
    }
    for word in ["t", "camera", "title", "lights"] {
        assert!(
            matches!(number(text, word, 1.0), Err(EditParamError::NoParam { .. })),
            "{word}"
        );
    }
}
