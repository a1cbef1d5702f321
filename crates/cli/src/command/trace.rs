//! `geotrace trace`: one geodesic in f64.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use geodesic::frame::trace_heading;
use geodesic::implicit::{PlaceError, SpaceFrame, SpaceTrace, SpaceTraceError};
use geodesic::point::Uv;
use geodesic::surface::Surface;
use geodesic::trace::{self, Options, Status, Trace, TraceError, TraceMethod};
use geometry::SolidSurface;
use render::PictureMethod;
use scene::{Object, ObjectId, ParamValues, Shape};
use serde::Serialize;

use crate::argument::{self, Assignment, Choice, Format, PlaceArgument, Quantity};
use crate::failure::Failure;
use crate::number::{self, show, show_measured};
use crate::output;
use crate::program::LoadedProgram;
use crate::progress::Progress;
use crate::registry::Context;

/// The most steps of a geodesic that is traced with equal steps.
pub const MOST_EQUAL_STEPS: u32 = 1_000_000;

/// Trace one geodesic of a surface, a metric or a solid: the straightest line from a point in a direction.
///
/// The geodesic is integrated adaptively in double precision, through poles and across seams. The output is its end,
/// the reason why it ends there, and an error estimate.
#[derive(Args, Debug)]
#[command(
    group = ArgGroup::new("way").required(true).args(["direction", "heading"]),
    after_help = "\
Examples:
  geotrace trace torus.gtr --surface s --from 0,0 --heading 30 --length 5
  geotrace trace torus.gtr --surface s --from -pi/2,0.3 --direction 1,-1 --length 5 --format json
  geotrace trace quartic.gtr --surface q --from 1,1,1 --direction 1,-1,0 --length 5

Positions, directions, headings and lengths may be expressions in the program's names, such as pi/2.

The status is one of
  complete      it reached its full length
  left_domain   it reached an edge of the surface or of the solid
  cone_point    it ran into the tip of a cone, beyond which no direction is straight ahead
  degenerate    σu and σv are parallel there, or a metric is not positive definite; on a solid, the gradient is 0 there
  undefined     the surface is undefined there
  work_limit    it reached the limit of evaluations (--max-evaluations)"
)]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The name of the surface, metric or solid [default: the program's first]
    #[arg(long, value_name = "S")]
    surface: Option<String>,
    /// The start: in the surface's parameters, or a point in space, which is projected onto the solid's surface
    #[arg(long, value_name = "U,V|X,Y,Z", value_parser = argument::place, allow_hyphen_values = true)]
    from: PlaceArgument,
    /// The direction: (u,v) components of any scale, or a direction in space, which is projected onto the solid's
    /// tangent plane
    #[arg(long, value_name = "A,B|A,B,C", value_parser = argument::place, allow_hyphen_values = true)]
    direction: Option<PlaceArgument>,
    /// The direction: degrees from σu towards σv in the tangent plane; on a solid with the unit normal n, from ẑ×n towards
    /// n×(ẑ×n)
    #[arg(long, value_name = "DEG", value_parser = argument::quantity, allow_hyphen_values = true)]
    heading: Option<Quantity>,
    /// The length, in the surface's units
    #[arg(long, value_name = "L", value_parser = argument::quantity, allow_hyphen_values = true)]
    length: Quantity,
    /// A value for a param or a grid, NAME=A,B for components [default: a param's initial value, a grid's first value]
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// The error allowed per step, relative to the step's length, up to 0.01 [default: 1.5e-10]
    #[arg(long, value_name = "T", value_parser = argument::tolerance, allow_hyphen_values = true)]
    tolerance: Option<f64>,
    /// The maximum number of evaluations of the surface and its derivatives [default: 10 million, a few seconds]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_hyphen_values = true)]
    max_evaluations: Option<u32>,
    /// The method of integration
    #[arg(long, value_name = "M", value_parser = argument::choice(&METHODS), default_value = "adaptive")]
    method: PictureMethod,
    /// The number of steps of rk4-pixel
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_EQUAL_STEPS)), allow_hyphen_values = true)]
    steps: Option<u32>,
    /// List the conjugate points along the geodesic, where geodesics that start beside it meet it again, and the
    /// Jacobi field at the end
    #[arg(long)]
    conjugate: bool,
    /// Human-readable text, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

const METHODS: [Choice<PictureMethod>; 4] = [
    Choice::new(
        "adaptive",
        "Steps as long as the tolerance allows",
        PictureMethod::Adaptive,
    ),
    Choice::new(
        "rk4-pixel",
        "The classical Runge–Kutta method with --steps steps of equal length (512 unless given), as in the thesis, for comparison",
        PictureMethod::Rk4Pixel,
    ),
    // Methods of pictures: refused with the reason, rather than as unknown word.
    Choice::hidden("fan", PictureMethod::Fan),
    Choice::hidden("fan-linear", PictureMethod::FanLinear),
];

/// The JSON document; numbers that do not exist are null.
#[derive(Serialize)]
struct TraceJson {
    u: Option<f64>,
    v: Option<f64>,
    position: Option<[f64; 3]>,
    direction: Vec<f64>,
    length: f64,
    speed_drift: f64,
    error_estimate: f64,
    steps: usize,
    evaluations: usize,
    status: &'static str,
    /// With `--conjugate`, the arc lengths of the conjugate points.
    #[serde(skip_serializing_if = "Option::is_none")]
    conjugates: Option<Vec<f64>>,
    /// With `--conjugate`, (m, m') at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    jacobi: Option<[f64; 2]>,
}

/// Traces one geodesic.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.set_params(&arguments.set)?;
    let (id, object) = program.ground(arguments.surface.as_deref())?;
    let length = program.number("--length", &arguments.length, &params)?;
    if length < 0.0 {
        return Err(Failure::Usage {
            message: format!("--length: {} is negative", show(length)),
            hint: Some(
                "to go the other way, reverse `--direction`, or add 180 to `--heading`".into(),
            ),
        });
    }
    let options = options(arguments)?;
    let progress = Progress::of_unknown_length("following the geodesic");
    if object.shape.solid().is_some() {
        let (from, trace) = on_solid(arguments, &program, &params, (id, object), length, &options)?;
        drop(progress);
        let (document, text) = (document_in_space(&trace), text_in_space(&trace, from));
        return print(arguments, document, text, (trace.conjugates, trace.jacobi));
    }
    let manifold = program.manifold(id, &params)?;
    let surface = manifold.surface();
    let from = program.place("--from", &arguments.from, &params, object)?;
    let traced = match &arguments.direction {
        Some(direction) => {
            let direction: [f64; 2] = program.place("--direction", direction, &params, object)?;
            trace::trace(surface, from, direction, length, &options)
        }
        None => {
            let angle = heading(arguments, &program, &params)?;
            trace_heading(surface, from, angle, length, &options)
        }
    };
    let trace = match traced {
        Ok(trace) => trace,
        Err(error) => stopped_at_start(error, surface)?,
    };
    drop(progress);
    let (document, text) = (document(&trace), text(&trace, from, surface, &object.shape));
    print(arguments, document, text, (trace.conjugates, trace.jacobi))
}

/// Returns the heading in radians.
fn heading(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<f64, Failure> {
    match &arguments.heading {
        Some(heading) => Ok(program.number("--heading", heading, params)?.to_radians()),
        None => Ok(0.0),
    }
}

/// Prints what was found, with the conjugate points and the Jacobi field where the arguments ask for them.
fn print(
    arguments: &Arguments,
    mut document: TraceJson,
    mut text: String,
    (conjugates, jacobi): (Vec<f64>, [f64; 2]),
) -> Result<(), Failure> {
    if arguments.conjugate {
        text.push_str(&field_text(&conjugates, jacobi));
        (document.conjugates, document.jacobi) = (Some(conjugates), Some(jacobi));
    }
    match arguments.format {
        Format::Json => output::print_json(&document),
        Format::Human => output::print(&text),
    }
}

/// The conjugate points and the Jacobi field (m, m') at the end.
fn field_text(conjugates: &[f64], jacobi: [f64; 2]) -> String {
    let points = match conjugates {
        [] => "none".to_owned(),
        lengths => {
            let lengths: Vec<String> = lengths.iter().copied().map(show).collect();
            format!("after {}", lengths.join(", "))
        }
    };
    let [m, slope] = jacobi.map(show);
    format!("  conjugate  {points}\n  Jacobi     m = {m}, m' = {slope} at the end\n")
}

/// Traces a geodesic on a solid. A start where the solid has no surface or is undefined is one of the arguments.
fn on_solid(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
    (id, object): (ObjectId, &Object),
    length: f64,
    options: &Options,
) -> Result<([f64; 3], SpaceTrace), Failure> {
    if options.method != TraceMethod::Adaptive {
        return Err(Failure::usage(
            "--method: rk4-pixel takes steps in (u, v), but a solid has no parameters",
        ));
    }
    // A script has other coordinates than its scene.
    let stated = |vector| program.scene().stated(vector);
    let given: [f64; 3] = program.place("--from", &arguments.from, params, object)?;
    let from = stated(given);
    let solid = SolidSurface::new(program.scene(), params, id);
    let solid = solid.map_err(|error| Failure::Input {
        message: error.to_string(),
        hint: None,
    })?;
    let surface = solid.surface();
    let unusable = |why: PlaceError| Failure::Usage {
        message: SpaceTraceError::Place { at: given, why }.to_string(),
        hint: Some("`--from` requires a point near the surface".into()),
    };
    let direction = match &arguments.direction {
        Some(direction) => stated(program.place("--direction", direction, params, object)?),
        None => {
            let angle = heading(arguments, program, params)?;
            SpaceFrame::new(surface, from, angle, 1.0)
                .map_err(unusable)?
                .x
        }
    };
    let traced = surface.trace(from, direction, length, options);
    let trace = traced.map_err(|error| match error {
        SpaceTraceError::Place { why, .. } => unusable(why),
        _ => Failure::usage(error.to_string()),
    })?;
    let turned = SpaceTrace {
        start: stated(trace.start),
        position: stated(trace.position),
        direction: stated(trace.direction),
        ..trace
    };
    Ok((given, turned))
}

fn document_in_space(trace: &SpaceTrace) -> TraceJson {
    TraceJson {
        u: None,
        v: None,
        position: Some(trace.position),
        direction: trace.direction.to_vec(),
        length: trace.length,
        speed_drift: trace.speed_drift,
        error_estimate: trace.error_estimate,
        steps: trace.steps,
        evaluations: trace.evaluations,
        status: status_word(trace.status),
        conjugates: None,
        jacobi: None,
    }
}

fn text_in_space(trace: &SpaceTrace, from: [f64; 3]) -> String {
    let length = show(trace.length);
    let end = match trace.status {
        Status::Complete => format!("it has its full length, {length}"),
        Status::LeftDomain => format!("it reached an edge of the solid after {length}"),
        Status::Degenerate | Status::ConePoint => {
            format!("after {length} the solid has no tangent plane: its gradient is 0 there")
        }
        Status::Undefined => format!("after {length} the solid is undefined"),
        Status::WorkLimit => format!("{} after {length}", used_up()),
    };
    let moved = if from == trace.start {
        String::new()
    } else {
        format!("\n  on it      {}", number::show_all(&trace.start))
    };
    format!(
        "\
{}: {end}
  from       {}{moved}
  position   {}
  direction  {}, at unit speed
  accuracy   error estimate {}, speed drift {}
  work       {}, {}
",
        status_word(trace.status),
        number::show_all(&from),
        number::show_all(&trace.position),
        number::show_all(&trace.direction),
        rough(trace.error_estimate),
        rough(trace.speed_drift),
        number::count(trace.steps, "step"),
        number::count(trace.evaluations, "evaluation"),
    )
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
        conjugates: arguments.conjugate,
        max_evaluations: arguments
            .max_evaluations
            .map_or(trace::MOST_OF_ONE, |most| most as usize),
        ..Options::default()
    };
    if let Some(tolerance) = arguments.tolerance {
        options.tolerance = tolerance;
    }
    match (arguments.method, arguments.steps) {
        (PictureMethod::Rk4Pixel, _) if arguments.conjugate => {
            return Err(Failure::usage(
                "--conjugate: the thesis' method, rk4-pixel, does not integrate the Jacobi field",
            ));
        }
        (PictureMethod::Rk4Pixel, steps) => {
            options.method = TraceMethod::Rk4 {
                steps: steps.unwrap_or(512),
            };
        }
        (_, None) => options.method = TraceMethod::Adaptive,
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
        u: Some(trace.uv[0]),
        v: Some(trace.uv[1]),
        position: trace.position,
        direction: trace.direction.0.to_vec(),
        length: trace.length,
        speed_drift: trace.speed_drift,
        error_estimate: trace.error_estimate,
        steps: trace.steps,
        evaluations: trace.evaluations,
        status: status_word(trace.status),
        conjugates: None,
        jacobi: None,
    }
}

fn used_up() -> &'static str {
    "it reached the limit of evaluations (`--max-evaluations` raises it)"
}

/// σu or σv is taken for zero where the length of its coordinate line is this share of the other's.
const VANISHING: f64 = 1e-3;
/// The line along which it is zero is looked for at this share of the domain from a point of it.
const ALONG_LINE: f64 = 0.1;

/// The reason why σu and σv span no plane at the end of a trace, and what helps where one of them is zero.
fn lost_rank(surface: &dyn Surface, uv: Uv, shape: &Shape) -> String {
    let domain = surface.domain();
    // The lengths of coordinate lines, which do not depend on the parameters' units.
    let lengths = |uv: Uv| {
        let jet = surface.jet(uv);
        [(jet.du, domain[0]), (jet.dv, domain[1])].map(|(tangent, [low, high])| {
            let largest = tangent.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            largest * (high - low)
        })
    };
    let vanishes = |lengths: [f64; 2], k: usize| lengths[k] < VANISHING * lengths[1 - k];
    let here = lengths(uv);
    let Some(zero) = (0..2).find(|&k| vanishes(here, k)) else {
        return match surface.is_embedded() {
            true => "σu and σv are parallel there".into(),
            false => "the metric is not positive definite there".into(),
        };
    };
    let tangent = match surface.is_embedded() {
        true => ["σu", "σv"][zero],
        false => ["E", "G"][zero],
    };
    // On a line of constant u or of constant v: it is still zero a part of the way along it.
    let is_line = |axis: usize| {
        let [low, high] = domain[1 - axis];
        let way = ALONG_LINE * (high - low);
        [-way, way].into_iter().any(|way| {
            let mut beside = uv;
            beside[1 - axis] += way;
            (low..=high).contains(&beside[1 - axis]) && vanishes(lengths(beside), zero)
        })
    };
    let Some(axis) = [zero, 1 - zero].into_iter().find(|&axis| is_line(axis)) else {
        return format!("{tangent} is 0 there");
    };
    let name = &shape.parameters()[axis];
    // The geodesic ends just before the line.
    let unit = VANISHING * (domain[axis][1] - domain[axis][0]);
    let line = show_measured((uv[axis] / unit).round() * unit);
    format!(
        "{tangent} is 0 on the line {name} ≈ {line}; if the surface is smooth there, another parametrisation leads across"
    )
}

/// The side that is one point nearest to the end of a trace, which no geodesic passes.
fn tip(surface: &dyn Surface, uv: Uv, shape: &Shape) -> String {
    let domain = surface.domain();
    let off = |axis: usize, end: usize| {
        (uv[axis] - domain[axis][end]).abs() / (domain[axis][1] - domain[axis][0])
    };
    let sides = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter();
    let points = sides.filter_map(|(axis, end)| Some((axis, end, surface.apex(axis, end)?)));
    let nearest = points.min_by(|a, b| off(a.0, a.1).total_cmp(&off(b.0, b.1)));
    match nearest {
        Some((axis, _, apex)) if apex.smooth => format!(
            "a pole about which the directions of the lines of constant {} are not those of an ellipse",
            shape.parameters()[1 - axis]
        ),
        _ => "the tip of a cone".to_owned(),
    }
}

fn text(trace: &Trace, from: [f64; 2], surface: &dyn Surface, shape: &Shape) -> String {
    let [u, v] = trace.uv.0;
    let chart = shape.chart_label();
    let length = show(trace.length);
    let end = match trace.status {
        Status::Complete => format!("it has its full length, {length}"),
        Status::LeftDomain => format!("it left the domain after {length}"),
        Status::ConePoint => format!(
            "it ran into {} after {length}",
            tip(surface, trace.uv, shape)
        ),
        Status::Degenerate => format!(
            "the parametrisation is degenerate at length {length}: {}",
            lost_rank(surface, trace.uv, shape)
        ),
        Status::Undefined => format!("after {length} the surface is undefined"),
        Status::WorkLimit => format!("{} after {length}", used_up()),
    };
    format!(
        "\
{}: {end}
  from       {chart} = {}
  to         {chart} = {}
  position   {}
  direction  {}
  accuracy   error estimate {}, speed drift {}
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
                "{} in {chart}, at unit speed",
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
