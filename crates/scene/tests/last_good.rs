//! The scene of a program with errors: that of the text in which the last good text of each faulty declaration takes its
//! place.

#[path = "random/programs.rs"]
mod programs;

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use programs::{Check, describe, edit_count, storms};
use scene::geotrace::{Document, builtin_count, compile};
use scene::{Attribute, Object, ProgramScene, Scene, Shape};
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::document::ChunkId;
use syntax::geotrace::actions::Operator;
use syntax::geotrace::document::ParseEvent;
use syntax::geotrace::token::TokenKind;
use syntax::span::Span;
use syntax::symbol::SymbolId;

/// Each declared name is written as one that no other name splits and that splits no other: a text says then how it was
/// read, wherever it is put.
#[derive(Default)]
struct Codes(Vec<String>);

impl Codes {
    fn code(&mut self, name: &str) -> String {
        let known = self.0.iter().position(|known| known == name);
        let number = known.unwrap_or_else(|| {
            self.0.push(name.to_owned());
            self.0.len() - 1
        });
        let letter = |digit: usize| char::from(b'A' + (digit % 26) as u8);
        format!("X{}{}", letter(number / 26), letter(number))
    }
}

/// A declaration that was good.
#[derive(Clone)]
struct Good {
    text: String,
    /// The declared names that it uses, in order.
    uses: Vec<String>,
}

/// What stands in a place of the reference's text.
#[derive(Clone, Debug, Eq, PartialEq)]
enum Choice {
    Own,
    LastGood,
    Nothing,
}

/// The last good text of each declaration, put in the place of what is faulty: the whole text is compiled until it has no
/// errors.
#[derive(Default)]
struct Reference {
    codes: Codes,
    good: HashMap<String, Good>,
    faulty: usize,
}

/// A part of the reference's text.
struct Part {
    /// Its number among the names of the text; none for what is put back.
    home: Option<usize>,
    name: String,
    text: String,
    is_own: bool,
}

fn is_error(found: &Diagnostic) -> bool {
    found.severity == Severity::Error
}

impl Reference {
    /// A chunk as it was read, each symbol by its code, and the declared names that it uses.
    fn written(&mut self, document: &Document, chunk: ChunkId) -> Good {
        let text = document.text();
        let placed = text.placed_chunk(chunk);
        let builtins = builtin_count();
        let names: Vec<(Span, &str)> = placed
            .declarations()
            .map(|(read, _)| (read.name_span, read.name))
            .collect();
        let mut written = String::new();
        for token in placed.tokens().iter() {
            let own = token.span.text(placed.text);
            let symbol = match token.kind {
                TokenKind::Constant(id) | TokenKind::Function(id) if id.0 >= builtins => Some(id),
                _ => None,
            };
            let named = names.iter().find(|(span, _)| *span == token.span);
            let word = match (named, symbol) {
                (Some((_, name)), _) => self.codes.code(name),
                (None, Some(id)) => {
                    let name = text.symbol(id).expect("a symbol").name.to_string();
                    self.codes.code(&name)
                }
                (None, None) => own.to_owned(),
            };
            if token.kind == TokenKind::Comment {
                continue;
            }
            // A number may begin with a point.
            let is_word = |c: char| c.is_ascii_alphanumeric() || c == '.';
            if written.ends_with(is_word) && word.starts_with(is_word) {
                written.push(' ');
            }
            written.push_str(&word);
        }
        let used = placed.events().filter_map(|event| match event {
            ParseEvent::Operator(Operator::Constant(id) | Operator::Function(id), _) => Some(id),
            _ => None,
        });
        let name = |id: SymbolId| Some(text.symbol(id)?.name.to_string());
        let uses = used.filter(|id| id.0 >= builtins).filter_map(name);
        Good {
            uses: uses.collect(),
            text: written,
        }
    }

    /// A declaration's last good text, behind those that it uses and that stand nowhere.
    fn stand_in(
        &self,
        name: &str,
        home: Option<usize>,
        declared: &HashSet<String>,
        put_back: &mut HashSet<String>,
        gone: &HashSet<String>,
        parts: &mut Vec<Part>,
    ) {
        let Some(good) = self.good.get(name) else {
            return;
        };
        for used in &good.uses {
            if !declared.contains(used) && put_back.insert(used.clone()) && !gone.contains(used) {
                self.stand_in(used, None, declared, put_back, gone, parts);
            }
        }
        parts.push(Part {
            home,
            name: name.to_owned(),
            text: good.text.clone(),
            is_own: false,
        });
    }

    /// What is to be shown of a text, and what of it has become good.
    fn show(
        &mut self,
        document: &Document,
        errors: &[Diagnostic],
    ) -> (ProgramScene, Vec<(String, Good)>) {
        let text = document.text();
        let faulty: HashSet<ChunkId> = errors
            .iter()
            .filter(|found| is_error(found))
            .filter_map(|found| Some(text.placed_chunk_at(found.span.start)?.chunk))
            .collect();
        let mut homes: Vec<(String, Choice, Option<Good>)> = Vec::new();
        let mut incomplete = false;
        for chunk in text.chunks() {
            let names = names(document, chunk, faulty.contains(&chunk));
            incomplete |= names.is_empty() && faulty.contains(&chunk);
            for name in names {
                let is_own = !faulty.contains(&chunk);
                let choice = if is_own {
                    Choice::Own
                } else {
                    Choice::LastGood
                };
                let own = is_own.then(|| self.written(document, chunk));
                homes.push((name, choice, own));
            }
        }
        let declared: HashSet<String> = homes.iter().map(|(name, ..)| name.clone()).collect();
        let mut gone = HashSet::new();
        loop {
            let (mut parts, mut put_back) = (Vec::new(), HashSet::new());
            for (number, (name, choice, own)) in homes.iter_mut().enumerate() {
                match (&choice, own) {
                    (Choice::Own, Some(own)) => parts.push(Part {
                        home: Some(number),
                        name: name.clone(),
                        text: own.text.clone(),
                        is_own: true,
                    }),
                    (Choice::LastGood, _) if self.good.contains_key(name) => {
                        let (all, back) = (&mut parts, &mut put_back);
                        self.stand_in(name, Some(number), &declared, back, &gone, all);
                    }
                    _ => *choice = Choice::Nothing,
                }
            }
            let whole: String = parts
                .iter()
                .map(|part| format!("{}\n", part.text))
                .collect();
            let compilation = compile(&whole);
            let mut errors = compilation.diagnostics.iter().filter(|it| is_error(it));
            // Diagnostics are sorted by place. What is below may only fail because of the first.
            let first = errors.next().map(|found| {
                let above = &whole[..found.span.start as usize];
                above.matches('\n').count()
            });
            if let Some(scene) = compilation.scene {
                incomplete |= homes
                    .iter()
                    .any(|(_, choice, _)| *choice == Choice::Nothing);
                let stale = self.stale(&scene, &parts);
                let became_good = homes.into_iter().filter_map(|(name, choice, own)| {
                    let own = own.filter(|_| choice == Choice::Own)?;
                    Some((name, own))
                });
                let shown = ProgramScene {
                    scene: Some(scene.into()),
                    stale,
                    incomplete,
                };
                return (shown, became_good.collect());
            }
            if let Some(part) = first.and_then(|line| parts.get(line)) {
                match part.home {
                    Some(home) if part.is_own => homes[home].1 = Choice::LastGood,
                    Some(home) => homes[home].1 = Choice::Nothing,
                    None => {
                        gone.insert(part.name.clone());
                    }
                }
            }
        }
    }

    /// The objects of parts that stand in for others, and of those that use them.
    fn stale(&self, scene: &Scene, parts: &[Part]) -> Vec<String> {
        let mut stale: HashSet<String> = HashSet::new();
        let mut codes: Vec<String> = Vec::new();
        for part in parts {
            let mut words = part.text.split(|c: char| !c.is_ascii_alphanumeric());
            let code = words.clone().find(|word| word.starts_with('X'));
            let code = code.expect("a name").to_owned();
            if !part.is_own || words.any(|word| stale.contains(word)) {
                stale.insert(code.clone());
            }
            codes.push(code);
        }
        let shown = scene.objects.iter().chain(&scene.stage);
        let names = shown.map(|object| object.name.clone());
        names.filter(|name| stale.contains(name)).collect()
    }
}

/// The names that a chunk declares, or seems to.
fn names(document: &Document, chunk: ChunkId, is_faulty: bool) -> Vec<String> {
    let text = document.text();
    let read = text.events(chunk).declarations();
    let names: Vec<String> = read.map(|(read, _)| read.name.to_owned()).collect();
    if !is_faulty || names.iter().any(|name| !name.is_empty()) {
        return names;
    }
    let lines = text.chunk_text(chunk).lines();
    let code: Vec<&str> = lines.map(|it| it.split('#').next().unwrap_or("")).collect();
    let code = code.join(" ");
    let mut words = code.split(|c: char| !c.is_ascii_alphanumeric());
    let second = words.by_ref().filter(|word| !word.is_empty()).nth(1);
    let second = second.filter(|word| word.starts_with(|c: char| c.is_ascii_alphabetic()));
    second.into_iter().map(str::to_owned).collect()
}

impl Check for Reference {
    fn check(&mut self, document: &Document, text: &str) {
        let whole = compile(text);
        assert_eq!(document.diagnostics(), whole.diagnostics);
        let shown = document.scene_with_last_good();
        let scene = shown.scene.as_ref().expect("something can be shown");
        for object in scene.objects.iter().chain(&scene.stage) {
            let place = object.name_span.text(text);
            assert!(place == object.name || shown.stale.contains(&object.name));
        }
        if let Some(whole) = &whole.scene {
            assert_eq!(describe(scene), describe(whole));
            assert!(shown.stale.is_empty() && !shown.incomplete);
            self.good.clear();
            let chunks: Vec<ChunkId> = document.text().chunks().collect();
            for chunk in chunks {
                for name in names(document, chunk, false) {
                    let good = self.written(document, chunk);
                    self.good.insert(name, good);
                }
            }
            return;
        }
        self.faulty += 1;
        let (wanted, good) = self.show(document, &whole.diagnostics);
        self.good.extend(good);
        let mut scene = Scene::clone(scene);
        for object in objects_mut(&mut scene) {
            object.name = self.codes.code(&object.name);
            if let Shape::Solid(solid) = &mut object.shape {
                for leaf in &mut Arc::make_mut(solid).leaves {
                    leaf.name = self.codes.code(&leaf.name);
                }
            }
        }
        for param in &mut scene.params {
            param.name = self.codes.code(&param.name);
        }
        for grid in &mut scene.grids {
            grid.name = self.codes.code(&grid.name);
        }
        let mut wanted_scene = Scene::clone(wanted.scene.as_deref().expect("a scene"));
        forget_places(&mut scene);
        forget_places(&mut wanted_scene);
        assert_eq!(describe(&scene), describe(&wanted_scene));
        let codes = &mut self.codes;
        let stale: HashSet<String> = shown.stale.iter().map(|name| codes.code(name)).collect();
        assert_eq!(stale.len(), shown.stale.len());
        assert_eq!(stale, wanted.stale.into_iter().collect());
        assert_eq!(shown.incomplete, wanted.incomplete);
    }
}

fn objects_mut(scene: &mut Scene) -> impl Iterator<Item = &mut Object> {
    let staged = scene.parts.iter_mut().chain(&mut scene.stage);
    scene.objects.iter_mut().chain(staged)
}

fn forget_places(scene: &mut Scene) {
    for object in objects_mut(scene) {
        let mut attributes: Vec<&mut Attribute> = object.attributes.iter_mut().collect();
        if let Shape::Solid(solid) = &mut object.shape {
            for leaf in &mut Arc::make_mut(solid).leaves {
                leaf.name_span = Span::default();
                attributes.extend(Arc::make_mut(&mut leaf.attributes));
            }
        }
        attributes
            .into_iter()
            .for_each(|it| it.span = Span::default());
        object.name_span = Span::default();
    }
    let params = scene.params.iter_mut().map(|it| &mut it.name_span);
    let grids = scene.grids.iter_mut().map(|it| &mut it.name_span);
    let all = params.chain(grids);
    all.for_each(|span| *span = Span::default());
}

#[test]
fn the_scene_of_a_text_with_errors_is_that_of_the_last_good_text_of_each_faulty_declaration() {
    let edits = edit_count() / 4;
    let sound = storms::<Reference>(edits);
    assert!(
        4 * sound < 3 * edits + 400,
        "{sound} of {edits} have no error"
    );
}
