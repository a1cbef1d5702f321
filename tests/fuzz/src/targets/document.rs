//! Edited programs, and their layout.

use arbitrary::Unstructured;
use ide::Languages;
use ide::language::Analysis;
use syntax::span::Span;

use super::program::WORDS;

/// The most edits of an input.
const EDITS: usize = 12;

/// Edits a program: after every edit it has the diagnostics and tokens of its text.
pub(crate) fn edits(input: &[u8]) {
    let languages = Languages::standard();
    let language = languages.default_language();
    let mut text = String::from_utf8_lossy(input).into_owned();
    let mut program = language.open(&text).expect("it is small");
    // The end of the text decides about the edits, so that its beginning is a program.
    let tail = &input[input.len().saturating_sub(4 * EDITS)..];
    let mut choices = Unstructured::new(tail);
    for _ in 0..EDITS {
        let Ok([from, length, word]) = choices.arbitrary::<[u16; 3]>() else {
            break;
        };
        let place = |at: usize| {
            let at = at.min(text.len());
            (0..=at)
                .rev()
                .find(|at| text.is_char_boundary(*at))
                .unwrap_or(0)
        };
        let start = place(usize::from(from) * text.len() / 65_535);
        let end = place(start + usize::from(length % 24)).max(start);
        let word = WORDS[usize::from(word) % WORDS.len()];
        let range = Span::new(start as u32, end as u32);
        program.edit(range, word).expect("a range of the text");
        text.replace_range(start..end, word);
        assert_eq!(program.text().string(), text, "the text");
        let scratch = language.read(&text);
        assert_eq!(
            program.diagnostics(),
            scratch.diagnostics(),
            "the diagnostics of {text:?}"
        );
        assert_eq!(
            tokens(&*program.snapshot()),
            tokens(&*scratch),
            "the tokens of {text:?}"
        );
    }
}

fn tokens(analysis: &dyn Analysis) -> String {
    let whole = Span::new(0, analysis.text().len());
    format!("{:?}", analysis.semantic_tokens(whole))
}

/// Lays a program out twice: the second time changes nothing, and its words, diagnostics and values are those of the text
/// before.
pub(crate) fn format(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let languages = Languages::standard();
    let language = languages.default_language();
    let before = language.read(&text);
    let laid_out = ide::edit::apply(&text, &before.format(None));
    let after = language.read(&laid_out);
    let again = after.format(None);
    assert_eq!(again, [], "a layout is laid out again: {laid_out:?}");
    let codes = |analysis: &dyn Analysis| -> Vec<_> {
        let found = analysis.diagnostics();
        found.iter().map(|it| (it.code, it.severity)).collect()
    };
    assert_eq!(
        codes(&*before),
        codes(&*after),
        "the diagnostics of {text:?} and of {laid_out:?}"
    );
    let values = |analysis: &dyn Analysis| -> Vec<String> {
        let whole = Span::new(0, analysis.text().len());
        let hints = analysis.hints(whole).into_iter();
        hints.map(|it| it.label).collect()
    };
    assert_eq!(values(&*before), values(&*after), "values of {text:?}");
    let words = |text: &str| text.split_whitespace().collect::<String>();
    assert_eq!(words(&text), words(&laid_out), "all but white space stays");
}
