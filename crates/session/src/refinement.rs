//! Pictures that are coarse while a view moves, and traced ones that are refined while it rests.
//!
//! The cost of the picture that a pane shows flows in; the size of the next one, or the next request, flows out.

use render::{PictureRequest, ViewId};

use crate::request::differ_by_refinement;
use crate::view::Preferences;

/// The time that a picture of a moving view should take, in seconds.
const MOVING_PICTURE: f64 = 0.022;
/// The time that a step of a picture that is refined should take, in seconds.
const REFINED_STEP: f64 = 0.1;
/// A picture that is not traced and would take longer may be as coarse as a traced one while it moves, in seconds: a solid
/// may take that long by itself.
const SLOW: f64 = 0.6;
/// The scale of the first traced picture of a pane.
const FIRST_TRACED: f64 = 0.25;

/// The cost and the fineness of a picture that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureDetail {
    /// The seconds that a pixel took; of a picture that is refined, a sample of it.
    pub rate: f64,
    /// The samples of each pixel, of a picture that is refined.
    pub samples: Option<u32>,
}

impl PictureDetail {
    /// Of a picture of a size in pixels that took some seconds. `samples` are those of each pixel and those of them that were
    /// added, of a picture that is refined.
    pub fn new(size: [u32; 2], seconds: f64, samples: Option<[u32; 2]>) -> Self {
        let [width, height] = size.map(f64::from);
        let added = samples.map_or(1, |[_, new]| new.max(1));
        Self {
            rate: seconds / (width * height * f64::from(added)).max(1.0),
            samples: samples.map(|[all, _]| all),
        }
    }
}

/// Returns the size of the picture of a view that has room for so many pixels: coarser while it moves, if pictures take
/// long, or may take long since none was `traced` yet. `shown` is what is there.
pub fn size(
    preferences: &Preferences,
    id: &ViewId,
    room: [u32; 2],
    moving: bool,
    traced: bool,
    shown: Option<PictureDetail>,
) -> [u32; 2] {
    let wanted = match id.object {
        None => preferences.space_size,
        Some(_) => preferences.inside_size,
    };
    let shorter = f64::from(room[0].min(room[1]).max(1));
    let mut scale = wanted.map_or(1.0, |side| f64::from(side) / shorter);
    if moving && let Some(shown) = shown {
        let whole = shown.rate * f64::from(room[0]) * f64::from(room[1]) * scale * scale;
        let share = (MOVING_PICTURE / whole.max(1e-9)).sqrt();
        let may_be_coarsest = traced || whole > SLOW;
        let (steps, least) = if may_be_coarsest {
            (16.0, 0.0625)
        } else {
            (8.0, 0.25)
        };
        // In steps, so that the size does not change with every picture.
        scale *= if traced && shown.samples.is_none() {
            FIRST_TRACED
        } else {
            ((share * steps).floor() / steps).clamp(least, 1.0)
        };
    }
    room.map(|side| ((f64::from(side) * scale).round() as u32).clamp(16, 4096))
}

/// A pane whose traced picture is refined.
#[derive(Clone, Copy, Debug)]
pub struct TracedPane<'a> {
    /// The request that was sent last.
    pub sent: Option<&'a PictureRequest>,
    /// The picture that it shows.
    pub shown: Option<PictureDetail>,
    /// Set if the last request has been answered, and with a picture.
    pub is_answered: bool,
    /// Set if the view moves.
    pub moving: bool,
    /// Set if a picture of what moves has just come, so that one of another size would be drawn for nothing.
    pub again: bool,
}

impl TracedPane<'_> {
    /// Returns the next request for the picture: a coarse one of something new, a whole one of what is at rest, and then more
    /// samples of it, as many as take a moment, up to `most`; `None` where there is nothing to be asked for now.
    /// `request` is for the picture as it is now, in the size of a picture at rest; `coarse` is that of a moving one.
    pub fn next(
        &self,
        mut request: PictureRequest,
        coarse: [u32; 2],
        most: u32,
    ) -> Option<PictureRequest> {
        let whole = request.size;
        request.moving = false;
        request.view.set_samples(1);
        let is_known = self
            .sent
            .is_some_and(|sent| differ_by_refinement(sent, &request));
        if self.moving || !is_known {
            request.moving = true;
            request.size = match self.sent {
                Some(sent) if is_known && self.again => sent.size,
                _ => coarse,
            };
            return (self.sent != Some(&request)).then_some(request);
        }
        let (Some(sent), Some(shown)) = (self.sent, self.shown) else {
            return Some(request);
        };
        if !self.is_answered {
            return None;
        }
        if sent.moving || sent.size != whole {
            return Some(request);
        }
        let done = sent.view.samples()?;
        let pixels = f64::from(whole[0]) * f64::from(whole[1]);
        let step = (REFINED_STEP / (shown.rate * pixels).max(1e-9)) as u32;
        request
            .view
            .set_samples((done + step.clamp(1, done)).min(most));
        (done < most).then_some(request)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use render::view::traced::TracedOptions;
    use render::{PictureRequest, ViewId};
    use scene::ParamValues;

    use super::{PictureDetail, TracedPane, size};
    use crate::view::Preferences;

    #[test]
    fn a_picture_that_takes_long_is_coarser_while_its_view_moves() {
        let (preferences, id) = (Preferences::default(), ViewId::of_scene("3d"));
        let size = |moving, traced, shown| {
            let room = [400, 200];
            size(&preferences, &id, room, moving, traced, shown)
        };
        let slow = PictureDetail::new([400, 200], 0.088, None);
        assert_eq!(size(false, false, Some(slow)), [400, 200]);
        assert_eq!(
            size(true, false, Some(slow)),
            [200, 100],
            "a quarter of the time"
        );
        let slowest = PictureDetail::new([400, 200], 8.8, None);
        assert_eq!(size(true, false, Some(slowest)), [25, 16]);
        assert_eq!(size(true, false, None), [400, 200]);
        assert_eq!(
            size(true, true, Some(slow)),
            [100, 50],
            "none was traced yet"
        );
        let traced = PictureDetail::new([400, 200], 8.8, Some([3, 2]));
        assert_eq!(traced.samples, Some(3));
        assert_eq!(size(true, true, Some(traced)), [25, 16]);
    }

    #[test]
    fn a_traced_picture_is_coarse_then_whole_then_finer() {
        let text = "solid s(x,y,z) = x^2 + y^2 + z^2 - 1;";
        let scene = Arc::new(scene::geotrace::compile(text).scene.expect("no errors"));
        let params = ParamValues::initial(&scene);
        let now = PictureRequest::new(&scene, params, TracedOptions::default(), [100; 2]);
        let mut pane = TracedPane {
            sent: None,
            shown: None,
            is_answered: true,
            moving: false,
            again: false,
        };
        let first = pane.next(now.clone(), [25; 2], 4).expect("a request");
        assert_eq!((first.size, first.moving), ([25; 2], true));
        pane.sent = Some(&first);
        pane.shown = Some(PictureDetail::new([25; 2], 0.1, Some([1, 1])));
        pane.is_answered = false;
        assert!(pane.next(now.clone(), [25; 2], 4).is_none());
        pane.is_answered = true;
        let whole = pane.next(now.clone(), [25; 2], 4).expect("a request");
        assert_eq!((whole.size, whole.moving), ([100; 2], false));
        assert_eq!(whole.view.samples(), Some(1));
        pane.sent = Some(&whole);
        let finer = pane.next(now.clone(), [25; 2], 4).expect("a request");
        assert_eq!(finer.view.samples(), Some(2));
        pane.sent = Some(&finer);
        // A picture that takes no time is refined to twice the samples at most.
        pane.shown = Some(PictureDetail::new([100; 2], 0.0, Some([2, 1])));
        let finest = pane.next(now.clone(), [25; 2], 3).expect("a request");
        assert_eq!(finest.view.samples(), Some(3));
        pane.sent = Some(&finest);
        assert!(pane.next(now, [25; 2], 3).is_none());
    }
}
