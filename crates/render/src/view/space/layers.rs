//! The 3D view in layers: its curves, geodesics and axes as vectors, and its names.

use super::{SpaceRenderer, drawables, is_labelled, labels, tints};
use crate::error::RenderError;
use crate::gpu::Pixels;
use crate::layers::Layers;
use crate::note::Note;
use crate::overlay::{self, KeyedCamera};
use crate::rendered::RenderedImage;
use crate::request::PictureRequest;
use crate::request::part::SpaceOptions;
use crate::sample::Samples;
use crate::software::{self, Drawable, LineCover};
use crate::solids::SolidPainter;
use crate::stated_colours;
use crate::view::SharedState;

impl SpaceRenderer {
    /// Draws a picture in layers, on the software path.
    pub(super) fn draw_layers(
        &mut self,
        shared: &mut SharedState,
        request: &PictureRequest,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Layers, RenderError> {
        let request = &*shared.stated_colours.textured(request);
        let colour_notes = stated_colours::notes(request);
        let options: &SpaceOptions = request.options()?;
        let prepared = self.prepare(shared, request, options)?;
        let (drawables, mut notes) =
            drawables(shared, request, options, &prepared.framed, None, &|_| {});
        let extras = prepared.overlay.iter().map(|object| {
            let look = object.look(request.scale);
            Drawable::new(object.samples.clone(), &look, None)
        });
        let is_line = |object: &Drawable| matches!(&*object.samples, Samples::Curves { .. });
        let (lines, others): (Vec<Drawable>, Vec<Drawable>) =
            drawables.into_iter().partition(is_line);
        let (extras, others): (Vec<Drawable>, Vec<Drawable>) =
            others.into_iter().chain(extras).partition(is_line);
        let background = options.background_light();
        let camera = &prepared.camera;
        let solids = shared
            .solids
            .get(request, &options.hidden, prepared.framed.contents());
        let tints = solids
            .as_ref()
            .map(|solids| tints(request, options, solids));
        let counters = shared.pixels.clone();
        let solids = solids.as_deref().zip(tints.as_deref());
        let painter =
            solids.map(|(solids, tints)| SolidPainter::new(camera, solids, tints, true, &counters));
        let (mut image, depths) =
            software::draw_with_depths(camera, &others, painter.as_ref(), background, progress);
        notes.extend(colour_notes);
        notes.extend(prepared.framed.notes(request, |id| options.shows(id)));
        if let Some(painter) = &painter {
            notes.extend(painter.notes(request)?);
        }
        let keyed = options.show_camera.as_ref().map(|shown| KeyedCamera {
            camera: shown,
            view: camera,
            objects: &prepared.overlay,
        });
        let shown = keyed.as_ref();
        let mut words = prepared
            .axes
            .as_ref()
            .map_or_else(Vec::new, |axes| axes.labels(camera, request.scale));
        if is_labelled(request, &prepared.overlay) {
            let extras = &prepared.overlay;
            words.extend(labels(
                shared,
                request,
                options,
                &prepared.framed,
                camera,
                extras,
            ));
        }
        let key = if overlay::has_space_key(request, shown)? {
            let all = others.iter().chain(&lines).chain(&extras);
            let all: Vec<Drawable> = all.cloned().collect();
            let whole = software::draw_beside(camera, &all, painter.as_ref(), background, &|_| {});
            overlay::space_key_place(request, shown, &whole, &words)?
        } else {
            None
        };
        let before = LineCover::new(&depths, key);
        let hides = request.overlays.hidden_lines;
        let lines = lines.iter().map(|line| (line, hides));
        let lines = lines.chain(extras.iter().map(|line| (line, false)));
        let strokes = software::strokes(camera, &lines.collect::<Vec<_>>(), &before);
        shared.samples.next();
        let mut overlays = overlay::names(prepared.overlay.iter());
        overlays.extend(overlay::over_space(&mut image, request, shown, &[], key)?);
        let below = RenderedImage {
            notes: notes.into_iter().map(Note::Remark).collect(),
            overlays,
            legend: key,
            ..RenderedImage::new(Pixels::Image(image.clone()))
        };
        Ok(Layers {
            below: below.with_pixels(image),
            strokes,
            words: overlay::placed(&words, request, key),
        })
    }
}
