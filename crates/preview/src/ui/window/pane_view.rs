//! A pane with a picture: its size on the screen, the request that was sent for it, and the picture that it shows.

use std::time::Duration;

use egui::{Rect, pos2};
use geodesic::ends::{Estimate, GeodesicWork};
use render::PictureRequest;
use render::gpu::Pixels;
use render::rendered::RenderedImage;
use session::refinement::PictureDetail;
use session::request::{differ_by_refinement, differ_by_shown_camera};

use crate::ui::gpu_surface::TextureBinding;

/// A pane with a picture.
#[derive(Default)]
pub(crate) struct PaneView {
    /// The size of the pane in pixels when it was last on the screen.
    pub(crate) room: Option<[u32; 2]>,
    /// True if it was on the screen in the last frame.
    pub(crate) on_screen: bool,
    /// The request that was sent last.
    pub(super) request: Option<PictureRequest>,
    pub(super) waiting: Waiting,
    /// The time of the interface at which a picture of something else was requested, in seconds.
    pub(super) changed_at: f64,
    /// The picture that is on the screen.
    pub(crate) picture: Option<Picture>,
}

/// The state of a pane's last request.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(super) enum Waiting {
    /// It has been answered.
    #[default]
    No,
    /// It is unanswered, and a frame may wait for the answer.
    ForFrame,
    /// It is unanswered. The picture only follows the camera of another view, and no frame waits for it.
    Following,
    /// It is unanswered. The picture refines the one that is shown, and no frame waits for it.
    Refining,
}

/// A picture that is on the screen.
#[derive(Default)]
pub(crate) struct Picture {
    /// Newly arrived pixels, to be uploaded to the GPU.
    pub(crate) fresh: Option<Pixels>,
    /// The texture from which it is painted.
    pub(crate) binding: Option<TextureBinding>,
    pub(crate) notes: Vec<String>,
    /// For a geodesic view: its cost, and its estimated error.
    pub(crate) geodesics: Option<(GeodesicWork, Option<Estimate>)>,
    pub(crate) took: Duration,
    /// The rectangle of its legend, if it has one, in fractions of its sides.
    pub(crate) legend: Option<Rect>,
    /// Its cost and level of detail.
    pub(crate) detail: PictureDetail,
    /// The reason why there is no newer one.
    pub(crate) error: Option<String>,
    /// The version of the text that it shows.
    pub(crate) version: i32,
}

impl PaneView {
    /// Notes a request that is sent at a time of the interface, in seconds. A picture that differs from the previous one only
    /// by another view's camera follows it; one that is only finer refines it.
    pub(super) fn send(&mut self, request: &PictureRequest, now: f64) {
        let before = self.request.as_ref();
        let follows = before.is_some_and(|before| differ_by_shown_camera(before, request));
        let refines = !request.moving
            && request.view.samples().is_some()
            && before.is_some_and(|before| differ_by_refinement(before, request));
        self.waiting = match (follows, self.waiting) {
            (true, Waiting::No | Waiting::Following) => Waiting::Following,
            _ if refines => Waiting::Refining,
            _ => Waiting::ForFrame,
        };
        if !refines {
            self.changed_at = now;
        }
        self.request = Some(request.clone());
    }

    /// Drops the request, whose answer is not needed.
    pub(super) fn forget_request(&mut self) {
        self.request = None;
        self.waiting = Waiting::No;
    }

    /// Takes over a picture that was drawn.
    pub(super) fn take(&mut self, drawn: RenderedImage, version: i32) {
        let picture = self.picture.get_or_insert_default();
        let size = match &drawn.image {
            Pixels::Image(image) => [image.width(), image.height()],
            Pixels::Texture(canvas) => canvas.size(),
        };
        picture.detail = PictureDetail::new(size, drawn.took.as_secs_f64(), drawn.samples);
        let [width, height] = size.map(|side| side as f32);
        picture.legend = drawn.legend.map(|[left, top, right, bottom]| {
            let [from, to] = [[left, top], [right, bottom]];
            let share = |[x, y]: [f32; 2]| pos2(x / width, y / height);
            Rect::from_min_max(share(from), share(to))
        });
        picture.notes = drawn.remarks().map(str::to_owned).collect();
        picture.fresh = Some(drawn.image);
        picture.geodesics = drawn.geodesics.or(picture.geodesics);
        picture.took = drawn.took;
        picture.error = None;
        picture.version = version;
    }

    /// Takes over the reason why there is no newer picture.
    pub(super) fn fail(&mut self, reason: String, version: i32) {
        let picture = self.picture.get_or_insert_default();
        picture.error = Some(reason);
        picture.version = version;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use render::view::traced::TracedOptions;
    use scene::ParamValues;

    use super::*;

    #[test]
    fn no_frame_waits_for_a_finer_picture_of_what_is_shown() {
        let text = "param r : [1, 2]; solid s(x,y,z) = x^2 + y^2 + z^2 - r^2;";
        let scene = Arc::new(scene::geotrace::compile(text).scene.expect("no errors"));
        let params = ParamValues::initial(&scene);
        let coarse = TracedOptions {
            samples: Some(1),
            ..TracedOptions::default()
        };
        let mut coarse = PictureRequest::new(&scene, params, coarse, [16; 2]);
        coarse.moving = true;
        let mut view = PaneView::default();
        view.send(&coarse, 1.0);
        assert_eq!(view.waiting, Waiting::ForFrame);
        let mut whole = coarse.clone();
        (whole.moving, whole.size) = (false, [64; 2]);
        view.send(&whole, 2.0);
        assert_eq!(view.waiting, Waiting::Refining);
        let mut finer = whole.clone();
        finer.view.set_samples(2);
        view.send(&finer, 3.0);
        assert_eq!(view.waiting, Waiting::Refining);
        assert_eq!(view.changed_at, 1.0);
        // What moves is awaited, as any other picture is.
        let mut other = ParamValues::initial(&scene);
        other.set(&scene, "r", &[2.0]).expect("in its interval");
        coarse.params = other.into();
        view.send(&coarse, 4.0);
        assert_eq!(view.waiting, Waiting::ForFrame);
        assert_eq!(view.changed_at, 4.0);
    }
}
