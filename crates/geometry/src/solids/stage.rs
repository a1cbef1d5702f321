//! Lights, cameras and the background.
//!
//! In: the declarations of a scene, and the 3D view's defaults where there are none. Out: the data that rays need.

use std::f64::consts::{FRAC_PI_4, PI};
use std::sync::atomic::{AtomicBool, Ordering};

use expr::Input;
use expr::tape::Tape;
use glam::DVec3;
use scene::{Object, ParamValues, Scene, Shape, stated_word};
use tracer::PictureLook;
use tracer::camera::{Bokeh, LensCamera, LensProjection, SharpPlaces};
use tracer::light::{Light, LightKind};

use super::attributes::{AttributeNumbers, AttributeSet, NumberAttribute as A, evaluated};
use super::look::BackgroundImage;
use super::note::RayFault;

/// One instance of a camera that a scene declares.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredCamera {
    /// Its name.
    pub name: String,
    /// The index of the instance, from 0.
    pub instance: u64,
    /// The camera.
    pub lens: LensCamera,
}

/// The lights of a scene that declares none: they move with the camera, like those of the 3D view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardLights {
    /// The strength of light from everywhere.
    pub ambient: f64,
    /// The strength of the light at the eye, which casts no shadows.
    pub fill: f64,
    /// The strength of the directional light.
    pub key: f64,
    /// The unit direction towards that light: to the picture's right, up, and towards the eye.
    pub key_direction: DVec3,
}

impl StandardLights {
    /// Returns the lights for a camera.
    pub fn of(&self, camera: &LensCamera) -> Vec<Light> {
        let [right, up, forward] = camera.axes();
        let [x, y, z] = self.key_direction.to_array();
        let towards = x * right + y * up - z * forward;
        let white = |strength: f64| DVec3::splat(strength);
        vec![
            Light {
                ambient: 1.0,
                highlight: DVec3::ZERO,
                ..Light::new(LightKind::Parallel(DVec3::ZERO), white(self.ambient))
            },
            Light {
                highlight: DVec3::ZERO,
                casts_shadows: false,
                ..Light::new(LightKind::Point(camera.position), white(self.fill))
            },
            Light {
                highlight: DVec3::ONE,
                ..Light::new(LightKind::Parallel(-towards), white(self.key))
            },
        ]
    }
}

/// The horizon of a scene that declares no background, sRGB.
const HORIZON: DVec3 = DVec3::new(96.0 / 255.0, 104.0 / 255.0, 120.0 / 255.0);

/// Returns the sky of a scene that declares no background, in sRGB, in a unit direction: `above` overhead and
/// underfoot, lighter towards the horizon.
pub fn standard_sky(above: DVec3, direction: DVec3) -> DVec3 {
    let share = (1.0 - direction.z.abs()).powi(4);
    above + share * (HORIZON - above)
}

/// A background that a scene declares.
#[derive(Debug)]
pub(super) struct DeclaredBackground {
    pub(super) name: String,
    /// The image that it names.
    pub(super) image: Option<String>,
    colour: Tape,
    /// The linear light of a colour that is the same in all directions.
    constant: Option<DVec3>,
    uniforms: Vec<f64>,
    /// The rotation of its image about z, in radians.
    turn: f64,
    attributes: AttributeSet,
    picture_look: PictureLook,
    /// True once the colour was undefined in a direction.
    was_undefined: AtomicBool,
    /// True once a component of the colour was negative in a direction.
    was_negative: AtomicBool,
}

impl DeclaredBackground {
    pub(super) fn new(
        scene: &Scene,
        params: &ParamValues,
        object: &Object,
        picture_look: PictureLook,
    ) -> Option<Self> {
        let Shape::Background(background) = &object.shape else {
            return None;
        };
        let uniforms = params.first_instance(scene, object);
        let attributes = AttributeSet::new(&scene.graph, &object.attributes, true);
        let mut turn = 0.0;
        attributes.at(
            &uniforms,
            |_| [f64::NAN; 3],
            |numbers| {
                if numbers.attribute == A::Turn {
                    turn = numbers.number();
                }
            },
        );
        let colour = Tape::new(&scene.graph, &background.colour);
        let mut found = Self {
            name: object.name.clone(),
            image: stated_word(&object.attributes, "image").map(str::to_owned),
            constant: None,
            uniforms,
            turn,
            attributes,
            colour,
            picture_look,
            was_undefined: AtomicBool::default(),
            was_negative: AtomicBool::default(),
        };
        let mut inputs = found.colour.inputs().iter();
        if !inputs.any(|input| matches!(input, Input::Variable(_))) {
            found.constant = Some(found.shining(DVec3::NAN));
        }
        Some(found)
    }

    /// Returns the linear light from a unit direction: that of `image` at a point of it, from (0, 0), the top left, to (1,
    /// 1), if there is one; black where the colour is undefined.
    pub(super) fn light(&self, direction: DVec3, image: Option<&BackgroundImage<'_>>) -> DVec3 {
        let Some(image) = image else {
            return self.constant.unwrap_or_else(|| self.shining(direction));
        };
        let around = direction.y.atan2(direction.x) + self.turn;
        let u = (0.5 - around / (2.0 * PI)).rem_euclid(1.0);
        let v = match self.picture_look {
            PictureLook::Geotrace => 0.5 - direction.z.clamp(-1.0, 1.0).asin() / PI,
            PictureLook::Crt => 0.5 - 0.5 * direction.z,
        };
        image([u, v])
    }

    /// Returns true if the colour depends only on the height of a direction.
    pub(super) fn is_level(&self) -> bool {
        let mut inputs = self.colour.inputs().iter();
        inputs.all(|input| !matches!(input, Input::Variable(0 | 1)))
    }

    /// Returns the linear light of the colour in a unit direction.
    fn shining(&self, direction: DVec3) -> DVec3 {
        let colour = evaluated(
            &self.colour,
            &direction.to_array(),
            &self.uniforms,
            DVec3::from_slice,
        );
        let remember = |fault: &AtomicBool| {
            // Threads share the line of memory: write it once.
            if !fault.load(Ordering::Relaxed) {
                fault.store(true, Ordering::Relaxed);
            }
        };
        if !colour.is_finite() {
            remember(&self.was_undefined);
            return DVec3::ZERO;
        }
        if colour.min_element() < 0.0 {
            remember(&self.was_negative);
        }
        self.picture_look.light(colour.max(DVec3::ZERO))
    }

    /// Returns the deviations of the colour from a colour, in the directions that were evaluated.
    pub(super) fn faults(&self) -> impl Iterator<Item = RayFault> {
        let faults = [
            (&self.was_undefined, RayFault::UndefinedBackground),
            (&self.was_negative, RayFault::NegativeBackground),
        ];
        let found = faults.into_iter();
        found.filter_map(|(was, fault)| was.load(Ordering::Relaxed).then_some(fault))
    }

    pub(super) fn attributes(&self) -> &AttributeSet {
        &self.attributes
    }
}

/// Returns all instances of a light. One whose position or direction is undefined does not shine, and is counted.
pub(super) fn lights(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    attributes: &AttributeSet,
    picture_look: PictureLook,
) -> (Vec<Light>, u64) {
    let Shape::Light(light) = &object.shape else {
        return (Vec::new(), 0);
    };
    let tape =
        |nodes: Option<[expr::NodeId; 3]>| nodes.map(|nodes| Tape::new(&scene.graph, &nodes));
    let [position, direction] = [light.position, light.direction].map(tape);
    let (mut found, mut undefined) = (Vec::new(), 0);
    params.for_each_instance(scene, object, |uniforms| {
        let at = |tape: &Option<Tape>| {
            let tape = tape.as_ref()?;
            Some(evaluated(tape, &[], uniforms, DVec3::from_slice))
        };
        let [position, direction] = [at(&position), at(&direction)];
        let parts = [position, direction].into_iter().flatten();
        let is_direction = |direction: DVec3| {
            let length = direction.length();
            length.is_finite() && length > 0.0
        };
        if parts.clone().any(|part| !part.is_finite()) || !direction.is_none_or(is_direction) {
            undefined += 1;
            return;
        }
        let mut radius = None;
        let (mut angle, mut soft) = (PI / 3.0, 0.2);
        let mut light = Light::new(LightKind::Parallel(DVec3::ZERO), DVec3::ONE);
        let mut power = 1.0;
        attributes.at(
            uniforms,
            |_| [f64::NAN; 3],
            |numbers: &AttributeNumbers| {
                let number = numbers.number();
                match numbers.attribute {
                    A::Colour => light.colour = picture_look.light(numbers.vector()),
                    A::Power => power = number,
                    A::Ambient => light.ambient = number,
                    A::Falloff => light.falloff = Some(number),
                    A::Angle => angle = number,
                    A::Radius => radius = Some(number),
                    A::Soft => soft = number,
                    A::Size => light.size = number,
                    _ => {}
                }
            },
        );
        light.colour *= power;
        light.highlight = light.colour;
        light.kind = match (position, direction, radius) {
            (Some(position), None, _) => LightKind::Point(position),
            (None, Some(direction), _) => LightKind::Parallel(direction),
            (Some(position), Some(direction), Some(radius)) => LightKind::Beam {
                position,
                direction,
                radius,
                soft,
            },
            (Some(position), Some(direction), None) => LightKind::Spot {
                position,
                direction,
                angle,
                soft,
            },
            (None, None, _) => return,
        };
        found.push(light);
    });
    (found, undefined)
}

/// Returns all instances of a camera. One whose position or direction is undefined is omitted, and counted.
pub(super) fn cameras(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    attributes: &AttributeSet,
    picture_look: PictureLook,
) -> (Vec<DeclaredCamera>, u64) {
    let Shape::Camera(camera) = &object.shape else {
        return (Vec::new(), 0);
    };
    let tape = Tape::new(&scene.graph, &[camera.direction, camera.position].concat());
    let word = |attribute: &str| stated_word(&object.attributes, attribute);
    let projection = word("projection").and_then(LensProjection::from_name);
    let bokeh = word("bokeh").and_then(Bokeh::from_name);
    let (mut found, mut undefined) = (Vec::new(), 0);
    let mut instance = 0;
    params.for_each_instance(scene, object, |uniforms| {
        instance += 1;
        let [direction, position] = evaluated(&tape, &[], uniforms, |out| {
            [&out[..3], &out[3..]].map(DVec3::from_slice)
        });
        let focus = direction.length();
        if !(position.is_finite() && focus.is_finite() && focus > 0.0) {
            undefined += 1;
            return;
        }
        let mut lens = LensCamera {
            position,
            direction,
            up: DVec3::Z,
            fov: FRAC_PI_4,
            roll: 0.0,
            focus,
            aperture: 0.0,
            bokeh: bokeh.unwrap_or_default(),
            projection: projection.unwrap_or_default(),
            sharp: match picture_look {
                PictureLook::Geotrace => SharpPlaces::Plane,
                PictureLook::Crt => SharpPlaces::Ball,
            },
        };
        attributes.at(
            uniforms,
            |_| [f64::NAN; 3],
            |numbers: &AttributeNumbers| {
                let number = numbers.number();
                match numbers.attribute {
                    A::Fov => lens.fov = number,
                    A::Focus => lens.focus = number,
                    A::Aperture => lens.aperture = number,
                    A::Roll => lens.roll = number,
                    _ => {}
                }
            },
        );
        found.push(DeclaredCamera {
            name: object.name.clone(),
            instance: instance - 1,
            lens,
        });
    });
    (found, undefined)
}
