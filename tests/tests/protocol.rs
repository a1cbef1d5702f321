//! What the language server answers through the protocol: a server in this process, and the binary on its standard
//! streams.

use serde_json::{Value, json};
use testing::editor::{Editor, PLACES, Place};
use testing::talk::{URI, at, capabilities, document, range, started};

const PROGRAM: &str = "\
# A torus 𝛼 and its radius.
param r : [0.4, 0.9];
define tau = 2pi;
function f(x, y) = x y + tau;
surface s(u, v) = ((1 + r cosv)cosu, (1 + r cosv)sinu, r sinv),
    u : [0, tau], v : [0, tau];
define b = f(1, 2) + sin 2;
";

#[tokio::test]
async fn every_feature_answers() {
    for place in PLACES {
        let mut editor = Editor::start(place, "features");
        let answer = editor.initialize(capabilities(&["utf-16"])).await;
        assert_eq!(answer["capabilities"]["positionEncoding"], "utf-16");
        assert_eq!(answer["serverInfo"]["name"], "geotrace");
        editor.open(URI, PROGRAM).await;
        assert_eq!(editor.diagnostics(URI, 1).await, Vec::<Value>::new());

        let hover = editor.ask("textDocument/hover", at(2, 8)).await;
        let text = hover["contents"]["value"].as_str().expect("markdown");
        assert!(text.contains("= 6.2832"), "{text}");
        assert_eq!(hover["range"], range([2, 7], [2, 10]));

        let items = editor.ask("textDocument/completion", at(6, 11)).await;
        let items = items.as_array().expect("a list").clone();
        let tau = items
            .iter()
            .find(|item| item["label"] == "tau")
            .expect("tau");
        let resolved = editor.ask("completionItem/resolve", tau.clone()).await;
        let text = resolved["documentation"]["value"]
            .as_str()
            .expect("documentation");
        assert!(text.contains("define tau"), "{text}");

        let help = editor.ask("textDocument/signatureHelp", at(6, 16)).await;
        assert_eq!(help["signatures"][0]["label"], "f(x, y)");
        assert_eq!(help["activeParameter"], 1);

        let definition = editor.ask("textDocument/definition", at(6, 11)).await;
        assert_eq!(definition["range"], range([3, 9], [3, 10]));
        let mut params = at(2, 7);
        params["context"] = json!({ "includeDeclaration": true });
        let references = editor.ask("textDocument/references", params).await;
        assert_eq!(references.as_array().map(Vec::len), Some(4));
        let highlights = editor.ask("textDocument/documentHighlight", at(1, 6)).await;
        // The declaration writes, the three uses read.
        let kinds: Vec<&Value> = highlights
            .as_array()
            .expect("a list")
            .iter()
            .map(|h| &h["kind"])
            .collect();
        assert_eq!(kinds, [3, 2, 2, 2]);

        let prepared = editor.ask("textDocument/prepareRename", at(1, 6)).await;
        assert_eq!(prepared["placeholder"], "r");
        let mut params = at(1, 6);
        params["newName"] = json!("radius");
        let edit = editor.ask("textDocument/rename", params).await;
        let edits = &edit["documentChanges"][0];
        assert_eq!(edits["textDocument"], json!({ "uri": URI, "version": 1 }));
        assert_eq!(edits["edits"].as_array().map(Vec::len), Some(4));

        let symbols = editor
            .ask(
                "textDocument/documentSymbol",
                json!({ "textDocument": document() }),
            )
            .await;
        let names: Vec<&Value> = symbols
            .as_array()
            .expect("a list")
            .iter()
            .map(|s| &s["name"])
            .collect();
        assert_eq!(names, ["r", "tau", "f", "s", "b"]);
        let symbols = editor
            .ask("workspace/symbol", json!({ "query": "ta" }))
            .await;
        assert_eq!(symbols.as_array().map(Vec::len), Some(1));

        let folds = editor
            .ask(
                "textDocument/foldingRange",
                json!({ "textDocument": document() }),
            )
            .await;
        assert_eq!(
            (&folds[0]["startLine"], &folds[0]["endLine"]),
            (&json!(4), &json!(5))
        );
        let params =
            json!({ "textDocument": document(), "positions": [{ "line": 6, "character": 13 }] });
        let selection = editor.ask("textDocument/selectionRange", params).await;
        assert_eq!(selection[0]["range"], range([6, 13], [6, 14]));
        assert_eq!(selection[0]["parent"]["range"], range([6, 12], [6, 18]));

        let params = json!({ "textDocument": document(), "range": range([0, 0], [9, 0]) });
        let hints = editor.ask("textDocument/inlayHint", params.clone()).await;
        let labels: Vec<&Value> = hints
            .as_array()
            .expect("a list")
            .iter()
            .map(|h| &h["label"])
            .collect();
        assert_eq!(labels, ["= 6.2832", " ", " ", " ", " ", " ", "= 9.1925"]);
        let lenses = editor
            .ask(
                "textDocument/codeLens",
                json!({ "textDocument": document() }),
            )
            .await;
        assert_eq!(
            lenses[1]["command"]["arguments"],
            json!([URI, { "view": "geodesic", "surface": "s" }])
        );

        let options = json!({ "tabSize": 4, "insertSpaces": true });
        let params = json!({ "textDocument": document(), "options": options });
        let edits = editor.ask("textDocument/formatting", params).await;
        assert_eq!(edits, json!([]), "it is laid out already");

        let params = json!({ "textDocument": document(), "range": range([4, 0], [4, 9]) });
        let some = editor
            .ask("textDocument/semanticTokens/range", params)
            .await;
        let all = editor
            .ask(
                "textDocument/semanticTokens/full",
                json!({ "textDocument": document() }),
            )
            .await;
        let length = |tokens: &Value| tokens["data"].as_array().map_or(0, Vec::len);
        assert!(0 < length(&some) && length(&some) < length(&all));
        assert_eq!(
            all["data"][2], 28,
            "the comment's letter beyond the first plane is two units"
        );

        let params = json!({ "command": "geotrace.preview", "arguments": [URI, { "view": "3d" }] });
        assert_eq!(
            editor.ask("workspace/executeCommand", params).await,
            Value::Null
        );
        let message = editor.notified("window/showMessage", |_| true).await;
        assert!(
            message["message"]
                .as_str()
                .is_some_and(|m| m.contains("preview"))
        );
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn a_selection_within_thousands_of_operators_grows_in_few_steps() {
    for place in PLACES {
        let mut editor = Editor::start(place, "selection");
        editor.initialize(capabilities(&["utf-16"])).await;
        let text = format!("define a = 1{};", "+1".repeat(20_000));
        editor.open(URI, &text).await;
        let params =
            json!({ "textDocument": document(), "positions": [{ "line": 0, "character": 13 }] });
        let selection = editor.ask("textDocument/selectionRange", params).await;
        let mut ranges = vec![&selection[0]];
        while let Some(parent) = ranges.last().and_then(|it| it.get("parent")) {
            ranges.push(parent);
        }
        let known = ranges.len();
        assert!((64..100).contains(&known), "{known}");
        assert_eq!(
            ranges[known - 1]["range"],
            range([0, 0], [0, text.len() as u32])
        );
        let ends = ranges
            .iter()
            .map(|it| it["range"]["end"]["character"].as_u64());
        assert!(ends.is_sorted());
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn colours_of_a_program_are_picked() {
    for place in PLACES {
        let mut editor = Editor::start(place, "colours");
        let answer = editor.initialize(capabilities(&["utf-16"])).await;
        assert_eq!(answer["capabilities"]["colorProvider"], true);
        let program = "# 𝛼\npoint p = (0,0,0), color : (1, 0.5, 0);";
        editor.open(URI, program).await;
        let params = json!({ "textDocument": document() });
        let colors = editor.ask("textDocument/documentColor", params).await;
        let color = json!({ "red": 1.0, "green": 0.5, "blue": 0.0, "alpha": 1.0 });
        let place = range([1, 27], [1, 38]);
        assert_eq!(colors, json!([{ "range": place, "color": color }]));
        let color = json!({ "red": 0.25, "green": 0.25, "blue": 0.25, "alpha": 1.0 });
        let params = json!({ "textDocument": document(), "range": place, "color": color });
        let texts = editor.ask("textDocument/colorPresentation", params).await;
        let edit = |text: &str| json!({ "range": place, "newText": text });
        let wanted = ["(0.25, 0.25, 0.25)", "0.25"];
        let wanted = wanted.map(|text| json!({ "label": text, "textEdit": edit(text) }));
        assert_eq!(texts, json!(wanted));
        assert_eq!(editor.quit().await, 0, "{place:?}");
    }
}

#[tokio::test]
async fn positions_are_in_the_encoding_that_was_agreed() {
    // The text is a comment up to a new line that an edit puts behind the letter 𝛼 and its accent é.
    let text = "# 𝛼é define a = sinn 1;";
    for (offered, agreed, column) in [
        (&["utf-8", "utf-16"][..], "utf-8", 9),
        (&["utf-16"], "utf-16", 6),
        (&["utf-32", "utf-16"], "utf-32", 5),
        (&[], "utf-16", 6),
    ] {
        let mut editor =
            Editor::start(Place::Here, &format!("encoding-{agreed}-{}", offered.len()));
        let capabilities = match offered {
            [] => json!({}),
            offered => capabilities(offered),
        };
        let answer = editor.initialize(capabilities).await;
        assert_eq!(answer["capabilities"]["positionEncoding"], agreed);
        editor.open(URI, text).await;
        assert_eq!(editor.diagnostics(URI, 1).await.len(), 0);
        let change = json!([{ "range": range([0, column], [0, column]), "text": "\n" }]);
        editor.change(URI, 2, change).await;
        let found = editor.diagnostics(URI, 2).await;
        assert_eq!(found[0]["range"], range([1, 14], [1, 15]), "{agreed}");
        // And back: the whole first line goes, whatever its length is called.
        let change = json!([{ "range": range([0, 0], [1, 0]), "text": "" }]);
        editor.change(URI, 3, change).await;
        let found = editor.diagnostics(URI, 3).await;
        assert_eq!(found[0]["range"], range([0, 14], [0, 15]), "{agreed}");
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn diagnostics_are_versioned_and_point_at_the_definition() {
    for place in PLACES {
        let mut editor = started(place, "diagnostics").await;
        editor.open(URI, "define a = 1;\ndefine a = 2;").await;
        let found = editor.diagnostics(URI, 1).await;
        assert_eq!(found.len(), 1);
        assert_eq!(found[0]["code"], "name-taken");
        assert_eq!(found[0]["source"], "geotrace");
        let related = &found[0]["relatedInformation"][0];
        assert_eq!(
            related["location"],
            json!({ "uri": URI, "range": range([0, 7], [0, 8]) })
        );

        // An editor that asks receives none unasked.
        let params = json!({ "textDocument": document() });
        let report = editor.ask("textDocument/diagnostic", params).await;
        assert_eq!(report["kind"], "full");
        assert_eq!(report["items"].as_array().map(Vec::len), Some(1));
        let emptied = editor
            .notified("textDocument/publishDiagnostics", |_| true)
            .await;
        assert_eq!(emptied["diagnostics"], json!([]));
        let params = json!({ "textDocument": document(), "previousResultId": report["resultId"] });
        let same = editor.ask("textDocument/diagnostic", params).await;
        assert_eq!(same["kind"], "unchanged");
        editor
            .change(URI, 2, json!([{ "text": "define a = 1;" }]))
            .await;
        let params = json!({ "textDocument": document(), "previousResultId": report["resultId"] });
        let report = editor.ask("textDocument/diagnostic", params).await;
        assert_eq!(
            (&report["kind"], &report["items"]),
            (&json!("full"), &json!([]))
        );

        // A document that is closed leaves nothing behind.
        editor
            .notify(
                "textDocument/didClose",
                json!({ "textDocument": document() }),
            )
            .await;
        let gone = editor.fail("textDocument/hover", at(0, 0)).await;
        assert_eq!(gone["code"], -32602);
        assert_eq!(editor.quit().await, 0);
    }
}

#[tokio::test]
async fn edits_out_of_range_and_the_wrong_way_round_are_taken_for_the_nearest_that_make_sense() {
    let mut editor = started(Place::Here, "edits").await;
    editor.open(URI, "define a = 1;").await;
    let changes = json!([
        { "range": range([9, 9], [99, 99]), "text": "\ndefine b = 2;" },
        { "range": range([1, 8], [1, 7]), "text": "c" },
        { "range": range([0, 4_000_000_000], [0, 4_000_000_000]), "text": " # end" },
    ]);
    editor.change(URI, 2, changes).await;
    editor.diagnostics(URI, 2).await;
    let symbols = editor
        .ask(
            "textDocument/documentSymbol",
            json!({ "textDocument": document() }),
        )
        .await;
    assert_eq!(symbols[1]["name"], "c");
    assert_eq!(symbols[1]["range"], range([1, 0], [1, 13]));
    // A change of what is not open is no one's fault.
    editor
        .change("file:///other.gtr", 7, json!([{ "text": "x" }]))
        .await;
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn tokens_that_are_sent_as_differences_are_the_tokens() {
    let mut editor = started(Place::Here, "tokens").await;
    editor.open(URI, PROGRAM).await;
    let full = |document: Value| json!({ "textDocument": document });
    let first = editor
        .ask("textDocument/semanticTokens/full", full(document()))
        .await;
    let numbers = |value: &Value| -> Vec<i64> {
        value
            .as_array()
            .expect("numbers")
            .iter()
            .map(|n| n.as_i64().expect("a number"))
            .collect()
    };
    let mut data = numbers(&first["data"]);
    let mut name = first["resultId"].clone();
    let edits = [
        "define z = 1;\n",
        "x",
        "# c\n",
        " ",
        "function g(t) = t;\n",
        "\n\n",
        ";",
        "2pi",
    ];
    for (k, text) in edits.into_iter().cycle().take(40).enumerate() {
        let line = (7 * k as u32) % 6;
        let version = k as i64 + 2;
        let change = json!([{ "range": range([line, 0], [line, (k % 3) as u32]), "text": text }]);
        editor.change(URI, version, change).await;
        let params = json!({ "textDocument": document(), "previousResultId": name });
        let delta = editor
            .ask("textDocument/semanticTokens/full/delta", params)
            .await;
        for edit in delta["edits"].as_array().expect("edits") {
            let start = edit["start"].as_u64().expect("a start") as usize;
            let gone = edit["deleteCount"].as_u64().expect("a count") as usize;
            data.splice(start..start + gone, numbers(&edit["data"]));
        }
        let now = editor
            .ask("textDocument/semanticTokens/full", full(document()))
            .await;
        assert_eq!(data, numbers(&now["data"]), "after edit {k}");
        name = now["resultId"].clone();
    }
    // A name that is not the last one sent gets everything.
    let params = json!({ "textDocument": document(), "previousResultId": "never" });
    let all = editor
        .ask("textDocument/semanticTokens/full/delta", params)
        .await;
    assert!(all.get("data").is_some());
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn a_name_that_cannot_be_is_refused_with_the_reason() {
    let mut editor = started(Place::Here, "rename").await;
    editor.open(URI, PROGRAM).await;
    let mut params = at(1, 6);
    params["newName"] = json!("sin");
    let error = editor.fail("textDocument/rename", params).await;
    assert_eq!(error["code"], -32803);
    assert_eq!(error["message"], "`sin` is the name of a builtin");
    let error = editor.fail("textDocument/prepareRename", at(6, 22)).await;
    assert!(
        error["message"]
            .as_str()
            .is_some_and(|m| m.contains("builtin")),
        "{error}"
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn mistakes_come_with_their_fixes() {
    let mut editor = started(Place::Here, "fixes").await;
    editor.open(URI, "define a = coss 1;").await;
    let found = editor.diagnostics(URI, 1).await;
    let params = json!({
        "textDocument": document(),
        "range": found[0]["range"],
        "context": { "diagnostics": found },
    });
    let actions = editor.ask("textDocument/codeAction", params.clone()).await;
    assert_eq!(actions[0]["title"], "Change to `cos`");
    let edit = &actions[0]["edit"]["documentChanges"][0]["edits"][0];
    assert_eq!(
        edit,
        &json!({ "range": range([0, 11], [0, 15]), "newText": "cos" })
    );
    let mut params = params;
    params["context"]["only"] = json!(["source"]);
    let all = editor.ask("textDocument/codeAction", params.clone()).await;
    assert_eq!(all, json!([]));
    params["context"]["only"] = json!(["refactor"]);
    assert_eq!(
        editor.ask("textDocument/codeAction", params).await,
        json!([])
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn all_certain_fixes_are_one_action() {
    let mut editor = started(Place::Here, "fix-all").await;
    editor.open(URI, "define a = ln 2 + arctan 1").await;
    editor.diagnostics(URI, 1).await;
    let params = json!({
        "textDocument": document(),
        "range": range([0, 0], [0, 0]),
        "context": { "diagnostics": [], "only": ["source.fixAll"] },
    });
    let actions = editor.ask("textDocument/codeAction", params).await;
    assert_eq!(actions[0]["title"], "Fix all (3 places)");
    assert_eq!(actions[0]["kind"], "source.fixAll");
    assert_eq!(
        actions[0]["edit"]["documentChanges"][0]["edits"],
        json!([
            { "range": range([0, 11], [0, 13]), "newText": "log" },
            { "range": range([0, 18], [0, 24]), "newText": "atan" },
            { "range": range([0, 26], [0, 26]), "newText": ";" },
        ])
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn settings_are_heeded() {
    let mut editor = Editor::start(Place::Here, "settings");
    editor.settings = json!({ "codeLens": false });
    editor.initialize(capabilities(&["utf-16"])).await;
    editor.open(URI, PROGRAM).await;
    editor.diagnostics(URI, 1).await;
    let lenses = json!({ "textDocument": document() });
    // The settings were asked for after the handshake; they come when they come.
    for _ in 0..1000 {
        if editor.ask("textDocument/codeLens", lenses.clone()).await == json!([]) {
            break;
        }
    }
    assert_eq!(
        editor.ask("textDocument/codeLens", lenses.clone()).await,
        json!([])
    );
    editor
        .notify(
            "workspace/didChangeConfiguration",
            json!({ "settings": { "geotrace": { "codeLens": true } } }),
        )
        .await;
    assert_eq!(
        editor
            .ask("textDocument/codeLens", lenses)
            .await
            .as_array()
            .map(Vec::len),
        Some(2)
    );
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn settings_that_are_not_sent_are_asked_for() {
    let mut editor = Editor::start(Place::Here, "settings-asked");
    editor.initialize(capabilities(&["utf-16"])).await;
    editor.asked("workspace/configuration").await;
    for settings in [Value::Null, json!({})] {
        let changed = json!({ "settings": settings });
        editor
            .notify("workspace/didChangeConfiguration", changed)
            .await;
        editor.asked("workspace/configuration").await;
    }
    assert_eq!(editor.quit().await, 0);
}

#[tokio::test]
async fn an_editor_is_sent_what_it_knows() {
    let text = "function f(x, y) = x y;\ndefine a = 1\ndefine b = f(a, a);\ndefine b = 2;\n";
    for knows in [false, true] {
        let mut editor = Editor::start(Place::Here, "what-it-knows");
        let capabilities = match knows {
            false => json!({}),
            true => json!({ "textDocument": {
                "rename": { "prepareSupport": true },
                "codeAction": { "isPreferredSupport": true },
                "signatureHelp": {
                    "signatureInformation": { "parameterInformation": { "labelOffsetSupport": true } },
                },
                "publishDiagnostics": { "relatedInformation": true },
            } }),
        };
        let answer = editor.initialize(capabilities).await;
        let renames = &answer["capabilities"]["renameProvider"];
        assert_eq!(*renames == json!(true), !knows, "{renames}");
        editor.open(URI, text).await;
        let found = editor.diagnostics(URI, 1).await;
        let has_places = found.iter().any(|it| !it["relatedInformation"].is_null());
        assert_eq!(has_places, knows, "{found:?}");
        let help = editor.ask("textDocument/signatureHelp", at(2, 13)).await;
        let label = &help["signatures"][0]["parameters"][0]["label"];
        let expected = if knows { json!([2, 3]) } else { json!("x") };
        assert_eq!(*label, expected);
        let params = json!({
            "textDocument": document(),
            "range": range([0, 0], [4, 0]),
            "context": { "diagnostics": [] },
        });
        let actions = editor.ask("textDocument/codeAction", params).await;
        let actions = actions.as_array().expect("a list");
        let is_marked = actions.iter().any(|it| it["isPreferred"] == true);
        assert!(!actions.is_empty());
        assert_eq!(is_marked, knows, "{actions:?}");
        assert_eq!(editor.quit().await, 0);
    }
}
