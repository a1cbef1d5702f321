//! The request of a picture: the options of `geotrace render` and a program flow in.

use std::sync::Arc;

use geodesic::surface::Surface;
use geometry::Manifold;
use render::figure::{Figure, FigureKind};
use render::measured::{FigureMeasures, lines, measure};
use render::point::WorldPoint;
use render::request::{Overlays, Spacing, ViewPart};
use render::shared::Shared;
use render::style;
use render::style::Theme;
use render::trail::Trail;
use render::view::geodesic::GeodesicOptions;
use render::view::traced::TracedOptions;
use render::viewpoint::{GeodesicCamera, Pose, Projection, Viewpoint};
use render::{PictureRequest, ViewId, Views, most_traced_operations};
use scene::{Object, ObjectId, ParamValues, Scene, Shape};
use tracer::PictureLook;

use super::Arguments;
use super::images::Images;
use crate::argument::{FigureArgument, ObjectColour, Pair, PathArgument, Triple};
use crate::command::measure::stopped;
use crate::failure::Failure;
use crate::program::LoadedProgram;

/// Returns the request of the picture that the options describe.
pub(super) fn request(
    arguments: &Arguments,
    views: &Views,
    program: &LoadedProgram,
    params: ParamValues,
    images: &Images,
) -> Result<PictureRequest, Failure> {
    let view = view(arguments, views, program, &params)?;
    Ok(PictureRequest {
        trails: trails(arguments, program, &params)?,
        overlays: overlays(arguments, program, &params)?,
        theme: arguments.theme,
        scale: arguments.scale as f32,
        colours: colours(arguments, program)?,
        textures: images.loaded.clone(),
        images: images.named.clone(),
        background_image: images.background.clone(),
        curved: images.curved.clone(),
        flipped: flipped(arguments, program)?,
        ..PictureRequest::new(
            program.scene(),
            params,
            view,
            arguments.size(program.scene()),
        )
    })
}

/// Returns the lines of paths and figures on the surfaces of some params.
///
/// # Errors
/// A place that is none of the surface, or what cannot be measured there.
pub(super) fn trails(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<Shared<Trail>>, Failure> {
    let mut trails = paths(arguments, program, params)?;
    trails.extend(figures(arguments, program, params)?);
    Ok(trails)
}

/// Returns the paths.
///
/// # Errors
/// A place that is none of the surface.
fn paths(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<Shared<Trail>>, Failure> {
    let path = |path: &PathArgument| {
        let (id, manifold) = manifold(&path.surface, program, params)?;
        let places = places("--path", &path.places, program, params)?;
        for at in &places {
            geodesic::measure::place(manifold.surface(), *at)
                .map_err(|error| Failure::usage(format!("--path {}: {error}", path.surface)))?;
        }
        Ok(Arc::new(Trail::through(manifold.surface(), id, places)).into())
    };
    arguments.overlays.path.iter().map(path).collect()
}

/// Returns the lines of the figures, measured on the surfaces of some params.
fn figures(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<Shared<Trail>>, Failure> {
    let mut trails = Vec::new();
    for stated in &arguments.overlays.figure {
        let (id, manifold) = manifold(&stated.surface, program, params)?;
        let (figure, finding) = measured(stated, manifold.surface(), program, params)?;
        let lines = lines(manifold.surface(), id, &figure, Some(&finding));
        trails.extend(lines.into_iter().map(Shared::from));
    }
    Ok(trails)
}

/// Returns a figure and its measures on its surface.
fn measured(
    stated: &FigureArgument,
    surface: &dyn Surface,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<(Arc<Figure>, FigureMeasures), Failure> {
    let radius = stated.radius.as_ref();
    let figure = Arc::new(Figure {
        kind: stated.kind,
        places: places("--figure", &stated.places, program, params)?,
        radius: radius
            .map(|radius| program.number("--figure", radius, params))
            .transpose()?,
    });
    let finding = measure(surface, &figure)
        .map_err(|error| Failure::usage(format!("{}: {error}", stated.option())))?;
    Ok((figure, finding))
}

/// Notes on figures that are not finished, of which only the points are drawn, and on circles with rays that end before them.
pub(super) fn partial_figures(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<String>, Failure> {
    let mut notes = Vec::new();
    for stated in &arguments.overlays.figure {
        let (given, all) = (stated.places.len(), stated.kind.places());
        if given < all && stated.radius.is_none() {
            let lack = match stated.kind {
                FigureKind::Circle => " and no radius",
                _ => "",
            };
            let plural = if given == 1 { "" } else { "s" };
            notes.push(format!(
                "{}: it has {given} place{plural} of {all}{lack}, so that only points are drawn",
                stated.option()
            ));
        } else if stated.kind == FigureKind::Circle {
            let (_, manifold) = manifold(&stated.surface, program, params)?;
            let (_, finding) = measured(stated, manifold.surface(), program, params)?;
            if let FigureMeasures::Circle(_, Err(stop)) = finding {
                let why = stopped(&stop);
                notes.push(format!(
                    "{}: the circle is not complete: {why}",
                    stated.option()
                ));
            }
        }
    }
    Ok(notes)
}

fn places(
    option: &str,
    places: &[Pair],
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Vec<[f64; 2]>, Failure> {
    let place = |Pair(place): &Pair| program.numbers(option, place, params);
    places.iter().map(place).collect()
}

/// The surface or metric of a name, with its numbers in place.
fn manifold(
    name: &str,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<(ObjectId, Manifold), Failure> {
    let (id, _) = program.surface(Some(name))?;
    Ok((id, program.manifold(id, params)?))
}

fn overlays(
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<Overlays, Failure> {
    let wavefronts = match &arguments.overlays.wavefronts {
        None => None,
        Some(None) => Some(Spacing::Auto),
        Some(Some(spacing)) => match program.number("--wavefronts", spacing, params)? {
            spacing if spacing > 0.0 => Some(Spacing::Every(spacing)),
            _ => return Err(Failure::usage("--wavefronts: it must be greater than 0")),
        },
    };
    Ok(Overlays {
        legend: arguments.overlays.legend,
        wavefronts,
        conjugate_points: arguments.overlays.conjugate,
        cut_locus: arguments.overlays.cut_locus,
        error: arguments.overlays.error,
        labels: arguments.overlays.labels,
        axes: arguments.space.axes,
        hidden_lines: arguments.space.hidden_lines,
    })
}

/// Returns the colours of objects.
fn colours(
    arguments: &Arguments,
    program: &LoadedProgram,
) -> Result<Vec<(ObjectId, [u8; 3])>, Failure> {
    let mut chosen = Vec::new();
    for ObjectColour { object, colour } in &arguments.colour {
        let objects = program.objects(object)?.into_iter();
        chosen.extend(objects.map(|id| (id, *colour)));
    }
    Ok(chosen)
}

/// Returns the surfaces whose images are turned over.
fn flipped(arguments: &Arguments, program: &LoadedProgram) -> Result<Vec<ObjectId>, Failure> {
    let surface = |name: &String| Ok(program.surface(Some(name))?.0);
    arguments.flip.iter().map(surface).collect()
}

/// Returns the requested view, with its camera and its options.
fn view(
    arguments: &Arguments,
    views: &Views,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<ViewPart, Failure> {
    let ViewId { kind, object } = &arguments.view(views, program.scene());
    let view = views.get(kind);
    let view = view.ok_or_else(|| Failure::usage(format!("there is no view `{kind}`")))?;
    let mut view = match (object, view.is_of_object()) {
        (_, true) => view.options(Some(program.ground(object.as_deref())?.0)),
        (None, false) => view.options(None),
        (Some(name), false) => view
            .options_of(program.scene(), name)
            .ok_or_else(|| no_camera(name, program))?,
    };
    let place = |option: &str, triple: &Option<Triple>| match triple {
        Some(triple) => {
            let numbers: [f64; 3] = program.numbers(option, &triple.0, params)?;
            Ok(Some(WorldPoint(program.scene().stated(numbers))))
        }
        None => Ok(None),
    };
    for (name, on) in &arguments.geodesic.setting {
        if !view.set(name, *on) {
            return Err(unknown_setting(name, views, &view));
        }
    }
    if let Some(options) = view.get_mut::<GeodesicOptions>() {
        options.method = arguments.geodesic.method.unwrap_or_default();
    }
    if let Some(options) = view.get_mut::<TracedOptions>() {
        options.samples = arguments.traced.samples;
        options.bounces = arguments.traced.bounces;
        options.look = arguments.traced.look;
        options.gamma = arguments.traced.gamma;
        let usual = most_traced_operations(arguments.size(program.scene()));
        options.max_operations = Some(arguments.traced.max_operations.unwrap_or(usual));
    }
    if let Some(space) = view.space_mut() {
        space.camera = Viewpoint {
            eye: place("--eye", &arguments.space.eye)?,
            target: place("--target", &arguments.space.target)?,
            projection: match arguments.space.orthographic {
                true => Projection::Orthographic,
                false => Projection::Perspective,
            },
        };
        let [r, g, b] = style::PAPER;
        let of_theme = (arguments.theme == Theme::Print).then_some([r, g, b, 255]);
        space.background = arguments.space.background.or(of_theme);
        let hidden = arguments
            .space
            .hide
            .iter()
            .map(|name| program.objects(name));
        space.hidden = hidden.collect::<Result<Vec<_>, _>>()?.concat();
    }
    let shown = match (&arguments.space.show_camera, view.geodesic_camera()) {
        (_, Some(own)) => Some(own.surface),
        (Some(name), None) if view.space().is_some() => Some(program.ground(Some(name))?.0),
        _ => None,
    };
    if let Some(surface) = shown {
        view.show_camera(geodesic_camera(surface, arguments, program, params)?);
    }
    Ok(view)
}

/// The geodesic camera that `--at`, `--angle` and `--zoom` place on a surface.
fn geodesic_camera(
    surface: ObjectId,
    arguments: &Arguments,
    program: &LoadedProgram,
    params: &ParamValues,
) -> Result<GeodesicCamera, Failure> {
    let angle = match &arguments.geodesic.angle {
        Some(angle) => program.number("--angle", angle, params)?.to_radians(),
        None => 0.0,
    };
    let pose = match program.scene().get(surface) {
        Some(object) if object.shape.solid().is_some() => {
            if arguments.geodesic.mirrored {
                return Err(Failure::usage(
                    "--mirrored: a solid is seen from outside, and has no other side",
                ));
            }
            let at = arguments.geodesic.at.as_ref();
            let at = at.map(|at| program.place("--at", at, params, object));
            Pose::InSpace {
                at: at.transpose()?.map(|at| program.scene().stated(at)),
                angle,
            }
        }
        Some(object) => {
            let at = arguments.geodesic.at.as_ref();
            let at = at.map(|at| program.place("--at", at, params, object));
            Pose::At {
                at: at.transpose()?,
                angle,
                mirrored: arguments.geodesic.mirrored,
            }
        }
        None => return Err(Failure::usage("there is no surface to see from inside")),
    };
    Ok(GeodesicCamera {
        surface,
        pose,
        zoom: match &arguments.geodesic.zoom {
            Some(zoom) => Some(program.number("--zoom", zoom, params)?),
            None => None,
        },
    })
}

fn no_camera(name: &str, program: &LoadedProgram) -> Failure {
    let stage = program.scene().stage.iter();
    let cameras = stage.filter(|object| matches!(object.shape, Shape::Camera(_)));
    let names: Vec<String> = cameras.map(|camera| format!("`{}`", camera.name)).collect();
    Failure::Usage {
        message: format!("`{}` declares no camera `{name}`", program.source.name),
        hint: Some(match &names[..] {
            [] => "a camera is declared like this: camera eye = (0, 4, -1) @ (0, -4, 1);".into(),
            [only] => format!("its camera is {only}"),
            several => format!("its cameras are {}", several.join(", ")),
        }),
    }
}

fn unknown_setting(name: &str, views: &Views, view: &ViewPart) -> Failure {
    let known = views.get(view.name()).map(|view| view.settings());
    let known = known.unwrap_or_default().iter();
    let known: Vec<String> = known.map(|it| format!("`{}`", it.name)).collect();
    Failure::Usage {
        message: format!("--setting: this view has no setting `{name}`"),
        hint: Some(match &known[..] {
            [] => "it has no settings".to_owned(),
            known => format!("it has {}", known.join(", ")),
        }),
    }
}

/// The note on a picture of space in which no object lies; a metric has a geodesic view alone.
pub(super) fn empty_space(scene: &Scene, view: &ViewPart) -> Option<String> {
    let space = view.space()?;
    let is_shown = |(id, object): (ObjectId, &Object)| {
        scene.is_in_space(object) && !space.hidden.contains(&id)
    };
    if scene.numbered().any(is_shown) {
        return None;
    }
    let mut metrics = scene.objects.iter().filter(|it| it.shape.is_metric());
    Some(match metrics.next() {
        Some(metric) => format!(
            "nothing to draw in 3D: a metric has no embedding; use `--view geodesic:{}`",
            metric.name
        ),
        None => "the picture shows no object".to_owned(),
    })
}

/// Notes on colours that are not shown, since the program states others, or those of curvature are shown.
pub(super) fn idle_colours(arguments: &Arguments, request: &PictureRequest) -> Vec<String> {
    let why = |name: &String| {
        let all = |holds: &dyn Fn(ObjectId) -> bool| {
            let mut objects = request.scene.objects_named(name);
            objects.all(|(id, _)| holds(id))
        };
        if all(&|id| request.shows_curvature_of(id)) {
            return Some(format!("`{name}` has the colours of its curvature"));
        }
        all(&|id| request.keeps_stated_colour(id))
            .then(|| format!("the program states a `color` of `{name}`, and that is shown"))
    };
    let names = arguments.colour.iter().map(|chosen| &chosen.object);
    let idle = names.filter_map(|name| Some(format!("--colour {name}: {}", why(name)?)));
    idle.collect()
}

/// Notes on options that the chosen view does not use.
pub(super) fn idle_options(arguments: &Arguments, request: &PictureRequest) -> Vec<String> {
    let (view, scene) = (&request.view, &*request.scene);
    let of_camera = [
        ("--at", arguments.geodesic.at.is_some()),
        ("--angle", arguments.geodesic.angle.is_some()),
        ("--mirrored", arguments.geodesic.mirrored),
        ("--zoom", arguments.geodesic.zoom.is_some()),
        ("--wavefronts", arguments.overlays.wavefronts.is_some()),
        ("--conjugate", arguments.overlays.conjugate),
    ];
    let inside = [
        ("--method", arguments.geodesic.method.is_some()),
        ("--cut-locus", arguments.overlays.cut_locus),
        ("--error", arguments.overlays.error),
    ];
    let space = [
        ("--axes", arguments.space.axes),
        ("--hidden-lines", arguments.space.hidden_lines),
        ("--hide", !arguments.space.hide.is_empty()),
        ("--background", arguments.space.background.is_some()),
        ("--eye", arguments.space.eye.is_some()),
        ("--target", arguments.space.target.is_some()),
        ("--orthographic", arguments.space.orthographic),
        ("--show-camera", arguments.space.show_camera.is_some()),
    ];
    let traced = [
        ("--samples", arguments.traced.samples.is_some()),
        ("--bounces", arguments.traced.bounces.is_some()),
        ("--look", arguments.traced.look.is_some()),
        ("--gamma", arguments.traced.gamma.is_some()),
        (
            "--max-operations",
            arguments.traced.max_operations.is_some(),
        ),
    ];
    // Lines are not drawn over rays, and rays part at the eye.
    let drawn = [
        ("--axes", arguments.space.axes),
        ("--hidden-lines", arguments.space.hidden_lines),
        ("--show-camera", arguments.space.show_camera.is_some()),
        ("--orthographic", arguments.space.orthographic),
    ];
    let of_all_others = [
        ("--legend", arguments.overlays.legend),
        ("--figure", !arguments.overlays.figure.is_empty()),
        ("--path", !arguments.overlays.path.is_empty()),
    ];
    let beside: &[(&[(&str, bool)], &str)] = if view.draws_lines() {
        &[(&traced, "the traced view: add `--view traced`")]
    } else {
        let others = "the 3D view and the geodesic view: leave out `--view traced`";
        &[
            (&drawn, "the 3D view: leave out `--view traced`"),
            (&of_all_others, others),
        ]
    };
    let geodesic = "the geodesic view: add `--view geodesic`";
    let shown = match view.draws_lines() {
        true => {
            "the geodesic view, or a camera in space: add `--view geodesic` or `--show-camera SURFACE`"
        }
        false => geodesic,
    };
    let idle: &[(&[(&str, bool)], &str)] =
        match (view.geodesic_camera(), &arguments.space.show_camera) {
            (Some(_), _) => &[(&space, "the 3D view")],
            (_, None) => &[(&of_camera, shown), (&inside, geodesic)],
            (_, Some(_)) => &[(&inside, geodesic)],
        };
    // Around a camera on a solid they are drawn in its geodesic view only.
    let around = [
        ("--wavefronts", arguments.overlays.wavefronts.is_some()),
        ("--conjugate", arguments.overlays.conjugate),
    ];
    let shown = view.shown_camera().filter(|_| view.space().is_some());
    let on_solid = shown.is_some_and(|camera| scene.is_solid(camera.surface));
    let on_solid = on_solid.then_some((&around[..], "the geodesic view of a solid"));
    let sentences = |options: &[(&str, bool)], other: &str| -> Vec<String> {
        let given = options.iter().filter(|(_, given)| *given);
        let sentences = given.map(|(option, _)| format!("{option} belongs to {other}"));
        sentences.collect()
    };
    let all = idle
        .iter()
        .copied()
        .chain(on_solid)
        .chain(beside.iter().copied());
    let mut notes: Vec<String> = all
        .flat_map(|(options, view)| sentences(options, view))
        .collect();
    let is_idle = |traced: &TracedOptions| {
        traced.gamma.is_some() && traced.picture_look(scene) != PictureLook::Crt
    };
    if view.get::<TracedOptions>().is_some_and(is_idle) {
        notes.push("--gamma belongs to `--look crt`".to_owned());
    }
    notes
}
