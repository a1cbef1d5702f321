//! What can be looked at: the views of each surface.

use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;

use crate::reading::Reading;

/// A view that a line above a declaration offers.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Lens {
    /// The declaration's name, above whose line it stands.
    pub span: Span,
    /// "3D", "inside view".
    pub title: &'static str,
    /// Which view.
    pub view: LensView,
    /// The object's name.
    pub object: String,
}

/// The views of an object.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum LensView {
    /// In space.
    Space,
    /// From inside.
    Inside,
}

/// The views of the surfaces and metrics, in the order of the text; a metric is seen from inside only.
pub fn lenses(reading: &Reading) -> Vec<Lens> {
    let items = reading.items().filter(|item| item.symbol.is_some());
    items
        .flat_map(|item| {
            let views: &[(LensView, &str)] = match item.word {
                DeclarationKeyword::Surface => {
                    &[(LensView::Space, "3D"), (LensView::Inside, "inside view")]
                }
                DeclarationKeyword::Metric => &[(LensView::Inside, "inside view")],
                _ => &[],
            };
            views.iter().map(move |&(view, title)| Lens {
                span: item.name_span,
                title,
                view,
                object: item.name.to_owned(),
            })
        })
        .collect()
}
