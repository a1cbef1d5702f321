//! Traced pictures on the processor in f64 and on a GPU, the same scenes beside each other.

use std::time::{Duration, Instant};

use render::gpu::Gpu;
use render::view::traced::TracedOptions;
use render::{PictureRequest, RenderError, Renderer};
use scene::ParamValues;
use testing::examples;

use crate::measure::Times;

const SIZE: [u32; 2] = [320, 240];
const SAMPLES: u32 = 1;
/// Pictures of a time, after a first one.
pub(crate) const RUNS: usize = 3;

/// The examples that the GPU's pass draws.
const NAMES: [&str; 4] = ["circle", "cushion", "dice", "ring"];

/// Draws each scene on both and prints the table.
pub(crate) fn run() {
    println!(
        "Traced pictures, {} × {}, {SAMPLES} sample, all cores",
        SIZE[0], SIZE[1]
    );
    let gpu = match Gpu::shared() {
        Ok(gpu) => gpu,
        Err(error) => {
            println!("  {error}");
            return;
        }
    };
    let mut by_gpu = Renderer::on_gpu(gpu.clone());
    for name in NAMES {
        let request = request(name);
        let by_f64 = times(&mut Renderer::software(), &request);
        let start = Instant::now();
        if let Err(error) = make_ready(&mut by_gpu, &request) {
            println!("  {error}");
            return;
        }
        if name == NAMES[0] {
            println!("  {}, ready after {:.1?}", gpu.name(), start.elapsed());
        }
        let times = times(&mut by_gpu, &request);
        println!("  {name:12} f64 {by_f64}, GPU {times}");
    }
}

fn request(name: &str) -> PictureRequest {
    let scene = testing::draw::scene(&examples::one(name).source);
    let params = ParamValues::initial(&scene);
    let options = TracedOptions {
        samples: Some(SAMPLES),
        ..TracedOptions::default()
    };
    PictureRequest::new(scene, params, options, SIZE)
}

/// Draws a picture, and waits until all that the GPU needs for it has been built.
pub(crate) fn make_ready(
    renderer: &mut Renderer,
    request: &PictureRequest,
) -> Result<(), RenderError> {
    renderer.draw(request)?;
    while renderer.is_building() {
        std::thread::sleep(Duration::from_millis(1));
    }
    Ok(())
}

/// The times of [`RUNS`] pictures of which nothing is known but the scene, each a column wider than the last one.
pub(crate) fn times(renderer: &mut Renderer, request: &PictureRequest) -> Times {
    let mut request = request.clone();
    renderer.set_bounds(None);
    Times::of(RUNS, || {
        // Another size is another picture: nothing is left of the last one's samples.
        request.size[0] += 1;
        renderer.draw(&request)
    })
}
