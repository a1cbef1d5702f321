//! The structure of the code, measured: lines, modules that import each other, files that name a variant.
//!
//! ```text
//! crates/*/src/**/*.rs ──proc-macro2──▶ tokens without comments and tests ─┬─▶ lines of code
//!                                                                          ├─▶ imports between top-level modules
//!                                                                          └─▶ names: of types, variants, words
//! ```
//!
//! `cargo run -p geotrace-tests --bin structure` prints the figures, and `tests/structure.rs` holds them. Rust's own
//! tokens are counted, so that neither a comment nor a string looks like code.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syntax::geotrace::declarations::DeclarationKeyword;

use crate::examples::repository;

/// A source file of a crate, read.
#[derive(Debug)]
pub struct File {
    /// The crate's folder name.
    pub krate: String,
    /// Its path below the repository.
    pub path: PathBuf,
    /// Its modules, from the crate's root: empty for `lib.rs` and `main.rs`.
    pub modules: Vec<String>,
    /// The numbers of its lines that hold code outside tests, from 1.
    pub code: BTreeSet<usize>,
    /// Its tokens in their order, without comments, attributes and test modules.
    pub tokens: Vec<Lexeme>,
    /// The whole text.
    pub text: String,
}

/// A token of a file.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Lexeme {
    /// An identifier or a keyword.
    Word(String),
    /// A literal as it is written.
    Literal(String),
    /// A mark; opening and closing delimiters among them.
    Mark(char),
}

impl Lexeme {
    fn word(&self) -> Option<&str> {
        match self {
            Self::Word(word) => Some(word),
            _ => None,
        }
    }

    fn is(&self, mark: char) -> bool {
        *self == Self::Mark(mark)
    }
}

/// Every source file of every crate, by path.
///
/// # Panics
/// If a file cannot be read, or is no Rust.
pub fn files() -> &'static [File] {
    // Every measure reads all of them.
    static FILES: LazyLock<Vec<File>> = LazyLock::new(|| {
        let mut paths = Vec::new();
        collect(&repository().join("crates"), "rs", &mut paths);
        paths.sort();
        assert!(paths.len() > 100, "only {} source files", paths.len());
        paths.iter().filter_map(|path| read(path)).collect()
    });
    &FILES
}

fn collect(folder: &Path, extension: &str, paths: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            collect(&path, extension, paths);
        } else if path.extension().is_some_and(|ending| ending == extension) {
            paths.push(path);
        }
    }
}

/// Reads a file below `crates/NAME/src`; files of a crate's own tests are left out.
fn read(path: &Path) -> Option<File> {
    let relative = path.strip_prefix(repository()).ok()?.to_owned();
    let mut parts: Vec<String> = relative
        .components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    if parts.get(2).map(String::as_str) != Some("src") {
        return None;
    }
    let mut modules = parts.split_off(3);
    let name = modules.pop()?;
    match name.strip_suffix(".rs")? {
        "tests" => return None,
        "lib" | "main" if modules.is_empty() => {}
        "mod" => {}
        name => modules.push(name.to_owned()),
    }
    let text = std::fs::read_to_string(path).expect("readable code");
    let stream: TokenStream = text
        .parse()
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut file = File {
        krate: parts[1].clone(),
        path: relative,
        modules,
        code: BTreeSet::new(),
        tokens: Vec::new(),
        text,
    };
    file.take(stream);
    Some(file)
}

impl File {
    /// Takes the tokens, but for documentation and items under `#[cfg(test)]`.
    fn take(&mut self, stream: TokenStream) {
        let tokens: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            if let Some((attribute, behind)) = attribute(&tokens, at) {
                if attribute.starts_with("cfg (test)") || attribute.starts_with("cfg(test)") {
                    at = end_of_item(&tokens, behind);
                } else {
                    if !attribute.starts_with("doc =") && !attribute.starts_with("doc=") {
                        for token in &tokens[at..behind] {
                            self.count(token);
                        }
                    }
                    at = behind;
                }
                continue;
            }
            self.push(&tokens[at]);
            at += 1;
        }
    }

    fn push(&mut self, token: &TokenTree) {
        match token {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Brace => ('{', '}'),
                    Delimiter::Bracket => ('[', ']'),
                    Delimiter::Parenthesis => ('(', ')'),
                    Delimiter::None => (' ', ' '),
                };
                self.code.insert(group.span_open().start().line);
                self.tokens.push(Lexeme::Mark(open));
                self.take(group.stream());
                self.code.insert(group.span_close().start().line);
                self.tokens.push(Lexeme::Mark(close));
            }
            TokenTree::Ident(ident) => self.tokens.push(Lexeme::Word(ident.to_string())),
            TokenTree::Punct(mark) => self.tokens.push(Lexeme::Mark(mark.as_char())),
            TokenTree::Literal(it) => self.tokens.push(Lexeme::Literal(it.to_string())),
        }
        self.count(token);
    }

    fn count(&mut self, token: &TokenTree) {
        let span = token.span();
        if matches!(token, TokenTree::Group(_)) {
            self.code.insert(span.start().line);
            self.code.insert(span.end().line);
        } else {
            self.code.extend(span.start().line..=span.end().line);
        }
    }

    /// True if a word occurs in its code.
    pub fn names(&self, word: &str) -> bool {
        self.tokens.iter().any(|it| it.word() == Some(word))
    }

    /// Top-level modules of the own crate that the file imports, its own among them.
    pub fn imports(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let tokens = &self.tokens;
        for at in 0..tokens.len() {
            match tokens[at].word() {
                // `pub(crate)` is no path.
                Some("crate") if is_path(tokens, at + 1) => {
                    found.extend(heads(tokens, at + 3).into_iter().map(str::to_owned));
                }
                Some("super") if at == 0 || !tokens[at - 1].is(':') => {
                    let mut levels = 1;
                    let mut behind = at + 1;
                    while is_path(tokens, behind)
                        && tokens.get(behind + 2).and_then(Lexeme::word) == Some("super")
                    {
                        levels += 1;
                        behind += 3;
                    }
                    if levels == self.modules.len() && is_path(tokens, behind) {
                        found.extend(heads(tokens, behind + 2).into_iter().map(str::to_owned));
                    }
                }
                _ => {}
            }
        }
        found
    }
}

/// An attribute that begins at a place: its text, and the place behind it.
fn attribute(tokens: &[TokenTree], at: usize) -> Option<(String, usize)> {
    let TokenTree::Punct(mark) = &tokens[at] else {
        return None;
    };
    if mark.as_char() != '#' {
        return None;
    }
    let mut behind = at + 1;
    if let Some(TokenTree::Punct(mark)) = tokens.get(behind)
        && mark.as_char() == '!'
    {
        behind += 1;
    }
    match tokens.get(behind) {
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Bracket => {
            Some((group.stream().to_string(), behind + 1))
        }
        _ => None,
    }
}

/// The place behind the item that begins at a place: behind its `;`, or its braces.
fn end_of_item(tokens: &[TokenTree], from: usize) -> usize {
    for (at, token) in tokens.iter().enumerate().skip(from) {
        match token {
            TokenTree::Punct(mark) if matches!(mark.as_char(), ';' | ',') => return at + 1,
            TokenTree::Group(group) if group.delimiter() == Delimiter::Brace => return at + 1,
            _ => {}
        }
    }
    tokens.len()
}

fn is_path(tokens: &[Lexeme], at: usize) -> bool {
    tokens.get(at).is_some_and(|it| it.is(':')) && tokens.get(at + 1).is_some_and(|it| it.is(':'))
}

/// The first names of the paths or variants that begin at a place: one, or those of a group in braces.
fn heads(tokens: &[Lexeme], at: usize) -> Vec<&str> {
    match tokens.get(at) {
        Some(Lexeme::Word(word)) => vec![word],
        Some(Lexeme::Mark('{')) => {
            let mut found = Vec::new();
            let mut depth = 0;
            let mut begins = true;
            for token in &tokens[at + 1..] {
                match token {
                    Lexeme::Mark('{') => depth += 1,
                    Lexeme::Mark('}') if depth == 0 => break,
                    Lexeme::Mark('}') => depth -= 1,
                    Lexeme::Mark(',') if depth == 0 => begins = true,
                    Lexeme::Word(word) if begins => {
                        found.push(word.as_str());
                        begins = false;
                    }
                    _ => {}
                }
            }
            found
        }
        _ => Vec::new(),
    }
}

/// Lines of code by crate: neither empty nor only a comment, and no tests.
pub fn lines(files: &[File]) -> BTreeMap<&str, usize> {
    let mut lines = BTreeMap::new();
    for file in files {
        *lines.entry(file.krate.as_str()).or_default() += file.code.len();
    }
    lines
}

/// The groups of top-level modules that import each other in a cycle, by crate; a crate's root is left out.
pub fn cycles(files: &[File]) -> BTreeMap<&str, Vec<BTreeSet<String>>> {
    let mut arrows: BTreeMap<&str, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for file in files {
        let Some(module) = file.modules.first() else {
            continue;
        };
        let own = arrows.entry(&file.krate).or_default();
        own.entry(module.clone())
            .or_default()
            .extend(file.imports());
    }
    let mut found = BTreeMap::new();
    for (krate, arrows) in arrows {
        let modules: BTreeSet<String> = arrows.keys().cloned().collect();
        let reached: BTreeMap<&String, BTreeSet<String>> = arrows
            .keys()
            .map(|module| (module, reached(&arrows, module)))
            .collect();
        let mut seen: BTreeSet<String> = BTreeSet::new();
        let mut groups = Vec::new();
        for module in &modules {
            if seen.contains(module) {
                continue;
            }
            let mut group: BTreeSet<String> = reached[module]
                .iter()
                .filter(|it| *it != module && reached.get(it).is_some_and(|r| r.contains(module)))
                .cloned()
                .collect();
            if !group.is_empty() {
                group.insert(module.clone());
                seen.extend(group.iter().cloned());
                groups.push(group);
            }
        }
        if !groups.is_empty() {
            found.insert(krate, groups);
        }
    }
    found
}

/// The modules that a module imports, directly or through others; itself only through others.
fn reached(arrows: &BTreeMap<String, BTreeSet<String>>, module: &String) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![module];
    while let Some(next) = open.pop() {
        for it in arrows.get(next).into_iter().flatten() {
            if it != next && arrows.contains_key(it) && found.insert(it.clone()) {
                open.push(it);
            }
        }
    }
    found
}

/// The files that name a variant of an enum, or any of its items, in code.
pub fn naming<'f>(files: &'f [File], name: &str, variant: Option<&str>) -> Vec<&'f Path> {
    let names = |file: &File| {
        let tokens = &file.tokens;
        (0..tokens.len()).any(|at| {
            tokens[at].word() == Some(name)
                && is_path(tokens, at + 1)
                && tokens
                    .get(at + 3)
                    .and_then(Lexeme::word)
                    .is_some_and(|word| variant.is_none_or(|variant| word == variant))
        })
    };
    let found = files.iter().filter(|file| names(file));
    found.map(|file| file.path.as_path()).collect()
}

/// The files with a name that is a word, in code.
pub fn using<'f>(files: &'f [File], word: &str) -> Vec<&'f Path> {
    let found = files.iter().filter(|file| file.names(word));
    found.map(|file| file.path.as_path()).collect()
}

/// The files with a string that is a word, in code.
pub fn quoting<'f>(files: &'f [File], word: &str) -> Vec<&'f Path> {
    let quoted = Lexeme::Literal(format!("\"{word}\""));
    let quotes = |file: &File| file.tokens.contains(&quoted);
    let found = files.iter().filter(|file| quotes(file));
    found.map(|file| file.path.as_path()).collect()
}

/// Types by name, each with the places where one of that name is declared.
pub fn types(files: &[File]) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files {
        for pair in file.tokens.windows(2) {
            if let [Lexeme::Word(keyword), Lexeme::Word(name)] = pair
                && matches!(
                    keyword.as_str(),
                    "struct" | "enum" | "trait" | "union" | "type"
                )
                && name.starts_with(|c: char| c.is_ascii_uppercase())
            {
                // An associated type is named by its trait.
                if keyword == "type" {
                    continue;
                }
                let place = file.path.display().to_string();
                found.entry(name.clone()).or_default().push(place);
            }
        }
    }
    found
}

/// The words of identifiers in code: `RenderThread` and `render_thread` hold `render` and `thread`.
pub fn words(file: &File) -> BTreeSet<String> {
    let names = file.tokens.iter().filter_map(Lexeme::word);
    words_of(names.chain(file.modules.iter().map(String::as_str)))
}

/// The scripts of the page and of the editors, by path below the repository, with the words of their identifiers.
///
/// # Panics
/// If a file cannot be read.
pub fn scripts() -> Vec<(PathBuf, BTreeSet<String>)> {
    let mut paths = Vec::new();
    for (folder, extension) in [
        ("web/src", "ts"),
        ("editors/vscode/src", "ts"),
        ("editors/neovim", "lua"),
    ] {
        collect(&repository().join(folder), extension, &mut paths);
    }
    paths.sort();
    let script = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).expect("a readable script");
        let code: String = text.lines().map(code_of).collect();
        let names = code.split(|c: char| !c.is_alphanumeric() && c != '_');
        let path = path
            .strip_prefix(repository())
            .expect("below the repository");
        (path.to_owned(), words_of(names))
    };
    paths.into_iter().map(script).collect()
}

/// A line of a script without its comment and its strings.
fn code_of(line: &str) -> String {
    let line = line.trim_start();
    let is_comment = ["//", "/*", "*", "--"]
        .iter()
        .any(|mark| line.starts_with(mark));
    let mut code = String::new();
    let mut quote = None;
    for c in line.chars().filter(|_| !is_comment) {
        match quote {
            Some(mark) if c == mark => quote = None,
            Some(_) => {}
            None if matches!(c, '"' | '\'' | '`') => quote = Some(c),
            None => code.push(c),
        }
    }
    let end = code
        .find("//")
        .or_else(|| code.find("-- "))
        .unwrap_or(code.len());
    code.truncate(end);
    code.push('\n');
    code
}

/// The words of identifiers.
fn words_of<'n>(names: impl Iterator<Item = &'n str>) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for name in names {
        let mut word = String::new();
        for c in name.chars().chain(['_']) {
            if (c == '_' || c.is_ascii_uppercase()) && !word.is_empty() {
                found.insert(std::mem::take(&mut word));
            }
            if c != '_' {
                word.push(c.to_ascii_lowercase());
            }
        }
    }
    found
}

/// How many files may name something.
#[derive(Debug)]
pub struct Limit<'f> {
    /// What they name.
    pub what: &'static str,
    /// The files that do.
    pub files: Vec<&'f Path>,
    /// How many may: as few as there are, so that a new one is noticed.
    pub most: usize,
}

/// The types of the views, and of the options of their pictures.
const VIEW_TYPES: &[&str] = &[
    "SpaceOptions",
    "GeodesicOptions",
    "TracedOptions",
    "SpaceView",
    "GeodesicView",
    "TracedView",
];

/// The names of views that no keyword of a declaration has.
const VIEW_NAMES: &[&str] = &["3d", "traced"];

/// The things that few files may name, so that one more of their kind touches few files.
///
/// # Panics
/// If nothing has one of the names, so that a list that is out of date is noticed.
pub fn limits(files: &[File]) -> Vec<Limit<'_>> {
    let views = merged([
        each(&["Space", "Inside"], |it| {
            naming(files, "SavedPane", Some(it))
        }),
        each(VIEW_TYPES, |it| using(files, it)),
        each(VIEW_NAMES, |it| quoting(files, it)),
    ]);
    let views = views
        .into_iter()
        .filter(|path| !path.starts_with("crates/render/src/view"))
        .collect();
    let shapes = variants(files, "crates/scene/src/scene/shape.rs", "Shape");
    let shapes = merged([each(&shapes, |it| naming(files, "Shape", Some(it)))]);
    let keywords = DeclarationKeyword::ALL.map(|keyword| keyword.row().text);
    let words = merged([
        each(&["DeclarationKeyword", "Operator"], |it| {
            naming(files, it, None)
        }),
        each(&keywords, |it| quoting(files, it)),
    ]);
    let outside = words
        .into_iter()
        .filter(|path| !is_language(path))
        .collect();
    vec![
        Limit {
            what: "files that name a view outside the views' own modules",
            files: views,
            most: 9,
        },
        Limit {
            what: "files that name a variant of a shape",
            files: shapes,
            most: 24,
        },
        Limit {
            what: "files that name a declaration's keyword or an operator outside the language's own modules",
            files: outside,
            most: 11,
        },
    ]
}

/// The files that have one of some words.
fn each<'f>(words: &[&str], find: impl Fn(&str) -> Vec<&'f Path>) -> Vec<&'f Path> {
    let found = words.iter().flat_map(|word| {
        let found = find(word);
        assert!(!found.is_empty(), "nothing has the name `{word}`");
        found
    });
    found.collect()
}

/// The variants of an enum that a file declares.
fn variants<'f>(files: &'f [File], path: &str, name: &str) -> Vec<&'f str> {
    let file = files.iter().find(|file| file.path == Path::new(path));
    let tokens = &file.expect("a source file").tokens;
    let word = |it: &str| Lexeme::Word(it.to_owned());
    let begin = tokens
        .windows(2)
        .position(|pair| *pair == [word("enum"), word(name)])
        .expect("an enum");
    heads(tokens, begin + 2)
}

/// Whether a file belongs to a language.
fn is_language(path: &Path) -> bool {
    let names = ["geotrace", "geotrace.rs", "crt", "crt.rs"];
    let in_language = path
        .iter()
        .any(|part| names.iter().any(|name| part == *name));
    in_language || path.starts_with("crates/expr")
}

fn merged<const N: usize>(lists: [Vec<&Path>; N]) -> Vec<&Path> {
    let all: BTreeSet<&Path> = lists.into_iter().flatten().collect();
    all.into_iter().collect()
}
