//! Requests become commands, and commands the same requests again.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use clap::CommandFactory;
use export::command_line::{command, options};
use geometry::Manifold;
use render::figure::{Figure, FigureKind};
use render::geodesic_view::PlacedCamera;
use render::measured::{lines, measure};
use render::point::WorldPoint;
use render::request::part::SpaceOptions;
use render::request::{Overlays, Spacing};
use render::shared::Shared;
use render::style;
use render::style::Theme;
use render::texture::{TexelBudget, Texture};
use render::trail::Trail;
use render::view::geodesic::GeodesicOptions;
use render::view::traced::TracedOptions;
use render::viewpoint::{GeodesicCamera, Projection, Viewpoint};
use render::{Backend, PictureMethod, PictureRequest, Views, most_traced_operations};
use scene::{ObjectId, ParamValues};

use super::{Arguments, picture, textures};
use crate::argument::Format;
use crate::command::Arguments as CommandArguments;
use crate::program::LoadedProgram;
use crate::registry::{Context, Registry};

const PROGRAM: &str = "\
param a : [0.5, 2];
param T : [0, 1], [-1, 1];
grid k : [0, 2pi, 3];
curve c(t) = (a cos t, a sin t, T_2 + cos(k)), t : [0, 2pi];
surface s(u, v) = ((2 + a cos v) cos u, (2 + a cos v) sin u, a sin v), u : [0, 2pi], v : [0, 2pi];
surface globe(u, v) = (cos v cos u, cos v sin u, sin v + T_1), u : [0, 2pi], v : [-pi/2, pi/2];
metric h(u, v) = (1/v^2, 0, 1/v^2), u : [-3, 3], v : [0.2, 5];
geodesic g(t) : s = (0, 0) @ (1, 0.5), t : [0, 3];
point p = (0, 0, a + k);
vector w = (1, T_1, 0) @ p;
solid dot(x, y, z) = x^2 + y^2 + z^2 - 0.04;
camera eye = (0, 4, -1) @ (0, -4, 1);
";

/// A program in a folder of its own, whose name a shell would take apart.
struct Bench {
    folder: tempfile::TempDir,
    context: Context,
    program: LoadedProgram,
}

const NAME: &str = "it's a torus.gtr";

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(NAME);
        std::fs::write(&path, PROGRAM).expect("written");
        let image = image::RgbaImage::from_fn(6, 4, |x, y| {
            image::Rgba([40 * x as u8, 60 * y as u8, 90, 255])
        });
        image
            .save(folder.path().join("map one.png"))
            .expect("saved");
        let context = Context {
            registry: Registry::standard(),
            language: None,
        };
        let program = LoadedProgram::load(&context, &path, Format::Human).expect("no errors");
        Self {
            folder,
            context,
            program,
        }
    }

    fn views(&self) -> &Views {
        &self.context.registry.views
    }

    /// The words of the line for a shell, as a shell reads them.
    fn words(&self, request: &PictureRequest) -> Vec<String> {
        let path = self.folder.path().join(NAME);
        let line = command(&path, Path::new("out.png"), &options(request, self.views()));
        let printed = line.replacen("geotrace", r"printf '%s\n'", 1);
        let output = std::process::Command::new("sh")
            .args(["-c", &printed])
            .output()
            .expect("a shell");
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        let words = text.lines().map(str::to_owned);
        std::iter::once("geotrace".to_owned())
            .chain(words)
            .collect()
    }

    /// The request that the command line makes of words.
    fn read(&self, words: &[String]) -> PictureRequest {
        let parsed = CommandArguments::parse_with(&self.context.registry, words);
        let parsed = parsed.unwrap_or_else(|error| panic!("{words:?}: {error}"));
        let Some(crate::command::Command::Render(arguments)) = parsed.command else {
            panic!("another command");
        };
        let path = self.folder.path().join(NAME);
        let mut program =
            LoadedProgram::load(&self.context, &path, Format::Human).expect("no errors");
        let params = program.set_params(&arguments.set).expect("values");
        let images = textures(&arguments.texture, None, &program).expect("images");
        let request = picture::request(&arguments, self.views(), &program, params, &images);
        let request = request.unwrap_or_else(|failure| panic!("{words:?}: {failure:?}"));
        // Scenes are equal if they are one.
        PictureRequest {
            scene: self.program.scene().into(),
            ..request
        }
    }

    fn object(&self, name: &str) -> ObjectId {
        self.program.objects(name).expect("it is declared")[0]
    }
}

/// Numbers without an order (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn often(&mut self) -> bool {
        self.below(2) == 0
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn colour(&mut self) -> [u8; 3] {
        std::array::from_fn(|_| self.next() as u8)
    }
}

fn random_request(bench: &Bench, random: &mut Random) -> PictureRequest {
    let scene = bench.program.scene();
    let mut params = ParamValues::initial(scene);
    let mut set = |name: &str, values: &[f64]| {
        params
            .set(scene, name, values)
            .expect("within its interval");
    };
    if random.often() {
        set("a", &[random.between(0.5, 2.0)]);
        set("T", &[random.between(0.0, 1.0), random.between(-1.0, 1.0)]);
    }
    if random.often() {
        set("k", &[random.between(0.0, 6.0)]);
    }
    let surface = bench.object(["s", "globe", "h"][random.below(3) as usize]);
    let size = [16 + random.below(40) as u32, 16 + random.below(40) as u32];
    let mut camera = GeodesicCamera::new(surface);
    if random.often() {
        let at = [random.between(0.0, 1.5), random.between(0.3, 1.5)];
        camera = camera.at(at).zoomed(random.between(0.1, 3.0));
    }
    if random.often() {
        // A camera that has been moved, as the window has it.
        let placed = PlacedCamera::new(scene, &params, &camera, size).expect("placed");
        let mut turned = placed.frame.turned(random.between(-4.0, 4.0));
        if random.often() {
            turned.y = turned.y.map(|y| -y);
        }
        let turned = GeodesicCamera::new(surface).with_frame(turned);
        let placed = PlacedCamera::new(scene, &params, &turned, size).expect("placed");
        camera = placed.by_angle();
    }
    let is_space = random.often();
    let is_traced = is_space && random.below(3) == 0;
    let mut view = match (is_traced, is_space) {
        (true, _) => TracedOptions {
            space: SpaceOptions {
                declared: random.often().then(|| "eye".to_owned()),
                ..SpaceOptions::default()
            },
            samples: Some(1 + random.below(3) as u32),
            bounces: (random.below(2) == 0).then_some(3),
            look: (random.below(2) == 0).then_some(tracer::PictureLook::Crt),
            gamma: (random.below(2) == 0).then_some(2.2),
            max_operations: Some(most_traced_operations(size)),
        }
        .into(),
        (_, true) => bench.views().first().options(None),
        _ => GeodesicOptions {
            method: [PictureMethod::Fan, PictureMethod::Adaptive][random.below(2) as usize],
            mark_centre: random.often(),
            ..GeodesicOptions::new(surface)
        }
        .into(),
    };
    let shows_camera = !is_space || (!is_traced && random.often());
    if shows_camera {
        view.show_camera(camera);
    }
    if let Some(space) = view.space_mut() {
        let mut place = || WorldPoint(std::array::from_fn(|_| random.between(-9.0, 9.0)));
        let places = [place(), place()];
        space.camera = Viewpoint {
            eye: random.often().then_some(places[0]),
            target: random.often().then_some(places[1]),
            projection: match !is_traced && random.often() {
                true => Projection::Orthographic,
                false => Projection::Perspective,
            },
        };
        let [r, g, b] = random.colour();
        space.background = match random.below(4) {
            0 => None,
            1 => Some([0; 4]),
            2 => Some([r, g, b, 77]),
            _ => Some([r, g, b, 255]),
        };
        let ids = scene.numbered().map(|(id, _)| id);
        space.hidden = ids.filter(|_| random.below(4) == 0).collect();
    }
    let theme = [Theme::Screen, Theme::Print][random.below(2) as usize];
    if theme == Theme::Print
        && let Some(space) = view.space_mut()
    {
        let [r, g, b] = style::PAPER;
        space.background.get_or_insert([r, g, b, 255]);
    }
    let mut request = PictureRequest::new(scene, params, view, size);
    request.theme = theme;
    request.scale = (random.between(0.5, 4.0) * 8.0).round() as f32 / 8.0;
    for (id, object) in scene.numbered() {
        if random.below(3) == 0 {
            request.colours.push((id, random.colour()));
        }
        if object.shape.manifold().is_some() {
            match random.below(4) {
                0 => request.curved.push(id),
                1 => request.textures.push((id, Texture::plain().into())),
                2 => {
                    let file = bench.folder.path().join("map one.png");
                    let texture = Texture::load(&file, &TexelBudget::default()).expect("an image");
                    request.textures.push((id, texture.into()));
                }
                _ => {}
            }
            if random.often() {
                request.flipped.push(id);
            }
        }
    }
    request.overlays = Overlays {
        legend: !is_traced && random.often(),
        labels: random.often(),
        axes: is_space && !is_traced && random.often(),
        hidden_lines: is_space && !is_traced && random.often(),
        cut_locus: !is_space && random.often(),
        error: !is_space && random.often(),
        conjugate_points: shows_camera && random.often(),
        wavefronts: match random.below(3) {
            0 if shows_camera => Some(Spacing::Auto),
            1 if shows_camera => Some(Spacing::Every(random.between(0.05, 1.0))),
            _ => None,
        },
    };
    if !is_traced {
        let own = (!is_space).then_some(surface);
        request.trails = trails(bench, random, &request, own.unwrap_or(bench.object("s")));
    }
    request
}

/// A path and a few figures on a surface, in places where there is something to be measured.
fn trails(
    bench: &Bench,
    random: &mut Random,
    request: &PictureRequest,
    surface: ObjectId,
) -> Vec<Shared<Trail>> {
    let scene = bench.program.scene();
    let object = scene.get(surface).expect("a surface");
    let uniforms = request.params.first_instance(scene, object);
    let manifold = Manifold::new(scene, surface, &uniforms).expect("a surface");
    let mut place = || [random.between(0.3, 1.2), random.between(0.4, 1.2)];
    let points: Vec<[f64; 2]> = (0..4).map(|_| place()).collect();
    let places = [place(), place(), place()];
    let mut all = Vec::new();
    if random.often() {
        all.push(Arc::new(Trail::through(manifold.surface(), surface, points)).into());
    }
    for kind in FigureKind::ALL {
        if random.below(6) > 0 {
            continue;
        }
        let count = 1 + random.below(kind.places() as u64) as usize;
        let is_circle = kind == FigureKind::Circle;
        let radius = (is_circle && random.often()).then(|| random.between(0.05, 0.3));
        let figure = Arc::new(Figure {
            kind,
            places: places[..count].to_vec(),
            radius,
        });
        let finding = measure(manifold.surface(), &figure).expect("measures");
        let drawn = lines(manifold.surface(), surface, &figure, Some(&finding));
        all.extend(drawn.into_iter().map(Shared::from));
    }
    all
}

/// The names of the options of the requests that were written so far.
fn names(words: &[String]) -> impl Iterator<Item = String> + '_ {
    let options = words.iter().filter_map(|word| word.strip_prefix("--"));
    options.map(|option| option.split('=').next().unwrap_or(option).to_owned())
}

#[test]
fn a_request_is_read_back_from_its_command_and_draws_the_same_bytes() {
    let bench = Bench::new();
    let mut random = Random(20_261_123);
    let mut seen = BTreeSet::new();
    for round in 0..200 {
        let request = random_request(&bench, &mut random);
        let words = bench.words(&request);
        seen.extend(names(&words));
        let again = bench.read(&words);
        let images = |request: &PictureRequest| -> Vec<(ObjectId, Texture)> {
            let textures = request.textures.iter();
            textures
                .map(|(id, texture)| (*id, (**texture).clone()))
                .collect()
        };
        assert!(
            images(&request) == images(&again),
            "round {round}: {words:?}"
        );
        let drawn = |request: &PictureRequest| -> Vec<Trail> {
            request.trails.iter().map(|it| (**it).clone()).collect()
        };
        assert_eq!(drawn(&request), drawn(&again), "round {round}: {words:?}");
        // An image that was read twice is another one, and so is a trail.
        let same_images = PictureRequest {
            textures: request.textures.clone(),
            trails: request.trails.clone(),
            ..again.clone()
        };
        assert!(request == same_images, "round {round}: {words:?}");
        if round % 20 == 0 {
            let draw = |request: &PictureRequest| {
                let drawn = render::render(bench.views(), request, Backend::Software, &|_| {});
                drawn.map(|picture| picture.image.into_raw())
            };
            assert_eq!(draw(&request), draw(&again), "round {round}: {words:?}");
        }
    }
    // Each option of the command line is written by some request, but for those that belong to no picture.
    let command = CommandArguments::command();
    let render = command.find_subcommand(super::NAME).expect("a command");
    let known = render.get_arguments().filter_map(|it| it.get_long());
    let known: BTreeSet<String> = known.map(str::to_owned).collect();
    let others = [
        "output",
        "partial",
        "backend",
        "like-window",
        "animate",
        "walk",
        "trail",
        "turntable",
        "course",
        "frames",
        "images",
        "max-operations",
        "fps",
        "help",
    ];
    let others: BTreeSet<String> = others.map(str::to_owned).into();
    let unwritten: Vec<&String> = known.difference(&seen).collect();
    let expected: Vec<&String> = others.intersection(&known).collect();
    assert_eq!(unwritten, expected);
}

#[test]
fn the_words_of_a_command_are_kept() {
    let registry = Registry::standard();
    let words = [
        "geotrace",
        "render",
        "a.gtr",
        "-o",
        "a.png",
        "--like-window",
    ];
    let parsed = CommandArguments::parse_with(&registry, words).expect("right usage");
    let Some(crate::command::Command::Render(arguments)) = parsed.command else {
        panic!("another command");
    };
    let Arguments {
        words: kept,
        like_window,
        ..
    } = *arguments;
    assert!(like_window);
    assert_eq!(kept, words);
}

#[test]
fn an_overlay_is_idle_where_the_view_does_not_draw_it() {
    let bench = Bench::new();
    let file = bench.folder.path().join(NAME);
    let overlays =
        "--legend --labels --axes --hidden-lines --cut-locus --error --conjugate --wavefronts=0.5";
    for view in [
        "--view=3d",
        "--view=3d --show-camera=s",
        "--view=geodesic:s",
        "--view=traced",
    ] {
        let words = ["geotrace", "render", "-o", "out.png"].into_iter();
        let words = words.chain(view.split(' ')).chain(overlays.split(' '));
        let words: Vec<String> = words.map(str::to_owned).collect();
        let words = [words, vec![file.display().to_string()]].concat();
        let request = bench.read(&words);
        let parsed = CommandArguments::parse_with(&bench.context.registry, &words);
        let Some(crate::command::Command::Render(arguments)) = parsed.expect("options").command
        else {
            panic!("another command");
        };
        let notes = picture::idle_options(&arguments, &request);
        let drawn = request.view.drawn(request.overlays);
        for (option, is_drawn) in [
            ("--legend", drawn.legend),
            ("--labels", drawn.labels),
            ("--axes", drawn.axes),
            ("--hidden-lines", drawn.hidden_lines),
            ("--cut-locus", drawn.cut_locus),
            ("--error", drawn.error),
            ("--conjugate", drawn.conjugate_points),
            ("--wavefronts", drawn.wavefronts.is_some()),
        ] {
            let is_idle = notes
                .iter()
                .any(|note| note.split(' ').next() == Some(option));
            assert_eq!(is_idle, !is_drawn, "{view} {option}: {notes:?}");
        }
    }
}

#[test]
fn options_without_an_effect_are_noted() {
    let bench = Bench::new();
    let file = bench.folder.path().join(NAME);
    let of_solid = "belongs to the geodesic view of a solid";
    let waves = [
        format!("--wavefronts {of_solid}"),
        format!("--conjugate {of_solid}"),
    ];
    let inside = "--wavefronts belongs to the geodesic view: add `--view geodesic`";
    for (options, expected) in [
        ("--show-camera=dot --wavefronts=0.5 --conjugate", &waves[..]),
        ("--show-camera=s --wavefronts=0.5 --conjugate", &[]),
        (
            "--view=traced --gamma=2",
            &["--gamma belongs to `--look crt`".to_owned()],
        ),
        ("--view=traced --look=crt --gamma=2", &[]),
        ("--view=traced --wavefronts=0.5", &[inside.to_owned()]),
    ] {
        let words = ["geotrace", "render", "-o", "out.png"].into_iter();
        let words = words.chain(options.split(' ')).map(str::to_owned);
        let words: Vec<String> = words.chain([file.display().to_string()]).collect();
        let request = bench.read(&words);
        let parsed = CommandArguments::parse_with(&bench.context.registry, &words);
        let Some(crate::command::Command::Render(arguments)) = parsed.expect("options").command
        else {
            panic!("another command");
        };
        let notes = picture::idle_options(&arguments, &request);
        assert_eq!(notes, expected, "{options}");
    }
}
