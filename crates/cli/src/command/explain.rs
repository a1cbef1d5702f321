//! `geotrace explain`: what is built for a program, what is left out, and what it costs.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use geometry::solids::{
    MAX_SHAPE_WORK, RayScene, RaySceneOptions, SOLID_COLOUR, instance_grids, leaf_class, srgb,
};
use render::plan::{ObjectPlan, Painter, Plan, SampleSource};
use render::{Backend, PictureRequest, ViewId, Views};
use scene::ParamValues;
use scene::{Object, Scene};
use serde::Serialize;

use crate::argument::Format;
use crate::failure::Failure;
use crate::number::{count, grouped, show};
use crate::output;
use crate::program::LoadedProgram;
use crate::registry::Context;

/// For developers: list what is built for a program, what is omitted, and the cost of each part.
///
/// Only the parts that a program needs are built. Each view is planned before anything is compiled; this is the plan
/// for a machine with a GPU. Without one, everything runs on the processor's cores.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace explain torus.gtr
  geotrace explain circle.gtr --format json")]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// Human-readable text, or one JSON document
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: Format,
}

/// The JSON document.
#[derive(Serialize)]
struct Explanation {
    #[serde(skip)]
    objects: usize,
    params: Vec<Dial>,
    grids: Vec<Dial>,
    views: Vec<ViewEntry>,
    intrinsic: Vec<IntrinsicEntry>,
    solids: Vec<SolidEntry>,
}

/// A param or a grid, and the number of uniforms that hold its components.
#[derive(Serialize)]
struct Dial {
    name: String,
    uniforms: usize,
}

/// The plan of one view.
#[derive(Serialize)]
struct ViewEntry {
    view: String,
    objects: Vec<ObjectEntry>,
    built: BuiltEntry,
    painters: Vec<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    geodesic: Option<GeodesicEntry>,
    left_out: Vec<String>,
}

#[derive(Serialize)]
struct ObjectEntry {
    name: String,
    kind: &'static str,
    instances: u64,
    samples: u64,
    source: &'static str,
    params: Vec<String>,
    grids: Vec<String>,
    uniforms: usize,
    operations: u64,
    operations_with_normals: Option<u64>,
}

#[derive(Serialize)]
struct GeodesicEntry {
    surface: String,
    kind: &'static str,
    source: &'static str,
    derivative_operations: Option<u64>,
}

#[derive(Serialize)]
struct BuiltEntry {
    draw_pipelines: u32,
    sample_kernels: u32,
    /// Always 0: geodesics are followed in f64. Readers of the document know the entry.
    geodesic_kernels: u32,
    resolve_pipelines: u32,
    textures: u32,
    samplers: u32,
}

/// The expressions of a metric, or of a geodesic on a surface or a metric.
#[derive(Serialize)]
struct IntrinsicEntry {
    name: String,
    kind: &'static str,
    /// What a geodesic lies on.
    #[serde(skip_serializing_if = "Option::is_none")]
    on: Option<String>,
    instances: u64,
    /// Of a geodesic.
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u64>,
    params: Vec<String>,
    grids: Vec<String>,
    operations: usize,
}

/// A solid, drawn or a part of others.
#[derive(Serialize)]
struct SolidEntry {
    name: String,
    drawn: bool,
    leaves: Vec<LeafEntry>,
    instances: u64,
    /// `[[x min, x max], [y min, y max], [z min, z max]]`; none for an empty or unbounded solid.
    bounds: Option<[[f64; 2]; 3]>,
    /// True if it contains no point.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    empty: bool,
    /// The reason for which nothing is known of its leaves and its box.
    #[serde(skip_serializing_if = "Option::is_none")]
    unknown: Option<String>,
}

#[derive(Serialize)]
struct LeafEntry {
    name: String,
    class: &'static str,
}

/// Plans every view of the program and prints the plans.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let mut program = LoadedProgram::load(context, &arguments.file, arguments.format)?;
    program.set_params(&[])?;
    let document = document(program.scene(), &context.registry.views);
    match arguments.format {
        Format::Json => output::print_json(&document),
        Format::Human => output::print(&text(&document, &program.source.name)),
    }
}

fn document(scene: &Arc<Scene>, all: &Views) -> Explanation {
    let param_values = ParamValues::initial(scene);
    // The size of a picture changes nothing of what is built for it.
    let size = [512, 512];
    let param_values = Arc::new(param_values);
    let mut views = Vec::new();
    for id in all.of_scene(Some(scene)) {
        if let Some(options) = all.options(&id, scene) {
            let request = PictureRequest::new(scene, param_values.clone(), options, size);
            views.push(view(all, &request));
        }
    }
    let dial = |(name, uniforms): (&String, usize)| Dial {
        name: name.clone(),
        uniforms,
    };
    let params = scene
        .params
        .iter()
        .map(|param| (&param.name, param.ranges.len()));
    let grids = scene.grids.iter().map(|grid| (&grid.name, grid.axes.len()));
    Explanation {
        objects: scene.objects.len(),
        params: params.map(dial).collect(),
        grids: grids.map(dial).collect(),
        views,
        intrinsic: intrinsic(scene, &param_values),
        solids: solids(scene, &param_values),
    }
}

/// The solids in the order of the text, those that are drawn first.
fn solids(scene: &Scene, params: &ParamValues) -> Vec<SolidEntry> {
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| srgb(SOLID_COLOUR),
        thickness: None,
        stage: false,
        picture_look: Default::default(),
    };
    let mut work = MAX_SHAPE_WORK;
    let drawn = scene.objects.iter().map(|object| (object, true));
    let all = drawn.chain(scene.parts.iter().map(|object| (object, false)));
    let entries = all.filter_map(|(object, drawn)| {
        let own = instance_grids(object.shape.solid()?);
        let rays = RayScene::of_solid(scene, params, &options, object, &mut work);
        let is_located = rays.world().solid_count() > 0;
        let empty = is_located && rays.is_empty(0);
        let bounds = (is_located && !empty).then(|| rays.world().bounds(0));
        let leaves = rays.leaves().into_iter();
        Some(SolidEntry {
            name: object.name.clone(),
            drawn,
            leaves: leaves
                .map(|(name, degree)| LeafEntry {
                    name: name.to_owned(),
                    class: leaf_class(degree),
                })
                .collect(),
            instances: params
                .instance_count(scene, object)
                .saturating_mul(params.combination_count(scene, own)),
            bounds: bounds
                .flatten()
                .map(|bounds| [0, 1, 2].map(|axis| [bounds.lower[axis], bounds.upper[axis]])),
            empty,
            unknown: (!is_located).then(|| {
                let notes: Vec<String> = rays.notes().iter().map(ToString::to_string).collect();
                notes.join("; ")
            }),
        })
    });
    entries.collect()
}

fn intrinsic(scene: &Scene, param_values: &ParamValues) -> Vec<IntrinsicEntry> {
    let entries = scene.objects.iter().filter_map(|object| {
        let (on, per_instance) = if object.shape.is_metric() {
            (None, None)
        } else if let Some((path, domain)) = object.shape.space_geodesic() {
            (Some(path.solid.to_owned()), Some(u64::from(domain.count)))
        } else {
            let (surface, domain) = object.shape.geodesic()?;
            let surface = scene.get(surface)?;
            (Some(surface.name.clone()), Some(u64::from(domain.count)))
        };
        let instances = param_values.instance_count(scene, object);
        let (params, grids) = inputs(scene, object);
        Some(IntrinsicEntry {
            name: object.name.clone(),
            kind: object.shape.kind(),
            on,
            instances,
            samples: per_instance.map(|samples| samples.saturating_mul(instances)),
            params,
            grids,
            operations: scene.graph.operation_count(&object.shape.roots()),
        })
    });
    entries.collect()
}

/// The names of the params and of the grids that an object depends on.
fn inputs(scene: &Scene, object: &Object) -> (Vec<String>, Vec<String>) {
    let params = object
        .params
        .iter()
        .filter_map(|id| scene.params.get(id.0 as usize));
    let grids = object
        .grids
        .iter()
        .filter_map(|id| scene.grids.get(id.0 as usize));
    (
        params.map(|param| param.name.clone()).collect(),
        grids.map(|grid| grid.name.clone()).collect(),
    )
}

fn view(views: &Views, request: &PictureRequest) -> ViewEntry {
    let scene = &request.scene;
    let plan = views.plan(request, Backend::Auto);
    let objects = plan.objects.iter().filter_map(|planned| {
        let object = scene.get(planned.object)?;
        Some(object_entry(scene, object, planned))
    });
    ViewEntry {
        view: ViewId::from_request(request).to_string(),
        objects: objects.collect(),
        built: built(&plan),
        painters: plan.painters().into_iter().map(painter).collect(),
        geodesic: plan.geodesic.as_ref().and_then(|geodesic| {
            let object = scene.get(geodesic.surface)?;
            Some(GeodesicEntry {
                surface: object.name.clone(),
                kind: object.shape.kind(),
                source: source(SampleSource::Blocks),
                derivative_operations: geodesic.derivative_operations,
            })
        }),
        left_out: plan.left_out,
    }
}

fn built(plan: &Plan) -> BuiltEntry {
    let built = plan.built();
    BuiltEntry {
        draw_pipelines: built.draw_pipelines,
        sample_kernels: built.sample_kernels,
        geodesic_kernels: 0,
        resolve_pipelines: built.resolve_pipelines,
        textures: built.textures,
        samplers: built.samplers,
    }
}

fn object_entry(scene: &Scene, object: &Object, planned: &ObjectPlan) -> ObjectEntry {
    let (params, grids) = inputs(scene, object);
    ObjectEntry {
        name: object.name.clone(),
        kind: object.shape.kind(),
        instances: planned.instances,
        samples: planned.samples,
        source: source(planned.source),
        params,
        grids,
        uniforms: planned.uniforms.len(),
        operations: planned.operations,
        operations_with_normals: planned.operations_with_normals,
    }
}

fn painter(painter: Painter) -> &'static str {
    match painter {
        Painter::Points => "points",
        Painter::Vectors => "vectors",
        Painter::Curves => "curves",
        Painter::Surfaces => "surfaces",
        Painter::Solids => "solids",
    }
}

fn source(source: SampleSource) -> &'static str {
    match source {
        SampleSource::Blocks => "blocks",
        SampleSource::Kernel => "kernel",
    }
}

fn text(document: &Explanation, file: &str) -> String {
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{file}: {}, {}, {}",
        count(document.objects, "object"),
        count(document.params.len(), "param"),
        count(document.grids.len(), "grid"),
    );
    for view in &document.views {
        view_text(&mut text, view);
    }
    if !document.intrinsic.is_empty() {
        let _ = writeln!(text, "\nMetrics and geodesics");
        for entry in &document.intrinsic {
            intrinsic_text(&mut text, entry);
        }
    }
    if !document.solids.is_empty() {
        let _ = writeln!(text, "\nSolids");
        for entry in &document.solids {
            solid_text(&mut text, entry);
        }
    }
    text
}

fn solid_text(text: &mut String, entry: &SolidEntry) {
    let _ = write!(text, "  {}: ", entry.name);
    if !entry.drawn {
        text.push_str("a part of others, not drawn; ");
    }
    if let Some(reason) = &entry.unknown {
        let _ = writeln!(
            text,
            "{}; {reason}",
            count(entry.instances as usize, "instance")
        );
        return;
    }
    let leaves = entry.leaves.iter();
    let leaves = leaves.map(|leaf| format!("{} ({})", leaf.name, leaf.class));
    let leaves: Vec<String> = leaves.collect();
    let _ = write!(
        text,
        "{}: {}; {}",
        plural(leaves.len() as u32, "leaf"),
        leaves.join(", "),
        count(entry.instances as usize, "instance"),
    );
    let _ = match entry.bounds {
        None if entry.empty => writeln!(text, "; empty"),
        Some(sides) => writeln!(
            text,
            "; in {}",
            sides
                .map(|[a, b]| format!("[{}, {}]", show(a), show(b)))
                .join(" × ")
        ),
        None => writeln!(text, "; unbounded"),
    };
}

fn intrinsic_text(text: &mut String, entry: &IntrinsicEntry) {
    let _ = write!(text, "  {} {}", entry.kind, entry.name);
    if let Some(on) = &entry.on {
        let _ = write!(text, " on {on}");
    }
    let _ = write!(text, ": {}", count(entry.instances as usize, "instance"));
    if let Some(samples) = entry.samples {
        let _ = write!(text, ", {}", count(samples as usize, "sample"));
    }
    let operations = count(entry.operations, "operation");
    let _ = match entry.on {
        Some(_) => write!(text, ", {operations} for each start"),
        None => write!(text, ", {operations} for E, F and G"),
    };
    depends(text, &entry.params, &entry.grids);
    text.push('\n');
}

fn depends(text: &mut String, params: &[String], grids: &[String]) {
    let inputs: Vec<&str> = params.iter().chain(grids).map(String::as_str).collect();
    if !inputs.is_empty() {
        let _ = write!(text, "; depends on {}", inputs.join(", "));
    }
}

fn view_text(text: &mut String, view: &ViewEntry) {
    let _ = writeln!(text, "\nView {}", view.view);
    for object in &view.objects {
        let _ = write!(
            text,
            "  {} {}: {} in {} from {}, {} each",
            object.kind,
            object.name,
            count(object.samples as usize, "sample"),
            count(object.instances as usize, "instance"),
            source_text(object.source),
            count(object.operations as usize, "operation"),
        );
        if let Some(operations) = object.operations_with_normals {
            let _ = write!(text, ", {} with normals", grouped(operations));
        }
        depends(text, &object.params, &object.grids);
        text.push('\n');
    }
    if let Some(geodesic) = &view.geodesic {
        let _ = write!(
            text,
            "  {} {}: ends of geodesics from {}",
            geodesic.kind,
            geodesic.surface,
            source_text(geodesic.source)
        );
        let _ = match geodesic.derivative_operations {
            Some(operations) => writeln!(
                text,
                ", {} for all derivatives",
                count(operations as usize, "operation")
            ),
            None => writeln!(text, "; its derivatives are too large to be written out"),
        };
    }
    let built = &view.built;
    let parts = [
        (built.draw_pipelines, "draw pipeline"),
        (built.sample_kernels, "sampling kernel"),
        (built.resolve_pipelines, "resolve pass"),
        (built.textures, "texture"),
        (built.samplers, "sampler"),
    ];
    let parts: Vec<String> = parts
        .iter()
        .filter(|(number, _)| *number > 0)
        .map(|(number, noun)| plural(*number, noun))
        .collect();
    let parts = if parts.is_empty() {
        "nothing".into()
    } else {
        parts.join(", ")
    };
    let _ = write!(text, "  built on a GPU: {parts}");
    let _ = match &view.painters[..] {
        [] => writeln!(text),
        painters => writeln!(text, " (draws {})", painters.join(", ")),
    };
    for sentence in &view.left_out {
        let _ = writeln!(text, "  left out: {sentence}");
    }
}

fn plural(number: u32, noun: &str) -> String {
    match (number, noun) {
        (2.., "resolve pass") => format!("{number} resolve passes"),
        (2.., "leaf") => format!("{number} leaves"),
        _ => count(number as usize, noun),
    }
}

fn source_text(source: &str) -> &'static str {
    match source {
        "kernel" => "a generated kernel",
        _ => "f64 blocks on the processor",
    }
}
