//! Programs whose runs take long keep nobody waiting who needs no run.

use std::sync::{Arc, Condvar, Mutex};

use ide::Languages;
use ide::language::{Analysis, EditError, Language, Program};
use ide::text::{PlainText, Text};
use scene::ProgramScene;
use serde_json::json;
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;
use testing::editor::{Editor, Place};
use testing::talk::{at, range};

/// A language whose programs run until they are released.
#[derive(Clone, Debug, Default)]
struct Endless(Arc<(Mutex<bool>, Condvar)>);

#[derive(Clone, Debug)]
struct EndlessProgram {
    text: PlainText,
    language: Endless,
}

impl Endless {
    fn release(&self) {
        *self.0.0.lock().expect("not poisoned") = true;
        self.0.1.notify_all();
    }

    fn is_released(&self) -> bool {
        *self.0.0.lock().expect("not poisoned")
    }

    fn run(&self) {
        let released = self.0.0.lock().expect("not poisoned");
        let released = self.0.1.wait_while(released, |released| !*released);
        drop(released.expect("not poisoned"));
    }
}

impl Language for Endless {
    fn name(&self) -> &'static str {
        "endless"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["endless"]
    }

    fn open(&self, text: &str) -> Result<Box<dyn Program>, EditError> {
        let mut program = EndlessProgram {
            text: PlainText::default(),
            language: self.clone(),
        };
        program.edit(Span::new(0, 0), text)?;
        Ok(Box::new(program))
    }
}

impl Program for EndlessProgram {
    fn text(&self) -> &dyn Text {
        &self.text
    }

    fn edit(&mut self, range: Span, text: &str) -> Result<(), EditError> {
        self.text.edit(range, text)
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        self.language.run();
        Arc::default()
    }

    fn diagnostics_of_reading(&self) -> Option<Arc<[Diagnostic]>> {
        self.awaits_run().then(Arc::default)
    }

    fn scene(&self) -> ProgramScene {
        ProgramScene::default()
    }

    fn snapshot(&self) -> Arc<dyn Analysis> {
        Arc::new(self.clone())
    }
}

impl Analysis for EndlessProgram {
    fn text(&self) -> &dyn Text {
        &self.text
    }

    fn diagnostics(&self) -> Arc<[Diagnostic]> {
        Program::diagnostics(self)
    }

    fn awaits_run(&self) -> bool {
        !self.language.is_released()
    }
}

#[tokio::test]
async fn other_documents_and_the_text_of_the_same_one_are_read_meanwhile() {
    let language = Endless::default();
    let languages = Languages::standard().with(language.clone());
    let mut editor = Editor::start_for(Place::Here, "long-runs", languages, None);
    editor.initialize(json!({})).await;
    let mut fixes = Vec::new();
    for name in ["a", "b", "c", "d"] {
        let uri = format!("file:///{name}.endless");
        editor.open(&uri, "x").await;
        let document = json!({ "uri": uri });
        let params = json!({ "textDocument": document, "range": range([0, 0], [0, 1]), "context": { "diagnostics": [] } });
        fixes.push(editor.post("textDocument/codeAction", params).await);
        let symbols = json!({ "textDocument": document });
        editor.ask("textDocument/documentSymbol", symbols).await;
    }
    let uri = "file:///e.gtr";
    editor.open(uri, "define a = 1;").await;
    let mut place = at(0, 7);
    place["textDocument"] = json!({ "uri": uri });
    let hover = editor.ask("textDocument/hover", place).await;
    assert!(hover.is_object(), "{hover}");
    language.release();
    for id in fixes {
        assert_eq!(editor.answer(id).await, Ok(json!([])));
    }
    assert_eq!(editor.quit().await, 0);
}
