//! The examples that the page offers: the programs of the folder `examples`.

use serde_json::{Value, json};
use session::program::first_sentence;

/// A program of the folder.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// The name of its file.
    pub file: &'static str,
    /// The program.
    pub text: &'static str,
}

macro_rules! examples {
    ($($file:literal),* $(,)?) => {
        &[$(Example {
            file: $file,
            text: include_str!(concat!("../../../examples/", $file)),
        }),*]
    };
}

/// All examples, by name.
pub const EXAMPLES: &[Example] = examples![
    "bokeh.crt",
    "carved_box.crt",
    "catenoid.gtr",
    "circle.gtr",
    "cone.gtr",
    "cushion.gtr",
    "deformation.gtr",
    "dice.gtr",
    "disc.gtr",
    "earth.gtr",
    "ellipsoid.gtr",
    "field.gtr",
    "flat.gtr",
    "forest.crt",
    "gears.crt",
    "gyroid.gtr",
    "halfplane.gtr",
    "helicoid.gtr",
    "klein.gtr",
    "lens.gtr",
    "mirror_room.crt",
    "mobius.gtr",
    "monkey.gtr",
    "paraboloid.gtr",
    "pseudosphere.gtr",
    "rays.gtr",
    "ring.gtr",
    "ripples.gtr",
    "sextic.gtr",
    "sphere.gtr",
    "spheres.crt",
    "torus.gtr",
    "trefoil.gtr",
    "triangle.gtr",
    "tube.gtr",
    "wave.gtr",
    "zoll.gtr",
];

impl Example {
    /// Returns the first sentence of its initial comment.
    pub fn about(&self) -> String {
        let mark = if self.file.ends_with(".crt") {
            "--"
        } else {
            "#"
        };
        first_sentence(self.text, mark)
    }
}

/// Returns the list for the page.
pub(crate) fn list() -> Value {
    let all = EXAMPLES.iter();
    all.map(|it| json!({ "file": it.file, "about": it.about(), "text": it.text }))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::EXAMPLES;

    #[test]
    fn every_program_of_the_folder_is_an_example_that_says_what_it_is() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let files = std::fs::read_dir(folder).expect("the folder");
        let names = files.map(|file| file.expect("a file").file_name());
        let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into()).collect();
        names.retain(|name| name.ends_with(".gtr") || name.ends_with(".crt"));
        names.sort();
        let known: Vec<&str> = EXAMPLES.iter().map(|it| it.file).collect();
        assert_eq!(names, known);
        for example in EXAMPLES {
            let about = example.about();
            assert!(about.chars().count() > 10, "{}: {about}", example.file);
        }
    }
}
