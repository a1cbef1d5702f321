//! The values that the run of a script gives to names.

use syntax::span::Span;

use super::extent::{EntityExtent, extent};
use super::value::{LONGEST, ScriptValue};

/// A place where a name is assigned, or a parameter is given a value, as the run has left it.
#[derive(Clone, Debug)]
pub struct Assignment {
    /// The span of the name.
    pub span: Span,
    /// The number of times that the run has come there.
    pub count: u32,
    /// The number of the last of them, counted over all places: of two places, the greater one was assigned later.
    pub last: u32,
    /// The value of the last time, and at top level that of the end; `None` where it had an error.
    pub(super) value: Option<ScriptValue>,
}

impl Assignment {
    /// Returns the type of the value; `None` where that had an error.
    pub fn kind(&self) -> Option<&'static str> {
        self.value.as_ref().map(ScriptValue::kind)
    }

    /// Returns the value as a script writes it, as far as it is short; empty where it had an error.
    pub fn text(&self) -> String {
        let value = self.value.as_ref();
        let mut text = value.map_or_else(String::new, ScriptValue::text);
        if let Some((end, _)) = text.char_indices().nth(LONGEST) {
            text.truncate(end);
            text.push('…');
        }
        text
    }

    /// Returns the entity that is the value.
    pub fn entity(&self) -> Option<EntityExtent> {
        match &self.value {
            Some(ScriptValue::Entity(entity)) => Some(extent(entity)),
            _ => None,
        }
    }
}
