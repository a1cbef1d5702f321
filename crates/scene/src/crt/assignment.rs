//! The values that a script's run assigns to names.

use syntax::span::Span;

use super::extent::{EntityExtent, extent};
use super::value::{LONGEST, ScriptValue};

/// An assignment to a name, or the binding of a parameter, at the end of the run.
#[derive(Clone, Debug)]
pub struct Assignment {
    /// The span of the name.
    pub span: Span,
    /// The number of times that the run has executed it.
    pub count: u32,
    /// The index of its last execution, counted over all assignments: of two assignments, the one with the greater
    /// index was executed later.
    pub last: u32,
    /// The value of the last execution, at top level the final value; `None` if it had an error.
    pub(super) value: Option<ScriptValue>,
}

impl Assignment {
    /// Returns the type of the value; `None` if it had an error.
    pub fn kind(&self) -> Option<&'static str> {
        self.value.as_ref().map(ScriptValue::kind)
    }

    /// Returns the value in the syntax of a script, truncated if it is long; empty if it had an error.
    pub fn text(&self) -> String {
        let value = self.value.as_ref();
        let mut text = value.map_or_else(String::new, ScriptValue::text);
        if let Some((end, _)) = text.char_indices().nth(LONGEST) {
            text.truncate(end);
            text.push('…');
        }
        text
    }

    /// Returns the value if it is an entity.
    pub fn entity(&self) -> Option<EntityExtent> {
        match &self.value {
            Some(ScriptValue::Entity(entity)) => Some(extent(entity)),
            _ => None,
        }
    }
}
