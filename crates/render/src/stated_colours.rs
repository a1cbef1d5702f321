//! The textures of surfaces with a specified colour that varies from point to point. In: expressions in (u, v). Out: an
//! image over the domain.

use std::borrow::Cow;
use std::sync::Arc;

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use rayon::prelude::*;
use scene::{Object, ObjectId, Range, Sampling, Scene};

use crate::content::{self, Content};
use crate::request::{PictureRequest, colour_nodes, srgb_of};
use crate::shared::Shared;
use crate::texture::Texture;

/// The number of texels along u and along v.
const SIDE: u32 = 512;
/// The same for a picture that moves.
const MOVING_SIDE: u32 = 256;
/// The number of textures that are kept although the last picture has not used them.
const KEPT: usize = 16;
/// The maximum number of instances that are compared.
const COMPARED: u64 = 256;

/// Textures of specified colours, by the content of the colour.
#[derive(Debug, Default)]
pub(crate) struct StatedColours {
    /// The most recently used one is last.
    known: Vec<(Content, u32, Shared<Texture>)>,
}

impl PictureRequest {
    /// Returns the request with the colours that surfaces specify and that vary from point to point as images, and notes about
    /// what images cannot show of them.
    pub fn with_stated_colours(&self) -> (Cow<'_, Self>, Vec<String>) {
        (StatedColours::default().textured(self), notes(self))
    }
}

impl StatedColours {
    /// Returns the request with textures for the surfaces that specify a varying colour and no image. They show the first
    /// instance.
    pub(crate) fn textured<'r>(&mut self, request: &'r PictureRequest) -> Cow<'r, PictureRequest> {
        let mut whole = Cow::Borrowed(request);
        let side = if request.moving { MOVING_SIDE } else { SIDE };
        for (id, object, nodes) in varying(request) {
            let texture = self.get(request, object, nodes, side);
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
        side: u32,
    ) -> Shared<Texture> {
        let uniforms = request.params.first_instance(&request.scene, object);
        let domain = object.shape.domain();
        let graph = &request.scene.graph;
        let content = content::expressions(graph, nodes, domain, &uniforms);
        let mut known = self.known.iter();
        let entry = match known.position(|(known, size, _)| *known == content && *size == side) {
            Some(at) => self.known.remove(at),
            None => {
                let texture = baked(&request.scene, nodes, domain, &uniforms, side);
                (content, side, Arc::new(texture).into())
            }
        };
        let texture = entry.2.clone();
        self.known.push(entry);
        texture
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

/// Returns sentences about the surfaces in space whose colour varies from point to point and between instances: an image for
/// each instance would need too much memory.
pub(crate) fn notes(request: &PictureRequest) -> Vec<String> {
    let (scene, params) = (&*request.scene, &*request.params);
    let options = request.view.space();
    let shown = varying(request).filter(|(id, object, _)| {
        object.shape.is_surface() && options.is_none_or(|options| options.shows(*id))
    });
    let differs = |object: &Object, nodes: &[NodeId]| {
        let count = params.instance_count(scene, object).min(COMPARED);
        let inputs = scene.graph.inputs(nodes);
        let of_instance = |index: u64| -> Vec<u64> {
            let uniforms = params.instance(scene, object, index);
            let number = |input: &Input| match *input {
                Input::Uniform(k) => uniforms.get(k as usize).map(|number| number.to_bits()),
                Input::Variable(_) => None,
            };
            inputs.iter().filter_map(number).collect()
        };
        count > 1 && (1..count).any(|index| of_instance(index) != of_instance(0))
    };
    let differing = shown.filter(|(_, object, nodes)| differs(object, nodes));
    let sentence = |object: &Object| {
        format!(
            "all instances of `{}` have the colours of the first one: its `color` depends on the place and on a grid; the traced \
             view shows those of each",
            object.name
        )
    };
    differing.map(|(_, object, _)| sentence(object)).collect()
}

/// Returns the colours at the centres of the texels. Undefined ones are white, like a surface without a colour.
fn baked(
    scene: &Scene,
    nodes: &[NodeId],
    domain: &[Sampling],
    uniforms: &[f64],
    side: u32,
) -> Texture {
    let tape = Tape::new(&scene.graph, nodes);
    let at = |k: usize, texel: u32| {
        let Range { min, max } = domain[k].range;
        min + (max - min) * (f64::from(texel) + 0.5) / f64::from(side)
    };
    let mut texels = vec![[255; 4]; (side * side) as usize];
    let rows = texels.par_chunks_mut(side as usize).zip(0..side);
    rows.for_each_init(Registers::default, |registers, (texels, row)| {
        let v = at(1, row);
        let mut values = vec![f64::NAN; tape.root_count()];
        for (texel, column) in texels.iter_mut().zip(0..side) {
            let u = at(0, column);
            let number = |input: &Input| match *input {
                Input::Variable(0) => u,
                Input::Variable(1) => v,
                Input::Variable(_) => f64::NAN,
                Input::Uniform(k) => uniforms.get(k as usize).copied().unwrap_or(f64::NAN),
            };
            let inputs: Vec<f64> = tape.inputs().iter().map(number).collect();
            tape.eval(registers, &inputs, &mut values);
            if let Some(colour) = srgb_of(&values) {
                let [r, g, b] = colour.map(|part| (255.0 * part).round() as u8);
                *texel = [r, g, b, 255];
            }
        }
    });
    Texture::of_texels([side; 2], texels)
}
