//! Requests that read a document run on a worker, over a snapshot of the document at the time of the request.

use std::sync::Arc;

use serde::Serialize;
use tower_lsp::jsonrpc::{Error, ErrorCode, Result};
use tower_lsp::ls_types as lsp;

use super::Backend;
use crate::documents::{Open, Snapshot};
use crate::raw_responses::{Answer, answer};
use crate::tasks;

impl Backend {
    /// Returns a snapshot of the document.
    pub(super) fn snapshot(&self, uri: &lsp::Uri) -> Result<Arc<Snapshot>> {
        let session = self.session();
        let open = session.documents.get(uri.as_str());
        open.map(Open::snapshot).ok_or_else(|| not_open(uri))
    }

    /// Runs a feature on a worker, over a snapshot of a document. A panic in it is an error of this request only.
    pub(super) async fn ask<T: Send + 'static>(
        &self,
        uri: &lsp::Uri,
        feature: impl FnOnce(&Snapshot) -> T + Send + 'static,
    ) -> Result<T> {
        let snapshot = Snapshot::clone(&*self.snapshot(uri)?);
        self.work(move || feature(&snapshot)).await
    }

    /// Runs a task with a large answer, which is also serialised on the worker.
    pub(super) async fn answer<T: Serialize>(
        &self,
        uri: &lsp::Uri,
        feature: impl FnOnce(&Snapshot) -> T + Send + 'static,
    ) -> Result<Answer> {
        self.ask(uri, |snapshot| answer(&feature(snapshot))).await?
    }

    /// Runs a feature like [`Self::ask`]. It may run the program, and then waits until no other one is run.
    pub(super) async fn ask_run<T: Send + 'static>(
        &self,
        uri: &lsp::Uri,
        feature: impl FnOnce(&Snapshot) -> T + Send + 'static,
    ) -> Result<T> {
        let snapshot = Snapshot::clone(&*self.snapshot(uri)?);
        self.run(Arc::new(snapshot), feature).await
    }

    /// Runs a feature that may run the program of a snapshot, like [`Self::work`]. Of those, only a few run at once.
    pub(super) async fn run<T: Send + 'static>(
        &self,
        snapshot: Arc<Snapshot>,
        feature: impl FnOnce(&Snapshot) -> T + Send + 'static,
    ) -> Result<T> {
        let run = match snapshot.analysis().awaits_run() {
            true => self.runs.clone().acquire_owned().await.ok(),
            false => None,
        };
        self.work(move || {
            let _run = run;
            feature(&snapshot)
        })
        .await
    }

    /// Runs work on a worker when a permit is free. A request that is cancelled while it waits never starts.
    pub(super) async fn work<T: Send + 'static>(
        &self,
        feature: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T> {
        let place = self.places.clone().acquire_owned().await;
        let done = tasks::work(move || {
            // Held until the work is done, even if the request has been cancelled.
            let _place = place;
            feature()
        });
        done.await.map_err(|_| {
            failed(
                ErrorCode::InternalError,
                "this request failed because of a fault in the server; other requests continue",
            )
        })
    }
}

pub(super) fn failed(code: ErrorCode, message: impl Into<String>) -> Error {
    Error {
        code,
        message: message.into().into(),
        data: None,
    }
}

pub(super) fn not_open(uri: &lsp::Uri) -> Error {
    let message = format!("the document {} is not open", uri.as_str());
    failed(ErrorCode::InvalidParams, message)
}
