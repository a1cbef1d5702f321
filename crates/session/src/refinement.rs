//! Pictures that are coarse while a view moves, and traced pictures that are refined while it rests.
//!
//! In: a pane's last request, and the cost of the picture that it shows. Out: the next request.

use render::{PictureRequest, ViewId};

use crate::choices::Preferences;
use crate::request::differ_by_refinement;

/// The target duration of a picture of a moving view, in seconds.
const MOVING_PICTURE: f64 = 0.016;
/// The target duration of a refinement step, in seconds.
const REFINED_STEP: f64 = 0.1;
/// A picture that is not traced, but takes longer than this, in seconds, may be as coarse as a traced one while it
/// moves: a single solid may take this long.
const SLOW: f64 = 0.6;
/// The scale of the first traced picture of a pane.
const FIRST_TRACED: f64 = 0.25;

/// The cost and the level of detail of a picture that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureDetail {
    /// The seconds per pixel; for a picture that is refined, per sample.
    pub rate: f64,
    /// The samples per pixel, for a picture that is refined.
    pub samples: Option<u32>,
}

impl PictureDetail {
    /// Returns the detail of a picture with a size in pixels that took some seconds. `samples` are the total and the
    /// added samples per pixel, for a picture that is refined.
    pub fn new(size: [u32; 2], seconds: f64, samples: Option<[u32; 2]>) -> Self {
        let [width, height] = size.map(f64::from);
        let added = samples.map_or(1, |[_, new]| new.max(1));
        Self {
            rate: seconds / (width * height * f64::from(added)).max(1.0),
            samples: samples.map(|[all, _]| all),
        }
    }
}

/// Returns the size of the picture at rest of a view with room for a number of pixels.
pub fn size_at_rest(preferences: &Preferences, id: &ViewId, room: [u32; 2]) -> [u32; 2] {
    let wanted = match id.object {
        None => preferences.space_size,
        Some(_) => preferences.inside_size,
    };
    let shorter = f64::from(room[0].min(room[1]).max(1));
    scaled(room, wanted.map_or(1.0, |side| f64::from(side) / shorter))
}

/// Returns the size of the picture of a moving view, given that of its picture at rest. It is coarser if pictures take
/// long, or may take long because none was `traced` yet. `shown` is the present picture.
fn moving_size(at_rest: [u32; 2], traced: bool, shown: Option<PictureDetail>) -> [u32; 2] {
    if traced && shown.is_none_or(|shown| shown.samples.is_none()) {
        return scaled(at_rest, FIRST_TRACED);
    }
    let Some(shown) = shown else {
        return at_rest;
    };
    let seconds = shown.rate * f64::from(at_rest[0]) * f64::from(at_rest[1]);
    let share = (MOVING_PICTURE / seconds.max(1e-9)).sqrt();
    let may_be_coarsest = traced || seconds > SLOW;
    let (steps, least) = if may_be_coarsest {
        (16.0, 0.0625)
    } else {
        (8.0, 0.25)
    };
    // In steps, so that the size does not change with every picture.
    scaled(at_rest, ((share * steps).floor() / steps).clamp(least, 1.0))
}

fn scaled(size: [u32; 2], scale: f64) -> [u32; 2] {
    size.map(|side| ((f64::from(side) * scale).round() as u32).clamp(16, 4096))
}

/// The progress of a pane's pictures.
#[derive(Clone, Copy, Debug)]
pub struct PictureProgress<'a> {
    /// The request that was sent last.
    pub sent: Option<&'a PictureRequest>,
    /// The picture that is shown.
    pub shown: Option<PictureDetail>,
    /// True if the last request has been answered with a picture.
    pub is_answered: bool,
    /// True if the view moves.
    pub moving: bool,
}

impl PictureProgress<'_> {
    /// Returns the next request; `None` if nothing is to be requested now. `request` is the current request for a
    /// picture at rest. A moving view is drawn as coarse as necessary, and only if it shows something new. A traced
    /// picture is coarse at first, then of full size, and then gets further samples, as many as take a moment, up to
    /// `most`.
    pub fn next(&self, mut request: PictureRequest, most: u32) -> Option<PictureRequest> {
        let whole = request.size;
        request.view.set_samples(1);
        let traced = request.view.samples().is_some();
        let is_known = self
            .sent
            .is_some_and(|sent| differ_by_refinement(sent, &request));
        if self.moving || (traced && !is_known) {
            request.moving = true;
            request.size = moving_size(whole, traced, self.shown);
            let [before, now] = [whole, request.size].map(|[width, height]| width.min(height));
            request.magnification = before as f32 / now as f32;
            return (!is_known).then_some(request);
        }
        let Some(sent) = self.sent.filter(|_| traced) else {
            return (self.sent != Some(&request)).then_some(request);
        };
        if !self.is_answered {
            return None;
        }
        if sent.moving || sent.size != whole {
            return Some(request);
        }
        let done = sent.view.samples()?;
        let pixels = f64::from(whole[0]) * f64::from(whole[1]);
        let step = (REFINED_STEP / (self.shown?.rate * pixels).max(1e-9)) as u32;
        request
            .view
            .set_samples((done + step.clamp(1, done)).min(most));
        (done < most).then_some(request)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use render::PictureRequest;
    use render::request::part::SpaceOptions;
    use render::view::traced::TracedOptions;
    use scene::ParamValues;

    use super::{PictureDetail, PictureProgress, moving_size};

    #[test]
    fn a_picture_that_takes_long_is_coarser_while_its_view_moves() {
        let size = |traced, shown| moving_size([400, 200], traced, shown);
        let slow = PictureDetail::new([400, 200], 0.064, None);
        assert_eq!(size(false, Some(slow)), [200, 100], "a quarter of the time");
        let slowest = PictureDetail::new([400, 200], 8.8, None);
        assert_eq!(size(false, Some(slowest)), [25, 16]);
        assert_eq!(size(false, None), [400, 200]);
        assert_eq!(size(true, None), [100, 50]);
        assert_eq!(size(true, Some(slow)), [100, 50], "none was traced yet");
        let traced = PictureDetail::new([400, 200], 8.8, Some([3, 2]));
        assert_eq!(traced.samples, Some(3));
        assert_eq!(size(true, Some(traced)), [25, 16]);
    }

    #[test]
    fn a_moving_view_is_drawn_only_where_it_shows_something_new() {
        let scene = scene::geotrace::compile("point p = (0, 0, 0);").scene;
        let scene = Arc::new(scene.expect("no errors"));
        let params = ParamValues::initial(&scene);
        let now = PictureRequest::new(&scene, params, SpaceOptions::default(), [64; 2]);
        let mut pane = PictureProgress {
            sent: None,
            shown: Some(PictureDetail::new([64; 2], 0.064, None)),
            is_answered: true,
            moving: true,
        };
        let coarse = pane.next(now.clone(), 4).expect("a request");
        assert_eq!((coarse.size, coarse.moving), ([32; 2], true));
        assert_eq!((coarse.magnification, now.magnification), (2.0, 1.0));
        pane.sent = Some(&coarse);
        assert!(pane.next(now.clone(), 4).is_none());
        let mut other = now.clone();
        other.overlays.axes = true;
        assert!(pane.next(other, 4).is_some_and(|it| it.moving));
        pane.moving = false;
        let whole = pane.next(now.clone(), 4).expect("a request");
        assert!(whole == now && !whole.moving);
        pane.sent = Some(&whole);
        assert!(pane.next(now.clone(), 4).is_none());
        pane.moving = true;
        assert!(pane.next(now, 4).is_none());
    }

    #[test]
    fn a_traced_picture_is_coarse_then_whole_then_finer() {
        let text = "solid s(x,y,z) = x^2 + y^2 + z^2 - 1;";
        let scene = Arc::new(scene::geotrace::compile(text).scene.expect("no errors"));
        let params = ParamValues::initial(&scene);
        let now = PictureRequest::new(&scene, params, TracedOptions::default(), [100; 2]);
        let mut pane = PictureProgress {
            sent: None,
            shown: None,
            is_answered: true,
            moving: false,
        };
        let first = pane.next(now.clone(), 4).expect("a request");
        assert_eq!((first.size, first.moving), ([25; 2], true));
        pane.sent = Some(&first);
        pane.shown = Some(PictureDetail::new([25; 2], 0.1, Some([1, 1])));
        pane.is_answered = false;
        assert!(pane.next(now.clone(), 4).is_none());
        pane.is_answered = true;
        let whole = pane.next(now.clone(), 4).expect("a request");
        assert_eq!((whole.size, whole.moving), ([100; 2], false));
        assert_eq!(whole.view.samples(), Some(1));
        pane.sent = Some(&whole);
        let finer = pane.next(now.clone(), 4).expect("a request");
        assert_eq!(finer.view.samples(), Some(2));
        pane.sent = Some(&finer);
        // A picture that takes no time is refined to twice the samples at most.
        pane.shown = Some(PictureDetail::new([100; 2], 0.0, Some([2, 1])));
        let finest = pane.next(now.clone(), 3).expect("a request");
        assert_eq!(finest.view.samples(), Some(3));
        pane.sent = Some(&finest);
        assert!(pane.next(now, 3).is_none());
    }
}
