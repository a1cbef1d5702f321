//! Counters for tests of the real window: one JSON object a line, after each time that it has drawn itself.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

/// What has happened since the window was opened.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counters {
    /// Times that the window has drawn itself.
    pub frames: u64,
    /// Pictures of views that have reached it.
    pub pictures: u64,
    /// Pictures that the stage has drawn.
    pub drawn: u64,
    /// Objects whose samples were computed.
    pub sampled: u64,
    /// Pipelines that were built.
    pub pipelines: u64,
    /// Of these, kernels that follow geodesics.
    pub geodesic_kernels: u64,
    /// Geodesic views whose geodesics were followed.
    pub looks: u64,
    /// Texts that were compiled.
    pub compiled: u64,
    /// The text's version that is on the screen.
    pub version: i32,
    /// Whether what is on the screen is marked as stale.
    pub stale: bool,
    /// The status line's first part.
    pub status: String,
    /// The params' values.
    pub params: std::collections::BTreeMap<String, Vec<f64>>,
    /// Where the 3D camera stands.
    pub eye: Option<[f64; 3]>,
    /// Where the geodesic cameras stand.
    pub inside: std::collections::BTreeMap<String, [f64; 2]>,
    /// Where the pictures of panes are in the window, in points: left, top, width, height.
    pub panes: std::collections::BTreeMap<String, [f32; 4]>,
}

/// Writes counters.
#[derive(Debug)]
pub(crate) struct Report {
    file: std::fs::File,
}

impl Report {
    /// Begins a file.
    ///
    /// # Errors
    /// The system's.
    pub(crate) fn create(path: &Path) -> std::io::Result<Self> {
        Ok(Self {
            file: std::fs::File::create(path)?,
        })
    }

    /// Writes a line; a file that cannot be written does not trouble the window.
    pub(crate) fn write(&mut self, counters: &Counters) {
        if let Ok(mut line) = serde_json::to_vec(counters) {
            line.push(b'\n');
            let _ = self.file.write_all(&line);
        }
    }
}
