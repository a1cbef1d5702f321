//! `geotrace trace`: one geodesic in f64.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use geodesic::frame::trace_heading;
use geodesic::surface::Surface;
use geodesic::trace::{self, Method, Options, Status, Trace, TraceError};
use render::PictureMethod;
use serde::Serialize;

use crate::argument::{self, Assignment, Choice, Format, Pair, Quantity};
use crate::failure::Failure;
use crate::number::{self, show};
use crate::output;
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Follow one geodesic of a surface or a metric: the straightest line from a point in a direction.
///
/// Follows it adaptively in double precision, through poles and where the surface closes on itself, and says
/// where it ends, why it ends there, and how far to trust that.
#[derive(Args, Debug)]
#[command(
    group = ArgGroup::new("way").required(true).args(["direction", "heading"]),
    after_help = "\
Examples:
  geotrace trace torus.gtr --surface s --from 0,0 --heading 30 --length 5
  geotrace trace torus.gtr --surface s --from -pi/2,0.3 --direction 1,-1 --length 5 --format json

A number may be an expression in the program's names, such as pi/2.

The status is one of
  complete      it has its full length
  left_domain   it reached an edge of the surface
  cone_point    it ran into the tip of a cone, from where no direction is straight on
  degenerate    the parametrisation lost its rank: σu and σv are parallel there
  undefined     the surface is undefined there
  work_limit    it took more evaluations than allowed"
)]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The surface's (or metric's) name; without it, the program's first
    #[arg(long, value_name = "S")]
    surface: Option<String>,
    /// Where it starts, in the surface's parameters
    #[arg(long, value_name = "U,V", value_parser = argument::pair, allow_hyphen_values = true)]
    from: Pair,
    /// Where it goes: (u,v) components of any scale
    #[arg(long, value_name = "A,B", value_parser = argument::pair, allow_hyphen_values = true)]
    direction: Option<Pair>,
    /// Where it goes: degrees from σu towards σv in the tangent plane
    #[arg(long, value_name = "DEG", value_parser = argument::finite, allow_hyphen_values = true)]
    heading: Option<f64>,
    /// How far it goes, in the surface's units
    #[arg(long, value_name = "L", value_parser = argument::quantity, allow_hyphen_values = true)]
    length: Quantity,
    /// A value for a param or a grid; without one a param is where it starts, and a grid at its first value
    #[arg(long, value_name = "NAME=V", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// The error allowed in a step, relative to the step's length, up to 0.01; 3e-10 unless given
    #[arg(long, value_name = "T", value_parser = argument::tolerance, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// How it is integrated
    #[arg(long, value_name = "M", value_parser = argument::choice(&METHODS), default_value = "adaptive")]
    method: PictureMethod,
    /// The number of steps of rk4-pixel
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    steps: Option<u32>,
    /// For people, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

const METHODS: [Choice<PictureMethod>; 4] = [
    Choice::new(
        "adaptive",
        "Steps as long as the tolerance allows; needs nothing else",
        PictureMethod::Adaptive,
    ),
    Choice::new(
        "rk4-pixel",
        "The classical Runge–Kutta method with --steps steps of equal length (512 unless given), as in the thesis, for comparison",
        PictureMethod::Rk4Pixel,
    ),
    // Methods of pictures: refused with the reason, rather than as an unknown word.
    Choice::hidden("fan", PictureMethod::Fan),
    Choice::hidden("fan-linear", PictureMethod::FanLinear),
];

/// The JSON document; numbers that do not exist are null.
#[derive(Serialize)]
struct TraceJson {
    u: f64,
    v: f64,
    position: Option<[f64; 3]>,
    direction: [f64; 2],
    length: f64,
    speed_drift: f64,
    error_estimate: f64,
    steps: usize,
    evaluations: usize,
    status: &'static str,
}

/// Traces one geodesic.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.params(&arguments.set)?;
    let (id, _) = program.surface(arguments.surface.as_deref())?;
    let manifold = program.manifold(id, &params)?;
    let surface = manifold.surface();
    let from = program.numbers("--from", &arguments.from.0, &params)?;
    let length = program.number("--length", &arguments.length, &params)?;
    if length < 0.0 {
        return Err(Failure::Usage {
            message: format!("--length: {} is negative", show(length)),
            hint: Some("the opposite direction goes the other way".into()),
        });
    }
    let options = options(arguments)?;
    let traced = match &arguments.direction {
        Some(direction) => {
            let direction = program.numbers("--direction", &direction.0, &params)?;
            trace::trace(surface, from, direction, length, &options)
        }
        None => {
            let angle = arguments.heading.unwrap_or(0.0).to_radians();
            trace_heading(surface, from, angle, length, &options)
        }
    };
    let trace = match traced {
        Ok(trace) => trace,
        Err(error) => stopped_at_start(error, surface)?,
    };
    match arguments.format {
        Format::Json => output::print_json(&document(&trace)),
        Format::Human => output::print(&text(&trace, from)),
    }
}

fn options(arguments: &Arguments) -> Result<Options, Failure> {
    if let PictureMethod::Fan | PictureMethod::FanLinear = arguments.method {
        return Err(Failure::Usage {
            message: "--method: a fan shares its rays among the pixels of a picture; one geodesic has nothing to share"
                .into(),
            hint: Some("`--method adaptive` follows one geodesic".into()),
        });
    }
    let mut options = Options {
        compare: true,
        ..Options::default()
    };
    if let Some(tolerance) = arguments.tolerance {
        options.tolerance = tolerance;
    }
    match (arguments.method, arguments.steps) {
        (PictureMethod::Rk4Pixel, steps) => {
            options.method = Method::Rk4 {
                steps: steps.unwrap_or(512),
            };
        }
        (_, None) => options.method = Method::Adaptive,
        (_, Some(_)) => {
            return Err(Failure::Usage {
                message: "--steps belongs to rk4-pixel; the adaptive method chooses its own".into(),
                hint: Some("`--tolerance T` makes them shorter or longer".into()),
            });
        }
    }
    Ok(options)
}

fn document(trace: &Trace) -> TraceJson {
    TraceJson {
        u: trace.uv[0],
        v: trace.uv[1],
        position: trace.position,
        direction: trace.direction.0,
        length: trace.length,
        speed_drift: trace.speed_drift,
        error_estimate: trace.error_estimate,
        steps: trace.steps,
        evaluations: trace.evaluations,
        status: status_word(trace.status),
    }
}

fn text(trace: &Trace, from: [f64; 2]) -> String {
    let [u, v] = trace.uv.0;
    let length = show(trace.length);
    let end = match trace.status {
        Status::Complete => format!("it has its full length, {length}"),
        Status::LeftDomain => format!("it left the domain after {length}"),
        Status::ConePoint => format!("it ran into the tip of a cone after {length}"),
        Status::Degenerate => {
            format!(
                "after {length} the parametrisation lost its rank: σu and σv are parallel there"
            )
        }
        Status::Undefined => format!("after {length} the surface is undefined"),
        Status::WorkLimit => format!("it used up its evaluations after {length}"),
    };
    format!(
        "\
{}: {end}
  from       (u, v) = {}
  to         (u, v) = {}
  position   {}
  direction  {}
  trust      error estimate {}, speed drift {}
  work       {}, {}
",
        status_word(trace.status),
        number::show_all(&from),
        number::show_all(&[u, v]),
        trace
            .position
            .map_or_else(|| "none".to_owned(), |at| number::show_all(&at)),
        if trace.direction[0].is_nan() {
            "none".to_owned()
        } else {
            format!(
                "{} in (u, v), at unit speed",
                number::show_all(&trace.direction.0)
            )
        },
        rough(trace.error_estimate),
        rough(trace.speed_drift),
        number::count(trace.steps, "step"),
        number::count(trace.evaluations, "evaluation"),
    )
}

/// Formats an error estimate with two digits; more would not be exact.
fn rough(error: f64) -> String {
    if error == 0.0 {
        "0".into()
    } else {
        format!("{error:.1e}")
    }
}

fn status_word(status: Status) -> &'static str {
    match status {
        Status::Complete => "complete",
        Status::LeftDomain => "left_domain",
        Status::ConePoint => "cone_point",
        Status::Degenerate => "degenerate",
        Status::Undefined => "undefined",
        Status::WorkLimit => "work_limit",
    }
}

/// Turns a start where the surface is undefined or degenerate into a trace of length zero with that status. Any other
/// error is one of the arguments.
fn stopped_at_start(error: TraceError, surface: &dyn Surface) -> Result<Trace, Failure> {
    let (uv, status) = match error {
        TraceError::UndefinedStart { at } => (at, Status::Undefined),
        TraceError::DegenerateStart { at } => (at, Status::Degenerate),
        TraceError::StartNotFinite
        | TraceError::DirectionNotFinite
        | TraceError::ZeroDirection
        | TraceError::BadLength { .. }
        | TraceError::BadTolerance { .. }
        | TraceError::OutsideDomain { .. } => return Err(Failure::usage(error.to_string())),
    };
    Ok(Trace {
        uv: uv.into(),
        direction: [f64::NAN; 2].into(),
        position: surface
            .is_embedded()
            .then(|| surface.jet(uv.into()).position),
        evaluations: 1,
        status,
        ..Trace::default()
    })
}
