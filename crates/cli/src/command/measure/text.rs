//! The answers of `geotrace measure` for people.

use std::f64::consts::{PI, TAU};

use geodesic::measure::{Circle, Connections, PlaceMeasures, Triangle};

use super::pair_text;
use crate::number::{count, is_vague, show_all, show_estimated, show_measured};

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
    show_all(&pair.map(|x| format!("{x:.14e}").parse().unwrap_or(x)))
}

/// The error estimate of some numbers, with a warning where it is so large that most of their digits mean nothing.
fn trust(estimate: f64, values: [f64; 2]) -> String {
    let warning = if values.iter().any(|&value| is_vague(value, estimate)) {
        ": these numbers are not reliable"
    } else {
        ""
    };
    format!("error estimate {estimate:.1e}{warning}")
}

pub(super) fn circle(found: &Circle, radius: f64) -> String {
    let ratio = |value: f64, flat: f64| {
        let share = match is_vague(value, found.error_estimate) {
            true => show_estimated(value / flat, found.error_estimate / flat),
            false => format!("{:.6}", value / flat),
        };
        format!("{share} of the flat one's {}", show_measured(flat))
    };
    let overlap = if found.overlaps {
        "it overlaps itself: regions swept twice count twice"
    } else {
        "it does not overlap itself"
    };
    format!(
        "\
circle of radius {}
  circumference  {}, {}
  area           {}, {}
  trust          {}
  {overlap}
",
        show_measured(radius),
        show_estimated(found.circumference, found.error_estimate),
        ratio(found.circumference, TAU * radius),
        show_estimated(found.area, found.error_estimate),
        ratio(found.area, PI * radius * radius),
        trust(found.error_estimate, [found.circumference, found.area]),
    )
}

/// The geodesics from one place to another, which are loops where their distance is 0; `chart` names the parameters.
pub(super) fn between(
    found: &Connections,
    from: [f64; 2],
    distance: Option<f64>,
    chart: &str,
) -> String {
    let Some(distance) = distance.filter(|_| !found.found.is_empty()) else {
        return String::new();
    };
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
        let family = if it.conjugate {
            ", one of a family: the ends are conjugate"
        } else {
            ""
        };
        let start = super::other_start(it, from);
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
        text.push_str(&format!(
            "  corner {}      angle {}{degrees}, opposite side {}\n",
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
  trust         {}
",
            show_estimated(region.curvature, region.error_estimate),
            show_estimated(region.area, region.error_estimate),
            // A curvature of 0 is as good as the area.
            trust(region.error_estimate, [region.area; 2]),
        )),
        Err(error) => text.push_str(&format!("  no region: {error}\n")),
    }
    text
}
