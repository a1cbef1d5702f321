//! Contracts: the names and signatures of functions, compared before texts are joined.

use crate::join::InternalError;
use crate::library::Piece;

/// A function's header.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct FunctionSignature {
    /// Its name.
    pub name: String,
    /// Name and type of each parameter.
    pub parameters: Vec<(String, String)>,
    /// The type of its value; empty if it has none.
    pub result: String,
}

/// Checks that `written` contains every function of the contract, each with the contract's signature.
///
/// # Errors
/// [`InternalError`] if a function is missing or has another signature.
pub fn fulfils(written: &Piece<'_>, contract: &Piece<'_>) -> Result<(), InternalError> {
    let present = signatures(written.text);
    for wanted in signatures(contract.text) {
        let Some(found) = present
            .iter()
            .find(|signature| signature.name == wanted.name)
        else {
            return Err(fault(
                written,
                format!(
                    "{} lacks `{}` of {}",
                    written.origin, wanted.name, contract.origin
                ),
            ));
        };
        if *found != wanted {
            return Err(fault(
                written,
                format!(
                    "`{}` of {} is {found:?}, {} asks for {wanted:?}",
                    wanted.name, written.origin, contract.origin
                ),
            ));
        }
    }
    Ok(())
}

/// Checks that a generated text contains exactly the functions of some contracts.
///
/// # Errors
/// [`InternalError`] if a function is missing, has another signature, or is in no contract.
pub fn is_exactly(generated: &Piece<'_>, contracts: &[Piece<'_>]) -> Result<(), InternalError> {
    let mut wanted = Vec::new();
    for contract in contracts {
        fulfils(generated, contract)?;
        wanted.extend(signatures(contract.text));
    }
    if let Some(extra) = signatures(generated.text)
        .into_iter()
        .find(|signature| !wanted.contains(signature))
    {
        return Err(fault(
            generated,
            format!("`{}` is in no contract", extra.name),
        ));
    }
    if let Some(item) = items(generated.text)
        .into_iter()
        .find(|item| !item.starts_with("fn "))
    {
        return Err(fault(
            generated,
            format!("generated text holds functions only, not `{item}`"),
        ));
    }
    Ok(())
}

/// Returns the signatures of the functions in a text, in order.
pub fn signatures(text: &str) -> Vec<FunctionSignature> {
    items(text)
        .iter()
        .filter_map(|item| signature(item))
        .collect()
}

fn fault(piece: &Piece<'_>, message: String) -> InternalError {
    InternalError {
        message,
        source: piece.text.to_owned(),
    }
}

/// Returns the top-level items of a text without comments and without the contents of braces.
fn items(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut item = String::new();
    let mut depth = 0usize;
    for line in text.lines() {
        let code = line.split_once("//").map_or(line, |(before, _)| before);
        for c in code.chars().chain(['\n']) {
            match c {
                '{' => depth += 1,
                '}' => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        finish(&mut item, &mut found);
                    }
                }
                ';' if depth == 0 => finish(&mut item, &mut found),
                _ if depth == 0 => item.push(c),
                _ => {}
            }
        }
    }
    finish(&mut item, &mut found);
    found
}

/// Appends a collected item to the list, with white space collapsed.
fn finish(item: &mut String, found: &mut Vec<String>) {
    let words: Vec<&str> = item.split_whitespace().collect();
    if !words.is_empty() {
        found.push(words.join(" "));
    }
    item.clear();
}

/// Parses `fn name(a: T, b: U) -> V`, skipping attributes before it; functions whose parameters have attributes (entry
/// points) are not part of a contract.
fn signature(item: &str) -> Option<FunctionSignature> {
    if item.starts_with('@') {
        return None;
    }
    let header = item.strip_prefix("fn ")?;
    let (name, rest) = header.split_once('(')?;
    let (inside, result) = rest.rsplit_once(')')?;
    let parameters = inside
        .split(',')
        .filter_map(|parameter| parameter.split_once(':'))
        .map(|(name, ty)| (name.trim().to_owned(), ty.trim().to_owned()))
        .collect();
    let result = result
        .trim()
        .strip_prefix("->")
        .unwrap_or("")
        .trim()
        .to_owned();
    Some(FunctionSignature {
        name: name.trim().to_owned(),
        parameters,
        result,
    })
}
