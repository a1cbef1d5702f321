//! The textures of surfaces with a specified colour that varies from point to point. In: expressions in (u, v). Out: an
//! image over the domain.

use std::borrow::Cow;
use std::sync::Arc;

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use rayon::prelude::*;
use scene::{Object, ObjectId, Range, Sampling, Scene};

use crate::content::{self, Content};
use crate::request::{ColourFaults, PictureRequest, colour_nodes, srgb_of};
use crate::shared::Shared;
use crate::texture::{self, MOST_INSTANCES, Texture};

/// The number of texels along u and along v, at most.
const SIDE: u32 = 512;
/// The same for a picture that moves.
const MOVING_SIDE: u32 = 256;
/// The number of textures that are kept although the last picture has not used them.
const KEPT: usize = 16;

/// Textures of specified colours, by the contents of the colour in the instances.
#[derive(Debug, Default)]
pub(crate) struct StatedColours {
    /// The most recently used one is last.
    known: Vec<(Vec<Content>, u32, Shared<Texture>, ColourFaults)>,
    /// The faults of the last request's textures.
    faults: Vec<(ObjectId, ColourFaults)>,
}

impl PictureRequest {
    /// Returns the request with the colours that surfaces specify and that vary from point to point as images, and notes about
    /// what images cannot show of them.
    pub fn with_stated_colours(&self) -> (Cow<'_, Self>, Vec<String>) {
        let whole = StatedColours::default().textured(self);
        let notes = notes(&whole);
        (whole, notes)
    }

    /// Returns the colours of the samples of a surface's instance, sRGB, u fastest, if the surface specifies a colour that
    /// varies from point to point and no image. Undefined ones are white.
    pub fn stated_colours_at_samples(&self, id: ObjectId, instance: u64) -> Option<Vec<[u8; 3]>> {
        let (_, object, nodes) = varying(self).find(|(other, ..)| *other == id)?;
        let parameters = [0, 1].map(|k| -> Vec<f64> {
            let sampling = &object.shape.domain()[k];
            (0..sampling.count)
                .map(|index| sampling.value(index))
                .collect()
        });
        let uniforms = self.params.instance(&self.scene, object, instance);
        let (texels, _) = colours(&self.scene, nodes, &parameters, &uniforms);
        Some(texels.into_iter().map(|[r, g, b, _]| [r, g, b]).collect())
    }
}

impl StatedColours {
    /// Returns the request with textures for the surfaces that specify a varying colour and no image.
    pub(crate) fn textured<'r>(&mut self, request: &'r PictureRequest) -> Cow<'r, PictureRequest> {
        let mut whole = Cow::Borrowed(request);
        let side = if request.moving { MOVING_SIDE } else { SIDE };
        self.faults.clear();
        for (id, object, nodes) in varying(request) {
            let (texture, faults) = self.get(request, object, nodes, side);
            self.faults.push((id, faults));
            whole.to_mut().textures.push((id, texture));
        }
        let most = KEPT.max(whole.textures.len());
        let old = self.known.len().saturating_sub(most);
        self.known.drain(..old);
        whole
    }

    fn get(
        &mut self,
        request: &PictureRequest,
        object: &Object,
        nodes: &[NodeId],
        most_side: u32,
    ) -> (Shared<Texture>, ColourFaults) {
        let (scene, params) = (&request.scene, &request.params);
        let count = params.instance_count(scene, object).min(MOST_INSTANCES);
        let instances = (1..count).map(|index| params.instance(scene, object, index));
        let mut uniforms = vec![params.first_instance(scene, object)];
        uniforms.extend(instances);
        let domain = object.shape.domain();
        let content =
            |uniforms: &Vec<f64>| content::expressions(&scene.graph, nodes, domain, uniforms);
        let mut contents: Vec<Content> = uniforms.iter().map(content).collect();
        if contents.iter().all(|other| *other == contents[0]) {
            contents.truncate(1);
        }
        uniforms.truncate(contents.len());
        let side = texture::side(contents.len() as u64, most_side);
        let mut known = self.known.iter();
        let entry = match known.position(|(known, size, ..)| *known == contents && *size == side) {
            Some(at) => self.known.remove(at),
            None => {
                let baked = uniforms
                    .iter()
                    .map(|it| baked(scene, nodes, domain, it, side));
                let (textures, faults): (Vec<Texture>, Vec<ColourFaults>) = baked.unzip();
                let texture = Texture::of_instances(textures.into_iter());
                let faults = faults.into_iter().reduce(ColourFaults::join);
                (
                    contents,
                    side,
                    Arc::new(texture).into(),
                    faults.unwrap_or_default(),
                )
            }
        };
        let found = (entry.2.clone(), entry.3);
        self.known.push(entry);
        found
    }

    /// Returns sentences about what a request with textures shows otherwise than its `shown` objects specify.
    pub(crate) fn notes(
        &self,
        request: &PictureRequest,
        shown: &dyn Fn(ObjectId) -> bool,
    ) -> Vec<String> {
        let mut notes = match request.view.space() {
            Some(_) => notes(request),
            None => Vec::new(),
        };
        // The colours of a script are used as they are.
        let objects = request.scene.numbered().filter(|(id, object)| {
            let is_solid = object.shape.solid().is_some();
            shown(*id) && !is_solid && !request.scene.is_script()
        });
        for (id, object) in objects {
            if request.shows_curvature_of(id) {
                continue;
            }
            let varying = self.faults.iter().find(|(other, _)| *other == id);
            let faults = varying.map(|(_, faults)| *faults);
            let faults = faults.unwrap_or_else(|| request.colour_faults(object));
            notes.extend(faults.notes(&object.name));
        }
        notes
    }
}

/// Returns the surfaces that specify a varying colour and no image, with the numbers of the colour.
fn varying(request: &PictureRequest) -> impl Iterator<Item = (ObjectId, &Object, &[NodeId])> {
    let surfaces = request.scene.numbered().filter(|(id, object)| {
        object.shape.manifold().is_some() && request.own_texture(*id).is_none()
    });
    surfaces.filter_map(|(id, object)| {
        let nodes = colour_nodes(object)?;
        let mut inputs = request.scene.graph.inputs(nodes).into_iter();
        let varies = inputs.any(|input| matches!(input, Input::Variable(_)));
        varies.then_some((id, object, nodes))
    })
}

/// Returns sentences about the surfaces in space with more instances than images, in a request with these.
fn notes(request: &PictureRequest) -> Vec<String> {
    let (scene, params) = (&*request.scene, &*request.params);
    let options = request.view.space();
    let shown = scene.numbered().filter(|(id, object)| {
        object.shape.is_surface() && options.is_none_or(|options| options.shows(*id))
    });
    let many = shown.filter(|(id, object)| {
        let texture = request.chosen_texture(*id);
        let differs = texture.is_some_and(|texture| texture.arc().instances().count() > 1);
        differs && params.instance_count(scene, object) > MOST_INSTANCES
    });
    let sentence = |object: &Object| {
        format!(
            "the instances of `{}` from number {MOST_INSTANCES} on have the colours of that one",
            object.name
        )
    };
    many.map(|(_, object)| sentence(object)).collect()
}

/// Returns the colours at the centres of the texels.
fn baked(
    scene: &Scene,
    nodes: &[NodeId],
    domain: &[Sampling],
    uniforms: &[f64],
    side: u32,
) -> (Texture, ColourFaults) {
    let centres = [0, 1].map(|k| -> Vec<f64> {
        let Range { min, max } = domain[k].range;
        let at = |texel| min + (max - min) * (f64::from(texel) + 0.5) / f64::from(side);
        (0..side).map(at).collect()
    });
    let (texels, faults) = colours(scene, nodes, &centres, uniforms);
    (Texture::of_texels([side; 2], texels), faults)
}

/// Returns the opaque colours at all pairs of parameters u and v, u fastest, and their faults. Undefined ones are white, like
/// a surface without a colour.
fn colours(
    scene: &Scene,
    nodes: &[NodeId],
    [us, vs]: &[Vec<f64>; 2],
    uniforms: &[f64],
) -> (Vec<[u8; 4]>, ColourFaults) {
    let tape = Tape::new(&scene.graph, nodes);
    let mut texels = vec![[255; 4]; us.len() * vs.len()];
    let rows = texels.par_chunks_mut(us.len()).zip(vs);
    let faults = rows.map_init(Registers::default, |registers, (texels, &v)| {
        let mut faults = ColourFaults::default();
        let mut values = vec![f64::NAN; tape.root_count()];
        for (texel, &u) in texels.iter_mut().zip(us) {
            let inputs = tape.inputs().iter();
            let inputs: Vec<f64> = inputs.map(|it| it.value(&[u, v], uniforms)).collect();
            tape.eval(registers, &inputs, &mut values);
            faults.add(&values);
            if let Some(colour) = srgb_of(&values) {
                let [r, g, b] = colour.map(|part| (255.0 * part).round() as u8);
                *texel = [r, g, b, 255];
            }
        }
        faults
    });
    let faults = faults.reduce(ColourFaults::default, ColourFaults::join);
    (texels, faults)
}
