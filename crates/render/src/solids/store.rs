//! A cache of scenes for rays, from one picture to the next.

use std::sync::{Arc, OnceLock};

use geometry::solids::{
    BackgroundImage, FaceImage, FaceOwner, ImagePart, RayFault, RayNote, RayScene, RaySceneOptions,
    StandardLights, srgb,
};
use glam::DVec3;
use scene::{ObjectId, Scene};
use tracer::camera::LensCamera;
use tracer::shade::{Face, FaceLook, Scenery};
use tracer::{PictureLook, World};

use crate::content::Content;
use crate::declared_camera::declared_lens;
use crate::placement::Placement;
use crate::request::PictureRequest;
use crate::shared::Shared;
use crate::style;
use crate::texture::Texture;

use super::images::{FaceImages, stated_texel, texel};
use super::tables::SceneTables;

/// The solids of the last pictures.
#[derive(Debug, Default)]
pub(crate) struct SolidStore {
    /// The solids of the 3D view, with their contents.
    solids: Option<(ShownContents, Arc<SolidScene>)>,
    /// The solid of the geodesic view, with its content.
    inside: Option<(ShownContents, Arc<SolidScene>)>,
    traced: Option<(TracedKey, Arc<TracedScene>)>,
    /// The number of scenes that were prepared for rays.
    pub(crate) built: u64,
}

/// The solids that a picture shows, and the images.
type ShownContents = (Vec<ShownSolid>, ImagesKey);

/// A solid that a picture shows. Notes contain the names of the solid and of its coordinates.
#[derive(Clone, Debug, PartialEq)]
struct ShownSolid {
    id: ObjectId,
    name: String,
    parameters: Option<Arc<[Box<str>]>>,
    content: Content,
}

impl ShownSolid {
    fn new(scene: &Scene, id: ObjectId, content: Content) -> Self {
        let object = scene.get(id);
        let solid = object.and_then(|object| object.shape.solid());
        Self {
            id,
            name: object.map_or_else(String::new, |object| object.name.clone()),
            parameters: solid.and_then(|solid| solid.parameters.clone()),
            content,
        }
    }
}

/// The images of objects: those that were chosen, and those that the program names.
type ImagesKey = (
    Vec<(ObjectId, Shared<Texture>)>,
    Vec<(String, Shared<Texture>)>,
);

fn images_of(request: &PictureRequest) -> ImagesKey {
    (request.textures.clone(), request.images.clone())
}

/// The solids of a scene, for the 3D view.
#[derive(Debug)]
pub(crate) struct SolidScene {
    rays: RayScene,
    images: FaceImages,
    /// The object of each solid of the world.
    objects: Vec<ObjectId>,
}

/// Everything that is shown of a scene in the traced view.
#[derive(Debug)]
pub(crate) struct TracedScene {
    rays: RayScene,
    images: FaceImages,
    /// The image of the declared background.
    background: Option<Arc<Texture>>,
    /// The colours of the sky overhead and underfoot, sRGB from 0 to 1.
    sky: DVec3,
    tables: OnceLock<Result<SceneTables, String>>,
}

/// Everything on which a scene for the traced view depends.
#[derive(Clone, Debug, PartialEq)]
struct TracedKey {
    scene: Shared<Scene>,
    params: Arc<scene::ParamValues>,
    hidden: Vec<ObjectId>,
    colours: Vec<[u8; 3]>,
    images: ImagesKey,
    background_image: Option<Shared<Texture>>,
    flipped: Vec<ObjectId>,
    placement: Placement,
    scale: f32,
    backdrop: [u8; 3],
    picture_look: PictureLook,
}

impl SolidStore {
    /// Returns the solids that a request of the 3D view shows, without the hidden ones; `None` if there are none. `contents`
    /// are those of the scene's objects.
    pub(crate) fn get(
        &mut self,
        request: &PictureRequest,
        hidden: &[ObjectId],
        contents: &[Content],
    ) -> Option<Arc<SolidScene>> {
        let objects = request.scene.numbered().zip(contents);
        let shown = objects
            .filter(|((id, object), _)| object.shape.solid().is_some() && !hidden.contains(id));
        let shown =
            shown.map(|((id, _), content)| ShownSolid::new(&request.scene, id, content.clone()));
        let shown: Vec<ShownSolid> = shown.collect();
        if shown.is_empty() {
            return None;
        }
        Some(kept(&mut self.solids, &mut self.built, request, shown))
    }

    /// Returns the solid on which the camera of a geodesic view is, with this content.
    pub(crate) fn inside(
        &mut self,
        request: &PictureRequest,
        id: ObjectId,
        content: Content,
    ) -> Arc<SolidScene> {
        let shown = vec![ShownSolid::new(&request.scene, id, content)];
        kept(&mut self.inside, &mut self.built, request, shown)
    }

    /// Returns everything that a request of the traced view shows, without hidden objects, in these drawing units and with
    /// these formulas.
    pub(crate) fn traced(
        &mut self,
        request: &PictureRequest,
        hidden: &[ObjectId],
        placement: &Placement,
        picture_look: PictureLook,
    ) -> Arc<TracedScene> {
        let key = TracedKey {
            scene: request.scene.clone(),
            params: request.params.clone(),
            hidden: hidden.to_vec(),
            colours: request.object_colours(),
            images: images_of(request),
            background_image: request.background_image.clone(),
            flipped: request.flipped.clone(),
            placement: *placement,
            scale: request.scale,
            backdrop: request.backdrop(),
            picture_look,
        };
        if let Some((known, scene)) = &self.traced
            && *known == key
        {
            return scene.clone();
        }
        let scene = Arc::new(TracedScene::new(request, &key));
        self.built += 1;
        self.traced = Some((key, scene.clone()));
        scene
    }
}

/// Returns the solids of a request that are shown, anew unless they are those of the last picture.
fn kept(
    last: &mut Option<(ShownContents, Arc<SolidScene>)>,
    built: &mut u64,
    request: &PictureRequest,
    shown: Vec<ShownSolid>,
) -> Arc<SolidScene> {
    let shown = (shown, images_of(request));
    if let Some((known, solids)) = last
        && *known == shown
    {
        return solids.clone();
    }
    let is_shown = |id: ObjectId| shown.0.iter().any(|known| known.id == id);
    let solids = Arc::new(SolidScene::new(request, &is_shown));
    *built += 1;
    *last = Some((shown, solids.clone()));
    solids
}

impl SolidScene {
    fn new(request: &PictureRequest, shown: &(dyn Fn(ObjectId) -> bool + Sync)) -> Self {
        let rays = RayScene::new(
            &request.scene,
            &request.params,
            &RaySceneOptions {
                shown,
                colour: &|_| srgb(style::SOLID_COLOUR),
                thickness: None,
                stage: false,
                picture_look: Default::default(),
            },
        );
        let solids = 0..rays.world().solid_count();
        let objects = solids.filter_map(|solid| rays.object_of_solid(solid).id);
        Self {
            objects: objects.collect(),
            images: FaceImages::new(request, &rays, shown),
            rays,
        }
    }

    pub(crate) fn world(&self) -> &World {
        self.rays.world()
    }

    /// Returns the look of a face.
    pub(crate) fn look(&self, face: &Face) -> FaceLook {
        let paint = |image: FaceImage, part: &ImagePart<'_>| self.painted(image, part);
        self.rays.look(face, &paint)
    }

    /// Returns the colour that the face of a leaf has near a point that may be on no face; `None` where it is undefined.
    pub(crate) fn colour_beside(&self, leaf: usize, point: DVec3) -> Option<DVec3> {
        let paint = |image: FaceImage, part: &ImagePart<'_>| self.painted(image, part);
        self.rays.colour_beside(leaf, point, &paint)
    }

    fn painted(&self, image: FaceImage, part: &ImagePart<'_>) -> Option<DVec3> {
        let [image, colour] = self.images.colours(image, part)?;
        Some(image * colour)
    }

    /// Returns true if the look of a face may depend on the point.
    pub(crate) fn look_varies(&self, face: &Face) -> bool {
        self.rays.look_varies(face)
    }

    /// Returns the object of each solid of the world.
    pub(crate) fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// Returns the object to which a face belongs.
    pub(crate) fn owner(&self, face: &Face) -> FaceOwner<'_> {
        self.rays.owner(&face.of)
    }

    /// Returns sentences about everything that differs from its declaration.
    pub(crate) fn notes(&self, request: &PictureRequest) -> impl Iterator<Item = String> {
        notes(&self.rays, request)
    }

    /// Returns sentences about the attributes that are undefined or out of range somewhere.
    pub(crate) fn attribute_notes(&self) -> impl Iterator<Item = String> {
        let notes = self.rays.notes().into_iter();
        let is_attribute = |note: &RayNote| {
            matches!(
                note.fault,
                RayFault::UndefinedAttribute(_) | RayFault::ClampedAttribute(_)
            )
        };
        notes.filter(is_attribute).map(|note| note.to_string())
    }
}

/// Returns sentences about everything that differs from its declaration, or from the request.
pub(crate) fn notes(rays: &RayScene, request: &PictureRequest) -> impl Iterator<Item = String> {
    let unplaced = rays.unplaced(|id| request.chosen_texture(id).is_some());
    let mut missing: Vec<RayNote> = unplaced.collect();
    if !is_framed(rays, request) {
        // A single note is enough: it applies to all of them.
        missing.extend(rays.endless().take(1));
    }
    let notes = rays.notes().into_iter().chain(missing);
    notes.map(|note| note.to_string())
}

/// Returns true if something determines the framing: a given position of the camera, or an object with a position.
fn is_framed(rays: &RayScene, request: &PictureRequest) -> bool {
    let objects = &request.scene.objects;
    let mut space = request.view.space().into_iter();
    space.all(|space| space.camera.eye.is_some())
        || rays.bounds().is_some()
        || objects.iter().any(|object| object.shape.solid().is_none())
        // Last: it evaluates the cameras anew, for each picture.
        || declared_lens(request).is_some()
}

impl TracedScene {
    fn new(request: &PictureRequest, key: &TracedKey) -> Self {
        let radius = key.placement.radius;
        let scale = f64::from(request.scale);
        let rays = RayScene::new(
            &request.scene,
            &request.params,
            &RaySceneOptions {
                shown: &|id| !key.hidden.contains(&id),
                colour: &|id| {
                    key.colours
                        .get(id.index())
                        .map_or(DVec3::ONE, |it| srgb(*it))
                },
                thickness: Some(style::thickness(radius * scale)),
                stage: true,
                picture_look: key.picture_look,
            },
        );
        let images = FaceImages::new(request, &rays, &|id| !key.hidden.contains(&id));
        let chosen = request.background_image.as_ref();
        let background = chosen.or_else(|| request.image(rays.background_image()?));
        Self {
            images,
            background: background.map(|image| image.arc().clone()),
            sky: srgb(key.backdrop),
            tables: OnceLock::new(),
            rays,
        }
    }

    pub(crate) fn rays(&self) -> &RayScene {
        &self.rays
    }

    /// Returns the scene as data for the pass on the GPU.
    ///
    /// # Errors
    /// A clause about the part of the scene that the pass cannot draw.
    pub(crate) fn tables(&self) -> Result<&SceneTables, &str> {
        let tables = self.tables.get_or_init(|| {
            // Looks and background do not depend on the camera.
            let camera = LensCamera::default();
            self.with_scenery(&camera, 0, |scenery| {
                SceneTables::new(&self.rays, scenery, self.background.is_some())
            })
        });
        tables.as_ref().map_err(String::as_str)
    }

    /// Provides the scenery that rays of a camera see.
    pub(crate) fn with_scenery<R>(
        &self,
        camera: &LensCamera,
        bounces: u32,
        see: impl FnOnce(&Scenery<'_>) -> R,
    ) -> R {
        let picture_look = self.rays.picture_look();
        let paint = |image: FaceImage, part: &ImagePart<'_>| {
            let [light, colour] = self.images.colours(image, part)?;
            Some(picture_look.image_light(light) * colour)
        };
        let image = self.background.as_deref().map(|image| {
            move |place: [f64; 2]| match picture_look {
                PictureLook::Geotrace => texel(image, place),
                PictureLook::Crt => stated_texel(image, place),
            }
        });
        let image = image.as_ref().map(|image| image as &BackgroundImage<'_>);
        let lights = self.rays.lights(camera, &STANDARD_LIGHTS);
        see(&Scenery {
            world: self.rays.world(),
            sheets: self.rays.sheets(),
            glass: self.rays.glass(),
            opaque: self.rays.opaque(),
            look: &|face| self.rays.look(face, &paint),
            lights: &lights,
            background: &|direction| self.rays.background(direction, self.sky, image),
            bounces,
            picture_look: self.rays.picture_look(),
            sides: self.rays.sides(),
        })
    }
}

/// The lights of the 3D view.
const STANDARD_LIGHTS: StandardLights = StandardLights {
    ambient: style::AMBIENT as f64,
    fill: style::FILL as f64,
    key: style::KEY as f64,
    key_direction: DVec3::new(
        style::KEY_DIRECTION[0] as f64,
        style::KEY_DIRECTION[1] as f64,
        style::KEY_DIRECTION[2] as f64,
    ),
};
