//! `geotrace render`: one picture.

mod images;
mod like_window;
mod picture;

use std::ffi::OsString;
use std::io::Cursor;
use std::path::PathBuf;

use clap::Args;
use export::print::PrintFormat;
use geometry::ManifoldError;
use image::{ImageFormat, RgbaImage};
use render::style::Theme;
use render::view::{Interrupt, space, traced};
use render::{
    Backend, Note, PictureMethod, PictureRequest, RenderError, RenderedImage, ViewId, Views,
};
use tracer::PictureLook;

use scene::Scene;

use super::animation;
use crate::argument::{
    self, Assignment, Choice, FigureArgument, Format, ObjectColour, PathArgument, PlaceArgument,
    Quantity, Size, TextureFile, Triple,
};
use crate::failure::Failure;
use crate::interruption;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::progress::Progress;
use crate::registry::Context;

pub(super) use images::textures;

/// The name of the command.
pub(super) const NAME: &str = "render";

/// Draw a picture or an animation of a program: in 3D, traced, or from inside.
///
/// The geodesic view shows a surface as an inhabitant sees it, with the image that is painted on it: each pixel shows
/// the end of a geodesic that starts at the camera in the centre and is as long as the pixel's distance from it.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:
  geotrace render sphere.gtr -o sphere.png                                in space
  geotrace render torus.gtr -o inside.png --view geodesic --zoom 2        from inside
  geotrace render die.gtr -o die.png --view traced                        with lights and shadows
  geotrace render torus.gtr -o k.png --texture s=curvature --legend       coloured by curvature
  geotrace render torus.gtr -o figure.pdf --theme print --labels          lines as vectors
  geotrace render circle.gtr -o turn.gif --animate o=0:2pi --frames 60    an animation

`geotrace render --help` has all options, also for methods, overlays, cameras and backgrounds.",
    after_long_help = "\
Examples:
  geotrace render sphere.gtr -o sphere.png
  geotrace render circle.gtr -o circle.png --set r=0.7 --set o=1.5 --eye 0,-3,2 --target 0,0,0
  geotrace render torus.gtr -o inside.png --view geodesic:s --at 0,pi --angle 45 --zoom 2
  geotrace render sphere.gtr -o earth.png --view geodesic --texture s=earth.jpg
  geotrace render quartic.gtr -o face.png --view geodesic:q --at 1,1,1
  geotrace render lens.gtr -o lens.png --view traced:eye --samples 256
  geotrace render torus.gtr -o rings.png --view geodesic --wavefronts --cut-locus --legend
  geotrace render torus.gtr -o camera.png --show-camera s --wavefronts
  geotrace render torus.gtr -o k.png --texture s=curvature --legend --background transparent
  geotrace render torus.gtr -o figure.png --orthographic --axes --labels --size 1600x1200
  geotrace render circle.gtr -o turn.gif --animate o=0:2pi --frames 60 --fps 25
  geotrace render torus.gtr -o walk.apng --view geodesic --walk 2pi --trail

A number may be an expression in the program's names, such as pi/2. Params have their initial values unless set. The 3D view draws objects that depend on a grid once for each value; the geodesic view uses the first value. Files are written whole or not at all.

In an .svg or a .pdf, the curves, geodesics, axes and names of the 3D view are vectors above the pixels.

An animation is one of
  .gif                 255 colours
  .apng                all colours
  .mp4, .webm          a video, made by `ffmpeg` if it is installed
  .png with --frames   one picture per frame: OUT-0001.png, OUT-0002.png and so on"
)]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The file to write: a picture (.png, or for papers .svg or .pdf) or an animation (.gif, .apng, .mp4 or .webm);
    /// `-` is standard output
    #[arg(short, long, value_name = "OUT.{png,svg,pdf,gif,apng,mp4,webm}")]
    output: PathBuf,
    /// 3d, or traced, or traced:CAMERA, or geodesic, or geodesic:SURFACE (or a metric, or a solid); without a name, the
    /// program's first
    #[arg(long, value_name = "VIEW", value_parser = argument::standard_view)]
    view: Option<ViewId>,
    /// The picture's size in pixels [default: 800x800, for a CRT script 800x600]
    #[arg(long, value_name = "WxH", value_parser = argument::size, allow_hyphen_values = true)]
    size: Option<Size>,
    /// A value for a param or a grid; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// The renderer: auto uses a hardware GPU if there is one, else the software path, and reports which
    #[arg(long, value_parser = argument::choice(&BACKENDS), default_value = "auto", value_name = "BACKEND", hide_short_help = true)]
    backend: Backend,
    /// An image (PNG or JPEG) for a surface: its left edge is at u min, its top edge at v min. `SURFACE=curvature` colours it
    /// by its Gaussian curvature: blue, white at 0, red; `SURFACE=plain` shows its colour alone. A solid shows its image at
    /// its `uv`, a background all around
    #[arg(long, value_name = "OBJECT=IMAGE", value_parser = argument::texture)]
    texture: Vec<TextureFile>,
    /// A folder with the images that the program names, such as `image : earth`, if they are not beside it
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
    /// A surface whose image is flipped upside down; may be given several times. In the built-in image, the letters
    /// are flipped
    #[arg(long, value_name = "SURFACE", hide_short_help = true)]
    flip: Vec<String>,
    /// Colours for a screen, or for paper: a white background, and dark points and lines
    #[arg(long, value_parser = argument::choice(&THEMES), default_value = "screen", value_name = "THEME")]
    theme: Theme,
    /// A colour for an object, such as c=#1a2b3c; a surface's colour multiplies its image. May be given several times
    #[arg(long, alias = "color", value_name = "OBJECT=COLOUR", value_parser = argument::object_colour)]
    colour: Vec<ObjectColour>,
    /// The scale of lines, points and text
    #[arg(long, value_name = "FACTOR", value_parser = argument::positive, default_value = "1", hide_short_help = true)]
    scale: f64,
    /// Use the settings that the window saved for this program; options given here override them
    #[arg(long)]
    like_window: bool,
    /// On Ctrl+C, keep the partial result: the samples of a traced picture, the finished frames of an animation
    #[arg(long, hide_short_help = true)]
    partial: bool,
    #[command(flatten)]
    motion: animation::Arguments,
    /// The camera's position: u,v, or near a solid x,y,z [default: the middle of the domain, or the point where the
    /// ray along x from the middle of the solid's box leaves the solid]
    #[arg(long, value_name = "U,V|X,Y,Z", value_parser = argument::place, allow_hyphen_values = true, help_heading = "Geodesic view")]
    at: Option<PlaceArgument>,
    /// The angle from the direction of increasing u to the picture's right, towards increasing v
    #[arg(long, value_name = "DEG", value_parser = argument::finite, allow_hyphen_values = true, help_heading = "Geodesic view", hide_short_help = true)]
    angle: Option<f64>,
    /// Show the surface from its other side: the picture is mirrored
    #[arg(long, help_heading = "Geodesic view", hide_short_help = true)]
    mirrored: bool,
    /// A setting of the view: `centre=off` leaves out the ring at the picture's centre
    #[arg(long, value_name = "NAME=on|off", value_parser = argument::setting, help_heading = "Geodesic view", hide_short_help = true)]
    setting: Vec<(String, bool)>,
    /// The distance on the surface from the picture's centre to its nearest edge
    #[arg(long, value_name = "Z", value_parser = argument::quantity, allow_hyphen_values = true, help_heading = "Geodesic view")]
    zoom: Option<Quantity>,
    /// The method of geodesic tracing
    #[arg(long, value_parser = argument::choice(&METHODS), value_name = "M", help_heading = "Geodesic view", hide_short_help = true)]
    method: Option<PictureMethod>,
    /// Draw a legend of the hatchings, lines and colours
    #[arg(long, help_heading = "Drawn over the picture")]
    legend: bool,
    /// Label the visible objects and the position of the geodesic camera
    #[arg(long, help_heading = "Drawn over the picture")]
    labels: bool,
    /// Draw geodesic circles around the camera, SPACING apart [default: the least 1, 2 or 5 times a power of ten that
    /// is at least a quarter of the distance to the picture's edge]. In the 3D view with --show-camera
    #[arg(long, value_name = "SPACING", num_args = 0..=1, value_parser = argument::positive, help_heading = "Drawn over the picture", hide_short_help = true)]
    wavefronts: Option<Option<f64>>,
    /// Mark the conjugate points, where geodesics from the camera meet their neighbours; in the 3D view with --show-camera
    #[arg(long, help_heading = "Drawn over the picture", hide_short_help = true)]
    conjugate: bool,
    /// Draw the cut locus, beyond which every point is nearer along another geodesic
    #[arg(long, help_heading = "Drawn over the picture", hide_short_help = true)]
    cut_locus: bool,
    /// Paint the estimated error over the picture
    #[arg(long, help_heading = "Drawn over the picture", hide_short_help = true)]
    error: bool,
    /// A figure on a surface, as the window measures it: place, distance, circle or triangle with its points A, B, C;
    /// for a circle, the centre and a point on it, or its radius. May be given several times
    #[arg(long, value_name = "SURFACE=KIND:U,V:…", value_parser = argument::figure, allow_hyphen_values = true, help_heading = "Drawn over the picture", hide_short_help = true)]
    figure: Vec<FigureArgument>,
    /// A path on a surface with its length, through points that are joined by straight lines in the parameters, as
    /// the window draws a walk. May be given several times
    #[arg(long, value_name = "SURFACE=U,V:U,V:…", value_parser = argument::path, allow_hyphen_values = true, help_heading = "Drawn over the picture", hide_short_help = true)]
    path: Vec<PathArgument>,
    /// An object to hide; objects on it are still drawn. May be given several times
    #[arg(long, value_name = "OBJECT", help_heading = "3D view")]
    hide: Vec<String>,
    /// Draw a box around the scene, with ticks at round numbers
    #[arg(long, help_heading = "3D view")]
    axes: bool,
    /// In an .svg or a .pdf, draw the hidden parts of curves and geodesics dashed
    #[arg(long, help_heading = "3D view", hide_short_help = true)]
    hidden_lines: bool,
    /// The background: transparent, white, black, #RRGGBB or #RRGGBBAA. In the traced view, the colour of the sky
    /// straight up and down, unless the program has a `background`
    #[arg(long, value_name = "COLOUR", value_parser = argument::colour, help_heading = "3D view", hide_short_help = true)]
    background: Option<[u8; 4]>,
    /// In the 3D view, show the geodesic camera of a surface (placed by --at, --angle, --zoom): its frame as arrows,
    /// the axes and the edge of its view as geodesics
    #[arg(
        long,
        value_name = "SURFACE",
        help_heading = "3D view",
        hide_short_help = true
    )]
    show_camera: Option<String>,
    /// The camera's position [default: where everything is visible]
    #[arg(long, value_name = "X,Y,Z", value_parser = argument::triple, allow_hyphen_values = true, help_heading = "3D view")]
    eye: Option<Triple>,
    /// The camera's target [default: the middle of the drawn objects]
    #[arg(long, value_name = "X,Y,Z", value_parser = argument::triple, allow_hyphen_values = true, help_heading = "3D view", hide_short_help = true)]
    target: Option<Triple>,
    /// Use parallel lines of sight: equal lengths are equal in the picture
    #[arg(long, help_heading = "3D view")]
    orthographic: bool,
    /// Samples per pixel [default: 16, through a lens 64, for a CRT script the script's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(traced::MAX_SAMPLES)), help_heading = "Traced view")]
    samples: Option<u32>,
    /// The maximum number of reflections and refractions along a ray [default: 8, for a CRT script the script's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(traced::MAX_BOUNCES)), help_heading = "Traced view")]
    bounces: Option<u32>,
    /// Work limit for one sample of every pixel, in operations on solids, lights and surfaces [default: a few
    /// seconds' worth]
    #[arg(
        long,
        value_name = "N",
        help_heading = "Traced view",
        hide_short_help = true
    )]
    max_operations: Option<u64>,
    /// The conversion of light to colours: geotrace, or crt as in the CRT scene language [default: geotrace, for a
    /// CRT script crt]
    #[arg(long, value_name = "LOOK", value_parser = argument::choice(&LOOKS), help_heading = "Traced view")]
    look: Option<PictureLook>,
    /// With --look crt, light is raised to the power 1/GAMMA [default: the script's gamma, or 1]
    #[arg(long, value_name = "GAMMA", value_parser = argument::positive, help_heading = "Traced view", hide_short_help = true)]
    gamma: Option<f64>,
    /// The words of the command line
    #[arg(skip)]
    pub(super) words: Vec<OsString>,
}

const LOOKS: [Choice<PictureLook>; 2] = [
    Choice::new(
        PictureLook::Geotrace.name(),
        "Linear light, stated colours are sRGB",
        PictureLook::Geotrace,
    ),
    Choice::new(
        PictureLook::Crt.name(),
        "Those of the CRT scene language",
        PictureLook::Crt,
    ),
];

const THEMES: [Choice<Theme>; 2] = [
    Choice::new(
        "screen",
        "Bright colours on a dark background",
        Theme::Screen,
    ),
    Choice::new("print", "Dark points and lines on white", Theme::Print),
];

const BACKENDS: [Choice<Backend>; 3] = [
    Choice::new(
        "auto",
        "A hardware GPU if there is one, else the software path",
        Backend::Auto,
    ),
    Choice::new("gpu", "A GPU, or an error", Backend::Gpu),
    Choice::new(
        "software",
        "The processor's cores, in double precision",
        Backend::Software,
    ),
];

const METHODS: [Choice<PictureMethod>; 5] = [
    Choice::new("auto", "The best method: fan", PictureMethod::Fan),
    Choice::new(
        PictureMethod::Fan.name(),
        "A fan of rays that all pixels share, in double precision, interpolated by their Jacobi fields",
        PictureMethod::Fan,
    ),
    Choice::new(
        PictureMethod::FanLinear.name(),
        "The same fan, interpolated linearly, for comparison",
        PictureMethod::FanLinear,
    ),
    Choice::new(
        PictureMethod::Adaptive.name(),
        "A geodesic for each pixel, with steps as long as the tolerance allows, in double precision",
        PictureMethod::Adaptive,
    ),
    Choice::new(
        PictureMethod::Rk4Pixel.name(),
        "A geodesic for each pixel, with steps of equal length, as in the thesis",
        PictureMethod::Rk4Pixel,
    ),
];

impl Arguments {
    /// The view: unless given, the 3D view, or the traced view of a scene that states its picture.
    fn view(&self, scene: &Scene) -> ViewId {
        self.view.clone().unwrap_or_else(|| {
            let name = match scene.picture {
                Some(_) => traced::NAME,
                None => space::NAME,
            };
            ViewId {
                kind: name.to_owned(),
                object: None,
            }
        })
    }

    /// The picture's size in pixels.
    fn size(&self, scene: &Scene) -> [u32; 2] {
        let usual = match scene.picture {
            Some(_) => [800, 600],
            None => [800, 800],
        };
        self.size.map_or(usual, |size| size.0)
    }
}

/// A picture in memory.
pub(super) type Picture = RenderedImage<RgbaImage>;

/// Draws one picture and writes it.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let program = LoadedProgram::load(context, &arguments.file, Format::Human)?;
    if arguments.like_window {
        let arguments = like_window::completed(arguments, &program, context)?;
        return draw(&arguments, program, context);
    }
    draw(arguments, program, context)
}

fn draw(
    arguments: &Arguments,
    mut program: LoadedProgram,
    context: &Context,
) -> Result<(), Failure> {
    let params = program.params(&arguments.set)?;
    let program = &program;
    let views = &context.registry.views;
    let images = textures(&arguments.texture, arguments.images.as_deref(), program)?;
    let request = picture::request(arguments, views, program, params, &images)?;
    let motion = &arguments.motion;
    let script = motion.script(program, &request)?;
    let animation = motion.animation(&arguments.output)?;
    let request = script.steady(&request).map_err(animation::failure)?;
    let mut notes = picture::idle_options(arguments, &request.view);
    notes.extend(picture::idle_colours(arguments, &request));
    notes.extend(picture::empty_space(&request.scene, &request.view));
    for note in notes {
        output::print_error(&format!("note: {note}\n"));
    }
    let frame = |share: f64| -> Result<PictureRequest, Failure> {
        let frame = script.frame_at(&request, share);
        let mut frame = frame.map_err(animation::failure)?;
        frame.textures = images.at(&frame.scene, &frame.params)?;
        frame.curved.clear();
        if *frame.params != *request.params {
            // They are those of the surface as it is now; the camera's own is already.
            let walked = frame.trails.split_off(request.trails.len());
            frame.trails = picture::trails(arguments, program, &frame.params)?;
            frame.trails.extend(walked);
        }
        Ok(frame)
    };
    let draw = |share: f64, progress: &(dyn Fn(f32) + Sync)| -> Result<Picture, Failure> {
        let request = frame(share)?;
        let drawn = match arguments.partial {
            true => {
                let interrupt = Interrupt::new(interruption::is_interrupted);
                render::render_until(views, &request, arguments.backend, progress, &interrupt)
            }
            false => render::render(views, &request, arguments.backend, progress),
        };
        let mut picture = drawn.map_err(failure)?;
        let notes = images.notes(program, &request).into_iter();
        picture.notes.extend(notes.map(Note::Remark));
        Ok(picture)
    };
    let extension = arguments.output.extension().unwrap_or_default();
    let print = PrintFormat::of_extension(&extension.to_string_lossy());
    if arguments.partial {
        let is_refined = request.view.samples().is_some() && print.is_none();
        match &animation {
            Some(animation) => animation.check_partial()?,
            None if is_refined => {}
            None => {
                return Err(Failure::Usage {
                    message: "--partial: there is no part of this picture that could be kept"
                        .to_owned(),
                    hint: Some(
                        "it keeps the samples of a traced picture in a .png, or the pictures of an animation"
                            .to_owned(),
                    ),
                });
            }
        }
        interruption::hear();
    }
    if arguments.hidden_lines && print.is_none() {
        return Err(Failure::usage(
            "`--hidden-lines` requires vector output: write to an .svg or a .pdf",
        ));
    }
    let inputs = Inputs::new(&arguments.file, images.files());
    if let Some(animation) = animation {
        let summary = |picture: &Picture, what: &str| summary(picture, what, &request, views);
        return animation.write(&inputs, request.size, &draw, summary);
    }
    let target = OutputTarget::apart_from(&arguments.output, &inputs)?;
    if let Some(format) = print {
        let request = frame(1.0)?;
        let notes = images.notes(program, &request);
        return print_picture(format, arguments, &request, notes, &target, views);
    }
    let progress = Progress::start("drawing");
    // A single picture shows the end of the script.
    let drawn = draw(1.0, &|done| progress.reach(done));
    drop(progress);
    let picture = drawn?;
    target.write(&png(&picture.image)?)?;
    output::print_error(&summary(&picture, &target.name(), &request, views));
    Ok(())
}

/// Draws a picture in layers and writes it for print.
fn print_picture(
    format: PrintFormat,
    arguments: &Arguments,
    request: &PictureRequest,
    notes: Vec<String>,
    target: &OutputTarget,
    views: &Views,
) -> Result<(), Failure> {
    if arguments.backend == Backend::Gpu {
        return Err(Failure::usage(
            "the lines of an SVG or a PDF are drawn by the software path: leave out `--backend gpu`",
        ));
    }
    let progress = Progress::start("drawing");
    let drawn = render::render_layers(views, request, &|done| progress.reach(done));
    drop(progress);
    let mut layers = drawn.map_err(failure)?;
    layers
        .below
        .notes
        .extend(notes.into_iter().map(Note::Remark));
    if layers.strokes.is_empty() && layers.words.is_empty() {
        let note = "this picture has no lines or text to draw as vectors: the file contains its pixels only";
        layers.below.notes.push(Note::Remark(note.to_owned()));
    }
    let title = arguments
        .file
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let bytes = format.bytes(&layers, &title);
    let bytes = bytes.map_err(|error| Failure::Internal {
        message: format!("the picture could not be encoded: {error}"),
    })?;
    target.write(&bytes)?;
    output::print_error(&summary(&layers.below, &target.name(), request, views));
    Ok(())
}

fn png(image: &RgbaImage) -> Result<Vec<u8>, Failure> {
    let mut bytes = Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| Failure::Internal {
            message: format!("the picture could not be encoded: {error}"),
        })?;
    Ok(bytes.into_inner())
}

/// The lines for standard error: the notes of the picture, its view and its backend.
fn summary(picture: &Picture, name: &str, request: &PictureRequest, views: &Views) -> String {
    let mut text = String::new();
    for note in &picture.notes {
        text.push_str(&format!("note: {note}\n"));
    }
    let id = ViewId::from_request(request);
    let title = views.get(&id.kind).map_or(&*id.kind, |view| view.title());
    let mut view = title.to_owned();
    // Inside a sentence: only "3D" stays as it is.
    if let Some(first) = view.get_mut(..1) {
        first.make_ascii_lowercase();
    }
    if let Some(object) = &id.object {
        view.push_str(&format!(" of `{object}`"));
    }
    let (width, height) = picture.image.dimensions();
    text.push_str(&format!(
        "{}: {view}, {width}×{height} pixels, drawn by {}\n",
        name, picture.backend
    ));
    text
}

pub(super) fn failure(error: RenderError) -> Failure {
    let message = error.to_string();
    match error {
        RenderError::NoView { .. } => Failure::usage(message),
        RenderError::NoGpu { .. } => Failure::Usage {
            message,
            hint: Some("`--backend auto` uses the software path if there is no GPU".into()),
        },
        RenderError::Interrupted => Failure::Input {
            message: "interrupted before every pixel had a sample: nothing is written".to_owned(),
            hint: None,
        },
        RenderError::TooMuchWork(_) => Failure::Input {
            message,
            hint: Some(
                "use a smaller `--size`, or fewer solids and lights; for a traced picture, a greater `--max-operations`"
                    .into(),
            ),
        },
        RenderError::Gpu(_) => Failure::Input {
            message,
            hint: Some("`--backend software` draws without it".into()),
        },
        RenderError::Manifold(ManifoldError::NoSurface { .. })
        | RenderError::CameraOutside { .. }
        | RenderError::Camera(_)
        | RenderError::Size(_)
        | RenderError::Scale(_) => Failure::usage(message),
        RenderError::Manifold(ManifoldError::TooLarge { .. }) => Failure::Input {
            message,
            hint: Some("the 3D view does without them".into()),
        },
        RenderError::Manifold(ManifoldError::Flat { .. } | ManifoldError::Empty { .. }) => Failure::Input {
            message,
            hint: None,
        },
        RenderError::UndefinedCamera { .. } => Failure::Input {
            message,
            hint: Some("`--at U,V` puts it elsewhere".into()),
        },
        RenderError::Internal { source, .. } => Failure::Internal {
            message: match output::keep_for_report(&source) {
                Some(path) => format!("{message}\n  the shader is kept in {}", path.display()),
                None => message,
            },
        },
    }
}

#[cfg(test)]
mod tests;
