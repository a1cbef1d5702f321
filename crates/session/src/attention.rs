//! The pause in typing before faults are shown, and the time for which the object at the cursor is emphasised.

use crate::Model;
use crate::model::Emphasis;

/// The pause in typing after which faults are shown, in seconds.
const TYPING_PAUSE: f64 = 0.5;
/// The time for which the object at the cursor is emphasised in the views in space, in seconds.
const EMPHASIS: f64 = 1.0;

/// The times at which faults are shown and the emphasis ends, in seconds of the host's clock.
#[derive(Debug, Default)]
pub struct Attention {
    /// The text counts as being typed until this time.
    typing_until: f64,
    /// The object at the cursor is emphasised until this time.
    emphasis_until: f64,
}

impl Attention {
    /// Notes that the text has changed.
    pub fn note_text(&mut self, now: f64) {
        self.typing_until = now + TYPING_PAUSE;
    }

    /// Shows the faults of the text after the pause, and starts and ends the emphasis. Returns true if pending faults
    /// are shown now.
    pub fn advance(&mut self, model: &mut Model, now: f64) -> bool {
        let shows = now >= self.typing_until && model.faults.are_waiting();
        if shows {
            model.faults.show_latest();
        }
        model.emphasis = match model.emphasis {
            Emphasis::Begins => {
                self.emphasis_until = now + EMPHASIS;
                Emphasis::On
            }
            Emphasis::On if now < self.emphasis_until => Emphasis::On,
            _ => Emphasis::Off,
        };
        shows
    }

    /// Returns the next known time at which [`Attention::advance`] changes something.
    pub fn next_end(&self, model: &Model) -> Option<f64> {
        let typing = model.faults.are_waiting().then_some(self.typing_until);
        let emphasis = (model.emphasis == Emphasis::On).then_some(self.emphasis_until);
        typing.into_iter().chain(emphasis).reduce(f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::Attention;
    use crate::Model;
    use crate::model::Emphasis;

    #[test]
    fn the_object_at_the_cursor_is_set_off_for_a_second() {
        let (mut attention, mut model) = (Attention::default(), Model::default());
        assert_eq!(attention.next_end(&model), None);
        model.emphasis = Emphasis::Begins;
        for (now, wanted) in [(5.0, Emphasis::On), (5.9, Emphasis::On)] {
            assert!(!attention.advance(&mut model, now), "there are no faults");
            assert_eq!(model.emphasis, wanted);
            assert_eq!(attention.next_end(&model), Some(6.0));
        }
        attention.advance(&mut model, 6.0);
        assert_eq!(model.emphasis, Emphasis::Off);
        assert_eq!(attention.next_end(&model), None);
    }
}
