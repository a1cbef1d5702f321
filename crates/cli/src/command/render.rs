//! `geotrace render`: one picture.

mod images;
mod like_window;
mod options;
mod picture;

use std::ffi::OsString;
use std::io::Cursor;
use std::path::PathBuf;

use clap::Args;
use export::print::PrintFormat;
use geometry::ManifoldError;
use image::{ImageFormat, RgbaImage};
use render::style::Theme;
use render::view::Interrupt;
use render::{Backend, Note, PictureRequest, RenderError, RenderedImage, ViewId, Views};

use scene::Scene;

use super::animation::{self, Animation};
use crate::argument::{self, Assignment, Choice, Format, ObjectColour, Size, TextureFile};
use crate::failure::Failure;
use crate::interruption;
use crate::number::show_measured;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::progress::Progress;
use crate::registry::Context;

pub(super) use images::textures;
use options::{GeodesicViewArguments, OverlayArguments, SpaceViewArguments, TracedViewArguments};

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

Positions, angles, lengths and zooms may be expressions in the program's names, such as pi/2. Params have their initial values unless set. The 3D view draws objects that depend on a grid once for each value; the geodesic view uses the first value. Files are written whole or not at all.

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
    /// A value for a param or a grid, NAME=A,B for components; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// The renderer: auto uses a hardware GPU if there is one, else the software path, and reports which
    #[arg(long, value_parser = argument::choice(&BACKENDS), default_value = "auto", value_name = "BACKEND", hide_short_help = true)]
    backend: Backend,
    /// An image (PNG or JPEG) for a surface: its left edge is at u min, its top edge at v min. `SURFACE=curvature` colours it
    /// by its Gaussian curvature: blue, white at 0, red; `SURFACE=plain` shows its colour alone. A solid shows its image at
    /// its `uv`, a background all around. A file that the current folder does not have is sought beside the program and
    /// in `--images`
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
    #[arg(long, value_name = "FACTOR", value_parser = argument::positive, default_value = "1", hide_short_help = true, allow_hyphen_values = true)]
    scale: f64,
    /// Use the settings that the window saved for this program; options given here override them
    #[arg(long)]
    like_window: bool,
    /// On Ctrl+C, keep the partial result: the samples of a traced picture, the finished frames of an animation
    #[arg(long, hide_short_help = true)]
    partial: bool,
    #[command(flatten)]
    motion: animation::Arguments,
    #[command(flatten)]
    geodesic: GeodesicViewArguments,
    #[command(flatten)]
    overlays: OverlayArguments,
    #[command(flatten)]
    space: SpaceViewArguments,
    #[command(flatten)]
    traced: TracedViewArguments,
    /// The words of the command line
    #[arg(skip)]
    pub(super) words: Vec<OsString>,
}

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

impl Arguments {
    /// The view: unless given, the 3D view, or the traced view of a scene that states its picture.
    fn view(&self, views: &Views, scene: &Scene) -> ViewId {
        let default = || ViewId::of_scene(views.default_of(scene).name());
        self.view.clone().unwrap_or_else(default)
    }

    /// The picture's size in pixels.
    fn size(&self, scene: &Scene) -> [u32; 2] {
        let usual = if scene.is_script() {
            [800, 600]
        } else {
            [800, 800]
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
    let views = &context.registry.views;
    let extension = arguments.output.extension().unwrap_or_default();
    let print = PrintFormat::of_extension(&extension.to_string_lossy());
    if arguments.space.hidden_lines && print.is_none() {
        return Err(Failure::usage(
            "`--hidden-lines` requires vector output: write to an .svg or a .pdf",
        ));
    }
    let mut params = program.values(&arguments.set)?;
    arguments.motion.begin(&program, &mut params)?;
    program.run_for(&params)?;
    let program = &program;
    let images = textures(&arguments.texture, arguments.images.as_deref(), program)?;
    let request = picture::request(arguments, views, program, params, &images)?;
    let motion = &arguments.motion;
    let script = motion.script(program, &request)?;
    let animation = motion.animation(&arguments.output)?;
    let is_refined = request.view.samples().is_some() && print.is_none();
    if arguments.partial {
        check_partial(animation.as_ref(), is_refined)?;
    }
    let request = script.steady(&request);
    let request = request.map_err(|error| animation::failure(error, program))?;
    let mut notes = picture::idle_options(arguments, &request);
    notes.extend(picture::idle_colours(arguments, &request));
    notes.extend(motion.idle_values(&arguments.set));
    let reached = script.walk_ends_after(&request);
    if let Some(reached) = reached.map_err(|error| animation::failure(error, program))? {
        notes.push(format!(
            "the walk ends at an edge of the surface, after {}",
            show_measured(reached)
        ));
    }
    notes.extend(picture::empty_space(&request.scene, &request.view));
    notes.extend(picture::partial_figures(
        arguments,
        program,
        &request.params,
    )?);
    for note in notes {
        output::print_error(&format!("note: {note}\n"));
    }
    let frame = |share: f64| -> Result<PictureRequest, Failure> {
        let frame = script.frame_at(&request, share);
        let mut frame = frame.map_err(|error| animation::failure(error, program))?;
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
        if arguments.partial {
            // There is something to keep.
            interruption::ask_for_end_first();
        }
        let notes = images.notes(program, &request).into_iter();
        picture.notes.extend(notes.map(Note::Remark));
        Ok(picture)
    };
    if arguments.partial && is_refined {
        interruption::ask_for_end_first();
    }
    let inputs = Inputs::new(&arguments.file, images.files());
    if let Some(animation) = animation {
        let describe = |picture: &Picture, name: &str| described(picture, name, &request, views);
        return animation.write(&inputs, request.size, &draw, describe);
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

/// Refuses `--partial` where no part of the output could be kept.
fn check_partial(animation: Option<&Animation>, is_refined: bool) -> Result<(), Failure> {
    match animation {
        Some(animation) => animation.check_partial(),
        None if is_refined => Ok(()),
        None => Err(Failure::Usage {
            message: "--partial: there is no part of this picture that could be kept".to_owned(),
            hint: Some(
                "it keeps the samples of a traced picture in a .png, or the frames of an animation"
                    .to_owned(),
            ),
        }),
    }
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
    text.push_str(&described(picture, name, request, views));
    text
}

/// The line for standard error with the view of the picture and its backend.
fn described(picture: &Picture, name: &str, request: &PictureRequest, views: &Views) -> String {
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
    format!(
        "{name}: {view}, {width}×{height} pixels, drawn by {}\n",
        picture.backend
    )
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
        RenderError::CameraOutside { .. }
        | RenderError::Camera(_)
        | RenderError::Size(_)
        | RenderError::Scale(_) => Failure::usage(message),
        RenderError::Manifold(ManifoldError::TooLarge { .. }) => Failure::Input {
            message,
            hint: Some("the 3D view does without them".into()),
        },
        RenderError::Manifold(error) => Failure::no_manifold(&error),
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
