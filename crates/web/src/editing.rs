//! The text that is edited, and the editor's queries: `ide` on UTF-16 offsets, as JSON values.
//!
//! ```text
//! edits ──source──▶ bytes ──▶ ide::Program ──▶ diagnostics, scene
//!                                 │ snapshot
//! a query at an offset ──▶ ide::Analysis ──▶ an answer with ranges in UTF-16
//! ```

use std::path::Path;
use std::sync::Arc;

use ide::completion::{Completion, CompletionKind};
use ide::description::Description;
use ide::edit::Edit;
use ide::language::Analysis;
use ide::{Language, Languages, Program};
use serde::Serialize;
use serde_json::{Value, json};
use syntax::diagnostic::Diagnostic;
use syntax::span::Span;

use crate::message::{PageFinding, Related};
use crate::source::{EditsDoNotFit, Utf16Edit, Utf16Range, Utf16Text};

/// A text of a language that is being edited.
#[derive(Debug)]
pub struct Editing {
    language: Arc<dyn Language>,
    program: Box<dyn Program>,
    source: Utf16Text,
    version: i32,
}

impl Editing {
    /// Opens a text; the name's extension selects the language.
    ///
    /// # Errors
    /// The sentence about a text that is too large.
    pub fn open(
        languages: &Languages,
        name: &str,
        text: String,
        version: i32,
    ) -> Result<Self, String> {
        let language = Arc::clone(languages.for_path(Path::new(name)));
        let program = language.open(&text).map_err(|error| error.to_string())?;
        Ok(Self {
            language,
            program,
            source: Utf16Text::new(text),
            version,
        })
    }

    /// Replaces the text by another one of the same language.
    ///
    /// # Errors
    /// The sentence about a text that is too large; the present one is then kept.
    pub fn replace(&mut self, text: String, version: i32) -> Result<(), String> {
        let program = self.language.open(&text);
        self.program = program.map_err(|error| error.to_string())?;
        self.source = Utf16Text::new(text);
        self.version = version;
        Ok(())
    }

    /// Applies the edits that lead to the next version.
    ///
    /// # Errors
    /// [`EditsDoNotFit`] if they are for another version, or their ranges are not in the text: the page must send it
    /// again.
    pub fn edit(&mut self, version: i32, edits: &[Utf16Edit]) -> Result<(), EditsDoNotFit> {
        if version != self.version.wrapping_add(1) {
            return Err(EditsDoNotFit);
        }
        let program = &mut self.program;
        let mut all_fit = true;
        self.source.edit(edits, |span, text| {
            all_fit &= program.edit(span, text).is_ok();
        })?;
        self.version = version;
        // The program refuses an edit that makes it too large.
        if all_fit { Ok(()) } else { Err(EditsDoNotFit) }
    }

    /// Returns the text, with its offsets.
    pub fn source(&self) -> &Utf16Text {
        &self.source
    }

    /// Returns its language.
    pub fn language(&self) -> &dyn Language {
        &*self.language
    }

    /// Returns its program.
    pub fn program(&self) -> &dyn Program {
        &*self.program
    }

    /// Returns the version of the text.
    pub fn version(&self) -> i32 {
        self.version
    }

    /// Returns the findings in the page's form.
    pub fn findings(&self, diagnostics: &[Diagnostic]) -> Vec<PageFinding> {
        let finding = |found: &Diagnostic| PageFinding {
            range: self.source.range(found.span),
            severity: found.severity.name(),
            code: found.code.0,
            message: found.message.clone(),
            hint: found.hint.clone(),
            related: found
                .related
                .iter()
                .map(|related| Related {
                    range: self.source.range(related.span),
                    message: related.message.clone(),
                })
                .collect(),
        };
        diagnostics.iter().map(finding).collect()
    }

    /// Returns the tokens that touch a range, four numbers each: from, to, type, modifiers.
    pub fn tokens(&self, range: Utf16Range) -> Vec<u32> {
        let span = self.source.span(range);
        let tokens = self.analysis().semantic_tokens(span).into_iter();
        tokens
            .flat_map(|token| {
                let Utf16Range { from, to } = self.source.range(token.span);
                [from, to, token.token_type as u32, token.modifiers.0]
            })
            .collect()
    }

    fn analysis(&self) -> Arc<dyn Analysis> {
        self.program.snapshot()
    }

    fn byte(&self, at: u32) -> u32 {
        self.source.byte(at)
    }

    /// Returns the description of the name at an offset.
    pub fn hover(&self, at: u32) -> Value {
        let Some((span, described)) = self.analysis().hover(self.byte(at)) else {
            return Value::Null;
        };
        let Utf16Range { from, to } = self.source.range(span);
        json!({ "from": from, "to": to, "description": description(&described) })
    }

    /// Returns the completions at an offset.
    pub fn complete(&self, at: u32) -> Value {
        let found = self.analysis().completions(self.byte(at), true);
        let Utf16Range { from, to } = self.source.range(found.range);
        let list: Vec<Value> = found.list.iter().map(completion).collect();
        json!({ "from": from, "to": to, "list": list, "isComplete": found.is_complete })
    }

    /// Returns the description of an entry of the completions at an offset.
    pub fn describe(&self, at: u32, label: &str) -> Value {
        let described = self.analysis().describe_completion(self.byte(at), label);
        described.as_ref().map_or(Value::Null, description)
    }

    /// Returns the signature of the function whose arguments are at an offset.
    pub fn signature(&self, at: u32) -> Value {
        let Some(found) = self.analysis().signature(self.byte(at)) else {
            return Value::Null;
        };
        let label = Utf16Text::new(found.label);
        let parameters = found.parameters.iter();
        let parameters: Vec<Utf16Range> = parameters
            .map(|&(start, end)| label.range(Span::new(start, end)))
            .collect();
        json!({
            "label": label.as_str(),
            "parameters": parameters,
            "active": found.active,
            "what": found.what,
        })
    }

    /// Returns the range in which the name at an offset is introduced.
    pub fn definition(&self, at: u32) -> Value {
        match self.analysis().definition(self.byte(at)) {
            Some((name, target)) => json!({
                "name": self.source.range(name),
                "target": self.source.range(target),
            }),
            None => Value::Null,
        }
    }

    /// Returns all occurrences of the name at an offset.
    pub fn occurrences(&self, at: u32) -> Value {
        let found = self.analysis().occurrences(self.byte(at)).into_iter();
        let found = found.map(|it| {
            let Utf16Range { from, to } = self.source.range(it.span);
            json!({ "from": from, "to": to, "introduces": it.introduces })
        });
        found.collect()
    }

    /// Returns the name at an offset, if it can be renamed.
    ///
    /// # Errors
    /// The sentence that says why it cannot.
    pub fn prepare_rename(&self, at: u32) -> Result<Value, String> {
        let found = self.analysis().prepare_rename(self.byte(at));
        let (span, name) = found.map_err(|error| error.to_string())?;
        let Utf16Range { from, to } = self.source.range(span);
        Ok(json!({ "from": from, "to": to, "name": name }))
    }

    /// Returns the edits of a renaming.
    ///
    /// # Errors
    /// The sentence that says why the new name is not possible.
    pub fn rename(&self, at: u32, name: &str) -> Result<Value, String> {
        let edits = self.analysis().rename(self.byte(at), name);
        Ok(self.edits(&edits.map_err(|error| error.to_string())?))
    }

    /// Returns the edits that format the text, or a part of it.
    pub fn format(&self, range: Option<Utf16Range>) -> Value {
        let span = range.map(|range| self.source.span(range));
        self.edits(&self.analysis().format(span))
    }

    /// Returns the fixes of the findings in a range.
    pub fn fixes(&self, range: Utf16Range) -> Value {
        let fixes = self.analysis().fixes(self.source.span(range)).into_iter();
        let fixes = fixes.map(|fix| {
            json!({
                "title": fix.title,
                "edits": self.edits(&fix.edits),
                "code": fix.diagnostic.code.0,
                "preferred": fix.preferred,
            })
        });
        fixes.collect()
    }

    /// Returns all fixes that may be applied without asking.
    pub fn fix_all(&self) -> Value {
        let (edits, count) = self.analysis().fix_all();
        json!({ "edits": self.edits(&edits), "count": count })
    }

    /// Returns the edit that gives a param initial values.
    ///
    /// # Errors
    /// The sentence that says why it is not written.
    pub fn write_param(&self, param: &str, values: &[f64]) -> Result<Value, String> {
        let edit = self.analysis().edit_param(param, values);
        Ok(json!(
            self.page_edit(&edit.map_err(|error| error.to_string())?)
        ))
    }

    /// Returns the edit that gives a camera of the text a position and a direction, and a new one a vertical field of view,
    /// in radians.
    ///
    /// # Errors
    /// The sentence that says why it is not written.
    pub fn write_camera(
        &self,
        name: &str,
        direction: [f64; 3],
        position: [f64; 3],
        fov: f64,
    ) -> Result<Value, String> {
        let analysis = self.analysis();
        let edit = analysis.edit_camera(name, direction, position, fov);
        Ok(json!(
            self.page_edit(&edit.map_err(|error| error.to_string())?)
        ))
    }

    /// Returns the edit that gives an object another colour.
    ///
    /// # Errors
    /// The sentence that says why it is not written.
    pub(crate) fn write_colour(&self, object: &str, rgb: [u8; 3]) -> Result<Value, String> {
        let rgb = rgb.map(|part| f64::from(part) / 255.0);
        let edit = self.analysis().edit_colour(object, rgb);
        Ok(json!(
            self.page_edit(&edit.map_err(|error| error.to_string())?)
        ))
    }

    fn edits(&self, edits: &[Edit]) -> Value {
        json!(
            edits
                .iter()
                .map(|edit| self.page_edit(edit))
                .collect::<Vec<_>>()
        )
    }

    fn page_edit(&self, edit: &Edit) -> Utf16Edit {
        let Utf16Range { from, to } = self.source.range(edit.span);
        Utf16Edit {
            from,
            to,
            insert: edit.text.clone(),
        }
    }
}

/// The kind of a completion, as named by the page's icons.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Constant,
    Function,
    Keyword,
    Surface,
    Curve,
    Parameter,
    Solid,
    Attribute,
    Word,
}

fn description(described: &Description) -> Value {
    json!({
        "language": described.language,
        "code": described.code,
        "text": described.text,
    })
}

fn completion(entry: &Completion) -> Value {
    let kind = match entry.kind {
        CompletionKind::Keyword => Kind::Keyword,
        CompletionKind::Function => Kind::Function,
        CompletionKind::Surface => Kind::Surface,
        CompletionKind::Curve => Kind::Curve,
        CompletionKind::Constant => Kind::Constant,
        CompletionKind::Parameter => Kind::Parameter,
        CompletionKind::Solid => Kind::Solid,
        CompletionKind::Attribute => Kind::Attribute,
        CompletionKind::Word => Kind::Word,
    };
    json!({
        "label": entry.label,
        "kind": kind,
        "detail": entry.detail,
        "insert": entry.insert,
        "snippet": entry.snippet,
    })
}

#[cfg(test)]
mod tests {
    use ide::Languages;

    use super::Editing;
    use crate::source::{Utf16Edit, Utf16Range};

    fn open(text: &str) -> Editing {
        Editing::open(&Languages::standard(), "a.gtr", text.to_owned(), 1).expect("a short text")
    }

    #[test]
    fn ranges_are_in_utf16() {
        let editing = open("# 𝕊²\nparam r : [1, 2];\npoint p = (r, q, 0);\n");
        let text = editing.source().as_str();
        let units: Vec<u16> = text.encode_utf16().collect();
        let finding = &editing.findings(&editing.program().diagnostics())[0];
        let Utf16Range { from, to } = finding.range;
        assert_eq!(
            String::from_utf16_lossy(&units[from as usize..to as usize]),
            "q"
        );
        let at = text.find("r, q").expect("there") as u32 - 4 + 1;
        let hover = editing.hover(at);
        assert!(
            hover["description"]["code"]
                .as_str()
                .expect("a line")
                .contains("param r"),
            "{hover}"
        );
        let edits = editing.rename(at, "radius").expect("a free name");
        assert_eq!(edits.as_array().map(Vec::len), Some(2));
    }

    #[test]
    fn an_edit_of_another_version_is_refused() {
        let mut editing = open("point p = (1, 2, 3);");
        let edit = Utf16Edit {
            from: 11,
            to: 12,
            insert: "7".to_owned(),
        };
        assert!(editing.edit(3, std::slice::from_ref(&edit)).is_err());
        editing.edit(2, &[edit]).expect("the next version");
        assert_eq!(editing.program().text().string(), "point p = (7, 2, 3);");
        assert_eq!(editing.source().as_str(), "point p = (7, 2, 3);");
    }
}
