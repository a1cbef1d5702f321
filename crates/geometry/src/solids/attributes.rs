//! Attributes: expressions that an object states, as numbers at a point.
//!
//! In: the attributes of an object or of a leaf, and the coordinates of a point. Out: numbers within their ranges, and
//! the attributes that were out of range or undefined.

use std::cell::{Cell, RefCell};
use std::sync::atomic::{AtomicU32, Ordering};

use expr::tape::{Registers, Tape};
use expr::{Graph, Input, NodeId};
use glam::{DAffine3, DMat3, DVec3};
use scene::{AffineNodes, Attribute, AttributeValue, stated_word};

/// Attributes whose values are numbers.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[repr(u8)]
pub(super) enum NumberAttribute {
    Colour,
    Mirror,
    Glass,
    Ior,
    Depth,
    Diffuse,
    Specular,
    Shininess,
    Bump,
    Uv,
    Radius,
    Power,
    Ambient,
    Falloff,
    Angle,
    Soft,
    Size,
    Fov,
    Focus,
    Aperture,
    Roll,
    Turn,
}

use NumberAttribute as A;

/// All attributes, each at its discriminant.
const ALL: [(A, &str); 22] = [
    (A::Colour, "color"),
    (A::Mirror, "mirror"),
    (A::Glass, "glass"),
    (A::Ior, "ior"),
    (A::Depth, "depth"),
    (A::Diffuse, "diffuse"),
    (A::Specular, "specular"),
    (A::Shininess, "shininess"),
    (A::Bump, "bump"),
    (A::Uv, "uv"),
    (A::Radius, "radius"),
    (A::Power, "power"),
    (A::Ambient, "ambient"),
    (A::Falloff, "falloff"),
    (A::Angle, "angle"),
    (A::Soft, "soft"),
    (A::Size, "size"),
    (A::Fov, "fov"),
    (A::Focus, "focus"),
    (A::Aperture, "aperture"),
    (A::Roll, "roll"),
    (A::Turn, "turn"),
];

/// The smallest number without a unit that counts as positive.
const POSITIVE: f64 = 1e-12;
/// A number that is out of range by at most this is within it: at the edge of a surface, a parameter exceeds its interval by
/// rounding.
pub const ROUNDING: f64 = 1e-9;
/// The maximum opening angle of a camera that is not spherical: its picture is scaled by the tangent of half the angle.
const WIDEST: f64 = std::f64::consts::PI * (1.0 - 1e-9);

impl A {
    fn of(word: &str) -> Option<Self> {
        let mut all = ALL.iter();
        all.find(|(_, other)| *other == word)
            .map(|(found, _)| *found)
    }

    fn bit(self) -> u32 {
        1 << self as u8
    }

    /// Returns the range of an attribute of a set.
    fn range(self, set: &AttributeSet) -> [f64; 2] {
        match self {
            A::Colour if !set.bright => [0.0, 1.0],
            A::Mirror | A::Glass | A::Soft => [0.0, 1.0],
            A::Ior | A::Shininess => [POSITIVE, f64::MAX],
            // Lengths have any scale.
            A::Depth | A::Focus => [f64::MIN_POSITIVE, f64::MAX],
            A::Fov => [POSITIVE, set.widest],
            A::Bump | A::Uv | A::Roll | A::Turn => [f64::MIN, f64::MAX],
            _ => [0.0, f64::MAX],
        }
    }
}

/// The attributes of one object or leaf.
#[derive(Debug)]
pub(super) struct AttributeSet {
    groups: Vec<AttributeGroup>,
    /// True for colours that may exceed 1: those of lights and of backgrounds.
    bright: bool,
    /// The maximum opening angle of a camera with its projection.
    widest: f64,
    faults: AttributeFaults,
}

/// Attributes that are stated in the same coordinates.
#[derive(Debug)]
struct AttributeGroup {
    /// The map from these coordinates to the scene's.
    map: Option<AffineTape>,
    tape: Tape,
    slots: Vec<Slot>,
    /// The roots of the tape, if one of them depends on the point.
    varying: Option<(Graph, Vec<NodeId>)>,
}

/// The roots of an attribute.
#[derive(Clone, Copy, Debug)]
struct Slot {
    attribute: A,
    first: usize,
    width: usize,
    /// True if a value depends on the point.
    varies: bool,
}

/// The attributes of a group that depend on the point.
pub(super) struct VaryingAttributes<'a> {
    /// The expressions' graph.
    pub(super) graph: &'a Graph,
    /// The index of the group.
    pub(super) group: usize,
    /// Each attribute with the roots that are its numbers.
    pub(super) attributes: Vec<(A, &'a [NodeId])>,
}

/// The attributes that were out of range or undefined somewhere, as bits.
#[derive(Debug, Default)]
struct AttributeFaults {
    clamped: AtomicU32,
    undefined: AtomicU32,
}

/// The fault of an attribute's numbers at a point.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum NumberFault {
    Undefined,
    Clamped,
}

/// The numbers of an attribute at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct AttributeNumbers {
    pub(super) attribute: A,
    values: [f64; 4],
    width: usize,
    /// The group that it belongs to.
    pub(super) group: usize,
}

/// An affine map whose numbers depend on uniforms.
#[derive(Debug)]
pub(super) struct AffineTape(Tape);

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

#[derive(Default)]
struct Scratch {
    registers: Registers,
    inputs: Vec<f64>,
    out: Vec<f64>,
}

/// Evaluates a tape over variables and uniforms, with NaN for an input that does not exist.
pub(super) fn evaluated<R>(
    tape: &Tape,
    variables: &[f64],
    uniforms: &[f64],
    read: impl FnOnce(&[f64]) -> R,
) -> R {
    SCRATCH.with_borrow_mut(|scratch| {
        let inputs = tape.inputs().iter();
        scratch.inputs.clear();
        scratch
            .inputs
            .extend(inputs.map(|it| it.value(variables, uniforms)));
        scratch.out.clear();
        scratch.out.resize(tape.root_count(), f64::NAN);
        tape.eval(&mut scratch.registers, &scratch.inputs, &mut scratch.out);
        read(&scratch.out)
    })
}

impl AffineTape {
    pub(super) fn new(graph: &Graph, map: &AffineNodes) -> Self {
        Self(Tape::new(graph, map.0.as_flattened()))
    }

    pub(super) fn at(&self, uniforms: &[f64]) -> DAffine3 {
        evaluated(&self.0, &[], uniforms, |rows| {
            let column = |k: usize| DVec3::new(rows[k], rows[4 + k], rows[8 + k]);
            DAffine3 {
                matrix3: DMat3::from_cols(column(0), column(1), column(2)),
                translation: column(3),
            }
        })
    }
}

impl AttributeSet {
    /// Compiles attributes. `bright` is true for those of lights and backgrounds. A height with too large a gradient is
    /// omitted.
    pub(super) fn new(graph: &Graph, attributes: &[Attribute], bright: bool) -> Self {
        let mut maps: Vec<Option<AffineNodes>> = Vec::new();
        let mut members: Vec<Vec<(A, &[NodeId])>> = Vec::new();
        for stated in attributes {
            let AttributeValue::Numbers(nodes) = &stated.value else {
                continue;
            };
            let Some(attribute) = A::of(stated.word) else {
                continue;
            };
            let group = maps.iter().position(|map| *map == stated.map);
            let group = group.unwrap_or_else(|| {
                maps.push(stated.map);
                members.push(Vec::new());
                maps.len() - 1
            });
            members[group].push((attribute, nodes));
        }
        let groups = maps.iter().zip(&members);
        let groups = groups.map(|(map, members)| AttributeGroup::new(graph, map.as_ref(), members));
        Self {
            groups: groups.collect(),
            bright,
            widest: match stated_word(attributes, "projection") {
                Some("spherical") => std::f64::consts::TAU,
                _ => WIDEST,
            },
            faults: AttributeFaults::default(),
        }
    }

    /// Returns true if the set states the attribute.
    pub(super) fn states(&self, attribute: A) -> bool {
        let mut slots = self.groups.iter().flat_map(|group| &group.slots);
        slots.any(|slot| slot.attribute == attribute)
    }

    /// Returns true if a value depends on the point.
    pub(super) fn varies(&self) -> bool {
        self.groups.iter().any(|group| group.varying.is_some())
    }

    /// Returns true if the values of the attribute depend on the point.
    pub(super) fn varies_by(&self, attribute: A) -> bool {
        let mut slots = self.groups.iter().flat_map(|group| &group.slots);
        slots.any(|slot| slot.varies && slot.attribute == attribute)
    }

    /// Returns the attributes that depend on the point.
    pub(super) fn varying(&self) -> impl Iterator<Item = VaryingAttributes<'_>> {
        let groups = self.groups.iter().enumerate();
        groups.filter_map(|(number, group)| {
            let (graph, roots) = group.varying.as_ref()?;
            let slots = group.slots.iter().filter(|slot| slot.varies);
            Some(VaryingAttributes {
                graph,
                group: number,
                attributes: slots
                    .map(|slot| (slot.attribute, &roots[slot.first..slot.first + slot.width]))
                    .collect(),
            })
        })
    }

    /// Returns true if colours may exceed 1.
    pub(super) fn is_bright(&self) -> bool {
        self.bright
    }

    /// Passes the numbers of the attributes that are the same everywhere to `found`, as [`AttributeSet::at`] does.
    pub(super) fn constant(&self, uniforms: &[f64], mut found: impl FnMut(&AttributeNumbers)) {
        for (k, group) in self.groups.iter().enumerate() {
            evaluated(&group.tape, &[], uniforms, |out| {
                let slots = group.slots.iter().filter(|slot| !slot.varies);
                let note = |slot: &Slot, fault| self.note(slot, fault);
                let numbers = slots.filter_map(|slot| self.read(slot, k, out, note));
                numbers.collect::<Vec<_>>().iter().for_each(&mut found);
            });
        }
    }

    /// Returns, for each group, the map from the scene's coordinates to those in which it is stated.
    pub(super) fn frames(&self, uniforms: &[f64]) -> Vec<DAffine3> {
        let frame = |group: &AttributeGroup| match &group.map {
            Some(map) => map.at(uniforms).inverse(),
            None => DAffine3::IDENTITY,
        };
        self.groups.iter().map(frame).collect()
    }

    /// Passes each attribute's numbers, within their range, to `found`. `variables` returns the coordinates of the point
    /// for a group; an attribute that is undefined there is omitted.
    pub(super) fn at(
        &self,
        uniforms: &[f64],
        variables: impl Fn(usize) -> [f64; 3],
        found: impl FnMut(&AttributeNumbers),
    ) {
        self.of(|_| true, uniforms, variables, found);
    }

    /// Passes the numbers of the `wanted` attributes to `found`, as [`AttributeSet::at`] does for all.
    pub(super) fn of(
        &self,
        wanted: impl Fn(A) -> bool,
        uniforms: &[f64],
        variables: impl Fn(usize) -> [f64; 3],
        found: impl FnMut(&AttributeNumbers),
    ) {
        let note = |slot: &Slot, fault| self.note(slot, fault);
        self.each(wanted, uniforms, variables, note, found);
    }

    /// Passes the numbers of the `wanted` attributes to `found` as [`AttributeSet::of`] does, at a point that may be on no
    /// face: faults there are not noted. Returns false if one of the attributes is undefined.
    pub(super) fn beside(
        &self,
        wanted: impl Fn(A) -> bool,
        uniforms: &[f64],
        variables: impl Fn(usize) -> [f64; 3],
        found: impl FnMut(&AttributeNumbers),
    ) -> bool {
        let is_undefined = Cell::new(false);
        let note = |_: &Slot, fault| {
            if fault == NumberFault::Undefined {
                is_undefined.set(true);
            }
        };
        self.each(wanted, uniforms, variables, note, found);
        !is_undefined.get()
    }

    fn each(
        &self,
        wanted: impl Fn(A) -> bool,
        uniforms: &[f64],
        variables: impl Fn(usize) -> [f64; 3],
        note: impl Fn(&Slot, NumberFault),
        mut found: impl FnMut(&AttributeNumbers),
    ) {
        for (k, group) in self.groups.iter().enumerate() {
            let place = if group.varying.is_some() {
                variables(k)
            } else {
                [f64::NAN; 3]
            };
            let mut all: [Option<AttributeNumbers>; ALL.len()] = [None; ALL.len()];
            evaluated(&group.tape, &place, uniforms, |out| {
                let slots = group.slots.iter().filter(|slot| wanted(slot.attribute));
                for (slot, into) in slots.zip(&mut all) {
                    *into = self.read(slot, k, out, &note);
                }
            });
            all.iter().flatten().for_each(&mut found);
        }
    }

    fn note(&self, slot: &Slot, fault: NumberFault) {
        let bits = match fault {
            NumberFault::Undefined => &self.faults.undefined,
            NumberFault::Clamped => &self.faults.clamped,
        };
        bits.fetch_or(slot.attribute.bit(), Ordering::Relaxed);
    }

    /// Returns the numbers of a slot; `None` where they are undefined. Passes faults to `note`.
    fn read(
        &self,
        slot: &Slot,
        group: usize,
        out: &[f64],
        note: impl Fn(&Slot, NumberFault),
    ) -> Option<AttributeNumbers> {
        let attribute = slot.attribute;
        let given = &out[slot.first..slot.first + slot.width];
        if given.iter().any(|number| !number.is_finite()) {
            note(slot, NumberFault::Undefined);
            return None;
        }
        let [least, most] = attribute.range(self);
        let mut values = [0.0; 4];
        for (value, &number) in values.iter_mut().zip(given) {
            *value = number.clamp(least, most);
            // A number that must be positive is not rounded to one.
            let is_rounding =
                (*value - number).abs() <= ROUNDING && (least <= 0.0 || *value > least);
            if *value != number && !is_rounding {
                note(slot, NumberFault::Clamped);
            }
        }
        Some(AttributeNumbers {
            attribute,
            values,
            width: slot.width,
            group,
        })
    }

    /// Returns the attributes that were undefined somewhere, and those that were out of range.
    pub(super) fn faults(&self) -> [Vec<&'static str>; 2] {
        let words = |bits: &AtomicU32| {
            let bits = bits.load(Ordering::Relaxed);
            let all = ALL
                .iter()
                .filter(|(attribute, _)| bits & attribute.bit() != 0);
            all.map(|(_, word)| *word).collect()
        };
        [words(&self.faults.undefined), words(&self.faults.clamped)]
    }
}

impl AttributeGroup {
    fn new(graph: &Graph, map: Option<&AffineNodes>, members: &[(A, &[NodeId])]) -> Self {
        let all: Vec<NodeId> = members
            .iter()
            .flat_map(|(_, nodes)| *nodes)
            .copied()
            .collect();
        let (mut own, roots) = graph.extract(&all);
        let (mut slots, mut compiled) = (Vec::new(), Vec::new());
        let mut next = 0;
        for &(attribute, nodes) in members {
            let values = &roots[next..next + nodes.len()];
            next += nodes.len();
            if values.is_empty() {
                continue;
            }
            let mut values = values[..values.len().min(4)].to_vec();
            if attribute == A::Bump {
                let height = [values[0]];
                values.clear();
                for k in 0..3 {
                    let slope = own.derivatives(&height, Input::Variable(k));
                    values.extend(slope.unwrap_or_default());
                }
                if values.len() < 3 {
                    continue;
                }
            }
            // The normals that a height tilts depend on the point even where its gradient does not.
            let is_slope = |value: &NodeId| own.value(*value) != Some(0.0);
            let tilts = attribute == A::Bump && values.iter().any(is_slope);
            slots.push(Slot {
                attribute,
                first: compiled.len(),
                width: values.len(),
                varies: tilts || reads_place(&own, &values),
            });
            compiled.extend(values);
        }
        let tape = Tape::new(&own, &compiled);
        let varies = slots.iter().any(|slot| slot.varies);
        Self {
            map: map.map(|map| AffineTape::new(graph, map)),
            tape,
            slots,
            varying: varies.then_some((own, compiled)),
        }
    }
}

/// Returns true if an expression reads coordinates.
fn reads_place(graph: &Graph, roots: &[NodeId]) -> bool {
    let mut inputs = graph.inputs(roots).into_iter();
    inputs.any(|input| matches!(input, Input::Variable(_)))
}

impl AttributeNumbers {
    /// Returns the first number.
    pub(super) fn number(&self) -> f64 {
        self.values[0]
    }

    /// Returns three numbers, one number three times, or two and 0.
    pub(super) fn vector(&self) -> DVec3 {
        let [a, b, c, _] = self.values;
        if self.width == 1 {
            DVec3::splat(a)
        } else {
            DVec3::new(a, b, c)
        }
    }
}
