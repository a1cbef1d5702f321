//! The texts that a window has been sent, for as long as it may speak of them, and where their places are now.
//!
//! A window is told a number with each text, which only grows. It is the editor's version, until the document is closed
//! and opened again: editors may count from the start then, or give a number twice.

use std::collections::VecDeque;
use std::sync::Arc;

use syntax::span::Span;

/// How many texts are kept. A window reads on while it compiles, but it speaks of what it shows.
const MOST: usize = 16;

/// The texts by number, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Sent {
    texts: VecDeque<(i32, Arc<str>)>,
    /// The last text that was shown without errors: its picture stays while later texts have errors.
    good: Option<(i32, Arc<str>)>,
    numbers: Numbers,
}

/// How texts are numbered.
#[derive(Debug, Default)]
struct Numbers {
    last: Option<i32>,
    /// By how much the numbers are above the editor's versions, …
    above: i64,
    /// … since this one.
    since: i32,
}

impl Sent {
    /// The text of a version is on its way; its number.
    pub(crate) fn put(&mut self, version: i32, text: Arc<str>) -> i32 {
        let number = self.numbers.next(version);
        self.texts.push_back((number, text));
        if self.texts.len() > MOST {
            self.texts.pop_front();
        }
        number
    }

    /// The number of the text of a version that the editor has now.
    pub(crate) fn number(&self, version: i32) -> i32 {
        self.numbers.of(version)
    }

    /// The editor's version of a number; none where it was that of a document which was opened anew since.
    pub(crate) fn version(&self, number: i32) -> Option<i32> {
        let version = i64::from(number) - self.numbers.above;
        let known = number >= self.numbers.since;
        known.then(|| i32::try_from(version).ok()).flatten()
    }

    /// A later text has taken the place of this one before the window has read it.
    pub(crate) fn never_read(&mut self, number: i32) {
        self.texts.retain(|(known, _)| *known != number);
    }

    /// The window shows a text: of those before it, it speaks no more.
    pub(crate) fn shown(&mut self, number: i32, ok: bool) {
        let Some(at) = self.texts.iter().position(|(known, _)| *known == number) else {
            return;
        };
        self.texts.drain(..at);
        if ok {
            self.good = self.texts.front().cloned();
        }
    }

    /// The text of a number.
    pub(crate) fn text(&self, number: i32) -> Option<&Arc<str>> {
        let known = self.texts.iter().chain(&self.good);
        known
            .filter(|(known, _)| *known == number)
            .map(|(_, text)| text)
            .next()
    }

    /// How many texts are kept.
    #[cfg(test)]
    fn len(&self) -> usize {
        self.texts.len() + usize::from(self.good.is_some())
    }
}

impl Numbers {
    /// The number of the next text, which has a version.
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

/// Where a span of a text stands in a later one: behind what has been changed before it. A span that has itself been
/// changed becomes what stands in its place.
pub(crate) fn moved(old: &str, new: &str, span: Span) -> Span {
    let (before, after) = (old.as_bytes(), new.as_bytes());
    let prefix = before.iter().zip(after).take_while(|(a, b)| a == b).count();
    let ends = before[prefix..]
        .iter()
        .rev()
        .zip(after[prefix..].iter().rev());
    let suffix = ends.take_while(|(a, b)| a == b).count();
    let behind = old.len() - suffix;
    let later = |offset: usize| new.len() - (old.len() - offset);
    let [start, end] = [span.start, span.end].map(|offset| (offset as usize).min(old.len()));
    // Something new directly before the span does not belong to it, nor does something directly behind.
    let start = match start {
        _ if start >= behind => later(start),
        _ => start.min(prefix),
    };
    let end = match end {
        _ if end <= prefix => end,
        _ => later(end.max(behind)),
    };
    Span::new(start as u32, end.max(start) as u32)
}

#[cfg(test)]
mod tests {
    use super::{MOST, Sent, moved};
    use syntax::span::Span;

    #[test]
    fn a_span_keeps_its_word_whatever_changes_around_it() {
        let old = "define a = 1;\nsurface s(u,v) = (u,v,0);\n";
        let at = old.find("s(u").expect("it is there") as u32;
        let span = Span::new(at, at + 1);
        for new in [
            "# new\ndefine a = 1;\nsurface s(u,v) = (u,v,0);\n",
            "surface s(u,v) = (u,v,0);\n",
            "define a = 1;\nsurface s(u,v) = (u,v,uv sin u);\n# é",
            "define a = 1;\n  surface s(u,v) = (u,v,0);\n",
            old,
        ] {
            let now = moved(old, new, span);
            assert_eq!(now.text(new), "s", "{new}");
            assert_eq!(&new[now.end as usize..][..2], "(u", "{new}");
        }
        // Letters directly beside it are not its own.
        let now = moved("a b c", "a xb c", Span::new(2, 3));
        assert_eq!((now.start, now.end), (3, 4));
        let now = moved("a b c", "a bx c", Span::new(2, 3));
        assert_eq!((now.start, now.end), (2, 3));
    }

    #[test]
    fn a_span_that_was_itself_changed_becomes_what_stands_there() {
        let old = "point p = 1;";
        let now = moved(old, "point q = 1;", Span::new(6, 7));
        assert_eq!(now.text("point q = 1;"), "q");
        assert_eq!(moved(old, "", Span::new(6, 7)), Span::new(0, 0));
        let beyond = moved("a", "b", Span::new(7, 9));
        assert!(beyond.start <= beyond.end && beyond.end <= 1);
    }

    #[test]
    fn numbers_only_grow_also_where_an_editor_counts_anew() {
        let mut sent = Sent::default();
        let mut put = |version| {
            let number = sent.put(version, version.to_string().into());
            assert_eq!(sent.number(version), number);
            assert_eq!(sent.version(number), Some(version));
            number
        };
        assert_eq!([4, 5, 9].map(&mut put), [4, 5, 9], "the editor's own");
        assert_eq!([0, 1, 7].map(&mut put), [10, 11, 17], "from the start");
        assert_eq!([7, 8].map(&mut put), [18, 19], "a number twice");
        assert_eq!([i32::MAX, 3].map(&mut put), [i32::MAX; 2]);
        let mut sent = Sent::default();
        sent.put(5, "old".into());
        sent.put(5, "new".into());
        sent.shown(5, true);
        assert_eq!(sent.text(5).map(|t| &**t), Some("old"), "its picture");
        assert_eq!(sent.text(6).map(|t| &**t), Some("new"));
        assert_eq!(sent.version(5), None, "of a document that was closed");
    }

    #[test]
    fn only_texts_that_the_window_may_speak_of_are_kept() {
        let mut sent = Sent::default();
        for version in 1..=10_000 {
            sent.put(version, version.to_string().into());
            assert!(sent.len() <= MOST + 1);
        }
        sent.shown(9_998, true);
        sent.shown(10_000, false);
        assert_eq!(sent.text(9_998).map(|t| &**t), Some("9998"), "its picture");
        assert_eq!(sent.text(9_999), None);
        assert_eq!(sent.text(10_000).map(|t| &**t), Some("10000"));
        assert_eq!(sent.len(), 2);
        sent.put(10_001, "a".into());
        sent.never_read(10_001);
        assert_eq!(sent.text(10_001), None);
    }
}
