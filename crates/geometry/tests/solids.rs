//! Scenes for rays: instances, attributes, stages, bodies; scenes are built by hand.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use expr::ops::Unary;
use expr::{Input, NodeId};
use geometry::solids::{
    RayFault, RayScene, RaySceneOptions, SOLID_COLOUR, StandardLights, Thickness, srgb,
};
use glam::DVec3;
use scene::{
    AffineNodes, Attribute, AttributeValue, BoundGrid, Camera, Grid, GridId, Light, Object, Param,
    ParamId, ParamValues, Range, Sampling, Scene, Shape, Solid, SolidLeaf, SolidStep,
};
use syntax::crt::objects::{ObjectName, ValueType};
use syntax::geotrace::attributes::{self, AttributeType, AttributeWord};
use syntax::geotrace::declarations::DeclarationKeyword;
use syntax::span::Span;
use tracer::Ray;
use tracer::camera::{Bokeh, LensCamera, LensProjection};
use tracer::light::LightKind;
use tracer::shade::{Face, FaceLook, FaceObject, LightTracer, Scenery};
use tracer::srgb::linear;

/// Writes scenes.
#[derive(Default)]
struct Writer {
    scene: Scene,
}

impl Writer {
    fn number(&mut self, value: f64) -> NodeId {
        self.scene.graph.constant(value)
    }

    fn numbers(&mut self, values: [f64; 3]) -> [NodeId; 3] {
        values.map(|value| self.number(value))
    }

    fn variables(&mut self) -> [NodeId; 3] {
        [0, 1, 2].map(|k| self.scene.graph.input(Input::Variable(k)))
    }

    /// x² + y² + z² − r².
    fn ball(&mut self, radius: NodeId) -> NodeId {
        let squares = self.variables().map(|x| self.scene.graph.mul(x, x));
        let graph = &mut self.scene.graph;
        let sum = graph.add(squares[0], squares[1]);
        let sum = graph.add(sum, squares[2]);
        let square = graph.mul(radius, radius);
        graph.sub(sum, square)
    }

    fn map(&mut self, rows: [[f64; 4]; 3]) -> AffineNodes {
        AffineNodes(rows.map(|row| row.map(|value| self.number(value))))
    }

    fn moved(&mut self, by: [NodeId; 3]) -> AffineNodes {
        let mut map = self.map([
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]);
        for (row, offset) in map.0.iter_mut().zip(by) {
            row[3] = offset;
        }
        map
    }

    fn identity(&mut self) -> AffineNodes {
        let zero = self.number(0.0);
        self.moved([zero; 3])
    }

    fn leaf(&mut self, name: &str, field: NodeId, map: AffineNodes) -> SolidLeaf {
        SolidLeaf {
            name: name.into(),
            name_span: Span::default(),
            field,
            cuts: [None; 3],
            map,
            attributes: Arc::default(),
        }
    }

    fn grid(&mut self, name: &str, min: f64, max: f64, count: u32) -> (GridId, NodeId) {
        let first_uniform = self.scene.uniform_count;
        self.scene.uniform_count += 1;
        self.scene.grids.push(Grid {
            name: name.into(),
            name_span: Span::default(),
            axes: vec![Sampling {
                range: Range { min, max },
                count,
            }],
            first_uniform,
        });
        let id = GridId(self.scene.grids.len() as u32 - 1);
        (id, self.scene.graph.input(Input::Uniform(first_uniform)))
    }

    fn param(&mut self, name: &str, value: f64) -> (ParamId, NodeId) {
        let first_uniform = self.scene.uniform_count;
        self.scene.uniform_count += 1;
        self.scene.params.push(Param {
            name: name.into(),
            name_span: Span::default(),
            ranges: vec![Range {
                min: -10.0,
                max: 10.0,
            }],
            initial: vec![value],
            first_uniform,
        });
        let id = ParamId(self.scene.params.len() as u32 - 1);
        (id, self.scene.graph.input(Input::Uniform(first_uniform)))
    }

    fn declare(&mut self, name: &str, shape: Shape, grids: &[GridId], attributes: Vec<Attribute>) {
        let object = Object {
            name: name.into(),
            name_span: Span::default(),
            shape,
            params: Vec::new(),
            grids: grids.to_vec(),
            geodesic_values: Vec::new(),
            attributes,
        };
        if matches!(
            object.shape,
            Shape::Light(_) | Shape::Camera(_) | Shape::Background(_)
        ) {
            self.scene.stage.push(object);
        } else {
            self.scene.objects.push(object);
        }
    }

    fn solid(&mut self, name: &str, leaves: Vec<SolidLeaf>, steps: &[SolidStep], grids: &[GridId]) {
        let solid = Solid {
            leaves,
            steps: steps.to_vec(),
            ..Solid::default()
        };
        self.declare(name, Shape::Solid(solid.into()), grids, Vec::new());
    }

    fn prepared(&self) -> RayScene {
        self.prepared_with(&ParamValues::initial(&self.scene))
    }

    fn prepared_with(&self, params: &ParamValues) -> RayScene {
        let options = RaySceneOptions {
            shown: &|_| true,
            colour: &|_| srgb(SOLID_COLOUR),
            thickness: Some(Thickness {
                point: 0.1,
                line: 0.05,
                head_length: 8.0,
                head_radius: 3.0,
                head_share: 0.4,
            }),
            stage: true,
            picture_look: Default::default(),
        };
        RayScene::new(&self.scene, params, &options)
    }
}

fn stated(word: &'static str, nodes: &[NodeId], map: Option<AffineNodes>) -> Attribute {
    Attribute {
        word,
        span: Span::default(),
        value: AttributeValue::Numbers(nodes.to_vec()),
        map,
    }
}

fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray {
        origin: origin.into(),
        direction: direction.into(),
        leaving: None,
    }
}

/// True if both are the same numbers but for rounding.
fn close(found: &[f64], expected: &[f64]) -> bool {
    let mut pairs = found.iter().zip(expected);
    found.len() == expected.len() && pairs.all(|(a, b)| (a - b).abs() < 1e-12)
}

/// The t of all crossings.
fn crossings(scene: &RayScene, ray: &Ray) -> Vec<f64> {
    let mut caster = scene.world().caster();
    caster.cast(ray).iter().map(|crossing| crossing.t).collect()
}

fn first(scene: &RayScene, ray: &Ray) -> Option<Face> {
    let scenery = Scenery {
        world: scene.world(),
        sheets: scene.sheets(),
        glass: scene.glass(),
        look: &|face| scene.look(face, &|_, _| None),
        lights: &[],
        background: &|_| DVec3::ZERO,
        bounces: 0,
        picture_look: Default::default(),
        opaque: &[],
        sides: &[],
    };
    LightTracer::new(&scenery).first(ray)
}

fn look(scene: &RayScene, ray: &Ray) -> FaceLook {
    let face = first(scene, ray).expect("a face");
    scene.look(&face, &|_, _| None)
}

#[test]
fn a_cut_shows_the_cutter() {
    let mut writer = Writer::default();
    let one = writer.number(1.0);
    let half = writer.number(0.5);
    let (outer, inner) = (writer.ball(one), writer.ball(half));
    let here = writer.identity();
    let zero = writer.number(0.0);
    let x = writer.number(1.0);
    let aside = writer.moved([x, zero, zero]);
    let leaves = vec![
        writer.leaf("outer", outer, here),
        writer.leaf("inner", inner, aside),
    ];
    let steps = [
        SolidStep::Leaf(0),
        SolidStep::Leaf(1),
        SolidStep::Difference,
    ];
    writer.solid("bitten", leaves, &steps, &[]);
    let scene = writer.prepared();
    let along = ray([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    assert!(close(&crossings(&scene, &along), &[2.5, 4.0]));
    let face = first(&scene, &along).expect("a face");
    let owner = scene.owner(&face.of);
    assert_eq!(
        owner.leaf.map(|leaf| (leaf.name, leaf.index)),
        Some(("inner", 1))
    );
    assert_eq!(
        (&*owner.object.name, owner.object.kind),
        ("bitten", "solid")
    );
    assert!(face.normal.distance(DVec3::X) < 1e-12);
    assert_eq!(scene.notes(), []);
}

#[test]
fn the_instances_of_a_solid_are_one_set() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", 0.0, 3.0, 4);
    let (one, zero) = (writer.number(1.0), writer.number(0.0));
    let ball = writer.ball(one);
    let place = writer.moved([k, zero, zero]);
    let leaf = writer.leaf("ball", ball, place);
    writer.solid("row", vec![leaf], &[SolidStep::Leaf(0)], &[grid]);
    let along = ray([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let scene = writer.prepared();
    assert_eq!(scene.world().solid_count(), 1);
    // The balls overlap: the row is entered once.
    assert!(close(&crossings(&scene, &along), &[4.0, 9.0]));
    let back = ray([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
    let face = first(&scene, &back).expect("a face");
    let owner = scene.owner(&face.of);
    assert_eq!(owner.instance, 3);
    assert_eq!(owner.grids, [("k", &[3.0][..])]);
    let mut params = ParamValues::initial(&writer.scene);
    params.set(&writer.scene, "k", &[1.5]).expect("in range");
    let fixed = writer.prepared_with(&params);
    assert!(close(&crossings(&fixed, &along), &[5.5, 7.5]));
    let face = first(&fixed, &along).expect("a face");
    assert_eq!(fixed.owner(&face.of).grids, []);
}

#[test]
fn a_radius_may_depend_on_a_grid() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", 1.0, 2.0, 2);
    let ball = writer.ball(k);
    // The waves make it a field that is solved by intervals.
    let [x, ..] = writer.variables();
    let graph = &mut writer.scene.graph;
    let wave = graph.unary(expr::ops::Unary::Sin, x);
    let wave = graph.mul(wave, wave);
    let tenth = graph.constant(0.1);
    let wave = graph.mul(wave, tenth);
    let wavy = graph.add(ball, wave);
    let ten = graph.constant(10.0);
    let zero = graph.constant(0.0);
    let apart = writer.scene.graph.mul(ten, k);
    let place = writer.moved([zero, apart, zero]);
    let leaf = writer.leaf("wavy", wavy, place);
    writer.solid("two", vec![leaf], &[SolidStep::Leaf(0)], &[grid]);
    let scene = writer.prepared();
    for k in [1.0, 2.0] {
        let along = ray([0.0, 10.0 * k, -5.0], [0.0, 0.0, 1.0]);
        let found = crossings(&scene, &along);
        let expected = [5.0 - k, 5.0 + k];
        let close = found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(found.len() == 2 && close, "{found:?}");
    }
}

#[test]
fn instances_within_a_set_are_a_union_and_may_be_cut() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", -2.0, 2.0, 5);
    let (two, zero, tenth) = (writer.number(2.5), writer.number(0.0), writer.number(0.25));
    let (plate, hole) = (writer.ball(two), writer.ball(tenth));
    let here = writer.identity();
    let place = writer.moved([k, zero, zero]);
    let leaves = vec![
        writer.leaf("plate", plate, here),
        writer.leaf("hole", hole, place),
    ];
    let bound = BoundGrid {
        grid,
        first_uniform: writer.scene.grids[grid.0 as usize].first_uniform,
    };
    let steps = [
        SolidStep::Leaf(0),
        SolidStep::Leaf(1),
        SolidStep::Instances(vec![bound]),
        SolidStep::Difference,
    ];
    // The grid is closed: the solid itself has one instance.
    writer.solid("cheese", leaves, &steps, &[]);
    let scene = writer.prepared();
    assert_eq!(scene.world().leaf_count(), 6);
    let along = ray([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let mut expected = vec![2.5];
    for k in -2..=2 {
        expected.extend([5.0 + f64::from(k) - 0.25, 5.0 + f64::from(k) + 0.25]);
    }
    expected.push(7.5);
    let found = crossings(&scene, &along);
    assert!(close(&found, &expected), "{found:?}");
}

#[test]
fn textures_and_bumps_move_along() {
    let mut writer = Writer::default();
    let (one, zero) = (writer.number(1.0), writer.number(0.0));
    let ball = writer.ball(one);
    // A quarter turn about z, then 3 along x: x' = 3 − y, y' = x; the image of (0, −1, 0) is (4, 0, 0).
    let map = writer.map([
        [0.0, -1.0, 0.0, 3.0],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]);
    let [_, y, z] = writer.variables();
    let height = {
        let graph = &mut writer.scene.graph;
        let tenth = graph.constant(0.1);
        let sum = graph.add(y, z);
        graph.mul(tenth, sum)
    };
    let red = {
        let graph = &mut writer.scene.graph;
        let minus = graph.constant(-0.5);
        graph.mul(minus, y)
    };
    let mut leaf = writer.leaf("ball", ball, map);
    leaf.attributes = Arc::new(vec![
        stated("color", &[red, zero, zero], Some(map)),
        stated("bump", &[height], Some(map)),
    ]);
    writer.solid("ball", vec![leaf], &[SolidStep::Leaf(0)], &[]);
    let scene = writer.prepared();
    let outside = look(&scene, &ray([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]));
    // At (0, −1, 0) of its own: red is 0.5.
    let expected = linear(DVec3::new(0.5, 0.0, 0.0));
    assert!(outside.colour.distance(expected) < 1e-12);
    // The gradient (0, 0.1, 0.1) turns with the ball; seen from inside, the height leads away.
    assert!(outside.bump.distance(DVec3::new(-0.1, 0.0, 0.1)) < 1e-12);
    let inside = look(&scene, &ray([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
    assert!(inside.bump.distance(DVec3::new(0.1, 0.0, -0.1)) < 1e-12);
}

#[test]
fn a_height_whose_gradient_is_the_same_everywhere_tilts_normals() {
    let scene = of_text(
        "solid s(x,y,z) = x^2 + y^2 + z^2 - 1, bump : 0.3x;
        solid t(x,y,z) = (x - 4)^2 + y^2 + z^2 - 1, bump : 0.3;",
    );
    let above = |x: f64| ray([x, 0.2, 5.0], [0.0, 0.0, -1.0]);
    assert_eq!(look(&scene, &above(0.1)).bump, 0.3 * DVec3::X);
    assert_eq!(look(&scene, &above(4.1)).bump, DVec3::ZERO);
    let leaf = |x: f64| match first(&scene, &above(x)).map(|face| face.of) {
        Some(FaceObject::Solid { leaf, .. }) => leaf,
        other => panic!("{other:?}"),
    };
    let varying = |x: f64| scene.varying_look(leaf(x)).expect("no image").is_some();
    assert!(varying(0.1) && !varying(4.1));
}

#[test]
fn what_is_out_of_range_or_undefined_is_noted() {
    let mut writer = Writer::default();
    let one = writer.number(1.0);
    let ball = writer.ball(one);
    let here = writer.identity();
    let [x, ..] = writer.variables();
    let root = writer.scene.graph.unary(expr::ops::Unary::Sqrt, x);
    let mut leaf = writer.leaf("ball", ball, here);
    leaf.attributes = Arc::new(vec![
        stated("color", &[x], None),
        stated("mirror", &[root], None),
    ]);
    writer.solid("ball", vec![leaf], &[SolidStep::Leaf(0)], &[]);
    let scene = writer.prepared();
    let right = look(&scene, &ray([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]));
    assert_eq!((right.colour, right.mirror), (DVec3::ONE, DVec3::ONE));
    assert_eq!(scene.notes(), []);
    let left = look(&scene, &ray([-9.0, 0.0, 0.0], [1.0, 0.0, 0.0]));
    assert_eq!((left.colour, left.mirror), (DVec3::ZERO, DVec3::ZERO));
    let faults: Vec<RayFault> = scene.notes().into_iter().map(|note| note.fault).collect();
    let expected = [
        RayFault::UndefinedAttribute("mirror"),
        RayFault::ClampedAttribute("color"),
    ];
    assert_eq!(faults, expected);
}

#[test]
fn rounding_beyond_the_range_is_not_noted() {
    for (beyond, faults) in [(1e-14, 0), (1e-6, 1)] {
        let mut writer = Writer::default();
        let (one, more) = (writer.number(1.0), writer.number(beyond));
        let ball = writer.ball(one);
        let here = writer.identity();
        let [x, ..] = writer.variables();
        let colour = writer.scene.graph.add(x, more);
        let mut leaf = writer.leaf("ball", ball, here);
        leaf.attributes = Arc::new(vec![stated("color", &[colour], None)]);
        writer.solid("ball", vec![leaf], &[SolidStep::Leaf(0)], &[]);
        let scene = writer.prepared();
        let right = look(&scene, &ray([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]));
        assert_eq!(right.colour, DVec3::ONE);
        assert_eq!(scene.notes().len(), faults, "{beyond}");
    }
}

#[test]
fn a_background_without_a_colour_is_noted_where_it_is_seen() {
    let (up, down) = (DVec3::Z, DVec3::NEG_Z);
    for (text, seen, fault) in [
        ("sky(x,y,z) = sqrt z", up, None),
        (
            "sky(x,y,z) = sqrt z",
            down,
            Some(RayFault::UndefinedBackground),
        ),
        ("sky(x,y,z) = (1, z, 1)", up, None),
        (
            "sky(x,y,z) = (1, z, 1)",
            down,
            Some(RayFault::NegativeBackground),
        ),
        ("sky = (-1, 1, 1)", up, Some(RayFault::NegativeBackground)),
        ("sky = sqrt(0 - 1)", up, Some(RayFault::UndefinedBackground)),
        // A sky may be brighter than white.
        ("sky = 1.5", up, None),
    ] {
        let compilation = scene::geotrace::compile(&format!("background {text};"));
        let writer = Writer {
            scene: Scene::clone(&compilation.scene.expect("a scene")),
        };
        let rays = writer.prepared();
        let light = rays.background(seen, DVec3::ZERO, None);
        assert!(light.min_element() >= 0.0, "{text}");
        let faults = rays.notes().into_iter().map(|note| note.fault);
        assert_eq!(faults.collect::<Vec<_>>(), Vec::from_iter(fault), "{text}");
    }
}

#[test]
fn glass_is_that_of_the_first_leaf_that_has_some() {
    let mut writer = Writer::default();
    let (one, zero) = (writer.number(1.0), writer.number(0.0));
    let ball = writer.ball(one);
    let here = writer.identity();
    let [share, none, index, other] = [0.9, 0.0, 1.33, 2.0].map(|value| writer.number(value));
    let aside = writer.moved([one, zero, zero]);
    // Another attribute may vary, and be undefined at 0, where no face is.
    let [x, _, _] = writer.variables();
    let varied = writer.scene.graph.div(one, x);
    let mut leaves = vec![
        writer.leaf("stone", ball, here),
        writer.leaf("water", ball, aside),
    ];
    leaves[0].attributes = Arc::new(vec![
        stated("glass", &[none], None),
        stated("ior", &[other], None),
        stated("shininess", &[varied], None),
    ]);
    leaves[1].attributes = Arc::new(vec![
        stated("glass", &[share], None),
        stated("ior", &[index], None),
        stated("shininess", &[varied], None),
    ]);
    let steps = [SolidStep::Leaf(0), SolidStep::Leaf(1), SolidStep::Union];
    writer.solid("both", leaves, &steps, &[]);
    let scene = writer.prepared();
    let [Some(glass)] = scene.glass() else {
        panic!("{:?}", scene.glass());
    };
    assert_eq!((glass.ior, glass.depth), (1.33, 1.0));
    let water = look(&scene, &ray([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]));
    assert_eq!((water.glass, water.colour), (0.9, DVec3::ONE));
    assert_eq!(scene.notes(), []);
}

#[test]
fn lengths_may_be_as_small_as_a_scene_but_not_zero() {
    for (depth, expected, clamped) in [
        (7e-13, 7e-13, vec![]),
        (1e-300, 1e-300, vec![]),
        (
            0.0,
            f64::MIN_POSITIVE,
            vec![RayFault::ClampedAttribute("depth")],
        ),
    ] {
        let mut writer = Writer::default();
        let one = writer.number(1.0);
        let ball = writer.ball(one);
        let here = writer.identity();
        let depth = writer.number(depth);
        let mut leaves = vec![writer.leaf("pane", ball, here)];
        leaves[0].attributes = Arc::new(vec![
            stated("glass", &[one], None),
            stated("depth", &[depth], None),
        ]);
        writer.solid("pane", leaves, &[SolidStep::Leaf(0)], &[]);
        let scene = writer.prepared();
        let [Some(glass)] = scene.glass() else {
            panic!("{:?}", scene.glass());
        };
        assert_eq!(glass.depth, expected);
        let faults: Vec<RayFault> = scene.notes().into_iter().map(|note| note.fault).collect();
        assert_eq!(faults, clamped);
    }
}

#[test]
fn singular_instances_are_left_out_and_noted() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", 0.0, 2.0, 3);
    let one = writer.number(1.0);
    let ball = writer.ball(one);
    let mut map = writer.identity();
    map.0[2][2] = k;
    let leaf = writer.leaf("flat", ball, map);
    writer.solid("stack", vec![leaf], &[SolidStep::Leaf(0)], &[grid]);
    let scene = writer.prepared();
    let along = ray([0.0, 0.0, -5.0], [0.0, 0.0, 1.0]);
    assert!(close(&crossings(&scene, &along), &[3.0, 7.0]));
    let notes = scene.notes();
    assert_eq!(
        notes[0].fault,
        RayFault::SingularMap {
            skipped: 1,
            instances: 3,
            leaf: "flat".into(),
        }
    );
    assert_eq!(
        notes[0].to_string(),
        "1 of the 3 instances of `stack` are not drawn: the map of `flat` is singular"
    );
}

#[test]
fn an_empty_solid_is_noted() {
    let mut writer = Writer::default();
    let radius = writer.number(1.0);
    let ball = writer.ball(radius);
    let [here, there] = [0.0, 5.0].map(|x| {
        let place = writer.numbers([x, 0.0, 0.0]);
        let map = writer.moved(place);
        writer.leaf("ball", ball, map)
    });
    let [first, second] = [SolidStep::Leaf(0), SolidStep::Leaf(1)];
    let common = [first.clone(), second.clone(), SolidStep::Intersection];
    let union = [first, second, SolidStep::Union];
    writer.solid("common", vec![here.clone(), there.clone()], &common, &[]);
    writer.solid("union", vec![here, there], &union, &[]);
    let notes = writer.prepared().notes();
    let told: Vec<String> = notes.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["`common` is not visible: it contains no point"]);
}

#[test]
fn the_work_of_reading_shapes_is_bounded_for_all_solids_together() {
    /// Six operations and one for all, 18 terms in each of two readings, a leaf that one surface bounds.
    const BALL: u64 = 32 * 7 + 2 * 18 + 16 + 24;
    let mut writer = Writer::default();
    // Half a million waves: each instance is a shape of its own, and its box takes thousands of evaluations.
    let (grid, k) = writer.grid("k", 0.0, 1.0, 500_000);
    let graph = &mut writer.scene.graph;
    let [x, y, z] = [0, 1, 2].map(|k| graph.input(Input::Variable(k)));
    let shifted = graph.add(x, k);
    let wave = graph.unary(Unary::Sin, shifted);
    let squares = [x, y, z].map(|x| graph.mul(x, x));
    let field = squares
        .into_iter()
        .fold(wave, |sum, square| graph.add(sum, square));
    let map = writer.identity();
    let leaf = writer.leaf("wave", field, map);
    writer.solid("waves", vec![leaf], &[SolidStep::Leaf(0)], &[grid]);
    let one = writer.number(1.0);
    let ball = writer.ball(one);
    let map = writer.identity();
    let leaf = writer.leaf("ball", ball, map);
    writer.solid("ball", vec![leaf], &[SolidStep::Leaf(0)], &[]);
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| srgb(SOLID_COLOUR),
        thickness: None,
        stage: false,
        picture_look: Default::default(),
    };
    let params = ParamValues::initial(&writer.scene);
    let alone = |name: &str, work: &mut u64| -> Vec<String> {
        let (_, object) = writer.scene.object(name).expect("declared");
        let rays = RayScene::of_solid(&writer.scene, &params, &options, object, work);
        assert_eq!(rays.is_out_of_work(), rays.world().solid_count() == 0);
        rays.notes()
            .into_iter()
            .map(|note| note.to_string())
            .collect()
    };
    // A ball is read, and its box has a formula.
    let mut work = 1_000_000;
    assert_eq!(alone("ball", &mut work).len(), 0);
    assert_eq!(work, 1_000_000 - BALL);
    let said =
        "`waves` is not drawn: locating the solids exceeds the work limit; use fewer instances";
    assert_eq!(alone("waves", &mut work), [said]);
    assert_eq!(work, 0);
    assert_eq!(alone("ball", &mut work), [said.replace("waves", "ball")]);
    assert_eq!(alone("ball", &mut { BALL }).len(), 1);
    assert_eq!(alone("ball", &mut { BALL + 1 }).len(), 0);
}

#[test]
fn points_arrows_and_curves_are_bodies() {
    let mut writer = Writer::default();
    let place = writer.numbers([0.0, 0.0, 1.0]);
    writer.declare("p", Shape::Point { position: place }, &[], Vec::new());
    let (direction, origin) = (
        writer.numbers([4.0, 0.0, 0.0]),
        writer.numbers([0.0, 3.0, 0.0]),
    );
    let arrow = Shape::Vector { direction, origin };
    let thick = writer.number(0.2);
    writer.declare("v", arrow, &[], vec![stated("radius", &[thick], None)]);
    // An arrow of length 0 is a point.
    let (direction, origin) = (
        writer.numbers([0.0, 0.0, 0.0]),
        writer.numbers([0.0, -3.0, 0.0]),
    );
    let none = Shape::Vector { direction, origin };
    writer.declare("z", none, &[], vec![stated("radius", &[thick], None)]);
    let [t, ..] = writer.variables();
    let zero = writer.number(0.0);
    let curve = Shape::Curve {
        position: [t, zero, zero],
        domain: Sampling {
            range: Range { min: 0.0, max: 1.0 },
            count: 5,
        },
        parameter: "t".into(),
        followed: Vec::new(),
    };
    let tint = vec![stated("color", &[t, zero, zero], None)];
    writer.declare("c", curve, &[], tint);
    let scene = writer.prepared();
    assert_eq!(scene.world().solid_count(), 4);
    let down = |x: f64, y: f64| ray([x, y, 5.0], [0.0, 0.0, -1.0]);
    assert!(close(&crossings(&scene, &down(0.0, -3.0)), &[4.8, 5.2]));
    assert!(close(&crossings(&scene, &down(0.0, 0.0))[..2], &[3.9, 4.1]));
    // The shaft ends where the head, 8 · 0.2 long and 3 · 0.2 thick, begins.
    assert!(close(&crossings(&scene, &down(1.0, 3.0)), &[4.8, 5.2]));
    let head = crossings(&scene, &down(2.4 + 0.8, 3.0));
    assert!((head[0] - 4.7).abs() < 1e-12 && head.len() == 2, "{head:?}");
    assert!(crossings(&scene, &down(4.01, 3.0)).is_empty());
    let face = first(&scene, &down(0.4, 0.01)).expect("the curve");
    let owner = scene.owner(&face.of);
    assert_eq!((&*owner.object.name, owner.object.kind), ("c", "curve"));
    let seen = scene.look(&face, &|_, _| None).colour;
    assert!(seen.distance(linear(DVec3::new(0.4, 0.0, 0.0))) < 1e-12);
    assert!(!scene.is_declared_solid(0));
}

#[test]
fn a_point_that_is_too_large_for_rays_hides_no_other_instance() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", 0.0, 1e120, 2);
    let zero = writer.number(0.0);
    let one = writer.number(1.0);
    let radius = writer.scene.graph.add(one, k);
    let position = [zero; 3];
    let thick = vec![stated("radius", &[radius], None)];
    writer.declare("p", Shape::Point { position }, &[grid], thick);
    let scene = writer.prepared();
    assert_eq!(scene.notes(), []);
    let down = ray([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
    assert!(close(&crossings(&scene, &down), &[4.0, 6.0]));
}

#[test]
fn lights_and_cameras_are_those_of_the_scene() {
    let mut writer = Writer::default();
    let (grid, k) = writer.grid("k", 0.0, 1.0, 2);
    let zero = writer.number(0.0);
    let down = writer.numbers([0.0, 0.0, -1.0]);
    let high = [zero, zero, k];
    let [half, two, wide] = [0.5, 2.0, -1.0].map(|value| writer.number(value));
    let spot = Light {
        position: Some(high),
        direction: Some(down),
    };
    let attributes = vec![
        stated("color", &[half], None),
        stated("power", &[two], None),
        stated("radius", &[wide], None),
    ];
    writer.declare("beam", Shape::Light(spot), &[grid], attributes);
    let ahead = writer.numbers([0.0, 2.0, 0.0]);
    let eye = Camera {
        direction: ahead,
        position: high,
    };
    let mut attributes = vec![stated("fov", &[two], None)];
    attributes.push(Attribute {
        word: "bokeh",
        span: Span::default(),
        value: AttributeValue::Word("star".into()),
        map: None,
    });
    writer.declare("eye", Shape::Camera(eye), &[grid], attributes);
    let scene = writer.prepared();
    let camera = &scene.cameras()[1];
    assert_eq!((&*camera.name, camera.instance), ("eye", 1));
    let LensCamera {
        position,
        focus,
        fov,
        bokeh,
        ..
    } = camera.lens;
    assert_eq!(
        (position, focus, fov, bokeh),
        (DVec3::Z, 2.0, 2.0, Bokeh::Star)
    );
    let standard = StandardLights {
        ambient: 0.2,
        fill: 0.3,
        key: 0.5,
        key_direction: DVec3::Y,
    };
    let lights = scene.lights(&camera.lens, &standard);
    assert_eq!(lights.len(), 2);
    let expected = 2.0 * linear(DVec3::splat(0.5));
    assert_eq!(
        (lights[1].colour, lights[1].highlight),
        (expected, expected)
    );
    let LightKind::Beam {
        position, radius, ..
    } = lights[1].kind
    else {
        panic!("{lights:?}");
    };
    assert_eq!((position, radius), (DVec3::Z, 0.0));
    assert_eq!(scene.notes()[0].fault, RayFault::ClampedAttribute("radius"));

    // Without lights: those of the 3D view. The key comes from above the picture.
    let own = standard.of(&camera.lens);
    assert_eq!(own.len(), 3);
    let key = own[2].from(DVec3::ZERO, [0.5; 2], 0.0);
    assert!(key.towards.distance(DVec3::Z) < 1e-12);
    assert_eq!(own[1].kind, LightKind::Point(camera.lens.position));
}

#[test]
fn surfaces_have_bumps_and_images() {
    let mut writer = Writer::default();
    let [u, v, _] = writer.variables();
    let zero = writer.number(0.0);
    // σ = (2u, v, 0), the height u + 3v: its gradient in space is (1/2, 3, 0).
    let (position, height) = {
        let graph = &mut writer.scene.graph;
        let (two, three) = (graph.constant(2.0), graph.constant(3.0));
        let product = graph.mul(three, v);
        ([graph.mul(two, u), v, zero], graph.add(u, product))
    };
    let axis = Sampling {
        range: Range {
            min: -1.0,
            max: 1.0,
        },
        count: 3,
    };
    let surface = Shape::Surface {
        position,
        domain: [axis; 2],
        parameters: ["u".into(), "v".into()],
    };
    writer.declare("s", surface, &[], vec![stated("bump", &[height], None)]);
    let scene = writer.prepared();
    for (z, side) in [(5.0, 1.0), (-5.0, -1.0)] {
        let face = first(&scene, &ray([1.0, 0.5, z], [0.0, 0.0, -z])).expect("a face");
        let FaceObject::Sheet { uv, .. } = face.of else {
            panic!("{face:?}");
        };
        assert!((uv[0] - 0.5).abs() < 1e-12 && (uv[1] - 0.5).abs() < 1e-12);
        // A step in space of (0.2, 0, 0) is one of 0.1 in u, which is 0.05 of the image.
        let beam = -0.2 * side * DVec3::Z;
        let face = Face { beam, ..face };
        let look = scene.look(&face, &|_, part| {
            let [[ax, ay], [bx, by]] = (part.sides)();
            assert!(ax.abs() < 1e-12 && (ay - side * 0.1).abs() < 1e-12);
            assert!((bx + 0.05).abs() < 1e-12 && by.abs() < 1e-12);
            Some(part.colour * DVec3::new(part.at[0], part.at[1], 0.0))
        });
        let expected = side * DVec3::new(0.5, 3.0, 0.0);
        assert!(look.bump.distance(expected) < 1e-12, "{}", look.bump);
        let painted = linear(srgb(SOLID_COLOUR)) * DVec3::new(0.75, 0.75, 0.0);
        assert!(look.colour.distance(painted) < 1e-12);
    }
    assert!(first(&scene, &ray([2.1, 0.0, 5.0], [0.0, 0.0, -1.0])).is_none());
}

#[test]
fn params_move_lights_and_turn_solids() {
    let mut writer = Writer::default();
    let (_, a) = writer.param("a", FRAC_PI_2);
    let zero = writer.number(0.0);
    let graph = &mut writer.scene.graph;
    let (sin, cos) = (
        graph.unary(expr::ops::Unary::Sin, a),
        graph.unary(expr::ops::Unary::Cos, a),
    );
    let lamp = Light {
        position: Some([cos, sin, zero]),
        direction: None,
    };
    writer.declare("lamp", Shape::Light(lamp), &[], Vec::new());
    let mut params = ParamValues::initial(&writer.scene);
    let place = |params: &ParamValues| {
        let scene = writer.prepared_with(params);
        let camera = LensCamera {
            position: DVec3::ZERO,
            direction: DVec3::Y,
            up: DVec3::Z,
            fov: 1.0,
            roll: 0.0,
            focus: 1.0,
            aperture: 0.0,
            bokeh: Bokeh::Circle,
            projection: Default::default(),
            sharp: Default::default(),
        };
        let standard = StandardLights {
            ambient: 0.0,
            fill: 0.0,
            key: 0.0,
            key_direction: DVec3::Z,
        };
        match scene.lights(&camera, &standard)[0].kind {
            LightKind::Point(place) => place,
            other => panic!("{other:?}"),
        }
    };
    assert!(place(&params).distance(DVec3::Y) < 1e-15);
    params.set(&writer.scene, "a", &[PI]).expect("in range");
    assert!(place(&params).distance(DVec3::NEG_X) < 1e-15);
}

/// A scene of a text, for rays.
fn of_text(text: &str) -> RayScene {
    let scene = scene::geotrace::compile(text).scene.expect("no errors");
    Writer {
        scene: Scene::clone(&scene),
    }
    .prepared()
}

#[test]
fn only_the_fov_of_a_spherical_camera_is_half_a_turn_or_more() {
    for (states, expected) in [
        ("projection : spherical, fov : 2pi", 2.0 * PI),
        ("projection : cylindrical, fov : 0.9pi", 0.9 * PI),
        ("projection : spherical, fov : pi", PI),
    ] {
        let scene = of_text(&format!("camera c = (1,0,0) @ (-3,0,0), {states};"));
        assert_eq!(scene.cameras()[0].lens.fov, expected, "{states}");
        assert_eq!(scene.notes(), [], "{states}");
    }
    for projection in ["pinhole", "cylindrical"] {
        let camera = "camera c = (1,0,0) @ (-3,0,0), fov : a, projection";
        let scene = of_text(&format!("param a = 4 : [0, 6]; {camera} : {projection};"));
        let fov = scene.cameras()[0].lens.fov;
        assert!(fov < PI && fov > 0.99 * PI, "{fov}");
        assert_eq!(scene.notes()[0].fault, RayFault::ClampedAttribute("fov"));
    }
}

#[test]
fn a_spherical_camera_sees_half_a_right_angle_up_and_down() {
    // What its pictures show at their top, as docs/solids.md says.
    let top = |fov: f64| {
        let scene = of_text(&format!(
            "camera c = (1,0,0) @ (0,0,0), fov : {fov}, projection : spherical;"
        ));
        let (_, direction) = scene.cameras()[0].lens.ray([40, 40], [20.0, 0.0], [0.5; 2]);
        direction.z.atan2(direction.x)
    };
    for (fov, elevation) in [
        (FRAC_PI_2, 0.5f64.sqrt().atan()),
        (PI, PI / 4.0),
        (2.0 * PI, 0.0),
    ] {
        let found = top(fov);
        assert!((found - elevation).abs() < 1e-9, "{fov}: {found}");
    }
}

#[test]
fn glass_of_share_0_has_the_colour_of_opaque_solids() {
    let colour = |states: &str| {
        let text = "param a = 0 : [0, 1]; solid b(x,y,z) = x^2 + y^2 + z^2 - 1";
        let scene = of_text(&format!("{text}{states};"));
        look(&scene, &ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0])).colour
    };
    let opaque = colour("");
    assert_ne!(opaque, DVec3::ONE);
    for states in [", glass : 0", ", glass : a", ", glass : 0, bump : sin x"] {
        assert_eq!(colour(states), opaque, "{states}");
    }
    for states in [", glass : 0.1", ", glass : 1 - a", ", glass : max(0, x)"] {
        assert_eq!(colour(states), DVec3::ONE, "{states}");
    }
    let red = colour(", color : (1, 0, 0)");
    assert_eq!(colour(", color : (1, 0, 0), glass : 0"), red);
    assert_eq!(colour(", glass : 0, color : (1, 0, 0)"), red);
}

#[test]
fn normals_at_poles_and_at_the_ends_of_domains_are_those_of_the_faces() {
    const BOX: &str = ", x : [-1,1], y : [-1,1], z : [-1,1]";
    let plane = |at: DVec3| (at.x.abs() < 1e-12).then_some(DVec3::X);
    let tube = |at: DVec3| {
        let around = DVec3::new(at.x, at.y, 0.0);
        let is_near = (around.length() - 0.5).abs() < 1e-9;
        is_near.then(|| around.normalize())
    };
    let planes = |at: DVec3| {
        let near = |k: &DVec3| at.dot(*k).abs() < 1e-12;
        let mut near = DVec3::AXES.into_iter().filter(near);
        near.next().filter(|_| near.next().is_none())
    };
    type Face<'a> = &'a dyn Fn(DVec3) -> Option<DVec3>;
    let solids: [(&str, &str, Face<'_>); 5] = [
        ("1/x", BOX, &plane),
        ("1/x^3", BOX, &plane),
        ("1/(x^2 + y^2 - 0.25)", BOX, &tube),
        ("x^(2/3) + y^(2/3) + z^(2/3) - 1", "", &planes),
        ("sqrt x + sqrt y + sqrt z - 1", "", &planes),
    ];
    for (text, cut, face) in solids {
        let scene = of_text(&format!("solid a(x,y,z) = {text}{cut};"));
        let mut caster = scene.world().caster();
        let mut met = 0;
        for k in 0..400 {
            // Sums of few binary digits, among others: many rays land exactly on a pole.
            let turn = f64::from(k) * 0.61803;
            let aside = [
                0.05 + 0.0125 * f64::from(k % 20),
                0.05 + 0.0125 * f64::from(k / 20),
            ];
            let target = DVec3::new(0.0, aside[0], aside[1]);
            let away = match k % 2 {
                0 => DVec3::new(1.0, 0.5, 0.5),
                _ => DVec3::new(1.0, turn.sin(), turn.cos()),
            };
            let ray = Ray {
                origin: target + away,
                direction: -away,
                leaving: None,
            };
            for crossing in caster.cast(&ray) {
                let Some(normal) = face(crossing.position) else {
                    continue;
                };
                met += 1;
                let off = crossing.normal.cross(normal).length();
                assert!(off < 1e-3, "{text}: {crossing:?}, not {normal}");
            }
        }
        assert!(met > 100, "{text}: {met}");
    }
}

#[test]
fn an_image_that_has_no_place_on_a_solid_is_noted() {
    const BALL: &str = "solid b(x,y,z) = x^2 + y^2 + z^2 - 1";
    let faults = |text: &str| -> Vec<String> {
        let scene = of_text(text);
        let notes = scene.notes().into_iter().chain(scene.unplaced(|_| true));
        notes.map(|note| note.to_string()).collect()
    };
    let note = "`b` has no `uv`, so its image is not shown";
    assert_eq!(faults(&format!("{BALL}, image : im;")), [note]);
    assert_eq!(
        faults(&format!("{BALL}, image : im, uv : (x, y);")),
        [""; 0]
    );
    // One that is chosen for it.
    assert_eq!(faults(&format!("{BALL};")), [note]);
    assert_eq!(faults(&format!("{BALL}, uv : (x, y);")), [""; 0]);
    let scene = of_text(&format!(
        "{BALL}; surface s(u,v) = (u,v,2), u : [0,1], v : [0,1], image : im;"
    ));
    assert_eq!(scene.notes(), []);
    assert_eq!(scene.unplaced(|_| false).count(), 0);
}

#[test]
fn each_word_of_a_camera_has_a_meaning_of_its_own() {
    fn differ<T: Default + PartialEq + std::fmt::Debug>(found: &[T]) -> bool {
        let repeats = |k: usize| found[..k].contains(&found[k]);
        found[0] == T::default() && !(0..found.len()).any(repeats)
    }
    let words = |word: AttributeWord| match word.row(DeclarationKeyword::Camera) {
        Some(row) => match row.value {
            AttributeType::Choice(words) => words,
            _ => panic!("{row:?}"),
        },
        None => panic!("{word:?}"),
    };
    let eye = |stated: String| {
        let scene = of_text(&format!("camera c = (1,0,0) @ (-3,0,0), {stated};"));
        scene.cameras()[0].lens
    };
    let shapes: Vec<Bokeh> = words(AttributeWord::Bokeh)
        .iter()
        .map(|word| eye(format!("bokeh : {word}")).bokeh)
        .collect();
    assert!(differ(&shapes), "{shapes:?}");
    let projections: Vec<LensProjection> = words(AttributeWord::Projection)
        .iter()
        .map(|word| eye(format!("projection : {word}")).projection)
        .collect();
    assert!(differ(&projections), "{projections:?}");
    // Those of scripts are the same, except for one word.
    for (attribute, known) in [
        ("apertureshape", words(AttributeWord::Bokeh)),
        ("projection", words(AttributeWord::Projection)),
    ] {
        let row = ObjectName::Camera.attribute(attribute).expect("a row");
        let ValueType::Choice(words) = row.value else {
            panic!("{row:?}");
        };
        for word in words.iter().filter(|word| **word != "uniform") {
            assert!(known.contains(word), "{word}");
        }
    }
}

#[test]
fn to_state_the_default_of_an_attribute_changes_nothing() {
    let standard = StandardLights {
        ambient: 0.2,
        fill: 0.3,
        key: 0.5,
        key_direction: DVec3::Y,
    };
    let seen = |text: &str| {
        let scene = scene::geotrace::compile(text).scene?;
        let scene = Writer { scene }.prepared();
        let lens = scene.cameras()[0].lens;
        let down = ray([0.1, 0.2, 5.0], [0.0, 0.0, -1.0]);
        let look = first(&scene, &down).map(|face| scene.look(&face, &|_, _| None));
        Some(format!(
            "{lens:?} {:?} {look:?} {:?}",
            scene.lights(&lens, &standard),
            scene.glass()
        ))
    };
    let mut compared = Vec::new();
    // Those of glass have another colour unless they state one.
    for (keyword, declaration) in [
        (DeclarationKeyword::Camera, "camera c = (1,0,0) @ (-3,0,0)"),
        (DeclarationKeyword::Light, "light l = (0,0,-1) @ (0,0,4)"),
        (
            DeclarationKeyword::Light,
            "light l = (0,0,-1) @ (0,0,4), radius : 1",
        ),
        (
            DeclarationKeyword::Solid,
            "solid s(x,y,z) = x^2 + y^2 + z^2 - 1, color : 0.5",
        ),
        (
            DeclarationKeyword::Solid,
            "solid s(x,y,z) = x^2 + y^2 + z^2 - 1, glass : 0.5",
        ),
        (
            DeclarationKeyword::Surface,
            "surface s(u,v) = (u, v, 0), u : [-1, 1], v : [-1, 1], color : 0.5",
        ),
    ] {
        let eye = match keyword {
            DeclarationKeyword::Camera => "",
            _ => "camera c = (1,0,0) @ (-3,0,0);",
        };
        let plain = seen(&format!("{eye} {declaration};")).expect("no errors");
        for row in attributes::of(keyword) {
            let is_number = matches!(
                row.value,
                AttributeType::Number(_) | AttributeType::Colour(_)
            );
            let stated = format!("{eye} {declaration}, {} : {};", row.text, row.default);
            // A default that is no expression is a phrase.
            if let Some(stated) = seen(&stated).filter(|_| is_number) {
                assert_eq!(stated, plain, "{declaration}, {}", row.text);
                compared.push(row.text);
            }
        }
    }
    for word in ["fov", "angle", "soft", "ior", "specular", "shininess"] {
        assert!(compared.contains(&word), "{word}: {compared:?}");
    }
}
