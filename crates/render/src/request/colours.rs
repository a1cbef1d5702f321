//! The colours of objects and of their instances: those that the program specifies, otherwise those that were chosen,
//! otherwise those of [`crate::style`].

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use geometry::MAX_POINTS;
use geometry::solids::{ROUNDING, RayFault, RayNote};
use scene::{AttributeValue, Object, ObjectId, ParamValues, Scene};

use super::PictureRequest;
use crate::style;

impl PictureRequest {
    /// Returns true if a colour that was chosen for an object is not shown, because the program states one: that of a surface
    /// which differs from place to place is multiplied by it.
    pub fn keeps_stated_colour(&self, object: ObjectId) -> bool {
        let is_stated_solid =
            |object: &Object| object.shape.solid().is_some() && colour_nodes(object).is_some();
        self.states_colour(object) || self.scene.get(object).is_some_and(is_stated_solid)
    }

    /// Returns true if an object is coloured by its curvature: the colours of a scale are not multiplied by its own.
    pub fn shows_curvature_of(&self, object: ObjectId) -> bool {
        let texture = self.own_texture(object);
        self.curved.contains(&object) || texture.is_some_and(|it| it.curvature_scale().is_some())
    }

    /// Returns true if an object specifies a colour that is the same at all points of an instance.
    pub(super) fn states_colour(&self, object: ObjectId) -> bool {
        let stated = || StatedColour::of(&self.scene, self.scene.get(object)?);
        stated().is_some_and(|mut stated| {
            let mut instances = stated.instances(&self.params);
            instances.any(|colour| colour.is_some())
        })
    }

    /// Returns the faults of a colour that is the same at all points of an instance.
    pub(crate) fn colour_faults(&self, object: &Object) -> ColourFaults {
        let mut faults = ColourFaults::default();
        if let Some(mut stated) = StatedColour::of(&self.scene, object) {
            let instances = stated.numbers(&self.params);
            instances.for_each(|numbers| faults.add(&numbers));
        }
        faults
    }

    /// Returns the colours of all objects, sRGB, in their order; those of the first instances.
    pub fn object_colours(&self) -> Vec<[u8; 3]> {
        let base = self.unstated_colours();
        let colours = self.scene.numbered().zip(base).map(|((id, object), base)| {
            if self.shows_curvature_of(id) {
                return base.under_curvature();
            }
            let stated = StatedColour::of(&self.scene, object);
            let first = stated.and_then(|mut stated| stated.instances(&self.params).next());
            base.or_stated(first.flatten())
        });
        colours.collect()
    }

    /// Returns the colours of the instances of all objects, sRGB, in their order: at least one for each object, of which the
    /// last is that of all further instances.
    pub fn instance_colours(&self) -> Vec<Vec<[u8; 3]>> {
        let base = self.unstated_colours();
        let colours = self.scene.numbered().zip(base).map(|((id, object), base)| {
            if self.shows_curvature_of(id) {
                return vec![base.under_curvature()];
            }
            let Some(mut stated) = StatedColour::of(&self.scene, object) else {
                return vec![base.or_stated(None)];
            };
            let instances = stated.instances(&self.params);
            let mut all: Vec<[u8; 3]> = instances.map(|it| base.or_stated(it)).collect();
            if all.is_empty() {
                all.push(base.or_stated(None));
            }
            if all.iter().all(|colour| *colour == all[0]) {
                all.truncate(1);
            }
            all
        });
        colours.collect()
    }

    /// Returns the colour of an object, sRGB; that of its first instance.
    pub fn srgb(&self, object: ObjectId) -> [u8; 3] {
        let colours = self.object_colours();
        let own = colours.get(object.index());
        own.copied().unwrap_or(style::SURFACE_COLOUR)
    }

    /// Returns the colours of objects that specify none.
    fn unstated_colours(&self) -> Vec<UnstatedColour> {
        let usual = style::colours(&self.scene, self.theme, self.shows_curvature());
        let both = usual.into_iter().map(|usual| UnstatedColour {
            usual,
            chosen: usual,
        });
        let mut colours: Vec<UnstatedColour> = both.collect();
        for (id, colour) in &self.colours {
            if let Some(place) = colours.get_mut(id.index()) {
                place.chosen = *colour;
            }
        }
        colours
    }
}

/// The colour, sRGB, of an object that specifies none.
#[derive(Clone, Copy)]
struct UnstatedColour {
    usual: [u8; 3],
    chosen: [u8; 3],
}

impl UnstatedColour {
    /// Returns the factor of the colours of curvature: the usual white, dim for an outdated surface.
    fn under_curvature(self) -> [u8; 3] {
        let dim = style::dimmed(self.usual);
        if self.chosen == dim { dim } else { self.usual }
    }

    /// Returns the specified colour, which takes precedence over a chosen one; an outdated object is still dimmed.
    fn or_stated(self, stated: Option<[f64; 3]>) -> [u8; 3] {
        let Some(stated) = stated else {
            return self.chosen;
        };
        let brightest = |colour: [u8; 3]| f64::from(colour.into_iter().fold(1, u8::max));
        let dim = (brightest(self.chosen) / brightest(self.usual)).min(1.0);
        stated.map(|part| (255.0 * dim * part).round() as u8)
    }
}

/// A specified colour that is the same at all points of an instance.
struct StatedColour<'a> {
    scene: &'a Scene,
    object: &'a Object,
    tape: Tape,
    registers: Registers,
    /// True if it reads nothing that differs between instances.
    is_one: bool,
}

impl<'a> StatedColour<'a> {
    /// Returns the colour that an object specifies; `None` if it differs from point to point, and for a solid, whose faces
    /// have colours of their own.
    fn of(scene: &'a Scene, object: &'a Object) -> Option<Self> {
        let nodes = colour_nodes(object).filter(|_| object.shape.solid().is_none())?;
        let inputs = scene.graph.inputs(nodes);
        let varies = |input: &Input| matches!(input, Input::Variable(_));
        if inputs.iter().any(varies) {
            return None;
        }
        let params = || scene.params.iter();
        let is_param = |input: &Input| match *input {
            Input::Uniform(k) => params().any(|param| {
                let first = param.first_uniform as usize;
                (first..first + param.ranges.len()).contains(&(k as usize))
            }),
            Input::Variable(_) => false,
        };
        Some(Self {
            scene,
            object,
            tape: Tape::new(&scene.graph, nodes),
            registers: Registers::default(),
            is_one: inputs.iter().all(is_param),
        })
    }

    /// Returns the colours of the instances, sRGB from 0 to 1, in their order: a single one if all are equal, `None` where
    /// the colour is undefined.
    fn instances(&mut self, params: &ParamValues) -> impl Iterator<Item = Option<[f64; 3]>> {
        self.numbers(params).map(|numbers| srgb_of(&numbers))
    }

    /// Returns the numbers of the instances, as [`StatedColour::instances`] does their colours.
    fn numbers(&mut self, params: &ParamValues) -> impl Iterator<Item = Vec<f64>> {
        let count = match self.is_one {
            true => 1,
            false => params
                .instance_count(self.scene, self.object)
                .min(MAX_POINTS),
        };
        (0..count).map(move |index| {
            let uniforms = params.instance(self.scene, self.object, index);
            self.at(&uniforms)
        })
    }

    fn at(&mut self, uniforms: &[f64]) -> Vec<f64> {
        let inputs = self.tape.inputs().iter();
        let inputs: Vec<f64> = inputs.map(|it| it.value(&[], uniforms)).collect();
        let mut out = vec![f64::NAN; self.tape.root_count()];
        self.tape.eval(&mut self.registers, &inputs, &mut out);
        out
    }
}

/// The deviations of a colour from the numbers that an object specifies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ColourFaults {
    is_undefined: bool,
    is_clamped: bool,
}

impl ColourFaults {
    /// Adds those of a colour with these numbers.
    pub(crate) fn add(&mut self, numbers: &[f64]) {
        let outside = |part: f64| (part - part.clamp(0.0, 1.0)).abs() > ROUNDING;
        match numbers.iter().all(|part| part.is_finite()) {
            true => self.is_clamped |= numbers.iter().any(|part| outside(*part)),
            false => self.is_undefined = true,
        }
    }

    /// Adds those of other colours.
    pub(crate) fn join(self, other: Self) -> Self {
        Self {
            is_undefined: self.is_undefined || other.is_undefined,
            is_clamped: self.is_clamped || other.is_clamped,
        }
    }

    /// Returns the sentences about an object with them.
    pub(crate) fn notes(self, object: &str) -> impl Iterator<Item = String> {
        let undefined = RayFault::UndefinedAttribute("color");
        let clamped = RayFault::ClampedAttribute("color");
        let faults = [(self.is_undefined, undefined), (self.is_clamped, clamped)];
        let faults = faults.into_iter().filter(|(is_there, _)| *is_there);
        faults.map(move |(_, fault)| {
            let object = object.to_owned();
            RayNote { object, fault }.to_string()
        })
    }
}

/// Returns the colour, sRGB from 0 to 1, of a grey value or of red, green and blue; `None` if it is undefined.
pub(crate) fn srgb_of(numbers: &[f64]) -> Option<[f64; 3]> {
    let colour = match *numbers {
        [grey] => [grey; 3],
        [red, green, blue] => [red, green, blue],
        _ => return None,
    };
    let is_defined = colour.iter().all(|part| part.is_finite());
    is_defined.then(|| colour.map(|part| part.clamp(0.0, 1.0)))
}

/// Returns the numbers of the colour that an object specifies.
pub(crate) fn colour_nodes(object: &Object) -> Option<&[NodeId]> {
    let stated = object.attributes.iter().find(|it| it.word == "color")?;
    match &stated.value {
        AttributeValue::Numbers(nodes) => Some(nodes),
        AttributeValue::Word(_) => None,
    }
}
