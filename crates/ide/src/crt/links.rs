//! The images that a script names.

use super::CrtAnalysis;
use crate::link::FileLink;

/// Returns the image files, in the order of the text. A leading `/` is dropped, as the paths are relative to the script; paths
/// with `..` are omitted.
pub(super) fn links(analysis: &CrtAnalysis) -> Vec<FileLink> {
    let images = analysis.names().images.iter();
    let links = images.map(|(span, path)| FileLink {
        span: *span,
        path: path.trim_start_matches('/').to_owned(),
    });
    let mut links: Vec<FileLink> = links
        .filter(|link| !link.path.is_empty() && !link.path.split(['/', '\\']).any(|it| it == ".."))
        .collect();
    links.sort_by_key(|link| link.span);
    links
}
