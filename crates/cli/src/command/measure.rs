//! `geotrace measure`: curvatures, circles, distances and triangles on a surface or a metric.

mod text;

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use geodesic::measure::{
    self, Circle, Connection, Connections, MeasureError, PlaceMeasures, RayStop, Triangle,
};
use geodesic::surface::Surface;
use scene::ParamValues;
use serde::Serialize;

use crate::argument::{self, Assignment, Format, Pair, Quantity};
use crate::failure::Failure;
use crate::number::{show_all, show_measured};
use crate::output;
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Measure a surface or a metric: curvature at a point, a circle, geodesics between two points, a triangle.
///
/// All measurements are intrinsic: distances along geodesics, angles in tangent planes, areas of the surface. Solids have no
/// parameters and cannot be measured; `geotrace trace` follows geodesics on them.
#[derive(Args, Debug)]
#[command(
    group = ArgGroup::new("what").required(true).args(["at", "between", "triangle"]),
    after_help = "\
Examples:
  geotrace measure torus.gtr --at 0,0                        K, H, E, F and G at a point
  geotrace measure torus.gtr --at 0,0 --circle 0.5           a circle's circumference and area
  geotrace measure torus.gtr --between 0,0 1,2               geodesics up to twice the distance
  geotrace measure torus.gtr --between 0,0 1,2 --within 9    geodesics no longer than 9
  geotrace measure torus.gtr --triangle 0,0 1,0 0,1          sides, angles, area, excess and ∫K

A number may be an expression in the program's names, such as pi/2.

  K, H      Gaussian and mean curvature; H is for the normal σu × σv, and a metric has none
  E, F, G   the first fundamental form E du² + 2F du dv + G dv²
  circle    the wavefront of this radius: ∫|m| dθ and ∬|m|, where m is the Jacobi field. What is
            swept twice counts twice. It overlaps where the radius is larger than the distance to
            the cut locus
  between   the shortest geodesic first, at most 32. Of a family of geodesics of one length, such
            as the meridians between a sphere's poles, one is listed, and marked as conjugate
  triangle  the sides are shortest geodesics, side k lies opposite corner k, angles are in radians.
            The area is that of the region that geodesics from the first corner sweep; ∫K includes
            the angle deficit of a cone's tip inside the triangle"
)]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The name of the surface or metric [default: the program's first]
    #[arg(long, value_name = "S")]
    surface: Option<String>,
    /// A point, in the surface's parameters
    #[arg(long, value_name = "U,V", value_parser = argument::pair, allow_hyphen_values = true)]
    at: Option<Pair>,
    /// The radius of a circle around the point
    #[arg(long, value_name = "R", value_parser = argument::quantity, allow_hyphen_values = true, requires = "at", conflicts_with_all = ["between", "triangle"])]
    circle: Option<Quantity>,
    /// Two points
    #[arg(long, value_name = "U,V", value_parser = argument::pair, allow_hyphen_values = true, num_args = 2)]
    between: Option<Vec<Pair>>,
    /// The maximum length of the listed geodesics [default: twice the distance]
    #[arg(long, value_name = "L", value_parser = argument::quantity, allow_hyphen_values = true, requires = "between", conflicts_with_all = ["at", "triangle"])]
    within: Option<Quantity>,
    /// Three points
    #[arg(long, value_name = "U,V", value_parser = argument::pair, allow_hyphen_values = true, num_args = 3)]
    triangle: Option<Vec<Pair>>,
    /// A value for a param or a grid, NAME=A,B for components [default: a param's initial value, a grid's first value]
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// Human-readable text, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

/// The JSON document of a place; numbers that do not exist are null.
#[derive(Serialize)]
struct PlaceJson {
    #[serde(rename = "K")]
    gaussian: Option<f64>,
    #[serde(rename = "H")]
    mean: Option<f64>,
    #[serde(rename = "E")]
    e: f64,
    #[serde(rename = "F")]
    f: f64,
    #[serde(rename = "G")]
    g: f64,
    /// The larger curvature first; null on a metric, at an umbilic and at a pole.
    principal: Option<[PrincipalJson; 2]>,
}

#[derive(Serialize)]
struct PrincipalJson {
    curvature: f64,
    direction: [f64; 2],
}

/// The JSON document of a circle; null where rays end.
#[derive(Serialize)]
struct CircleJson {
    circumference: Option<f64>,
    area: Option<f64>,
    /// Null also where it is not known.
    overlaps: Option<bool>,
    /// The larger of both estimates.
    error_estimate: Option<f64>,
    error_estimates: Option<CircleErrorsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
}

#[derive(Serialize)]
struct CircleErrorsJson {
    circumference: f64,
    area: f64,
}

/// The JSON document of the geodesics between two places.
#[derive(Serialize)]
struct ConnectionsJson {
    /// Null where no geodesic was found.
    distance: Option<f64>,
    within: f64,
    geodesics: Vec<ConnectionJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
}

#[derive(Serialize)]
struct ConnectionJson {
    length: f64,
    direction: [f64; 2],
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    conjugate: bool,
    /// Where it starts, unless that is the place given: at a pole, on another meridian.
    #[serde(skip_serializing_if = "Option::is_none")]
    from: Option<[f64; 2]>,
}

/// The JSON document of a triangle; null where a side or the region is none.
#[derive(Serialize)]
struct TriangleJson {
    sides: [Option<f64>; 3],
    angles: [Option<f64>; 3],
    area: Option<f64>,
    excess: Option<f64>,
    #[serde(rename = "integral_K")]
    curvature: Option<f64>,
    /// The larger of both estimates.
    error_estimate: Option<f64>,
    error_estimates: Option<TriangleErrorsJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    note: Option<String>,
}

#[derive(Serialize)]
struct TriangleErrorsJson {
    area: f64,
    #[serde(rename = "integral_K")]
    curvature: f64,
}

/// Measures what the arguments name.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.set_params(&arguments.set)?;
    let (id, object) = program.surface(arguments.surface.as_deref())?;
    let manifold = program.manifold(id, &params)?;
    let measuring = Measuring {
        surface: manifold.surface(),
        parameters: object.shape.parameters(),
        chart: object.shape.chart_label(),
        program: &program,
        params: &params,
        format: arguments.format,
    };
    match (&arguments.at, &arguments.between, &arguments.triangle) {
        (Some(at), _, _) => match &arguments.circle {
            None => measuring.place(at),
            Some(radius) => measuring.circle(at, radius),
        },
        (_, Some(places), _) => measuring.between(places, arguments.within.as_ref()),
        (_, _, Some(corners)) => measuring.triangle(corners),
        (None, None, None) => Err(Failure::usage(
            "one of --at, --between and --triangle is required",
        )),
    }
}

/// A surface with what the numbers of the arguments mean, and the format of the answer.
struct Measuring<'a> {
    surface: &'a dyn Surface,
    /// The names of its parameters.
    parameters: &'a [String],
    /// These names as a place is written.
    chart: String,
    program: &'a LoadedProgram,
    params: &'a ParamValues,
    format: Format,
}

impl Measuring<'_> {
    fn print(&self, document: &impl Serialize, text: &str) -> Result<(), Failure> {
        match self.format {
            Format::Json => output::print_json(document),
            Format::Human => output::print(text),
        }
    }

    fn pair(&self, option: &str, pair: &Pair) -> Result<[f64; 2], Failure> {
        self.program.numbers(option, &pair.0, self.params)
    }

    fn pairs<const N: usize>(
        &self,
        option: &str,
        pairs: &[Pair],
    ) -> Result<[[f64; 2]; N], Failure> {
        let mut places = [[0.0; 2]; N];
        for (place, pair) in places.iter_mut().zip(pairs) {
            *place = self.pair(option, pair)?;
        }
        Ok(places)
    }

    fn length(&self, option: &str, quantity: &Quantity) -> Result<f64, Failure> {
        let length = self.program.number(option, quantity, self.params)?;
        if length > 0.0 && length.is_finite() {
            return Ok(length);
        }
        Err(Failure::usage(format!(
            "{option}: {} is not greater than 0",
            show_measured(length)
        )))
    }

    fn place(&self, at: &Pair) -> Result<(), Failure> {
        let at = self.pair("--at", at)?;
        let found = measure::place(self.surface, at).map_err(|error| refused("--at", &error))?;
        let PlaceMeasures {
            form: [e, f, g],
            gaussian,
            mean,
            principal,
            ..
        } = found;
        let document = PlaceJson {
            gaussian,
            mean,
            e,
            f,
            g,
            principal: principal.map(|both| {
                both.map(|it| PrincipalJson {
                    curvature: it.curvature,
                    direction: it.direction,
                })
            }),
        };
        self.print(
            &document,
            &text::place(&found, self.surface.is_embedded(), self.parameters),
        )
    }

    fn circle(&self, at: &Pair, radius: &Quantity) -> Result<(), Failure> {
        let at = self.pair("--at", at)?;
        let radius = self.length("--circle", radius)?;
        let found = measure::circle(self.surface, at, radius);
        let found = found.map_err(|error| refused("--at", &error))?;
        let document = match found {
            Ok(Circle {
                circumference,
                area,
                overlaps,
                circumference_error,
                area_error,
            }) => CircleJson {
                circumference: Some(circumference),
                area: Some(area),
                overlaps,
                error_estimate: Some(circumference_error.max(area_error)),
                error_estimates: Some(CircleErrorsJson {
                    circumference: circumference_error,
                    area: area_error,
                }),
                note: None,
            },
            Err(stop) => CircleJson {
                circumference: None,
                area: None,
                overlaps: None,
                error_estimate: None,
                error_estimates: None,
                note: Some(stopped(&stop)),
            },
        };
        let text = match &found {
            Ok(circle) => text::circle(circle, radius),
            Err(stop) => format!(
                "The circle of this radius is not complete: {}.\n",
                stopped(stop)
            ),
        };
        self.print(&document, &text)
    }

    fn between(&self, places: &[Pair], within: Option<&Quantity>) -> Result<(), Failure> {
        let [from, to] = self.pairs("--between", places)?;
        let within = within
            .map(|within| self.length("--within", within))
            .transpose()?;
        let found = measure::between(self.surface, from, to, within);
        let found = found.map_err(|error| refused("--between", &error))?;
        let distance = match measure::is_one_place(self.surface, from, to) {
            true => Some(0.0),
            false => found.found.first().map(|it| it.length),
        };
        let other_start = |it: &Connection| other_start(it, from, self.surface.domain());
        let document = ConnectionsJson {
            distance,
            within: found.within,
            geodesics: found
                .found
                .iter()
                .map(|it| connection(it, other_start(it)))
                .collect(),
            note: note(&found, distance),
        };
        let mut text = text::between(&found, distance, &self.chart, &other_start);
        if let Some(note) = &document.note {
            text.push_str(&format!("{note}\n"));
        }
        self.print(&document, &text)
    }

    fn triangle(&self, corners: &[Pair]) -> Result<(), Failure> {
        let corners: [[f64; 2]; 3] = self.pairs("--triangle", corners)?;
        let found = measure::triangle(self.surface, corners);
        let found = found.map_err(|error| refused("--triangle", &error))?;
        let region = found.region.ok();
        let document = TriangleJson {
            sides: found.sides.map(|side| Some(side?.length)),
            angles: found.angles,
            area: region.map(|region| region.area),
            excess: found.excess(),
            curvature: region.map(|region| region.curvature),
            error_estimate: region.map(|region| region.area_error.max(region.curvature_error)),
            error_estimates: region.map(|region| TriangleErrorsJson {
                area: region.area_error,
                curvature: region.curvature_error,
            }),
            note: triangle_note(&found),
        };
        self.print(&document, &text::triangle(&found))
    }
}

fn connection(it: &Connection, other_start: Option<[f64; 2]>) -> ConnectionJson {
    ConnectionJson {
        length: it.length,
        direction: it.direction.0,
        conjugate: it.conjugate,
        from: other_start,
    }
}

/// The start of a geodesic where its numbers are not those of the place: at a pole all meridians begin.
fn other_start(it: &Connection, from: [f64; 2], domain: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let moved = (0..2).any(|k| {
        let [low, high] = domain[k];
        (it.from[k] - from[k]).abs() > 1e-9 * (high - low)
    });
    (moved && it.direction.is_finite()).then_some(it.from.0)
}

/// What the list of geodesics leaves open.
fn note(found: &Connections, distance: Option<f64>) -> Option<String> {
    let within = show_measured(found.within);
    if found.found.is_empty() {
        if distance == Some(0.0) {
            return Some(format!("no loop of length at most {within} was found"));
        }
        return Some(if found.complete {
            format!("no geodesic of length at most {within} joins the two points")
        } else {
            format!("no geodesic was found up to length {within}; the search may have missed some")
        });
    }
    (!found.complete).then(|| {
        format!("the list may be incomplete up to length {within}: the search reached its limit")
    })
}

/// The sides of a triangle that could be others, with other results, and why it has no region.
fn triangle_note(found: &Triangle) -> Option<String> {
    let remark = |k| Some(format!("side {} is {}", k + 1, found.remark(k)?));
    let error = found.region.err().map(|error| error.to_string());
    let clauses: Vec<String> = (0..3).filter_map(remark).chain(error).collect();
    (!clauses.is_empty()).then(|| clauses.join("; "))
}

pub(super) fn stopped(stop: &RayStop) -> String {
    stop.clause(&show_measured(stop.length))
}

fn refused(option: &str, error: &MeasureError) -> Failure {
    let message = format!("{option}: {error}");
    match error {
        MeasureError::Undefined { .. }
        | MeasureError::Degenerate { .. }
        | MeasureError::Crease { .. } => Failure::Input {
            message,
            hint: None,
        },
        MeasureError::NotFinite | MeasureError::Outside { .. } | MeasureError::BadLength { .. } => {
            Failure::usage(message)
        }
    }
}

/// Several numbers in brackets, and `none` where one does not exist.
fn pair_text(values: [f64; 2]) -> String {
    if values.iter().all(|x| x.is_finite()) {
        show_all(&values)
    } else {
        "none".into()
    }
}
