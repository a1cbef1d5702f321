//! The window's side of the edits: determines which of them apply to its text.

/// Follows the versions of a text through the commands, in order.
#[derive(Clone, Debug, Default)]
pub struct Follower {
    /// The version that the reader has; `None` before the first text and after a gap.
    version: Option<i32>,
    /// True while a requested text has not arrived.
    waits: bool,
}

/// The error that an edit applies to a text that the reader does not have.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Gap {
    /// True for the first edit after the gap: the reader requests the text once.
    pub ask: bool,
}

impl Follower {
    /// Returns the version that the reader has.
    #[must_use]
    pub fn version(&self) -> Option<i32> {
        self.version
    }

    /// Notes a whole text.
    pub fn text(&mut self, version: i32) {
        self.version = Some(version);
        self.waits = false;
    }

    /// Notes an edit.
    ///
    /// # Errors
    /// [`Gap`] if the edit does not apply to the version that the reader has. No edit applies after that until the next
    /// text.
    pub fn edit(&mut self, version: i32, base: i32) -> Result<(), Gap> {
        if self.version == Some(base) {
            self.version = Some(version);
            return Ok(());
        }
        let ask = !self.waits;
        self.wait();
        Err(Gap { ask })
    }

    /// Notes that the reader has no text and has requested it: edits do not apply until it arrives.
    pub fn wait(&mut self) {
        self.version = None;
        self.waits = true;
    }
}

#[cfg(test)]
mod tests {
    use super::{Follower, Gap};

    #[test]
    fn edits_apply_to_the_version_that_they_name_and_a_gap_is_reported_once() {
        let mut follower = Follower::default();
        assert_eq!(follower.edit(2, 1), Err(Gap { ask: true }), "no text yet");
        follower.text(3);
        assert_eq!(follower.edit(4, 3), Ok(()));
        assert_eq!(follower.edit(9, 4), Ok(()));
        assert_eq!(follower.version(), Some(9));
        assert_eq!(follower.edit(11, 10), Err(Gap { ask: true }));
        assert_eq!(follower.edit(12, 11), Err(Gap { ask: false }));
        assert_eq!(follower.edit(13, 9), Err(Gap { ask: false }), "overtaken");
        assert_eq!(follower.version(), None);
        follower.text(13);
        assert_eq!(follower.edit(14, 13), Ok(()));
        follower.wait();
        assert_eq!(follower.edit(15, 14), Err(Gap { ask: false }));
    }
}
