//! Keeps the events of the pointer and of keys in order, so that none is lost in a slow frame.
//!
//! Events between two frames arrive at once. egui then knows the position of the pointer at the end, not that of the
//! press, and does not recognise a drag that is pressed and released within a frame. So a press, the motion after it,
//! and the release after that each get a frame, as though frames had been quick; and so does text typed after a click,
//! since only then does the clicked control have the focus.
//!
//! Keys that the window handles before the text field (to save, to complete a word) are passed on in a frame after the
//! letters that were typed before them.

use egui::{Context, Event, Id, Key, Modifiers, Plugin, RawInput};

/// Passes events on in parts.
#[derive(Debug, Default)]
pub(crate) struct EventSplitter {
    /// Events for the next frame, or later ones.
    later: Vec<Event>,
}

impl EventSplitter {
    /// Presses the Tab key again in the next frame, with Shift if that is held.
    pub(crate) fn press_tab(context: &Context) {
        let modifiers = context.input(|input| input.modifiers);
        context.data_mut(|data| data.insert_temp(Self::again(), modifiers));
        context.request_repaint();
    }

    fn again() -> Id {
        Id::unique("press Tab again")
    }
}

impl Plugin for EventSplitter {
    fn debug_name(&self) -> &'static str {
        "events in their order"
    }

    fn input_hook(&mut self, context: &Context, input: &mut RawInput) {
        // A frame that is laid out again takes no further input, and the window's keys would miss it.
        if context.current_pass_index() > 0 {
            return;
        }
        let mut events = std::mem::take(&mut self.later);
        let again = context.data_mut(|data| data.remove_temp::<Modifiers>(Self::again()));
        if let Some(modifiers) = again {
            events.extend([true, false].map(|pressed| Event::Key {
                key: Key::Tab,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers,
            }));
        }
        events.append(&mut input.events);
        self.later = events.split_off(first_part(&events));
        input.events = events;
        if !self.later.is_empty() {
            context.request_repaint();
        }
    }
}

/// Returns the number of events that one frame can handle.
fn first_part(events: &[Event]) -> usize {
    let (mut pressed, mut moved, mut clicked, mut typed) = (false, false, false, false);
    for (at, event) in events.iter().enumerate() {
        match event {
            Event::PointerMoved(_) if pressed => return at,
            Event::PointerMoved(_) => moved = true,
            Event::PointerButton { pressed: true, .. } => pressed = true,
            // A release at the point of the press, without any motion, is a click.
            Event::PointerButton { pressed: false, .. } if moved && !pressed => return at,
            // Typed text belongs to the control that was clicked, which has the focus in the next frame.
            Event::Key { .. } | Event::Text(_) | Event::Paste(_) | Event::Ime(_) if clicked => {
                return at;
            }
            Event::Key {
                key,
                pressed: true,
                modifiers,
                ..
            } if typed && is_command(*key, *modifiers) => return at,
            _ => {}
        }
        typed |= matches!(event, Event::Text(_) | Event::Paste(_));
        clicked |= matches!(event, Event::PointerButton { .. });
    }
    events.len()
}

/// Returns whether a key does something else than write a letter.
fn is_command(key: Key, modifiers: Modifiers) -> bool {
    let is_special = matches!(
        key,
        Key::Tab | Key::Enter | Key::Escape | Key::ArrowUp | Key::ArrowDown
    );
    is_special || modifiers.command || modifiers.ctrl
}

#[cfg(test)]
mod tests {
    use super::{EventSplitter, first_part};
    use egui::{Context, Event, Key, Modifiers, PointerButton, Pos2, RawInput};

    /// The parts in which events are handed over: `m` moves, `p` presses, `r` releases, `t` is a text, `k` is the
    /// key Tab.
    fn parts(events: &str) -> Vec<String> {
        let button = |pressed| Event::PointerButton {
            pos: Pos2::ZERO,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let event = |letter: char| match letter {
            'm' => Event::PointerMoved(Pos2::ZERO),
            'p' => button(true),
            'r' => button(false),
            'k' => Event::Key {
                key: Key::Tab,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
            },
            _ => Event::Text(String::new()),
        };
        let all: Vec<Event> = events.chars().map(event).collect();
        let (mut rest, mut parts) = (events, Vec::new());
        let mut left = &all[..];
        while !left.is_empty() {
            let many = first_part(left);
            parts.push(rest[..many].to_owned());
            (rest, left) = (&rest[many..], &left[many..]);
        }
        parts
    }

    #[test]
    fn a_drag_within_a_frame_is_handed_over_in_parts() {
        assert_eq!(parts("mpmmr"), ["mp", "mm", "r"]);
        assert_eq!(parts("mmr"), ["mm", "r"]);
        assert_eq!(parts("pmtrmp"), ["p", "mt", "rmp"]);
        assert_eq!(parts("mprttm"), ["mpr", "ttm"]);
    }

    #[test]
    fn what_is_handed_over_later_comes_in_the_next_frame_however_often_this_one_is_laid_out() {
        let context = Context::default();
        context.add_plugin(EventSplitter::default());
        let tab = Event::Key {
            key: Key::Tab,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let mut seen = Vec::new();
        for events in [vec![Event::Text("a".to_owned()), tab], Vec::new()] {
            let input = RawInput {
                events,
                ..RawInput::default()
            };
            let output = context.run_ui(input, |ui| {
                let pass = ui.ctx().current_pass_index();
                seen.push((pass, ui.input(|input| input.events.len())));
                if pass == 0 {
                    ui.ctx().request_discard("a test");
                }
            });
            output.drop_without_applying_deltas();
        }
        assert_eq!(seen, [(0, 1), (1, 0), (0, 1), (1, 0)]);
    }

    #[test]
    fn a_command_comes_behind_what_was_typed_before_it() {
        assert_eq!(parts("ttktkk"), ["tt", "kt", "kk"]);
        assert_eq!(parts("kkt"), ["kkt"]);
    }

    #[test]
    fn clicks_and_plain_motion_are_handed_over_in_one() {
        assert_eq!(parts("mmpr"), ["mmpr"]);
        assert_eq!(parts("prpr"), ["prpr"]);
        assert_eq!(parts("mmmt"), ["mmmt"]);
    }
}
