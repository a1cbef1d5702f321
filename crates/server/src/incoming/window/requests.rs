//! Requests of a window to the editor: to show a declaration, to write a value into the text.

use std::sync::Arc;
use std::time::Duration;

use ide::Analysis;
use ide::edit::Edit;
use syntax::span::Span;
use tokio::sync::mpsc::Receiver;
use tokio::time::timeout;
use tower_lsp::ls_types as lsp;

use super::{PreviewWindow, lock, name};
use crate::documents::{Open, Snapshot};
use crate::tasks;
use crate::to_lsp;

/// The maximum time for one request to the editor; then the next one is sent.
const EDITOR_TIMEOUT: Duration = Duration::from_secs(30);

/// A request to the editor.
#[derive(Debug)]
pub(super) enum WindowRequest {
    /// To show a declaration: its range in the text of a version.
    Open { version: i32, range: [u32; 2] },
    /// To write a param's value into the text.
    Write { param: String, value: Vec<f64> },
    /// To write a camera into the text.
    WriteCamera {
        name: String,
        direction: [f64; 3],
        position: [f64; 3],
        fov: f64,
    },
    /// To write the colour of an object into the text.
    WriteColour { object: String, colour: [f64; 3] },
}

/// Sends the requests of a window to the editor, one after the other.
pub(super) async fn run_all(window: Arc<PreviewWindow>, mut requests: Receiver<WindowRequest>) {
    while let Some(request) = requests.recv().await {
        let done = async {
            match request {
                WindowRequest::Open { version, range } => {
                    window.show_declaration(version, range).await
                }
                WindowRequest::Write { param, value } => window.write_value(param, value).await,
                WindowRequest::WriteCamera {
                    name,
                    direction,
                    position,
                    fov,
                } => window.write_camera(name, direction, position, fov).await,
                WindowRequest::WriteColour { object, colour } => {
                    window.write_colour(object, colour).await
                }
            }
        };
        // An editor may ask its user first, but other requests do not wait forever.
        let _ = timeout(EDITOR_TIMEOUT, done).await;
    }
}

impl PreviewWindow {
    async fn show_declaration(&self, version: i32, range: [u32; 2]) {
        let (snapshot, span, can) = {
            let mut session = lock(&self.session);
            let can = session.editor.shows_documents;
            let uri = self.uri.as_str();
            let Some(snapshot) = session.documents.get(uri).map(Open::snapshot) else {
                return;
            };
            let [start, end] = range;
            let range = [start.min(end), start.max(end)];
            // In an unknown version no range can be located; the document is shown all the same.
            let preview = session.previews.of(uri, self.id);
            let moved = preview.and_then(|preview| preview.sent.moved(version, range));
            (
                snapshot,
                moved.map(|[start, end]| Span::new(start, end)),
                can,
            )
        };
        let selection = span.map(|span| to_lsp::range(&*snapshot, span));
        if !can {
            let place = selection.map_or_else(String::new, |range| {
                let start = range.start;
                format!(", line {}, column {}", start.line + 1, start.character + 1)
            });
            let message = format!("{}{place}", name(&self.uri));
            self.show_message(lsp::MessageType::INFO, message).await;
            return;
        }
        let params = lsp::ShowDocumentParams {
            uri: self.uri.clone(),
            external: None,
            take_focus: Some(true),
            selection,
        };
        if let Ok(false) | Err(_) = self.client.show_document(params).await {
            let message = format!("The editor cannot show {}.", name(&self.uri));
            self.show_message(lsp::MessageType::WARNING, message).await;
        }
    }

    async fn write_value(&self, param: String, value: Vec<f64>) {
        let label = format!("Set {param}");
        let subject = format!("The value of `{param}`");
        let make = move |analysis: &dyn Analysis| {
            let edit = analysis.edit_param(&param, &value);
            edit.map_err(|refusal| refusal.to_string())
        };
        self.write(label, subject, make).await;
    }

    async fn write_camera(
        &self,
        camera: String,
        direction: [f64; 3],
        position: [f64; 3],
        fov: f64,
    ) {
        let subject = format!("The camera `{camera}`");
        let make = move |analysis: &dyn Analysis| {
            let edit = analysis.edit_camera(&camera, direction, position, fov);
            edit.map_err(|refusal| refusal.to_string())
        };
        self.write("Write camera".to_owned(), subject, make).await;
    }

    async fn write_colour(&self, object: String, colour: [f64; 3]) {
        let subject = format!("The colour of `{object}`");
        let make = move |analysis: &dyn Analysis| {
            let edit = analysis.edit_colour(&object, colour);
            edit.map_err(|refusal| refusal.to_string())
        };
        self.write("Change a colour".to_owned(), subject, make)
            .await;
    }

    /// Requests an edit from the editor, and tells the user if it was not made. `subject` begins that sentence.
    async fn write(
        &self,
        label: String,
        subject: String,
        make: impl Fn(&dyn Analysis) -> Result<Edit, String> + Clone + Send + 'static,
    ) {
        if let Err(reason) = self.try_to_write(label, make).await {
            let message = format!(
                "{subject} was not written into {}: {reason}",
                name(&self.uri)
            );
            self.show_message(lsp::MessageType::WARNING, message).await;
        }
    }

    async fn try_to_write(
        &self,
        label: String,
        make: impl Fn(&dyn Analysis) -> Result<Edit, String> + Clone + Send + 'static,
    ) -> Result<(), String> {
        let editor = lock(&self.session).editor;
        if !editor.applies_edits {
            return Err("this editor does not accept edits from its language server".to_owned());
        }
        let mut reason = None;
        // The user may have typed meanwhile: then the edit is made once more, in the current text.
        for _ in 0..2 {
            let Some(snapshot) = self.snapshot() else {
                return Err("it is no longer open".to_owned());
            };
            let edit = {
                let (snapshot, make) = (snapshot.clone(), make.clone());
                let write = move || make(snapshot.analysis());
                let made = tasks::work(write).await;
                made.map_err(|_| "a fault of the server".to_owned())??
            };
            if snapshot.text().slice(edit.span).as_ref() == Some(&edit.text) {
                return Ok(());
            }
            let edit =
                to_lsp::workspace_edit(&snapshot, &self.uri, &[edit], editor.versioned_edits);
            let params = lsp::ApplyWorkspaceEditParams {
                label: Some(label.clone()),
                edit,
            };
            let asked = self
                .client
                .send_request::<lsp::request::ApplyWorkspaceEdit>(params);
            match asked.await {
                Ok(answer) if answer.applied => return Ok(()),
                Ok(answer) => reason = answer.failure_reason,
                Err(error) => reason = Some(error.message.into_owned()),
            }
            if self
                .snapshot()
                .is_some_and(|now| now.version == snapshot.version)
            {
                break;
            }
        }
        Err(reason.unwrap_or_else(|| "the editor rejected the edit".to_owned()))
    }

    async fn show_message(&self, kind: lsp::MessageType, message: String) {
        self.client.show_message(kind, message).await;
    }

    /// Returns a snapshot of the document, if it is still open.
    fn snapshot(&self) -> Option<Arc<Snapshot>> {
        let session = lock(&self.session);
        session.documents.get(self.uri.as_str()).map(Open::snapshot)
    }
}
