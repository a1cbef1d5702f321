//! How windows begin and end.

use std::time::Duration;

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};
use testing::window::{VERSION, Windows, kill};

use super::{
    FAKE, OTHER, PROGRAM, URI, capabilities, command, insert, message, messages, previewed, started,
};

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
    assert_eq!(window.receive_of("text").await["uri"], URI);
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
        .notify("workspace/didChangeConfiguration", settings)
        .await;
    let mut window = windows.next().await;
    window.greet().await;
    assert_eq!(editor.quit().await, 0);
}
#[tokio::test]
async fn a_window_that_was_closed_opens_anew_without_a_word() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Here, "preview-closed", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    window.send(json!({ "type": "closed" })).await;
    // The process may take its time to end: the command does not wait for it.
    window
        .send(json!({ "type": "message", "error": false, "text": "bye" }))
        .await;
    message(&mut editor, "bye").await;
    command(&mut editor, URI, Value::Null).await;
    let mut next = windows.next().await;
    assert_ne!(next.pid, window.pid);
    next.greet().await;
    assert_eq!(next.receive_of("text").await["version"], 1);
    window.exit(3).await;
    editor.change(URI, 2, insert(0, 0, "#")).await;
    assert_eq!(next.receive_of("text").await["version"], 2);
    assert_eq!(messages(&editor), ["bye"]);
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_that_dies_is_reported_once_and_the_command_restarts_it() {
    for place in PLACES {
        let windows = Windows::new(FAKE, false).await;
        let mut editor = started(place, "preview-killed", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        window.complain("the driver says goodbye").await;
        let received = editor.notified("window/logMessage", |_| true).await;
        assert_eq!(
            received["message"],
            "preview of a.gtr: the driver says goodbye"
        );
        window.kill().await;
        let received = message(&mut editor, "ended").await;
        for part in ["a.gtr", "signal: 9", "the driver says goodbye"] {
            assert!(received.contains(part), "{received}");
        }
        editor.change(URI, 2, insert(0, 0, "#")).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet().await;
        assert_eq!(window.receive_of("text").await["version"], 2);

        // The command does not wait until the death has been reported.
        kill(window.pid);
        window.ended().await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet().await;
        assert_eq!(window.receive_of("text").await["version"], 2);

        // One that says why it ends is repeated: here, that there is no display.
        window.complain("error: there is no display").await;
        window.complain("  help: draw with `geotrace render`").await;
        editor
            .notified("window/logMessage", |p| {
                p["message"].as_str().is_some_and(|m| m.contains("help"))
            })
            .await;
        window.exit(1).await;
        let received = message(&mut editor, "exit status: 1").await;
        assert!(
            received.contains("error: there is no display. "),
            "{received}"
        );
        // The second death may have been reported as well, or not: the command has answered it.
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
    let received = message(&mut editor, "version").await;
    assert!(
        received.contains("version 99") && received.contains("version 3"),
        "{received}"
    );
    window.ended().await;

    // One that begins with something else is none.
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.send(json!({ "type": "closed" })).await;
    message(&mut editor, "did not send its version").await;
    window.ended().await;
    assert_eq!(messages(&editor).len(), 2);

    // Noise before the greeting, and behind it, is only logged.
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    window.send_line("WARNING: a driver is talking").await;
    window.greet().await;
    window.send_line("{\"type\":\"unheard of\"}").await;
    window.send_line("{\"type\":\"shown\"").await;
    window
        .send(json!({ "type": "message", "error": true, "text": "here I am" }))
        .await;
    message(&mut editor, "here I am").await;
    for part in ["a driver is talking", "unheard of", "not a message"] {
        let logged = editor
            .received()
            .any(|m| m["method"] == "window/logMessage" && m.to_string().contains(part));
        assert!(logged, "{part}");
    }
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_window_that_says_nothing_is_ended() {
    let mut windows = Windows::new(FAKE, false).await;
    windows.program.version_timeout = Duration::from_millis(300);
    let mut editor = started(Place::Here, "preview-silent", &windows).await;
    editor.open(URI, PROGRAM).await;
    command(&mut editor, URI, Value::Null).await;
    let mut window = windows.next().await;
    let received = message(&mut editor, "has not answered").await;
    assert!(received.contains("0.3 seconds"), "{received}");
    window.ended().await;
    // One that ends before it says anything may not do so silently, whatever its status.
    command(&mut editor, URI, Value::Null).await;
    windows.next().await.exit(0).await;
    let received = message(&mut editor, "exit status: 0").await;
    assert!(!received.contains("opens it again"), "{received}");
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn what_cannot_be_started_is_reported() {
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
async fn a_server_that_is_killed_leaves_its_windows() {
    let windows = Windows::new(FAKE, false).await;
    let mut editor = started(Place::Binary, "preview-server-killed", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    kill(editor.process().expect("a process"));
    // The window's input ends without a farewell, and the window lives on.
    assert_eq!(window.receive().await, None);
    window.exit(0).await;
}

#[tokio::test]
async fn a_server_that_is_told_to_end_closes_its_windows() {
    let windows = Windows::new(FAKE, false).await;
    // Under `nohup` the server is to outlive its terminal.
    let status = std::fs::read_to_string("/proc/self/status").expect("the status of a process");
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = u64::from_str_radix(ignored.expect("a mask").trim(), 16).expect("a number");
    let signals: &[&str] = match ignored & 1 {
        0 => &["-TERM", "-INT", "-HUP"],
        _ => &["-TERM", "-INT"],
    };
    for signal in signals {
        let mut editor = started(Place::Binary, "preview-signal", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        let pid = editor.process().expect("a process").to_string();
        let mut command = std::process::Command::new("kill");
        let sent = command.args([*signal, &pid]).status();
        assert!(sent.expect("kill is there").success());
        let close = json!({ "type": "close" });
        assert_eq!(window.receive().await, Some(close), "{signal}");
        assert_eq!(editor.end().await, 1);
        window.exit(0).await;
    }
}

#[tokio::test]
async fn an_editor_that_says_goodbye_closes_its_windows_though_they_have_much_to_read() {
    for place in PLACES {
        let windows = Windows::new(FAKE, false).await;
        let mut editor = started(place, "preview-goodbye", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        for version in 2..100 {
            editor.change(URI, version, insert(0, 0, "#")).await;
        }
        assert_eq!(editor.quit().await, 0);
        window.receive_of("close").await;
        assert_eq!(window.receive().await, None);
        window.exit(0).await;
    }
}

#[tokio::test]
async fn an_editor_that_goes_without_a_word_takes_its_windows_along() {
    let windows = Windows::new(FAKE, false).await;
    let close = Some(json!({ "type": "close" }));
    // Its input ends, …
    for place in PLACES {
        let mut editor = started(place, "preview-hung-up", &windows).await;
        let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
        assert_eq!(editor.hang_up().await, 1);
        assert_eq!(window.receive().await, close, "{place:?}");
        window.exit(0).await;
    }
    // … it says `exit` and no farewell, …
    let mut editor = started(Place::Binary, "preview-exit", &windows).await;
    let mut window = previewed(&mut editor, &windows, URI, PROGRAM).await;
    editor.notify("exit", Value::Null).await;
    assert_eq!(editor.end().await, 1);
    assert_eq!(window.receive().await, close);
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
    assert_eq!(window.receive().await, close);
    assert_eq!(editor.end().await, 1);
    window.exit(0).await;
}

#[tokio::test]
async fn a_window_that_does_not_listen_is_ended_with_its_editor() {
    let windows = Windows::new(FAKE, true).await;
    for says_goodbye in [true, false] {
        let name = format!("preview-deaf-goodbye-{says_goodbye}");
        let mut editor = started(Place::Binary, &name, &windows).await;
        editor.open(URI, &"# filling\n".repeat(20_000)).await;
        command(&mut editor, URI, Value::Null).await;
        let mut window = windows.next().await;
        window.greet_as(VERSION).await;
        if says_goodbye {
            assert_eq!(editor.quit().await, 0);
        } else {
            assert_eq!(editor.hang_up().await, 1);
        }
        window.ended().await;
    }
}
