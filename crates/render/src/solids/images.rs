//! The images of faces. In: a request and its scene for rays. Out: colours at points.

use std::sync::Arc;

use geometry::solids::{FaceImage, ImagePart, RayScene};
use glam::DVec3;
use scene::{Object, ObjectId};

use crate::request::{PictureRequest, colour_nodes};
use crate::style;
use crate::texture::{Level, Sampler, SurfaceImage, Texture};

/// The images of the objects of a picture.
#[derive(Debug)]
pub(super) struct FaceImages {
    /// The images of whole objects, in the order of their numbers.
    objects: Vec<ObjectImage>,
    /// The images that attributes name, by their positions in [`RayScene::images`].
    stated: Vec<Option<Arc<Texture>>>,
}

/// The image of a whole object.
#[derive(Debug)]
struct ObjectImage {
    object: ObjectId,
    image: SurfaceImage,
    /// The linear colour that multiplies the image instead of that of the face.
    colour: Option<DVec3>,
}

impl FaceImages {
    /// Collects the images of the objects that a picture shows.
    pub(super) fn new(
        request: &PictureRequest,
        rays: &RayScene,
        shown: &dyn Fn(ObjectId) -> bool,
    ) -> Self {
        let image = |(id, object): (ObjectId, &Object)| {
            let chosen = match object.shape.is_surface() {
                true => request.own_texture(id).is_some() || colour_nodes(object).is_none(),
                false => request.chosen_texture(id).is_some(),
            };
            (chosen && shown(id)).then(|| ObjectImage {
                object: id,
                image: match object.shape.is_surface() && !places_image(object) {
                    true => request.image_in_space(id),
                    false => repeated(request.texture(id)),
                },
                colour: request
                    .shows_curvature_of(id)
                    .then(|| light(style::linear(request.srgb(id)))),
            })
        };
        let stated = rays.images().iter();
        let stated = stated.map(|word| request.image(word).map(|image| image.arc().clone()));
        Self {
            objects: request.scene.numbered().filter_map(image).collect(),
            stated: stated.collect(),
        }
    }

    /// Returns the linear colour of a part of the image of a face, and that which multiplies it.
    pub(super) fn colours(&self, face: FaceImage, part: &ImagePart<'_>) -> Option<[DVec3; 2]> {
        let objects = &self.objects;
        let (texture, repeats, colour) =
            match objects.binary_search_by_key(&face.object, |it| it.object) {
                Ok(found) => {
                    let ObjectImage { image, colour, .. } = &objects[found];
                    let texture = image.texture.of_instance(part.instance);
                    (texture, image.repeats, *colour)
                }
                Err(_) => (self.stated.get(face.stated?)?.as_ref()?, [true; 2], None),
            };
        let [across, along] = (part.sides)();
        let [at, across, along] = [part.at, across, along].map(|it| it.map(|x| x as f32));
        let sampler = Sampler::new(texture, [0.0; 2], [1.0; 2], repeats);
        let image = light(sampler.colour(at, across, along));
        Some([image, colour.unwrap_or(part.colour)])
    }
}

/// Returns true if an object states the position in its image.
fn places_image(object: &Object) -> bool {
    object.attributes.iter().any(|it| it.word == "uv")
}

/// Returns an image that repeats.
fn repeated(texture: Arc<Texture>) -> SurfaceImage {
    SurfaceImage {
        texture,
        repeats: [true; 2],
    }
}

/// Returns the colour of an image at a position in it as its file has it, sRGB from 0 to 1. Pixels are at integers; the
/// image is bilinear between them and repeats: for the backgrounds of scripts.
pub(super) fn stated_texel(texture: &Texture, place: [f64; 2]) -> DVec3 {
    let Level { size, texels } = &texture.levels()[0];
    let at = [0, 1].map(|k| place[k] * f64::from(size[k]));
    let [x, y] = at.map(f64::floor);
    let texel = |right: f64, down: f64| {
        let repeated = |at: f64, side: u32| at.rem_euclid(f64::from(side)) as usize;
        let [i, j] = [repeated(x + right, size[0]), repeated(y + down, size[1])];
        let [r, g, b, _] = texels[j * size[0] as usize + i];
        DVec3::new(r.into(), g.into(), b.into()) / 255.0
    };
    let [across, along] = [at[0] - x, at[1] - y];
    let above = texel(0.0, 0.0).lerp(texel(1.0, 0.0), across);
    let below = texel(0.0, 1.0).lerp(texel(1.0, 1.0), across);
    above.lerp(below, along)
}

/// Returns the linear colour of an image at a position in it: for backgrounds, whose left and right sides are glued.
pub(super) fn texel(texture: &Texture, place: [f64; 2]) -> DVec3 {
    let sampler = Sampler::new(texture, [0.0; 2], [1.0; 2], [true, false]);
    light(sampler.colour(place.map(|x| x as f32), [0.0; 2], [0.0; 2]))
}

fn light(linear: [f32; 3]) -> DVec3 {
    DVec3::from_array(linear.map(f64::from))
}
