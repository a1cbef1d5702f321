//! Geotrace's language on one page: the declarations of its table, and what expressions are made of.

use syntax::geotrace::declarations::TABLE;

use crate::overview::OverviewRow;

/// The parts of expressions. A test compiles the examples.
const EXPRESSIONS: &[OverviewRow] = &[
    row(
        "a + b   a b   a/b   a^b",
        "sum, product, quotient and power; v w is the dot product of two vectors",
    ),
    row(
        "(x, y, z)   v_1   v * w",
        "a vector, its first component, the cross product",
    ),
    row(
        "sin(2 a)   sin 2 a",
        "a function takes the shortest operand: the second is (sin 2) a",
    ),
    row(
        "sin cos tan asin acos atan sinh cosh tanh",
        "functions of angles, in radians",
    ),
    row(
        "exp log sqrt abs",
        "further functions; log is the natural logarithm",
    ),
    row(
        "min(a, b)   max(a, b, 1)",
        "the least and the greatest of numbers, or of a vector's components",
    ),
    row("pi   e", "constants"),
    row("c(1)   s(1, 2)", "the place on a curve or surface"),
    row(
        "c'(1)   s_u(1, 2)",
        "derivatives: of a function of one parameter, and by a parameter",
    ),
    row("# up to the end of the line", "a comment"),
];

const fn row(code: &'static str, text: &'static str) -> OverviewRow {
    OverviewRow { code, text }
}

/// Returns the rows of the page.
pub(super) fn overview() -> Vec<OverviewRow> {
    let declarations = TABLE.iter().map(|it| row(it.example, it.purpose));
    declarations.chain(EXPRESSIONS.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::{EXPRESSIONS, overview};

    /// The declarations that the examples use.
    const BEFORE: &str = "define a = 1; define b = 2; define x = 1; define y = 2; define z = 3;
curve c(t) = (t, t^2, 0), t : [0, 2];
surface s(u, v) = (u, v, u v), u : [0, 2], v : [0, 2];
point v = (1, 0, 0); point w = (0, 1, 0);
";

    #[test]
    fn what_the_page_says_compiles() {
        let sound = |expression: &str| {
            let program = format!("{BEFORE}define test = {expression};");
            let compiled = scene::geotrace::compile(&program);
            let diagnostics = compiled.diagnostics;
            assert!(compiled.scene.is_some(), "{expression}: {diagnostics:?}");
        };
        for row in EXPRESSIONS.iter().filter(|row| !row.code.starts_with('#')) {
            if row.text.contains("functions") {
                let names = row.code.split(' ');
                names.for_each(|name| sound(&format!("{name}(a/2)")));
            } else {
                row.code.split("   ").for_each(&sound);
            }
        }
        assert!(overview().len() > EXPRESSIONS.len() + 5);
    }
}
