//! The life of a session: the editor's capabilities, the server's, and the end.

use std::path::PathBuf;

use tower_lsp::jsonrpc::Result;
use tower_lsp::ls_types as lsp;

use super::workspace::set;
use super::{Backend, window};
use crate::encoding::Encoding;
use crate::session::Editor;
use crate::tasks;
use crate::to_lsp;

pub(super) async fn initialize(
    server: &Backend,
    params: lsp::InitializeParams,
) -> Result<lsp::InitializeResult> {
    let encoding = encoding(&params.capabilities);
    let editor = editor(&params.capabilities);
    {
        let mut session = server.session();
        session.editor = editor;
        session.documents.encoding = encoding;
        if let Some(options) = &params.initialization_options {
            session.settings = session.settings.with(options);
        }
        session.folders = folders(&params);
    }
    if let Some(process) = params.process_id {
        let end = server.end.clone();
        crate::platform::when_process_ends(process, move || end.now());
    }
    Ok(lsp::InitializeResult {
        capabilities: to_lsp::capabilities(encoding, editor),
        server_info: Some(lsp::ServerInfo {
            name: "geotrace".to_owned(),
            version: Some(env!("CARGO_PKG_VERSION").to_owned()),
        }),
        ..lsp::InitializeResult::default()
    })
}

/// Returns the folders of the workspace, or the root if the editor does not support folders.
fn folders(params: &lsp::InitializeParams) -> Vec<PathBuf> {
    let path = |uri: &lsp::Uri| uri.to_file_path().map(|path| path.into_owned());
    #[allow(deprecated)]
    let root = params.root_uri.as_ref();
    match &params.workspace_folders {
        Some(folders) => folders.iter().filter_map(|it| path(&it.uri)).collect(),
        None => root.and_then(path).into_iter().collect(),
    }
}

pub(super) async fn initialized(server: &Backend, _: lsp::InitializedParams) {
    request_settings(server);
}

/// Requests the user's settings from the editor, if it answers such requests.
pub(super) fn request_settings(server: &Backend) {
    if server.session().editor.configuration {
        let (client, session) = (server.client.clone(), server.session.clone());
        tasks::spawn(async move {
            let item = lsp::ConfigurationItem {
                scope_uri: None,
                section: Some("geotrace".to_owned()),
            };
            if let Ok(answers) = client.configuration(vec![item]).await
                && let Some(settings) = answers.first()
            {
                set(&session, &client, settings);
            }
        });
    }
}

pub(super) async fn shutdown(server: &Backend) -> Result<()> {
    server.end.was_asked_for();
    window::close_all(&server.session).await;
    Ok(())
}

/// Returns the capabilities of the editor.
fn editor(capabilities: &lsp::ClientCapabilities) -> Editor {
    let text = capabilities.text_document.as_ref();
    let workspace = capabilities.workspace.as_ref();
    let markdown = |formats: Option<&Vec<lsp::MarkupKind>>| {
        formats.is_some_and(|formats| formats.contains(&lsp::MarkupKind::Markdown))
    };
    let completion = text
        .and_then(|text| text.completion.as_ref())
        .and_then(|completion| completion.completion_item.as_ref());
    let hover = text.and_then(|text| text.hover.as_ref());
    let symbols = text.and_then(|text| text.document_symbol.as_ref());
    let edit = workspace.and_then(|workspace| workspace.workspace_edit.as_ref());
    let signatures = text
        .and_then(|text| text.signature_help.as_ref()?.signature_information.as_ref())
        .and_then(|signature| signature.parameter_information.as_ref());
    let actions = text.and_then(|text| text.code_action.as_ref());
    let rename = text.and_then(|text| text.rename.as_ref());
    let diagnostics = text.and_then(|text| text.publish_diagnostics.as_ref());
    let hints = workspace.and_then(|workspace| workspace.inlay_hint.as_ref());
    let lenses = workspace.and_then(|workspace| workspace.code_lens.as_ref());
    let window = capabilities.window.as_ref();
    let experimental = capabilities.experimental.as_ref();
    Editor {
        markdown: markdown(hover.and_then(|hover| hover.content_format.as_ref())),
        documentation: completion
            .and_then(|c| c.documentation_format.as_ref())
            .map(|formats| formats.contains(&lsp::MarkupKind::Markdown)),
        snippets: completion.and_then(|c| c.snippet_support).unwrap_or(false),
        // File operations are part of the list of changes: an editor that supports them supports that list too, though
        // Neovim does not declare it.
        creates_files: edit.is_some_and(|edit| {
            let mut operations = edit.resource_operations.iter().flatten();
            operations.any(|it| *it == lsp::ResourceOperationKind::Create)
        }),
        versioned_edits: edit.and_then(|edit| edit.document_changes).unwrap_or(false),
        label_offsets: signatures
            .and_then(|it| it.label_offset_support)
            .unwrap_or(false),
        preferred_actions: actions
            .and_then(|it| it.is_preferred_support)
            .unwrap_or(false),
        prepares_rename: rename.and_then(|it| it.prepare_support).unwrap_or(false),
        related_places: diagnostics
            .and_then(|it| it.related_information)
            .unwrap_or(false),
        configuration: workspace.and_then(|w| w.configuration).unwrap_or(false),
        hierarchical_symbols: symbols
            .and_then(|symbols| symbols.hierarchical_document_symbol_support)
            .unwrap_or(false),
        refreshes_hints: hints.and_then(|h| h.refresh_support).unwrap_or(false),
        refreshes_lenses: lenses.and_then(|l| l.refresh_support).unwrap_or(false),
        shows_documents: window
            .and_then(|window| window.show_document.as_ref())
            .is_some_and(|show| show.support),
        applies_edits: workspace.and_then(|w| w.apply_edit).unwrap_or(false),
        wants_shown: experimental
            .and_then(|own| own.get("geotrace")?.get("shown")?.as_bool())
            .unwrap_or(false),
    }
}

/// Returns the encoding of positions: the editor's preferred one, which is the first that it offers.
fn encoding(capabilities: &lsp::ClientCapabilities) -> Encoding {
    let offered = capabilities
        .general
        .as_ref()
        .and_then(|general| general.position_encodings.as_ref());
    let known = |kind: &lsp::PositionEncodingKind| match kind.as_str() {
        "utf-8" => Some(Encoding::Utf8),
        "utf-16" => Some(Encoding::Utf16),
        "utf-32" => Some(Encoding::Utf32),
        _ => None,
    };
    offered
        .and_then(|offered| offered.iter().find_map(known))
        .unwrap_or_default()
}
