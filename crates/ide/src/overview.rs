//! A language on one page: its constructs, each with an example.

/// A row of the page.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct OverviewRow {
    /// An example.
    pub code: &'static str,
    /// Its meaning.
    pub text: &'static str,
}
