//! What can be shown of a program with errors.
//!
//! In: a text. Out: its diagnostics, and a scene. Where a declaration has an error, its last good text stands in for
//! it, so that the others keep up with what is written; where there is none, it is left out, and so is what needs it.

use std::collections::{BTreeSet, HashMap, HashSet};

use scene::Scene;
use scene::geotrace::Document;
use syntax::diagnostic::{Code, Diagnostic, Severity};
use syntax::document::{ChunkId, EditError};
use syntax::geotrace::actions::Operator;
use syntax::geotrace::document::{Event, Snapshot};
use syntax::span::Span;

use crate::state::Declared;

/// How often declarations are stood in for or left out before the whole scene is given up: each round can only bring out
/// errors of what used the one before.
const ROUNDS: usize = 12;

/// Reads texts one after the other, and remembers the last good declarations.
#[derive(Debug, Default)]
pub(crate) struct Mender {
    document: Option<Document>,
    good: Good,
    /// The mended text that was shown last, as long as there are errors.
    mended: Option<Document>,
}

/// What was read.
#[derive(Debug, Default)]
pub(crate) struct Read {
    /// Of the text as it is.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// What the text declares, in its order.
    pub(crate) declared: Vec<Declared>,
    /// Places of names are those of the text as it is; of a declaration that is stood in for, its place.
    pub(crate) scene: Option<Scene>,
    /// The objects that are shown as they last were, and those that read something that is.
    pub(crate) stale: Vec<String>,
    /// Something of the text is not shown at all.
    pub(crate) lacks: bool,
}

/// The last good text of each declaration.
#[derive(Debug, Default)]
struct Good {
    /// The last text without errors.
    whole: Option<Snapshot>,
    /// What was good since then, by name.
    since: HashMap<String, String>,
}

/// A part of a mended text.
#[derive(Debug)]
struct Piece {
    /// Where it stands in the text as it is.
    place: Span,
    /// What is declared there; an empty name where it was not read.
    names: Vec<String>,
    /// The text there, or what stands in for it.
    text: String,
    /// It is the text that stands there.
    own: bool,
    /// Something that stands there is not in it.
    lacks: bool,
}

impl Mender {
    /// Reads a text, of which only what differs from the one before is read anew.
    pub(crate) fn read(&mut self, text: &str) -> Read {
        if let Err(error) = bring(&mut self.document, text) {
            let code = Code("too-large");
            let sentence = error.to_string();
            return Read {
                diagnostics: vec![Diagnostic::error(code, Span::default(), sentence)],
                ..Read::default()
            };
        }
        let Some(document) = &self.document else {
            return Read::default();
        };
        let compilation = document.compilation();
        let read = Read {
            diagnostics: compilation.diagnostics.clone(),
            declared: declared(document),
            ..Read::default()
        };
        if let Some(scene) = &compilation.scene {
            self.good = Good {
                whole: Some(document.text().snapshot()),
                since: HashMap::new(),
            };
            self.mended = None;
            return Read {
                scene: Some(scene.clone()),
                ..read
            };
        }
        let pieces = self.pieces(document, &read.diagnostics);
        // It differs by a few declarations, and only those are read.
        self.mended.get_or_insert_with(|| document.clone());
        self.mend(pieces, read)
    }

    /// The pieces of a text with errors, of which some are stood in for.
    fn pieces(&self, document: &Document, diagnostics: &[Diagnostic]) -> Vec<Piece> {
        let piece = |chunk: ChunkId| {
            let text = document.text().chunk_text(chunk);
            let start = document.text().start(chunk);
            Piece {
                place: Span::new(start, start + text.len() as u32),
                names: names_of(document, chunk),
                text: text.to_owned(),
                own: true,
                lacks: false,
            }
        };
        let mut pieces: Vec<Piece> = document.text().chunks().map(piece).collect();
        let places = pieces.iter().map(|piece| piece.place).collect::<Vec<_>>();
        for at in faulty(&places, diagnostics) {
            pieces[at].stand_in(&self.good);
        }
        pieces
    }

    /// What can be shown of pieces; what still has errors is stood in for, and left out where that does not help.
    fn mend(&mut self, mut pieces: Vec<Piece>, read: Read) -> Read {
        for _ in 0..ROUNDS {
            let mut places = Vec::with_capacity(pieces.len());
            let mut text = String::new();
            for piece in &pieces {
                let start = text.len() as u32;
                text.push_str(&piece.text);
                places.push(Span::new(start, text.len() as u32));
            }
            if bring(&mut self.mended, &text).is_err() {
                return read;
            }
            let Some(mended) = &self.mended else {
                return read;
            };
            let compilation = mended.compilation();
            if let Some(scene) = &compilation.scene {
                let stale = stale(mended, scene, &pieces, &places);
                let scene = moved(scene.clone(), &pieces, &places);
                self.good.note(&pieces);
                return Read {
                    scene: Some(scene),
                    stale,
                    lacks: pieces.iter().any(|piece| piece.lacks),
                    ..read
                };
            }
            let faulty = faulty(&places, &compilation.diagnostics);
            self.go_on(&mut pieces, faulty);
        }
        read
    }

    /// Stands in for pieces that have errors, or leaves them out. What those need that are stood in for and stands nowhere
    /// any more is put before the first that needs it.
    fn go_on(&self, pieces: &mut Vec<Piece>, faulty: BTreeSet<usize>) {
        let names = pieces.iter().flat_map(|piece| &piece.names);
        let known: HashSet<String> = names.cloned().collect();
        let mut revived: HashMap<String, usize> = HashMap::new();
        for at in faulty {
            let piece = &mut pieces[at];
            if piece.own {
                piece.stand_in(&self.good);
                continue;
            }
            let mut missing = self.good.reads(&piece.names);
            missing.retain(|name| !known.contains(name));
            if missing.is_empty() {
                piece.text.clear();
                piece.lacks = true;
            }
            for name in missing {
                revived.entry(name).or_insert(at);
            }
        }
        let mut revived: Vec<(usize, String)> =
            revived.into_iter().map(|(name, at)| (at, name)).collect();
        revived.sort();
        // From the last to the first, so that none moves one that is yet to come.
        for (at, name) in revived.into_iter().rev() {
            let place = pieces[at].place;
            pieces.insert(at, Piece::revived(name, place, &self.good));
        }
    }
}

impl Piece {
    /// What was declared there when it was good takes the place of what stands there.
    fn stand_in(&mut self, good: &Good) {
        let texts = self.names.iter().map(|name| good.text(name));
        let texts: Vec<Option<&str>> = texts.collect();
        self.lacks = texts.is_empty() || texts.contains(&None);
        self.text = texts.into_iter().flatten().collect();
        self.own = false;
    }

    /// A declaration that stands nowhere any more, for one that cannot do without it.
    fn revived(name: String, place: Span, good: &Good) -> Self {
        Self {
            place,
            text: good.text(&name).unwrap_or_default().to_owned(),
            names: vec![name],
            own: false,
            lacks: false,
        }
    }
}

impl Good {
    /// The last good text of a declaration.
    fn text(&self, name: &str) -> Option<&str> {
        if let Some(text) = self.since.get(name) {
            return Some(text);
        }
        let whole = self.whole.as_ref()?;
        let home = whole.home(whole.named(name)?)?;
        Some(whole.chunk_text(home))
    }

    /// Remembers what has turned out to be good.
    fn note(&mut self, pieces: &[Piece]) {
        for piece in pieces {
            if let (true, [name]) = (piece.own, piece.names.as_slice())
                && self.text(name) != Some(&piece.text)
            {
                self.since.insert(name.clone(), piece.text.clone());
            }
        }
    }

    /// What declarations have read of the text when it was good.
    fn reads(&self, names: &[String]) -> Vec<String> {
        let Some(whole) = &self.whole else {
            return Vec::new();
        };
        let home = |name: &String| whole.home(whole.named(name)?);
        let events = names.iter().filter_map(home);
        let events = events.flat_map(|home| whole.events(home));
        let read = events.filter_map(|event| match event {
            Event::Operator(Operator::Constant(id) | Operator::Function(id), _) => {
                whole.home(id)?;
                Some(whole.symbol(id)?.name.to_string())
            }
            _ => None,
        });
        read.collect()
    }
}

/// Brings a document to a text by one edit of what differs.
fn bring(document: &mut Option<Document>, text: &str) -> Result<(), EditError> {
    let Some(document) = document else {
        *document = Some(Document::new(text)?);
        return Ok(());
    };
    let old = document.text().text();
    let (range, new) = difference(&old, text);
    if range.start < range.end || !new.is_empty() {
        document.edit(range, new)?;
    }
    Ok(())
}

/// What a text declares.
fn declared(document: &Document) -> Vec<Declared> {
    let text = document.text();
    let mut all = Vec::new();
    let mut start = 0;
    for chunk in text.chunks() {
        let read = text.events(chunk).declarations();
        let named = read.filter(|(read, _)| !read.name.is_empty());
        all.extend(named.map(|(read, _)| Declared {
            span: read.span.moved(start),
            name_span: read.name_span.moved(start),
        }));
        start += text.chunk_text(chunk).len() as u32;
    }
    all
}

/// The places, by their numbers, in which there are errors. They follow each other.
fn faulty(places: &[Span], diagnostics: &[Diagnostic]) -> BTreeSet<usize> {
    let errors = diagnostics.iter();
    let errors = errors.filter(|diagnostic| diagnostic.severity == Severity::Error);
    let place = |error: &Diagnostic| {
        let at = error.span.start;
        let next = places.partition_point(|place| place.start <= at);
        // What is missing at the end of a text is reported there, and empty places share their start with others.
        let begun = places[..next]
            .iter()
            .rposition(|place| place.start < place.end);
        begun.or(next.checked_sub(1))
    };
    errors.filter_map(place).collect()
}

/// The objects that are shown as they last were, and those that read something that is.
fn stale(mended: &Document, scene: &Scene, pieces: &[Piece], places: &[Span]) -> Vec<String> {
    let text = mended.text();
    let mut waiting: Vec<ChunkId> = Vec::new();
    for (piece, place) in pieces.iter().zip(places) {
        if !piece.own && place.start < place.end {
            waiting.extend(text.chunks_in(*place).map(|(chunk, _)| chunk));
        }
    }
    let mut all: HashSet<ChunkId> = waiting.iter().copied().collect();
    while let Some(chunk) = waiting.pop() {
        let declared = text.events(chunk).declarations();
        for symbol in declared.filter_map(|(read, _)| read.symbol) {
            waiting.extend(text.readers(symbol).filter(|reader| all.insert(*reader)));
        }
    }
    let is_stale = |at: u32| {
        let home = text.chunks_in(Span::new(at, at + 1)).next();
        home.is_some_and(|(chunk, _)| all.contains(&chunk))
    };
    let objects = scene.objects.iter();
    let stale = objects.filter(|object| is_stale(object.name_span.start));
    stale.map(|object| object.name.clone()).collect()
}

/// A scene of pieces, with its places in the text as it is.
fn moved(mut scene: Scene, pieces: &[Piece], places: &[Span]) -> Scene {
    let place = |span: &mut Span| {
        // Empty places share their start with the one behind them, which is the last of those.
        let at = places.partition_point(|place| place.start <= span.start);
        let Some(at) = at.checked_sub(1) else {
            return;
        };
        let (piece, start) = (&pieces[at], places[at].start);
        *span = if piece.own {
            let moved = |at: u32| at - start + piece.place.start;
            Span::new(moved(span.start), moved(span.end))
        } else {
            piece.place
        };
    };
    let objects = scene.objects.iter_mut().map(|it| &mut it.name_span);
    let params = scene.params.iter_mut().map(|it| &mut it.name_span);
    let grids = scene.grids.iter_mut().map(|it| &mut it.name_span);
    objects.chain(params).chain(grids).for_each(place);
    scene
}

/// What a chunk declares: the names that were read, or the one that stands behind its first word.
fn names_of(document: &Document, chunk: ChunkId) -> Vec<String> {
    let events = document.text().events(chunk);
    let names = events.declarations().map(|(read, _)| read.name.to_owned());
    let names: Vec<String> = names.collect();
    if names.iter().any(|name| !name.is_empty()) {
        return names;
    }
    let text = document.text().chunk_text(chunk);
    let code = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or(""));
    let code: String = code.collect::<Vec<_>>().join(" ");
    let words = code.split(|c: char| !c.is_ascii_alphanumeric());
    let name = words.filter(|word| !word.is_empty()).nth(1);
    let name = name.filter(|name| name.starts_with(|c: char| c.is_ascii_alphabetic()));
    name.into_iter().map(str::to_owned).collect()
}

/// What of `old` is to be replaced by what, so that it becomes `new`: all but the longest common start and end.
fn difference<'n>(old: &str, new: &'n str) -> (Span, &'n str) {
    let mut start = old
        .bytes()
        .zip(new.bytes())
        .take_while(|(a, b)| a == b)
        .count();
    while !(old.is_char_boundary(start) && new.is_char_boundary(start)) {
        start -= 1;
    }
    let (a, b) = (&old.as_bytes()[start..], &new.as_bytes()[start..]);
    let mut end = a
        .iter()
        .rev()
        .zip(b.iter().rev())
        .take_while(|(a, b)| a == b)
        .count();
    while !(old.is_char_boundary(old.len() - end) && new.is_char_boundary(new.len() - end)) {
        end -= 1;
    }
    let range = Span::new(start as u32, (old.len() - end) as u32);
    (range, &new[start..new.len() - end])
}

#[cfg(test)]
mod tests {
    use super::{Mender, difference};
    use syntax::span::Span;

    #[test]
    fn the_difference_of_two_texts_is_what_lies_between_their_common_ends() {
        for (old, new, range, text) in [
            ("abc", "abxc", (2, 2), "x"),
            ("aaa", "aa", (2, 3), ""),
            ("é", "è", (0, 2), "è"),
            ("", "x", (0, 0), "x"),
            ("same", "same", (4, 4), ""),
        ] {
            assert_eq!(difference(old, new), (Span::new(range.0, range.1), text));
        }
    }

    const GOOD: &str = "point p = (1,2,3);\npoint q = (0,0,0);\nvector v = (1,0,0) @ q;\n";

    #[test]
    fn a_declaration_with_an_error_is_shown_as_it_last_was_while_others_move_on() {
        let mut mender = Mender::default();
        assert!(mender.read(GOOD).stale.is_empty());
        let broken = "point p = (1,2,;\npoint qq = (0,0,0);\nvector v = (1,0,0) @ qq;\n";
        let read = mender.read(broken);
        assert!(!read.diagnostics.is_empty());
        assert_eq!(read.stale, ["p"]);
        let scene = read.scene.expect("mended");
        let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["p", "qq", "v"]);
        assert_eq!(scene.objects[1].name_span.text(broken), "qq");
    }

    #[test]
    fn what_needs_a_declaration_that_was_never_good_is_left_out() {
        let text = "point q = (0,0;\nvector v = (1,0,0) @ q;\npoint r = (1,1,1);";
        let read = Mender::default().read(text);
        let scene = read.scene.expect("mended");
        let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["r"]);
    }

    fn names(read: &super::Read) -> Vec<&str> {
        let scene = read.scene.as_ref().expect("mended");
        scene.objects.iter().map(|it| it.name.as_str()).collect()
    }

    /// The value that a param opens with.
    fn opening(read: &super::Read, name: &str) -> f64 {
        let params = &read.scene.as_ref().expect("mended").params;
        let param = params.iter().find(|param| param.name == name);
        param.expect("there").initial[0]
    }

    #[test]
    fn what_has_become_good_beside_an_error_is_what_stands_in_later() {
        let mut mender = Mender::default();
        mender.read("param y = 1 : [0, 9]; point x = (1, 2, 3);");
        assert_eq!(
            opening(&mender.read("param y = 2 : [0, 9]; point x = (1, 2, "), "y"),
            2.0
        );
        // The same with a declaration that is new, and both are incomplete for a key.
        let read = mender.read("param y = 2 : [0, 9]; param z = 5 : [0, 9]; point x = (1, 2, ");
        assert_eq!(opening(&read, "z"), 5.0);
        let read = mender.read("param y = : [0, 9]; param z = : [0, 9]; point x = (1, 2, ");
        assert_eq!((opening(&read, "y"), opening(&read, "z")), (2.0, 5.0));
        assert_eq!(names(&read), ["x"]);
        assert!(!read.lacks);
    }

    #[test]
    fn a_declaration_that_loses_its_end_takes_none_with_it() {
        let mut mender = Mender::default();
        mender.read(GOOD);
        let read = mender.read(&GOOD.replace("3);", "3)"));
        assert_eq!(names(&read), ["p", "q", "v"]);
        assert_eq!(
            read.stale,
            ["p", "q", "v"],
            "v stands on q, which is read with p"
        );
        assert!(!read.lacks);
        // A new one that is begun above another one hides nothing but itself.
        let read = mender.read(&format!("point n\n{GOOD}"));
        assert_eq!(names(&read), ["p", "q", "v"]);
        assert!(read.lacks);
    }

    #[test]
    fn what_reads_a_name_that_is_gone_is_shown_as_it_was() {
        let good = "param a : [1, 2];\nfunction f(x) = a x;\npoint p = (f(1), 0, 0);\npoint q = (0, 0, 0);\n";
        let mut mender = Mender::default();
        mender.read(good);
        // Renamed where it is declared, and not yet where it is used.
        let renamed = good.replace("param a", "param b");
        let read = mender.read(&renamed);
        assert!(!read.diagnostics.is_empty());
        assert_eq!(names(&read), ["p", "q"]);
        assert_eq!(read.stale, ["p"]);
        assert!(!read.lacks);
        let read = mender.read(&renamed.replace("function f", "function h"));
        assert_eq!(names(&read), ["p", "q"]);
        // Several may need it.
        let two = format!("{good}point r = (a, f(2), 0);\n");
        mender.read(&two);
        let read = mender.read(&two.replace("param a", "param b"));
        assert_eq!(names(&read), ["p", "q", "r"]);
        assert_eq!(read.stale, ["p", "r"]);
        assert!(!read.lacks);
        // What nobody declares and nobody needs any more is gone.
        assert_eq!(
            names(&mender.read("point q = (0, 0, 0);\npoint z = (")),
            ["q"]
        );
    }

    #[test]
    fn a_text_that_is_mended_by_hand_has_no_stale_objects() {
        let mut mender = Mender::default();
        mender.read(GOOD);
        mender.read("point p = ");
        let read = mender.read(GOOD);
        assert!(read.diagnostics.is_empty() && read.stale.is_empty());
        assert_eq!(read.scene.expect("good").objects.len(), 3);
    }
}
