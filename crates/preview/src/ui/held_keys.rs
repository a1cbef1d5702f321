//! The held keys, by their physical position on the keyboard.
//!
//! A key may be released under another name than it was pressed: the key of Shift and = is reported as +, and if Shift
//! is released first, the release is of =. So a key is identified by its position until it is released. It moves a
//! camera only if a view had the focus when it was pressed, and has had it since. A key that is pressed and released
//! within one frame, as a short press in a slow frame is, is held for that frame.

use std::collections::BTreeMap;

use egui::{Event, Key};

/// The keys that are held.
#[derive(Debug, Default)]
pub(crate) struct HeldKeys {
    /// By their positions.
    down: BTreeMap<Key, HeldKey>,
}

/// A key that is held.
#[derive(Clone, Copy, Debug)]
struct HeldKey {
    /// Its name when it was pressed.
    name: Key,
    /// True if it belongs to a view.
    moves: bool,
    /// True if it was released in the frame in which it was pressed.
    is_tapped: bool,
}

impl HeldKeys {
    /// Handles the events of a frame. A key that is pressed belongs to a view if `has_key` returns true for it.
    pub(crate) fn update(&mut self, events: &[Event], has_key: impl Fn(Key) -> bool) {
        self.down.retain(|_, held| !held.is_tapped);
        let before: Vec<Key> = self.down.keys().copied().collect();
        for event in events {
            match *event {
                Event::Key {
                    key,
                    physical_key,
                    pressed,
                    ..
                } => {
                    let place = physical_key.unwrap_or(key);
                    if pressed {
                        // A held key repeats, possibly under another name.
                        self.down.entry(place).or_insert(HeldKey {
                            name: key,
                            moves: true,
                            is_tapped: false,
                        });
                    } else if before.contains(&place) {
                        self.down.remove(&place);
                    } else if let Some(held) = self.down.get_mut(&place) {
                        held.is_tapped = true;
                    }
                }
                // Releases outside the window are not reported.
                Event::WindowFocused(false) => self.down.clear(),
                _ => {}
            }
        }
        for held in self.down.values_mut() {
            held.moves &= has_key(held.name);
        }
    }

    /// Releases the held keys from their view: another one has the focus now.
    pub(crate) fn release_views(&mut self) {
        for held in self.down.values_mut() {
            held.moves = false;
        }
    }

    /// Returns whether a key is held and belongs to a view.
    pub(crate) fn moves(&self, key: Key) -> bool {
        self.down
            .values()
            .any(|held| held.moves && held.name == key)
    }

    /// Returns whether any key is held, whether it belongs to a view or not.
    pub(crate) fn any(&self) -> bool {
        !self.down.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::HeldKeys;
    use egui::{Event, Key, Modifiers};

    fn event(key: Key, place: Option<Key>, pressed: bool) -> Event {
        Event::Key {
            key,
            physical_key: place,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    #[test]
    fn a_key_comes_up_under_any_name() {
        for (down, up, place) in [
            (Key::Plus, Key::Equals, Key::Equals),
            (Key::Equals, Key::Plus, Key::Equals),
            (Key::Plus, Key::Plus, Key::Equals),
            (Key::Minus, Key::Minus, Key::Minus),
        ] {
            let mut held = HeldKeys::default();
            held.update(&[event(down, Some(place), true)], |_| true);
            assert!(held.moves(down));
            // It repeats itself under its other name.
            held.update(&[event(up, Some(place), true)], |_| true);
            assert!(held.moves(down));
            held.update(&[event(up, Some(place), false)], |_| true);
            assert!(!held.any(), "{held:?}");
        }
    }

    #[test]
    fn a_key_that_is_tapped_within_a_frame_is_held_for_that_frame() {
        let mut held = HeldKeys::default();
        let tap = [true, false].map(|pressed| event(Key::W, None, pressed));
        held.update(&tap, |_| true);
        assert!(held.moves(Key::W));
        held.update(&tap, |_| true);
        assert!(held.moves(Key::W), "it is tapped again");
        held.update(&[], |_| true);
        assert!(!held.any());
        held.update(&tap, |_| false);
        assert!(!held.moves(Key::W), "a text has the keys");
        held.update(&[], |_| true);
        held.update(&tap[..1], |_| true);
        held.update(&tap[1..], |_| true);
        assert!(!held.any(), "it was held before");
    }

    #[test]
    fn a_key_moves_only_while_a_view_has_had_the_keys_all_the_time() {
        let mut held = HeldKeys::default();
        let press = [event(Key::W, None, true)];
        held.update(&press, |_| false);
        held.update(&press, |_| true);
        assert!(held.any() && !held.moves(Key::W), "it began in a text");
        held.update(&[event(Key::W, None, false)], |_| true);
        held.update(&press, |_| true);
        assert!(held.moves(Key::W));
        held.update(&[], |key| key != Key::W);
        held.update(&press, |_| true);
        assert!(!held.moves(Key::W), "a text had the keys in between");
        held.update(&[Event::WindowFocused(false)], |_| true);
        assert!(!held.any());
        held.update(&press, |_| true);
        held.release_views();
        assert!(held.any() && !held.moves(Key::W));
    }
}
