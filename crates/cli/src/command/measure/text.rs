//! The answers of `geotrace measure` for people.

use std::f64::consts::{PI, TAU};

use geodesic::measure::{Circle, Connection, Connections, FAMILY_REMARK, PlaceMeasures, Triangle};

use super::pair_text;
use crate::number::{count, is_vague, rounded, show_all, show_estimated, show_measured};

/// The measures at a place of a surface with these parameters.
pub(super) fn place(found: &PlaceMeasures, embedded: bool, parameters: &[String]) -> String {
    let chart = parameters.join(", ");
    let normal: Vec<String> = parameters.iter().map(|name| format!("σ{name}")).collect();
    let normal = normal.join(" × ");
    let curvature = |value: Option<f64>| value.map_or_else(|| "undefined".into(), show_measured);
    let mean = match (found.mean, embedded) {
        (None, false) => "none: a metric has no embedding".into(),
        (mean, _) => format!("{}  for the normal {normal}", curvature(mean)),
    };
    let [e, f, g] = found.form.map(show_measured);
    let mut text = format!(
        "\
at ({chart}) = {}
  Gaussian curvature  K = {}
  mean curvature      H = {mean}
  first form          E = {e}, F = {f}, G = {g}
",
        pair_text(found.uv.0),
        curvature(found.gaussian),
    );
    for (name, it) in ["k1", "k2"].iter().zip(found.principal.iter().flatten()) {
        let [a, b] = it.direction.map(show_measured);
        text += &format!(
            "  principal           {name} = {} along ({a}, {b})\n",
            show_measured(it.curvature)
        );
    }
    text
}

/// A place or a vector to go on from: all digits but the last, which is rounding.
fn show_pair(pair: [f64; 2]) -> String {
    show_all(&pair.map(|x| rounded(x, 15)))
}

/// The error estimates of two numbers, with a warning where one is so large that most digits of its number mean nothing.
fn error_estimates(values: [f64; 2], estimates: [f64; 2]) -> String {
    let is_any_vague = (0..2).any(|k| is_vague(values[k], estimates[k]));
    let warning = if is_any_vague {
        ": these numbers are not reliable"
    } else {
        ""
    };
    let [first, second] = estimates;
    format!("error estimates {first:.1e} and {second:.1e}{warning}")
}

pub(super) fn circle(found: &Circle, radius: f64) -> String {
    let ratio = |value: f64, estimate: f64, formula: &str, flat: f64| {
        if !flat.is_normal() {
            // Too small for its digits.
            return format!("{formula} = {}", show_measured(flat));
        }
        let share = match is_vague(value, estimate) {
            true => show_estimated(value / flat, estimate / flat),
            false => format!("{:.6}", value / flat),
        };
        format!("{share} of {formula} = {}", show_measured(flat))
    };
    let Circle {
        circumference,
        area,
        circumference_error,
        area_error,
        ..
    } = *found;
    let overlap = match found.overlaps {
        Some(true) => "it overlaps itself: regions swept twice count twice",
        Some(false) => "it does not overlap itself",
        None => "whether it overlaps itself is not known",
    };
    format!(
        "\
circle of radius {}
  circumference  {}, {}
  area           {}, {}
  accuracy       {}
  {overlap}
",
        show_measured(radius),
        show_estimated(circumference, circumference_error),
        ratio(circumference, circumference_error, "2πr", TAU * radius),
        show_estimated(area, area_error),
        ratio(area, area_error, "πr²", PI * radius * radius),
        error_estimates([circumference, area], [circumference_error, area_error]),
    )
}

/// The geodesics from one place to another, which are loops where their distance is 0; `chart` names the parameters, and
/// `other_start` gives where one starts if the numbers of the place do not.
pub(super) fn between(
    found: &Connections,
    distance: Option<f64>,
    chart: &str,
    other_start: &dyn Fn(&Connection) -> Option<[f64; 2]>,
) -> String {
    let Some(distance) = distance else {
        return String::new();
    };
    if found.found.is_empty() {
        return format!("distance {}\n", show_measured(distance));
    }
    let (most, kind) = match distance {
        0.0 => ("", "loop"),
        _ if found.distance_known => ("", "geodesic"),
        _ => ("at most ", "geodesic"),
    };
    let mut text = format!(
        "distance {most}{}; {} no longer than {}\n",
        show_measured(distance),
        count(found.found.len(), kind),
        show_measured(found.within)
    );
    for it in &found.found {
        let family = match it.conjugate {
            true => format!(", {FAMILY_REMARK}"),
            false => String::new(),
        };
        let start = other_start(it);
        let start = start.map_or_else(String::new, |at| format!(" from {}", show_pair(at)));
        text.push_str(&format!(
            "  length {:<20} direction {} in {chart}{start}{family}\n",
            show_measured(it.length),
            show_pair(it.direction.0)
        ));
    }
    text
}

pub(super) fn triangle(found: &Triangle) -> String {
    let number = |value: Option<f64>| value.map_or_else(|| "none".into(), show_measured);
    let mut text = String::from("triangle of shortest geodesics\n");
    for (k, (side, angle)) in found.sides.iter().zip(found.angles).enumerate() {
        let degrees = angle.map_or_else(String::new, |angle| {
            format!(" ({:.6}°)", angle.to_degrees())
        });
        let remark = found.remark(k);
        let remark = remark.map_or_else(String::new, |remark| format!(", {remark}"));
        text.push_str(&format!(
            "  corner {}      angle {}{degrees}, opposite side {}{remark}\n",
            k + 1,
            number(angle),
            number(side.map(|side| side.length)),
        ));
    }
    text.push_str(&format!("  angle excess  {}\n", number(found.excess())));
    match &found.region {
        Ok(region) => text.push_str(&format!(
            "  ∫K            {}
  area          {}
  accuracy      {}
",
            show_estimated(region.curvature, region.curvature_error),
            show_estimated(region.area, region.area_error),
            // An integral of 0 is as good as one of 1.
            error_estimates(
                [region.curvature.abs().max(1.0), region.area],
                [region.curvature_error, region.area_error],
            ),
        )),
        Err(error) => text.push_str(&format!("  no region: {error}\n")),
    }
    text
}
