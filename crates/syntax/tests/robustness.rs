//! Whatever is typed, the front-end ends, in bounded time and space, and says what is wrong.

#[path = "support/recorder.rs"]
mod support;

use proptest::prelude::*;
use support::{Recorder, assert_tokens_tile, parse, program_diagnostics, vocabulary};
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::geotrace::actions::Actions;
use syntax::geotrace::codes;
use syntax::geotrace::highlight::highlight;
use syntax::geotrace::parser::MAX_DEPTH;
use syntax::geotrace::{parse_expression, parse_program};
use syntax::text::MAX_DIAGNOSTICS;

/// Counts, and keeps nothing.
#[derive(Default)]
struct Counter {
    steps: usize,
    codes: Vec<syntax::diagnostic::Code>,
}

impl Actions for Counter {
    fn act_operator(&mut self, _: syntax::geotrace::actions::Operator, _: syntax::span::Span) {
        self.steps += 1;
    }
    fn act_error(&mut self, diagnostic: Diagnostic) {
        self.codes.push(diagnostic.code);
    }
}

fn count(source: &str) -> Counter {
    let mut counter = Counter::default();
    parse_program(source, &vocabulary(), &mut counter);
    counter
}

/// Every invariant that holds for any text at all.
fn check_invariants(source: &str) {
    let (recorder, parsed) = parse(source);
    assert_tokens_tile(source, &recorder.tokens);
    for diagnostic in &recorder.diagnostics {
        let places = diagnostic.related.iter().map(|related| related.span);
        for span in places.chain([diagnostic.span]) {
            assert!(source.get(span.start as usize..span.end as usize).is_some());
        }
        assert!(!diagnostic.message.is_empty());
    }
    for declared in &recorder.declared {
        assert!(
            source
                .get(declared.span.start as usize..declared.span.end as usize)
                .is_some()
        );
        let name = declared.name_span.text(source);
        assert_eq!(name, declared.name);
        if let Some(id) = declared.symbol {
            assert_eq!(*parsed.symbols[id].name, *declared.name);
            assert_eq!(parsed.symbols[id].faulty, declared.faulty);
            assert_eq!(parsed.trie.get(name), Some(id));
        }
    }
    assert_eq!(recorder.opened.len(), recorder.declared.len());
    let has_error = recorder
        .diagnostics
        .iter()
        .any(|d| d.severity == Severity::Error);
    assert!(has_error || recorder.declared.iter().all(|declared| !declared.faulty));
    assert_stack_is_balanced(&recorder);
    let mut expression = Recorder::default();
    let complete = parse_expression(source, &parsed, &mut expression);
    assert_tokens_tile(source, &expression.tokens);
    assert!(!complete || stack_height(&expression.steps, 0) == 1);
    let spans: Vec<_> = highlight(source, &vocabulary())
        .iter()
        .map(|h| h.span)
        .collect();
    let tokens: Vec<_> = recorder.tokens.iter().map(|token| token.span).collect();
    assert_eq!(spans, tokens);
}

/// How high the imagined stack of the hooks stands after some steps.
fn stack_height(
    steps: &[(syntax::geotrace::actions::Operator, syntax::span::Span)],
    start: i64,
) -> i64 {
    use syntax::geotrace::actions::Operator as O;
    steps.iter().fold(start, |height, (operator, _)| {
        let height = match operator {
            O::Number(_) | O::Constant(_) | O::Variable(_) | O::Function(_) => height + 1,
            O::Partial(_)
            | O::Total
            | O::Plus
            | O::Negate
            | O::Square
            | O::Reciprocal
            | O::Position
            | O::Atom
            | O::Component(_) => height,
            O::FunctionPower
            | O::Apply
            | O::Add
            | O::Subtract
            | O::Juxtapose
            | O::Multiply
            | O::Divide
            | O::Power
            | O::Union
            | O::Intersection
            | O::Difference
            | O::Move
            | O::Scale
            | O::Rotate
            | O::Image => height - 1,
            O::Tuple(n) => height - i64::from(*n) + 1,
        };
        assert!(height > 0, "an operand is missing");
        height
    })
}

/// What is handed out for a declaration without error is complete.
fn assert_stack_is_balanced(recorder: &Recorder) {
    use syntax::geotrace::actions::IntervalKind;
    use syntax::geotrace::declarations::DeclarationKeyword as W;
    for declared in recorder.declared.iter().filter(|declared| !declared.faulty) {
        let expressions = match declared.keyword {
            // The value that a param opens with may be left out.
            W::Param => {
                let interval = declared.intervals[0].span;
                let first = declared.steps[0].1;
                i64::from(first.start < interval.start)
            }
            W::Grid => 0,
            W::Vector | W::Camera => 2,
            // A light has a direction, a place or both.
            W::Light => stack_height(&declared.steps, 0).clamp(1, 2),
            _ => 1,
        };
        let stated = declared.attributes.iter();
        let stated = stated.filter(|it| !it.word.is_key()).count() as i64;
        let expressions = match declared.keyword {
            W::Light => expressions
                .min(stack_height(&declared.steps, 0) - stated)
                .max(1),
            _ => expressions,
        };
        let popped: i64 = (declared.intervals.iter())
            .map(|interval| {
                if interval.kind == IntervalKind::Range {
                    2
                } else {
                    3
                }
            })
            .sum();
        assert_eq!(
            stack_height(&declared.steps, 0),
            expressions + popped + stated,
            "{declared:?}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn any_text_is_read_to_its_end(source in "\\PC{0,80}") {
        check_invariants(&source);
    }

    #[test]
    fn any_bytes_that_are_text_are_read_to_their_end(characters in prop::collection::vec(any::<char>(), 0..60)) {
        check_invariants(&characters.into_iter().collect::<String>());
    }

    #[test]
    fn any_mixture_of_tokens_is_read_to_its_end(
        pieces in prop::collection::vec(
            prop::sample::select(vec![
                "define ", "function ", "curve ", "surface ", "param ", "grid ", "point ", "vector ", "metric ", "geodesic ", "defin ",
                "solid ", "light ", "camera ", "background ", "|", "&", "\\", "color", "bokeh", "star", "scale ", "rotate ", ", x : ",
                "f", "g", "u", "x", "pi", "sin", "e", "2", ".5", ".", "1e999", "1e-999", "(", ")", "[", "]", "{", "}",
                ",", ";", ";", ":", "=", "=", "@", "_", "'", "^", "+", "-", "*", "/", " ", "\n", "# c\n", "α", "\0", "f(u)=",
            ]),
            0..60,
        ),
    ) {
        check_invariants(&pieces.concat());
    }
}

#[test]
fn the_deepest_nesting_fits_a_small_stack_and_one_level_more_is_an_error() {
    let run = || {
        let depth = MAX_DEPTH as usize;
        let nest = |open: &str, close: &str, depth: usize| {
            format!("define a = {}1{};", open.repeat(depth), close.repeat(depth))
        };
        for (open, close) in [
            ("(", ")"),
            ("-", ""),
            ("sin ", ""),
            ("2^", ""),
            ("sin^", " 1"),
            ("[(", ")]"),
            ("1+(pi ", ")"),
        ] {
            let levels = if open == "[(" { depth / 2 } else { depth };
            assert_eq!(count(&nest(open, close, levels)).codes, []);
            for more in [levels + 1, 100_000] {
                let source = nest(open, close, more);
                assert_eq!(count(&source).codes, [codes::TOO_DEEP], "{open} {more}");
            }
        }
    };
    let thread = std::thread::Builder::new()
        .stack_size(2 << 20)
        .spawn(run)
        .expect("a thread");
    thread.join().expect("no overflow");
}

#[test]
fn a_megabyte_of_flat_expression_needs_no_depth() {
    let flat = |operator: &str| format!("define a = 1{};", format!("{operator}1").repeat(500_000));
    for operator in ["+", "-", "*", "/", " "] {
        let counter = count(&flat(operator));
        assert_eq!((counter.codes.len(), counter.steps), (0, 1_000_001));
    }
    let tuple = format!("define a = (1{});", ",1".repeat(500_000));
    assert_eq!(count(&tuple).steps, 500_002);
    let derivatives = format!("define a = sin{} 1;", "'".repeat(500_000));
    assert_eq!(count(&derivatives).steps, 500_003);
}

#[test]
fn long_words_are_split_in_linear_time() {
    let source = format!("define a = 1; define b = {};", "a".repeat(1_000_000));
    assert_eq!(count(&source).codes, []);
    let unknown = format!("define b = {};", "z".repeat(1_000_000));
    let lines = program_diagnostics(&unknown);
    assert_eq!(lines.len(), 1);
    assert!(lines[0].contains("`zzz"), "the quote is cut");
    assert!(count(&unknown).codes == [codes::UNDEFINED_NAME]);
}

#[test]
fn diagnostics_are_limited_and_the_last_one_says_so() {
    let counter = count(&"\0 ".repeat(2 * MAX_DIAGNOSTICS));
    assert_eq!(counter.codes.len(), MAX_DIAGNOSTICS);
    assert_eq!(counter.codes.last(), Some(&syntax::codes::TOO_MANY_ERRORS));
}

#[test]
fn a_run_of_nul_bytes_is_one_finding() {
    let counter = count(&"\0".repeat(100_000));
    assert_eq!(counter.codes, [codes::BAD_CHARACTER]);
    let lines = program_diagnostics("define a = 1 + \0 2;");
    assert_eq!(lines.len(), 1);
    assert!(lines[0].contains("a NUL byte (U+0000) cannot be used here"));
}

#[test]
fn many_misspelt_words_among_many_names_are_answered() {
    let mut source = String::new();
    for k in 0..3000 {
        source.push_str(&format!("define name{k} = 1; define x{k} = nmae{k};\n"));
    }
    let counter = count(&source);
    assert_eq!(counter.codes, vec![codes::UNDEFINED_NAME; 3000]);
}

#[test]
fn every_faulty_declaration_is_reported_and_the_others_are_kept() {
    let mut source = String::new();
    for k in 0..200 {
        source.push_str(&format!("define a{k} = 1 +; define b{k} = a{k} + 1;\n"));
    }
    let (recorder, _) = parse(&source);
    assert_eq!(recorder.diagnostics.len(), 200);
    assert!(
        recorder
            .diagnostics
            .iter()
            .all(|d| d.code == codes::UNEXPECTED_TOKEN)
    );
    let sound = recorder
        .declared
        .iter()
        .filter(|declared| !declared.faulty)
        .count();
    assert_eq!((recorder.declared.len(), sound), (400, 200));
}

#[test]
fn a_faulty_declaration_still_splits_what_stands_below() {
    let (recorder, parsed) =
        parse("define ab = ; function f(u, vw) = ; define c = ab f_vw(1,2) f_u 3;");
    assert_eq!(recorder.diagnostics.len(), 2);
    assert!(!recorder.declared[2].faulty);
    let steps = support::postfix(&recorder.declared[2].steps, &parsed, &[]);
    assert_eq!(steps, "ab f ∂1 1 2 (2) @ · f ∂0 3 @ ·");
}

#[test]
fn a_lone_expression_is_read_to_its_end() {
    let (_, parsed) = parse("define a = 1;");
    for (text, complete) in [
        ("a + 1", true),
        ("", false),
        ("1;", false),
        ("1 2)", false),
        ("b", false),
        ("# x", false),
        ("a # x", true),
    ] {
        let mut recorder = Recorder::default();
        assert_eq!(
            parse_expression(text, &parsed, &mut recorder),
            complete,
            "{text}"
        );
        assert_eq!(recorder.diagnostics.len(), usize::from(!complete), "{text}");
        for diagnostic in &recorder.diagnostics {
            let message = &diagnostic.message;
            assert!(!message.contains("after the end"), "{text}: {message}");
        }
    }
}
