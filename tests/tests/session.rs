//! How a session with the language server goes, whatever is asked: load, faults, life and death.

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};
use testing::talk::{URI, at, document, range, started};

/// A program of many declarations, each using the one before.
fn long_program(count: usize) -> String {
    let mut text = String::from("define a0 = 1;\n");
    for k in 1..count {
        text.push_str(&format!("define a{k} = a{} + {k};\n", k - 1));
    }
    text
}

#[tokio::test]
async fn cancelled_requests_are_answered_at_once_and_the_others_too() {
    for place in PLACES {
        let mut editor = started(place, "cancellation").await;
        editor.open(URI, &long_program(1000)).await;
        let params = json!({ "textDocument": document() });
        let mut ids = Vec::new();
        for k in 0..120_u32 {
            // Every change makes the requests behind it read the text anew.
            let change = json!([{ "range": range([k, 0], [k, 0]), "text": " " }]);
            editor.change(URI, i64::from(k) + 2, change).await;
            let id = editor
                .post("textDocument/documentSymbol", params.clone())
                .await;
            if k % 2 == 0 {
                editor.notify("$/cancelRequest", json!({ "id": id })).await;
            }
            ids.push(id);
        }
        let mut cancelled = 0;
        for (k, id) in ids.into_iter().enumerate() {
            match editor.answer(id).await {
                Ok(symbols) => assert_eq!(symbols.as_array().map(Vec::len), Some(1000)),
                Err(error) => {
                    assert_eq!(error["code"], -32800, "{error}");
                    assert_eq!(k % 2, 0, "only what was cancelled is");
                    cancelled += 1;
                }
            }
        }
        assert!(
            cancelled > 20,
            "{cancelled} of 60 cancellations were honoured"
        );
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn a_burst_of_ten_thousand_messages_ends_in_the_last_state() {
    for place in PLACES {
        let mut editor = started(place, "burst").await;
        editor.open(URI, "define a = 1;\n").await;
        for k in 0..10_000_i64 {
            let text = if k % 2 == 0 { "define b = sinn 1;" } else { "" };
            let end = if k % 2 == 0 { 0 } else { 18 };
            let change = json!([{ "range": range([1, 0], [1, end]), "text": text }]);
            editor.change(URI, k + 2, change).await;
        }
        let found = editor.diagnostics(URI, 10_001).await;
        assert_eq!(found, Vec::<Value>::new());
        // Versions only grow, and most were never worked on.
        let versions: Vec<i64> = editor
            .received()
            .filter(|m| m["method"] == "textDocument/publishDiagnostics")
            .filter_map(|m| m["params"]["version"].as_i64())
            .collect();
        assert!(versions.is_sorted(), "{versions:?}");
        let hover = editor.ask("textDocument/hover", at(0, 7)).await;
        assert!(
            hover["contents"]["value"]
                .as_str()
                .is_some_and(|t| t.contains("= 1"))
        );
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn a_script_runs_beside_the_edits_and_a_newer_edit_ends_the_run() {
    const SCRIPT: &str = "file:///w/a.crt";
    let looping = "i = 0\nwhile (i < 900000) { i = i + 1 }\n1\nScene { }\n";
    for place in PLACES {
        let mut editor = started(place, "script").await;
        let found = |params: &Value| -> Vec<String> {
            let all = params["diagnostics"].as_array().expect("a list").iter();
            all.map(|it| it["code"].as_str().unwrap_or_default().to_owned())
                .collect()
        };
        // What reading finds comes first, what running finds behind it.
        let text = "a = 1\n- 2\n1\nScene { }\n";
        editor.open(SCRIPT, text).await;
        let of = |version: i64| move |p: &Value| p["uri"] == SCRIPT && p["version"] == version;
        const PUBLISH: &str = "textDocument/publishDiagnostics";
        let reading = editor.notified(PUBLISH, of(1)).await;
        assert_eq!(found(&reading), ["continues-line"]);
        let running = editor.notified(PUBLISH, of(1)).await;
        assert_eq!(found(&running), ["continues-line", "no-effect"]);
        // Ten runs that take long are given up, and only the last one has a second answer.
        for version in 2..12 {
            let change = json!([{ "text": looping }]);
            editor.change(SCRIPT, version, change).await;
        }
        let change = json!([{ "range": range([0, 0], [0, 0]), "text": "2\n" }]);
        editor.change(SCRIPT, 12, change).await;
        let last = |p: &Value| p["version"] == 12 && p["diagnostics"] != json!([]);
        let last = editor.notified(PUBLISH, last).await;
        assert_eq!(found(&last), ["no-effect", "no-effect"]);
        let early = editor.received().filter(|m| {
            let version = m["params"]["version"].as_i64();
            let is_early = version.is_some_and(|it| (2..12).contains(&it));
            is_early && m["params"]["diagnostics"] != json!([])
        });
        assert!(early.count() <= 1, "a run was not given up");
        // The values of the run stand in a hover.
        let place =
            json!({ "textDocument": { "uri": SCRIPT }, "position": { "line": 1, "character": 0 } });
        let hover = editor.ask("textDocument/hover", place).await;
        let text = hover["contents"]["value"].as_str().unwrap_or_default();
        assert!(text.contains("`900000`, an Integer"), "{text}");
        // An editor that asks is answered when the run has ended.
        let which = json!({ "textDocument": { "uri": SCRIPT } });
        editor
            .change(SCRIPT, 13, json!([{ "text": text_with_link() }]))
            .await;
        let report = editor.ask("textDocument/diagnostic", which.clone()).await;
        assert_eq!(report["items"][0]["code"], "no-effect");
        let links = editor.ask("textDocument/documentLink", which).await;
        assert_eq!(links[0]["target"], "file:///w/sky/noon.png");
        assert_eq!(editor.quit().await, 0);
    }
}

/// A script with an image, and one statement without an effect.
fn text_with_link() -> &'static str {
    "b = Background { image -> \"sky/noon.png\" }\n1\nScene { }\n"
}

#[tokio::test]
async fn what_is_no_message_is_answered_and_the_next_message_is_read() {
    for place in PLACES {
        let mut editor = started(place, "malformed").await;
        for bytes in [
            &b"Content-Length: 9\r\n\r\n{\"jsonrpc"[..],
            b"Content-Length: 3\r\n\r\n{\"jsonrpc\":\"2.0\"}",
            b"Content-Length: x\r\n\r\n{}",
            b"Content-Length: 2\r\n\r\n\xFF\xFE",
        ] {
            editor.send_raw(bytes).await;
            let error = editor.answer_to_nothing().await;
            assert_eq!(error["code"], -32700, "{error}");
        }
        // Valid JSON that is no request.
        editor.send_raw(b"Content-Length: 2\r\n\r\n[]").await;
        assert_eq!(editor.answer_to_nothing().await["code"], -32600);
        editor.open(URI, "define a = 1;").await;
        assert_eq!(editor.diagnostics(URI, 1).await.len(), 0);
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn unknown_methods_and_wrong_params_are_errors_of_their_own() {
    let mut editor = started(Place::Here, "unknown").await;
    let error = editor.fail("geotrace/no-such-method", json!({})).await;
    assert_eq!(error["code"], -32601);
    let error = editor.fail("$/no-such-method", json!({})).await;
    assert_eq!(error["code"], -32601);
    editor
        .notify("geotrace/no-such-notification", json!({}))
        .await;
    editor.notify("$/no-such-notification", json!({})).await;
    let error = editor
        .fail("textDocument/hover", json!({ "textDocument": 7 }))
        .await;
    assert_eq!(error["code"], -32602);
    let error = editor.fail("textDocument/hover", at(0, 0)).await;
    assert!(
        error["message"]
            .as_str()
            .is_some_and(|m| m.contains("not open")),
        "{error}"
    );
    let params = json!({ "command": "geotrace.other", "arguments": [] });
    assert_eq!(
        editor.fail("workspace/executeCommand", params).await["code"],
        -32602
    );
    let params = json!({ "command": "geotrace.preview", "arguments": [] });
    assert_eq!(
        editor.fail("workspace/executeCommand", params).await["code"],
        -32602
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn requests_before_the_handshake_and_after_the_farewell_are_refused() {
    let mut editor = Editor::start(Place::Binary, "life");
    let error = editor.fail("textDocument/hover", at(0, 0)).await;
    assert_eq!(error["code"], -32002);
    editor.initialize(json!({})).await;
    assert_eq!(
        editor
            .fail("initialize", json!({ "capabilities": {} }))
            .await["code"],
        -32600
    );
    assert_eq!(editor.ask("shutdown", Value::Null).await, Value::Null);
    assert_eq!(
        editor.fail("textDocument/hover", at(0, 0)).await["code"],
        -32600
    );
    editor.notify("exit", Value::Null).await;
    assert_eq!(editor.end().await, 0);
}

#[tokio::test]
async fn an_editor_that_leaves_without_a_word_ends_the_server() {
    let editor = started(Place::Binary, "eof").await;
    assert_eq!(editor.hang_up().await, 1);
    let mut editor = started(Place::Binary, "exit").await;
    editor.notify("exit", Value::Null).await;
    assert_eq!(editor.end().await, 1);
    let mut editor = started(Place::Binary, "farewell").await;
    editor.ask("shutdown", Value::Null).await;
    assert_eq!(editor.hang_up().await, 0);
}

#[tokio::test]
async fn the_death_of_the_editor_ends_the_server_though_its_input_stays_open() {
    let mut parent = std::process::Command::new("sleep")
        .arg("600")
        .spawn()
        .expect("a process");
    let mut editor = Editor::start(Place::Binary, "death");
    let params = json!({ "processId": parent.id(), "rootUri": null, "capabilities": {} });
    editor.initialize_with(params).await;
    editor.open(URI, "define a = 1;").await;
    editor.diagnostics(URI, 1).await;
    parent.kill().expect("it can be ended");
    parent.wait().expect("it has ended");
    assert_eq!(editor.end().await, 1);
}
