//! The requests of windows: declarations to be shown, values to be written, hints.

use serde_json::{Value, json};
use testing::editor::{Editor, Place};
use testing::window::Windows;

use super::{FAKE, PROGRAM, URI, insert, message, previewed, started};

#[tokio::test]
async fn a_declaration_is_shown_where_it_stands_now() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-open", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    let name = PROGRAM.find("s(u").expect("it is there");
    // The text has moved on since the picture was drawn.
    editor.change(URI, 2, insert(0, 0, "# 𝛼 𝛼\n\n")).await;
    editor.change(URI, 3, insert(4, 0, "  ")).await;
    // The first of them may have been passed by.
    while window.receive_of("text").await["version"] != 3 {}
    let open = json!({ "type": "open", "version": 1, "range": [name, name + 1] });
    window.send(open.clone()).await;
    let asked = editor.asked("window/showDocument").await;
    let [start, end] = [10, 11].map(|c| json!({ "line": 4, "character": c }));
    let selection = json!({ "start": start, "end": end });
    assert_eq!(
        asked,
        json!({ "uri": URI, "takeFocus": true, "selection": selection })
    );
    // Of a text that was never sent no place is known.
    window
        .send(json!({ "type": "open", "version": 77, "range": [1, 2] }))
        .await;
    let asked = editor.asked("window/showDocument").await;
    assert_eq!(asked, json!({ "uri": URI, "takeFocus": true }));
    assert_eq!(editor.quit().await, 0);

    // An editor that cannot be asked gets a message.
    let mut editor = Editor::start_with(Place::Here, "preview-plain", Some(&windows.program));
    editor.initialize(json!({})).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.send(open).await;
    let received = message(&mut editor, "line").await;
    assert_eq!(received, "a.gtr, line 3, column 9");
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn values_of_params_are_hints_as_long_as_the_window_is_open() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-values", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    let hints = |answer: &Value| -> Vec<Value> {
        let all = answer.as_array().expect("a list").iter();
        all.filter(|hint| hint["label"].as_str().is_some_and(|l| l.starts_with('=')))
            .cloned()
            .collect()
    };
    let params = json!({
        "textDocument": { "uri": URI },
        "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 9, "character": 0 } },
    });
    // Many values in a short time: the editor is asked to look again, but not each time.
    for k in 0..1_000 {
        let values = json!({ "r": [f64::from(k) / 1_000.0], "gone": [1.0] });
        window
            .send(json!({ "type": "values", "version": 1, "values": values }))
            .await;
    }
    window
        .send(json!({ "type": "message", "error": false, "text": "all said" }))
        .await;
    message(&mut editor, "all said").await;
    editor.asked("workspace/inlayHint/refresh").await;
    let found = hints(&editor.ask("textDocument/inlayHint", params.clone()).await);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["label"], "= 0.999");
    assert_eq!(found[0]["position"], json!({ "line": 1, "character": 16 }));
    let count = |editor: &Editor| {
        let asked = editor
            .received()
            .filter(|m| m["method"] == "workspace/inlayHint/refresh");
        asked.count()
    };
    assert!(count(&editor) < 100, "{}", count(&editor));

    window.send(json!({ "type": "closed" })).await;
    window.exit(0).await;
    // Hints that nothing stands behind any more are taken away.
    loop {
        let found = hints(&editor.ask("textDocument/inlayHint", params.clone()).await);
        if found.is_empty() {
            break;
        }
        editor.asked("workspace/inlayHint/refresh").await;
    }
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_value_that_a_slider_has_found_becomes_one_edit_of_the_text() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-write", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    let write =
        |value: Value| json!({ "type": "write", "version": 1, "param": "r", "value": value });
    // The text has moved on, and the edit is one of the text as it is now.
    editor.change(URI, 2, insert(0, 0, "# 𝛼\n")).await;
    window.receive_of("text").await;
    window.send(write(json!([0.25]))).await;
    let asked = editor.asked("workspace/applyEdit").await;
    let place = json!({ "line": 2, "character": 7 });
    let wanted = json!({
        "label": "Set r",
        "edit": { "documentChanges": [{
            "textDocument": { "uri": URI, "version": 2 },
            "edits": [{ "range": { "start": place, "end": place }, "newText": " = 0.25" }],
        }] },
    });
    assert_eq!(asked, wanted);
    // The editor makes it; the same value again changes nothing.
    editor.change(URI, 3, insert(2, 7, " = 0.25")).await;
    window.receive_of("text").await;
    window.send(write(json!([0.25]))).await;
    window.send(write(json!([0.5]))).await;
    let asked = editor.asked("workspace/applyEdit").await;
    let edit = &asked["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(edit["newText"], "0.5");

    // What is refused is reported: by the editor, …
    editor.applied = json!({ "applied": false, "failureReason": "it is read-only" });
    window.send(write(json!([0.75]))).await;
    let received = message(&mut editor, "`r` was not written").await;
    assert!(received.contains("a.gtr: it is read-only"), "{received}");
    // … or by the language.
    window.send(write(json!([7.0]))).await;
    message(&mut editor, "`r` was not written").await;
    window
        .send(json!({ "type": "write", "version": 1, "param": "s", "value": [1.0] }))
        .await;
    message(&mut editor, "`s` was not written").await;
    assert_eq!(editor.quit().await, 0);

    // An editor that does not accept edits is not asked.
    let mut editor = Editor::start_with(Place::Here, "preview-no-edits", Some(&windows.program));
    editor.initialize(json!({})).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.send(write(json!([0.25]))).await;
    message(&mut editor, "does not accept edits").await;
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_view_that_is_written_becomes_one_edit_of_a_camera() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-camera", &windows).await;
    let program = "camera eye = (0,1,0) @ (0,-4,1), roll : 0.1;\n";
    let mut window = previewed(&mut editor, &windows, URI, program).await;
    let write = |name: &str, direction: Value| {
        json!({
            "type": "writeCamera",
            "version": 1,
            "name": name,
            "direction": direction,
            "position": [0.5, -3.0, 1.0 / 3.0],
            "fov": 0.6,
        })
    };
    window.send(write("eye", json!([0, 1, 0]))).await;
    let asked = editor.asked("workspace/applyEdit").await;
    assert_eq!(asked["label"], "Write camera");
    let edit = &asked["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(edit["newText"], "(0, 1, 0) @ (0.5, -3, 0.3333)");
    let start = json!({ "line": 0, "character": 13 });
    assert_eq!(edit["range"]["start"], start);
    assert_eq!(edit["range"]["end"]["character"], 31);
    // What no camera can be is reported.
    window.send(write("eye", json!([0, 0, 0]))).await;
    message(&mut editor, "not zero").await;
    window.send(write("pi", json!([0, 1, 0]))).await;
    message(&mut editor, "`pi` is not available").await;
    assert_eq!(editor.quit().await, 0);
}
