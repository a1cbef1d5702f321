//! The looks of faces.
//!
//! In: the attributes of an object or of a leaf, and a point on one of its faces. Out: colours, mirror, glass and
//! slopes there, linear and within their ranges.

use std::sync::OnceLock;

use expr::tape::Tape;
use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DVec3};
use scene::ObjectId;
use tracer::PictureLook;
use tracer::shade::{Face, FaceLook, Glass};

use super::SheetFace;
use super::attributes::{AttributeNumbers, AttributeSet, NumberAttribute as A, evaluated};

/// Returns the linear colour of a face that has an image, at a part of the image; `None` without an image: then it is the
/// face's own.
pub type Paint<'a> = dyn Fn(FaceImage, &ImagePart<'_>) -> Option<DVec3> + Sync + 'a;

/// A part of an image.
pub struct ImagePart<'a> {
    /// The middle, from (0, 0), the top left, to (1, 1).
    pub at: [f64; 2],
    /// Returns the sides of a parallelogram around it, 0 for a point.
    pub sides: &'a dyn Fn() -> [[f64; 2]; 2],
    /// The face's own linear colour, which usually multiplies the image.
    pub colour: DVec3,
    /// The instance of a surface; 0 for a solid, all instances of which have one image.
    pub instance: u64,
}

/// Returns the linear colour of the background's image at a point of it, as [`Paint`] does for faces.
pub type BackgroundImage<'a> = dyn Fn([f64; 2]) -> DVec3 + Sync + 'a;

/// The sides of a part that is a point.
const POINT: [[f64; 2]; 2] = [[0.0; 2]; 2];

/// The image of a face.
#[derive(Clone, Copy, Debug)]
pub struct FaceImage {
    /// The object, which may have its own image.
    pub object: ObjectId,
    /// The image that the face's attributes name, as an index into [`RayScene::images`](super::RayScene::images).
    pub stated: Option<usize>,
}

/// The look of the faces of an object, or of those that a leaf owns.
#[derive(Debug)]
pub(super) struct LookProgram {
    pub(super) object: String,
    image: Option<FaceImage>,
    picture_look: PictureLook,
    /// The linear colour, unless it is stated, where it is not glass.
    opaque_colour: DVec3,
    pub(super) attributes: AttributeSet,
    /// σu and σv of a parametric surface that has a height or an image.
    slopes: Option<Tape>,
    is_glass: bool,
}

/// A point of a face in the coordinates of its attributes.
#[derive(Debug)]
pub(super) enum FacePlace {
    /// The look, and the position in an image, are the same everywhere, once known.
    Anywhere(OnceLock<Box<(FaceLook, Option<DVec3>)>>),
    /// For each group of attributes, the map from the scene's coordinates.
    Within(Box<[DAffine3]>),
    /// On a part of a curve: the map from the scene's coordinates to those in which z runs from −1 to 1, and the parameter
    /// at both ends.
    Along(Box<(DAffine3, [f64; 2])>),
}

impl LookProgram {
    /// Creates the look of the faces of an object whose colour is `colour`, in sRGB, unless it states one.
    pub(super) fn new(
        object: &str,
        image: Option<FaceImage>,
        picture_look: PictureLook,
        colour: DVec3,
        attributes: AttributeSet,
    ) -> Self {
        Self {
            object: object.to_owned(),
            image,
            picture_look,
            opaque_colour: picture_look.light(colour),
            is_glass: attributes.states(A::Glass),
            attributes,
            slopes: None,
        }
    }

    /// Adds what the slopes of a height, and the footprints of an image, need on a parametric surface.
    pub(super) fn on_surface(mut self, graph: &Graph, position: &[NodeId; 3]) -> Self {
        if self.attributes.states(A::Bump) || self.image.is_some() {
            let (mut graph, roots) = graph.extract(position);
            let mut slopes = Vec::new();
            for k in 0..2 {
                slopes.extend(
                    graph
                        .derivatives(&roots, Input::Variable(k))
                        .unwrap_or_default(),
                );
            }
            self.slopes = (slopes.len() == 6).then(|| Tape::new(&graph, &slopes));
        }
        self
    }

    /// Returns the coordinates for the faces of an instance of a solid's leaf.
    pub(super) fn place(&self, uniforms: &[f64]) -> FacePlace {
        if self.attributes.varies() {
            FacePlace::Within(self.attributes.frames(uniforms).into())
        } else {
            FacePlace::anywhere()
        }
    }

    /// Returns the glass that the leaf makes of its solid; `None` if it is opaque.
    pub(super) fn glass(&self, uniforms: &[f64]) -> Option<Glass> {
        if !self.is_glass {
            return None;
        }
        let mut glass = Glass::default();
        let mut share = None;
        // The other attributes are not evaluated at 0: no face need be there.
        self.attributes.of(
            |attribute| matches!(attribute, A::Ior | A::Depth | A::Glass),
            uniforms,
            |_| [0.0; 3],
            |numbers| match numbers.attribute {
                A::Ior => glass.ior = numbers.number(),
                A::Depth => glass.depth = numbers.number(),
                A::Glass => share = Some(numbers.number()),
                _ => {}
            },
        );
        // An attribute that depends on the point may be glass elsewhere.
        let opaque = share == Some(0.0) && !self.attributes.varies_by(A::Glass);
        (!opaque).then_some(glass)
    }

    /// Returns true if it is opaque everywhere.
    pub(super) fn is_opaque(&self) -> bool {
        !self.is_glass
    }

    /// Returns the attributes that depend on the point but apply to a whole solid.
    pub(super) fn uneven(&self) -> impl Iterator<Item = &'static str> + '_ {
        let words = [(A::Ior, "ior"), (A::Depth, "depth")];
        let uneven = words
            .into_iter()
            .filter(|(attribute, _)| self.attributes.varies_by(*attribute));
        uneven.map(|(_, word)| word)
    }

    /// Returns the look of a solid's face; `entering` is true where it is seen from outside.
    pub(super) fn solid(
        &self,
        uniforms: &[f64],
        place: &FacePlace,
        face: &Face,
        entering: bool,
        paint: &Paint<'_>,
    ) -> FaceLook {
        if let FacePlace::Anywhere(known) = place {
            let (look, image) = &**known.get_or_init(|| {
                let (mut look, mut image) = (self.plain(), None);
                let nowhere = |_| [f64::NAN; 3];
                self.attributes
                    .at(uniforms, nowhere, |numbers| match numbers.attribute {
                        A::Uv => image = Some(numbers.vector()),
                        _ => self.apply(&mut look, numbers),
                    });
                Box::new((look, image))
            });
            let image = image.map(|at| [at.x, at.y]);
            return self.painted(*look, image, &|| POINT, 0, paint);
        }
        let variables = |group: usize| place.variables(face.position, group);
        let side = if entering { 1.0 } else { -1.0 };
        let mut look = self.plain();
        let mut image = None;
        self.attributes.at(uniforms, variables, |numbers| {
            match (numbers.attribute, place) {
                (A::Bump, FacePlace::Within(frames)) => {
                    let frame = frames[numbers.group].matrix3;
                    look.bump = side * (frame.transpose() * numbers.vector());
                }
                (A::Uv, _) => image = Some(numbers.vector()),
                _ => self.apply(&mut look, numbers),
            }
        });
        let image = image.map(|at| [at.x, at.y]);
        let sides = || {
            let Some(middle) = image else { return POINT };
            face.footprint().map(|side| {
                let beside = face.position + side;
                self.image_side(uniforms, middle, |group| place.variables(beside, group))
            })
        };
        self.painted(look, image, &sides, 0, paint)
    }

    /// Returns the colour near a solid's face, at a point that may be on no face; `None` where it is undefined.
    pub(super) fn colour_beside(
        &self,
        uniforms: &[f64],
        place: &FacePlace,
        position: DVec3,
        paint: &Paint<'_>,
    ) -> Option<DVec3> {
        let (mut look, mut image) = (self.plain(), None);
        let is_defined = self.attributes.beside(
            |attribute| matches!(attribute, A::Colour | A::Glass | A::Uv),
            uniforms,
            |group| place.variables(position, group),
            |numbers| match numbers.attribute {
                A::Uv => image = Some([numbers.vector().x, numbers.vector().y]),
                _ => self.apply(&mut look, numbers),
            },
        );
        let colour = || self.painted(look, image, &|| POINT, 0, paint).colour;
        is_defined.then(colour)
    }

    /// Returns the look of a parametric surface's face at its parameters.
    pub(super) fn sheet(
        &self,
        sheet: &SheetFace,
        uv: [f64; 2],
        face: &Face,
        paint: &Paint<'_>,
    ) -> FaceLook {
        let (uniforms, domain) = (&*sheet.uniforms, sheet.domain);
        let [u, v] = uv;
        let mut look = self.plain();
        let mut image = None;
        let place = |_| [u, v, f64::NAN];
        self.attributes
            .at(uniforms, place, |numbers| match numbers.attribute {
                A::Bump => {
                    if let Some(tape) = &self.slopes {
                        let [along_u, along_v] = evaluated(tape, &uv, uniforms, |out| {
                            [&out[..3], &out[3..]].map(DVec3::from_slice)
                        });
                        let height = numbers.vector();
                        look.bump = slope(along_u, along_v, [height.x, height.y], face.normal);
                    }
                }
                A::Uv => image = Some(numbers.vector()),
                _ => self.apply(&mut look, numbers),
            });
        let shares = [0, 1].map(|k| (uv[k] - domain[k][0]) / (domain[k][1] - domain[k][0]));
        let stated = image.map(|at| [at.x, at.y]);
        let sides = || {
            let Some(tape) = &self.slopes else {
                return POINT;
            };
            let tangents = evaluated(tape, &uv, uniforms, |out| {
                [&out[..3], &out[3..]].map(DVec3::from_slice)
            });
            face.footprint().map(|side| {
                let step = components(tangents, side);
                match stated {
                    Some(middle) => {
                        let beside = [u + step[0], v + step[1], f64::NAN];
                        self.image_side(uniforms, middle, |_| beside)
                    }
                    None => [0, 1].map(|k| step[k] / (domain[k][1] - domain[k][0])),
                }
            })
        };
        let at = Some(stated.unwrap_or(shares));
        self.painted(look, at, &sides, sheet.instance, paint)
    }

    /// Returns the vector in the image from `middle` to its place at other coordinates, on the shortest way: images repeat.
    fn image_side(
        &self,
        uniforms: &[f64],
        middle: [f64; 2],
        variables: impl Fn(usize) -> [f64; 3],
    ) -> [f64; 2] {
        let mut side = [0.0; 2];
        let is_uv = |attribute| attribute == A::Uv;
        self.attributes
            .beside(is_uv, uniforms, variables, |numbers| {
                let at = numbers.vector();
                side = [at.x - middle[0], at.y - middle[1]].map(|way| way - way.round());
            });
        side
    }

    pub(super) fn plain(&self) -> FaceLook {
        FaceLook {
            colour: match self.is_glass {
                true => DVec3::ONE,
                false => self.opaque_colour,
            },
            ..FaceLook::default()
        }
    }

    /// Writes an attribute into a look.
    pub(super) fn apply(&self, look: &mut FaceLook, numbers: &AttributeNumbers) {
        let number = numbers.number();
        match numbers.attribute {
            A::Colour => look.colour = self.picture_look.light(numbers.vector()),
            A::Mirror => look.mirror = numbers.vector(),
            A::Glass => {
                look.glass = number;
                // It is not glass, unless it is elsewhere.
                let is_opaque = number == 0.0 && !self.attributes.varies_by(A::Glass);
                if is_opaque && !self.attributes.states(A::Colour) {
                    look.colour = self.opaque_colour;
                }
            }
            A::Diffuse => look.diffuse = Some(number),
            A::Specular => look.specular = number,
            A::Shininess => look.shininess = number,
            _ => {}
        }
    }

    fn painted(
        &self,
        mut look: FaceLook,
        at: Option<[f64; 2]>,
        sides: &dyn Fn() -> [[f64; 2]; 2],
        instance: u64,
        paint: &Paint<'_>,
    ) -> FaceLook {
        let colour = look.colour;
        let part = |at| ImagePart {
            at,
            sides,
            colour,
            instance,
        };
        if let (Some(image), Some(at)) = (self.image, at)
            && let Some(colour) = paint(image, &part(at))
        {
            look.colour = colour;
        }
        look
    }
}

impl FacePlace {
    /// Returns the coordinates of a look that is the same everywhere.
    pub(super) fn anywhere() -> Self {
        Self::Anywhere(OnceLock::new())
    }

    /// Returns the coordinates of a point for a group of attributes.
    fn variables(&self, position: DVec3, group: usize) -> [f64; 3] {
        match self {
            Self::Anywhere(_) => [f64::NAN; 3],
            Self::Within(frames) => frames[group].transform_point3(position).to_array(),
            Self::Along(along) => {
                let (map, [from, to]) = &**along;
                let z = map.transform_point3(position).z;
                let share = (0.5 + 0.5 * z).clamp(0.0, 1.0);
                [from + share * (to - from), f64::NAN, f64::NAN]
            }
        }
    }
}

/// Returns the components along u and v of a vector in the plane of the tangents σu and σv; 0 where they span none.
fn components([along_u, along_v]: [DVec3; 2], vector: DVec3) -> [f64; 2] {
    let normal = along_u.cross(along_v);
    let across = normal / normal.length_squared();
    let components = [vector.cross(along_v), along_u.cross(vector)].map(|area| area.dot(across));
    if components.iter().all(|c| c.is_finite()) {
        components
    } else {
        [0.0; 2]
    }
}

/// Returns the gradient on a surface of a height with these derivatives by u and v, on the side of a normal; 0 where the
/// surface has no tangent plane.
fn slope(along_u: DVec3, along_v: DVec3, [by_u, by_v]: [f64; 2], normal: DVec3) -> DVec3 {
    let (e, f, g) = (
        along_u.length_squared(),
        along_u.dot(along_v),
        along_v.length_squared(),
    );
    let determinant = e * g - f * f;
    let gradient =
        ((g * by_u - f * by_v) * along_u + (e * by_v - f * by_u) * along_v) / determinant;
    let side = along_u.cross(along_v).dot(normal).signum();
    if gradient.is_finite() {
        side * gradient
    } else {
        DVec3::ZERO
    }
}
