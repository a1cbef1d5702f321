//! Scenes for rays.
//!
//! In: a scene, values of its params, the objects that are shown. Out: a [`RayScene`], which owns everything rays need:
//! solids, surfaces, the looks of their faces, lights, cameras, the background. It also maps each face to its object, and
//! reports deviations from the declarations.
//!
//! ```text
//! Scene + ParamValues ──draft.rs──▶ RayScene, and deviations from the declarations (note.rs)
//!        ├──────────────expand.rs──▶ solids, the instances of each united
//!        ├──────────────bodies.rs──▶ points, arrows, curves and geodesics as balls, cylinders and cones
//!        ├──────────attributes.rs──▶ numbers at points, within their ranges ──look.rs──▶ looks of faces
//!        │                              └─varying.rs──▶ the same as expressions
//!        └───────────────stage.rs──▶ lights, cameras, the background
//! ```

mod attributes;
mod bodies;
mod draft;
mod expand;
mod look;
mod note;
mod stage;
mod varying;

use std::borrow::Cow;
use std::sync::Arc;

use expr::Input;
use glam::DVec3;
use scene::{GridId, Object, ObjectId, ParamValues, Scene, Shape};
use tracer::camera::LensCamera;
use tracer::light::Light;
use tracer::shade::{Face, FaceLook, FaceObject, FaceSides, Glass};
use tracer::{BoundingBox, PictureLook, Sheets, World, WorldBuilder};

use attributes::AttributeSet;
use draft::Draft;
use look::{FacePlace, LookProgram};
use stage::DeclaredBackground;

pub use attributes::ROUNDING;
pub use bodies::{MAX_BODIES, Thickness, stated_radius};
pub use expand::instance_grids;
pub use look::{BackgroundImage, FaceImage, ImagePart, Paint};
pub use note::{MissingCuts, RayFault, RayNote};
pub use stage::{DeclaredCamera, StandardLights, standard_sky};
pub use varying::{VaryingAttribute, VaryingImage, VaryingList, VaryingLook, VaryingPlace};

/// The colour, in sRGB, of solids without a stated one.
pub const SOLID_COLOUR: [u8; 3] = [224, 219, 209];

/// Returns a colour in sRGB as numbers from 0 to 1.
pub fn srgb(colour: [u8; 3]) -> DVec3 {
    DVec3::from_array(colour.map(f64::from)) / 255.0
}

/// The maximum number of instances of all surfaces of a scene for rays.
pub const MAX_SHEETS: usize = 4096;

/// The maximum work, in interval operations, of reading the shapes of a scene's solids and finding their boxes.
pub const MAX_SHAPE_WORK: u64 = 50_000_000;

/// Returns the class of a leaf bounded by polynomials of up to this degree, which determines how rays are intersected with
/// it; `None` stands for other functions.
pub fn leaf_class(degree: Option<usize>) -> &'static str {
    match degree {
        Some(0 | 1) => "plane",
        Some(2) => "quadric",
        Some(3 | 4) => "quartic",
        Some(_) | None => "general",
    }
}

/// The parts of a scene that become a [`RayScene`], and the default looks.
#[derive(Clone, Copy)]
pub struct RaySceneOptions<'a> {
    /// True for the objects that rays meet.
    pub shown: &'a (dyn Fn(ObjectId) -> bool + Sync),
    /// The colour, in sRGB from 0 to 1, of objects without a stated one; solids and surfaces of glass are white.
    pub colour: &'a (dyn Fn(ObjectId) -> DVec3 + Sync),
    /// The sizes of points, arrows and curves; if `None`, they are omitted.
    pub thickness: Option<Thickness>,
    /// True if the lights, cameras and the background of the scene are included.
    pub stage: bool,
    /// The formulas of the picture.
    pub picture_look: PictureLook,
}

/// A scene with numbers substituted, for rays.
#[derive(Debug)]
pub struct RayScene {
    world: World,
    sheets: Sheets,
    content: RayContent,
}

/// Everything that rays need of a scene except the geometry: owners, looks and lights.
#[derive(Debug, Default)]
struct RayContent {
    glass: Vec<Option<Glass>>,
    opaque: Vec<bool>,
    objects: Vec<RayObject>,
    /// The solids of the world; `glass` and `opaque` have the same length.
    solids: Vec<RaySolid>,
    leaves: Vec<RayLeaf>,
    /// The sides of each leaf; empty if all leaves are seen from both sides.
    sides: Vec<FaceSides>,
    /// The names of the leaves of solids.
    names: Vec<String>,
    sheet_faces: Vec<SheetFace>,
    looks: Vec<LookProgram>,
    /// The images that attributes name.
    images: Vec<String>,
    /// The solids that state neither a position in an image, nor an image.
    unplaced: Vec<ObjectId>,
    lights: Vec<Light>,
    cameras: Vec<DeclaredCamera>,
    background: Option<DeclaredBackground>,
    /// The attributes of lights and cameras, with their names.
    staged: Vec<(String, AttributeSet)>,
    notes: Vec<RayNote>,
    picture_look: PictureLook,
    /// True if the scene is that of a script: only declared lights shine.
    is_script: bool,
}

/// A solid of the world.
#[derive(Debug)]
struct RaySolid {
    /// The index of its object.
    object: usize,
    /// The length of a mesh cell stated by its intervals.
    stated_cell: Option<f64>,
    /// The names of the coordinates in its declaration; see [`Solid::parameters`].
    parameters: Option<Arc<[Box<str>]>>,
    /// The index of the name of its first leaf.
    first_name: u32,
}

/// An object that rays may meet.
#[derive(Clone, Debug, PartialEq)]
pub struct RayObject {
    /// Its id in the scene; `None` for a solid that is a part of others.
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
    /// The index of its name; `None` for a part of a point, an arrow or a curve.
    name: Option<u32>,
    instance: u64,
    look: u32,
    /// The uniforms of its instance, with those added by unions over grids.
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
    /// The index of the instance, from 0.
    pub instance: u64,
    /// The values of the grids that give the object instances, each with its name: one number for each axis.
    pub grids: Vec<(&'a str, &'a [f64])>,
    /// The leaf of a solid.
    pub leaf: Option<LeafOwner<'a>>,
}

/// A leaf of a declared solid.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct LeafOwner<'a> {
    /// The name of its function, or of a solid in field form.
    pub name: &'a str,
    /// Its position in [`scene::Solid::leaves`].
    pub index: usize,
}

impl RayScene {
    /// Prepares the shown objects of a scene.
    pub fn new(scene: &Scene, params: &ParamValues, options: &RaySceneOptions<'_>) -> Self {
        let shown = scene.numbered().filter(|(id, _)| (options.shown)(*id));
        let objects = shown.map(|(id, object)| (Some(id), object)).collect();
        Self::of(scene, params, options, objects, &mut { MAX_SHAPE_WORK })
    }

    /// Prepares one solid alone, even if it is only a part of others; it may be one of [`Scene::objects`] or of
    /// [`Scene::parts`]. `work` is the work allowed for reading its shapes ([`MAX_SHAPE_WORK`] for all solids of a scene
    /// together), and becomes the remaining work.
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
        // Bodies have only three shapes.
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
        if options.stage {
            draft.stage();
        }
        draft.finish(builder)
    }

    /// Returns the solids: first those of the scene, then bodies of points, arrows and curves.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Returns the parametric surfaces.
    pub fn sheets(&self) -> &Sheets {
        &self.sheets
    }

    /// Returns the glass of each solid of the world.
    pub fn glass(&self) -> &[Option<Glass>] {
        &self.content.glass
    }

    /// Returns true for each solid of the world that is opaque everywhere.
    pub fn opaque(&self) -> &[bool] {
        &self.content.opaque
    }

    /// Returns the objects that rays may meet.
    pub fn objects(&self) -> &[RayObject] {
        &self.content.objects
    }

    /// Returns the maximum mesh cell of a solid of the world: the smallest one requested by a counted interval of one of
    /// its leaves. `None` if no interval has a count.
    pub fn stated_cell(&self, solid: usize) -> Option<f64> {
        self.content.solids[solid].stated_cell
    }

    /// Returns the object of a solid of the world.
    pub fn object_of_solid(&self, solid: usize) -> &RayObject {
        &self.content.objects[self.content.solids[solid].object]
    }

    /// Returns true if a solid of the world is a solid of the scene, not a point, arrow or curve.
    pub fn is_declared_solid(&self, solid: usize) -> bool {
        self.object_of_solid(solid).kind == "solid"
    }

    /// Returns the lights that the scene declares; if there are none, those of the 3D view for the camera.
    pub fn lights(&self, camera: &LensCamera, standard: &StandardLights) -> Vec<Light> {
        if self.content.lights.is_empty() && !self.content.is_script {
            standard.of(camera)
        } else {
            self.content.lights.clone()
        }
    }

    /// Returns the cameras that the scene declares, with all their instances, in the order of the text.
    pub fn cameras(&self) -> &[DeclaredCamera] {
        &self.content.cameras
    }

    /// Returns the names of the images that attributes of faces use.
    pub fn images(&self) -> &[String] {
        &self.content.images
    }

    /// Returns a note for each of these objects that has its own image, which is not shown.
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

    /// Returns the name of the image of the declared background.
    pub fn background_image(&self) -> Option<&str> {
        self.content.background.as_ref()?.image.as_deref()
    }

    /// Returns true if the scene declares a background.
    pub fn has_background(&self) -> bool {
        self.content.background.is_some()
    }

    /// Returns the linear light from a unit direction in which there is nothing else: that of the declared background, or
    /// of its `image` at a point from (0, 0), the top left, to (1, 1); if none is declared, that of [`standard_sky`], which
    /// is `above` (sRGB) overhead.
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

    /// Returns true if a solid is omitted because the work for reading shapes is used up.
    pub fn is_out_of_work(&self) -> bool {
        let mut notes = self.content.notes.iter();
        notes.any(|note| note.fault == RayFault::TooMuchWork)
    }

    /// Returns true if the scene is that of a script.
    pub fn is_script(&self) -> bool {
        self.content.is_script
    }

    /// Returns the formulas of the picture.
    pub fn picture_look(&self) -> PictureLook {
        self.content.picture_look
    }

    /// Returns the sides from which the faces of each leaf are seen; see [`tracer::shade::Scenery`].
    pub fn sides(&self) -> &[FaceSides] {
        &self.content.sides
    }

    /// Returns the look of the faces that a leaf owns as expressions; `None` if [`RayScene::look`] is the same at all
    /// their points.
    ///
    /// # Errors
    /// If it uses an image with stated positions.
    pub fn varying_look(&self, leaf: usize) -> Result<Option<VaryingLook<'_>>, VaryingImage> {
        let leaf = &self.content.leaves[leaf];
        let look = &self.content.looks[leaf.look as usize];
        look.varying(&leaf.uniforms, &leaf.place).transpose()
    }

    /// Returns true if the background, without an image, depends only on the height z of a unit direction.
    pub fn has_level_background(&self) -> bool {
        let background = self.content.background.as_ref();
        background.is_none_or(DeclaredBackground::is_level)
    }

    /// Returns the look of a face. `paint` provides the images of objects.
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
                look.sheet(sheet, uv, face, paint)
            }
        }
    }

    /// Returns the colour that the face of a solid's leaf has near a point that may be on no face; `None` where it is
    /// undefined. `paint` provides the images of objects.
    pub fn colour_beside(&self, leaf: usize, point: DVec3, paint: &Paint<'_>) -> Option<DVec3> {
        let leaf = &self.content.leaves[leaf];
        let look = &self.content.looks[leaf.look as usize];
        look.colour_beside(&leaf.uniforms, &leaf.place, point, paint)
    }

    /// Returns true if the look of a face may depend on the point.
    pub fn look_varies(&self, face: &Face) -> bool {
        match face.of {
            FaceObject::Solid { leaf, .. } => {
                !matches!(self.content.leaves[leaf].place, FacePlace::Anywhere(_))
            }
            FaceObject::Sheet { .. } => true,
        }
    }

    /// Returns the object that a face belongs to.
    pub fn owner(&self, of: &FaceObject) -> FaceOwner<'_> {
        match *of {
            FaceObject::Solid { solid, leaf, .. } => {
                let solid = &self.content.solids[solid];
                let object = &self.content.objects[solid.object];
                let leaf = &self.content.leaves[leaf];
                let owner = |name: u32| LeafOwner {
                    name: &self.content.names[name as usize],
                    index: (name - solid.first_name) as usize,
                };
                FaceOwner {
                    object,
                    instance: leaf.instance,
                    grids: object.grids_at(&leaf.uniforms),
                    leaf: leaf.name.map(owner),
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

    /// Returns the leaves of the scene's solids in the order of the text, with instances separate: the name of each, and
    /// the highest degree of its bounding polynomials, `None` if it is bounded otherwise.
    pub fn leaves(&self) -> Vec<(&str, Option<usize>)> {
        let mut degrees: Vec<Option<Option<usize>>> = vec![None; self.content.names.len()];
        for (k, leaf) in self.content.leaves.iter().enumerate() {
            if let Some(name) = leaf.name {
                degrees[name as usize].get_or_insert_with(|| self.world.degree(k));
            }
        }
        let names = self.content.names.iter().zip(degrees);
        names
            .filter_map(|(name, degree)| Some((&**name, degree?)))
            .collect()
    }

    /// Returns a box that contains everything bounded; `None` if nothing is.
    pub fn bounds(&self) -> Option<BoundingBox> {
        let solids = (0..self.world.solid_count()).filter_map(|solid| self.world.bounds(solid));
        let all = solids.chain([self.sheets.bounds()]);
        let all = all.filter(|bounds| !bounds.is_empty());
        all.reduce(|a, b| a.union(&b))
    }

    /// Returns true if a solid of the world is known to be empty.
    pub fn is_empty(&self, solid: usize) -> bool {
        let bounds = self.world.bounds(solid);
        bounds.is_some_and(|bounds| bounds.is_empty())
    }

    /// Returns the names of the coordinates of a solid of the world, also of the one that the declaration of a prism omits.
    pub fn coordinates(&self, solid: usize) -> [&str; 3] {
        match self.content.solids[solid].parameters.as_deref() {
            Some([a, b, c]) => [a, b, c],
            Some([a, b]) => {
                let is_free = |name: &&str| ![&**a, b].contains(name);
                [
                    a,
                    b,
                    ["z", "y", "x"].into_iter().find(is_free).unwrap_or("z"),
                ]
            }
            _ => ["x", "y", "z"],
        }
    }

    /// Returns the axes along which a solid of the world has no bound, as advice to cut it.
    pub fn missing_cuts(&self, solid: usize) -> MissingCuts {
        let is_script = self.content.is_script;
        let [x, y, z] = self.world.unbounded_axes(solid);
        let parameters = self.content.solids[solid].parameters.as_deref();
        let is_prism = matches!(parameters, Some([_, _]));
        MissingCuts {
            axes: if is_script { [x, z, y] } else { [x, y, z] },
            coordinates: self.coordinates(solid).map(str::to_owned),
            is_script,
            prism: is_prism.then(|| self.object_of_solid(solid).name.clone()),
        }
    }

    /// Returns a note for each solid without a bounding box.
    pub fn endless(&self) -> impl Iterator<Item = RayNote> {
        let solids = 0..self.world.solid_count();
        let endless = solids.filter(|&solid| self.world.bounds(solid).is_none());
        endless.map(|solid| RayNote {
            object: self.object_of_solid(solid).name.clone(),
            fault: RayFault::Endless(self.missing_cuts(solid)),
        })
    }

    /// Returns the notes on deviations from the declarations. Those that depend on points are known once rays have met them.
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
        notes.extend(background.clone().flat_map(|found| {
            found.faults().map(|fault| RayNote {
                object: found.name.clone(),
                fault,
            })
        }));
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

impl RayContent {
    fn add_solid(&mut self, solid: RaySolid, glass: Option<Glass>, is_opaque: bool) {
        self.solids.push(solid);
        self.glass.push(glass);
        self.opaque.push(is_opaque);
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
