//! The table of declarations.
//!
//! Each row contains a declaration's keyword, its syntax, the number of its parameters, the category of its name, and its
//! documentation (an example, the purpose in one sentence, a snippet for editors). The parser, the grammar, highlighting,
//! completion, hover, the outline and the documentation read this table. To add a declaration, add a row, productions to
//! [`grammar`](super::grammar) if its [`Syntax`] is new, and its meaning to the compiler.

/// The syntax of a declaration from its name to its `;`.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Syntax {
    /// `id : INTS` or `id = EXPR : INTS`.
    Slider,
    /// `id : GRIDS`.
    Grid,
    /// `id = EXPR`.
    Value,
    /// `id = EXPR @ EXPR`: a value with a position.
    Anchored,
    /// `id(IDS) = EXPR`.
    Function,
    /// `id(IDS) = EXPR, ITEMS`: a function over a domain.
    Parametrized,
    /// `id(IDS) = EXPR` or `id = SET`: a set of points, given by a function or by other sets.
    Solid,
    /// `id = EXPR`, `id = @ EXPR` or `id = EXPR @ EXPR`: a direction, a position or both.
    Light,
    /// `id(IDS) = EXPR` or `id = EXPR`: a value, or a function of a direction.
    Background,
    /// `id(IDS) : func = EXPR @ EXPR, ITEMS`: a curve in the surface or metric `func`, from a start along a direction, or
    /// without `@` between two places.
    InSurface,
}

/// The number of parameters of a declaration.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum ParameterCount {
    /// It declares a value.
    None,
    /// It declares a function of at least one parameter.
    AnyNumber,
    /// It declares a function of exactly this many parameters.
    Exactly(usize),
    /// It declares a function; if it states no parameters, it has those of space, x, y and z.
    OfSpace,
    /// It declares a value if it states no parameters, otherwise a function.
    Optional,
}

/// The category of a declared name, as far as tools distinguish declarations: in colours, icons, lists and views.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Category {
    /// A number or vector that a user sets.
    Slider,
    /// Equally spaced values, with one instance of each dependent object for each value.
    Grid,
    /// A number or vector.
    Constant,
    /// A function without a domain.
    Function,
    /// A curve, in space or in a surface.
    Curve,
    /// A surface in space.
    Surface,
    /// A surface that is given only by its first fundamental form and has no shape in space.
    Metric,
    /// A set of points of space.
    Solid,
    /// A light, a camera or a background.
    Stage,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct DeclarationRow {
    /// The keyword.
    pub keyword: DeclarationKeyword,
    /// The keyword as written.
    pub text: &'static str,
    /// The syntax after the keyword.
    pub syntax: Syntax,
    /// The number of its parameters.
    pub parameters: ParameterCount,
    /// The category of the declared name.
    pub category: Category,
    /// A complete declaration.
    pub example: &'static str,
    /// The purpose: the end of a sentence, without a full stop.
    pub purpose: &'static str,
    /// The declaration with numbered placeholders, in the syntax of the language server protocol's snippets.
    pub snippet: &'static str,
}

macro_rules! declarations {
    ($($name:ident $text:literal { $($field:ident: $value:expr),* $(,)? })*) => {
        /// The keywords that open a declaration.
        #[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
        #[allow(missing_docs)]
        pub enum DeclarationKeyword {
            $($name),*
        }

        const COUNT: usize = [$($text),*].len();

        /// The table, in the order of the keywords.
        pub static TABLE: [DeclarationRow; COUNT] = [
            $(DeclarationRow { keyword: DeclarationKeyword::$name, text: $text, $($field: $value),* }),*
        ];

        impl DeclarationKeyword {
            /// All keywords, in the order of the table.
            pub const ALL: [Self; COUNT] = [$(Self::$name),*];

            /// Returns the keyword with this text.
            pub fn from_text(text: &str) -> Option<Self> {
                // The lexer looks up every word of a text, so this compares literals instead of searching the table.
                Some(match text {
                    $($text => Self::$name,)*
                    _ => return None,
                })
            }
        }
    };
}

/// The parameters of a solid that states none.
pub const COORDINATES: [&str; 3] = ["x", "y", "z"];

declarations! {
    Param "param" {
        syntax: Syntax::Slider,
        parameters: ParameterCount::None,
        category: Category::Slider,
        example: "param r = 0.5 : [0, 1];",
        purpose: "a slider for each interval",
        snippet: "param ${1:r} : [${2:0}, ${3:1}];",
    }
    Grid "grid" {
        syntax: Syntax::Grid,
        parameters: ParameterCount::None,
        category: Category::Grid,
        example: "grid k : [0, 1, 5];",
        purpose: "equally spaced values; objects that depend on them are drawn once for each",
        snippet: "grid ${1:k} : [${2:0}, ${3:1}, ${4:5}];",
    }
    Define "define" {
        syntax: Syntax::Value,
        parameters: ParameterCount::None,
        category: Category::Constant,
        example: "define a = 2pi;",
        purpose: "a named value",
        snippet: "define ${1:a} = ${2:2pi};",
    }
    Function "function" {
        syntax: Syntax::Function,
        parameters: ParameterCount::AnyNumber,
        category: Category::Function,
        example: "function f(x, y) = x^2 + y;",
        purpose: "a function of numbers or vectors",
        snippet: "function ${1:f}(${2:x}) = ${3:x^2};",
    }
    Curve "curve" {
        syntax: Syntax::Parametrized,
        parameters: ParameterCount::Exactly(1),
        category: Category::Curve,
        example: "curve c(t) = (cos t, sin t, 0), t : [0, 2pi];",
        purpose: "a curve in space",
        snippet: "curve ${1:c}(${2:t}) = (${3:cos t}, ${4:sin t}, ${5:0}), ${2:t} : [${6:0}, ${7:2pi}];",
    }
    Surface "surface" {
        syntax: Syntax::Parametrized,
        parameters: ParameterCount::Exactly(2),
        category: Category::Surface,
        example: "surface s(u, v) = (u, v, u v), u : [0, 1], v : [0, 1];",
        purpose: "a surface in space, seen in 3D and from inside",
        snippet: "surface ${1:s}(${2:u}, ${3:v}) = (${4:u}, ${5:v}, ${6:u v}),\n    ${2:u} : [${7:-1}, ${8:1}], ${3:v} : [${9:-1}, ${10:1}];",
    }
    Point "point" {
        syntax: Syntax::Value,
        parameters: ParameterCount::None,
        category: Category::Constant,
        example: "point p = (1, 2, 3);",
        purpose: "a point in space",
        snippet: "point ${1:p} = (${2:0}, ${3:0}, ${4:0});",
    }
    Vector "vector" {
        syntax: Syntax::Anchored,
        parameters: ParameterCount::None,
        category: Category::Constant,
        example: "vector v = (1, 0, 0) @ p;",
        purpose: "an arrow: direction @ origin",
        snippet: "vector ${1:v} = (${2:1}, ${3:0}, ${4:0}) @ ${5:(0, 0, 0)};",
    }
    Metric "metric" {
        syntax: Syntax::Parametrized,
        parameters: ParameterCount::Exactly(2),
        category: Category::Metric,
        example: "metric h(u, v) = (1/v^2, 0, 1/v^2), u : [-2, 2], v : [1, 4];",
        purpose: "a surface given by its first fundamental form (E, F, G), seen from inside",
        snippet: "metric ${1:h}(${2:u}, ${3:v}) = (${4:1}, ${5:0}, ${6:1}),\n    ${2:u} : [${7:-1}, ${8:1}], ${3:v} : [${9:-1}, ${10:1}];",
    }
    Geodesic "geodesic" {
        syntax: Syntax::InSurface,
        parameters: ParameterCount::Exactly(1),
        category: Category::Curve,
        example: "geodesic g(t) : s = (1, 0) @ (0, 0), t : [0, 1];",
        purpose: "a geodesic: direction @ start, or (p, q) for the shortest one from p to q",
        snippet: "geodesic ${1:g}(${2:t}) : ${3:s} = (${4:1}, ${5:0}) @ (${6:0}, ${7:0}), ${2:t} : [0, ${8:1}];",
    }
    Solid "solid" {
        syntax: Syntax::Solid,
        parameters: ParameterCount::OfSpace,
        category: Category::Solid,
        example: "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1;",
        purpose: "the points where a function is not positive, or a set of solids: a | b, a & b, a \\ b, a @ v",
        snippet: "solid ${1:ball}(${2:x}, ${3:y}, ${4:z}) = ${5:x^2 + y^2 + z^2 - 1};",
    }
    Light "light" {
        syntax: Syntax::Light,
        parameters: ParameterCount::None,
        category: Category::Stage,
        example: "light lamp = @ (2, -2, 4);",
        purpose: "a light: @ position, direction, or direction @ position",
        snippet: "light ${1:lamp} = @ (${2:2}, ${3:-2}, ${4:4});",
    }
    Camera "camera" {
        syntax: Syntax::Anchored,
        parameters: ParameterCount::None,
        category: Category::Stage,
        example: "camera eye = (0, 4, -1) @ (0, -4, 1);",
        purpose: "a camera: direction @ position",
        snippet: "camera ${1:eye} = (${2:0}, ${3:4}, ${4:-1}) @ (${5:0}, ${6:-4}, ${7:1});",
    }
    Background "background" {
        syntax: Syntax::Background,
        parameters: ParameterCount::Optional,
        category: Category::Stage,
        example: "background sky(x, y, z) = (1 - z)(0.8, 0.9, 1) + z(0.1, 0.3, 0.6);",
        purpose: "a colour, or a colour for each direction, where no object is",
        snippet: "background ${1:sky} = (${2:0.8}, ${3:0.9}, ${4:1});",
    }
}

impl DeclarationKeyword {
    /// Returns the keyword's row of the table.
    #[inline]
    pub fn row(self) -> &'static DeclarationRow {
        &TABLE[self as usize]
    }

    /// Returns the keyword as written.
    pub fn text(self) -> &'static str {
        self.row().text
    }

    /// Returns the category of the declared name.
    pub fn category(self) -> Category {
        self.row().category
    }

    /// Returns true if the declared name is applied to operands, and false if it is a value. `states_parameters` is true
    /// if the declaration lists parameters.
    pub(crate) fn declares_function(self, states_parameters: bool) -> bool {
        match self.row().parameters {
            ParameterCount::None => false,
            ParameterCount::Optional => states_parameters,
            ParameterCount::AnyNumber | ParameterCount::Exactly(_) | ParameterCount::OfSpace => {
                true
            }
        }
    }

    /// Returns true if the declaration may list parameters.
    pub fn may_have_parameters(self) -> bool {
        self.declares_function(true)
    }

    /// Returns true if the word is a keyword only where a declaration may begin, and an ordinary word elsewhere.
    pub fn is_soft(self) -> bool {
        matches!(
            self,
            Self::Solid | Self::Light | Self::Camera | Self::Background
        )
    }

    /// Returns true if the declaration has an interval for each of its parameters.
    pub fn has_domain(self) -> bool {
        matches!(self.row().syntax, Syntax::Parametrized | Syntax::InSurface)
    }
}

#[cfg(test)]
mod tests {
    use super::{DeclarationKeyword, Syntax, TABLE};

    #[test]
    fn the_table_stands_in_the_order_of_the_keywords() {
        for (index, keyword) in DeclarationKeyword::ALL.into_iter().enumerate() {
            assert_eq!(keyword as usize, index);
            assert_eq!(keyword.row().keyword, keyword);
            assert_eq!(keyword.row(), &TABLE[index]);
            assert_eq!(DeclarationKeyword::from_text(keyword.text()), Some(keyword));
        }
        assert_eq!(DeclarationKeyword::from_text("Param"), None);
        assert_eq!(DeclarationKeyword::from_text(""), None);
    }

    #[test]
    fn each_row_agrees_with_itself() {
        for row in &TABLE {
            let opening = format!("{} ", row.text);
            assert!(row.example.starts_with(&opening), "{}", row.example);
            assert!(row.snippet.starts_with(&opening), "{}", row.snippet);
            assert!(row.example.ends_with(';') && row.snippet.ends_with(';'));
            let has_parameters = matches!(
                row.syntax,
                Syntax::Function | Syntax::Parametrized | Syntax::InSurface | Syntax::Solid
            );
            assert_eq!(row.keyword.declares_function(false), has_parameters);
            let may_have = has_parameters || row.syntax == Syntax::Background;
            assert_eq!(row.keyword.declares_function(true), may_have);
        }
    }
}
