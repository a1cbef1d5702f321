//! Reads the shown objects of a scene, one by one, into a [`RayScene`].

use std::sync::Arc;

use expr::Input;
use glam::DVec3;
use scene::limits::MAX_LEAVES;
use scene::{Attribute, Object, ObjectId, ParamValues, Scene, Shape, Solid, stated_word};
use tracer::shade::{FaceSides, Glass};
use tracer::{Sheet, Sheets, World, WorldBuilder};

use super::attributes::{AffineTape, AttributeSet, NumberAttribute};
use super::bodies::{self, BodyPart, BodyShapes, MAX_BODIES, Thickness};
use super::expand::{ExpandedLeaf, ExpandedSolid, Expansion, Omission, ShapeTable, instance_grids};
use super::look::{FaceImage, FacePlace, LookProgram};
use super::note::{RayFault, RayNote};
use super::stage::{self, DeclaredBackground};
use super::{
    MAX_SHEETS, RayContent, RayLeaf, RayObject, RayScene, RaySceneOptions, RaySolid, SheetFace,
};

/// A scene for rays under construction.
pub(super) struct Draft<'a> {
    scene: &'a Scene,
    params: &'a ParamValues,
    options: &'a RaySceneOptions<'a>,
    table: ShapeTable,
    pub(super) shapes: BodyShapes,
    leaf_room: usize,
    body_room: usize,
    sheets: Vec<Sheet>,
    content: RayContent,
}

impl<'a> Draft<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        params: &'a ParamValues,
        options: &'a RaySceneOptions<'a>,
    ) -> Self {
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
                is_script: scene.is_script(),
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

    /// Returns the image of faces with these attributes.
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

    pub(super) fn solid(
        &mut self,
        builder: &mut WorldBuilder<'_>,
        id: Option<ObjectId>,
        object: &Object,
    ) {
        let Some(solid) = object.shape.solid() else {
            return;
        };
        let Some((expanded, instances)) = self.expanded(object, solid) else {
            return;
        };
        match expanded.build(self.scene, solid, builder, &mut self.table) {
            Ok(()) => {}
            Err(Omission::TooLarge) => return self.note(object, RayFault::TooLarge),
            Err(Omission::TooMuchWork) => return self.note(object, RayFault::TooMuchWork),
            Err(_) => return,
        }
        let first = [self.content.looks.len(), self.content.names.len()].map(|it| it as u32);
        let ray_solid = RaySolid {
            object: self.object(id, object),
            stated_cell: expanded.stated_cell(solid),
            parameters: solid.parameters.clone(),
            first_name: first[1],
        };
        self.add_looks(id, object, solid);
        let glass = self.add_leaves(expanded.leaves, &instances, solid, first);
        let looks = &self.content.looks[first[0] as usize..];
        let is_opaque = looks.iter().all(LookProgram::is_opaque);
        let mut uneven: Vec<&str> = looks.iter().flat_map(LookProgram::uneven).collect();
        uneven.sort_unstable();
        uneven.dedup();
        self.content.add_solid(ray_solid, glass, is_opaque);
        for word in uneven {
            self.note(object, RayFault::NotUniform(word));
        }
    }

    /// Returns the set of all instances of a solid, and for each instance the number of leaves up to its end and its index;
    /// `None` if there are none or too many.
    fn expanded(
        &mut self,
        object: &Object,
        solid: &Solid,
    ) -> Option<(ExpandedSolid, Vec<(usize, u64)>)> {
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
                    return None;
                }
                Err(_) => return None,
            }
        }
        self.leaf_room = expansion.room;
        if singular > 0 {
            let leaf = solid.leaves[whose as usize].name.clone();
            let fault = RayFault::SingularMap {
                skipped: singular,
                instances: count,
                leaf,
            };
            self.note(object, fault);
        }
        (!expanded.leaves.is_empty()).then_some((expanded, instances))
    }

    /// Adds the looks and names of a solid's leaves.
    fn add_looks(&mut self, id: Option<ObjectId>, object: &Object, solid: &Solid) {
        let colour = id.map_or(DVec3::ONE, |id| (self.options.colour)(id));
        let (mut has_unplaced, mut has_places) = (false, false);
        for leaf in &solid.leaves {
            // In a scene script a colour may be brighter than white.
            let bright = self.scene.is_script();
            let attributes = AttributeSet::new(&self.scene.graph, &leaf.attributes, bright);
            let image = self.image(id, &leaf.attributes);
            let is_stated = image.is_some_and(|image| image.stated.is_some());
            has_unplaced |= is_stated && !attributes.states(NumberAttribute::Uv);
            has_places |= attributes.states(NumberAttribute::Uv);
            let picture_look = self.options.picture_look;
            let look = LookProgram::new(&object.name, image, picture_look, colour, attributes);
            self.content.looks.push(look);
            self.content.names.push(leaf.name.clone());
        }
        if has_unplaced {
            self.note(object, RayFault::UnplacedImage);
        } else if !has_places {
            self.content.unplaced.extend(id);
        }
    }

    /// Adds the leaves of a solid's instances, whose looks and names begin at these indices. Returns its glass, if a leaf
    /// has one.
    fn add_leaves(
        &mut self,
        expanded: Vec<ExpandedLeaf>,
        instances: &[(usize, u64)],
        solid: &Solid,
        [first_look, first_name]: [u32; 2],
    ) -> Option<Glass> {
        let RayContent {
            leaves,
            sides,
            looks,
            ..
        } = &mut self.content;
        let mut instance_of = instances.iter();
        let mut current = instance_of.next();
        let mut glass = None;
        for (k, leaf) in expanded.into_iter().enumerate() {
            while current.is_some_and(|(end, _)| *end <= k) {
                current = instance_of.next();
            }
            let look = &looks[(first_look + leaf.leaf) as usize];
            if glass.is_none() {
                let of_leaf = look.glass(&leaf.uniforms);
                glass = of_leaf.map(|glass| Glass {
                    leaf: leaves.len(),
                    ..glass
                });
            }
            let place = look.place(&leaf.uniforms);
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
        glass
    }

    pub(super) fn body(
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
        let ray_solid = RaySolid {
            object: self.object(Some(id), object),
            stated_cell: None,
            parameters: None,
            first_name: self.content.names.len() as u32,
        };
        let colour = (self.options.colour)(id);
        let look = LookProgram::new(
            &object.name,
            None,
            self.options.picture_look,
            colour,
            attributes,
        );
        self.content.add_solid(ray_solid, None, look.is_opaque());
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

    pub(super) fn sheets(&mut self, id: ObjectId, object: &Object) {
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
        let colour = (self.options.colour)(id);
        let image = self.image(Some(id), &object.attributes);
        let picture_look = self.options.picture_look;
        let look = LookProgram::new(&object.name, image, picture_look, colour, attributes);
        let look = look.on_surface(&scene.graph, position);
        self.content.looks.push(look);
        for instance in 0..count.min(room) {
            let uniforms: Arc<[f64]> = params.instance(scene, object, instance).into();
            let number_of = |input: Input| input.value(&[], &uniforms);
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

    pub(super) fn stage(&mut self) {
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

    pub(super) fn finish(mut self, builder: WorldBuilder<'_>) -> RayScene {
        let world = builder.build().unwrap_or_else(|_| {
            // Not expected: each shape has been read, and its bounds in its frame are a part of that. Surfaces are drawn
            // all the same.
            let objects = self.content.solids.iter();
            let notes = objects.map(|solid| RayNote {
                object: self.content.objects[solid.object].name.clone(),
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
