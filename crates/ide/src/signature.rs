//! The signature of the function whose arguments are being written.

/// A function and its current parameter.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Signature {
    /// The function with its parameters: `f(x, y)`.
    pub label: String,
    /// The range of each parameter in the label, in bytes.
    pub parameters: Vec<(u32, u32)>,
    /// The index of the parameter that is being written, from 0; it may be beyond the last.
    pub active: u32,
    /// The kind of function: "surface", "builtin function".
    pub what: String,
}
