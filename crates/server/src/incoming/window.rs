//! A preview window, from its start to its end: its events become requests to the editor.
//!
//! One task receives the events of each window. It never waits for the editor: a second task sends the requests to it,
//! one after the other.

mod requests;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use protocol::{Event, ViewName, handshake};
use tokio::sync::mpsc::{self, Receiver};
use tokio::time::{Instant, sleep_until, timeout};
use tower_lsp::Client;
use tower_lsp::ls_types as lsp;

use crate::documents::Open;
use crate::preview::{Gone, Left, Process, Started, WindowOutput};
use crate::session::Session;
use crate::tasks;
use requests::{WindowRequest, run_all};

/// The time within which windows must have received the command to close when the editor quits.
const SHUTDOWN_TIMEOUT: Duration = Duration::from_millis(500);
/// The time that a window may take to close after the command.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(5);
/// The maximum number of waiting requests: a user does not click faster than an editor responds.
const MOST_WAITING: usize = 16;
/// Hints follow the sliders, but are refreshed at most once in this time.
const HINTS_EVERY: Duration = Duration::from_millis(200);

/// Opens a document's preview, or brings it to the front.
pub(super) fn open(
    session: &Arc<Mutex<Session>>,
    client: &Client,
    uri: &lsp::Uri,
    view: Option<ViewName>,
) {
    let opened = start(&mut lock(session), uri, view);
    let client = client.clone();
    match opened {
        Ok(None) => {}
        Ok(Some((started, version_timeout))) => {
            let Started {
                id,
                process,
                outputs,
            } = started;
            let window = Arc::new(PreviewWindow {
                uri: uri.clone(),
                id,
                process,
                client,
                session: session.clone(),
            });
            tasks::spawn(run(window, outputs, version_timeout));
        }
        // Handlers never wait for requests and notifications to the editor.
        Err((kind, message)) => {
            tasks::spawn(async move { client.show_message(kind, message).await });
        }
    }
}

/// Closes the window of a closed document after a delay, unless the document has been opened again.
pub(super) fn close_later(session: &Arc<Mutex<Session>>, uri: &lsp::Uri, left: Left) {
    let program = lock(session).window.clone();
    let close_delay = program.map_or(Duration::ZERO, |program| program.close_delay);
    let (session, uri) = (session.clone(), uri.clone());
    tasks::spawn(async move {
        tokio::time::sleep(close_delay).await;
        lock(&session).previews.close(uri.as_str(), left);
    });
}

/// Sends the command to close to all windows, and kills those that have not received it in time.
pub(crate) async fn close_all(session: &Arc<Mutex<Session>>) {
    let all = lock(session).previews.close_all();
    if all.is_empty() {
        // A browser has no windows, and no clock for the deadline.
        return;
    }
    let deadline = Instant::now() + SHUTDOWN_TIMEOUT;
    for process in all {
        let written = tokio::time::timeout_at(deadline, process.all_written()).await;
        if written.is_err() {
            process.kill();
        }
    }
}

struct PreviewWindow {
    uri: lsp::Uri,
    id: u64,
    process: Arc<Process>,
    client: Client,
    session: Arc<Mutex<Session>>,
}

/// The notification of each shown picture, for editors that support it: `geotrace/shown`.
enum Shown {}

#[derive(serde::Deserialize, serde::Serialize)]
struct ShownParams {
    uri: lsp::Uri,
    version: i32,
    ok: bool,
    milliseconds: f64,
    painting: f64,
}

impl lsp::notification::Notification for Shown {
    type Params = ShownParams;
    const METHOD: &'static str = "geotrace/shown";
}

fn lock(session: &Mutex<Session>) -> MutexGuard<'_, Session> {
    session.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the document's name for the user.
fn name(uri: &lsp::Uri) -> String {
    let path = uri.to_file_path();
    let name = path.as_ref().and_then(|path| path.file_name());
    name.map_or_else(
        || uri.as_str().to_owned(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// Starts a window. Returns it with its `version_timeout`; `None` if there already is one.
fn start(
    session: &mut Session,
    uri: &lsp::Uri,
    view: Option<ViewName>,
) -> Result<Option<(Started, Duration)>, (lsp::MessageType, String)> {
    let Some(snapshot) = session.documents.get(uri.as_str()).map(Open::snapshot) else {
        let message = format!(
            "The preview shows open documents: open {} first.",
            name(uri)
        );
        return Err((lsp::MessageType::ERROR, message));
    };
    if session.previews.show(uri.as_str(), view.as_ref()) {
        return Ok(None);
    }
    let Some(program) = session.window.clone() else {
        let inside = match &view {
            Some(ViewName {
                view,
                surface: Some(surface),
            }) => format!(" --view {view}:{surface}"),
            Some(other) if *other != ViewName::default() => format!(" --view {}", other.view),
            _ => String::new(),
        };
        let file = name(uri);
        let message = format!(
            "This build of geotrace has no preview window: `cargo install --locked --path crates/cli` builds one with it. \
             `geotrace render {file} -o picture.png{inside}` draws a picture."
        );
        return Err((lsp::MessageType::INFO, message));
    };
    let path = uri
        .as_str()
        .starts_with("file:")
        .then(|| uri.to_file_path());
    let path = path
        .flatten()
        .and_then(|path| path.to_str().map(str::to_owned));
    let cursor = session.cursors.get(uri.as_str());
    let cursor = cursor.map(|place| snapshot.offset(*place));
    let started = session
        .previews
        .start(&program, &snapshot, path, view, cursor);
    match started {
        Ok(started) => Ok(Some((started, program.version_timeout))),
        Err(error) => {
            let program = program.program.display();
            let message = format!("The preview window, {program}, cannot be started: {error}");
            Err((lsp::MessageType::ERROR, message))
        }
    }
}

/// Handles the events of a window until it has ended.
async fn run(
    window: Arc<PreviewWindow>,
    mut outputs: Receiver<WindowOutput>,
    version_timeout: Duration,
) {
    match timeout(version_timeout, window.greeted(&mut outputs)).await {
        Ok(Ok(())) => {}
        Ok(Err(None)) => return,
        Ok(Err(Some(message))) => {
            window.give_up(message).await;
            return;
        }
        Err(_) => {
            let message = format!(
                "The preview window of {} has not answered for {} seconds and has been ended. The command opens it again.",
                name(&window.uri),
                version_timeout.as_secs_f64(),
            );
            window.give_up(message).await;
            return;
        }
    }
    let (requests, to_ask) = mpsc::channel(MOST_WAITING);
    tasks::spawn(run_all(window.clone(), to_ask));
    let mut hints: Option<Instant> = None;
    let mut last_hints: Option<Instant> = None;
    let mut deadline: Option<Instant> = None;
    let at = |time: Option<Instant>| sleep_until(time.unwrap_or_else(Instant::now));
    loop {
        let output = tokio::select! {
            output = outputs.recv() => output,
            () = window.process.closing(), if deadline.is_none() => {
                deadline = Some(Instant::now() + CLOSE_TIMEOUT);
                continue;
            }
            () = at(deadline), if deadline.is_some() => {
                window.process.kill();
                deadline = Some(Instant::now() + CLOSE_TIMEOUT);
                continue;
            }
            () = at(hints), if hints.is_some() => {
                hints = None;
                last_hints = Some(Instant::now());
                window.refresh_hints();
                continue;
            }
        };
        match output {
            Some(WindowOutput::Event(event)) => {
                if window.take_event(event, &requests).await && hints.is_none() {
                    let now = Instant::now();
                    hints = Some(last_hints.map_or(now, |last| now.max(last + HINTS_EVERY)));
                }
            }
            Some(WindowOutput::Line(line)) => window.log(line).await,
            Some(WindowOutput::NotSent(message)) => {
                let message = format!("{}: {message}", name(&window.uri));
                window
                    .client
                    .show_message(lsp::MessageType::ERROR, message)
                    .await;
            }
            Some(WindowOutput::Gone(gone)) => {
                if hints.is_some() {
                    window.refresh_hints();
                }
                window.gone(gone, true).await;
                return;
            }
            None => return,
        }
    }
}

impl PreviewWindow {
    /// Waits for the window's version. The error is a message for the user, if there is one.
    async fn greeted(&self, outputs: &mut Receiver<WindowOutput>) -> Result<(), Option<String>> {
        loop {
            match outputs.recv().await {
                Some(WindowOutput::Line(line)) => self.log(line).await,
                Some(WindowOutput::Event(event)) => {
                    return handshake::check(&event).map_err(|error| Some(error.to_string()));
                }
                Some(WindowOutput::NotSent(message)) => return Err(Some(message)),
                Some(WindowOutput::Gone(gone)) => {
                    self.gone(gone, false).await;
                    return Err(None);
                }
                None => return Err(None),
            }
        }
    }

    /// Ends a window whose messages cannot be understood.
    async fn give_up(&self, message: String) {
        let known = lock(&self.session)
            .previews
            .forget(self.uri.as_str(), self.id);
        self.process.kill();
        // If it was closed meanwhile, the user needs no message.
        if known.is_some() {
            self.client
                .show_message(lsp::MessageType::ERROR, message)
                .await;
        }
    }

    /// Removes a window that has ended. If its end was not requested, the user gets a message. A window that has never
    /// sent a greeting gets one whatever its exit status, without the hope that another one may.
    async fn gone(&self, gone: Gone, greeted: bool) {
        let known = lock(&self.session)
            .previews
            .forget(self.uri.as_str(), self.id);
        let Some(preview) = known else {
            return;
        };
        if !preview.live.is_empty() {
            self.refresh_hints();
        }
        if gone.clean && greeted {
            return;
        }
        let because = gone.reason.map(|reason| format!(": {reason}"));
        let message = format!(
            "The preview window of {} has ended ({}){}{}",
            name(&self.uri),
            gone.status,
            because.map_or_else(
                || ".".to_owned(),
                |because| {
                    let end = if because.ends_with(['.', '!', '?']) {
                        ""
                    } else {
                        "."
                    };
                    because + end
                }
            ),
            if greeted {
                " The command opens it again."
            } else {
                ""
            },
        );
        self.client
            .show_message(lsp::MessageType::ERROR, message)
            .await;
    }

    async fn log(&self, line: String) {
        let message = format!("preview of {}: {line}", name(&self.uri));
        self.client
            .log_message(lsp::MessageType::LOG, message)
            .await;
    }

    /// Takes what the window says; whether the hints have changed.
    async fn take_event(&self, event: Event, requests: &mpsc::Sender<WindowRequest>) -> bool {
        match event {
            Event::Shown {
                version,
                ok,
                milliseconds,
                painting,
            } => {
                let shown = {
                    let mut session = lock(&self.session);
                    let uri = self.uri.as_str();
                    let version = session.previews.shown(uri, self.id, version, ok);
                    version.filter(|_| session.editor.wants_shown)
                };
                if let Some(version) = shown {
                    let uri = self.uri.clone();
                    let params = ShownParams {
                        uri,
                        version,
                        ok,
                        milliseconds,
                        painting,
                    };
                    self.client.send_notification::<Shown>(params).await;
                }
            }
            Event::Open { version, range } => {
                // Requests beyond the limit are dropped.
                let _ = requests.try_send(WindowRequest::Open { version, range });
            }
            Event::Write { param, value, .. } => {
                let _ = requests.try_send(WindowRequest::Write { param, value });
            }
            Event::WriteCamera {
                name,
                direction,
                position,
                fov,
                ..
            } => {
                let _ = requests.try_send(WindowRequest::WriteCamera {
                    name,
                    direction,
                    position,
                    fov,
                });
            }
            Event::WriteColour { object, colour, .. } => {
                let _ = requests.try_send(WindowRequest::WriteColour { object, colour });
            }
            Event::Values { values, .. } => {
                let mut session = lock(&self.session);
                let shown = session.settings.values && session.editor.refreshes_hints;
                let Some(preview) = session.previews.of(self.uri.as_str(), self.id) else {
                    return false;
                };
                let changed = preview.live != values;
                preview.live = values;
                return changed && shown;
            }
            Event::Message { error, text } => {
                let kind = if error {
                    lsp::MessageType::ERROR
                } else {
                    lsp::MessageType::INFO
                };
                self.client.show_message(kind, text).await;
            }
            Event::TextWanted => {
                let mut session = lock(&self.session);
                let Session {
                    documents,
                    previews,
                    ..
                } = &mut *session;
                if let Some(open) = documents.get(self.uri.as_str()) {
                    previews.resend(self.uri.as_str(), self.id, open);
                }
            }
            Event::Closed => {
                let known = lock(&self.session)
                    .previews
                    .forget(self.uri.as_str(), self.id);
                return known.is_some_and(|preview| !preview.live.is_empty());
            }
            // A repeated greeting, or an event of a later version of the messages.
            _ => {}
        }
        false
    }

    fn refresh_hints(&self) {
        if lock(&self.session).editor.refreshes_hints {
            let client = self.client.clone();
            tasks::spawn(async move {
                let _ = client.inlay_hint_refresh().await;
            });
        }
    }
}
