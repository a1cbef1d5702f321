//! The Geotrace language on one page: the declarations of its table, and the parts of expressions.

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
        "trigonometric functions, with angles in radians, their inverses, and hyperbolic functions",
    ),
    row(
        "exp log sqrt abs id",
        "further functions; log is the natural logarithm, id(x) is x",
    ),
    row(
        "min(a, b)   max(a, b, 1)",
        "the least and the greatest of numbers, or of a vector's components",
    ),
    row("pi   e", "constants"),
    row("c(1)   s(1, 2)", "the point on a curve or surface"),
    row(
        "c'(1)   s_u(1, 2)",
        "derivatives: of a function of one parameter, and by one of several",
    ),
    row(
        "a | b   a \\ b   a & b   a @ v   a @ scale 2   a @ rotate v",
        "sets of solids, in `solid s = …;`",
    ),
    row(
        "color : (1, 0.5, 0)   mirror : 0.3   glass : 0.9",
        "attributes, after a `,` of a declaration",
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

    /// The declarations that the examples of sets use.
    const SETS: &str = "solid a(x, y, z) = x; solid b(x, y, z) = y; point v = (1, 0, 0);
";

    #[test]
    fn what_the_page_says_compiles() {
        let compiles = |program: String| {
            let compiled = scene::geotrace::compile(&program);
            let diagnostics = compiled.diagnostics;
            assert!(compiled.scene.is_some(), "{program}: {diagnostics:?}");
        };
        let sound = |expression: &str| compiles(format!("{BEFORE}define test = {expression};"));
        for row in EXPRESSIONS.iter().filter(|row| !row.code.starts_with('#')) {
            let parts = row.code.split("   ");
            if row.text.contains("functions") {
                let names = row.code.split(' ');
                names.for_each(|name| sound(&format!("{name}(a/2)")));
            } else if row.text.contains("sets") {
                parts.for_each(|set| compiles(format!("{SETS}solid test = {set};")));
            } else if row.text.contains("attributes") {
                parts.for_each(|item| compiles(format!("{SETS}solid test = a, {item};")));
            } else {
                parts.for_each(&sound);
            }
        }
        assert!(overview().len() > EXPRESSIONS.len() + 5);
    }
}
