//! The texts that a window has been sent, for as long as it may speak of them, and where their places are now.

use std::collections::VecDeque;
use std::sync::Arc;

use syntax::span::Span;

/// How many texts are kept. A window reads on while it compiles, but it speaks of what it shows.
const MOST: usize = 16;

/// The texts by version, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Sent {
    texts: VecDeque<(i32, Arc<str>)>,
    /// The last text that was shown without errors: its picture stays while later texts have errors.
    good: Option<(i32, Arc<str>)>,
}

impl Sent {
    /// A text is on its way.
    pub(crate) fn put(&mut self, version: i32, text: Arc<str>) {
        // A document that was opened anew counts from the start.
        self.never_read(version);
        self.texts.push_back((version, text));
        if self.texts.len() > MOST {
            self.texts.pop_front();
        }
    }

    /// A later text has taken the place of this one before the window has read it.
    pub(crate) fn never_read(&mut self, version: i32) {
        self.texts.retain(|(known, _)| *known != version);
    }

    /// The window shows a text: of those before it, it speaks no more.
    pub(crate) fn shown(&mut self, version: i32, ok: bool) {
        let Some(at) = self.texts.iter().position(|(known, _)| *known == version) else {
            return;
        };
        self.texts.drain(..at);
        if ok {
            self.good = self.texts.front().cloned();
        }
    }

    /// The text of a version.
    pub(crate) fn text(&self, version: i32) -> Option<&Arc<str>> {
        let known = self.texts.iter().chain(&self.good);
        known
            .filter(|(known, _)| *known == version)
            .map(|(_, text)| text)
            .next()
    }

    /// How many texts are kept.
    #[cfg(test)]
    fn len(&self) -> usize {
        self.texts.len() + usize::from(self.good.is_some())
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
