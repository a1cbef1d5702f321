//! What there is to say of a name: its signature, its value, its geometry.

use expr::ops;
use scene::Settings;
use syntax::symbols::{Symbol, SymbolKind};
use syntax::token::{DeclareWord, SymbolId};

use crate::geometry;
use crate::hints::{constant, shown};
use crate::outline::parameters;
use crate::reading::{Item, Reading, Target};
use crate::write;

/// A name, told to a reader: `code` in the language, `text` in Markdown.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Description {
    /// One line of code: `surface s(u, v)`.
    pub code: String,
    /// Paragraphs of Markdown.
    pub text: Vec<String>,
}

impl Description {
    /// All of it in Markdown.
    pub fn markdown(&self) -> String {
        let mut all = vec![format!("```geotrace\n{}\n```", self.code)];
        all.extend(self.text.iter().cloned());
        all.join("\n\n")
    }

    /// All of it as plain text.
    pub fn plain(&self) -> String {
        let mut all = vec![self.code.clone()];
        all.extend(self.text.iter().map(|text| text.replace(['`', '*'], "")));
        all.join("\n\n")
    }
}

/// What a target is.
pub fn describe(reading: &Reading, target: Target) -> Option<Description> {
    match target {
        Target::Symbol(id) => {
            let symbol = reading.symbols().get(id)?;
            match reading.item_of(id) {
                Some(item) => Some(declared(reading, item)),
                None => builtin(symbol),
            }
        }
        Target::Parameter { item, position } => {
            let item = reading.items().get(item)?;
            let parameter = &item.parameters.get(position)?.name;
            let owner = format!("{}{}", item.name, signature(item));
            let mut text = vec![format!("a parameter of the {} `{owner}`", item.word.text())];
            text.extend(interval_of(reading, item, position).map(|i| format!("over `{i}`")));
            Some(Description {
                code: parameter.clone(),
                text,
            })
        }
    }
}

fn signature(item: &Item) -> String {
    parameters(item.parameters.iter().map(|p| p.name.as_str()))
}

/// The interval of a parameter, as it is written.
fn interval_of(reading: &Reading, item: &Item, position: usize) -> Option<String> {
    // Intervals carry tags; they come in any order.
    let name = &item.parameters.get(position)?.name;
    let text = reading.text();
    item.intervals.iter().find_map(|span| {
        let before = text[item.span.start as usize..span.start as usize].trim_end();
        let tag = before.strip_suffix(':')?.trim_end();
        let word = tag.rsplit(|c: char| !c.is_ascii_alphanumeric()).next()?;
        (word == name).then(|| span.text(text).to_owned())
    })
}

fn declared(reading: &Reading, position: usize) -> Description {
    let item = &reading.items()[position];
    let code = format!("{} {}{}", item.word.text(), item.name, signature(item));
    let mut text = Vec::new();
    if item.faulty {
        text.push("This declaration holds an error.".to_owned());
        return Description { code, text };
    }
    match item.word {
        DeclareWord::Param => {
            let intervals = written_intervals(reading, item);
            text.push(format!(
                "a slider over {intervals}; it starts at {}",
                match write::opening(reading, position) {
                    Some(span) => format!("`{}`", span.text(reading.text())),
                    None => "its minimum".to_owned(),
                }
            ));
        }
        DeclareWord::Grid => {
            let intervals = written_intervals(reading, item);
            text.push(format!(
                "the values {intervals}: what depends on it is drawn once for each"
            ));
        }
        DeclareWord::Define | DeclareWord::Point | DeclareWord::Vector => {
            text.extend(value(reading, position));
        }
        DeclareWord::Function => {}
        _ => {
            let lines = (0..item.parameters.len()).filter_map(|k| {
                let interval = interval_of(reading, item, k)?;
                Some(format!("`{} : {interval}`", item.parameters[k].name))
            });
            let lines: Vec<String> = lines.collect();
            if !lines.is_empty() {
                text.push(format!("over {}", lines.join(", ")));
            }
            text.extend(geometry::of(reading, position));
        }
    }
    text.extend(comment_above(reading, item));
    Description { code, text }
}

fn written_intervals(reading: &Reading, item: &Item) -> String {
    let intervals = item
        .intervals
        .iter()
        .map(|span| format!("`{}`", span.text(reading.text())));
    intervals.collect::<Vec<_>>().join(" × ")
}

/// The value of a constant: for one that params move, that at their start.
fn value(reading: &Reading, item: usize) -> Option<String> {
    let compilation = reading.compile_alone([item])?;
    let item = &reading.items()[item];
    if let Some(value) = constant(&compilation, &item.name) {
        return Some(if reading.depends_on_settings(item.symbol?) {
            format!("= {value}, with every param at its start")
        } else {
            format!("= {value}")
        });
    }
    let settings = Settings::opening(compilation.scene.as_ref()?);
    let scene::Outcome::Instances(instances) =
        compilation.evaluate(&item.name, &settings).ok()?.outcome
    else {
        return None;
    };
    let first = instances.first()?;
    Some(format!(
        "{} values, one for each value of the grids; the first is {}",
        instances.len(),
        shown(&first.value)
    ))
}

/// The comment right above a declaration, or behind it on its line.
fn comment_above(reading: &Reading, item: &Item) -> Option<String> {
    let text = reading.text();
    let mut lines: Vec<&str> = Vec::new();
    let before = &text[..item.span.start as usize];
    let line_start = before.rfind('\n').map_or(0, |at| at + 1);
    if before[line_start..].trim().is_empty() {
        for line in before[..line_start].lines().rev() {
            match line.trim().strip_prefix('#') {
                Some(comment) => lines.push(comment.trim()),
                None => break,
            }
        }
        lines.reverse();
    }
    if lines.is_empty() {
        let behind = text[item.span.end as usize..]
            .lines()
            .next()
            .unwrap_or_default();
        lines.extend(behind.trim().strip_prefix('#').map(str::trim));
    }
    let comment = lines.join(" ");
    (!comment.is_empty()).then_some(comment)
}

/// A name that every program starts with.
fn builtin(symbol: &Symbol) -> Option<Description> {
    let name = &symbol.name;
    if symbol.kind == SymbolKind::Constant {
        let (_, _, doc) = ops::CONSTANTS
            .into_iter()
            .find(|(known, ..)| known == name)?;
        return Some(Description {
            code: name.clone(),
            text: vec![doc.to_owned()],
        });
    }
    let text = match ops::builtin(name) {
        Some(operation) => {
            let row = operation.row();
            vec![
                row.doc.to_owned(),
                format!("derivative: `{}`", row.derivative),
            ]
        }
        None => vec!["The identity: gives its operand, a number or a vector.".to_owned()],
    };
    Some(Description {
        code: format!("{name} x"),
        text,
    })
}

/// The description of a symbol, for a list of completions.
pub(crate) fn of_symbol(reading: &Reading, id: SymbolId) -> Option<Description> {
    describe(reading, Target::Symbol(id))
}
