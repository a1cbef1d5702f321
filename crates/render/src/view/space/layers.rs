//! The 3D view in layers: its curves, geodesics and axes as vectors, and its names.

use super::{SpaceRenderer, drawables};
use crate::error::RenderError;
use crate::gpu::Pixels;
use crate::layers::Layers;
use crate::note::Note;
use crate::overlay;
use crate::rendered::RenderedImage;
use crate::request::PictureRequest;
use crate::request::part::SpaceOptions;
use crate::sample::Samples;
use crate::software::{self, Drawable, LineCover};
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
        let options: &SpaceOptions = request.options()?;
        let prepared = self.prepare(shared, request, options)?;
        let (drawables, mut notes) =
            drawables(shared, request, options, &prepared.framed, None, &|_| {});
        let extras = prepared.extras(request);
        let is_line = |object: &Drawable| matches!(&*object.samples, Samples::Curves { .. });
        let (lines, others): (Vec<Drawable>, Vec<Drawable>) =
            drawables.into_iter().partition(is_line);
        let (extras, others): (Vec<Drawable>, Vec<Drawable>) =
            others.into_iter().chain(extras).partition(is_line);
        let background = options.background_light();
        let camera = &prepared.camera;
        let counters = shared.pixels.clone();
        let painter = prepared.painter(true, &counters);
        let (mut image, depths) =
            software::draw_with_depths(camera, &others, painter.as_ref(), background, progress);
        notes.extend(prepared.notes(request, options, painter.as_ref(), &shared.stated_colours)?);
        let keyed = prepared.keyed_camera(options);
        let shown = keyed.as_ref();
        let words = prepared.words(shared, request, options);
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
