//! Conversion of scripts into programs of the Geotrace language.

use std::path::Path;

use scene::ParamValues;
use scene::crt::{Converted, MAX_CONVERTED_LEAVES};
use syntax::span::Span;

use super::CrtAnalysis;
use crate::conversion::ConvertError;
use crate::geotrace::GeotraceAnalysis;
use crate::geotrace::format;
use crate::geotrace::rename::is_free;
use crate::language::Analysis;

/// Returns the program that shows the scene of a script at a value of `t`, in the canonical layout. Its first comment is
/// the command that renders the script's picture; `file` is the name of the program's file.
///
/// # Errors
/// [`ConvertError`].
pub(super) fn convert(analysis: &CrtAnalysis, t: f64, file: &str) -> Result<String, ConvertError> {
    let run = analysis
        .run()
        .filter(|_| analysis.errors().next().is_none());
    let scene = run.map(|run| &run.scene).ok_or(ConvertError::HasErrors)?;
    let mut params = ParamValues::initial(scene);
    let set = params.set(scene, "t", &[t]);
    if set.is_err() || scene.at(&params).check_run().is_err() {
        return Err(ConvertError::HasErrors);
    }
    let whole = analysis.slice(Span::new(0, analysis.text().len()));
    let empty = GeotraceAnalysis::new("");
    let converted =
        scene::crt::convert(&analysis.script(), &whole, t, &|name| is_free(&empty, name));
    let Converted {
        declarations,
        options,
    } = converted.ok_or(ConvertError::TooManyLeaves {
        most: MAX_CONVERTED_LEAVES,
    })?;
    // A word that begins with a `-` is an option.
    let file = match file.starts_with('-') {
        true => format!("./{file}"),
        false => file.to_owned(),
    };
    let picture = Path::new(&file).with_extension("png").display().to_string();
    let mut command = "# geotrace render".to_owned();
    let options = options.iter().map(String::as_str);
    for word in [&file, "-o", &picture].into_iter().chain(options) {
        command.push(' ');
        command.push_str(&shell_word(word));
    }
    let text = format!("{command}\n\n{declarations}");
    Ok(format::laid_out(&text))
}

/// Returns a word of a command as a shell reads it, on one line.
fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+".contains(c);
    if word.chars().all(is_plain) {
        return word.to_owned();
    }
    if !word.contains(char::is_control) {
        return format!("'{}'", word.replace('\'', r"'\''"));
    }
    let mut written = String::new();
    for c in word.chars() {
        match c {
            '\'' | '\\' => written.extend(['\\', c]),
            c if c.is_control() => written.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => written.push(c),
        }
    }
    format!("$'{written}'")
}
