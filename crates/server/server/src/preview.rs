//! The preview window, as the commands `geotrace.preview` ask for it.

/// The command that opens a preview: its arguments are a document's URI and, perhaps, `{"view": "3d"}` or
/// `{"view": "geodesic", "surface": NAME}`.
pub(crate) const COMMAND: &str = "geotrace.preview";

/// What is asked for.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Wanted {
    /// The document.
    pub(crate) uri: String,
    /// "3d" or "geodesic", where one is named.
    pub(crate) view: Option<String>,
    /// The surface of a geodesic view.
    pub(crate) surface: Option<String>,
}

/// Opens a preview.
///
/// # Errors
/// A sentence for the user: this build has none.
pub(crate) fn open(wanted: &Wanted) -> Result<(), String> {
    let what = match (&wanted.view, &wanted.surface) {
        (Some(view), Some(surface)) if view == "geodesic" => format!(" --view geodesic:{surface}"),
        _ => String::new(),
    };
    let file = wanted.uri.rsplit('/').next().unwrap_or(&wanted.uri);
    Err(format!(
        "This build of geotrace has no preview window yet. `geotrace render {file} -o picture.png{what}` draws a picture."
    ))
}
