//! The options of `geotrace render` that belong to a view or to what is drawn over it, by the headings of the help.

use clap::Args;
use render::PictureMethod;
use render::view::traced;
use tracer::PictureLook;

use crate::argument::{
    self, Choice, FigureArgument, PathArgument, PlaceArgument, Quantity, Triple,
};

/// The options of the geodesic view and of its camera.
#[derive(Args, Debug)]
#[command(next_help_heading = "Geodesic view")]
#[group(skip)]
pub(super) struct GeodesicViewArguments {
    /// The camera's position: u,v, or near a solid x,y,z [default: the middle of the domain; on a solid a point from which
    /// geodesics go far, usually where the ray along x from the middle of its box leaves it]
    #[arg(long, value_name = "U,V|X,Y,Z", value_parser = argument::place, allow_hyphen_values = true)]
    pub(super) at: Option<PlaceArgument>,
    /// The angle from the direction of increasing u to the picture's right, towards increasing v [default: 0]
    #[arg(long, value_name = "DEG", value_parser = argument::quantity, allow_hyphen_values = true, hide_short_help = true)]
    pub(super) angle: Option<Quantity>,
    /// Show the surface from its other side: the picture is mirrored
    #[arg(long, hide_short_help = true)]
    pub(super) mirrored: bool,
    /// A setting of the view: `centre=off` leaves out the ring at the picture's centre
    #[arg(long, value_name = "NAME=on|off", value_parser = argument::setting, hide_short_help = true)]
    pub(super) setting: Vec<(String, bool)>,
    /// The distance on the surface from the picture's centre to its nearest edge [default: 0.55 of the
    /// length of the shorter coordinate line through the camera, on a solid 0.86 of its longest side]
    #[arg(long, value_name = "Z", value_parser = argument::quantity, allow_hyphen_values = true)]
    pub(super) zoom: Option<Quantity>,
    /// The method of geodesic tracing
    #[arg(long, value_parser = argument::choice(&METHODS), value_name = "M", hide_short_help = true)]
    pub(super) method: Option<PictureMethod>,
}

/// The options of what is drawn over a picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Drawn over the picture")]
#[group(skip)]
pub(super) struct OverlayArguments {
    /// Draw a legend of the hatchings, lines and colours
    #[arg(long)]
    pub(super) legend: bool,
    /// Label the visible objects and the position of the geodesic camera
    #[arg(long)]
    pub(super) labels: bool,
    /// Draw geodesic circles around the camera, SPACING apart [default: the least 1, 2 or 5 times a power of ten that
    /// is at least a quarter of the distance to the picture's edge]. In the 3D view with --show-camera SURFACE
    #[arg(long, value_name = "SPACING", num_args = 0..=1, value_parser = argument::quantity, hide_short_help = true)]
    pub(super) wavefronts: Option<Option<Quantity>>,
    /// Mark the conjugate points, where geodesics from the camera meet their neighbours; in the 3D view with
    /// --show-camera SURFACE
    #[arg(long, hide_short_help = true)]
    pub(super) conjugate: bool,
    /// Draw the cut locus, beyond which every point is nearer along another geodesic
    #[arg(long, hide_short_help = true)]
    pub(super) cut_locus: bool,
    /// Paint the estimated error over the picture
    #[arg(long, hide_short_help = true)]
    pub(super) error: bool,
    /// A figure on a surface, as the window measures it: place, distance, circle or triangle with its points A, B, C;
    /// for a circle, the centre and a point on it, or its radius. May be given several times
    #[arg(long, value_name = "SURFACE=KIND:U,V:…", value_parser = argument::figure, allow_hyphen_values = true, hide_short_help = true)]
    pub(super) figure: Vec<FigureArgument>,
    /// A path on a surface with its length, through points that are joined by straight lines in the parameters, as
    /// the window draws a walk. May be given several times
    #[arg(long, value_name = "SURFACE=U,V:U,V:…", value_parser = argument::path, allow_hyphen_values = true, hide_short_help = true)]
    pub(super) path: Vec<PathArgument>,
}

/// The options of the 3D view and of its camera.
#[derive(Args, Debug)]
#[command(next_help_heading = "3D view")]
#[group(skip)]
pub(super) struct SpaceViewArguments {
    /// An object to hide; objects on it are still drawn. May be given several times
    #[arg(long, value_name = "OBJECT")]
    pub(super) hide: Vec<String>,
    /// Draw a box around the scene, with ticks at round numbers
    #[arg(long)]
    pub(super) axes: bool,
    /// In an .svg or a .pdf, draw the hidden parts of curves and geodesics dashed
    #[arg(long, hide_short_help = true)]
    pub(super) hidden_lines: bool,
    /// The background: transparent, white, black, #RRGGBB or #RRGGBBAA. In the traced view, the colour of the sky
    /// straight up and down, unless the program has a `background`
    #[arg(long, value_name = "COLOUR", value_parser = argument::colour, hide_short_help = true)]
    pub(super) background: Option<[u8; 4]>,
    /// In the 3D view, show the geodesic camera of a surface (placed by --at, --angle, --zoom): its frame as arrows,
    /// the axes and the edge of its view as geodesics
    #[arg(long, value_name = "SURFACE", hide_short_help = true)]
    pub(super) show_camera: Option<String>,
    /// The camera's position [default: where everything is visible]
    #[arg(long, value_name = "X,Y,Z", value_parser = argument::triple, allow_hyphen_values = true)]
    pub(super) eye: Option<Triple>,
    /// The camera's target [default: the middle of the drawn objects]
    #[arg(long, value_name = "X,Y,Z", value_parser = argument::triple, allow_hyphen_values = true, hide_short_help = true)]
    pub(super) target: Option<Triple>,
    /// Use parallel lines of sight: equal lengths are equal in the picture
    #[arg(long)]
    pub(super) orthographic: bool,
}

/// The options of the traced view.
#[derive(Args, Debug)]
#[command(next_help_heading = "Traced view")]
#[group(skip)]
pub(super) struct TracedViewArguments {
    /// Samples per pixel [default: 16, through a lens 64, for a CRT script the script's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(traced::MAX_SAMPLES)), allow_hyphen_values = true)]
    pub(super) samples: Option<u32>,
    /// The maximum number of reflections and refractions along a ray [default: 8, for a CRT script the script's own]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(traced::MAX_BOUNCES)), allow_hyphen_values = true)]
    pub(super) bounces: Option<u32>,
    /// Work limit for one sample of every pixel, in operations on solids, lights and surfaces [default: a few
    /// seconds' worth]
    #[arg(long, value_name = "N", hide_short_help = true)]
    pub(super) max_operations: Option<u64>,
    /// The conversion of light to colours: geotrace, or crt as in the CRT scene language [default: geotrace, for a
    /// CRT script crt]
    #[arg(long, value_name = "LOOK", value_parser = argument::choice(&LOOKS))]
    pub(super) look: Option<PictureLook>,
    /// With --look crt, light is raised to the power 1/GAMMA [default: the script's gamma, or 1]
    #[arg(long, value_name = "GAMMA", value_parser = argument::positive, hide_short_help = true, allow_hyphen_values = true)]
    pub(super) gamma: Option<f64>,
}

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
