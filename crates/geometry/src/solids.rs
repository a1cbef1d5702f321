//! Scenes for rays.
//!
//! Input: a scene, values of its params, the objects that are shown. Output: a [`RayScene`], which owns all that rays need:
//! solids, surfaces, the looks of their faces, lights, cameras, the background; and which says of each face what it belongs
//! to, and of the scene what is not as it is declared.
//!
//! ```text
//! Scene + ParamValues ──expand.rs──▶ solids, the instances of each united
//!        ├──────────────bodies.rs──▶ points, arrows, curves and geodesics as balls, cylinders and cones
//!        ├──────────attributes.rs──▶ numbers at places, within their ranges ──look.rs──▶ looks of faces
//!        │                              └─varying.rs──▶ the same as expressions
//!        └───────────────stage.rs──▶ lights, cameras, the background
//! ```

mod attributes;
mod bodies;
mod expand;
mod look;
mod stage;
mod varying;

use std::borrow::Cow;
use std::sync::Arc;

use expr::Input;
use glam::DVec3;
use scene::limits::MAX_LEAVES;
use scene::{Attribute, GridId, Object, ObjectId, ParamValues, Scene, Shape, stated_word};
use syntax::span::Span;
use tracer::camera::LensCamera;
use tracer::light::Light;
use tracer::shade::{Face, FaceLook, FaceObject, FaceSides, Glass};
use tracer::{BoundingBox, PictureLook, Sheet, Sheets, World, WorldBuilder};

use attributes::{AffineTape, AttributeSet, NumberAttribute};
use bodies::{BodyPart, BodyShapes};
use expand::{ExpandedSolid, Expansion, Omission, ShapeTable};
use look::{FacePlace, LookProgram};
use stage::DeclaredBackground;

pub use bodies::{MAX_BODIES, Thickness};
pub use expand::instance_grids;
pub use look::{BackgroundImage, FaceImage, Paint};
pub use stage::{DeclaredCamera, StandardLights, standard_sky};
pub use varying::{VaryingAttribute, VaryingImage, VaryingList, VaryingLook, VaryingPlace};

/// The colour of solids that state none, sRGB.
pub const SOLID_COLOR: DVec3 = DVec3::new(0.88, 0.86, 0.82);
/// The most instances of all surfaces of a scene that rays meet.
pub const MAX_SHEETS: usize = 4096;

/// The most work that reading the shapes of a scene's solids and looking for their boxes may take, in operations on intervals.
pub const MAX_SHAPE_WORK: u64 = 50_000_000;

/// The class of a leaf that polynomials of up to this degree bound, which tells how rays meet it; `None` for other functions.
pub fn leaf_class(degree: Option<usize>) -> &'static str {
    match degree {
        Some(0 | 1) => "plane",
        Some(2) => "quadric",
        Some(3 | 4) => "quartic",
        Some(_) | None => "general",
    }
}

/// The parts of a scene that become a [`RayScene`], and how they look where they do not say it themselves.
#[derive(Clone, Copy)]
pub struct RaySceneOptions<'a> {
    /// True for the objects that rays meet.
    pub shown: &'a (dyn Fn(ObjectId) -> bool + Sync),
    /// The colour, sRGB from 0 to 1, of objects that state none; solids and surfaces of glass are white.
    pub color: &'a (dyn Fn(ObjectId) -> DVec3 + Sync),
    /// The sizes of points, arrows and curves; without it they are left out.
    pub thickness: Option<Thickness>,
    /// The formulas of the picture.
    pub picture_look: PictureLook,
}

/// A scene with numbers in place, for rays.
#[derive(Debug)]
pub struct RayScene {
    world: World,
    sheets: Sheets,
    content: RayContent,
}

/// All of a scene for rays but what they meet: what it belongs to, how it looks, and what shines on it.
#[derive(Debug, Default)]
struct RayContent {
    glass: Vec<Option<Glass>>,
    opaque: Vec<bool>,
    /// For each solid of the world, the length of a mesh cell that its intervals state.
    cells: Vec<Option<f64>>,
    objects: Vec<RayObject>,
    /// The object of each solid of the world.
    solids: Vec<usize>,
    leaves: Vec<RayLeaf>,
    /// The sides of each leaf; none where all leaves are seen from both sides.
    sides: Vec<FaceSides>,
    /// The names of the leaves of solids.
    names: Vec<(String, Span)>,
    sheet_faces: Vec<SheetFace>,
    looks: Vec<LookProgram>,
    /// The images that attributes name.
    images: Vec<String>,
    /// The solids that state no place in an image, and no image.
    unplaced: Vec<ObjectId>,
    lights: Vec<Light>,
    cameras: Vec<DeclaredCamera>,
    background: Option<DeclaredBackground>,
    /// The attributes of lights and cameras, with their names.
    staged: Vec<(String, AttributeSet)>,
    notes: Vec<RayNote>,
    picture_look: PictureLook,
    /// False where the scene says that only what it declares shines.
    has_standard_lights: bool,
}

/// An object that rays may meet.
#[derive(Clone, Debug, PartialEq)]
pub struct RayObject {
    /// Its number among the scene's objects; `None` for a solid that is a part of others.
    pub id: Option<ObjectId>,
    /// Its name.
    pub name: String,
    /// The word that declares it.
    pub kind: &'static str,
    /// The grids that give it instances, each with its name and its position among the uniforms.
    grids: Vec<(String, std::ops::Range<usize>)>,
}

/// A leaf of the world.
#[derive(Debug)]
struct RayLeaf {
    /// The position of its name; `None` for a part of a point, an arrow or a curve.
    name: Option<u32>,
    instance: u64,
    look: u32,
    /// Those of its instance, with what unions over grids add.
    uniforms: Arc<[f64]>,
    place: FacePlace,
}

/// A parametric surface.
#[derive(Debug)]
struct SheetFace {
    object: usize,
    instance: u64,
    look: u32,
    uniforms: Arc<[f64]>,
    domain: [[f64; 2]; 2],
}

/// The object of a face, with its instance and its leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceOwner<'a> {
    /// The object.
    pub object: &'a RayObject,
    /// Its instance, from 0.
    pub instance: u64,
    /// The values of the grids that give the object instances, each with its name: one number for each axis.
    pub grids: Vec<(&'a str, &'a [f64])>,
    /// The leaf of a solid: the name of its function, or of a solid in field form, and the place where the set names it.
    pub leaf: Option<(&'a str, Span)>,
}

/// Something that is not as it is declared.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct RayNote {
    /// The object.
    pub object: String,
    /// The notes: differences from what is declared.
    pub fault: RayFault,
}

/// The ways in which something is not as it is declared.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum RayFault {
    /// So many of all instances are not drawn: a map takes volumes to 0. The leaf whose map it is.
    SingularMap(u64, u64, String),
    /// Not seen: no point is in it.
    Empty,
    /// Not drawn: there are more than [`MAX_LEAVES`] leaves.
    TooManyLeaves,
    /// Not drawn: its derivatives are too large.
    TooLarge,
    /// Not drawn: with it, reading the shapes of the solids takes more work than there is.
    TooMuchWork,
    /// Not drawn whole: there are more than [`MAX_BODIES`] pieces of points, arrows and curves.
    TooManyBodies,
    /// Not all instances of a surface are drawn: there are more than [`MAX_SHEETS`].
    TooManySheets,
    /// So many instances of a light or a camera have no place or no direction.
    UndefinedStage(u64),
    /// The attribute is undefined somewhere: its default is taken.
    UndefinedAttribute(&'static str),
    /// The attribute is out of its range somewhere: the nearest number in it is taken.
    ClampedAttribute(&'static str),
    /// The attribute is one number for a whole solid: its value at the origin is taken.
    NotUniform(&'static str),
    /// An image is not shown: no `uv` says where.
    UnplacedImage,
}

impl RayScene {
    /// Prepares what is shown of a scene.
    pub fn new(scene: &Scene, params: &ParamValues, options: &RaySceneOptions<'_>) -> Self {
        let shown = scene.numbered().filter(|(id, _)| (options.shown)(*id));
        let objects = shown.map(|(id, object)| (Some(id), object)).collect();
        Self::of(scene, params, options, objects, &mut { MAX_SHAPE_WORK })
    }

    /// Prepares one solid alone, also one that is a part of others; it may be of [`Scene::objects`] or of [`Scene::parts`].
    /// `work` is what reading its shapes may take, [`MAX_SHAPE_WORK`] for the solids of a scene together, and becomes what is
    /// left of that.
    pub fn of_solid(
        scene: &Scene,
        params: &ParamValues,
        options: &RaySceneOptions<'_>,
        solid: &Object,
        work: &mut u64,
    ) -> Self {
        let id = scene.object(&solid.name).map(|(id, _)| id);
        Self::of(scene, params, options, vec![(id, solid)], work)
    }

    fn of(
        scene: &Scene,
        params: &ParamValues,
        options: &RaySceneOptions<'_>,
        objects: Vec<(Option<ObjectId>, &Object)>,
        work: &mut u64,
    ) -> Self {
        let mut draft = Draft::new(scene, params, options);
        let with_bodies = options.thickness.is_some();
        let is_body = |object: &Object| match object.shape {
            Shape::Point { .. } | Shape::Vector { .. } | Shape::Curve { .. } => true,
            Shape::Geodesic { .. } => scene.is_in_space(object),
            _ => false,
        };
        let mut graph = Cow::Borrowed(&scene.graph);
        if with_bodies && objects.iter().any(|(_, object)| is_body(object)) {
            draft.shapes.prepare(graph.to_mut());
        }
        let nowhere = |_: Input| f64::NAN;
        let mut builder = WorldBuilder::new(&graph, &nowhere).with_work(*work);
        for &(id, object) in &objects {
            if object.shape.solid().is_some() {
                draft.solid(&mut builder, id, object);
            }
        }
        *work = builder.work_left();
        // Bodies have three shapes in all.
        builder = builder.with_work(u64::MAX);
        for &(id, object) in &objects {
            if let (Some(thickness), Some(id)) = (&options.thickness, id)
                && is_body(object)
            {
                draft.body(&mut builder, id, object, thickness);
            }
        }
        for &(id, object) in &objects {
            if let Some(id) = id {
                draft.sheets(id, object);
            }
        }
        draft.stage();
        draft.finish(builder)
    }

    /// The solids; those of the scene first, then bodies of points, arrows and curves.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The parametric surfaces.
    pub fn sheets(&self) -> &Sheets {
        &self.sheets
    }

    /// The glass that each solid of the world is of.
    pub fn glass(&self) -> &[Option<Glass>] {
        &self.content.glass
    }

    /// True for each solid of the world that lets no light through, wherever light meets it.
    pub fn opaque(&self) -> &[bool] {
        &self.content.opaque
    }

    /// The objects that rays may meet.
    pub fn objects(&self) -> &[RayObject] {
        &self.content.objects
    }

    /// The largest cell that a mesh of a solid of the world may have: the smallest that a counted interval of one of its
    /// leaves asks for. `None` where no interval has a count.
    pub fn stated_cell(&self, solid: usize) -> Option<f64> {
        self.content.cells[solid]
    }

    /// The object of a solid of the world.
    pub fn object_of_solid(&self, solid: usize) -> &RayObject {
        &self.content.objects[self.content.solids[solid]]
    }

    /// True if a solid of the world is a solid of the scene, and no point, arrow or curve.
    pub fn is_declared_solid(&self, solid: usize) -> bool {
        self.object_of_solid(solid).kind == "solid"
    }

    /// The lights that the scene declares; without any, those of the 3D view for the camera.
    pub fn lights(&self, camera: &LensCamera, standard: &StandardLights) -> Vec<Light> {
        if self.content.lights.is_empty() && self.content.has_standard_lights {
            standard.of(camera)
        } else {
            self.content.lights.clone()
        }
    }

    /// The cameras that the scene declares, in the order of the text, all instances of each.
    pub fn cameras(&self) -> &[DeclaredCamera] {
        &self.content.cameras
    }

    /// The words of the images that attributes of faces name.
    pub fn images(&self) -> &[String] {
        &self.content.images
    }

    /// A note for each of these objects, which have images of their own, whose image is not shown.
    pub fn unplaced(&self, images: impl Fn(ObjectId) -> bool) -> impl Iterator<Item = RayNote> {
        let objects = self.content.objects.iter();
        let is_unplaced = move |object: &&RayObject| {
            let mut unplaced = self.content.unplaced.iter();
            unplaced.any(|id| object.id == Some(*id) && images(*id))
        };
        objects.filter(is_unplaced).map(|object| RayNote {
            object: object.name.clone(),
            fault: RayFault::UnplacedImage,
        })
    }

    /// The word of the image that the declared background states.
    pub fn background_image(&self) -> Option<&str> {
        self.content.background.as_ref()?.image.as_deref()
    }

    /// True if the scene declares a background.
    pub fn has_background(&self) -> bool {
        self.content.background.is_some()
    }

    /// The linear light from a unit direction where nothing else is: that of the declared background or of its `image` at a
    /// place from (0, 0), the top left, to (1, 1); without one, that of [`standard_sky`], which is `above` (sRGB) overhead.
    pub fn background(
        &self,
        direction: DVec3,
        above: DVec3,
        image: Option<&BackgroundImage<'_>>,
    ) -> DVec3 {
        match &self.content.background {
            Some(background) => background.light(direction, image),
            None => self
                .content
                .picture_look
                .light(standard_sky(above, direction)),
        }
    }

    /// True if a solid is left out because the work of reading shapes is used up.
    pub fn is_out_of_work(&self) -> bool {
        let mut notes = self.content.notes.iter();
        notes.any(|note| note.fault == RayFault::TooMuchWork)
    }

    /// The formulas of the picture.
    pub fn picture_look(&self) -> PictureLook {
        self.content.picture_look
    }

    /// The sides from which the faces of each leaf are seen, as [`tracer::shade::Scenery`] has them.
    pub fn sides(&self) -> &[FaceSides] {
        &self.content.sides
    }

    /// The look of the faces that a leaf owns as expressions; `None` where [`RayScene::look`] is the same at all places of
    /// them.
    ///
    /// # Errors
    /// If it states places of an image.
    pub fn varying_look(&self, leaf: usize) -> Result<Option<VaryingLook<'_>>, VaryingImage> {
        let leaf = &self.content.leaves[leaf];
        let look = &self.content.looks[leaf.look as usize];
        look.varying(&leaf.uniforms, &leaf.place).transpose()
    }

    /// True if the background, without an image, depends on nothing but the height z of a unit direction.
    pub fn has_level_background(&self) -> bool {
        let background = self.content.background.as_ref();
        background.is_none_or(DeclaredBackground::is_level)
    }

    /// The look of a face. `paint` gives the images of objects.
    pub fn look(&self, face: &Face, paint: &Paint<'_>) -> FaceLook {
        match face.of {
            FaceObject::Solid { leaf, entering, .. } => {
                let leaf = &self.content.leaves[leaf];
                self.content.looks[leaf.look as usize].solid(
                    &leaf.uniforms,
                    &leaf.place,
                    face,
                    entering,
                    paint,
                )
            }
            FaceObject::Sheet { sheet, uv } => {
                let sheet = &self.content.sheet_faces[sheet];
                let look = &self.content.looks[sheet.look as usize];
                look.sheet(&sheet.uniforms, sheet.domain, uv, face, paint)
            }
        }
    }

    /// Returns the object that a face belongs to.
    pub fn owner(&self, of: &FaceObject) -> FaceOwner<'_> {
        match *of {
            FaceObject::Solid { solid, leaf, .. } => {
                let object = &self.content.objects[self.content.solids[solid]];
                let leaf = &self.content.leaves[leaf];
                let name = leaf.name.map(|name| &self.content.names[name as usize]);
                FaceOwner {
                    object,
                    instance: leaf.instance,
                    grids: object.grids_at(&leaf.uniforms),
                    leaf: name.map(|(name, span)| (&**name, *span)),
                }
            }
            FaceObject::Sheet { sheet, .. } => {
                let sheet = &self.content.sheet_faces[sheet];
                let object = &self.content.objects[sheet.object];
                FaceOwner {
                    object,
                    instance: sheet.instance,
                    grids: object.grids_at(&sheet.uniforms),
                    leaf: None,
                }
            }
        }
    }

    /// The leaves of the scene's solids in the order of the text, instances apart: the name of each, and the highest degree
    /// of the polynomials that bound it, `None` if something else does.
    pub fn leaves(&self) -> Vec<(&str, Option<usize>)> {
        let mut degrees: Vec<Option<Option<usize>>> = vec![None; self.content.names.len()];
        for (k, leaf) in self.content.leaves.iter().enumerate() {
            if let Some(name) = leaf.name {
                degrees[name as usize].get_or_insert_with(|| self.world.degree(k));
            }
        }
        let names = self.content.names.iter().zip(degrees);
        names
            .filter_map(|((name, _), degree)| Some((&**name, degree?)))
            .collect()
    }

    /// A box that contains all that is bounded; `None` where nothing is.
    pub fn bounds(&self) -> Option<BoundingBox> {
        let solids = (0..self.world.solid_count()).filter_map(|solid| self.world.bounds(solid));
        let all = solids.chain([self.sheets.bounds()]);
        let all = all.filter(|bounds| !bounds.is_empty());
        all.reduce(|a, b| a.union(&b))
    }

    /// True if it is known that no point is in a solid of the world.
    pub fn is_empty(&self, solid: usize) -> bool {
        let bounds = self.world.bounds(solid);
        bounds.is_some_and(|bounds| bounds.is_empty())
    }

    /// Returns the notes on differences from what is declared. Those that depend on places are known once rays have met them.
    pub fn notes(&self) -> Vec<RayNote> {
        let mut notes = self.content.notes.clone();
        let empty = (0..self.world.solid_count()).filter(|&solid| self.is_empty(solid));
        notes.extend(empty.map(|solid| RayNote {
            object: self.object_of_solid(solid).name.clone(),
            fault: RayFault::Empty,
        }));
        let looks = self.content.looks.iter();
        let looks = looks.map(|look| (&*look.object, &look.attributes));
        let staged = self.content.staged.iter();
        let staged = staged.map(|(name, attributes)| (&**name, attributes));
        let background = self.content.background.iter();
        let background = background.map(|found| (&*found.name, found.attributes()));
        for (object, attributes) in looks.chain(staged).chain(background) {
            let [undefined, clamped] = attributes.faults();
            let faults = undefined.into_iter().map(RayFault::UndefinedAttribute);
            let faults = faults.chain(clamped.into_iter().map(RayFault::ClampedAttribute));
            for fault in faults {
                let note = RayNote {
                    object: object.to_owned(),
                    fault,
                };
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        notes
    }
}

impl RayObject {
    fn new(scene: &Scene, params: &ParamValues, id: Option<ObjectId>, object: &Object) -> Self {
        let open = |grid: &GridId| params.fixed_grid(scene, *grid).is_none();
        let own = object.shape.solid().map_or(&[][..], instance_grids);
        let own = own.iter().map(|bound| (bound.grid, bound.first_uniform));
        let read = object.grids.iter().filter_map(|id| {
            let grid = scene.grids.get(id.0 as usize)?;
            Some((*id, grid.first_uniform))
        });
        let grids = read.chain(own).filter(|(id, _)| open(id));
        let grids = grids.filter_map(|(id, first)| {
            let grid = scene.grids.get(id.0 as usize)?;
            let first = first as usize;
            Some((grid.name.clone(), first..first + grid.axes.len()))
        });
        Self {
            id,
            name: object.name.clone(),
            kind: object.shape.kind(),
            grids: grids.collect(),
        }
    }

    fn grids_at<'a>(&'a self, uniforms: &'a [f64]) -> Vec<(&'a str, &'a [f64])> {
        let grids = self.grids.iter();
        grids
            .filter_map(|(name, places)| Some((&**name, uniforms.get(places.clone())?)))
            .collect()
    }
}

/// A scene for rays that is being made.
struct Draft<'a> {
    scene: &'a Scene,
    params: &'a ParamValues,
    options: &'a RaySceneOptions<'a>,
    table: ShapeTable,
    shapes: BodyShapes,
    leaf_room: usize,
    body_room: usize,
    sheets: Vec<Sheet>,
    content: RayContent,
}

impl<'a> Draft<'a> {
    fn new(scene: &'a Scene, params: &'a ParamValues, options: &'a RaySceneOptions<'a>) -> Self {
        Self {
            scene,
            params,
            options,
            table: ShapeTable::default(),
            shapes: BodyShapes::default(),
            leaf_room: MAX_LEAVES as usize,
            body_room: MAX_BODIES,
            sheets: Vec::new(),
            content: RayContent {
                picture_look: options.picture_look,
                has_standard_lights: scene.picture.is_none(),
                ..RayContent::default()
            },
        }
    }

    fn note(&mut self, object: &Object, fault: RayFault) {
        self.content.notes.push(RayNote {
            object: object.name.clone(),
            fault,
        });
    }

    fn object(&mut self, id: Option<ObjectId>, object: &Object) -> usize {
        let ray_object = RayObject::new(self.scene, self.params, id, object);
        self.content.objects.push(ray_object);
        self.content.objects.len() - 1
    }

    /// The image of faces with these attributes.
    fn image(&mut self, id: Option<ObjectId>, attributes: &[Attribute]) -> Option<FaceImage> {
        let images = &mut self.content.images;
        let stated = stated_word(attributes, "image").map(|word| {
            let known = images.iter().position(|image| image == word);
            known.unwrap_or_else(|| {
                images.push(word.to_owned());
                images.len() - 1
            })
        });
        id.map(|object| FaceImage { object, stated })
    }

    fn solid(&mut self, builder: &mut WorldBuilder<'_>, id: Option<ObjectId>, object: &Object) {
        let Some(solid) = object.shape.solid() else {
            return;
        };
        let (scene, params) = (self.scene, self.params);
        let maps = solid.leaves.iter();
        let mut expansion = Expansion {
            scene,
            params,
            object,
            solid,
            maps: maps
                .map(|leaf| AffineTape::new(&scene.graph, &leaf.map))
                .collect(),
            room: self.leaf_room,
        };
        let mut expanded = ExpandedSolid::default();
        let mut instances: Vec<(usize, u64)> = Vec::new();
        let own = params.combination_count(scene, instance_grids(solid));
        let count = params.instance_count(scene, object).saturating_mul(own);
        let (mut singular, mut whose) = (0, 0);
        for instance in 0..count {
            let uniforms = params.instance(scene, object, instance / own);
            match expansion.add(&mut expanded, &uniforms, instance % own) {
                Ok(()) => instances.push((expanded.leaves.len(), instance)),
                Err(Omission::Singular { leaf }) => (singular, whose) = (singular + 1, leaf),
                Err(Omission::TooManyLeaves) => {
                    self.note(object, RayFault::TooManyLeaves);
                    return;
                }
                Err(_) => return,
            }
        }
        self.leaf_room = expansion.room;
        if singular > 0 {
            let leaf = solid.leaves[whose as usize].name.clone();
            self.note(object, RayFault::SingularMap(singular, count, leaf));
        }
        if expanded.leaves.is_empty() {
            return;
        }
        match expanded.build(scene, solid, builder, &mut self.table) {
            Ok(()) => {}
            Err(Omission::TooLarge) => return self.note(object, RayFault::TooLarge),
            Err(Omission::TooMuchWork) => return self.note(object, RayFault::TooMuchWork),
            Err(_) => return,
        }
        let number = self.object(id, object);
        self.content.solids.push(number);
        self.content.cells.push(expanded.stated_cell(solid));
        let color = id.map_or(DVec3::ONE, |id| (self.options.color)(id));
        let first_look = self.content.looks.len() as u32;
        let first_name = self.content.names.len() as u32;
        let (mut has_unplaced, mut has_places) = (false, false);
        for leaf in &solid.leaves {
            // In a scene script a colour may be brighter than white.
            let bright = scene.picture.is_some();
            let attributes = AttributeSet::new(&scene.graph, &leaf.attributes, bright);
            let image = self.image(id, &leaf.attributes);
            let is_stated = image.is_some_and(|image| image.stated.is_some());
            has_unplaced |= is_stated && !attributes.states(NumberAttribute::Uv);
            has_places |= attributes.states(NumberAttribute::Uv);
            let picture_look = self.options.picture_look;
            let look = LookProgram::new(&object.name, image, picture_look, color, attributes);
            self.content.looks.push(look);
            self.content.names.push((leaf.name.clone(), leaf.name_span));
        }
        if has_unplaced {
            self.note(object, RayFault::UnplacedImage);
        } else if !has_places {
            self.content.unplaced.extend(id);
        }
        let mut instance_of = instances.iter();
        let mut current = instance_of.next();
        let mut glass = None;
        for (k, leaf) in expanded.leaves.into_iter().enumerate() {
            while current.is_some_and(|(end, _)| *end <= k) {
                current = instance_of.next();
            }
            let look = &self.content.looks[(first_look + leaf.leaf) as usize];
            if glass.is_none() {
                glass = look.glass(&leaf.uniforms);
            }
            let place = look.place(&leaf.uniforms);
            let RayContent { leaves, sides, .. } = &mut self.content;
            if let Some(front) = solid.front {
                sides.resize(leaves.len(), FaceSides::Both);
                sides.push(match leaf.leaf == front {
                    true => FaceSides::Outer,
                    false => FaceSides::None,
                });
            }
            leaves.push(RayLeaf {
                name: Some(first_name + leaf.leaf),
                instance: current.map_or(0, |(_, instance)| *instance),
                look: first_look + leaf.leaf,
                place,
                uniforms: leaf.uniforms,
            });
        }
        self.content.glass.push(glass);
        let looks = &self.content.looks[first_look as usize..];
        self.content
            .opaque
            .push(looks.iter().all(LookProgram::is_opaque));
        let mut uneven: Vec<&str> = looks.iter().flat_map(LookProgram::uneven).collect();
        uneven.sort_unstable();
        uneven.dedup();
        for word in uneven {
            self.note(object, RayFault::NotUniform(word));
        }
    }

    fn body(
        &mut self,
        builder: &mut WorldBuilder<'_>,
        id: ObjectId,
        object: &Object,
        thickness: &Thickness,
    ) {
        let (scene, params) = (self.scene, self.params);
        let attributes = AttributeSet::new(&scene.graph, &object.attributes, false);
        let room = self.body_room;
        let (parts, more) =
            bodies::parts(scene, params, (id, object), &attributes, thickness, room);
        self.body_room -= parts.len();
        if more {
            self.note(object, RayFault::TooManyBodies);
        }
        if parts.is_empty() {
            return;
        }
        let steps = self.shapes.steps(builder, &parts);
        if steps.is_err() || steps.is_ok_and(|steps| builder.solid(&steps).is_err()) {
            return self.note(object, RayFault::TooLarge);
        }
        let number = self.object(Some(id), object);
        self.content.solids.push(number);
        self.content.cells.push(None);
        self.content.glass.push(None);
        let color = (self.options.color)(id);
        let look = LookProgram::new(
            &object.name,
            None,
            self.options.picture_look,
            color,
            attributes,
        );
        self.content.opaque.push(look.is_opaque());
        self.content.looks.push(look);
        let look = self.content.looks.len() as u32 - 1;
        let mut uniforms: (u64, Arc<[f64]>) = (u64::MAX, Arc::default());
        for part in parts {
            let BodyPart {
                map,
                parameter,
                instance,
                ..
            } = part;
            if uniforms.0 != instance {
                uniforms = (instance, params.instance(scene, object, instance).into());
            }
            let varies = self.content.looks[look as usize].attributes.varies();
            self.content.leaves.push(RayLeaf {
                name: None,
                instance,
                look,
                uniforms: uniforms.1.clone(),
                place: if varies {
                    FacePlace::Along(Box::new((map.inverse(), parameter)))
                } else {
                    FacePlace::anywhere()
                },
            });
        }
    }

    fn sheets(&mut self, id: ObjectId, object: &Object) {
        let Some((position, domain)) = object.shape.surface() else {
            return;
        };
        let (scene, params) = (self.scene, self.params);
        let domain = domain.map(|axis| [axis.range.min, axis.range.max]);
        let count = params.instance_count(scene, object);
        let room = (MAX_SHEETS - self.sheets.len()) as u64;
        if count > room {
            self.note(object, RayFault::TooManySheets);
        }
        let number = self.object(Some(id), object);
        let attributes = AttributeSet::new(&scene.graph, &object.attributes, false);
        let color = (self.options.color)(id);
        let image = self.image(Some(id), &object.attributes);
        let picture_look = self.options.picture_look;
        let look = LookProgram::new(&object.name, image, picture_look, color, attributes);
        let look = look.on_surface(&scene.graph, position);
        self.content.looks.push(look);
        for instance in 0..count.min(room) {
            let uniforms: Arc<[f64]> = params.instance(scene, object, instance).into();
            let number_of = |input: Input| match input {
                Input::Uniform(k) => uniforms.get(k as usize).copied().unwrap_or(f64::NAN),
                Input::Variable(_) => f64::NAN,
            };
            let sheet = Sheet::new(&scene.graph, *position, domain, &number_of);
            let Ok(sheet) = sheet else {
                return self.note(object, RayFault::TooLarge);
            };
            self.sheets.push(sheet);
            self.content.sheet_faces.push(SheetFace {
                object: number,
                instance,
                look: self.content.looks.len() as u32 - 1,
                uniforms,
                domain,
            });
        }
    }

    fn stage(&mut self) {
        let (scene, params) = (self.scene, self.params);
        let picture_look = self.options.picture_look;
        let background = scene.background();
        self.content.background = background
            .and_then(|object| DeclaredBackground::new(scene, params, object, picture_look));
        let others = scene.stage.iter();
        for object in others.filter(|object| !matches!(object.shape, Shape::Background(_))) {
            let attributes = AttributeSet::new(&scene.graph, &object.attributes, true);
            let (lights, dark) = stage::lights(scene, params, object, &attributes, picture_look);
            let (cameras, blind) = stage::cameras(scene, params, object, &attributes, picture_look);
            self.content.lights.extend(lights);
            self.content.cameras.extend(cameras);
            if dark + blind > 0 {
                self.note(object, RayFault::UndefinedStage(dark + blind));
            }
            self.content.staged.push((object.name.clone(), attributes));
        }
    }

    fn finish(mut self, builder: WorldBuilder<'_>) -> RayScene {
        let world = builder.build().unwrap_or_else(|_| {
            // Not to be expected: each shape has been read, and what bounds it in its frame is a part of that. Surfaces are
            // drawn all the same.
            let objects = self.content.solids.iter();
            let notes = objects.map(|&object| RayNote {
                object: self.content.objects[object].name.clone(),
                fault: RayFault::TooLarge,
            });
            self.content.notes.extend(notes);
            World::empty()
        });
        RayScene {
            world,
            sheets: Sheets::new(self.sheets),
            content: self.content,
        }
    }
}

impl std::fmt::Display for RayNote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = &self.object;
        match &self.fault {
            RayFault::SingularMap(1, 1, leaf) => {
                write!(
                    f,
                    "`{name}` is not drawn: the map of `{leaf}` takes volumes to 0"
                )
            }
            RayFault::SingularMap(few, all, leaf) => write!(
                f,
                "{few} of the {all} instances of `{name}` are not drawn: the map of `{leaf}` takes volumes to 0"
            ),
            RayFault::Empty => write!(f, "`{name}` is not seen: no point is in it"),
            RayFault::TooManyLeaves => write!(
                f,
                "`{name}` is not drawn: with it the solids have more than {MAX_LEAVES} leaves"
            ),
            RayFault::TooLarge => {
                write!(f, "`{name}` is not drawn: its derivatives are too large")
            }
            RayFault::TooMuchWork => write!(
                f,
                "`{name}` is not drawn: to find where the solids lie takes more work than there may be; fewer instances take less"
            ),
            RayFault::TooManyBodies => write!(
                f,
                "not all of `{name}` is drawn: points, arrows and curves have more than {MAX_BODIES} pieces"
            ),
            RayFault::TooManySheets => write!(
                f,
                "not all instances of `{name}` are drawn: there are more than {MAX_SHEETS} surfaces"
            ),
            RayFault::UndefinedStage(1) => {
                write!(
                    f,
                    "`{name}` is left out: its place or its direction is undefined, or the direction is zero"
                )
            }
            RayFault::UndefinedStage(count) => write!(
                f,
                "{count} instances of `{name}` are left out: their place or direction is undefined, or the direction is zero"
            ),
            RayFault::UndefinedAttribute(word) => write!(
                f,
                "`{word}` of `{name}` is undefined somewhere: its default is taken there"
            ),
            RayFault::ClampedAttribute(word) => write!(
                f,
                "`{word}` of `{name}` is out of its range somewhere: the nearest number in it is taken there"
            ),
            RayFault::NotUniform(word) => write!(
                f,
                "`{word}` of `{name}` is one number for the whole solid: its value at the origin is taken"
            ),
            RayFault::UnplacedImage => {
                write!(f, "`{name}` has no `uv`, so its image is not shown")
            }
        }
    }
}
