//! The codes in the tables of a traced scene. The constants of the pass have the same names and, as a test checks, the same
//! values.

macro_rules! codes {
    ($($name:ident = $value:expr;)*) => {
        $(pub(super) const $name: u32 = $value;)*

        #[cfg(test)]
        const ALL: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

codes! {
    AXIS_LENS = 1;
    AXIS_LIGHTS = 2;
    PROJECTION_PINHOLE = 0;
    PROJECTION_SPHERICAL = 1;
    PROJECTION_CYLINDRICAL = 2;
    BOKEH_CIRCLE = 0;
    BOKEH_LINE = 1;
    BOKEH_BOX = 2;
    BOKEH_GAUSSIAN = 3;
    BOKEH_POLYGON = 4;
    BOKEH_STAR = 5;
    LIGHT_POINT = 0;
    LIGHT_PARALLEL = 1;
    LIGHT_SPOT = 2;
    LIGHT_BEAM = 3;
    LOOK_CRT = 1;
    SIDES_BOTH = 0;
    SIDES_OUTER = 1;
    SIDES_NONE = 2;
    FIELD_PIECE = 255;
    OPPOSITE_PIECE = 256;
    // The number of words of a field before the numbers that it reads.
    FIELD_HEAD = 7;
    // Mark a material whose transmission, or whose colour, depends on the point.
    VARIES_THROUGH = 1 << 16;
    VARIES_COLOR = 1 << 17;
    // The number of words of a list before its attributes.
    LIST_HEAD = 16;
    LIST_ALONG = 1;
    LIST_BRIGHT = 2;
    VARIED_COLOR = 0;
    VARIED_MIRROR = 1;
    VARIED_GLASS = 2;
    VARIED_DIFFUSE = 3;
    VARIED_SPECULAR = 4;
    VARIED_SHININESS = 5;
    VARIED_BUMP = 6;
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use expr::{Graph, Input};
    use tracer::camera::STAR_INNER;
    use tracer::shade::PARALLEL_REACH;
    use wgsl::traced::{TracedFunctions, trace_scene};

    use super::ALL;

    #[test]
    fn codes_are_those_of_the_pass() {
        // The whole pass: one with a list of attributes and a field.
        let mut graph = Graph::default();
        let x = graph.input(Input::Variable(0));
        let mut functions = TracedFunctions::default();
        functions.list(&graph, &[x]).expect("a small list");
        functions.field(&graph, x).expect("a small field");
        let pass = trace_scene(&functions.text()).expect("valid");
        let pass: BTreeMap<&str, f64> = pass.constants().collect();
        let here: BTreeMap<&str, f64> = ALL.iter().map(|&(it, code)| (it, code.into())).collect();
        for (name, code) in &here {
            assert_eq!(pass.get(name), Some(code), "{name}");
        }
        // The steps of a search in a field are no codes.
        let kinds = here.keys().filter_map(|name| name.split('_').next());
        for kind in kinds.filter(|kind| *kind != "FIELD") {
            let mut of_kind = pass
                .keys()
                .filter(|name| name.split('_').next() == Some(kind));
            assert_eq!(of_kind.find(|name| !here.contains_key(*name)), None);
        }
        for (name, number) in [
            ("PARALLEL_REACH", PARALLEL_REACH),
            ("STAR_INNER", STAR_INNER),
        ] {
            let number = f64::from(number as f32);
            assert_eq!(pass.get(name), Some(&number), "{name}");
        }
    }
}
