//! Programs that are edited at random, as people edit them: most edits make sense, some are slips of the fingers that are
//! taken back, and names are few, so that what is removed comes back.

use std::fmt::Write as _;

use scene::geotrace::Document;
use scene::{AttributeValue, Object, Scene};
use syntax::diagnostic::Severity;
use syntax::span::Span;

/// Every object of a scene, drawn or not.
pub(crate) fn all_objects(scene: &Scene) -> impl Iterator<Item = &Object> {
    let staged = scene.parts.iter().chain(&scene.stage);
    scene.objects.iter().chain(staged)
}

/// What can be told of a scene, in full.
pub(crate) fn describe(scene: &Scene) -> String {
    let mut text = format!(
        "{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{:?}\n{}\n",
        scene.params,
        scene.grids,
        scene.objects,
        scene.parts,
        scene.stage,
        scene.geodesic_values,
        scene.uniform_count
    );
    // A geodesic's name is that of its object.
    let followed = all_objects(scene).flat_map(|it| it.shape.followed());
    for value in scene.geodesic_values.iter().chain(followed) {
        text = text.replace(&format!("geodesic: {:?}", value.geodesic), "geodesic");
    }
    let mut roots = Vec::new();
    for object in all_objects(scene) {
        roots.extend(object.shape.roots());
        let followed = object.shape.followed().iter();
        roots.extend(followed.flat_map(|value| value.nodes()));
        for attribute in &object.attributes {
            if let AttributeValue::Numbers(nodes) = &attribute.value {
                roots.extend(nodes);
            }
        }
    }
    let values = scene.geodesic_values.iter();
    roots.extend(values.flat_map(|value| value.nodes()));
    for id in scene.graph.order(&roots) {
        let _ = write!(text, "{id:?} {:?}; ", scene.graph.node(id));
    }
    text
}

/// A generator of numbers that is the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % bound.max(1) as u64) as usize
    }

    fn pick<'t>(&mut self, of: &[&'t str]) -> &'t str {
        of[self.below(of.len())]
    }
}

/// What a name stands for, as far as the generator minds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Kind {
    Number,
    Space,
    One,
    Two,
    Curve,
    Patch,
    Geodesic,
    Solid,
    Map,
    Stage,
}

/// The names of each kind: few, so that what is removed comes back, and some split others.
const NAMES: &[(Kind, &[&str])] = &[
    (Kind::Number, &["a", "b", "ab", "k", "p", "r2", "r"]),
    (Kind::Space, &["q", "w", "qa", "z"]),
    (Kind::One, &["f", "h", "fa"]),
    (Kind::Two, &["g", "l"]),
    (Kind::Curve, &["c", "ca"]),
    (Kind::Patch, &["s", "m", "sa"]),
    (Kind::Geodesic, &["y", "ya"]),
    (Kind::Solid, &["o", "oa", "n", "so"]),
    (Kind::Solid, &["o", "n"]),
    (Kind::Map, &["d", "scale"]),
    (Kind::Stage, &["i", "light", "j", "ja"]),
];

/// A declaration of a program that is edited.
#[derive(Clone, Debug)]
struct Line {
    kind: Kind,
    name: &'static str,
    text: String,
}

/// Writes declarations that mean something, most of the time.
struct Writer<'r, 'l> {
    random: &'r mut Random,
    above: &'l [Line],
}

impl Writer<'_, '_> {
    /// A name of this kind that is declared above, or else `otherwise`; now and then another name.
    fn name(&mut self, kind: Kind, otherwise: &str) -> String {
        let anything = self.random.below(60) == 0;
        let fits = |line: &&Line| anything || line.kind == kind;
        let names: Vec<&str> = self
            .above
            .iter()
            .filter(fits)
            .map(|line| line.name)
            .collect();
        match names.is_empty() {
            true => otherwise.to_owned(),
            false => self.random.pick(&names).to_owned(),
        }
    }

    fn number(&mut self) -> String {
        let digits = self.random.pick(&["1", "2", "3", "0.5", "7"]).to_owned();
        // Geodesics take time to follow.
        if self.random.below(30) == 0 {
            return format!("({}({digits}))_1", self.name(Kind::Geodesic, "(1, 2)"));
        }
        match self.random.below(9) {
            8 if self.random.below(3) == 0 => {
                let solid = self.name(Kind::Solid, "id");
                format!("{solid}(1, {digits}, 2)").replace("id(1, ", "sqrt*(1, ")
            }
            0 | 1 => digits,
            2..=4 => self.name(Kind::Number, &digits),
            5 => format!("{} {digits}", self.name(Kind::One, "sin")),
            6 => format!("{}(1, {digits})", self.name(Kind::Two, "id")).replace("id(1, ", "id("),
            _ => format!("({})_2", self.name(Kind::Space, "(1, 2, 3)")),
        }
    }

    /// A set of points, or a function that may be one.
    fn atom(&mut self) -> String {
        let kind = match self.random.below(4) {
            0 => Kind::Two,
            _ => Kind::Solid,
        };
        match self.name(kind, "g").as_str() {
            "g" => self.name(Kind::Solid, "g"),
            name => name.to_owned(),
        }
    }

    /// The attributes of what is drawn, if it states any.
    fn attributes(&mut self) -> String {
        let x = self.number();
        match self.random.below(5) {
            0 => format!(", color : (0.5, {x}, 0.1)"),
            1 => format!(", mirror : 0.1 + 0 {x}"),
            _ => String::new(),
        }
    }

    fn line(&mut self, kind: Kind, name: &'static str) -> Line {
        let (x, y) = (self.number(), self.number());
        let digit = 2 + self.random.below(6);
        let least = self.random.pick(&["-1", "0", "1"]);
        // A set needs something to name.
        let has_solid = self.above.iter().any(|line| line.kind == Kind::Solid);
        let form = match self.random.below(7) {
            form if kind == Kind::Solid && form > 2 && !has_solid => form % 3,
            form => form,
        };
        let text = match (kind, form) {
            (Kind::Number, 0) => match self.random.below(3) {
                0 => format!("param {name} = {x} : [{least}, {digit}];"),
                _ => format!("param {name} : [{least}, {digit}];"),
            },
            (Kind::Number, 1) => format!("grid {name} : [{least}, 2, {digit}];"),
            (Kind::Number, 2) => format!("grid {name} : [{least}, 90, 1{digit}00];"),
            // It reads what its value does not hang on.
            (Kind::Number, 3) => format!("define {name} = 0 {x} + {digit};"),
            (Kind::Number, _) => format!("define {name} = {x} + {y};"),
            (Kind::Space, 0) => format!("param {name} : [0, 1], [0, {digit}], [1, 2];"),
            (Kind::Space, 1) => format!("define {name} = ({x}, 0, {y});"),
            (Kind::Space, 2) => {
                format!(
                    "vector {name} = ({x}, 1, {y}) @ {};",
                    self.name(Kind::Space, "(0, 0, 0)")
                )
            }
            (Kind::Space, 3) => format!(
                "define {name} = {}_u({x}, 1);",
                self.name(Kind::Patch, "id")
            )
            .replace("id_u(", "(1, 2, "),
            (Kind::Space, 4) => {
                format!(
                    "define {name} = {}' {digit};",
                    self.name(Kind::Curve, "(0, 1, 2) sin")
                )
            }
            (Kind::Space, _) => format!("point {name} = ({x}, {y}, {digit}){};", self.attributes()),
            (Kind::Solid, 0) => format!(
                "solid {name}(x, y, z) = {x} x + y z - {y}{};",
                self.attributes()
            ),
            (Kind::Solid, 1) => {
                format!("solid {name}(x, y, z) = x^2 + y^2 - {x}, z : [0, {digit}], bump : {y} x;")
            }
            (Kind::Solid, 2) => format!("solid {name}(x, y) = x y - {x}, color : 0 {y} + y;"),
            (Kind::Solid, 3) => format!(
                "solid {name} = {} | {} @ ({x}, 0, {y}){};",
                self.atom(),
                self.atom(),
                self.attributes()
            ),
            (Kind::Solid, 4) => format!(
                "solid {name} = {} \\ {} @ scale {digit}, bump : x + {x};",
                self.atom(),
                self.atom()
            ),
            (Kind::Solid, 5) => format!(
                "solid {name} = ({} & {}) @ rotate (0, {x}, {y}), x : [-1, {digit}];",
                self.atom(),
                self.atom()
            ),
            (Kind::Solid, _) => format!(
                "solid {name} = {} @ {};",
                self.atom(),
                self.name(Kind::Map, "rotate (1, 0, 0)")
            ),
            (Kind::Map, _) => {
                format!("function {name}(x, y, z) = (x + {x} z, y, {digit} z + {y});")
            }
            (Kind::Stage, 0) => format!(
                "light {name} = @ {}, power : {digit};",
                self.name(Kind::Space, "(0, 1, 2)")
            ),
            (Kind::Stage, 1) => format!("light {name} = (1, {x}, {y}), ambient : 0.1;"),
            (Kind::Stage, 2) => format!("light {name} = (1, {x}, 2) @ (0, 0, {y});"),
            (Kind::Stage, 3 | 4) => {
                format!("camera {name} = (1, {x}, 2) @ ({y}, 0, 0), fov : 1, bokeh : star;")
            }
            (Kind::Stage, 5) if self.random.below(3) == 0 => {
                format!("background {name}(x, y, z) = (x, y {x}, z);")
            }
            (Kind::Stage, 6) if self.random.below(3) == 0 => format!("background {name} = {x};"),
            (Kind::Stage, _) => format!("light {name} = (1, {x}, {y}), color : (1, 0 {x}, 2);"),
            (Kind::One, 0) => format!(
                "function {name}(x) = {}' x + {y};",
                self.name(Kind::One, "cos")
            ),
            (Kind::One, 6) => format!(
                "function {name}(x) = ({}'(x {y}))_2;",
                self.name(Kind::Geodesic, "id")
            )
            .replace("id'(x", "(1, x)(1"),
            (Kind::One, 1) => format!("function {name}(x) = x {x};"),
            (Kind::One, _) => format!("function {name}(x) = {x} x^2 - {y};"),
            (Kind::Two, _) => format!("function {name}(x, t) = {x} t - x {y};"),
            (Kind::Curve, 0 | 1) => {
                format!("curve {name}(t) = (t, {x} t, {y}), t : [0, 1 + {x} {y}];")
            }
            (Kind::Curve, 2) => format!(
                "curve {name}(t) = ({}({x} t))_1 (1, 2, t), t : [0, {digit}, 9];",
                self.name(Kind::Geodesic, "(1, 2)")
            ),
            (Kind::Curve, _) => format!("curve {name}(t) = (t, {x}, {y}), t : [0, {digit}, 9];"),
            (Kind::Patch, 0 | 1) => {
                format!("metric {name}(u, v) = (1 + {x}^2, 0, {y}), u : [0, 1], v : [0, {digit}];")
            }
            (Kind::Patch, _) => format!(
                "surface {name}(u, v) = (u, v {x}, {y}), u : [0, {digit}, 40], v : [0, 1, 50];"
            ),
            (Kind::Geodesic, 0) => format!(
                "geodesic {name}(t) : {} = ((0.5, {y}), (0.25, {x})), t : [0, 1];",
                self.name(Kind::Patch, "s")
            ),
            (Kind::Geodesic, 1) => format!(
                "geodesic {name}(t) : {} = (1, {x}) @ {}(0.5), t : [0, 1];",
                self.name(Kind::Patch, "s"),
                self.name(Kind::Geodesic, "(1, 1)")
            ),
            (Kind::Geodesic, _) => format!(
                "geodesic {name}(t) : {} = (1, {x}) @ (0.5, {y}), t : [0, 1];",
                self.name(Kind::Patch, "s")
            ),
        };
        Line { kind, name, text }
    }

    /// A declaration of a name that is not declared yet, as a rule.
    fn fresh(&mut self, all: &[Line]) -> Line {
        let (mut kind, mut name) = (Kind::Number, "a");
        for _ in 0..12 {
            let (some, names) = NAMES[self.random.below(NAMES.len())];
            (kind, name) = (some, names[self.random.below(names.len())]);
            // A geodesic needs something to lie on.
            let is_lost = kind == Kind::Geodesic
                && self.above.iter().all(|line| line.kind != Kind::Patch)
                && self.random.below(8) > 0;
            if !is_lost && all.iter().all(|line| line.name != name) {
                break;
            }
        }
        self.line(kind, name)
    }
}

fn join(lines: &[Line]) -> String {
    lines
        .iter()
        .map(|line| format!("{}\n", line.text))
        .collect()
}

/// The next program, a declaration away from the last.
fn change(random: &mut Random, lines: &mut Vec<Line>) {
    let at = random.below(lines.len() + 1);
    let choice = random.below(12);
    let all = lines.clone();
    let mut writer = Writer {
        random,
        above: &all[..at.min(all.len())],
    };
    let known = all.get(at).map(|line| (line.kind, line.name));
    match known {
        Some((kind, name)) if choice < 5 => lines[at] = writer.line(kind, name),
        Some(_) if choice == 5 => {
            lines.remove(at);
        }
        // Renamed, and those who use it keep the old name.
        Some(_) if choice == 6 => {
            let other = writer.fresh(&all);
            lines[at] = writer.line(other.kind, other.name);
        }
        Some(_) if choice == 7 => lines[at].text.insert_str(0, "# π𝔘\n"),
        Some(_) if choice == 8 && at > 0 => lines.swap(at - 1, at),
        _ if lines.len() < 16 => lines.insert(at, writer.fresh(&all)),
        _ => {
            lines.remove(at.min(all.len() - 1));
        }
    }
}

/// Writes anew what stands in a line of the text, counted from 1.
fn repair(random: &mut Random, lines: &mut [Line], place: usize) {
    let all = lines.to_vec();
    let mut end = 0;
    let is_there = |line: &Line| {
        end += line.text.matches('\n').count() + 1;
        place <= end
    };
    let Some(at) = all.iter().position(is_there) else {
        return;
    };
    let above = &all[..at];
    let is_taken = above.iter().any(|line| line.name == all[at].name);
    let mut writer = Writer { random, above };
    lines[at] = match is_taken {
        true => writer.fresh(&all),
        false => writer.line(all[at].kind, all[at].name),
    };
}

/// The edit that makes one text of another: what is the same in front and behind stays.
fn difference(old: &str, new: &str) -> (Span, String) {
    let pairs = old.char_indices().zip(new.chars());
    let front = pairs.take_while(|((_, a), b)| a == b);
    let front = front.last().map_or(0, |((at, a), _)| at + a.len_utf8());
    let (old, new) = (&old[front..], &new[front..]);
    let pairs = old.chars().rev().zip(new.chars().rev());
    let back: usize = pairs
        .take_while(|(a, b)| a == b)
        .map(|(a, _)| a.len_utf8())
        .sum();
    let range = Span::new(front as u32, (front + old.len() - back) as u32);
    (range, new[..new.len() - back].to_owned())
}

const PIECES: &[&str] = &[
    ";",
    "#",
    "\n",
    " ",
    "(",
    ")",
    ",",
    "1",
    "9",
    "a",
    "b",
    "f",
    "g",
    "x",
    "'",
    "_u",
    "+ a",
    "- 1",
    "define ",
    "param ",
    "# 𝔘\n",
    "e",
    "k",
    "",
    "|",
    "&",
    "@",
    "solid ",
    "light ",
    ", color : 1",
];

/// How many random edits are made: `GEOTRACE_EDITS`, or a hundred thousand.
pub(crate) fn edit_count() -> usize {
    let wanted = std::env::var("GEOTRACE_EDITS").ok();
    wanted
        .and_then(|count| count.parse().ok())
        .unwrap_or(100_000)
}

/// What a document is held to after each edit.
pub(crate) trait Check: Default {
    /// Looks at a document and the text that it holds.
    fn check(&mut self, document: &Document, text: &str);
}

/// Makes one edit and holds the document to the text.
fn make(
    check: &mut impl Check,
    document: &mut Document,
    text: &mut String,
    range: Span,
    inserted: &str,
) {
    let before = text.clone();
    document.edit(range, inserted).expect("an edit");
    text.replace_range(range.start as usize..range.end as usize, inserted);
    let held = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        check.check(document, text);
    }));
    if held.is_err() {
        panic!("after the edit {range:?} {inserted:?} of\n{before}");
    }
}

/// Makes random edits and says after how many of them the program had no error.
fn storm<C: Check>(seed: u64, edits: usize) -> usize {
    const EDITS_OF_ONE: usize = 120;
    let mut random = Random(seed);
    let (mut done, mut sound) = (0, 0);
    while done < edits {
        let mut lines: Vec<Line> = Vec::new();
        for _ in 0..random.below(14) {
            let above = lines.clone();
            let mut writer = Writer {
                random: &mut random,
                above: &above,
            };
            lines.push(writer.fresh(&above));
        }
        let mut text = join(&lines);
        let mut document = Document::new(&text).expect("a small text");
        let mut checked = C::default();
        checked.check(&document, &text);
        for _ in 0..EDITS_OF_ONE {
            // A slip of the fingers, which is taken back by the next edit.
            if random.below(4) == 0 {
                let mut at = random.below(text.len() + 1);
                while !text.is_char_boundary(at) {
                    at -= 1;
                }
                let mut end = (at + random.below(4)).min(text.len());
                while !text.is_char_boundary(end) {
                    end += 1;
                }
                let range = Span::new(at as u32, end as u32);
                make(
                    &mut checked,
                    &mut document,
                    &mut text,
                    range,
                    random.pick(PIECES),
                );
                done += 1;
            }
            if random.below(12) > 0 {
                let diagnostics = document.diagnostics();
                let error = diagnostics.iter().find(|it| it.severity == Severity::Error);
                match error {
                    // What is wrong is put right, as a rule.
                    Some(error) if random.below(4) > 0 => {
                        let place = document.text().line(error.span.start);
                        repair(&mut random, &mut lines, place as usize);
                    }
                    _ => change(&mut random, &mut lines),
                }
            }
            let (range, inserted) = difference(&text, &join(&lines));
            make(&mut checked, &mut document, &mut text, range, &inserted);
            sound += usize::from(document.compilation().scene.is_some());
            done += 1;
        }
        assert_eq!(document.counters().renewed, 1);
    }
    sound
}

/// Makes random edits in four threads, and says after how many of them the program had no error.
pub(crate) fn storms<C: Check>(edits: usize) -> usize {
    let threads = 4;
    let each = edits.div_ceil(threads);
    std::thread::scope(|scope| {
        let storms = (0..threads).map(|k| scope.spawn(move || storm::<C>(k as u64 + 11, each)));
        let storms: Vec<_> = storms.collect();
        let sound = |storm: std::thread::ScopedJoinHandle<'_, usize>| match storm.join() {
            Ok(sound) => sound,
            Err(panic) => std::panic::resume_unwind(panic),
        };
        storms.into_iter().map(sound).sum()
    })
}
