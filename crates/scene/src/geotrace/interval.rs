//! Intervals: from the expressions between `[` and `]` to finite, ordered numbers.

use expr::number;
use expr::value::Value;
use syntax::diagnostic::Diagnostic;
use syntax::geotrace::actions::{self, IntervalKind};
use syntax::geotrace::declarations::DeclarationKeyword;

use crate::geotrace::code::Expression;
use crate::geotrace::error::{self, SemanticError};
use crate::geotrace::lowerer::{Lowered, Lowerer};
use crate::limits::{MAX_AXIS, MAX_SAMPLES};
use crate::scene::{Range, Sampling};

/// An interval as read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeclaredInterval {
    pub(crate) read: actions::Interval,
    ends: [Expression; 2],
    count: Option<Expression>,
}

/// The owner of an interval, which determines the limit of its count and the hint of an error.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Purpose {
    Param,
    Grid,
    /// The domain of a curve, a surface, a metric or a geodesic.
    Domain,
    /// A cut of a solid.
    Cut,
}

impl Purpose {
    /// Returns the hint for an interval that depends on a name.
    fn constant_hint(self, role: Role, name: &str) -> String {
        if let Role::Count = role {
            return "write the count as a number: samples do not depend on params or grids"
                .to_owned();
        }
        match self {
            Self::Param => format!(
                "keep the interval constant and scale in a define, as in `param share : [0, 1]; define scaled = {name} share;`"
            ),
            Self::Grid => format!(
                "keep the interval constant and scale in a define, as in `grid share : [0, 1, 5]; define scaled = {name} share;`"
            ),
            Self::Domain => {
                format!("keep the interval constant and scale inside, as in `c({name} t)`")
            }
            Self::Cut => format!(
                "keep the interval constant and cut the solid by a set, as in `solid part = s & slab;` with `solid slab(x, y, z) = abs x - {name};`"
            ),
        }
    }
}

/// The numbers of an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) range: Range,
    /// The number of values, if the interval has one.
    pub(crate) count: Option<u32>,
}

impl DeclaredInterval {
    /// Returns the interval whose expressions are the last ones read; `None` if they are incomplete.
    pub(crate) fn last(lowerer: &Lowerer, read: actions::Interval) -> Option<Self> {
        let code = &lowerer.code;
        let (ends, count) = match read.kind {
            IntervalKind::Range => (code.last_before(code.end())?, None),
            IntervalKind::Grid => {
                let [min, max, count] = code.last_before(code.end())?;
                ([min, max], Some(count))
            }
        };
        Some(Self { read, ends, count })
    }

    /// Returns the step at which its first expression starts.
    pub(crate) fn start(&self) -> usize {
        self.ends[0].steps().start
    }

    /// Returns the interval's numbers; `None` after an error, which is added to `diagnostics`.
    pub(crate) fn bounds(
        &self,
        lowerer: &mut Lowerer,
        purpose: Purpose,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Bounds> {
        let roles = [
            (Some(self.ends[0]), Role::Minimum),
            (Some(self.ends[1]), Role::Maximum),
            (self.count, Role::Count),
        ];
        let mut numbers = [None; 3];
        for ((expression, role), number) in roles.into_iter().zip(&mut numbers) {
            let Some(expression) = expression else {
                continue;
            };
            // An error inside an expression has its own span and has been reported there.
            let before = diagnostics.len();
            let lowered = lowerer.lower(expression, Vec::new(), diagnostics);
            if diagnostics.len() > before {
                return None;
            }
            match constant(lowerer, &lowered, role, purpose) {
                Ok(value) => *number = Some(value?),
                Err(error) => {
                    diagnostics.push(error.at(self.read.span));
                    return None;
                }
            }
        }
        let [Some(min), Some(max), count] = numbers else {
            return None;
        };
        let result = in_order(min, max).and_then(|range| {
            let count = count.map(|count| whole(count, purpose)).transpose()?;
            Ok(Bounds { range, count })
        });
        match result {
            Ok(bounds) => Some(bounds),
            Err(error) => {
                diagnostics.push(error.at(self.read.span));
                None
            }
        }
    }
}

impl Bounds {
    /// Returns the interval with its count, or with `default` if it has none.
    pub(crate) fn sampling(self, default: u32) -> Sampling {
        Sampling {
            range: self.range,
            count: self.count.unwrap_or(default),
        }
    }
}

/// The role of a number in an interval.
#[derive(Clone, Copy, Debug)]
enum Role {
    Minimum,
    Maximum,
    Count,
}

impl Role {
    fn name(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Count => "count",
        }
    }
}

/// Returns the value of an expression of an interval, which must be a finite number; `None` if it uses a name whose
/// declaration failed.
fn constant(
    lowerer: &Lowerer,
    lowered: &Lowered,
    role: Role,
    purpose: Purpose,
) -> Result<Option<f64>, SemanticError> {
    if let Some(symbol) = lowerer.dependencies.first(lowered.dependencies) {
        let word = match lowerer.symbols.keyword(symbol) {
            Some(DeclarationKeyword::Grid) => "grid",
            _ => "param",
        };
        let name = lowerer.symbols.name(symbol);
        return Err(SemanticError::new(
            error::INTERVAL_NOT_CONSTANT,
            format!(
                "an interval is constant, but the {} of this one depends on the {word} `{name}`",
                role.name()
            ),
        )
        .with_hint(purpose.constant_hint(role, name)));
    }
    let node = match &lowered.value {
        None => return Ok(None),
        Some(Value::Number(node)) => *node,
        Some(vector) => {
            return Err(SemanticError::new(
                error::INTERVAL_NOT_NUMBER,
                format!(
                    "the {} of an interval is a number, not a vector of dimension {}",
                    role.name(),
                    vector.dimension()
                ),
            ));
        }
    };
    let number = lowerer.graph.value(node);
    let number = number.unwrap_or_else(|| lowerer.numbers(&[node])[0]);
    if number.is_finite() {
        return Ok(Some(number));
    }
    let what = if number.is_nan() {
        "undefined"
    } else {
        "infinite"
    };
    Err(SemanticError::new(
        error::INTERVAL_UNDEFINED,
        format!("the {} of this interval is {what}", role.name()),
    ))
}

fn in_order(min: f64, max: f64) -> Result<Range, SemanticError> {
    if min < max {
        return Ok(Range { min, max });
    }
    let error = SemanticError::new(
        error::INTERVAL_EMPTY,
        format!(
            "the minimum of this interval, {}, is not below its maximum, {}",
            number::text(min),
            number::text(max)
        ),
    );
    Err(if min == max {
        error
    } else {
        error.with_hint("write the smaller end first")
    })
}

/// Returns a count, rounded down.
fn whole(count: f64, purpose: Purpose) -> Result<u32, SemanticError> {
    let largest = match purpose {
        Purpose::Param | Purpose::Grid => MAX_AXIS,
        Purpose::Domain | Purpose::Cut => MAX_SAMPLES as u32,
    };
    let rounded = count.floor();
    if rounded < 2.0 {
        return Err(SemanticError::new(
            error::INTERVAL_COUNT,
            format!(
                "an interval has at least 2 values, but the count of this one is {}",
                number::text(count)
            ),
        )
        .with_hint("both ends are included"));
    }
    if rounded > f64::from(largest) {
        return Err(SemanticError::new(
            error::INTERVAL_COUNT,
            format!(
                "the count of this interval is {}, and the limit is {largest}",
                number::text(count)
            ),
        ));
    }
    Ok(rounded as u32)
}
