//! `geotrace accuracy`: error against run time, for every method, on one view.
//!
//! ```text
//! program ──▶ initial view ──measure.rs──▶ rows ──▶ table (text.rs) | JSON | diagram (plot.rs)
//!                               └ method.rs: the methods and their settings
//! ```

mod measure;
mod method;
mod plot;
mod text;

use std::path::{Path, PathBuf};

use clap::Args;
use geodesic::frame::Frame;
use geodesic::map::MapMethod;
use geodesic::surface::Surface;
use render::geodesic_view::PlacedCamera;
use render::viewpoint::GeodesicCamera;
use serde::Serialize;

use self::measure::{Measured, MeasuredView, STATUSES, Threads};
use self::method::{NAMES, STEPS, Setting};
use crate::argument::{self, Assignment, Format, Size};
use crate::failure::Failure;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::progress::Progress;
use crate::registry::Context;

/// The growth of the cost is measured at these multiples of the picture's size and of the view's length.
const SIZES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
const LENGTHS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// The longest side of a picture, in pixels: a map of twice the width and height must fit into memory.
const LONGEST: u32 = 2048;
/// The error at which methods are compared, in pixels.
const EQUAL: f64 = 0.25;

/// Compare the methods of geodesic tracing on a program: error against run time.
///
/// Each method computes the initial geodesic view with several settings. The endpoints are compared with a reference:
/// geodesics traced at a far smaller tolerance for some thousand pixels, and by hill climbing from the worst of them.
/// Run times are for this machine and for the endpoints of all pixels, without their colours.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace accuracy torus.gtr
  geotrace accuracy torus.gtr --set r=0.5 -o torus.svg

Errors are distances on the surface, in pixels. The methods:
  rk4-pixel    steps of equal length for each pixel, as in the thesis, in double precision
  adaptive     steps as long as the tolerance allows, for each pixel
  fan-linear   rays that all pixels share, with linear interpolation between them
  fan          rays with their Jacobi fields, as `render` uses them")]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The surface's name [default: the program's first surface]
    #[arg(long, value_name = "S")]
    surface: Option<String>,
    /// A value for a param or a grid, NAME=A,B for components [default: a param's initial value, a grid's first value]
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// The picture's size in pixels
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = argument::size, allow_hyphen_values = true)]
    size: Size,
    /// Human-readable text, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
    /// Write a diagram of the results, an SVG file
    #[arg(short, long, value_name = "PLOT.svg")]
    output: Option<PathBuf>,
}

/// The JSON document. Times are in milliseconds, errors in pixels.
#[derive(Debug, Serialize)]
struct Measurements {
    file: String,
    surface: String,
    size: [u32; 2],
    zoom: f64,
    threads: usize,
    reference: Sampled,
    rows: Vec<MethodRow>,
    /// The cost by the size of the picture.
    by_size: Vec<Growth>,
    /// The cost by the length of the view.
    by_length: Vec<Growth>,
}

#[derive(Debug, Serialize)]
struct Sampled {
    pixels: usize,
    unknown: usize,
}

#[derive(Debug, Serialize)]
struct MethodRow {
    method: &'static str,
    steps: Option<u32>,
    tolerance: Option<f64>,
    #[serde(flatten)]
    measured: Measured,
    status: serde_json::Map<String, serde_json::Value>,
    #[serde(skip)]
    setting: Setting,
}

/// One view of another size, or length.
#[derive(Debug, Serialize)]
struct Growth {
    size: [u32; 2],
    zoom: f64,
    rows: Vec<MethodRow>,
}

/// Measures all methods and prints the results.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.set_params(&arguments.set)?;
    let (id, object) = program.surface(arguments.surface.as_deref())?;
    let extension = arguments.output.as_deref().and_then(Path::extension);
    if let (Some(output), Some(extension)) = (&arguments.output, extension)
        && !extension.eq_ignore_ascii_case("svg")
    {
        return Err(Failure::Usage {
            message: format!("`{}`: the diagram is an SVG file", output.display()),
            hint: Some(format!(
                "write to `{}`",
                output.with_extension("svg").display()
            )),
        });
    }
    let target = match &arguments.output {
        Some(path) => Some(OutputTarget::apart_from(
            path,
            &Inputs::new(&arguments.file, []),
        )?),
        None => None,
    };
    if arguments.size.0.iter().any(|side| *side > LONGEST) {
        return Err(Failure::usage(format!(
            "--size: methods are measured on pictures of up to {LONGEST} × {LONGEST} pixels"
        )));
    }
    let camera = GeodesicCamera::new(id);
    let camera = PlacedCamera::new(program.scene(), &params, &camera, arguments.size.0)
        .map_err(super::render::failure)?;
    let surface = camera.manifold().surface();

    let threads = Threads::new()?;
    let progress = Progress::start("measuring");
    let document = measure(
        Subject {
            file: program.source.name.clone(),
            name: object.name.clone(),
            surface,
            frame: camera.frame,
            size: arguments.size.0,
        },
        &threads,
        &|share| progress.reach(share),
    );
    drop(progress);
    match arguments.format {
        Format::Json => output::print_json(&document)?,
        Format::Human => output::print(&text::table(&document))?,
    }
    if let Some(target) = target {
        target.write(diagram(&document).as_bytes())?;
    }
    Ok(())
}

/// The view that is measured.
struct Subject<'s> {
    file: String,
    name: String,
    surface: &'s dyn Surface,
    frame: Frame,
    size: [u32; 2],
}

fn measure(subject: Subject<'_>, threads: &Threads, progress: &dyn Fn(f32)) -> Measurements {
    let Subject {
        file,
        name,
        surface,
        frame,
        size,
    } = subject;
    let settings = Setting::all();
    let parts = (settings.len() + SIZES.len() + LENGTHS.len()) as f32;
    let mut done = 0.0;
    let mut reach = || {
        done += 1.0;
        progress(done / parts);
    };
    let mut view = MeasuredView::new(surface, frame, size);
    let (pixels, unknown) = view.sampled();
    let mut rows = Vec::new();
    for setting in settings {
        rows.push(MethodRow::new(setting, view.measure(&setting, threads)));
        reach();
    }
    let mut grown = |larger: f64, longer: f64| {
        let size = size.map(|side| ((larger * f64::from(side)) as u32).max(1));
        let frame = frame.zoomed(longer);
        let mut view = MeasuredView::new(surface, frame, size);
        let rows = growth(&mut view, threads);
        reach();
        Growth {
            size,
            zoom: frame.zoom(surface),
            rows,
        }
    };
    let by_size = SIZES.map(|larger| grown(larger, 1.0)).into();
    let by_length = LENGTHS.map(|longer| grown(1.0, longer)).into();
    Measurements {
        file,
        surface: name,
        size,
        zoom: frame.zoom(surface),
        threads: threads.count(),
        reference: Sampled { pixels, unknown },
        rows,
        by_size,
        by_length,
    }
}

/// Chooses the settings that are compared as pictures grow: the thesis' method with the fewest steps that are exact
/// enough, the adaptive method, and the fan.
fn growth(view: &mut MeasuredView<'_>, threads: &Threads) -> Vec<MethodRow> {
    let mut rows = Vec::new();
    for steps in STEPS {
        let setting = Setting::with_steps(steps);
        let row = MethodRow::new(setting, view.measure(&setting, threads));
        let enough = row.measured.error_px.max <= EQUAL;
        if enough || steps == STEPS[STEPS.len() - 1] {
            rows.push(row);
            break;
        }
    }
    for method in [MapMethod::Adaptive, MapMethod::Fan] {
        let setting = Setting::with_tolerance(method, 0.1);
        rows.push(MethodRow::new(setting, view.measure(&setting, threads)));
    }
    rows
}

impl MethodRow {
    fn new(setting: Setting, measured: Measured) -> Self {
        let status = STATUSES
            .iter()
            .zip(measured.shares)
            .map(|((_, name), share)| ((*name).to_owned(), share.into()))
            .collect();
        Self {
            method: setting.name(),
            steps: setting.steps(),
            tolerance: setting.tolerance,
            measured,
            status,
            setting,
        }
    }
}

/// The work–precision diagram.
fn diagram(document: &Measurements) -> String {
    let series: Vec<plot::Series> = NAMES
        .iter()
        .map(|name| plot::Series {
            name: (*name).to_owned(),
            points: document
                .rows
                .iter()
                .filter(|row| row.method == *name)
                .map(|row| {
                    let at = [row.measured.time_one_ms, row.measured.error_px.max];
                    (at, row.setting.text())
                })
                .collect(),
        })
        .collect();
    let words = plot::Words {
        title: format!("{}: error against run time", document.file),
        subtitle: format!(
            "geodesic view of {}, {} × {} pixels, zoom {:.4}, one thread",
            document.surface, document.size[0], document.size[1], document.zoom
        ),
        across: "run time (ms)",
        up: "largest error (px)",
        mark: (EQUAL, "0.25 px"),
    };
    plot::svg(&words, &series)
}
