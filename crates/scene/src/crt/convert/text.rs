//! Numbers, sums of terms and looks in the syntax of a program.

use std::fmt::Write;

use crate::crt::value::Material;

/// Returns a number in the syntax of a program, with as many digits as it needs.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Returns `+ 1` or `- 1`.
pub(super) fn signed(value: f64) -> String {
    let sign = if value < 0.0 { '-' } else { '+' };
    format!("{sign} {}", number(value.abs()))
}

/// Returns a tuple of numbers.
pub(super) fn tuple(values: [f64; 3]) -> String {
    format!("({})", values.map(number).join(", "))
}

/// Returns degrees as radians.
pub(super) fn radians(degrees: f64) -> String {
    format!("{}pi/180", number(degrees))
}

/// Returns a sum of multiples of x, y, z and a constant.
pub(super) fn affine(factors: [f64; 3], constant: f64) -> String {
    let [a, b, c] = factors;
    linear(&[(a, "x"), (b, "y"), (c, "z")], constant)
}

/// Returns a sum of multiples of variables and a constant.
pub(super) fn linear(terms: &[(f64, &str)], constant: f64) -> String {
    let mut text = String::new();
    let mut add = |value: f64, variable: &str| {
        if value == 0.0 {
            return;
        }
        let sign = match (text.is_empty(), value < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(sign);
        if variable.is_empty() || value.abs() != 1.0 {
            text.push_str(&number(value.abs()));
        }
        text.push_str(variable);
    };
    for (factor, variable) in terms {
        add(*factor, variable);
    }
    add(constant, "");
    if text.is_empty() {
        text.push('0');
    }
    text
}

/// Returns the maximum component of a material's colour, at least 1.
pub(super) fn brightest(material: &Material) -> f64 {
    let parts = material.colour.iter();
    parts.fold(1.0f64, |most, part| most.max(*part))
}

/// Returns the attributes of a material, for a solid or else for a surface.
///
/// A colour above 1, which attributes do not allow, is divided by its maximum component, and the light that it reflects is
/// multiplied by it; the light transmitted through glass is not.
pub(super) fn look(material: &Material, is_solid: bool) -> String {
    let most = brightest(material);
    let colour = material.colour.map(|part| (part / most).max(0.0));
    let usual = (1.0 - material.reflectivity - material.transparency).max(0.0);
    let diffuse = most * material.diffuse.unwrap_or(usual);
    let mut text = format!("color : {}", tuple(colour));
    let mut state = |word: &str, value: f64| {
        let _ = write!(text, ", {word} : {}", number(value));
    };
    if diffuse != usual {
        state("diffuse", diffuse);
    }
    state("specular", most * material.specularity);
    if material.specularity > 0.0 {
        state("shininess", material.shininess);
    }
    if material.reflectivity > 0.0 {
        state("mirror", material.reflectivity);
    }
    if material.transparency > 0.0 {
        state("glass", material.transparency);
        if is_solid {
            state("ior", material.refractiveindex);
        }
    }
    text
}
