//! Scenes for rays, kept from one picture to the next.

use std::sync::Arc;

use geometry::solids::{RayNote, RayScene, RaySceneOptions, StandardLights, Thickness};
use glam::DVec3;
use scene::{ObjectId, Scene};
use tracer::World;
use tracer::camera::LensCamera;
use tracer::shade::{Face, FaceLook, Scenery};

use crate::content::Content;
use crate::placement::Placement;
use crate::request::PictureRequest;
use crate::shared::Shared;
use crate::style;
use crate::texture::Texture;

/// The solids of the last pictures.
#[derive(Debug, Default)]
pub(crate) struct SolidStore {
    /// Those of the 3D view, with the contents that they are of.
    solids: Option<(ShownContents, Arc<SolidScene>)>,
    traced: Option<(TracedKey, Arc<TracedScene>)>,
    /// The number of scenes that were prepared for rays.
    pub(crate) built: u64,
}

/// The solids that a picture shows, each with what it is of.
type ShownContents = Vec<(ObjectId, Content)>;

/// The solids of a scene, for the 3D view.
#[derive(Debug)]
pub(crate) struct SolidScene {
    rays: RayScene,
    /// The object of each solid of the world.
    objects: Vec<ObjectId>,
}

/// All that is shown of a scene, for the traced view.
#[derive(Debug)]
pub(crate) struct TracedScene {
    rays: RayScene,
    textures: Vec<(ObjectId, Arc<Texture>)>,
    /// Overhead and underfoot, sRGB from 0 to 1.
    sky: DVec3,
}

/// All that a scene for the traced view depends on.
#[derive(Clone, Debug, PartialEq)]
struct TracedKey {
    scene: Shared<Scene>,
    params: Arc<scene::ParamValues>,
    hidden: Vec<ObjectId>,
    colours: Vec<[u8; 3]>,
    textures: Vec<(ObjectId, Shared<Texture>)>,
    flipped: Vec<ObjectId>,
    placement: Placement,
    scale: f32,
    backdrop: [u8; 3],
}

impl SolidStore {
    /// The solids that a request of the 3D view shows, all but the hidden ones; `None` if there are none. `contents` are
    /// those of the scene's objects.
    pub(crate) fn get(
        &mut self,
        request: &PictureRequest,
        hidden: &[ObjectId],
        contents: &[Content],
    ) -> Option<Arc<SolidScene>> {
        let objects = request.scene.numbered().zip(contents);
        let shown = objects
            .filter(|((id, object), _)| object.shape.solid().is_some() && !hidden.contains(id));
        let shown: Vec<(ObjectId, Content)> = shown
            .map(|((id, _), content)| (id, content.clone()))
            .collect();
        if shown.is_empty() {
            return None;
        }
        if let Some((known, solids)) = &self.solids
            && *known == shown
        {
            return Some(solids.clone());
        }
        let is_shown = |id: ObjectId| shown.iter().any(|(known, _)| *known == id);
        let solids = Arc::new(SolidScene::new(request, &is_shown));
        self.built += 1;
        self.solids = Some((shown, solids.clone()));
        Some(solids)
    }

    /// All that a request of the traced view shows, all but the hidden ones, in these drawing units.
    pub(crate) fn traced(
        &mut self,
        request: &PictureRequest,
        hidden: &[ObjectId],
        placement: &Placement,
    ) -> Arc<TracedScene> {
        let key = TracedKey {
            scene: request.scene.clone(),
            params: request.params.clone(),
            hidden: hidden.to_vec(),
            colours: request.object_colours(),
            textures: request.textures.clone(),
            flipped: request.flipped.clone(),
            placement: *placement,
            scale: request.scale,
            backdrop: request.backdrop(),
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

impl SolidScene {
    fn new(request: &PictureRequest, shown: &(dyn Fn(ObjectId) -> bool + Sync)) -> Self {
        let rays = RayScene::new(
            &request.scene,
            &request.params,
            &RaySceneOptions {
                shown,
                color: &|_| srgb(style::SOLID_COLOUR),
                thickness: None,
            },
        );
        let solids = 0..rays.world().solid_count();
        let objects = solids.filter_map(|solid| rays.object_of_solid(solid).id);
        Self {
            objects: objects.collect(),
            rays,
        }
    }

    pub(crate) fn world(&self) -> &World {
        self.rays.world()
    }

    /// The look of a face, without an image.
    pub(crate) fn look(&self, face: &Face) -> FaceLook {
        self.rays.look(face, &|_, _| None)
    }

    /// The object of each solid of the world.
    pub(crate) fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// The position of the leaf whose face it is among those of its solid.
    pub(crate) fn leaf(&self, scene: &Scene, face: &Face) -> Option<usize> {
        leaf(&self.rays, scene, face)
    }

    /// Sentences about all that is not as it is declared.
    pub(crate) fn notes(&self) -> impl Iterator<Item = String> {
        self.rays
            .notes()
            .into_iter()
            .map(|note: RayNote| note.to_string())
    }
}

impl TracedScene {
    fn new(request: &PictureRequest, key: &TracedKey) -> Self {
        let radius = key.placement.radius;
        let scale = f64::from(request.scale);
        let nominal = |length: &style::Length| f64::from(length.nominal) * radius * scale;
        let rays = RayScene::new(
            &request.scene,
            &request.params,
            &RaySceneOptions {
                shown: &|id| !key.hidden.contains(&id),
                color: &|id| {
                    key.colours
                        .get(id.0 as usize)
                        .map_or(DVec3::ONE, |it| srgb(*it))
                },
                thickness: Some(Thickness {
                    point: nominal(&style::POINT_RADIUS),
                    line: nominal(&style::LINE_HALF_WIDTH),
                    head_length: f64::from(style::HEAD_LENGTH),
                    head_radius: f64::from(style::HEAD_RADIUS),
                    head_share: f64::from(style::HEAD_SHARE),
                }),
            },
        );
        let objects = request.scene.numbered();
        let surfaces = objects.filter(|(id, object)| {
            let states = |word| object.attributes.iter().any(|it| it.word == word);
            object.shape.is_surface() && !key.hidden.contains(id) && !states("color")
        });
        Self {
            rays,
            textures: surfaces.map(|(id, _)| (id, request.texture(id))).collect(),
            sky: srgb(key.backdrop),
        }
    }

    pub(crate) fn rays(&self) -> &RayScene {
        &self.rays
    }

    /// Hands out what rays see by a camera.
    pub(crate) fn with_scenery<R>(
        &self,
        camera: &LensCamera,
        bounces: u32,
        see: impl FnOnce(&Scenery<'_>) -> R,
    ) -> R {
        let paint = |id: ObjectId, place: [f64; 2]| {
            let texture = self.textures.iter().find(|(known, _)| *known == id);
            texture.map(|(_, texture)| texel(texture, place))
        };
        let lights = self.rays.lights(camera, &STANDARD_LIGHTS);
        see(&Scenery {
            world: self.rays.world(),
            sheets: self.rays.sheets(),
            glass: self.rays.glass(),
            look: &|face| self.rays.look(face, &paint),
            lights: &lights,
            background: &|direction| self.rays.background(direction, self.sky, &|_| None),
            bounces,
        })
    }

    /// The position of the leaf whose face it is among those of its solid.
    pub(crate) fn leaf(&self, scene: &Scene, face: &Face) -> Option<usize> {
        leaf(&self.rays, scene, face)
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

fn srgb(colour: [u8; 3]) -> DVec3 {
    DVec3::from_array(colour.map(f64::from)) / 255.0
}

/// The position of the leaf whose face it is among those of its solid.
fn leaf(rays: &RayScene, scene: &Scene, face: &Face) -> Option<usize> {
    let owner = rays.owner(&face.of);
    let (_, span) = owner.leaf?;
    let solid = scene.get(owner.object.id?)?.shape.solid()?;
    solid.leaves.iter().position(|leaf| leaf.name_span == span)
}

/// The linear colour of an image at a place of it.
fn texel(texture: &Texture, [u, v]: [f64; 2]) -> DVec3 {
    let sampler = texture.sampler();
    let light = sampler.averaged([u as f32, v as f32], sampler.footprint([0.0; 4]));
    DVec3::from_array(light.map(f64::from))
}
