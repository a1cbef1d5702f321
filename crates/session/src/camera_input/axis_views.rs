//! Views along the axes: their names and keys, the turn of the camera to one, and the positions of the axes' ends in a
//! picture.
//!
//! The camera in space turns about its target, in a quarter of a second. The ends of the axes are drawn as a gizmo; a
//! click on one turns the camera to it.

use glam::DVec3;

use crate::camera::SpaceCamera;
use crate::history::Step;
use crate::model::Model;

/// A view along an axis.
#[derive(Debug)]
pub struct AxisView {
    /// Its name: "Top".
    pub title: &'static str,
    /// The digit key that turns the camera to it.
    pub digit: char,
    /// True if Ctrl, or the Command key of a Mac, is held with the digit: for the views from behind.
    pub command: bool,
    /// The keys, for the user.
    pub keys: &'static str,
    /// The axis in space, from 0.
    pub axis: usize,
    /// 1 or −1: the end of the axis nearer to the eye.
    pub sign: f64,
}

impl AxisView {
    const fn new(title: &'static str, digit: char, keys: &'static str, axis: usize) -> Self {
        Self {
            title,
            digit,
            command: false,
            keys,
            axis,
            sign: 1.0,
        }
    }

    /// Returns the view from the negative end.
    const fn negative(self) -> Self {
        Self { sign: -1.0, ..self }
    }

    const fn with_command(self) -> Self {
        Self {
            command: true,
            ..self
        }
    }

    /// Returns the unit vector from the target to the eye.
    pub fn direction(&self) -> DVec3 {
        self.sign * [DVec3::X, DVec3::Y, DVec3::Z][self.axis]
    }

    /// Returns the end of the axis: "+z". `axis` is the axis of the text, from 0; scripts may name the axes of space
    /// differently.
    pub fn end(&self, axis: usize) -> String {
        let sign = if self.sign < 0.0 { '−' } else { '+' };
        format!("{sign}{}", ["x", "y", "z"][axis])
    }
}

/// The views, in the order of a menu.
pub static AXIS_VIEWS: [AxisView; 6] = [
    AxisView::new("Front", '1', "1", 1).negative(),
    AxisView::new("Back", '1', "Ctrl+1", 1).with_command(),
    AxisView::new("Right", '3', "3", 0),
    AxisView::new("Left", '3', "Ctrl+3", 0)
        .negative()
        .with_command(),
    AxisView::new("Top", '7', "7", 2),
    AxisView::new("Bottom", '7', "Ctrl+7", 2)
        .negative()
        .with_command(),
];

/// The end of an axis as seen by a camera.
#[derive(Clone, Copy, Debug)]
pub struct AxisEnd {
    /// The view from that end.
    pub view: &'static AxisView,
    /// Its position relative to the centre of a gizmo, to the right and down; an axis across the line of sight has the
    /// length 1.
    pub at: [f64; 2],
    /// Its coordinate towards the eye, from −1 to 1, 0 at the centre.
    pub depth: f64,
}

impl AxisEnd {
    /// Returns the six ends as seen by a camera, the farthest first.
    pub fn all(camera: &SpaceCamera) -> [Self; 6] {
        let [right, up, back] = camera.axes();
        let mut ends = AXIS_VIEWS.each_ref().map(|view| {
            let way = view.direction();
            Self {
                view,
                at: [way.dot(right), -way.dot(up)],
                depth: way.dot(back),
            }
        });
        ends.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        ends
    }

    /// Returns the direction to which a click on it turns the eye: the end that already faces the eye leads to the
    /// opposite one.
    pub fn leads_to(&self) -> DVec3 {
        let sign = if self.depth > 0.999 { -1.0 } else { 1.0 };
        sign * self.view.direction()
    }
}

/// The duration of a turn, in seconds.
const TURN_TIME: f64 = 0.25;

/// A camera that is turning to another direction.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    from: SpaceCamera,
    to: SpaceCamera,
    /// The camera of the last frame of the turn.
    last: SpaceCamera,
    /// The time at which it started, in seconds.
    begun: f64,
}

impl Turn {
    /// Starts to turn the camera in space about its target until its eye is in a direction: an undoable step. `now` is
    /// in seconds, of any clock. Returns `None` if there is no camera yet.
    pub fn begin(model: &mut Model, direction: DVec3, now: f64) -> Option<Self> {
        let from = model.choices.space?;
        let to = from.seen_from(direction);
        let step = Step::new("Turn the 3D camera", "");
        model.change(step, |choices| choices.space = Some(to));
        model.history.settle();
        // The step leads to the end of the turn; the cameras before it are not steps.
        model.adjust(|choices| choices.space = Some(from));
        Some(Self {
            from,
            to,
            last: from,
            begun: now,
        })
    }

    /// Moves a turning camera to its direction at the time `now`. Ends the turn when it is complete, or the camera has
    /// been moved otherwise. Returns whether the camera has moved.
    pub fn advance(turn: &mut Option<Self>, model: &mut Model, now: f64) -> bool {
        let Some(on_its_way) = turn.take() else {
            return false;
        };
        if model.choices.space != Some(on_its_way.last) {
            return false;
        }
        let elapsed = now - on_its_way.begun;
        let last = on_its_way.at(elapsed / TURN_TIME);
        model.adjust(|choices| choices.space = Some(last));
        if elapsed < TURN_TIME {
            *turn = Some(Self { last, ..on_its_way });
        }
        true
    }

    /// Returns the camera at a fraction of the turn, from 0 to 1.
    fn at(&self, share: f64) -> SpaceCamera {
        if share >= 1.0 {
            return self.to;
        }
        // Slow at both ends.
        let share = share * share * (3.0 - 2.0 * share);
        let [from, to] = [self.from, self.to].map(|camera| camera.axes()[2]);
        let angle = from.dot(to).clamp(-1.0, 1.0).acos();
        let across = (to - from * from.dot(to)).normalize_or(self.from.axes()[0]);
        let (sin, cos) = (share * angle).sin_cos();
        self.from.seen_from(from * cos + across * sin)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{AxisEnd, Turn};
    use crate::camera::SpaceCamera;
    use crate::model::Model;

    fn model() -> Model {
        let mut model = Model::default();
        model.choices.space = Some(SpaceCamera {
            eye: [0.0, -4.0, 0.0],
            target: [0.0; 3],
            radius: 2.0,
            moved: false,
            tangent: 0.5,
            roll: 0.0,
        });
        model
    }

    #[test]
    fn the_ends_are_seen_where_the_axes_point() {
        let camera = model().choices.space.expect("a camera");
        let ends = AxisEnd::all(&camera);
        assert_eq!((ends[0].view.title, ends[5].view.title), ("Back", "Front"));
        let end = |title| ends.iter().find(|end| end.view.title == title);
        let right = end("Right").expect("one of them");
        assert!((right.at[0] - 1.0).abs() < 1e-12 && right.at[1].abs() < 1e-12);
        let top = end("Top").expect("one of them");
        assert!((top.at[1] + 1.0).abs() < 1e-12, "{top:?}");
        assert_eq!(top.leads_to(), DVec3::Z);
        assert_eq!(ends[5].leads_to(), DVec3::Y, "to the other side");
    }

    #[test]
    fn a_turn_arrives_after_a_quarter_of_a_second_and_is_one_step() {
        let mut model = model();
        let first = model.choices.space;
        let mut turn = Turn::begin(&mut model, DVec3::X, 10.0);
        assert_eq!(model.choices.space, first);
        assert!(Turn::advance(&mut turn, &mut model, 10.125));
        let between = model.choices.space.expect("a camera").eye;
        assert!(between[0] > 1.0 && between[1] < -1.0, "{between:?}");
        assert!(Turn::advance(&mut turn, &mut model, 10.25) && turn.is_none());
        let there = model.choices.space.expect("a camera").eye;
        assert!((there[0] - 4.0).abs() < 1e-9, "{there:?}");
        assert_eq!(model.undo(), Some("Turn the 3D camera"));
        assert_eq!(model.choices.space, first);
    }

    #[test]
    fn a_camera_that_is_moved_on_its_way_stays_where_it_is() {
        let mut model = model();
        let mut turn = Turn::begin(&mut model, DVec3::X, 0.0);
        assert!(Turn::advance(&mut turn, &mut model, 0.1));
        let moved = model
            .choices
            .space
            .map(|camera| camera.moved([1.0, 0.0, 0.0]));
        model.adjust(|choices| choices.space = moved);
        assert!(!Turn::advance(&mut turn, &mut model, 0.2) && turn.is_none());
        assert_eq!(model.choices.space, moved);
    }
}
