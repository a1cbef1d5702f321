//! A stage's pictures while a window is used: frames of a camera that turns, of a param that is dragged, of a being that
//! walks inside a surface.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::{Duration, Instant};

use geodesic::trace::Options;
use render::Renderer;
use render::gpu::Gpu;
use render::gpu::Pixels;
use render::point::DrawingPoint;
use render::viewpoint::Viewpoint;
use scene::ParamValues;
use scene::{ObjectId, Scene};
use testing::draw::middle;
use testing::examples;
use testing::wanted::Wanted;

use crate::measure::{Times, process_clock};

const SIZE: [u32; 2] = [800, 600];
/// Pictures of a table's cell, after a first one.
const FRAMES: u32 = 12;
/// Pictures of a walk, after a first one.
const STEPS: u32 = 40;
/// What a frame of a walk may take.
const TARGET: Duration = Duration::from_millis(16);
/// A frame of a screen that shows sixty a second.
const FRAME: Duration = Duration::from_micros(16_667);

/// Prints the table.
pub(crate) fn run() {
    println!(
        "Frames of {} × {} pixels by a stage: camera turns, first param is dragged, being inside walks",
        SIZE[0], SIZE[1]
    );
    stage("software", Renderer::software);
    match Gpu::shared() {
        Ok(gpu) => {
            let name = gpu.name().to_owned();
            stage(&name, || Renderer::on_gpu(gpu.clone()));
        }
        Err(error) => println!("  {error}"),
    }
}

/// Prints how long the frames of a walk take in software, example by example, and what of it processors were busy.
pub(crate) fn walk() {
    println!(
        "A being walks inside, {} × {} pixels, software, {} threads: {STEPS} frames each",
        SIZE[0],
        SIZE[1],
        rayon::current_num_threads()
    );
    let mut over = Vec::new();
    for example in examples::all() {
        let Some(scene) = scene::geotrace::compile(&example.source)
            .scene
            .map(Arc::new)
        else {
            println!("    {} has errors", example.name);
            continue;
        };
        let mut stage = Renderer::software();
        let busy = process_clock();
        let Some(times) = walking(&mut stage, &scene, STEPS) else {
            continue;
        };
        let busy = (process_clock().saturating_sub(busy)).as_secs_f64() / f64::from(STEPS + 1);
        println!(
            "    {:16} {times}   {:6.1} ms of processor time",
            example.name,
            1e3 * busy
        );
        if times.median() > TARGET {
            over.push(example.name);
        }
    }
    match over.len() {
        0 => println!("    all within {TARGET:?}"),
        count => println!("    {count} not within {TARGET:?}: {}", over.join(", ")),
    }
}

fn stage(name: &str, make: impl Fn() -> Renderer) {
    println!("  {name}");
    // Of examples without solids, by columns; and how many cells there are in all, and are within a frame.
    let mut plain: [Vec<Duration>; 3] = Default::default();
    let (mut within, mut all) = (0, 0);
    for example in examples::all() {
        let Some(scene) = scene::geotrace::compile(&example.source).scene else {
            println!("    {} has errors", example.name);
            continue;
        };
        let scene = Arc::new(scene);
        let mut stage = make();
        let cells = [
            turning(&mut stage, &scene),
            dragging(&mut stage, &scene),
            walking(&mut stage, &scene, FRAMES),
        ];
        for times in cells.iter().flatten() {
            all += 1;
            within += u32::from(times.median() <= FRAME);
        }
        let mut objects = scene.objects.iter();
        if !objects.any(|object| object.shape.solid().is_some()) {
            for (column, times) in plain.iter_mut().zip(&cells) {
                column.extend(times.as_ref().map(Times::median));
            }
        }
        let text = cells.map(|times| {
            times.map_or_else(
                || format!("{:>10}", "–"),
                |times| format!("{:7.1} ms", 1e3 * times.median().as_secs_f64()),
            )
        });
        println!(
            "    {:16} camera {}   param {}   inside {}",
            example.name, text[0], text[1], text[2]
        );
    }
    println!("    {within} of {all} within a frame of 16.7 ms");
    let count = plain.iter().flatten().count();
    let within = plain.iter().flatten().filter(|it| **it <= FRAME).count();
    println!("  without solids: {within} of {count}; medians, and in parentheses the slowest");
    for (what, mut column) in ["camera", "param", "inside"].into_iter().zip(plain) {
        column.sort_unstable();
        let at = |k: usize| column.get(k).map_or(f64::NAN, |it| 1e3 * it.as_secs_f64());
        let [median, slowest] = [column.len() / 2, column.len().saturating_sub(1)].map(at);
        println!(
            "    {what:7} {median:.1} ms ({slowest:.1}), {} of them",
            column.len()
        );
    }
}

/// Draws frames, the first of which is not counted. A picture on a GPU counts when it has been drawn.
fn frames(
    count: u32,
    stage: &mut Renderer,
    scene: &Arc<Scene>,
    mut next: impl FnMut(f64) -> Option<(ParamValues, Wanted)>,
) -> Option<Times> {
    let mut times = Vec::new();
    for frame in 0..=count {
        let (settings, request) = next(f64::from(frame) / f64::from(count))?;
        let start = Instant::now();
        let shot = stage.draw(&request.of(scene, &settings)).ok()?;
        if let (Pixels::Texture(_), Some(gpu)) = (&shot.image, stage.gpu()) {
            gpu.finish().ok()?;
        }
        if frame > 0 {
            times.push(start.elapsed());
        }
    }
    Some(Times::new(times))
}

fn turning(stage: &mut Renderer, scene: &Arc<Scene>) -> Option<Times> {
    let settings = middle(scene);
    let camera = stage
        .camera(&Wanted::space(SIZE).of(scene, &settings))
        .ok()?;
    let [x, y, z] = camera.eye.to_array();
    let (away, first) = (x.hypot(y), y.atan2(x));
    frames(FRAMES, stage, scene, |share| {
        let angle = first + 0.3 * TAU * share;
        let eye = [away * angle.cos(), away * angle.sin(), z];
        let mut request = in_motion();
        request.in_space().camera = Viewpoint::new(
            camera.placement.world(DrawingPoint(eye)),
            camera.placement.world(DrawingPoint([0.0; 3])),
        );
        Some((settings.clone(), request))
    })
}

fn dragging(stage: &mut Renderer, scene: &Arc<Scene>) -> Option<Times> {
    let param = scene.params.first()?;
    frames(FRAMES, stage, scene, |share| {
        let mut settings = middle(scene);
        let mut values = settings.param(param).to_vec();
        let range = param.ranges.first()?;
        values[0] = range.min + (0.3 + 0.4 * share) * (range.max - range.min);
        settings.set(scene, &param.name, &values).ok()?;
        Some((settings, in_motion()))
    })
}

/// Returns the 3D view, drawn as a window draws it while something moves.
fn in_motion() -> Wanted {
    Wanted {
        moving: true,
        ..Wanted::space(SIZE)
    }
}

fn walking(stage: &mut Renderer, scene: &Arc<Scene>, steps: u32) -> Option<Times> {
    let settings = middle(scene);
    let surface = (0..)
        .zip(&scene.objects)
        .find(|(_, object)| object.shape.manifold().is_some())
        .map(|(index, _)| ObjectId::new(index))?;
    let mut request = Wanted::geodesic(surface, SIZE);
    request.moving = true;
    let inside = request.placed(scene, &settings).ok()?;
    frames(steps, stage, scene, |share| {
        let (ahead, _) = inside
            .frame
            .advance(
                inside.manifold().surface(),
                [0.2 * share, 0.1 * share],
                &Options::default(),
            )
            .ok()?;
        let mut request = request.clone();
        let camera = &mut request.inside().camera;
        *camera = camera.with_frame(ahead);
        Some((settings.clone(), request))
    })
}
