//! Looks that depend on the point, as expressions.
//!
//! In: the look of a leaf's faces. Out: the attributes that are the same everywhere, and expressions for the others, each in
//! its own coordinates, for evaluators other than [`RayScene::look`](super::RayScene::look).

use expr::{Graph, NodeId};
use glam::DAffine3;
use tracer::shade::FaceLook;

use super::attributes::NumberAttribute as A;
use super::look::{FacePlace, LookProgram};

/// The look of the faces of a leaf, which depends on the point.
#[derive(Debug)]
pub struct VaryingLook<'a> {
    /// The look without the attributes that depend on the point.
    pub base: FaceLook,
    /// The attributes that depend on the point.
    pub lists: Vec<VaryingList<'a>>,
    /// The numbers of the uniforms.
    pub uniforms: &'a [f64],
}

/// Attributes that are stated in the same coordinates.
#[derive(Debug)]
pub struct VaryingList<'a> {
    /// The graph of the expressions, whose variables are the coordinates.
    pub graph: &'a Graph,
    /// Each attribute with its numbers: one or three.
    pub attributes: Vec<(VaryingAttribute, Vec<NodeId>)>,
    /// The coordinates.
    pub place: VaryingPlace,
    /// True if colours may exceed 1.
    pub bright: bool,
}

/// An attribute of a face that may depend on the point.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum VaryingAttribute {
    /// The stated colour.
    Colour,
    /// The fraction that is reflected, by colour.
    Mirror,
    /// The fraction that is reflected or refracted.
    Glass,
    /// The fraction that is scattered.
    Diffuse,
    /// The strength of the highlight.
    Specular,
    /// The sharpness of the highlight.
    Shininess,
    /// The derivatives of the height by the coordinates.
    Bump,
}

/// The coordinates of expressions.
#[derive(Clone, Copy, Debug)]
pub enum VaryingPlace {
    /// The image of the scene's coordinates under this map.
    Within(DAffine3),
    /// The parameter of a curve, which runs from the first number to the second one while z, after this map from the
    /// scene's coordinates, runs from −1 to 1.
    Along(DAffine3, [f64; 2]),
}

impl LookProgram {
    /// Returns the look as expressions; `None` if it is the same everywhere. `Err` if it uses an image with stated
    /// positions.
    pub(super) fn varying<'a>(
        &'a self,
        uniforms: &'a [f64],
        place: &FacePlace,
    ) -> Option<Result<VaryingLook<'a>, VaryingImage>> {
        if let FacePlace::Anywhere(_) = place {
            return None;
        }
        let attributes = &self.attributes;
        if attributes.states(A::Uv) {
            return Some(Err(VaryingImage));
        }
        let mut lists = Vec::new();
        for found in attributes.varying() {
            let stated = found.attributes.into_iter();
            let stated = stated.filter_map(|(attribute, numbers)| {
                let attribute = match attribute {
                    A::Colour => VaryingAttribute::Colour,
                    A::Mirror => VaryingAttribute::Mirror,
                    A::Glass => VaryingAttribute::Glass,
                    A::Diffuse => VaryingAttribute::Diffuse,
                    A::Specular => VaryingAttribute::Specular,
                    A::Shininess => VaryingAttribute::Shininess,
                    // Bodies have no height.
                    A::Bump if matches!(place, FacePlace::Within(_)) => VaryingAttribute::Bump,
                    _ => return None,
                };
                let coloured = [VaryingAttribute::Colour, VaryingAttribute::Mirror];
                let numbers = match numbers {
                    [one] if coloured.contains(&attribute) => vec![*one; 3],
                    numbers => numbers.to_vec(),
                };
                Some((attribute, numbers))
            });
            lists.push(VaryingList {
                graph: found.graph,
                attributes: stated.collect(),
                place: match place {
                    FacePlace::Along(along) => VaryingPlace::Along(along.0, along.1),
                    FacePlace::Within(frames) => VaryingPlace::Within(frames[found.group]),
                    FacePlace::Anywhere(_) => VaryingPlace::Within(DAffine3::IDENTITY),
                },
                bright: attributes.is_bright(),
            });
        }
        let mut base = self.plain();
        attributes.constant(uniforms, |numbers| self.apply(&mut base, numbers));
        Some(Ok(VaryingLook {
            base,
            lists,
            uniforms,
        }))
    }
}

/// The look uses an image with stated positions.
#[derive(Clone, Copy, Debug)]
pub struct VaryingImage;
