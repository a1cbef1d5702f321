//! For tests of the real window: one JSON object per line after each frame. The counters so far ([`Counters`]) are
//! written to the file; the positions of all named controls in the window are written to a second file, with the
//! additional extension `.controls`.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use egui::accesskit::Node;
use egui::{Context, FullOutput, Plugin};
use serde::Serialize;

/// Counts of the work since the window was opened, and its state.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counters {
    /// Frames that were drawn.
    pub frames: u64,
    /// Pictures of views that have arrived.
    pub pictures: u64,
    /// Pictures that the renderer has drawn.
    pub drawn: u64,
    /// Objects whose samples were computed.
    pub sampled: u64,
    /// Pipelines that were built.
    pub pipelines: u64,
    /// Geodesic views whose geodesics were traced.
    pub followed: u64,
    /// Scenes that were prepared for ray casting.
    pub worlds: u64,
    /// Rays of the 3D view that were cast at solids.
    pub rays: u64,
    /// Pixel samples of traced pictures.
    pub traced: u64,
    /// The samples per pixel in the traced pictures that panes show.
    pub samples: BTreeMap<String, u32>,
    /// Texts that were compiled.
    pub compiled: u64,
    /// The version of the text on the screen.
    pub version: i32,
    /// True if the picture on the screen is marked as stale.
    pub stale: bool,
    /// True if every view on the screen shows its newest picture.
    pub settled: bool,
    /// The status line's first part.
    pub status: String,
    /// The params' values.
    pub params: BTreeMap<String, Vec<f64>>,
    /// The position of the 3D camera.
    pub eye: Option<[f64; 3]>,
    /// The positions of the geodesic cameras.
    pub inside: BTreeMap<String, Vec<f64>>,
    /// The lengths of the geodesic cameras' trails.
    pub trails: BTreeMap<String, f64>,
    /// The rectangles of the panes' pictures in the window, in pixels: left, top, width, height.
    pub panes: BTreeMap<String, [f32; 4]>,
}

/// Writes lines.
#[derive(Clone, Debug)]
pub(crate) struct Report {
    counters: Lines,
    controls: Lines,
}

type Lines = Arc<Mutex<std::fs::File>>;

impl Report {
    /// Creates the files.
    ///
    /// # Errors
    /// The system's error.
    pub(crate) fn create(path: &Path) -> std::io::Result<Self> {
        let mut beside = path.as_os_str().to_owned();
        beside.push(".controls");
        let lines = |path: &Path| std::fs::File::create(path).map(|it| Arc::new(Mutex::new(it)));
        Ok(Self {
            counters: lines(path)?,
            controls: lines(Path::new(&beside))?,
        })
    }

    /// Starts to report the positions of all named controls.
    pub(crate) fn report_places(&self, context: &Context) {
        context.enable_accesskit();
        context.add_plugin(Places {
            lines: Arc::clone(&self.controls),
            last: BTreeMap::new(),
        });
    }

    /// Writes a line; errors are ignored.
    pub(crate) fn write(&self, counters: &Counters) {
        write(&self.counters, counters);
    }
}

fn write(lines: &Lines, line: &impl Serialize) {
    if let Ok(mut line) = serde_json::to_vec(line) {
        line.push(b'\n');
        let mut file = lines.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = file.write_all(&line);
    }
}

/// Reads the accessibility tree.
struct Places {
    lines: Lines,
    /// By "role: name": left, top, width, height in pixels of the window.
    last: BTreeMap<String, [f64; 4]>,
}

impl Plugin for Places {
    fn debug_name(&self) -> &'static str {
        "places of controls"
    }

    fn output_hook(&mut self, _context: &Context, output: &mut FullOutput) {
        let Some(tree) = &output.platform_output.accesskit_update else {
            return;
        };
        let scale = f64::from(output.pixels_per_point);
        let own = |node: &Node| node.label().or(node.value()).map(str::to_owned);
        // A control may get its name from a label beside it.
        let name = |node: &Node| match (node.label(), node.labelled_by().first()) {
            (None, Some(label)) => {
                let label = tree.nodes.iter().find(|(id, _)| id == label);
                label.and_then(|(_, label)| own(label))
            }
            _ => own(node),
        };
        let mut places = BTreeMap::new();
        for (_, node) in &tree.nodes {
            if let (Some(name), Some(at)) = (name(node), node.bounds()) {
                let place = [at.x0, at.y0, at.x1 - at.x0, at.y1 - at.y0];
                let name = format!("{:?}: {name}", node.role());
                places.insert(name, place.map(|x| x * scale));
            }
        }
        if places != self.last {
            self.last = places;
            write(&self.lines, &self.last);
        }
    }
}
