//! The values of params and grids for which descriptions hold: those at the start of a program.

use scene::{Object, ParamValues, Scene};

use super::hints::short;

/// The maximum number of names that are listed.
const MOST_NAMES: usize = 4;

/// Returns the end of a sentence about a whole scene: ", for `a = 2`" if it has params.
pub(crate) fn of_scene(scene: &Scene) -> String {
    let values = ParamValues::initial(scene);
    let params = scene.params.iter();
    told(params.map(|param| (&*param.name, values.param(param).to_vec())))
}

/// Returns the end of a sentence about the first instance of an object: ", for `a = 2`, `k = 0`" if it reads params or
/// grids.
pub(crate) fn of_object(scene: &Scene, object: &Object) -> String {
    let uniforms = ParamValues::initial(scene).first_instance(scene, object);
    let numbers = |first: u32, count: usize| {
        let uniforms = uniforms.iter().skip(first as usize);
        uniforms.take(count).copied().collect::<Vec<f64>>()
    };
    let params = object.params.iter().filter_map(|id| {
        let param = scene.params.get(id.0 as usize)?;
        Some((
            &*param.name,
            numbers(param.first_uniform, param.ranges.len()),
        ))
    });
    let grids = object.grids.iter().filter_map(|id| {
        let grid = scene.grids.get(id.0 as usize)?;
        Some((&*grid.name, numbers(grid.first_uniform, grid.axes.len())))
    });
    told(params.chain(grids))
}

fn told<'s>(values: impl Iterator<Item = (&'s str, Vec<f64>)>) -> String {
    let mut written: Vec<String> = values
        .map(|(name, numbers)| {
            let numbers: Vec<String> = numbers.into_iter().map(short).collect();
            match &numbers[..] {
                [number] => format!("`{name} = {number}`"),
                numbers => format!("`{name} = ({})`", numbers.join(", ")),
            }
        })
        .collect();
    if written.is_empty() {
        return String::new();
    }
    let more = written.len().saturating_sub(MOST_NAMES);
    written.truncate(MOST_NAMES);
    let more = match more {
        0 => String::new(),
        1 => " and one more at its start".to_owned(),
        more => format!(" and {more} more at their start"),
    };
    format!(", for {}{more}", written.join(", "))
}
