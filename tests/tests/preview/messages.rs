//! The messages that windows receive: texts, cursors, views.

use std::time::Duration;

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};
use testing::window::{VERSION, Windows};

use super::{
    FAKE, OTHER, PROGRAM, URI, at, capabilities, close, command, insert, message, messages,
    previewed, shown, started,
};

#[tokio::test]
async fn a_window_receives_the_text_and_every_edit() {
    for place in PLACES {
        let windows = Windows::new(FAKE, false).await;
        let mut editor = started(place, "preview-texts", &windows).await;
        editor.open(URI, PROGRAM).await;
        let view = json!({ "view": "geodesic", "surface": "s" });
        command(&mut editor, URI, view).await;
        let mut window = windows.next().await;
        window.greet().await;
        let received = window.receive().await.expect("the text");
        let wanted = json!({
            "type": "text", "uri": URI, "path": "/a folder/a.gtr", "version": 1, "text": PROGRAM,
        });
        assert_eq!(received, wanted);
        let received = window.receive().await.expect("the view");
        let wanted = json!({ "type": "show", "view": { "view": "geodesic", "surface": "s" } });
        assert_eq!(received, wanted);

        editor.change(URI, 2, insert(1, 15, ".5")).await;
        let received = window.receive().await.expect("the edit");
        let offset = PROGRAM.find("]").expect("it is there") as u32;
        let wanted = json!({
            "type": "edit", "version": 2, "base": 1,
            "changes": [{ "range": [offset, offset], "text": ".5" }],
        });
        assert_eq!(received, wanted);
        // The whole text at once, as simple editors send it.
        editor.change(URI, 3, json!([{ "text": "#" }])).await;
        assert_eq!(window.receive().await.expect("the text")["text"], "#");

        // The same command again brings the window to the front, and no other opens.
        command(&mut editor, URI, json!({ "view": "3d" })).await;
        let received = window.receive().await.expect("the view");
        assert_eq!(
            received,
            json!({ "type": "show", "view": { "view": "3d" } })
        );
        command(&mut editor, URI, Value::Null).await;
        let received = window.receive().await.expect("the view");
        assert_eq!(received, json!({ "type": "show", "view": null }));
        assert!(!windows.is_any().await);

        // An editor that asks for it is notified of what is shown.
        window.send(shown(3)).await;
        let received = editor.notified("geotrace/shown", |_| true).await;
        let wanted =
            json!({ "uri": URI, "version": 3, "ok": true, "milliseconds": 1.5, "painting": 2.5 });
        assert_eq!(received, wanted);

        // With its document the window closes.
        close(&mut editor, URI).await;
        assert_eq!(window.receive().await, Some(json!({ "type": "close" })));
        assert_eq!(window.receive().await, None);
        window.exit(0).await;
        assert_eq!(messages(&editor), Vec::<&Value>::new());
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn a_window_that_lacks_a_text_receives_it_once_more() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-gap", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    // Several changes at once, each in places of the text after the one before.
    let mut changes = insert(0, 0, "#\n");
    let more = [insert(1, 2, "é"), insert(0, 1, "!")];
    let all = changes.as_array_mut().expect("changes");
    all.extend(more.iter().map(|change| change[0].clone()));
    editor.change(URI, 2, changes).await;
    let received = window.receive().await.expect("the edit");
    let wanted = json!([
        { "range": [0, 0], "text": "#!\n" },
        { "range": [2, 2], "text": "é" },
    ]);
    assert_eq!(received["changes"], wanted);
    window.send(json!({ "type": "textWanted" })).await;
    let received = window.receive().await.expect("the text");
    let text = format!("#!\n{}", PROGRAM.replacen("# ", "# é", 1));
    let wanted = json!({
        "type": "text", "uri": URI, "path": "/a folder/a.gtr", "version": 2, "text": text,
    });
    assert_eq!(received, wanted);
    editor.change(URI, 3, insert(0, 0, "#")).await;
    assert_eq!(window.receive().await.expect("the edit")["base"], 2);
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_document_that_is_read_anew_keeps_its_window_whatever_its_versions_are() {
    let mut windows = Windows::new(FAKE, false).await;
    // As long as any test lasts: only what calls the end off keeps the window.
    windows.program.close_delay = Duration::from_secs(3600);
    let mut editor = started(Place::Here, "preview-reread", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    editor
        .change(URI, 7, json!([{ "text": "point p = (1, 2, 3);" }]))
        .await;
    assert_eq!(window.receive_of("text").await["version"], 7);
    // The same document with another text, whose version is lower, and then the same.
    for (text, number) in [("#new", 8), ("#newer", 9)] {
        close(&mut editor, URI).await;
        editor.open(URI, text).await;
        let received = window.receive().await.expect("the text");
        assert_eq!(
            (&received["type"], &received["text"]),
            (&json!("text"), &json!(text))
        );
        assert_eq!(received["version"], number, "it is later than all before");
    }
    // What the window shows is the version that the editor knows, or of a text that it knows no more.
    for number in [7, 8, 9] {
        window.send(shown(number)).await;
    }
    let received = editor.notified("geotrace/shown", |_| true).await;
    assert_eq!(received["version"], 1);
    // Cursors and places are those of the text that is meant.
    editor.notify("geotrace/cursor", at(URI, 0, 2)).await;
    let received = window.receive_of("cursor").await;
    assert_eq!(
        (&received["version"], &received["offset"]),
        (&json!(9), &json!(2))
    );
    editor.change(URI, 2, insert(0, 0, "#\n")).await;
    assert_eq!(window.receive_of("text").await["version"], 10);
    window
        .send(json!({ "type": "open", "version": 9, "range": [1, 6] }))
        .await;
    let asked = editor.asked("window/showDocument").await;
    let [start, end] = [1, 6].map(|c| json!({ "line": 1, "character": c }));
    assert_eq!(asked["selection"], json!({ "start": start, "end": end }));
    assert_eq!(
        editor
            .received()
            .filter(|m| m["method"] == "geotrace/shown")
            .count(),
        1
    );
    // One that has been closed for now is closed when the editor leaves.
    close(&mut editor, URI).await;
    assert_eq!(editor.quit().await, 0);
    assert_eq!(window.receive_of("close").await, json!({ "type": "close" }));
}

#[tokio::test]
async fn a_document_that_is_read_anew_brings_no_window_to_the_front() {
    let mut windows = Windows::new(FAKE, false).await;
    windows.program.close_delay = Duration::from_secs(3600);
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
    assert_eq!(window.receive_of("text").await["version"], 1);
    close(&mut editor, URI).await;
    editor.open(URI, "#new").await;
    editor.change(URI, 2, insert(0, 0, "#")).await;
    let mut all_received = vec![window.receive().await.expect("a text")];
    while all_received
        .last()
        .is_some_and(|received| received["text"] != "##new")
    {
        all_received.push(window.receive().await.expect("a text"));
    }
    assert!(
        all_received
            .iter()
            .all(|received| received["type"] == "text"),
        "{all_received:?}"
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_knows_where_the_cursor_stood_before_it_was_opened() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-cursor-before", &windows).await;
    editor.open(URI, PROGRAM).await;
    editor.notify("geotrace/cursor", at(URI, 2, 8)).await;
    // It stands in the same line and column of the text as it is then.
    editor.change(URI, 2, insert(0, 2, "𝛼𝛼")).await;
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.greet().await;
    let received = window.receive_of("text").await;
    let offset = received["text"].as_str().and_then(|text| text.find("s(u"));
    let wanted = json!({ "type": "cursor", "version": 2, "offset": offset });
    assert_eq!(window.receive().await, Some(wanted.clone()));
    // And once more when the window has read the text.
    window.send(shown(2)).await;
    assert_eq!(window.receive().await, Some(wanted));
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
    let received = window.receive().await.expect("the cursor");
    assert_eq!(
        received,
        json!({ "type": "cursor", "version": 1, "offset": 14 })
    );
    // … by the notification, in the encoding that was agreed (UTF-16 here), …
    editor.notify("geotrace/cursor", at(URI, 1, 21)).await;
    let received = window.receive().await.expect("the cursor");
    assert_eq!(received["offset"], 7 + 16 + 2 + 1 + 4 + 1);
    // … and not again where it has not moved.
    editor.notify("geotrace/cursor", at(URI, 1, 21)).await;
    editor.notify("geotrace/cursor", at(OTHER, 0, 0)).await;
    assert!(window.receives_nothing().await);
    // The window may have compiled the text only now: it receives it once more.
    window.send(shown(1)).await;
    let received = window.receive().await.expect("the cursor");
    assert_eq!(
        received,
        json!({ "type": "cursor", "version": 1, "offset": 31 })
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn of_many_edits_a_window_that_does_not_read_receives_the_last() {
    const EDITS: i64 = 2_000;
    for place in PLACES {
        let windows = Windows::new(FAKE, true).await;
        let mut editor = started(place, "preview-deaf", &windows).await;
        // Longer than what a pipe takes: nothing of it is read for now.
        let text = format!("{}define a = 1;", "# filling\n".repeat(20_000));
        editor.open(URI, &text).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet_as(VERSION).await;
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
            let received = window.receive_of("text").await;
            versions.push(received["version"].as_i64().expect("a number"));
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
    assert_eq!(of_one.receive_of("text").await["text"], "#a\ndefine a = 1;");
    assert!(other_of_one.receives_nothing().await);
    assert!(of_two.receives_nothing().await);
    one.change(OTHER, 2, insert(0, 0, "#b\n")).await;
    let received = other_of_one.receive_of("text").await;
    assert_eq!(
        (&received["uri"], &received["text"]),
        (&json!(OTHER), &json!("#b\ndefine b = 1;"))
    );
    two.change(URI, 2, insert(0, 0, "#c\n")).await;
    assert_eq!(of_two.receive_of("text").await["text"], "#c\ndefine c = 1;");
    assert!(of_one.receives_nothing().await);

    // Their events arrive where they belong.
    let open = json!({ "type": "open", "version": 2, "range": [10, 11] });
    other_of_one.send(open.clone()).await;
    let asked = one.asked("window/showDocument").await;
    assert_eq!(asked["uri"], OTHER);
    of_two.send(open).await;
    assert_eq!(two.asked("window/showDocument").await["uri"], URI);
    let values = json!({ "type": "values", "version": 2, "values": { "b": [1.0] } });
    other_of_one.send(values).await;
    one.asked("workspace/inlayHint/refresh").await;

    // One window's end is not the others'.
    of_one.kill().await;
    message(&mut one, "a.gtr").await;
    one.change(OTHER, 3, insert(0, 0, "#")).await;
    assert_eq!(other_of_one.receive_of("text").await["version"], 3);
    two.change(URI, 3, insert(0, 0, "#")).await;
    assert_eq!(of_two.receive_of("text").await["version"], 3);
    assert_eq!(one.quit().await, 0);
    assert_eq!(
        other_of_one.receive().await,
        Some(json!({ "type": "close" }))
    );
    assert!(of_two.receives_nothing().await);
    assert_eq!(two.quit().await, 0);
    assert_eq!(of_two.receive().await, Some(json!({ "type": "close" })));
}
