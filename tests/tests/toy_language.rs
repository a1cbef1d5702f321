//! A second language that is registered in one place opens in the command line, the server and the window.

use std::process::Command;

use ide::Languages;
use serde_json::json;
use testing::editor::{Editor, Place};
use testing::toy_language::Dots;

const TEXT: &str = "// three of them\ndot 0 0 0\ndot 1 0 0\ndot 0 1 0.5\n";

#[test]
fn the_command_line_checks_and_draws_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.dots");
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_toy-geotrace"))
            .args(arguments)
            .arg(&file)
            .current_dir(folder.path())
            .output()
            .expect("it starts");
        let text = [output.stdout, output.stderr].concat();
        (
            output.status.code(),
            String::from_utf8_lossy(&text).into_owned(),
        )
    };
    std::fs::write(&file, TEXT).expect("written");
    assert_eq!(run(&["check"]).0, Some(0));
    let drawn = run(&[
        "render",
        "-o",
        "a.png",
        "--size",
        "64x64",
        "--backend",
        "software",
    ]);
    assert_eq!(drawn.0, Some(0), "{}", drawn.1);
    let image = image::open(folder.path().join("a.png"))
        .expect("a picture")
        .to_rgba8();
    let first = image.get_pixel(0, 0);
    assert!(
        image.pixels().any(|pixel| pixel != first),
        "nothing is seen"
    );

    std::fs::write(&file, "dot 0 0\n").expect("written");
    let (status, text) = run(&["check"]);
    assert_eq!(status, Some(1));
    assert!(
        text.contains("a.dots:1:1: error[no-dot]: a line is `dot` and three numbers"),
        "{text}"
    );
}

#[tokio::test]
async fn the_server_has_its_diagnostics_colours_and_outline() {
    let languages = Languages::standard().with(Dots);
    let mut editor = Editor::start_for(Place::Here, "toy", languages, None);
    editor.initialize(json!({})).await;
    let uri = "file:///a.dots";
    let document = json!({ "uri": uri, "languageId": "dots", "version": 1, "text": TEXT });
    editor
        .notify("textDocument/didOpen", json!({ "textDocument": document }))
        .await;
    assert!(editor.diagnostics(uri, 1).await.is_empty());
    let here = json!({ "textDocument": { "uri": uri } });
    let tokens = editor
        .ask("textDocument/semanticTokens/full", here.clone())
        .await;
    // A comment and three keywords.
    assert_eq!(
        tokens["data"].as_array().expect("tokens").len(),
        4 * 5,
        "{tokens}"
    );
    let outline = editor.ask("textDocument/documentSymbol", here).await;
    let names: Vec<&str> = outline
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|it| it["name"].as_str())
        .collect();
    assert_eq!(names, ["dot1", "dot2", "dot3"]);

    let range =
        json!({ "start": { "line": 1, "character": 4 }, "end": { "line": 1, "character": 5 } });
    editor
        .change(uri, 2, json!([{ "range": range, "text": "x" }]))
        .await;
    let found = editor.diagnostics(uri, 2).await;
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0]["code"], "no-dot");
    assert_eq!(
        found[0]["range"]["start"],
        json!({ "line": 1, "character": 0 })
    );
    // The other language is there as ever.
    editor.open("file:///b.gtr", "point p = (1, 2);").await;
    let found = editor.diagnostics("file:///b.gtr", 1).await;
    assert_eq!(found[0]["code"], "not-in-space");
    assert_eq!(editor.quit().await, 0);
}
