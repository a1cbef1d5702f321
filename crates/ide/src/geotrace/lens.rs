//! The views of each surface.

use syntax::geotrace::declarations::Category;

use super::analysis::GeotraceAnalysis;
use crate::lens::Lens;

/// The views of the surfaces and metrics, in the order of the text; a metric has no view in space.
pub fn lenses(analysis: &GeotraceAnalysis) -> Vec<Lens> {
    let items = analysis.items().filter(|item| item.symbol.is_some());
    let offered = items.flat_map(|item| {
        let lens = move |title, view, object| Lens {
            span: item.name_span,
            title,
            view,
            object,
        };
        let space = lens("3D", "3d", None);
        let inside = lens("inside view", "geodesic", Some(item.name.to_owned()));
        match item.keyword.category() {
            Category::Surface => vec![space, inside],
            Category::Metric => vec![inside],
            _ => Vec::new(),
        }
    });
    offered.collect()
}
