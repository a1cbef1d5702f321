//! Edits of a text as data: they are applied, composed, and used to move ranges.
//!
//! A [`Changes`] holds what an edit replaces, all in offsets into the text before it. Two consecutive edits are
//! composed into one with the same effect ([`Changes::then`]), so that a reader that lags behind applies one edit
//! instead of many.

use serde::{Deserialize, Serialize};

/// The approximate length that a change adds to a message besides its text, in bytes.
const OVERHEAD: usize = 32;

/// A range of a text and what replaces it.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Change {
    /// The first byte that is replaced, and the byte after the last.
    pub range: [u32; 2],
    /// The new text.
    pub text: String,
}

/// The changes of one edit, in the order of the text and without overlap.
#[derive(Clone, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Changes(Vec<Change>);

impl Changes {
    /// Returns the edit that replaces one range.
    #[must_use]
    pub fn one(range: [u32; 2], text: impl Into<String>) -> Self {
        let text = text.into();
        let mut changes = Composer::default();
        changes.delete(range);
        changes.insert(range[1], &text);
        Self(changes.done)
    }

    /// Returns the edit that turns one text into another: it replaces everything from the first to the last byte that
    /// differs.
    #[must_use]
    pub fn between(old: &str, new: &str) -> Self {
        let (before, after) = (old.as_bytes(), new.as_bytes());
        let mut start = before.iter().zip(after).take_while(|(a, b)| a == b).count();
        while !old.is_char_boundary(start) {
            start -= 1;
        }
        let ends = before[start..].iter().rev();
        let ends = ends.zip(after[start..].iter().rev());
        let mut same = ends.take_while(|(a, b)| a == b).count();
        // Both texts are equal after the end, so both have a character boundary there.
        while !old.is_char_boundary(old.len() - same) {
            same -= 1;
        }
        let range = [start as u32, (old.len() - same) as u32];
        Self::one(range, &new[start..new.len() - same])
    }

    /// Returns the changes, in the order of the text.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Change> {
        self.0.iter()
    }

    /// True if nothing changes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the approximate length of the changes in a message, in bytes, to compare with that of the whole text.
    #[must_use]
    pub fn weight(&self) -> usize {
        let changes = self.0.iter();
        changes.map(|change| change.text.len() + OVERHEAD).sum()
    }

    /// Applies the changes. Returns `None` if they do not fit this text.
    #[must_use]
    pub fn apply(&self, text: &str) -> Option<String> {
        let mut result = String::with_capacity(text.len());
        let mut at = 0;
        for Change { range, text: new } in &self.0 {
            let [start, end] = range.map(|offset| offset as usize);
            result.push_str(text.get(at..start)?);
            // The range must itself be valid in the text.
            text.get(start..end)?;
            result.push_str(new);
            at = end;
        }
        result.push_str(text.get(at..)?);
        Some(result)
    }

    /// Returns a single edit with the effect of this one followed by another, whose offsets refer to the text between
    /// the two.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let mut composer = Composer::default();
        let mut first = Walk::new(&self.0);
        let mut passed = 0;
        for change in &next.0 {
            let [start, end] = change.range;
            first.pass(start.saturating_sub(passed), true, &mut composer);
            first.pass(end.saturating_sub(start), false, &mut composer);
            composer.insert(first.at, &change.text);
            passed = end;
        }
        first.pass_all(&mut composer);
        Self(composer.done)
    }

    /// Returns where a range of the text before the edit is in the text after it. Text that is inserted directly before
    /// or after the range does not belong to it; a range that was itself replaced becomes its replacement.
    #[must_use]
    pub fn moved(&self, [start, end]: [u32; 2]) -> [u32; 2] {
        let mut moved = [start, end].map(i64::from);
        for Change { range, text } in &self.0 {
            let [from, to] = *range;
            let longer = text.len() as i64 - i64::from(to - from);
            moved[0] += match start {
                _ if start >= to => longer,
                _ if start > from => i64::from(from) - i64::from(start),
                _ => 0,
            };
            moved[1] += match end {
                _ if end <= from => 0,
                _ => longer + i64::from(to.max(end) - end),
            };
        }
        let [start, end] = moved.map(|offset| u32::try_from(offset).unwrap_or(0));
        [start, end.max(start)]
    }
}

/// Assembles changes from the start of a text to its end.
#[derive(Default)]
struct Composer {
    done: Vec<Change>,
}

impl Composer {
    /// Records that a range of the first text is absent from the last one.
    fn delete(&mut self, [start, end]: [u32; 2]) {
        if start < end {
            self.change_at(start).range[1] = end;
        }
    }

    /// Records that the last text has new text before an offset of the first one.
    fn insert(&mut self, at: u32, text: &str) {
        if !text.is_empty() {
            self.change_at(at).text.push_str(text);
        }
    }

    /// Returns the change that ends at an offset of the first text.
    fn change_at(&mut self, at: u32) -> &mut Change {
        if self.done.last().is_none_or(|last| last.range[1] != at) {
            self.done.push(Change {
                range: [at, at],
                text: String::new(),
            });
        }
        let last = self.done.len() - 1;
        &mut self.done[last]
    }
}

/// A walk along the text that some changes produce: through the text that they insert and the text that they keep.
struct Walk<'c> {
    ahead: &'c [Change],
    /// The rest of the inserted text in which the walk is.
    inserted: &'c str,
    /// The offset in the text before the changes.
    at: u32,
}

impl<'c> Walk<'c> {
    fn new(changes: &'c [Change]) -> Self {
        Self {
            ahead: changes,
            inserted: "",
            at: 0,
        }
    }

    /// Walks over a number of bytes, which are kept or deleted.
    fn pass(&mut self, mut bytes: u32, stay: bool, composer: &mut Composer) {
        while bytes > 0 {
            if !self.inserted.is_empty() {
                let length = (bytes as usize).min(self.inserted.len());
                // A cut within a character is not valid in the intermediate text: the changes do not belong together.
                let Some((passed, rest)) = self.inserted.split_at_checked(length) else {
                    return;
                };
                if stay {
                    composer.insert(self.at, passed);
                }
                self.inserted = rest;
                bytes -= length as u32;
                continue;
            }
            let next = self.ahead.first().map(|change| change.range[0]);
            if next.is_some_and(|next| next <= self.at) {
                self.enter(composer);
                continue;
            }
            let left = next.map_or(u32::MAX, |next| next - self.at);
            let length = bytes.min(left);
            let end = self.at.saturating_add(length);
            if !stay {
                composer.delete([self.at, end]);
            }
            self.at = end;
            bytes -= length;
        }
    }

    /// Walks to the end.
    fn pass_all(&mut self, composer: &mut Composer) {
        loop {
            composer.insert(self.at, self.inserted);
            self.inserted = "";
            let Some(next) = self.ahead.first() else {
                return;
            };
            self.at = next.range[0];
            self.enter(composer);
        }
    }

    /// Enters the change that begins at the current offset.
    fn enter(&mut self, composer: &mut Composer) {
        if let Some((change, ahead)) = self.ahead.split_first() {
            composer.delete(change.range);
            self.at = change.range[1];
            self.inserted = &change.text;
            self.ahead = ahead;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Change, Changes};

    /// A generator of numbers below a limit, always the same.
    fn random() -> impl FnMut(usize) -> usize {
        let mut seed = 11_u64;
        move |limit| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % limit
        }
    }

    const PIECES: [&str; 7] = ["", "a", "é", "𝛼", "\r\n", "xyz", "€ab"];

    fn text(random: &mut impl FnMut(usize) -> usize, pieces: usize) -> String {
        (0..random(pieces + 1))
            .map(|_| PIECES[random(PIECES.len())])
            .collect()
    }

    /// Some changes of a text.
    fn changes(random: &mut impl FnMut(usize) -> usize, text: &str) -> Changes {
        let places: Vec<u32> = (0..=text.len())
            .filter(|&k| text.is_char_boundary(k))
            .map(|k| k as u32)
            .collect();
        let mut all = Changes::default();
        let mut cuts: Vec<u32> = (0..2 * random(4))
            .map(|_| places[random(places.len())])
            .collect();
        cuts.sort_unstable();
        for range in cuts.chunks_exact(2) {
            let change = Change {
                range: [range[0], range[1]],
                text: self::text(random, 2),
            };
            all.0.push(change);
        }
        all
    }

    #[test]
    fn composed_edits_have_the_effect_of_both() {
        let mut random = random();
        for _ in 0..50_000 {
            let first = text(&mut random, 9);
            let one = changes(&mut random, &first);
            let second = one.apply(&first).expect("of this text");
            let other = changes(&mut random, &second);
            let third = other.apply(&second).expect("of this text");
            let both = one.then(&other);
            let context = format!("{first:?} {one:?} {other:?}: {both:?}");
            assert_eq!(both.apply(&first).as_ref(), Some(&third), "{context}");
            let ends: Vec<_> = both.iter().map(|it| it.range).collect();
            assert!(ends.is_sorted_by(|a, b| a[1] < b[0]), "{context}");
        }
    }

    #[test]
    fn it_does_not_matter_which_of_several_edits_are_composed_first() {
        let mut random = random();
        for _ in 0..20_000 {
            let mut last = text(&mut random, 9);
            let first = last.clone();
            let edits: Vec<Changes> = (0..3)
                .map(|_| {
                    let edit = changes(&mut random, &last);
                    last = edit.apply(&last).expect("of this text");
                    edit
                })
                .collect();
            let [a, b, c] = &edits[..] else {
                panic!("three")
            };
            assert_eq!(a.then(b).then(c).apply(&first), Some(last.clone()));
            assert_eq!(a.then(&b.then(c)).apply(&first), Some(last));
        }
    }

    #[test]
    fn the_edit_between_two_texts_turns_one_into_the_other() {
        let mut random = random();
        for _ in 0..20_000 {
            let (old, new) = (text(&mut random, 6), text(&mut random, 6));
            let edit = Changes::between(&old, &new);
            assert_eq!(edit.apply(&old).as_ref(), Some(&new));
            assert_eq!(edit.is_empty(), old == new);
        }
        // Both begin with the same byte, but not with the same character.
        let edit = Changes::between("é", "è");
        assert_eq!(edit, Changes::one([0, 2], "è"));
    }

    #[test]
    fn changes_of_another_text_are_not_applied() {
        for (range, text) in [
            ([0, 9], "abc"),
            ([2, 1], "abc"),
            ([1, 2], "é"),
            ([4, 4], "abc"),
        ] {
            let change = Change {
                range,
                text: "x".to_owned(),
            };
            assert_eq!(Changes(vec![change]).apply(text), None, "{range:?}");
        }
        let overlapping = [[0, 2], [1, 3]].map(|range| Change {
            range,
            text: String::new(),
        });
        assert_eq!(Changes(overlapping.to_vec()).apply("abc"), None);
    }

    #[test]
    fn a_range_keeps_its_word_whatever_changes_around_it() {
        let old = "define a = 1;\nsurface s(u,v) = (u,v,0);\n";
        let at = old.find("s(u").expect("it is there") as u32;
        for new in [
            "# new\ndefine a = 1;\nsurface s(u,v) = (u,v,0);\n",
            "surface s(u,v) = (u,v,0);\n",
            "define a = 1;\nsurface s(u,v) = (u,v,uv sin u);\n# é",
            "define a = 1;\n  surface s(u,v) = (u,v,0);\n",
            old,
        ] {
            let [start, end] = Changes::between(old, new).moved([at, at + 1]);
            assert_eq!(&new[start as usize..end as usize], "s", "{new}");
            assert_eq!(&new[end as usize..][..2], "(u", "{new}");
        }
        // Letters directly beside it are not its own.
        assert_eq!(Changes::between("a b c", "a xb c").moved([2, 3]), [3, 4]);
        assert_eq!(Changes::between("a b c", "a bx c").moved([2, 3]), [2, 3]);
    }

    #[test]
    fn a_range_that_was_itself_changed_becomes_what_stands_there() {
        let old = "point p = 1;";
        assert_eq!(Changes::between(old, "point q = 1;").moved([6, 7]), [6, 7]);
        assert_eq!(Changes::between(old, "").moved([6, 7]), [0, 0]);
        let [start, end] = Changes::between("a", "b").moved([7, 9]);
        assert!(start <= end);
        // Part of it.
        let longer = Changes::one([1, 3], "xyz");
        assert_eq!(longer.moved([0, 2]), [0, 4]);
        assert_eq!(longer.moved([2, 5]), [1, 6]);
    }
}
