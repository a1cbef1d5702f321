//! Solids, in words: the solids of which they are parts, their box, the kinds of surface that bound them.

use std::fmt::Write as _;

use expr::tape::{Registers, Tape};
use expr::{Input, NodeId};
use geometry::solids::{MAX_SHAPE_WORK, RayScene, RaySceneOptions, leaf_class};
use glam::DVec3;
use scene::{ParamValues, Scene};

use super::analysis::GeotraceAnalysis;
use super::completion_place::{Expected, in_set};
use super::hints::short;
use super::item::Item;
use super::start;
use super::targets::Target;

/// The maximum work of a description, in operations on intervals: a fraction of the maximum for a picture.
const MOST_WORK: u64 = MAX_SHAPE_WORK / 16;
/// The maximum number of kinds of leaf that are listed.
const MOST_LEAVES: usize = 12;

/// Returns sentences about the solid that an item declares, with every param at its start.
pub(crate) fn describe(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Vec<String> {
    let mut text = Vec::new();
    text.extend(whole(analysis, item));
    let excerpt = analysis.excerpt([item.index]);
    let scene = excerpt.scene();
    let all = scene.objects.iter().chain(&scene.parts);
    let Some(object) = { all }.find(|object| object.name == item.name) else {
        return text;
    };
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| DVec3::ONE,
        thickness: None,
        stage: false,
        picture_look: Default::default(),
    };
    let params = ParamValues::initial(scene);
    let mut work = MOST_WORK;
    let rays = RayScene::of_solid(scene, &params, &options, object, &mut work);
    if rays.is_out_of_work() {
        text.push("too many instances, or too complex, to locate it here".to_owned());
    }
    if rays.world().solid_count() == 0 {
        return text;
    }
    let start = start::of_object(scene, object);
    if rays.is_empty(0) {
        text.push(format!("empty{start}: it contains no point"));
        return text;
    }
    text.push(extent(&rays, &start));
    text.extend(leaves(&rays));
    text
}

/// Returns a sentence about the solids whose sets name this one, which is then not drawn separately.
pub(super) fn whole(analysis: &GeotraceAnalysis, item: &Item<'_>) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    // The end of the last set that names it: a set may name it many times.
    let mut counted = 0;
    for token in analysis.occurrences(Target::Symbol(item.symbol?)) {
        let Some(before) = token.checked_sub(1) else {
            continue;
        };
        let place = analysis.token(token)?.span.start;
        if place >= counted
            && let Some(set) = analysis.item_at(place)
            && in_set(analysis, &set, before) == Some(Expected::Atom)
        {
            names.push(set.name);
            counted = set.span.end;
        }
    }
    match names[..] {
        [] => None,
        [one] => Some(format!("a part of `{one}`, not drawn itself")),
        [one, other] => Some(format!("a part of `{one}` and `{other}`, not drawn itself")),
        [one, ..] => {
            let others = names.len() - 1;
            Some(format!(
                "a part of `{one}` and {others} others, not drawn itself"
            ))
        }
    }
}

/// Returns the box of a solid; `start` describes the values of the params.
fn extent(rays: &RayScene, start: &str) -> String {
    let Some(bounds) = rays.bounds() else {
        return format!("unbounded{start}");
    };
    let lengths = (bounds.upper - bounds.lower).to_array().into_iter();
    let longest = lengths.filter(|x| x.is_finite()).fold(0.0, f64::max);
    // The box is rounded to at most a hundredth of its size, which is about its accuracy.
    let step = 10_f64.powf(longest.log10().floor() - 2.0);
    let sides = ["x", "y", "z"].into_iter().enumerate().map(|(axis, name)| {
        let [low, high] = [bounds.lower[axis], bounds.upper[axis]];
        // The box is about 1e-9 too large: that must not become a whole step.
        let slack = (1e-6 * longest).min((high - low) / 4.0);
        let low = end(((low + slack) / step).floor() * step);
        let high = end(((high - slack) / step).ceil() * step);
        format!("`{name} : [{low}, {high}]`")
    });
    let sides: Vec<String> = sides.collect();
    format!("within {}{start}", sides.join(", "))
}

/// Returns an end of a box.
fn end(x: f64) -> String {
    match x {
        f64::INFINITY => "∞".to_owned(),
        f64::NEG_INFINITY => "-∞".to_owned(),
        // Without the sign of a zero.
        x => short(x + 0.0),
    }
}

/// Returns the leaves by their names, each with its class.
fn leaves(rays: &RayScene) -> Option<String> {
    let mut found: Vec<(String, &str, u64)> = Vec::new();
    for (name, degree) in rays.leaves() {
        let class = leaf_class(degree);
        let known = found
            .iter_mut()
            .find(|(other, kind, _)| other == name && *kind == class);
        match known {
            Some((.., count)) => *count += 1,
            None => found.push((name.to_owned(), class, 1)),
        }
    }
    let mut told = String::from("leaves: ");
    for (k, (name, class, count)) in found.iter().take(MOST_LEAVES).enumerate() {
        let gap = if k > 0 { ", " } else { "" };
        let times = match count {
            1 => String::new(),
            count => format!("{count} × "),
        };
        // Writing to a string cannot fail.
        let _ = write!(told, "{gap}{times}`{name}` ({class})");
    }
    if found.len() > MOST_LEAVES {
        told.push_str(", …");
    }
    (!found.is_empty()).then_some(told)
}

/// Returns the values of nodes that read no variable; `None` if one reads a variable or is undefined.
pub(crate) fn values(scene: &Scene, nodes: [NodeId; 3], uniforms: &[f64]) -> Option<[f64; 3]> {
    let tape = Tape::new(&scene.graph, &nodes);
    let inputs = tape.inputs().iter().map(|input| match input {
        Input::Uniform(number) => uniforms.get(*number as usize).copied(),
        Input::Variable(_) => None,
    });
    let inputs: Vec<f64> = inputs.collect::<Option<_>>()?;
    let mut numbers = [0.0; 3];
    tape.eval(&mut Registers::default(), &inputs, &mut numbers);
    numbers.iter().all(|x| x.is_finite()).then_some(numbers)
}
