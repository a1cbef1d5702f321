//! The views of each surface, metric, solid and camera.

use syntax::geotrace::declarations::{Category, DeclarationKeyword};

use super::analysis::GeotraceAnalysis;
use super::solid;
use crate::lens::Lens;

/// Returns the views of surfaces, metrics, solids and cameras, in the order of the text. A metric has no view in space, and a
/// solid that is a part of others is not drawn separately.
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
        let inside = lens("geodesic view", "geodesic", Some(item.name.to_owned()));
        let traced = |camera: Option<String>| lens("traced", "traced", camera);
        match item.keyword.category() {
            Category::Surface => vec![space, inside],
            Category::Metric => vec![inside],
            Category::Solid if solid::whole(analysis, &item).is_none() => {
                vec![space, inside, traced(None)]
            }
            Category::Stage if item.keyword == DeclarationKeyword::Camera => {
                vec![traced(Some(item.name.to_owned()))]
            }
            _ => Vec::new(),
        }
    });
    offered.collect()
}
