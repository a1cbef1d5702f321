//! The language server and its preview windows, which the tests play: what they are told, and what becomes of what they
//! say. The window itself is tested where it is made, and with real editors.

use std::time::Duration;

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};
use testing::window::{Window, Windows, kill};

const FAKE: &str = env!("CARGO_BIN_EXE_fake-window");
const URI: &str = "file:///a%20folder/a.gtr";
const OTHER: &str = "file:///other/b.gtr";
const PROGRAM: &str = "# 𝛼\nparam r : [0, 1];\nsurface s(u,v) = (u,v,r), u : [0,1], v : [0,1];\n";

/// What VS Code offers, as far as previews use it.
fn capabilities() -> Value {
    json!({
        "workspace": {
            "applyEdit": true,
            "configuration": true,
            "workspaceEdit": { "documentChanges": true },
            "inlayHint": { "refreshSupport": true },
        },
        "window": { "showDocument": { "support": true } },
        "experimental": { "geotrace": { "shown": true } },
    })
}

fn at(uri: &str, line: u32, character: u32) -> Value {
    json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": character } })
}

fn insert(line: u32, character: u32, text: &str) -> Value {
    let place = json!({ "line": line, "character": character });
    json!([{ "range": { "start": place, "end": place }, "text": text }])
}

async fn started(place: Place, name: &str, windows: &Windows) -> Editor {
    let mut editor = Editor::start_with(place, name, Some(&windows.program));
    editor.initialize(capabilities()).await;
    editor
}

async fn command(editor: &mut Editor, uri: &str, view: Value) {
    let arguments = match view {
        Value::Null => json!([uri]),
        view => json!([uri, view]),
    };
    let params = json!({ "command": "geotrace.preview", "arguments": arguments });
    let answer = editor.ask("workspace/executeCommand", params).await;
    assert_eq!(answer, Value::Null);
}

async fn close(editor: &mut Editor, uri: &str) {
    let params = json!({ "textDocument": { "uri": uri } });
    editor.tell("textDocument/didClose", params).await;
}

/// Opens a document and its preview, which has shaken hands and read the text.
async fn previewed(editor: &mut Editor, windows: &Windows, uri: &str, text: &str) -> Window {
    editor.open(uri, text).await;
    command(editor, uri, Value::Null).await;
    let mut window = windows.next().await;
    window.greet().await;
    let told = window.hear_of("text").await;
    assert_eq!((&told["uri"], &told["text"]), (&json!(uri), &json!(text)));
    window
}

async fn message(editor: &mut Editor, part: &str) -> String {
    let has = |p: &Value| p["message"].as_str().is_some_and(|m| m.contains(part));
    let told = editor.notified("window/showMessage", has).await;
    told["message"].as_str().expect("a sentence").to_owned()
}

fn messages(editor: &Editor) -> Vec<&Value> {
    let shown = editor
        .heard()
        .filter(|m| m["method"] == "window/showMessage");
    shown.map(|m| &m["params"]["message"]).collect()
}

#[tokio::test]
async fn a_window_is_told_the_text_and_every_edit() {
    for place in PLACES {
        let windows = Windows::new(FAKE, false).await;
        let mut editor = started(place, "preview-texts", &windows).await;
        editor.open(URI, PROGRAM).await;
        let view = json!({ "view": "geodesic", "surface": "s" });
        command(&mut editor, URI, view).await;
        let mut window = windows.next().await;
        window.greet().await;
        let told = window.hear().await.expect("the text");
        let wanted = json!({
            "type": "text", "uri": URI, "path": "/a folder/a.gtr", "version": 1, "text": PROGRAM,
        });
        assert_eq!(told, wanted);
        let told = window.hear().await.expect("the view");
        let wanted = json!({ "type": "show", "view": { "view": "geodesic", "surface": "s" } });
        assert_eq!(told, wanted);

        editor.change(URI, 2, insert(1, 15, ".5")).await;
        let told = window.hear().await.expect("the text");
        let wanted = PROGRAM.replacen("1]", "1.5]", 1);
        assert_eq!(
            (&told["version"], &told["text"]),
            (&json!(2), &json!(wanted))
        );
        // The whole text at once, as simple editors send it.
        editor.change(URI, 3, json!([{ "text": "#" }])).await;
        assert_eq!(window.hear().await.expect("the text")["text"], "#");

        // The same command again brings the window to the front, and no other opens.
        command(&mut editor, URI, json!({ "view": "3d" })).await;
        let told = window.hear().await.expect("the view");
        assert_eq!(told, json!({ "type": "show", "view": { "view": "3d" } }));
        command(&mut editor, URI, Value::Null).await;
        let told = window.hear().await.expect("the view");
        assert_eq!(told, json!({ "type": "show", "view": null }));
        assert!(!windows.is_any().await);

        // What is shown is told to an editor that wants to hear it.
        window
            .say(json!({ "type": "shown", "version": 3, "ok": true, "milliseconds": 1.5, "painting": 2.5 }))
            .await;
        let told = editor.notified("geotrace/shown", |_| true).await;
        let wanted =
            json!({ "uri": URI, "version": 3, "ok": true, "milliseconds": 1.5, "painting": 2.5 });
        assert_eq!(told, wanted);

        // With its document the window closes.
        close(&mut editor, URI).await;
        assert_eq!(window.hear().await, Some(json!({ "type": "close" })));
        assert_eq!(window.hear().await, None);
        window.exit(0).await;
        assert_eq!(messages(&editor), Vec::<&Value>::new());
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn a_document_that_is_read_anew_keeps_its_window_whatever_its_versions_are() {
    let mut windows = Windows::new(FAKE, false).await;
    // As long as any test lasts: only what calls the end off keeps the window.
    windows.program.lingers = Duration::from_secs(3600);
    let mut editor = started(Place::Here, "preview-reread", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    editor
        .change(URI, 7, json!([{ "text": "point p = (1, 2, 3);" }]))
        .await;
    assert_eq!(window.hear_of("text").await["version"], 7);
    let shown = |version: i64| json!({ "type": "shown", "version": version, "ok": true, "milliseconds": 1.0, "painting": 0.0 });
    // The same document with another text, whose version is lower, and then the same.
    for (text, number) in [("#new", 8), ("#newer", 9)] {
        close(&mut editor, URI).await;
        editor.open(URI, text).await;
        let told = window.hear().await.expect("the text");
        assert_eq!(
            (&told["type"], &told["text"]),
            (&json!("text"), &json!(text))
        );
        assert_eq!(told["version"], number, "it is later than all before");
    }
    // What the window shows is the version that the editor knows, or of a text that it knows no more.
    for number in [7, 8, 9] {
        window.say(shown(number)).await;
    }
    let told = editor.notified("geotrace/shown", |_| true).await;
    assert_eq!(told["version"], 1);
    // Cursors and places are those of the text that is meant.
    editor.tell("geotrace/cursor", at(URI, 0, 2)).await;
    let told = window.hear_of("cursor").await;
    assert_eq!((&told["version"], &told["offset"]), (&json!(9), &json!(2)));
    editor.change(URI, 2, insert(0, 0, "#\n")).await;
    assert_eq!(window.hear_of("text").await["version"], 10);
    window
        .say(json!({ "type": "open", "version": 9, "range": [1, 6] }))
        .await;
    let asked = editor.asked("window/showDocument").await;
    let [start, end] = [1, 6].map(|c| json!({ "line": 1, "character": c }));
    assert_eq!(asked["selection"], json!({ "start": start, "end": end }));
    assert_eq!(
        editor
            .heard()
            .filter(|m| m["method"] == "geotrace/shown")
            .count(),
        1
    );
    // One that has been closed for now is closed when the editor leaves.
    close(&mut editor, URI).await;
    assert_eq!(editor.quit().await, 0);
    assert_eq!(window.hear_of("close").await, json!({ "type": "close" }));
}

#[tokio::test]
async fn a_document_that_is_read_anew_brings_no_window_to_the_front() {
    let mut windows = Windows::new(FAKE, false).await;
    windows.program.lingers = Duration::from_secs(3600);
    let mut editor = Editor::start_with(
        Place::Here,
        "preview-reread-on-open",
        Some(&windows.program),
    );
    let mut params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities() });
    params["initializationOptions"] = json!({ "preview": { "open": "onOpen" } });
    editor.initialize_with(params).await;
    editor.open(URI, PROGRAM).await;
    let mut window = windows.next().await;
    window.greet().await;
    assert_eq!(window.hear_of("text").await["version"], 1);
    close(&mut editor, URI).await;
    editor.open(URI, "#new").await;
    editor.change(URI, 2, insert(0, 0, "#")).await;
    let mut heard = vec![window.hear().await.expect("a text")];
    while heard.last().is_some_and(|told| told["text"] != "##new") {
        heard.push(window.hear().await.expect("a text"));
    }
    assert!(heard.iter().all(|told| told["type"] == "text"), "{heard:?}");
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_knows_where_the_cursor_stood_before_it_was_opened() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-cursor-before", &windows).await;
    editor.open(URI, PROGRAM).await;
    editor.tell("geotrace/cursor", at(URI, 2, 8)).await;
    // It stands in the same line and column of the text as it is then.
    editor.change(URI, 2, insert(0, 2, "𝛼𝛼")).await;
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.greet().await;
    let told = window.hear_of("text").await;
    let offset = told["text"].as_str().and_then(|text| text.find("s(u"));
    let wanted = json!({ "type": "cursor", "version": 2, "offset": offset });
    assert_eq!(window.hear().await, Some(wanted.clone()));
    // And once more when the window has read the text.
    window
        .say(json!({ "type": "shown", "version": 2, "ok": true, "milliseconds": 1.0, "painting": 0.0 }))
        .await;
    assert_eq!(window.hear().await, Some(wanted));
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn the_cursor_is_a_place_in_the_bytes_of_the_text() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-cursor", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, "# 𝛼\ndefine a = 1; # é 𝛼 x").await;
    // By the request that editors make where the cursor stands, …
    editor
        .ask("textDocument/documentHighlight", at(URI, 1, 7))
        .await;
    let told = window.hear().await.expect("the cursor");
    assert_eq!(
        told,
        json!({ "type": "cursor", "version": 1, "offset": 14 })
    );
    // … by the notification, in the encoding that was agreed (UTF-16 here), …
    editor.tell("geotrace/cursor", at(URI, 1, 21)).await;
    let told = window.hear().await.expect("the cursor");
    assert_eq!(told["offset"], 7 + 16 + 2 + 1 + 4 + 1);
    // … and not again where it has not moved.
    editor.tell("geotrace/cursor", at(URI, 1, 21)).await;
    editor.tell("geotrace/cursor", at(OTHER, 0, 0)).await;
    assert!(window.hears_nothing().await);
    // The window may have compiled the text only now: it is told once more.
    window
        .say(json!({ "type": "shown", "version": 1, "ok": true, "milliseconds": 1.0, "painting": 0.0 }))
        .await;
    let told = window.hear().await.expect("the cursor");
    assert_eq!(
        told,
        json!({ "type": "cursor", "version": 1, "offset": 31 })
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn of_many_edits_a_window_that_does_not_read_is_told_the_last() {
    const EDITS: i64 = 2_000;
    for place in PLACES {
        let windows = Windows::new(FAKE, true).await;
        let mut editor = started(place, "preview-deaf", &windows).await;
        // Longer than what a pipe takes: nothing of it is read for now.
        let text = format!("{}define a = 1;", "# filling\n".repeat(20_000));
        editor.open(URI, &text).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet_as(1).await;
        for version in 2..=EDITS {
            editor.change(URI, version, insert(0, 2, "x")).await;
        }
        // The server goes on as if nothing were wrong.
        let hover = editor.ask("textDocument/hover", at(URI, 20_000, 7)).await;
        assert!(!hover.is_null());
        if let Some(process) = editor.process() {
            let status = std::fs::read_to_string(format!("/proc/{process}/status"));
            let most = testing::binary::high_water_mark(&status.expect("it lives"));
            assert!(most < 300 << 20, "{most} bytes for {EDITS} texts of 200 kB");
        }
        window.listen().await;
        let mut versions = Vec::new();
        while versions.last() != Some(&EDITS) {
            let told = window.hear_of("text").await;
            versions.push(told["version"].as_i64().expect("a number"));
        }
        assert!(versions.len() <= 3, "{versions:?}");
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn no_message_goes_to_another_window_or_another_editor() {
    let windows = Windows::new(FAKE, false).await;
    let mut one = started(Place::Here, "preview-first", &windows).await;
    let mut two = started(Place::Binary, "preview-second", &windows).await;
    let mut of_one = previewed(&mut one, &windows, URI, "define a = 1;").await;
    let mut other_of_one = previewed(&mut one, &windows, OTHER, "define b = 1;").await;
    // The second editor has the first document open, too.
    let mut of_two = previewed(&mut two, &windows, URI, "define c = 1;").await;

    one.change(URI, 2, insert(0, 0, "#a\n")).await;
    assert_eq!(of_one.hear_of("text").await["text"], "#a\ndefine a = 1;");
    assert!(other_of_one.hears_nothing().await);
    assert!(of_two.hears_nothing().await);
    one.change(OTHER, 2, insert(0, 0, "#b\n")).await;
    let told = other_of_one.hear_of("text").await;
    assert_eq!(
        (&told["uri"], &told["text"]),
        (&json!(OTHER), &json!("#b\ndefine b = 1;"))
    );
    two.change(URI, 2, insert(0, 0, "#c\n")).await;
    assert_eq!(of_two.hear_of("text").await["text"], "#c\ndefine c = 1;");
    assert!(of_one.hears_nothing().await);

    // What they say arrives where they belong.
    let open = json!({ "type": "open", "version": 2, "range": [10, 11] });
    other_of_one.say(open.clone()).await;
    let asked = one.asked("window/showDocument").await;
    assert_eq!(asked["uri"], OTHER);
    of_two.say(open).await;
    assert_eq!(two.asked("window/showDocument").await["uri"], URI);
    let values = json!({ "type": "values", "version": 2, "values": { "b": [1.0] } });
    other_of_one.say(values).await;
    one.asked("workspace/inlayHint/refresh").await;

    // One window's end is not the others'.
    of_one.kill().await;
    message(&mut one, "a.gtr").await;
    one.change(OTHER, 3, insert(0, 0, "#")).await;
    assert_eq!(other_of_one.hear_of("text").await["version"], 3);
    two.change(URI, 3, insert(0, 0, "#")).await;
    assert_eq!(of_two.hear_of("text").await["version"], 3);
    assert_eq!(one.quit().await, 0);
    assert_eq!(other_of_one.hear().await, Some(json!({ "type": "close" })));
    assert!(of_two.hears_nothing().await);
    assert_eq!(two.quit().await, 0);
    assert_eq!(of_two.hear().await, Some(json!({ "type": "close" })));
}

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
    while window.hear_of("text").await["version"] != 3 {}
    let open = json!({ "type": "open", "version": 1, "range": [name, name + 1] });
    window.say(open.clone()).await;
    let asked = editor.asked("window/showDocument").await;
    let [start, end] = [10, 11].map(|c| json!({ "line": 4, "character": c }));
    let selection = json!({ "start": start, "end": end });
    assert_eq!(
        asked,
        json!({ "uri": URI, "takeFocus": true, "selection": selection })
    );
    // Of a text that was never sent no place is known.
    window
        .say(json!({ "type": "open", "version": 77, "range": [1, 2] }))
        .await;
    let asked = editor.asked("window/showDocument").await;
    assert_eq!(asked, json!({ "uri": URI, "takeFocus": true }));
    assert_eq!(editor.quit().await, 0);

    // An editor that cannot be asked is told.
    let mut editor = Editor::start_with(Place::Here, "preview-plain", Some(&windows.program));
    editor.initialize(json!({})).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.say(open).await;
    let told = message(&mut editor, "line").await;
    assert_eq!(told, "a.gtr, line 3, column 9");
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
            .say(json!({ "type": "values", "version": 1, "values": values }))
            .await;
    }
    window
        .say(json!({ "type": "message", "error": false, "text": "all said" }))
        .await;
    message(&mut editor, "all said").await;
    editor.asked("workspace/inlayHint/refresh").await;
    let found = hints(&editor.ask("textDocument/inlayHint", params.clone()).await);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0]["label"], "= 0.999");
    assert_eq!(found[0]["position"], json!({ "line": 1, "character": 16 }));
    let count = |editor: &Editor| {
        let asked = editor
            .heard()
            .filter(|m| m["method"] == "workspace/inlayHint/refresh");
        asked.count()
    };
    assert!(count(&editor) < 100, "{}", count(&editor));

    window.say(json!({ "type": "closed" })).await;
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
    window.hear_of("text").await;
    window.say(write(json!([0.25]))).await;
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
    window.hear_of("text").await;
    window.say(write(json!([0.25]))).await;
    window.say(write(json!([0.5]))).await;
    let asked = editor.asked("workspace/applyEdit").await;
    let edit = &asked["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(edit["newText"], "0.5");

    // What is refused is told: by the editor, …
    editor.applied = json!({ "applied": false, "failureReason": "it is read-only" });
    window.say(write(json!([0.75]))).await;
    let told = message(&mut editor, "`r` was not written").await;
    assert!(told.contains("a.gtr: it is read-only"), "{told}");
    // … or by the language.
    window.say(write(json!([7.0]))).await;
    message(&mut editor, "`r` was not written").await;
    window
        .say(json!({ "type": "write", "version": 1, "param": "s", "value": [1.0] }))
        .await;
    message(&mut editor, "`s` was not written").await;
    assert_eq!(editor.quit().await, 0);

    // An editor that takes no edits is not asked.
    let mut editor = Editor::start_with(Place::Here, "preview-no-edits", Some(&windows.program));
    editor.initialize(json!({})).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.say(write(json!([0.25]))).await;
    message(&mut editor, "takes no edits").await;
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_that_was_closed_opens_anew_without_a_word() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-closed", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.say(json!({ "type": "closed" })).await;
    // The process may take its time to end: the command does not wait for it.
    window
        .say(json!({ "type": "message", "error": false, "text": "bye" }))
        .await;
    message(&mut editor, "bye").await;
    command(&mut editor, URI, Value::Null).await;
    let mut next = windows.next().await;
    assert_ne!(next.pid, window.pid);
    next.greet().await;
    assert_eq!(next.hear_of("text").await["version"], 1);
    window.exit(3).await;
    editor.change(URI, 2, insert(0, 0, "#")).await;
    assert_eq!(next.hear_of("text").await["version"], 2);
    assert_eq!(messages(&editor), ["bye"]);
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_that_dies_is_told_of_once_and_the_command_restarts_it() {
    for place in PLACES {
        let windows = Windows::new(FAKE, false).await;
        let mut editor = started(place, "preview-killed", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        window.complain("the driver says goodbye").await;
        let told = editor.notified("window/logMessage", |_| true).await;
        assert_eq!(told["message"], "preview of a.gtr: the driver says goodbye");
        window.kill().await;
        let told = message(&mut editor, "ended").await;
        for part in ["a.gtr", "signal: 9", "the driver says goodbye"] {
            assert!(told.contains(part), "{told}");
        }
        editor.change(URI, 2, insert(0, 0, "#")).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet().await;
        assert_eq!(window.hear_of("text").await["version"], 2);

        // The command does not wait until the death has been told.
        kill(window.pid);
        window.ended().await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet().await;
        assert_eq!(window.hear_of("text").await["version"], 2);

        // One that says why it ends is repeated: here, that there is no display.
        window.complain("error: there is no display").await;
        window.complain("  help: draw with `geotrace render`").await;
        editor
            .notified("window/logMessage", |p| {
                p["message"].as_str().is_some_and(|m| m.contains("help"))
            })
            .await;
        window.exit(1).await;
        let told = message(&mut editor, "exit status: 1").await;
        assert!(told.contains("error: there is no display. "), "{told}");
        // The second death may have been told as well, or not: the command has answered it.
        assert!((2..=3).contains(&messages(&editor).len()));
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn a_window_of_another_version_is_refused_with_a_sentence() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-version", &windows).await;
    editor.open(URI, PROGRAM).await;
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.greet_as(99).await;
    let told = message(&mut editor, "version").await;
    assert!(
        told.contains("version 99") && told.contains("version 1"),
        "{told}"
    );
    window.ended().await;

    // One that begins with something else is none.
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.say(json!({ "type": "closed" })).await;
    message(&mut editor, "did not say its version").await;
    window.ended().await;
    assert_eq!(messages(&editor).len(), 2);

    // Noise before the greeting, and behind it, is only logged.
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.say_line("WARNING: a driver is talking").await;
    window.greet().await;
    window.say_line("{\"type\":\"unheard of\"}").await;
    window.say_line("{\"type\":\"shown\"").await;
    window
        .say(json!({ "type": "message", "error": true, "text": "here I am" }))
        .await;
    message(&mut editor, "here I am").await;
    for part in ["a driver is talking", "unheard of", "no message"] {
        let logged = editor
            .heard()
            .any(|m| m["method"] == "window/logMessage" && m.to_string().contains(part));
        assert!(logged, "{part}");
    }
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_that_says_nothing_is_ended() {
    let mut windows = Windows::new(FAKE, false).await;
    windows.program.patience = Duration::from_millis(300);
    let mut editor = started(Place::Here, "preview-silent", &windows).await;
    editor.open(URI, PROGRAM).await;
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    let told = message(&mut editor, "has not answered").await;
    assert!(told.contains("0.3 seconds"), "{told}");
    window.ended().await;
    // One that ends before it says anything may not do so silently, whatever its status.
    command(&mut editor, URI, Value::Null).await;
    windows.next().await.exit(0).await;
    message(&mut editor, "exit status: 0").await;
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn what_cannot_be_started_is_told() {
    let mut windows = Windows::new("/no/such/window", false).await;
    windows.program.arguments.clear();
    let mut editor = started(Place::Here, "preview-missing", &windows).await;
    editor.open(URI, PROGRAM).await;
    command(&mut editor, URI, Value::Null).await;
    message(&mut editor, "/no/such/window").await;
    command(&mut editor, OTHER, Value::Null).await;
    message(&mut editor, "open b.gtr first").await;
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_server_that_is_killed_leaves_its_windows_and_one_whose_editor_goes_closes_them() {
    let windows = Windows::new(FAKE, false).await;
    // Killed: the window's input ends without a farewell, and the window lives on.
    let mut editor = started(Place::Binary, "preview-server-killed", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    kill(editor.process().expect("a process"));
    assert_eq!(window.hear().await, None);
    window.exit(0).await;
    // An editor that has gone without a word needs no picture of its text: its input ends, …
    for place in PLACES {
        let mut editor = started(place, "preview-hung-up", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        assert_eq!(editor.hang_up().await, 1);
        assert_eq!(
            window.hear().await,
            Some(json!({ "type": "close" })),
            "{place:?}"
        );
        window.exit(0).await;
    }
    // … it says `exit` and no farewell, …
    let mut editor = started(Place::Binary, "preview-exit", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    editor.tell("exit", Value::Null).await;
    assert_eq!(editor.end().await, 1);
    assert_eq!(window.hear().await, Some(json!({ "type": "close" })));
    window.exit(0).await;
    // … or it is dead, though its end of the pipe stays open.
    let mut parent = std::process::Command::new("sleep");
    let mut parent = parent.arg("600").spawn().expect("a process");
    let mut editor = Editor::start_with(Place::Binary, "preview-orphan", Some(&windows.program));
    let params =
        json!({ "processId": parent.id(), "rootUri": null, "capabilities": capabilities() });
    editor.initialize_with(params).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    parent.kill().expect("it can be ended");
    parent.wait().expect("it has ended");
    assert_eq!(window.hear().await, Some(json!({ "type": "close" })));
    assert_eq!(editor.end().await, 1);
    window.exit(0).await;
    // A goodbye: it is told, though its input is full of texts.
    for place in PLACES {
        let mut editor = started(place, "preview-goodbye", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        for version in 2..100 {
            editor.change(URI, version, insert(0, 0, "#")).await;
        }
        assert_eq!(editor.quit().await, 0);
        window.hear_of("close").await;
        assert_eq!(window.hear().await, None);
        window.exit(0).await;
    }
    // One that does not listen is ended.
    let windows = Windows::new(FAKE, true).await;
    for says_goodbye in [true, false] {
        let name = format!("preview-deaf-goodbye-{says_goodbye}");
        let mut editor = started(Place::Binary, &name, &windows).await;
        editor.open(URI, &"# filling\n".repeat(20_000)).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet_as(1).await;
        if says_goodbye {
            assert_eq!(editor.quit().await, 0);
        } else {
            assert_eq!(editor.hang_up().await, 1);
        }
        window.ended().await;
    }
}

#[tokio::test]
async fn a_setting_opens_the_preview_with_each_document() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = Editor::start_with(Place::Here, "preview-on-open", Some(&windows.program));
    let mut params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities() });
    params["initializationOptions"] = json!({ "preview": { "open": "onOpen" } });
    editor.initialize_with(params).await;
    editor.open(URI, PROGRAM).await;
    let mut window = windows.next().await;
    window.greet().await;
    assert_eq!(window.hear_of("text").await["uri"], URI);
    // Not for what an editor shows beside it, such as an older version.
    editor.open("git:/other/b.gtr", PROGRAM).await;
    assert!(!windows.is_any().await);
    assert_eq!(editor.quit().await, 0);

    // Settings that come later open the preview of what is open.
    let mut editor = Editor::start_with(Place::Here, "preview-later", Some(&windows.program));
    editor.initialize(json!({})).await;
    editor.open(URI, PROGRAM).await;
    let settings = json!({ "settings": { "geotrace": { "preview": { "open": "onOpen" } } } });
    editor
        .tell("workspace/didChangeConfiguration", settings)
        .await;
    let mut window = windows.next().await;
    window.greet().await;
    assert_eq!(editor.quit().await, 0);
}
