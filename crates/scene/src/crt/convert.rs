//! Conversion of a script's results into a program of the Geotrace language.
//!
//! In: settings and emitted entities, in the script's coordinates. Out: declarations with y and z exchanged, and the
//! options that the picture requires besides them. Shapes of one kind share a function. A lone plane becomes a parametric
//! surface, because the look `crt` shows such surfaces from one side, unless it is transparent.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::sync::Arc;

use coordinates::{geotrace, half_space, swapped, upright};
use geodesic::vector::{cross, dot};
use text::{affine, brightest, linear, look, number, radians, signed, tuple};

mod coordinates;
mod text;

use super::build;
use super::entity::{Entity, Map, Node, ObjectNode, SetOperation, UnitShape};
use super::value::{Background, Material, ScriptCamera, ScriptLight, ScriptSettings};
use super::vector;
use crate::limits::MAX_LEAVES;
use crate::solid::AffineNodes;

/// The maximum number of leaves of a program.
pub const MAX_CONVERTED_LEAVES: u64 = 10_000;
/// The maximum depth of nested brackets before a set is given a name: the least and the greatest.
const MAX_BRACKETS: std::ops::RangeInclusive<u64> = 16..=128;
/// The length of a line, in characters, after which a set continues on the next line.
const LINE: usize = 80;
/// A plane extends this factor times the extent of the script's positions.
const PLANE_REACH: f64 = 1e5;

/// Returns true for a name that a program may declare.
pub type NameTest<'n> = &'n (dyn Fn(&str) -> bool + Sync);

/// The parameters of functions, which names must not hide.
const PARAMETERS: [&str; 5] = ["x", "y", "z", "u", "v"];

/// A program converted from a script.
#[derive(Clone, Debug, PartialEq)]
pub struct Converted {
    /// The declarations.
    pub declarations: String,
    /// The options of `geotrace render` with which the program gives the script's picture, without the files.
    pub options: Vec<String>,
}

/// Returns the program of a run; `None` if it has too many leaves.
pub(super) fn program(
    settings: &ScriptSettings,
    drawn: &[Arc<Entity>],
    is_free: NameTest<'_>,
) -> Option<Converted> {
    let leaves: u64 = drawn.iter().map(|entity| entity.leaves).sum();
    if leaves > MAX_CONVERTED_LEAVES {
        return None;
    }
    let mut writer = Writer::new(settings, drawn, is_free);
    for entity in drawn {
        writer.object(entity);
    }
    for light in &settings.lights {
        writer.light(light);
    }
    if settings.lights.is_empty() {
        // A program without lights would have the lights of the 3D view.
        let name = writer.free("dark");
        writer.declare(&format!("light {name} = (0, 0, -1), power : 0"));
    }
    let default = Arc::new(ScriptCamera::default());
    let camera = settings.camera.as_ref().unwrap_or(&default);
    writer.camera(camera, settings.dofsamples > 1);
    let background = settings.background.clone().unwrap_or_default();
    let image = writer.background(&background);
    let samples = settings.dofsamples * settings.supersampling * settings.supersampling;
    let mut options = vec![
        "--view=traced".to_owned(),
        "--size=800x600".to_owned(),
        "--look=crt".to_owned(),
        format!("--bounces={}", settings.recursiondepth),
        format!("--samples={samples}"),
    ];
    if settings.gamma != 1.0 {
        options.push(format!("--gamma={}", number(settings.gamma)));
    }
    options.extend(image.map(|image| format!("--texture={image}")));
    let text = writer.functions + "\n" + &writer.declarations;
    Some(Converted {
        declarations: text,
        options,
    })
}

/// A part of a set as text.
struct SetText {
    text: String,
    /// The binding strength of its outermost operations.
    binding: SetBinding,
    /// The depth of brackets in it.
    brackets: u32,
    /// The look of all its leaves; `None` if the leaves state their own.
    material: Option<Arc<Material>>,
    /// The name that it is given if it requires one.
    name: String,
}

/// The loosest-binding operation outside all brackets of a set.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum SetBinding {
    /// Only unions.
    Union,
    /// Differences, and possibly unions.
    Difference,
    Intersection,
    /// One leaf.
    Leaf,
}

/// The remaining work; the next step is last.
enum WriteStep<'a> {
    Entity(&'a Entity, Map),
    Join(SetOperation),
}

struct Writer<'w> {
    /// Returns true for names that the language leaves available.
    is_free: NameTest<'w>,
    /// The functions of shapes.
    functions: String,
    declarations: String,
    /// The names in use.
    names: HashSet<String>,
    /// The last number in the names that are similar to a name.
    numbers: HashMap<String, u32>,
    /// The names of the functions, by their bodies.
    known: HashMap<String, String>,
    /// The extent of planes.
    reach: f64,
    /// The maximum depth of nested brackets.
    max_brackets: u32,
}

impl<'w> Writer<'w> {
    fn new(settings: &ScriptSettings, drawn: &[Arc<Entity>], is_free: NameTest<'w>) -> Self {
        let camera = settings.camera.as_ref().map(|camera| camera.position);
        let mut farthest = 1.0f64;
        let translations = drawn.iter().map(|entity| entity.map.0.map(|row| row[3]));
        let own = drawn.iter().filter_map(|entity| match entity.node() {
            Some(Node::Object(object)) => {
                let map = entity.map.after(&object.first.1);
                Some(map.0.map(|row| row[3]))
            }
            _ => None,
        });
        for place in translations.chain(own).chain(camera) {
            farthest = place.iter().fold(farthest, |most, x| most.max(x.abs()));
        }
        // The leaves of a named set count again in each set that contains it: with n leaves and a name for each b of them,
        // up to n²/2b are counted.
        let leaves: u64 = drawn.iter().map(|entity| entity.leaves).sum();
        let (least, most) = MAX_BRACKETS.into_inner();
        let max_brackets = (leaves * leaves / MAX_LEAVES).clamp(least, most) as u32;
        Self {
            is_free,
            names: PARAMETERS.map(str::to_owned).into(),
            numbers: HashMap::new(),
            functions: String::new(),
            declarations: String::new(),
            known: HashMap::new(),
            reach: PLANE_REACH * 10f64.powf(farthest.log10().ceil()),
            max_brackets,
        }
    }

    /// Returns an available name similar to `like`.
    fn free(&mut self, like: &str) -> String {
        let count = self.numbers.entry(like.to_owned()).or_default();
        loop {
            *count += 1;
            let name = match *count {
                1 => like.to_owned(),
                count => format!("{like}{count}"),
            };
            if !self.names.contains(&name) && (self.is_free)(&name) {
                self.names.insert(name.clone());
                return name;
            }
        }
    }

    fn declare(&mut self, declaration: &str) {
        self.declarations.push_str(declaration);
        self.declarations.push_str(";\n");
    }

    /// Adds a comment on the next declaration.
    fn remark(&mut self, sentence: &str) {
        let _ = writeln!(self.declarations, "# {sentence}.");
    }

    fn object(&mut self, entity: &Entity) {
        // A plane that refracts light is the face of a half-space, although such a face is also visible from behind.
        if let Some(Node::Object(object)) = entity.node()
            && object.is_plane
            && object.material.transparency == 0.0
        {
            return self.plane(entity, object);
        }
        let mut done: Vec<SetText> = Vec::new();
        let mut work = vec![WriteStep::Entity(entity, Map::IDENTITY)];
        let before = self.declarations.len();
        while let Some(next) = work.pop() {
            if self.step(next, &mut work, &mut done).is_none() {
                // Parts that no set uses would be drawn.
                self.declarations.truncate(before);
                return self.not_drawn(entity);
            }
        }
        let Some(mut whole) = done.pop() else {
            return;
        };
        if let Some(label) = label(entity) {
            whole.name = label.to_owned();
        }
        if let Some(Node::Object(object)) = entity.node()
            && object.is_plane
        {
            self.remark(match object.second {
                Some(_) => "The script's half-plane is one face: this solid has a second one, which refracts too",
                None => "The script's plane is seen from one side: this solid is seen from behind too",
            });
        }
        self.named(whole);
    }

    /// Adds a comment in place of a set with a singular map.
    fn not_drawn(&mut self, entity: &Entity) {
        let label = entity.label.as_ref().map_or("a set", |(label, _)| label);
        self.remark(&format!("`{label}` is not drawn: its map is singular"));
    }

    /// Takes a step: replaces a set by its operands, adds a leaf or joins the last two parts. `None` if the set is not drawn.
    fn step<'a>(
        &mut self,
        step: WriteStep<'a>,
        work: &mut Vec<WriteStep<'a>>,
        done: &mut Vec<SetText>,
    ) -> Option<()> {
        match step {
            WriteStep::Join(operation) => {
                let (b, a) = (done.pop()?, done.pop()?);
                let joined = self.joined(operation, a, b);
                done.push(joined);
            }
            WriteStep::Entity(entity, around) => {
                let map = around.after(&entity.map);
                match entity.node()? {
                    Node::Set(operation, a, b) => {
                        work.push(WriteStep::Join(*operation));
                        work.push(WriteStep::Entity(b, map));
                        work.push(WriteStep::Entity(a, map));
                    }
                    Node::Object(object) => {
                        let mut leaf = self.leaf(object, object.first, &map)?;
                        if let Some((operation, shape, own)) = object.second {
                            let other = self.leaf(object, (shape, own), &map)?;
                            leaf = self.joined(operation, leaf, other);
                        }
                        done.push(leaf);
                    }
                }
            }
        }
        Some(())
    }

    /// Declares a set and returns its name.
    fn named(&mut self, set: SetText) -> String {
        let name = self.free(&set.name);
        let mut declaration = format!("solid {name} = {}", set.text);
        if let Some(material) = &set.material {
            let _ = write!(declaration, ",\n    {}", look(material, true));
            if material.transparency > 0.0 && brightest(material) > 1.0 {
                self.remark(
                    "No glass here brightens what is seen through it, as the script's does",
                );
            }
        }
        self.declare(&declaration);
        name
    }

    /// Declares a set as a part of another one.
    fn atom(&mut self, set: SetText) -> SetText {
        let name = set.name.clone();
        SetText {
            text: self.named(set),
            binding: SetBinding::Leaf,
            brackets: 0,
            material: None,
            name,
        }
    }

    fn joined(&mut self, operation: SetOperation, mut a: SetText, mut b: SetText) -> SetText {
        // A material of all leaves is stated once, on the outermost set.
        if a.material != b.material {
            [a, b] = [a, b].map(|set| match set.material {
                Some(_) => self.atom(set),
                None => set,
            });
        }
        let (sign, binding, closed) = match operation {
            SetOperation::Union => {
                let both = a.binding != SetBinding::Difference;
                let binding = if both {
                    SetBinding::Union
                } else {
                    SetBinding::Difference
                };
                ("|", binding, [false, b.binding == SetBinding::Difference])
            }
            SetOperation::Difference => {
                let is_joined = matches!(b.binding, SetBinding::Union | SetBinding::Difference);
                ("\\", SetBinding::Difference, [false, is_joined])
            }
            SetOperation::Intersection => {
                let is_joined = |set: &SetText| {
                    matches!(set.binding, SetBinding::Union | SetBinding::Difference)
                };
                (
                    "&",
                    SetBinding::Intersection,
                    [is_joined(&a), is_joined(&b)],
                )
            }
        };
        [a, b] = [(a, closed[0]), (b, closed[1])].map(|(mut set, closed)| {
            if closed && set.brackets >= self.max_brackets {
                // A part needs no look of its own if the surrounding set states one.
                let material = set.material.take();
                let mut atom = self.atom(set);
                atom.material = material;
                return atom;
            }
            if closed {
                set.text = format!("({})", set.text);
                set.brackets += 1;
            }
            set
        });
        let last = a.text.rfind('\n').map_or(0, |at| at + 1);
        let first = b.text.find('\n').unwrap_or(b.text.len());
        let is_long = a.text.len() - last + first > LINE;
        a.text.push_str(if is_long { "\n    " } else { " " });
        a.text.push_str(sign);
        a.text.push(' ');
        a.text.push_str(&b.text);
        SetText {
            binding,
            brackets: a.brackets.max(b.brackets),
            ..a
        }
    }

    /// Returns a shape; `None` if its map is singular: a set with such a shape is not drawn.
    fn leaf(
        &mut self,
        object: &ObjectNode,
        (shape, own): (UnitShape, Map),
        around: &Map,
    ) -> Option<SetText> {
        let map = swapped(&around.after(&own));
        let text = match (shape, half_space(&map)) {
            (UnitShape::HalfSpace, Some(half)) => {
                self.function("half", affine(half.normal, -half.offset))
            }
            _ if AffineNodes::is_flat(map.0.as_flattened()) => return None,
            _ => self.placed(shape, &map),
        };
        let kind = object.made.split(' ').next().unwrap_or_default();
        let name = match object.name.get() {
            Some(name) => name.to_string(),
            None => kind.to_ascii_lowercase(),
        };
        Some(SetText {
            text,
            binding: SetBinding::Leaf,
            brackets: 0,
            material: Some(object.material.clone()),
            name,
        })
    }

    /// Returns the name of the function of x, y, z with this body.
    fn function(&mut self, like: &str, body: String) -> String {
        if let Some(name) = self.known.get(&body) {
            return name.clone();
        }
        let name = self.free(like);
        let _ = writeln!(self.functions, "function {name}(x, y, z) = {body};");
        self.known.insert(body, name.clone());
        name
    }

    /// Returns a shape under a map.
    fn placed(&mut self, shape: UnitShape, map: &Map) -> String {
        let name = self.shape(shape);
        let map = upright(shape, map);
        let at = map.0.map(|row| row[3]);
        let sizes = [0, 1, 2].map(|k| map.0[k][k]);
        let is_diagonal = (0..3).all(|i| (0..3).all(|j| i == j || map.0[i][j] == 0.0))
            && sizes.iter().all(|s| *s > 0.0);
        if !is_diagonal {
            let rows = map.0.map(|[a, b, c, d]| affine([a, b, c], d));
            let place = self.function("place", format!("({})", rows.join(", ")));
            return format!("{name} @ {place}");
        }
        let mut text = name;
        let [a, b, c] = sizes;
        if a == b && b == c {
            if a != 1.0 {
                let _ = write!(text, " @ scale {}", number(a));
            }
        } else {
            let _ = write!(text, " @ scale {}", tuple(sizes));
        }
        if at != [0.0; 3] {
            let _ = write!(text, " @ {}", tuple(at));
        }
        text
    }

    /// Returns the function of a shape in its own coordinates.
    fn shape(&mut self, shape: UnitShape) -> String {
        let (like, field) = match shape {
            UnitShape::Ball => ("unitball", "x^2 + y^2 + z^2 - 1".to_owned()),
            UnitShape::Cube => ("unitcube", "max(abs x, abs y, abs z) - 1".to_owned()),
            UnitShape::HalfSpace => ("below", "z".to_owned()),
            UnitShape::Cylinder => ("unitcylinder", "max(x^2 + y^2 - 1, -z, z - 1)".to_owned()),
            UnitShape::Cone => (
                "unitcone",
                "max(x^2 + y^2 - (1 - z)^2, -z, z - 1)".to_owned(),
            ),
            UnitShape::Torus(tube) => {
                let rest = signed(1.0 - tube * tube);
                (
                    "unitring",
                    format!("(x^2 + y^2 + z^2 {rest})^2 - 4(x^2 + y^2)"),
                )
            }
        };
        self.function(like, field)
    }

    /// Declares a lone plane as a surface whose σu×σv points out of its half-space.
    fn plane(&mut self, entity: &Entity, object: &ObjectNode) {
        let placed = |own: &Map| swapped(&entity.map.after(own));
        let map = placed(&object.first.1);
        let Some(half) = half_space(&map) else {
            return self.not_drawn(entity);
        };
        let [p, q] = vector::across(half.normal);
        // The half-space behind the direction of a half-plane is omitted; the surface begins at the intersection of
        // both planes.
        let second = object
            .second
            .and_then(|(_, _, own)| half_space(&placed(&own)));
        let ahead = second.and_then(|beyond| {
            let along = dot(beyond.normal, half.normal);
            let in_plane = vector::sub(beyond.normal, vector::scaled(half.normal, along));
            vector::unit(vector::scaled(in_plane, -1.0))
        });
        let [p, q] = match ahead {
            Some(ahead) => [ahead, cross(half.normal, ahead)],
            None => [p, q],
        };
        let at = map.0.map(|row| row[3]);
        let rows = [0, 1, 2].map(|k| {
            let terms = [(p[k], "u"), (q[k], "v")];
            linear(&terms, at[k])
        });
        let name = self.free(label(entity).unwrap_or("plane"));
        let reach = number(self.reach);
        let from = match ahead {
            Some(_) => "0".to_owned(),
            None => format!("-{reach}"),
        };
        let look = look(&object.material, false);
        self.declare(&format!(
            "surface {name}(u, v) = ({}), u : [{from}, {reach}, 2], v : [-{reach}, {reach}, 2],\n    {look}",
            rows.join(", ")
        ));
    }

    fn light(&mut self, light: &ScriptLight) {
        let name = self.free("lamp");
        let place = light.position.map(|place| tuple(geotrace(place)));
        let direction = light.direction.map(|direction| tuple(geotrace(direction)));
        let mut text = format!("light {name} = {}", direction.unwrap_or_default());
        if let Some(place) = place {
            let space = if light.direction.is_some() { " " } else { "" };
            let _ = write!(text, "{space}@ {place}");
        }
        let colour = light.colour.map(|part| part.max(0.0));
        let _ = write!(text, ", color : {}", tuple(colour));
        let mut state = |word: &str, value: f64| {
            let _ = write!(text, ", {word} : {}", number(value));
        };
        if light.ambient > 0.0 {
            state("ambient", light.ambient);
        }
        if light.falloff > 0.0 {
            state("falloff", light.falloff.sqrt());
        }
        if let Some(radius) = light.radius {
            state("radius", radius);
        }
        if light.direction.is_some() && light.position.is_some() {
            state("soft", light.softness);
        }
        if let Some(angle) = light.angle {
            let _ = write!(text, ", angle : {}", radians(angle));
        }
        self.declare(&text);
    }

    fn camera(&mut self, camera: &ScriptCamera, has_lens: bool) {
        let name = self.free("eye");
        let direction = vector::sub(camera.pointing, camera.position);
        let mut text = format!(
            "camera {name} = {} @ {}, fov : {}",
            tuple(geotrace(direction)),
            tuple(geotrace(camera.position)),
            radians(camera.fov)
        );
        if has_lens {
            let _ = write!(
                text,
                ", focus : {}, aperture : {}/{}, bokeh : {}",
                number(camera.focaldistance),
                number(camera.aperture),
                number(build::APERTURES),
                build::bokeh(&camera.apertureshape)
            );
        }
        let roll = build::roll(direction, camera.roll.to_radians());
        if roll != 0.0 {
            let _ = write!(text, ", roll : {}", number(roll));
        }
        if &*camera.projection != "pinhole" {
            let _ = write!(text, ", projection : {}", camera.projection);
        }
        self.declare(&text);
    }

    /// Declares the background; returns the value of `--texture` for an image that is not `WORD.png`.
    fn background(&mut self, background: &Background) -> Option<String> {
        let name = self.free("sky");
        let white = [1.0; 3];
        let image = background.image.as_ref();
        let path = image.map(|image| image.trim_start_matches(['/', '\\']));
        let is_below =
            |path: &str| !path.is_empty() && path.split(['/', '\\']).all(|part| part != "..");
        if path.is_some_and(|path| !is_below(path)) {
            self.remark("The image of the script is not a file below its folder, and is not shown");
        }
        let mut text = match (background.horizon, background.sky, background.colour) {
            (None, None, colour) => {
                format!("background {name} = {}", tuple(colour.unwrap_or(white)))
            }
            (horizon, sky, colour) => {
                let other = colour.unwrap_or(white);
                let [low, high] = [horizon, sky].map(|it| tuple(it.unwrap_or(other)));
                format!("background {name}(x, y, z) = (1 - abs z){low} + (abs z){high}")
            }
        };
        let mut option = None;
        if let Some(path) = path.filter(|path| is_below(path)) {
            // Without an extension, in a script and in a program, `a` is the file `a.png` if there is one, whichever others
            // there are.
            let (word, extension) = path.rsplit_once('.').unwrap_or((path, "png"));
            if is_word(word) && matches!(extension, "png" | "jpg" | "jpeg") {
                let _ = write!(text, ", image : {word}");
            }
            if !is_word(word) || extension != "png" {
                option = Some(format!("{name}={path}"));
            }
            let _ = write!(
                text,
                ", turn : {}",
                number(background.angle - std::f64::consts::FRAC_PI_2)
            );
        }
        self.declare(&text);
        option
    }
}

/// Returns the name of the emitted variable; `None` if there is none.
fn label(entity: &Entity) -> Option<&str> {
    let (label, _) = entity.label.as_ref()?;
    is_word(label).then_some(label)
}

/// Returns true for a text that can be a name, and so the name of an image.
fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric())
}
