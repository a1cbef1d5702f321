//! Whole pictures, as `geotrace-benches povray` has them: the processor's time on one thread, and a number that depends on
//! every byte of the picture.

use glam::{DAffine3, DVec3};
use tracer::camera::{Bokeh, LensCamera, LensProjection, SharpPlaces};
use tracer::light::{Light, LightKind};
use tracer::picture::LightSums;
use tracer::shade::{FaceLook, FaceObject, Scenery};
use tracer::{PictureLook, SetStep, ShapeId, Sheets, World, WorldBuilder};

use super::formula::{Formula, variables};
use super::{SIZE, processor_time};

const BOUNCES: u32 = 5;
const LAMPS: [[f64; 3]; 4] = [
    [6.0, -6.0, 8.0],
    [-7.0, -4.0, 7.0],
    [2.0, -9.0, 5.0],
    [-3.0, 5.0, 9.0],
];

/// Solids, and the look of each.
struct Stage {
    world: World,
    looks: Vec<FaceLook>,
    lamps: usize,
    camera: LensCamera,
}

/// A name, what it shows, and the samples of a pixel.
type Scene = (&'static str, fn() -> Stage, u32);

/// Draws the pictures whose names contain `wanted`.
pub(super) fn pictures(wanted: &str) {
    let scenes: [Scene; 3] = [
        ("carved box, seven mirror balls, mirror", || carved(0.0), 1),
        ("400 boxes with three cuts", boxes, 1),
        ("lens with 50 samples", || carved(0.1), 50),
    ];
    for (name, stage, samples) in scenes {
        if name.contains(wanted) {
            let (seconds, bits) = drawn(&stage(), samples);
            println!("{name:40} {seconds:8.3} s, bits {bits:016x}");
        }
    }
}

fn drawn(stage: &Stage, samples: u32) -> (f64, u64) {
    let sheets = Sheets::new(Vec::new());
    let lamps = &LAMPS[..stage.lamps];
    let color = DVec3::splat(tracer::decoded(DVec3::splat(1.0 / lamps.len() as f64)).x);
    let lights: Vec<Light> = lamps
        .iter()
        .map(|&place| Light::new(LightKind::Point(DVec3::from_array(place)), color))
        .collect();
    let scenery = Scenery {
        world: &stage.world,
        sheets: &sheets,
        glass: &[],
        opaque: &vec![true; stage.looks.len()],
        look: &|face| match face.of {
            FaceObject::Solid { solid, .. } => stage.looks[solid],
            FaceObject::Sheet { .. } => FaceLook::default(),
        },
        lights: &lights,
        background: &|_| DVec3::ZERO,
        bounces: BOUNCES,
        picture_look: PictureLook::Geotrace,
        sides: &[],
    };
    let start = processor_time();
    let mut sums = LightSums::new(SIZE.map(|side| side as u32));
    sums.add(&scenery, &stage.camera, None, samples, 1, &|_| true);
    let seconds = 1e-3 * (processor_time() - start);
    let bits = sums
        .means()
        .flat_map(tracer::encoded)
        .fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    (seconds, bits)
}

fn camera(position: [f64; 3], direction: [f64; 3], aperture: f64) -> LensCamera {
    let direction = DVec3::from_array(direction);
    LensCamera {
        position: DVec3::from_array(position),
        direction,
        up: DVec3::Z,
        fov: 0.7,
        roll: 0.0,
        focus: direction.length(),
        aperture,
        bokeh: Bokeh::Circle,
        projection: LensProjection::Pinhole,
        sharp: SharpPlaces::Plane,
    }
}

fn opaque(color: f64, diffuse: f64, mirror: f64) -> FaceLook {
    FaceLook {
        color: tracer::decoded(DVec3::splat(color)),
        diffuse: Some(diffuse),
        specular: 0.0,
        mirror: DVec3::splat(mirror),
        ..FaceLook::default()
    }
}

fn cube([x, y, z]: &[Formula; 3], half: f64) -> Formula {
    x.abs().max(&y.abs()).max(&z.abs()) - half
}

fn shape(builder: &mut WorldBuilder<'_>, formula: &Formula) -> Option<ShapeId> {
    builder.shape(formula.node(), [None; 3]).ok()
}

/// A carved box and seven mirror balls on a mirror.
fn carved(aperture: f64) -> Stage {
    let variables = variables();
    let [x, y, z] = &variables;
    let rod = x.squared() + y.squared() - 0.36;
    let ground = z + 1.0;
    let balls: Vec<Formula> = (0..7)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 7.0;
            let (a, b) = (2.6 * angle.cos(), 2.6 * angle.sin());
            (x - a).squared() + (y - b).squared() + (z + 0.4).squared() - 0.36
        })
        .collect();
    let solid = cube(&variables, 1.0);
    let graph = x.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    let quarter = std::f64::consts::FRAC_PI_2;
    if let (Some(cube), Some(rod)) = (shape(&mut builder, &solid), shape(&mut builder, &rod)) {
        let at = |map| SetStep::Leaf(rod, map);
        let _ = builder.solid([
            SetStep::Leaf(cube, DAffine3::IDENTITY),
            at(DAffine3::IDENTITY),
            SetStep::Difference,
            at(DAffine3::from_rotation_x(quarter)),
            SetStep::Difference,
            at(DAffine3::from_rotation_y(quarter)),
            SetStep::Difference,
        ]);
    }
    let mut looks = vec![opaque(0.7, 1.0, 0.0), opaque(0.5, 0.7, 0.3)];
    for formula in [ground].iter().chain(&balls) {
        if let Some(shape) = shape(&mut builder, formula) {
            let _ = builder.solid([SetStep::Leaf(shape, DAffine3::IDENTITY)]);
        }
    }
    looks.extend([opaque(0.8, 0.4, 0.6); 7]);
    Stage {
        world: builder.build().unwrap_or_else(|_| World::empty()),
        looks,
        lamps: 4,
        camera: camera([-0.5, -8.0, 3.0], [0.5, 7.0, -2.4], aperture),
    }
}

/// 400 boxes, of each of which three balls are taken away.
fn boxes() -> Stage {
    let variables = variables();
    let [x, y, z] = &variables;
    let ball = x.squared() + y.squared() + z.squared() - 0.09;
    let solid = cube(&variables, 0.4);
    let graph = x.graph().clone();
    let mut builder = WorldBuilder::new(&graph, &|_| f64::NAN);
    if let (Some(cube), Some(ball)) = (shape(&mut builder, &solid), shape(&mut builder, &ball)) {
        let mut steps = Vec::new();
        for k in 0..400 {
            let place = DVec3::new(f64::from(k / 20) - 9.5, f64::from(k % 20) - 9.5, 0.0);
            let leaf = |shape, offset: [f64; 3]| {
                let place = place + DVec3::from_array(offset);
                SetStep::Leaf(shape, DAffine3::from_translation(place))
            };
            steps.push(leaf(cube, [0.0; 3]));
            for offset in [[0.4, 0.0, 0.0], [0.0, -0.4, 0.0], [0.0, 0.0, 0.4]] {
                steps.extend([leaf(ball, offset), SetStep::Difference]);
            }
            if k > 0 {
                steps.push(SetStep::Union);
            }
        }
        let _ = builder.solid(&steps);
    }
    Stage {
        world: builder.build().unwrap_or_else(|_| World::empty()),
        looks: vec![opaque(0.75, 1.0, 0.0)],
        lamps: 2,
        camera: camera([-0.5, -18.0, 13.0], [0.2, 7.0, -5.0], 0.0),
    }
}
