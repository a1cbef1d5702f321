//! Requests to the language server that take more than one short document: a folder of programs, a long list, a range.

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};

const URI: &str = "file:///a.gtr";

async fn started(place: Place, name: &str, folders: Value) -> Editor {
    let mut editor = Editor::start(place, name);
    let params = json!({
        "processId": null,
        "rootUri": null,
        "capabilities": { "window": { "workDoneProgress": true } },
        "workspaceFolders": folders,
    });
    editor.initialize_with(params).await;
    editor
}

fn names(symbols: &Value) -> Vec<&str> {
    let symbols = symbols.as_array().expect("a list").iter();
    symbols.filter_map(|it| it["name"].as_str()).collect()
}

/// The kinds of the reports of a progress that have been received.
fn progress(editor: &Editor, token: &str) -> Vec<String> {
    let received = editor.received().filter(|it| it["method"] == "$/progress");
    let own = received.filter(|it| it["params"]["token"] == token);
    let kinds = own.map(|it| it["params"]["value"]["kind"].as_str());
    kinds.flatten().map(str::to_owned).collect()
}

#[tokio::test]
async fn the_root_of_an_editor_without_folders_is_searched() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("one.gtr"), "define alpha = 1;\n").expect("a file");
    let mut editor = Editor::start(Place::Here, "root");
    let params = json!({
        "processId": null,
        "rootUri": format!("file://{}", folder.path().display()),
        "capabilities": {},
    });
    let answer = editor.initialize_with(params).await;
    let folders = &answer["capabilities"]["workspace"]["workspaceFolders"];
    assert_eq!(
        *folders,
        json!({ "supported": true, "changeNotifications": true })
    );
    let found = editor
        .ask("workspace/symbol", json!({ "query": "al" }))
        .await;
    assert_eq!(names(&found), ["alpha"]);
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_search_finds_programs_that_are_not_open_and_reports_its_progress() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::create_dir(path.join(".hidden")).expect("a folder");
    for (name, text) in [
        ("one.gtr", "define alpha = 1;\n"),
        ("two.gtr", "define alp = 1;\ndefine beta = 2;\n"),
        (".hidden/three.gtr", "define alphabet = 3;\n"),
        ("four.txt", "define alphas = 4;\n"),
    ] {
        std::fs::write(path.join(name), text).expect("a file");
    }
    let uri = format!("file://{}", path.display());
    for place in PLACES {
        let folders = json!([{ "uri": uri, "name": "programs" }]);
        let mut editor = started(place, "workspace", folders).await;
        let query = |token: &str| json!({ "query": "al", "workDoneToken": token });
        let found = editor.ask("workspace/symbol", query("first")).await;
        let mut found = names(&found);
        found.sort_unstable();
        assert_eq!(found, ["alp", "alpha"]);
        // All of it is sent before the answer.
        assert_eq!(progress(&editor, "first"), ["begin", "end"]);

        // An open document is what the editor has of it, not what is on the disk.
        editor
            .open(&format!("{uri}/one.gtr"), "define also = 1;\n")
            .await;
        let found = editor.ask("workspace/symbol", query("second")).await;
        let mut found = names(&found);
        found.sort_unstable();
        assert_eq!(found, ["alp", "also"]);

        let event =
            json!({ "event": { "removed": [{ "uri": uri, "name": "programs" }], "added": [] } });
        editor
            .notify("workspace/didChangeWorkspaceFolders", event)
            .await;
        let found = editor.ask("workspace/symbol", query("third")).await;
        assert_eq!(names(&found), ["also"]);

        // Whether it is cancelled in time or not, what has begun ends.
        for k in 0..20 {
            let token = format!("cancelled {k}");
            let id = editor.post("workspace/symbol", query(&token)).await;
            editor.notify("$/cancelRequest", json!({ "id": id })).await;
            let _ = editor.answer(id).await;
            let received = progress(&editor, &token);
            assert!(
                received.is_empty() || received == ["begin", "end"],
                "{received:?}"
            );
        }
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn a_search_passes_over_programs_that_are_too_long() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::write(path.join("short.gtr"), "define alpha = 1;\n").expect("a file");
    let mut long = std::fs::File::create(path.join("long.gtr")).expect("a file");
    std::io::Write::write_all(&mut long, b"define alpine = 1;\n").expect("written");
    long.set_len(ide::language::LONGEST_PROGRAM + 1)
        .expect("it becomes long");
    let uri = format!("file://{}", path.display());
    for place in PLACES {
        let folders = json!([{ "uri": uri, "name": "programs" }]);
        let mut editor = started(place, "long programs", folders).await;
        let found = editor.ask("workspace/symbol", json!({ "query": "alp" }));
        assert_eq!(names(&found.await), ["alpha"]);
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn a_search_in_too_many_programs_takes_the_first_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    // More than are searched, written in another order.
    for k in (0..2_010).rev() {
        let text = if k < 2_000 { "" } else { "define late = 1;\n" };
        std::fs::write(folder.path().join(format!("{k:04}.gtr")), text).expect("a file");
    }
    let uri = format!("file://{}", folder.path().display());
    let folders = json!([{ "uri": uri, "name": "programs" }]);
    let mut editor = started(PLACES[0], "many programs", folders).await;
    let found = editor.ask("workspace/symbol", json!({ "query": "late" }));
    assert!(names(&found.await).is_empty());
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_list_that_leaves_names_out_says_so_and_is_asked_for_again() {
    let mut text = String::new();
    for k in 0..1_000 {
        text.push_str(&format!("define a{k} = {k};\n"));
    }
    text.push_str("define last = 2a77;\n");
    for place in PLACES {
        let mut editor = started(place, "long list", Value::Null).await;
        editor.open(URI, &text).await;
        let at = |character: u32| json!({ "textDocument": { "uri": URI }, "position": { "line": 1_000, "character": character } });
        let list = editor.ask("textDocument/completion", at(17)).await;
        assert_eq!(list["isIncomplete"], true);
        let labels = |list: &Value| -> Vec<String> {
            let items = list["items"].as_array().expect("items").iter();
            items
                .filter_map(|it| it["label"].as_str())
                .map(str::to_owned)
                .collect()
        };
        assert!(labels(&list).len() < 400, "{} names", labels(&list).len());
        // Behind `a77`: what goes on from there.
        let list = editor.ask("textDocument/completion", at(18)).await;
        let found = labels(&list);
        let mut found: Vec<&str> = found
            .iter()
            .filter(|it| it.starts_with("a7"))
            .map(String::as_str)
            .collect();
        found.sort_unstable();
        assert_eq!(
            found,
            [
                "a77", "a770", "a771", "a772", "a773", "a774", "a775", "a776", "a777", "a778",
                "a779"
            ]
        );
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn a_range_is_laid_out_alone_and_so_is_what_a_semicolon_ends() {
    let text = "define a=1 ;\ndefine b=2 ;\ndefine c=3 ;\n";
    let options = json!({ "tabSize": 4, "insertSpaces": true });
    let laid_out = |edits: &Value| -> Vec<u64> {
        let edits = edits.as_array().expect("edits").iter();
        let mut lines: Vec<u64> = edits
            .filter_map(|it| it["range"]["start"]["line"].as_u64())
            .collect();
        lines.dedup();
        lines
    };
    for place in PLACES {
        let mut editor = started(place, "a range", Value::Null).await;
        editor.open(URI, text).await;
        let params = json!({
            "textDocument": { "uri": URI },
            "range": { "start": { "line": 1, "character": 0 }, "end": { "line": 1, "character": 12 } },
            "options": options,
        });
        let edits = editor.ask("textDocument/rangeFormatting", params).await;
        assert_eq!(laid_out(&edits), [1]);
        let params = json!({
            "textDocument": { "uri": URI },
            "position": { "line": 2, "character": 12 },
            "ch": ";",
            "options": options,
        });
        let edits = editor.ask("textDocument/onTypeFormatting", params).await;
        assert_eq!(laid_out(&edits), [2]);
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn diagnostics_of_what_is_not_open_are_refused_and_nothing_is_taken_back() {
    let mut editor = started(Place::Here, "not-open", Value::Null).await;
    let params = json!({ "textDocument": { "uri": URI } });
    let error = editor.fail("textDocument/diagnostic", params).await;
    assert!(
        error["message"]
            .as_str()
            .is_some_and(|it| it.contains("not open")),
        "{error}"
    );
    // The server sends what it has to report before it ends.
    let published = |editor: &Editor| {
        let received = editor.received();
        received
            .filter(|it| it["method"] == "textDocument/publishDiagnostics")
            .count()
    };
    editor.open("file:///b.gtr", "point p = (1, 0, 0);").await;
    editor.diagnostics("file:///b.gtr", 1).await;
    assert_eq!(published(&editor), 1);
    assert_eq!(editor.quit().await, 0);
}
