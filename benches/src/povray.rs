//! The same scenes by the traced view in f64 and on a GPU, and by POV-Ray: pictures beside pictures, times beside times.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Duration;

use geometry::solids::{RayScene, RaySceneOptions, SOLID_COLOUR, StandardLights, srgb};
use glam::DVec3;
use image::RgbImage;
use render::gpu::Gpu;
use render::view::traced::TracedOptions;
use render::{PictureRequest, Renderer};
use scene::ParamValues;
use tracer::camera::LensCamera;
use tracer::picture::LightSums;
use tracer::shade::Scenery;
use tracer::srgb::bytes;

use crate::measure::{process_clock, processor_time};
use crate::traced::{RUNS, make_ready, times};

const SIZE: [u32; 2] = [640, 480];
/// Reflections in both programs.
const BOUNCES: u32 = 5;
/// A byte may be off by so much.
const CLOSE: u8 = 2;

/// A scene in both languages.
struct Compared {
    title: &'static str,
    program: String,
    /// Its objects and lights in POV-Ray's language.
    description: String,
    samples: u32,
    /// True if both pictures should be the same.
    same: bool,
    /// True if the GPU's pass draws it.
    has_tables: bool,
}

/// A light for each place, so that all together are as strong as one.
fn lights(places: &[[f64; 3]]) -> [String; 2] {
    let power = 1.0 / places.len() as f64;
    let (mut ours, mut theirs) = (String::new(), String::new());
    for (k, [x, y, z]) in places.iter().enumerate() {
        let name = char::from(b'a' + k as u8);
        let _ = writeln!(
            ours,
            "light lamp{name} = @ ({x}, {y}, {z}), power : {power};"
        );
        let _ = writeln!(theirs, "light_source {{ <{x}, {y}, {z}> rgb {power} }}");
    }
    [ours, theirs]
}

const LAMPS: [[f64; 3]; 4] = [
    [6.0, -6.0, 8.0],
    [-7.0, -4.0, 7.0],
    [2.0, -9.0, 5.0],
    [-3.0, 5.0, 9.0],
];

/// One carved box and seven mirror balls on a mirror.
fn carved(camera: &str, title: &'static str, samples: u32) -> Compared {
    let [lamps, sources] = lights(&LAMPS);
    let mut program = format!(
        "solid box(x, y, z) = max(abs x, abs y, abs z) - 1;
function rod(x, y, z) = x^2 + y^2 - 0.36;
solid carved = box \\ rod \\ rod @ rotate (pi/2, 0, 0) \\ rod @ rotate (0, pi/2, 0),
    color : (0.8, 0.5, 0.3), diffuse : 1, specular : 0;
solid ground(x, y, z) = z + 1, color : 0.5, diffuse : 0.7, mirror : 0.3, specular : 0;
background none = 0;
{lamps}camera eye = (0.5, 7, -2.4) @ (-0.5, -8, 3), fov : 0.7{camera};
"
    );
    let mut description = format!(
        "difference {{
  box {{ -1, 1 }}
  cylinder {{ <0, 0, -2>, <0, 0, 2>, 0.6 }}
  cylinder {{ <0, -2, 0>, <0, 2, 0>, 0.6 }}
  cylinder {{ <-2, 0, 0>, <2, 0, 0>, 0.6 }}
  pigment {{ srgb <0.8, 0.5, 0.3> }} finish {{ ambient 0 diffuse 1 }}
}}
plane {{ z, -1 pigment {{ srgb 0.5 }} finish {{ ambient 0 diffuse 0.7 reflection 0.3 }} }}
{sources}"
    );
    for k in 0..7 {
        let angle = f64::from(k) * std::f64::consts::TAU / 7.0;
        let (x, y) = (2.6 * angle.cos(), 2.6 * angle.sin());
        let name = char::from(b'a' + k as u8);
        let _ = writeln!(
            program,
            "solid ball{name}(x, y, z) = (x - {x})^2 + (y - {y})^2 + (z + 0.4)^2 - 0.36,
    color : 0.8, diffuse : 0.4, mirror : 0.6, specular : 0;"
        );
        let _ = writeln!(
            description,
            "sphere {{ <{x}, {y}, -0.4>, 0.6 pigment {{ srgb 0.8 }} finish {{ ambient 0 diffuse 0.4 reflection 0.6 }} }}"
        );
    }
    Compared {
        title,
        program,
        description,
        samples,
        same: samples == 1,
        has_tables: true,
    }
}

/// 400 boxes, of each of which three balls are taken away.
fn boxes() -> Compared {
    let [lamps, sources] = lights(&LAMPS[..2]);
    let program = format!(
        "grid i : [-9.5, 9.5, 20];
grid j : [-9.5, 9.5, 20];
function box(x, y, z) = max(abs x, abs y, abs z) - 0.4;
function ball(x, y, z) = x^2 + y^2 + z^2 - 0.09;
solid cut = box \\ ball @ (0.4, 0, 0) \\ ball @ (0, -0.4, 0) \\ ball @ (0, 0, 0.4);
solid all = cut @ (i, j, 0), color : (0.7, 0.75, 0.8), diffuse : 1, specular : 0;
background none = 0;
{lamps}camera eye = (0.2, 7, -5) @ (-0.5, -18, 13), fov : 0.7;
"
    );
    let mut description = format!(
        "#declare Cut = difference {{
  box {{ -0.4, 0.4 }}
  sphere {{ <0.4, 0, 0>, 0.3 }} sphere {{ <0, -0.4, 0>, 0.3 }} sphere {{ <0, 0, 0.4>, 0.3 }}
  pigment {{ srgb <0.7, 0.75, 0.8> }} finish {{ ambient 0 diffuse 1 }}
}}
{sources}"
    );
    for k in 0..400 {
        let (i, j) = (f64::from(k / 20) - 9.5, f64::from(k % 20) - 9.5);
        let _ = writeln!(description, "object {{ Cut translate <{i}, {j}, 0> }}");
    }
    Compared {
        title: "400 boxes with three cuts each",
        program,
        description,
        samples: 1,
        same: true,
        has_tables: true,
    }
}

/// A torus: ours as a parametric surface, POV-Ray's as the quartic that it has for it.
fn torus() -> Compared {
    let [lamps, sources] = lights(&LAMPS[..1]);
    let program = format!(
        "surface s(u, v) = ((2 + 0.7cos v) cos u, (2 + 0.7cos v) sin u, 0.7sin v), u : [0, 2pi], v : [0, 2pi],
    color : 0.8, diffuse : 1, specular : 0;
background none = 0;
{lamps}camera eye = (0, 7, -4) @ (0, -7, 4), fov : 0.7;
"
    );
    let description = format!(
        "torus {{ 2, 0.7 rotate x*90 pigment {{ srgb 0.8 }} finish {{ ambient 0 diffuse 1 }} }}
{sources}"
    );
    Compared {
        title: "a torus, parametric beside POV-Ray's own",
        program,
        description,
        samples: 1,
        same: true,
        has_tables: false,
    }
}

/// A picture and the processor time that it took.
struct Drawn {
    picture: RgbImage,
    time: Duration,
}

/// Draws with one thread.
fn ours(compared: &Compared) -> Result<(Drawn, LensCamera), String> {
    let compilation = scene::geotrace::compile(&compared.program);
    let scene = compilation
        .scene
        .ok_or_else(|| format!("{:?}", compilation.diagnostics))?;
    let params = ParamValues::initial(&scene);
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| srgb(SOLID_COLOUR),
        thickness: None,
        stage: true,
        picture_look: Default::default(),
    };
    let mut camera = None;
    let mut picture = RgbImage::new(SIZE[0], SIZE[1]);
    let time = processor_time(|| {
        let rays = RayScene::new(&scene, &params, &options);
        let Some(eye) = rays.cameras().first() else {
            return;
        };
        let nothing = StandardLights {
            ambient: 0.0,
            fill: 0.0,
            key: 0.0,
            key_direction: DVec3::Z,
        };
        let lights = rays.lights(&eye.lens, &nothing);
        let scenery = Scenery {
            world: rays.world(),
            sheets: rays.sheets(),
            glass: rays.glass(),
            opaque: rays.opaque(),
            look: &|face| rays.look(face, &|_, _| None),
            lights: &lights,
            background: &|direction| rays.background(direction, DVec3::ZERO, None),
            bounces: BOUNCES,
            picture_look: Default::default(),
            sides: &[],
        };
        let mut sums = LightSums::new(SIZE);
        sums.add(&scenery, &eye.lens, None, compared.samples, 1, &|_| true);
        for (pixel, light) in picture.pixels_mut().zip(sums.means()) {
            pixel.0 = bytes(light);
        }
        camera = Some(eye.lens);
    });
    let camera = camera.ok_or("the program declares no camera")?;
    Ok((Drawn { picture, time }, camera))
}

/// What the GPU's pass takes: the time of a picture, the processor time of all threads in it (a driver that is a program
/// draws on the processor), and the share of samples that were left to f64.
fn by_gpu(gpu: &Arc<Gpu>, compared: &Compared) -> Result<String, String> {
    let scene = testing::draw::scene(&compared.program);
    let params = ParamValues::initial(&scene);
    let options = TracedOptions {
        samples: Some(compared.samples),
        bounces: Some(BOUNCES),
        ..TracedOptions::default()
    };
    let request = PictureRequest::new(scene, params, options, SIZE);
    let mut renderer = Renderer::on_gpu(gpu.clone());
    make_ready(&mut renderer, &request).map_err(|error| error.to_string())?;
    let (before, counted) = (process_clock(), renderer.counters());
    let times = times(&mut renderer, &request);
    let processor = (process_clock() - before).as_secs_f64() / RUNS as f64;
    let counters = renderer.counters();
    let left = (counters.retraced - counted.retraced) as f64;
    let all = (counters.traced - counted.traced) as f64;
    Ok(format!(
        "{times}, {processor:.3} s of the processor, {:.1} % of the samples left to f64",
        100.0 * left / all
    ))
}

/// Draws with POV-Ray and one thread; its time is that of tracing, without reading.
fn theirs(compared: &Compared, camera: &LensCamera, folder: &Path) -> Result<Drawn, String> {
    let [right, up, forward] = camera.axes();
    let height = 2.0 * (0.5 * camera.fov).tan();
    let width = height * f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let vector = |v: DVec3| format!("<{}, {}, {}>", v.x, v.y, v.z);
    let mut lens = String::new();
    if camera.aperture > 0.0 {
        let sharp = camera.position + camera.focus * forward;
        let _ = write!(
            lens,
            " focal_point {} aperture {} blur_samples {} variance 0 confidence 0.999",
            vector(sharp),
            2.0 * camera.aperture,
            compared.samples
        );
    }
    let text = format!(
        "#version 3.7;
global_settings {{ assumed_gamma 1 max_trace_level {} }}
background {{ rgb 0 }}
camera {{ perspective location {} direction {} right {} up {}{lens} }}
{}",
        BOUNCES + 1,
        vector(camera.position),
        vector(forward),
        vector(width * right),
        vector(height * up),
        compared.description
    );
    let system = |error: std::io::Error| error.to_string();
    std::fs::write(folder.join("scene.pov"), text).map_err(system)?;
    let output = Command::new("povray")
        .current_dir(folder)
        .args(["+Iscene.pov", "+Oscene.png", "-D", "-A", "+WT1"])
        .args([format!("+W{}", SIZE[0]), format!("+H{}", SIZE[1])])
        .output()
        .map_err(system)?;
    let printed = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(printed
            .lines()
            .rev()
            .take(12)
            .collect::<Vec<_>>()
            .join("\n"));
    }
    let times = printed.split("Trace Time:").nth(1);
    let seconds = times
        .and_then(|text| text.split("with").nth(1))
        .and_then(|text| text.split_whitespace().next())
        .and_then(|word| word.parse().ok())
        .ok_or("POV-Ray does not say how long it traced")?;
    let picture = image::open(folder.join("scene.png")).map_err(|error| error.to_string())?;
    Ok(Drawn {
        picture: picture.to_rgb8(),
        time: Duration::from_secs_f64(seconds),
    })
}

/// The number of pixels whose colour is not between those of ours and its neighbours, to [`CLOSE`].
fn apart(ours: &RgbImage, theirs: &RgbImage) -> usize {
    let [width, height] = SIZE;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let is_apart = |&[x, y]: &[u32; 2]| {
        let near = (y.saturating_sub(1)..=(y + 1).min(height - 1))
            .flat_map(|y| (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |x| [x, y]));
        let near: Vec<[u8; 3]> = near.map(|[x, y]| ours.get_pixel(x, y).0).collect();
        (0..3).any(|k| {
            let value = theirs.get_pixel(x, y).0[k];
            let least = near.iter().map(|colour| colour[k]).min().unwrap_or(0);
            let most = near.iter().map(|colour| colour[k]).max().unwrap_or(0);
            value < least.saturating_sub(CLOSE) || value > most.saturating_add(CLOSE)
        })
    };
    places.filter(is_apart).count()
}

/// Draws every scene with each and prints the table.
pub(crate) fn run() {
    println!(
        "The same scenes in f64, by the GPU's pass and by POV-Ray, one thread each but the GPU's driver, {} × {}",
        SIZE[0], SIZE[1]
    );
    let gpu = Gpu::shared();
    match &gpu {
        Ok(gpu) => println!("  GPU: {}", gpu.name()),
        Err(error) => println!("  GPU: {error}"),
    }
    let has_povray = Command::new("povray").arg("--version").output().is_ok();
    if !has_povray {
        println!("  there is no `povray` here");
    }
    let scenes = [
        carved("", "a carved box, seven mirror balls, a mirror", 1),
        boxes(),
        torus(),
        carved(
            ", aperture : 0.1",
            "the first one, 50 samples through a lens",
            50,
        ),
    ];
    // A driver that draws on the processor would take an hour for the samples of a lens.
    let is_real = Gpu::shared_real().is_ok();
    for compared in &scenes {
        let is_drawn = compared.has_tables && (is_real || compared.samples == 1);
        let gpu = gpu.as_ref().ok().filter(|_| is_drawn);
        match rows(compared, gpu, has_povray) {
            Ok(rows) => println!("  {}{rows}", compared.title),
            Err(error) => println!("  {} failed: {error}", compared.title),
        }
    }
}

/// What each takes for a scene, a line each.
fn rows(compared: &Compared, gpu: Option<&Arc<Gpu>>, has_povray: bool) -> Result<String, String> {
    let (drawn, camera) = ours(compared)?;
    let mut rows = format!("\n    f64      {:7.3} s", drawn.time.as_secs_f64());
    if has_povray {
        let _ = write!(
            rows,
            "\n    POV-Ray  {}",
            beside(compared, &drawn, &camera)?
        );
    }
    if let Some(gpu) = gpu {
        let _ = write!(rows, "\n    GPU     {}", by_gpu(gpu, compared)?);
    }
    Ok(rows)
}

/// What POV-Ray takes, and how its picture differs from ours.
fn beside(compared: &Compared, ours: &Drawn, camera: &LensCamera) -> Result<String, String> {
    let folder = std::env::temp_dir().join(format!("geotrace-povray-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let theirs = theirs(compared, camera, &folder);
    if std::env::var_os("KEEP").is_some() {
        let _ = ours.picture.save(folder.join("ours.png"));
        println!("  kept in {}", folder.display());
    } else {
        let _ = std::fs::remove_dir_all(&folder);
    }
    let theirs = theirs?;
    let [a, b] = [ours.time, theirs.time].map(|time| time.as_secs_f64());
    let mut row = format!("{b:7.3} s, of which f64 takes {:5.2}", a / b);
    if compared.same {
        let count = apart(&ours.picture, &theirs.picture);
        let _ = write!(row, ", {count} pixels differ beyond their neighbours");
    }
    Ok(row)
}
