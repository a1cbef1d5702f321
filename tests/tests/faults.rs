//! Faults around the program: full disks, folders that vanish, clients that are slow, clocks that jump. Nothing is lost and
//! nothing waits for ever.
//!
//! Kills at random times, disks that are full behind a random byte and two writers of one file are attacks of
//! `geotrace-fuzz`, a few of which its tests make. The faults of the real window are in `tests/window`, those of windows
//! beside an editor in `preview/lives.rs`, and a GPU that is lost in `render/tests/live.rs` and in `tests/window`.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use testing::binary::{binary, geotrace};
use testing::editor::{Place, framed};
use testing::structure;
use testing::talk::{URI, at, document, started};

const PROGRAM: &str = "\
param r : [0.4, 0.9];
surface s(u,v) = ((1 + r cosv)cosu, (1 + r cosv)sinu, r sinv), u : [0, 2pi], v : [0, 2pi];
";

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry.expect("an entry")))
        .collect();
    names.sort();
    names
}

/// A folder with the program.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("p.gtr"), PROGRAM).expect("written");
    folder
}

#[cfg(target_os = "linux")]
#[test]
fn a_standard_output_that_is_full_is_reported_by_every_command() {
    let folder = folder();
    let commands: [&[&str]; 11] = [
        &["--help"],
        &["check", "p.gtr", "--format", "json"],
        &["explain", "p.gtr"],
        &["explain", "p.gtr", "--format", "json"],
        &["eval", "p.gtr", "1 + 1"],
        &["format", "-"],
        &[
            "render",
            "p.gtr",
            "--backend=software",
            "--size=16x16",
            "-o",
            "-",
        ],
        &[
            "render",
            "p.gtr",
            "--backend=software",
            "--size=16x16",
            "-o",
            "/dev/full",
        ],
        &["export", "p.gtr", "--format", "obj", "-o", "-"],
        &["trace", "p.gtr", "--from=0,0", "--heading=30", "--length=1"],
        &["measure", "p.gtr", "--at=0,0", "--format=json"],
    ];
    for arguments in commands {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let ended = Command::new(binary())
            .args(arguments)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(full.expect("the device"))
            .output()
            .expect("it runs");
        let printed = String::from_utf8_lossy(&ended.stderr);
        // An empty input has an empty layout.
        let status = if arguments[0] == "format" { 0 } else { 2 };
        assert_eq!(
            ended.status.code(),
            Some(status),
            "{arguments:?}: {printed}"
        );
        assert!(!printed.contains("panicked"), "{arguments:?}: {printed}");
        assert_eq!(
            printed.contains("space"),
            status == 2,
            "{arguments:?}: {printed}"
        );
    }
    assert_eq!(names(folder.path()), ["p.gtr"]);
}

#[cfg(unix)]
#[test]
fn a_series_on_a_full_disk_replaces_nothing_and_leaves_nothing() {
    let folder = folder();
    let render =
        "render p.gtr --backend=software --size=64x48 -o q.png --animate r=0.4:0.9 --frames 5";
    std::fs::write(folder.path().join("q-0002.png"), "older").expect("written");
    let run = geotrace(render.split(' '))
        .folder(folder.path())
        .largest_file(512)
        .run();
    run.expect_status(2).expect_text("cannot write");
    assert_eq!(names(folder.path()), ["p.gtr", "q-0002.png"]);
    let older = std::fs::read(folder.path().join("q-0002.png"));
    assert_eq!(older.expect("it is there"), b"older");
}

#[cfg(unix)]
#[test]
fn a_folder_that_vanishes_while_pictures_are_drawn_is_reported() {
    let folder = folder();
    let out = folder.path().join("out");
    std::fs::create_dir(&out).expect("a folder");
    let render = "render p.gtr --backend=software --size=32x24 --animate r=0.4:0.9 --frames 100000 -o out/q.png";
    let mut drawing = Command::new(binary())
        .args(render.split(' '))
        .current_dir(folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    while names(&out).is_empty() {
        assert!(drawing.try_wait().expect("a process").is_none(), "it draws");
        std::thread::sleep(Duration::from_millis(5));
    }
    // While it is emptied, a new picture may come.
    std::fs::rename(&out, folder.path().join("gone")).expect("renamed");
    let ended = drawing.wait_with_output().expect("it ends");
    let printed = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(2), "{printed}");
    assert!(printed.contains("cannot write"), "{printed}");
    assert!(!printed.contains("panicked"), "{printed}");
    assert_eq!(names(folder.path()), ["gone", "p.gtr"]);
}

#[tokio::test]
async fn an_editor_that_reads_late_has_all_its_answers_and_costs_little_memory() {
    let mut editor = started(Place::Binary, "faults-late").await;
    editor.open(URI, &"define a = 2pi;\n".repeat(300)).await;
    editor.diagnostics(URI, 1).await;
    editor.read_late(Duration::from_millis(200)).await;
    // Each answer has some ten thousand bytes, and the pipe holds a few of them.
    let mut ids = Vec::new();
    for _ in 0..3_000 {
        let params = json!({ "textDocument": document() });
        ids.push(editor.post("textDocument/documentSymbol", params).await);
    }
    for id in ids {
        let symbols = editor.answer(id).await.expect("an answer");
        assert_eq!(symbols.as_array().map(Vec::len), Some(300));
    }
    let peak = editor.peak();
    assert!(peak < 300 << 20, "{} MB", peak >> 20);
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn an_editor_that_writes_byte_by_byte_is_understood() {
    let mut editor = started(Place::Binary, "faults-slow").await;
    let text =
        json!({ "uri": URI, "languageId": "geotrace", "version": 1, "text": "define a = 1; # 𝛼" });
    let message = json!({
        "jsonrpc": "2.0",
        "method": "textDocument/didOpen",
        "params": { "textDocument": text },
    });
    for byte in framed(&message.to_string()).as_bytes() {
        editor.send_raw(&[*byte]).await;
        tokio::task::yield_now().await;
    }
    let found = editor.diagnostics(URI, 1).await;
    assert!(found.iter().all(|it| it["severity"] != 1), "{found:?}");
    assert_ne!(
        editor.ask("textDocument/hover", at(0, 7)).await,
        Value::Null
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_workspace_that_vanishes_takes_no_open_document_with_it() {
    let folder = folder();
    let mut editor = testing::editor::Editor::start(Place::Binary, "faults-vanished");
    let root = format!("file://{}", folder.path().display());
    let params = json!({
        "processId": null,
        "rootUri": root,
        "workspaceFolders": [{ "uri": root, "name": "w" }],
        "capabilities": {},
    });
    editor.initialize_with(params).await;
    let uri = format!("{root}/p.gtr");
    editor.open(&uri, PROGRAM).await;
    editor.diagnostics(&uri, 1).await;
    drop(folder);
    let symbols = editor
        .ask("workspace/symbol", json!({ "query": "s" }))
        .await;
    assert!(
        symbols.as_array().is_some_and(|it| !it.is_empty()),
        "{symbols}"
    );
    let change = json!([{ "text": "define a = ;" }]);
    editor.change(&uri, 2, change).await;
    assert_eq!(editor.diagnostics(&uri, 2).await.len(), 1);
    assert_eq!(editor.quit().await, 0);
}

/// A clock that is set forward or back changes nothing, because none is read but the monotonic one.
#[test]
fn no_clock_is_read_that_can_jump() {
    let jumping = [
        "SystemTime",
        "UNIX_EPOCH",
        ".modified()",
        ".accessed()",
        ".created()",
    ];
    for file in structure::files() {
        for call in jumping {
            assert!(
                !file.text.contains(call),
                "{} has {call}",
                file.path.display()
            );
        }
    }
}
