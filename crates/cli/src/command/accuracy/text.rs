//! The measurements as tables for people.

use std::fmt::Write;

use super::measure::{EVERY, STATUSES};
use super::method::NAMES;
use super::{EQUAL, Growth, Measurements, MethodRow};
use crate::number;

/// Formats all tables.
pub(super) fn table(document: &Measurements) -> String {
    let Measurements {
        file,
        surface,
        size: [width, height],
        zoom,
        threads,
        reference,
        ..
    } = document;
    let mut out = format!(
        "{file}: geodesic view of `{surface}` as it opens, {width} × {height} pixels, zoom {zoom:.4}\n"
    );
    let _ = writeln!(
        out,
        "errors in pixels, against {} reference pixels and by hill climbing from the worst{}; times in ms, medians",
        number::grouped(reference.pixels as u64),
        match reference.unknown {
            0 => String::new(),
            unknown => format!(" ({} of them unknown)", number::grouped(unknown as u64)),
        }
    );
    let _ = writeln!(
        out,
        "rk4-pixel and adaptive are run on every {EVERY}th pixel along both axes, their times scaled\n"
    );
    let _ = writeln!(
        out,
        "{:19} {:>10} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} {:>8}  ended",
        "method",
        "setting",
        "1 thread",
        format!("{threads} threads"),
        "eval/px",
        "max",
        "99 %",
        "estimate",
        "unlike"
    );
    let mut last = "";
    for row in &document.rows {
        if row.method != last && !last.is_empty() {
            out.push('\n');
        }
        last = row.method;
        out.push_str(&line(row));
    }
    out.push('\n');
    out.push_str(&equal(document));
    out.push_str(&growth("picture size", &document.by_size, |grown| {
        format!("{}×{}", grown.size[0], grown.size[1])
    }));
    out.push_str(&growth("view length", &document.by_length, |grown| {
        format!("z = {:.3}", grown.zoom)
    }));
    out
}

fn line(row: &MethodRow) -> String {
    let measured = &row.measured;
    format!(
        "{:19} {:>10} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} {:>8}  {}\n",
        row.method,
        row.setting.text(),
        short(measured.time_one_ms),
        short(measured.time_all_ms),
        short(measured.evaluations_per_pixel),
        short(measured.error_px.max),
        short(measured.error_px.p99),
        measured
            .estimate_px
            .map_or_else(|| "–".into(), |bounds| short(bounds.max)),
        percent(measured.unlike),
        ended(row)
    )
}

/// Formats a number with three digits.
fn short(value: f64) -> String {
    if value.is_nan() {
        "–".into()
    } else if value == 0.0 {
        "0".into()
    } else if !(1e-4..1e7).contains(&value) {
        format!("{value:.1e}")
    } else {
        let decimals = (2 - value.log10().floor() as i32).max(0) as usize;
        let rounded = format!("{value:.decimals$}");
        if value >= 1e4 {
            number::grouped(value.round() as u64)
        } else {
            rounded
        }
    }
}

fn percent(share: f64) -> String {
    if share == 0.0 {
        "0".into()
    } else {
        format!("{:.2} %", 100.0 * share)
    }
}

/// Formats the shares of the pixels by status; empty if all are complete.
fn ended(row: &MethodRow) -> String {
    let shares = STATUSES.iter().zip(row.measured.shares);
    let parts: Vec<String> = shares
        .filter(|(_, share)| *share > 0.0)
        .map(|((_, name), share)| {
            if share == 1.0 {
                (*name).to_owned()
            } else {
                format!("{name} {}", percent(share))
            }
        })
        .collect();
    parts.join(", ")
}

/// Finds the fastest setting of each method that is exact enough.
fn equal(document: &Measurements) -> String {
    let mut out = format!("the fastest with at most {EQUAL} px everywhere, on one thread:\n");
    let best = |name: &str| {
        document
            .rows
            .iter()
            .filter(|row| row.method == name)
            .filter(|row| row.measured.error_px.max <= EQUAL && row.measured.unlike == 0.0)
            .min_by(|a, b| a.measured.time_one_ms.total_cmp(&b.measured.time_one_ms))
    };
    let fan = best("fan").map(|row| row.measured.time_one_ms);
    for name in NAMES {
        let text = match best(name) {
            None => "never".to_owned(),
            Some(row) => {
                let ratio = match fan {
                    Some(fan) if name != "fan" => {
                        format!(", {:.0} times the fan's", row.measured.time_one_ms / fan)
                    }
                    _ => String::new(),
                };
                format!(
                    "{} ms ({}, {} evaluations per pixel){ratio}",
                    short(row.measured.time_one_ms),
                    row.setting.text(),
                    short(row.measured.evaluations_per_pixel)
                )
            }
        };
        let _ = writeln!(out, "  {:19} {text}", name);
    }
    out
}

fn growth(what: &str, all: &[Growth], label: impl Fn(&Growth) -> String) -> String {
    let mut out = format!(
        "\nby {what}, on one thread (rk4-pixel with the fewest steps of the table above that reach {EQUAL} px):\n"
    );
    for grown in all {
        let parts: Vec<String> = grown
            .rows
            .iter()
            .map(|row| {
                format!(
                    "{} ({}) {} ms, {} eval/px, max {}",
                    row.method,
                    row.setting.text(),
                    short(row.measured.time_one_ms),
                    short(row.measured.evaluations_per_pixel),
                    short(row.measured.error_px.max)
                )
            })
            .collect();
        let _ = writeln!(out, "  {:10} {}", label(grown), parts.join("; "));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_three_digits() {
        let written = [
            0.0, 1.2345e-6, 0.012345, 0.5, 1.2345, 12.345, 123.45, 1234.5, 123_456.0,
        ]
        .map(short);
        assert_eq!(
            written,
            [
                "0", "1.2e-6", "0.0123", "0.500", "1.23", "12.3", "123", "1234", "123,456"
            ]
        );
    }
}
