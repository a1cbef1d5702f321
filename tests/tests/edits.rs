//! Random edits through the language server: after every one, what it says is what the text alone says.

use testing::random_edits::session;

/// Edits of each session; there is a session for each encoding, and one for an editor that asks for diagnostics.
/// `geotrace-fuzz --full` makes 100,000 in each encoding.
const EDITS: usize = 8_000;

#[tokio::test]
async fn the_server_says_what_the_text_alone_says_in_bytes() {
    session("utf-8", false, 11, EDITS).await;
}

#[tokio::test]
async fn the_server_says_what_the_text_alone_says_in_code_units() {
    session("utf-16", false, 12, EDITS).await;
}

#[tokio::test]
async fn the_server_says_what_the_text_alone_says_in_characters() {
    session("utf-32", false, 13, EDITS).await;
}

#[tokio::test]
async fn pulled_diagnostics_equal_those_of_the_text_alone() {
    session("utf-16", true, 14, EDITS).await;
}
