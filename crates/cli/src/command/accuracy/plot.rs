//! A work–precision diagram as SVG: series of points flow in, one picture flows out. Both axes are logarithmic.
//!
//! Written by hand: the diagram is about a hundred lines and rectangles, and the plotting libraries bring fonts and
//! rasterisers with them.

use std::fmt::Write;

/// One method's points.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// The name in the legend.
    pub(super) name: String,
    /// (x, y) with the tooltip of the point; points with a coordinate that is not positive are left out.
    pub(super) points: Vec<([f64; 2], String)>,
}

/// The texts of the diagram.
#[derive(Clone, Debug)]
pub(super) struct Words {
    /// The title, above the diagram.
    pub(super) title: String,
    /// The line below the title.
    pub(super) subtitle: String,
    /// The label of the x axis.
    pub(super) across: &'static str,
    /// The label of the y axis.
    pub(super) up: &'static str,
    /// A height that a dashed line marks, with its label.
    pub(super) mark: (f64, &'static str),
}

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 540.0;
/// The frame: left, top, right, bottom.
const FRAME: [f64; 4] = [74.0, 66.0, 640.0, 480.0];
/// Colours that colour-blind readers can distinguish (M. Okabe and K. Ito, Color Universal Design, 2008).
const COLOURS: [&str; 8] = [
    "#0072b2", "#56b4e9", "#999999", "#009e73", "#e69f00", "#d55e00", "#cc79a7", "#000000",
];
/// Points farther off are cut off.
const RANGE: [f64; 2] = [1e-7, 1e7];

/// A logarithmic axis over whole decades.
struct Axis {
    /// The decimal logarithms at both ends.
    decades: [i32; 2],
    /// The coordinates at both ends.
    ends: [f64; 2],
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, ends: [f64; 2]) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| shown(*value)) {
            low = low.min(value);
            high = high.max(value);
        }
        let (low, high) = if low <= high { (low, high) } else { (0.1, 1.0) };
        let first = low.log10().floor() as i32;
        let last = (high.log10().ceil() as i32).max(first + 1);
        Self {
            decades: [first, last],
            ends,
        }
    }

    fn coordinate(&self, value: f64) -> f64 {
        let [first, last] = self.decades.map(f64::from);
        let share = (value.log10() - first) / (last - first);
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// The values of the grid lines, each with whether it begins a decade.
    fn lines(&self) -> impl Iterator<Item = (f64, bool)> {
        let [first, last] = self.decades;
        (first..=last).flat_map(move |decade| {
            let within: &[f64] = if decade == last {
                &[1.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            within
                .iter()
                .map(move |factor| (factor * 10_f64.powi(decade), *factor == 1.0))
        })
    }
}

fn shown(value: f64) -> bool {
    (RANGE[0]..=RANGE[1]).contains(&value)
}

/// Draws the diagram.
pub(super) fn svg(words: &Words, series: &[Series]) -> String {
    let [left, top, right, bottom] = FRAME;
    let points = || series.iter().flat_map(|series| &series.points);
    let x = Axis::over(points().map(|(at, _)| at[0]), [left, right]);
    let y = Axis::over(
        points().map(|(at, _)| at[1]).chain([words.mark.0]),
        [bottom, top],
    );
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    text(
        &mut out,
        [left, 28.0],
        "start",
        "font-size=\"16\" font-weight=\"bold\"",
        &words.title,
    );
    text(
        &mut out,
        [left, 48.0],
        "start",
        "fill=\"#555555\"",
        &words.subtitle,
    );
    grid(&mut out, &x, &y);
    let middle = [0.5 * (left + right), bottom + 42.0];
    text(&mut out, middle, "middle", "", words.across);
    let side = [22.0, 0.5 * (top + bottom)];
    let turned = format!("transform=\"rotate(-90 {} {})\"", side[0], side[1]);
    text(&mut out, side, "middle", &turned, words.up);
    let (height, name) = words.mark;
    let level = y.coordinate(height);
    line(
        &mut out,
        [left, level],
        [right, level],
        "stroke=\"#444444\" stroke-dasharray=\"5 4\"",
    );
    text(
        &mut out,
        [right - 6.0, level - 5.0],
        "end",
        "fill=\"#444444\" font-size=\"11\"",
        name,
    );
    for (number, series) in series.iter().enumerate() {
        curve(&mut out, number, series, &x, &y);
        let row = top + 12.0 + 24.0 * number as f64;
        let key = right + 22.0;
        let colour = COLOURS[number % COLOURS.len()];
        let stroke = format!("stroke=\"{colour}\" stroke-width=\"2\"");
        line(&mut out, [key, row], [key + 28.0, row], &stroke);
        marker(&mut out, number, [key + 14.0, row], &series.name);
        text(&mut out, [key + 38.0, row + 4.0], "start", "", &series.name);
    }
    out.push_str("</svg>\n");
    out
}

fn grid(out: &mut String, x: &Axis, y: &Axis) {
    let [left, top, right, bottom] = FRAME;
    for (value, begins) in x.lines() {
        let at = x.coordinate(value);
        line(out, [at, top], [at, bottom], shade(begins));
        if begins {
            text(out, [at, bottom + 18.0], "middle", "", &power(value));
        }
    }
    for (value, begins) in y.lines() {
        let at = y.coordinate(value);
        line(out, [left, at], [right, at], shade(begins));
        if begins {
            text(out, [left - 8.0, at + 4.0], "end", "", &power(value));
        }
    }
    let _ = writeln!(
        out,
        "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#444444\"/>",
        right - left,
        bottom - top
    );
}

fn shade(begins: bool) -> &'static str {
    if begins {
        "stroke=\"#c8c8c8\""
    } else {
        "stroke=\"#ececec\""
    }
}

/// Formats a power of ten.
fn power(value: f64) -> String {
    if (1e-3..1e5).contains(&value) {
        // Rounded, so that 10⁻³ is not written with seventeen digits.
        let decimals = (-value.log10().round()).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("1e{}", value.log10().round())
    }
}

fn curve(out: &mut String, number: usize, series: &Series, x: &Axis, y: &Axis) {
    let visible = series
        .points
        .iter()
        .filter(|(at, _)| at.iter().all(|value| shown(*value)));
    let places: Vec<([f64; 2], &str)> = visible
        .map(|(at, note)| ([x.coordinate(at[0]), y.coordinate(at[1])], note.as_str()))
        .collect();
    let path: Vec<String> = places
        .iter()
        .map(|([a, b], _)| format!("{a:.1},{b:.1}"))
        .collect();
    let colour = COLOURS[number % COLOURS.len()];
    let _ = writeln!(
        out,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\" \
         stroke-linejoin=\"round\"/>",
        path.join(" ")
    );
    for (at, note) in places {
        marker(out, number, at, &format!("{}: {note}", series.name));
    }
}

/// Draws the marker of a point. Each series has a shape of its own, so that colour is not the only difference.
fn marker(out: &mut String, number: usize, [x, y]: [f64; 2], title: &str) {
    let colour = COLOURS[number % COLOURS.len()];
    let hollow = number % 2 == 1;
    let fill = if hollow { "white" } else { colour };
    let style = format!("fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.6\"");
    let polygon = |corners: &[[f64; 2]]| {
        let corners: Vec<String> = corners
            .iter()
            .map(|[a, b]| format!("{:.1},{:.1}", x + a, y + b))
            .collect();
        format!("<polygon points=\"{}\" {style}>", corners.join(" "))
    };
    let (shape, tag) = match number % 8 / 2 {
        0 => (
            format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {style}>"),
            "circle",
        ),
        1 => (
            format!(
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"7.6\" height=\"7.6\" {style}>",
                x - 3.8,
                y - 3.8
            ),
            "rect",
        ),
        2 => (polygon(&[[0.0, -5.0], [4.8, 3.8], [-4.8, 3.8]]), "polygon"),
        _ => (
            polygon(&[[0.0, -5.4], [5.4, 0.0], [0.0, 5.4], [-5.4, 0.0]]),
            "polygon",
        ),
    };
    let _ = writeln!(out, "{shape}<title>{}</title></{tag}>", escaped(title));
}

fn line(out: &mut String, [a, b]: [f64; 2], [c, d]: [f64; 2], style: &str) {
    let _ = writeln!(
        out,
        "<line x1=\"{a:.1}\" y1=\"{b:.1}\" x2=\"{c:.1}\" y2=\"{d:.1}\" {style}/>"
    );
}

fn text(out: &mut String, [x, y]: [f64; 2], anchor: &str, style: &str, words: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {style}>{}</text>",
        escaped(words)
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words() -> Words {
        Words {
            title: "a < b".into(),
            subtitle: String::new(),
            across: "time",
            up: "error",
            mark: (0.25, "a quarter"),
        }
    }

    #[test]
    fn decades_enclose_what_is_shown() {
        let axis = Axis::over([0.02, 30.0, f64::NAN, 0.0].into_iter(), [0.0, 100.0]);
        assert_eq!(axis.decades, [-2, 2]);
        assert!((axis.coordinate(1.0) - 50.0).abs() < 1e-9);
        assert_eq!(axis.coordinate(100.0), 100.0);
        let values: Vec<f64> = axis.lines().map(|(value, _)| value).collect();
        assert_eq!(values.len(), 13);
    }

    #[test]
    fn a_diagram_of_nothing_is_still_a_picture() {
        let picture = svg(&words(), &[]);
        assert!(picture.starts_with("<svg") && picture.ends_with("</svg>\n"));
        assert!(picture.contains("a &lt; b"), "{picture}");
    }

    #[test]
    fn points_that_no_axis_can_show_are_left_out() {
        let series = Series {
            name: "s".into(),
            points: [
                [1.0, 0.1],
                [2.0, 0.0],
                [f64::NAN, 1.0],
                [3.0, f64::INFINITY],
            ]
            .map(|at| (at, String::new()))
            .into(),
        };
        let picture = svg(&words(), &[series]);
        // One in the legend and one in the diagram.
        assert_eq!(picture.matches("<circle").count(), 2);
        assert!(!picture.contains("NaN") && !picture.contains("inf"));
    }

    #[test]
    fn powers_of_ten_are_written_short() {
        let written = [1e-4, 1e-3, 0.1, 1.0, 1e4, 1e5].map(power);
        assert_eq!(written, ["1e-4", "0.001", "0.1", "1", "10000", "1e5"]);
    }
}
