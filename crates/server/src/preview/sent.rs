//! The versions of the text that a window has been sent, for as long as it may refer to them, and the current locations
//! of their ranges.
//!
//! A window gets a number with each text, which only increases. It is the editor's version, until the document is
//! closed and opened again: then editors may count from the start, or use a number twice.

use std::collections::VecDeque;

use protocol::changes::Changes;

/// The maximum number of versions that are kept. A window reads ahead while it compiles, but refers to the version that
/// it shows.
const MOST: usize = 16;

/// The versions by number, oldest first.
#[derive(Debug, Default)]
pub(crate) struct SentVersions {
    /// Each with the changes from its text to the next one.
    versions: VecDeque<(i32, Changes)>,
    /// The last version that was shown without errors, since its picture stays while later ones have errors; with the
    /// changes that lead to the first of `versions`.
    good: Option<(i32, Changes)>,
    numbers: Numbers,
}

/// The numbering of versions.
#[derive(Debug, Default)]
struct Numbers {
    last: Option<i32>,
    /// The difference between the numbers and the editor's versions, …
    above: i64,
    /// … since this one.
    since: i32,
}

impl SentVersions {
    /// Adds a version of the editor. Returns its number. `changes` lead to it from the last one; without them, ranges
    /// in earlier versions can no longer be located.
    pub(crate) fn put(&mut self, version: i32, changes: Option<&Changes>) -> i32 {
        match (self.versions.back_mut(), changes) {
            (Some((_, last)), Some(changes)) => *last = last.then(changes),
            _ => {
                self.versions.clear();
                self.good = None;
            }
        }
        let number = self.numbers.next(version);
        self.versions.push_back((number, Changes::default()));
        if self.versions.len() > MOST {
            self.drop_first();
        }
        number
    }

    /// Returns the number of the last version.
    pub(crate) fn last(&self) -> Option<i32> {
        self.numbers.last
    }

    /// Returns the number of a current version of the editor.
    pub(crate) fn number(&self, version: i32) -> i32 {
        self.numbers.of(version)
    }

    /// Returns the editor's version of a number; `None` if the document has been opened again since.
    pub(crate) fn version(&self, number: i32) -> Option<i32> {
        let version = i64::from(number) - self.numbers.above;
        let known = number >= self.numbers.since;
        known.then(|| i32::try_from(version).ok()).flatten()
    }

    /// Forgets a version that a later one has superseded before the window has read it.
    pub(crate) fn never_read(&mut self, number: i32) {
        let last = self.versions.len().saturating_sub(1);
        let mut known = self.versions.iter();
        match known.position(|(known, _)| *known == number) {
            Some(0) if last > 0 => self.drop_first(),
            Some(at) if at < last => {
                if let Some((_, changes)) = self.versions.remove(at) {
                    let (_, before) = &mut self.versions[at - 1];
                    *before = before.then(&changes);
                }
            }
            _ => {}
        }
    }

    /// Notes that the window shows a version: it no longer refers to earlier ones.
    pub(crate) fn shown(&mut self, number: i32, ok: bool) {
        let mut known = self.versions.iter();
        let Some(at) = known.position(|(known, _)| *known == number) else {
            return;
        };
        for _ in 0..at {
            self.drop_first();
        }
        if ok {
            self.good = Some((number, Changes::default()));
        }
    }

    /// Returns the current location of a range of a version; `None` if the version is not known.
    pub(crate) fn moved(&self, number: i32, mut range: [u32; 2]) -> Option<[u32; 2]> {
        let mut known = self.versions.iter();
        let first = match known.position(|(known, _)| *known == number) {
            Some(at) => at,
            None => {
                let (_, changes) = self.good.as_ref().filter(|(good, _)| *good == number)?;
                range = changes.moved(range);
                0
            }
        };
        let steps = self.versions.iter().skip(first);
        Some(steps.fold(range, |range, (_, changes)| changes.moved(range)))
    }

    fn drop_first(&mut self) {
        if let Some((_, changes)) = self.versions.pop_front()
            && let Some((_, good)) = &mut self.good
        {
            *good = good.then(&changes);
        }
    }

    /// Returns the number of versions that are kept.
    #[cfg(test)]
    fn len(&self) -> usize {
        self.versions.len() + usize::from(self.good.is_some())
    }
}

impl Numbers {
    /// Returns the number of the next text, which has a version.
    fn next(&mut self, version: i32) -> i32 {
        let number = match self.last {
            Some(last) if self.of(version) <= last => last.saturating_add(1),
            _ => self.of(version),
        };
        let above = i64::from(number) - i64::from(version);
        if self.last.is_none() || above != self.above {
            self.since = number;
        }
        (self.above, self.last) = (above, Some(number));
        number
    }

    fn of(&self, version: i32) -> i32 {
        let number = i64::from(version) + self.above;
        number.clamp(i32::MIN.into(), i32::MAX.into()) as i32
    }
}

#[cfg(test)]
mod tests {
    use protocol::changes::Changes;

    use super::{MOST, SentVersions};

    /// An edit that puts a byte before the text.
    fn byte() -> Changes {
        Changes::one([0, 0], "x")
    }

    #[test]
    fn numbers_only_grow_also_where_an_editor_counts_anew() {
        let mut sent = SentVersions::default();
        let mut put = |version| {
            let number = sent.put(version, Some(&byte()));
            assert_eq!(sent.number(version), number);
            assert_eq!(sent.version(number), Some(version));
            assert_eq!(sent.last(), Some(number));
            number
        };
        assert_eq!([4, 5, 9].map(&mut put), [4, 5, 9], "the editor's own");
        assert_eq!([0, 1, 7].map(&mut put), [10, 11, 17], "from the start");
        assert_eq!([7, 8].map(&mut put), [18, 19], "a number twice");
        assert_eq!([i32::MAX, 3].map(&mut put), [i32::MAX; 2]);
        let mut sent = SentVersions::default();
        sent.put(5, None);
        sent.put(5, Some(&byte()));
        sent.shown(5, true);
        assert_eq!(sent.moved(5, [3, 4]), Some([4, 5]), "its picture");
        assert_eq!(sent.moved(6, [3, 4]), Some([3, 4]));
        assert_eq!(sent.version(5), None, "of a document that was closed");
    }

    #[test]
    fn only_versions_that_the_window_may_speak_of_are_kept() {
        let mut sent = SentVersions::default();
        for version in 1..=10_000 {
            sent.put(version, Some(&byte()));
            assert!(sent.len() <= MOST + 1);
        }
        sent.shown(9_998, true);
        sent.shown(10_000, false);
        assert_eq!(sent.moved(9_998, [0, 1]), Some([2, 3]), "its picture");
        assert_eq!(sent.moved(9_999, [0, 1]), None);
        assert_eq!(sent.moved(10_000, [0, 1]), Some([0, 1]));
        assert_eq!(sent.len(), 2);
        sent.put(10_001, Some(&byte()));
        sent.put(10_002, Some(&byte()));
        sent.never_read(10_001);
        assert_eq!(sent.moved(10_001, [0, 1]), None);
        for (number, at) in [(9_998, 4), (10_000, 2), (10_002, 0)] {
            assert_eq!(sent.moved(number, [0, 1]), Some([at, at + 1]));
        }
        // However long the picture stays.
        for version in 10_003..=10_100 {
            sent.put(version, Some(&byte()));
        }
        assert_eq!(sent.moved(9_998, [0, 1]), Some([102, 103]));
        // A text that has nothing to do with the ones before.
        sent.put(10_101, None);
        assert_eq!(sent.moved(9_998, [0, 1]), None);
        assert_eq!(sent.len(), 1);
    }
}
