//! `geotrace cast`: where rays meet solids and other objects, in f64.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use geometry::solids::{MAX_SHAPE_WORK, RayScene, RaySceneOptions, SOLID_COLOUR, srgb};
use glam::DVec3;
use render::bounds::Bounds;
use scene::{Object, ParamValues, Scene, Shape};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use tracer::shade::{Face, LightTracer, Scenery};
use tracer::{Caster, Ray};

use crate::argument::{self, Assignment, Format, Triple};
use crate::failure::Failure;
use crate::number::{show, show_all};
use crate::output;
use crate::program::{LoadedProgram, quoted};
use crate::registry::Context;

/// The most rays of a file.
pub const MOST_RAYS: usize = 4_000_000;
/// The longest line of a file of rays, in bytes.
pub const LONGEST_LINE: u64 = 4096;

/// Cast a ray into a program: where it enters and leaves each solid, and which object it meets first.
///
/// Solids are solved, not sampled: up to degree 4 in closed form, any other function by interval arithmetic.
/// Crossings closer to the start than 10⁻¹⁰ of its coordinates are limited by rounding.
#[derive(Args, Debug)]
#[command(
    group = ArgGroup::new("rays_of").required(true).args(["from", "rays"]),
    after_help = "\
Examples:
  geotrace cast die.gtr --from 3,0.4,0.4 --direction -1,0,0
  geotrace cast die.gtr --from 0,0,5 --direction 0,0,-1 --solid ball --format json
  geotrace cast die.gtr --rays rays.txt --format json        a document for each line `x y z a b c`

Positions and directions may be expressions in the program's names, such as pi/2.

t is the distance from the start. Normals are unit vectors: they lead out of a solid, and from a
surface back to the start."
)]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The ray's start
    #[arg(long, value_name = "X,Y,Z", value_parser = argument::triple, allow_hyphen_values = true, requires = "direction")]
    from: Option<Triple>,
    /// The ray's direction; its length does not matter
    #[arg(long, value_name = "A,B,C", value_parser = argument::triple, allow_hyphen_values = true, requires = "from")]
    direction: Option<Triple>,
    /// A file of rays, one per line: six numbers, the start and the direction; `-` is standard input
    #[arg(long, value_name = "FILE")]
    rays: Option<PathBuf>,
    /// The only solid to cast into, which may be a part of others [default: all that are drawn]
    #[arg(long, value_name = "NAME")]
    solid: Option<String>,
    /// A value for a param or a grid, NAME=A,B for components; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// Human-readable text, or one JSON document per ray
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

/// The note on a ray on which a function was sampled in the end.
const CUT_SHORT: &str = "the ray exceeds the work limit: crossings may be missing";

/// The JSON document of a ray.
#[derive(Serialize)]
struct CastJson<'a> {
    crossings: Vec<CrossingJson<'a>>,
    inside: Vec<&'a str>,
    first: Option<FirstJson<'a>>,
    notes: Vec<&'a str>,
}

#[derive(Serialize)]
struct CrossingJson<'a> {
    t: f64,
    position: [f64; 3],
    normal: [f64; 3],
    solid: &'a str,
    leaf: &'a str,
    entering: bool,
    #[serde(skip_serializing_if = "GridsJson::is_empty")]
    grids: GridsJson<'a>,
}

#[derive(Serialize)]
struct FirstJson<'a> {
    t: f64,
    position: [f64; 3],
    normal: [f64; 3],
    object: &'a str,
    kind: &'a str,
    leaf: Option<&'a str>,
    #[serde(skip_serializing_if = "GridsJson::is_empty")]
    grids: GridsJson<'a>,
}

/// The values of grids: a number for each, or a list for one with several axes.
struct GridsJson<'a>(Vec<(&'a str, &'a [f64])>);

impl CastJson<'_> {
    /// Changes the coordinates of all places and normals.
    fn turn(&mut self, turned: &dyn Fn([f64; 3]) -> [f64; 3]) {
        for crossing in &mut self.crossings {
            crossing.position = turned(crossing.position);
            crossing.normal = turned(crossing.normal);
        }
        if let Some(first) = &mut self.first {
            first.position = turned(first.position);
            first.normal = turned(first.normal);
        }
    }
}

impl GridsJson<'_> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Serialize for GridsJson<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, values) in &self.0 {
            match values {
                [one] => map.serialize_entry(name, one)?,
                several => map.serialize_entry(name, several)?,
            }
        }
        map.end()
    }
}

/// Casts one ray, or those of a file.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let standard = Some(Path::new("-"));
    if Some(&*arguments.file) == standard && arguments.rays.as_deref() == standard {
        return Err(Failure::usage("standard input (`-`) can be read only once"));
    }
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    let params = program.set_params(&arguments.set)?;
    let rays = rays(arguments, &program, &params)?;
    let scene = prepared(&program, &params, arguments.solid.as_deref())?;
    let notes: Vec<String> = scene.notes().iter().map(ToString::to_string).collect();
    let look = |face: &Face| scene.look(face, &|_, _| None);
    let scenery = Scenery {
        world: scene.world(),
        sheets: scene.sheets(),
        glass: scene.glass(),
        look: &look,
        lights: &[],
        background: &|_| DVec3::ZERO,
        bounces: 0,
        picture_look: scene.picture_look(),
        opaque: &[],
        sides: scene.sides(),
    };
    let mut caster = scene.world().caster();
    let mut tracer = LightTracer::new(&scenery);
    let mut out = BufWriter::new(std::io::stdout().lock());
    let several = rays.len() > 1;
    // Rays, places and normals are in the coordinates of the text.
    let turned = |ray: &Ray| {
        let [origin, direction] = [ray.origin, ray.direction];
        let stated = |vector: DVec3| DVec3::from_array(program.scene().stated(vector.to_array()));
        Ray {
            origin: stated(origin),
            direction: stated(direction),
            leaving: None,
        }
    };
    for (k, ray) in rays.iter().enumerate() {
        let mut found = cast(&scene, &mut caster, &mut tracer, &turned(ray), &notes);
        found.turn(&|vector| program.scene().stated(vector));
        let text = match arguments.format {
            Format::Json => {
                let text = serde_json::to_string(&found).map_err(|error| Failure::Internal {
                    message: format!("the document could not be written: {error}"),
                })?;
                text + "\n"
            }
            Format::Human => {
                let head = several.then_some(k + 1);
                text(&found, ray, head)
            }
        };
        out.write_all(text.as_bytes())
            .map_err(output::stdout_failure)?;
    }
    out.flush().map_err(output::stdout_failure)
}

/// The scene for rays: all that is drawn, or one solid.
fn prepared(
    program: &LoadedProgram,
    params: &ParamValues,
    solid: Option<&str>,
) -> Result<RayScene, Failure> {
    let scene = program.scene();
    let bounds = Bounds::of(scene, params);
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| srgb(SOLID_COLOUR),
        thickness: Some(render::style::thickness(bounds.placement.radius)),
        stage: true,
        picture_look: Default::default(),
    };
    let Some(name) = solid else {
        return Ok(RayScene::new(scene, params, &options));
    };
    let all = || scene.objects.iter().chain(&scene.parts);
    let found = all().find(|object| object.name == name);
    match found {
        Some(object) if object.shape.solid().is_some() => {
            Ok(RayScene::of_solid(scene, params, &options, object, &mut {
                MAX_SHAPE_WORK
            }))
        }
        found => Err(no_solid(program, scene, name, found)),
    }
}

fn no_solid(program: &LoadedProgram, scene: &Scene, name: &str, found: Option<&Object>) -> Failure {
    let file = &program.source.name;
    let solids = scene.objects.iter().chain(&scene.parts);
    let solids = solids.filter(|object| matches!(object.shape, Shape::Solid(_)));
    let names = quoted(solids);
    Failure::Usage {
        message: match found {
            Some(object) => format!(
                "--solid: `{name}` is a {}, not a solid",
                object.shape.kind()
            ),
            None => format!("--solid: `{file}` declares no solid `{name}`"),
        },
        hint: Some(match &names[..] {
            [] => {
                "a solid is declared like this: solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;".into()
            }
            [only] => format!("its solid is {only}"),
            several => format!("its solids are {}", several.join(", ")),
        }),
    }
}

/// The rays of the arguments; their directions are unit vectors.
fn rays(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<Ray>, Failure> {
    if let (Some(from), Some(direction)) = (&arguments.from, &arguments.direction) {
        let from = program.numbers("--from", &from.0, params)?;
        let direction = program.numbers("--direction", &direction.0, params)?;
        let ray = ray([from, direction]);
        return Ok(vec![ray.map_err(|reason| {
            Failure::usage(format!("--direction: {reason}"))
        })?]);
    }
    let path = arguments.rays.as_deref().unwrap_or(Path::new("-"));
    let name = if path.as_os_str() == "-" {
        "standard input".to_owned()
    } else {
        path.display().to_string()
    };
    let unreadable = |reason: String| Failure::Unreadable {
        file: name.clone(),
        reason,
    };
    let mut input = open(path).map_err(|error| unreadable(output::reason(&error)))?;
    let mut rays = Vec::new();
    let mut bytes = Vec::new();
    for line in 1.. {
        bytes.clear();
        let mut rest = (&mut input).take(LONGEST_LINE + 1);
        let read = rest.read_until(b'\n', &mut bytes);
        if read.map_err(|error| unreadable(output::reason(&error)))? == 0 {
            break;
        }
        if bytes.len() as u64 > LONGEST_LINE {
            return Err(unreadable(format!(
                "line {line} is longer than {LONGEST_LINE} bytes"
            )));
        }
        let words = String::from_utf8_lossy(&bytes);
        let words = words.trim_start_matches('\u{FEFF}');
        if words.trim().is_empty() {
            continue;
        }
        if rays.len() == MOST_RAYS {
            return Err(unreadable(format!(
                "it has more than {MOST_RAYS} rays: split the file"
            )));
        }
        let ray = six_numbers(words).and_then(ray);
        let ray = ray.map_err(|reason| Failure::Input {
            message: format!("{name}:{line}: {reason}"),
            hint: Some("a line is `x y z a b c`: the start and the direction of a ray".into()),
        });
        rays.push(ray?);
    }
    Ok(rays)
}

fn open(path: &Path) -> std::io::Result<Box<dyn BufRead>> {
    Ok(match path.as_os_str() == "-" {
        true => Box::new(std::io::stdin().lock()),
        false => Box::new(BufReader::new(File::open(path)?)),
    })
}

fn six_numbers(line: &str) -> Result<[[f64; 3]; 2], String> {
    let numbers: Result<Vec<f64>, String> = line.split_whitespace().map(argument::finite).collect();
    let numbers = numbers?;
    let given = numbers.len();
    let [x, y, z, a, b, c] = numbers[..] else {
        return Err(format!("expected six numbers, found {given}"));
    };
    Ok([[x, y, z], [a, b, c]])
}

fn ray([origin, direction]: [[f64; 3]; 2]) -> Result<Ray, String> {
    let direction = DVec3::from_array(direction);
    let largest = direction.abs().max_element();
    if largest == 0.0 {
        return Err("the direction of a ray must not be zero".into());
    }
    Ok(Ray {
        origin: origin.into(),
        // Divided twice: the square of a large number is infinite.
        direction: (direction / largest).normalize(),
        leaving: None,
    })
}

fn cast<'a>(
    scene: &'a RayScene,
    caster: &mut Caster<'_>,
    tracer: &mut LightTracer<'_>,
    ray: &Ray,
    notes: &'a [String],
) -> CastJson<'a> {
    let cut_short = caster.rays_cut_short();
    let crossings = caster.cast(ray).iter();
    let crossings = crossings.filter(|crossing| scene.is_declared_solid(crossing.solid));
    let crossings = crossings.map(|crossing| {
        let owner = scene.owner(&Face::from(crossing).of);
        CrossingJson {
            t: crossing.t,
            position: crossing.position.to_array(),
            normal: crossing.normal.to_array(),
            solid: &owner.object.name,
            leaf: owner.leaf.map_or(&*owner.object.name, |leaf| leaf.name),
            entering: crossing.entering,
            grids: GridsJson(owner.grids),
        }
    });
    let crossings = crossings.collect();
    let solids = caster.solids_at_start().iter();
    let inside = solids.filter(|&&solid| scene.is_declared_solid(solid));
    let inside = inside.map(|&solid| &*scene.object_of_solid(solid).name);
    let inside = inside.collect();
    let first = tracer.first(ray).map(|face| {
        let owner = scene.owner(&face.of);
        FirstJson {
            t: face.t,
            position: face.position.to_array(),
            normal: face.outward().to_array(),
            object: &owner.object.name,
            kind: owner.object.kind,
            leaf: owner.leaf.map(|leaf| leaf.name),
            grids: GridsJson(owner.grids),
        }
    });
    let mut notes: Vec<&str> = notes.iter().map(String::as_str).collect();
    if caster.rays_cut_short() > cut_short {
        notes.push(CUT_SHORT);
    }
    CastJson {
        crossings,
        inside,
        first,
        notes,
    }
}

/// The answer for people; with a number, where it is one of several.
fn text(found: &CastJson<'_>, ray: &Ray, number: Option<usize>) -> String {
    let mut text = String::new();
    if let Some(number) = number {
        let [from, direction] = [ray.origin, ray.direction].map(|v| show_all(&v.to_array()));
        let _ = writeln!(text, "ray {number}: from {from} along {direction}");
    }
    let inside = &found.inside;
    if !inside.is_empty() {
        let names: Vec<String> = inside.iter().map(|name| format!("`{name}`")).collect();
        let _ = writeln!(text, "it starts inside {}", names.join(", "));
    }
    match (&found.first, &found.crossings[..]) {
        (None, []) => text.push_str("it meets nothing\n"),
        (None, _) => {}
        (Some(first), _) => {
            let leaf = first.leaf.filter(|leaf| *leaf != first.object);
            let leaf = leaf.map_or_else(String::new, |leaf| format!(", face of `{leaf}`"));
            let _ = writeln!(
                text,
                "it first meets the {} `{}`{leaf}{}: t = {}, at {}, normal {}",
                first.kind,
                first.object,
                first.grids.text(),
                show(first.t),
                show_all(&first.position),
                show_all(&first.normal),
            );
        }
    }
    for crossing in &found.crossings {
        let way = if crossing.entering {
            "enters"
        } else {
            "leaves"
        };
        let leaf = Some(crossing.leaf).filter(|leaf| *leaf != crossing.solid);
        let leaf = leaf.map_or_else(String::new, |leaf| format!(" through `{leaf}`"));
        let _ = writeln!(
            text,
            "  t = {:<12} {way} `{}`{leaf}{} at {}, normal {}",
            show(crossing.t),
            crossing.solid,
            crossing.grids.text(),
            show_all(&crossing.position),
            show_all(&crossing.normal),
        );
    }
    for note in &found.notes {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

impl GridsJson<'_> {
    /// ` (k = 0)`, or nothing.
    fn text(&self) -> String {
        let grids = self.0.iter();
        let values = grids.map(|(name, values)| match values {
            [one] => format!("{name} = {}", show(*one)),
            several => format!("{name} = {}", show_all(several)),
        });
        let values: Vec<String> = values.collect();
        if values.is_empty() {
            return String::new();
        }
        format!(" ({})", values.join(", "))
    }
}
