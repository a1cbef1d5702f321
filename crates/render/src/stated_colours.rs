//! The textures of surfaces that state a colour which changes from place to place: expressions in (u, v) in, an image over
//! the domain out.

use std::borrow::Cow;
use std::sync::Arc;

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use rayon::prelude::*;
use scene::{Object, Range, Sampling, Scene};

use crate::content::{self, Content};
use crate::request::{PictureRequest, color_nodes, srgb_of};
use crate::shared::Shared;
use crate::texture::Texture;

/// Texels along u and along v.
const SIDE: u32 = 512;
/// Those of a picture that moves.
const MOVING_SIDE: u32 = 256;
/// Textures that are kept though the last picture has not used them.
const KEPT: usize = 16;

/// Textures of stated colours, by the content of the colour.
#[derive(Debug, Default)]
pub(crate) struct StatedColours {
    /// The one that was used last is the last one.
    known: Vec<(Content, u32, Shared<Texture>)>,
}

impl StatedColours {
    /// The request with the textures of the surfaces that state a colour which changes from place to place, and no image.
    /// The look is that of the first instance.
    pub(crate) fn textured<'r>(&mut self, request: &'r PictureRequest) -> Cow<'r, PictureRequest> {
        let mut whole = Cow::Borrowed(request);
        let side = if request.moving { MOVING_SIDE } else { SIDE };
        for (id, object) in request.scene.numbered() {
            if object.shape.manifold().is_none() || request.own_texture(id).is_some() {
                continue;
            }
            let Some(nodes) = color_nodes(object) else {
                continue;
            };
            let mut inputs = request.scene.graph.inputs(nodes).into_iter();
            if inputs.any(|input| matches!(input, Input::Variable(_))) {
                let texture = self.get(request, object, nodes, side);
                whole.to_mut().textures.push((id, texture));
            }
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

/// The colours at the middles of the texels. What is undefined is white, as a surface without a colour is.
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
