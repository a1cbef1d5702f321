//! The programs to start from: the examples, which are embedded in the window, and short templates.

use session::program::first_sentence;

/// An example: a program of the folder `examples`, with its picture in the gallery.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Example {
    /// The name of its file, without the extension.
    pub(crate) name: &'static str,
    /// The program.
    pub(crate) text: &'static str,
    /// Its picture, a PNG file.
    pub(crate) picture: &'static [u8],
}

macro_rules! examples {
    ($($name:literal),* $(,)?) => {
        &[$(Example {
            name: $name,
            text: include_str!(concat!("../../../examples/", $name, ".gtr")),
            picture: include_bytes!(concat!("../../../docs/images/gallery/", $name, ".png")),
        }),*]
    };
}

/// All examples.
pub(crate) const EXAMPLES: &[Example] = examples![
    "catenoid",
    "circle",
    "cone",
    "cushion",
    "deformation",
    "dice",
    "disc",
    "earth",
    "ellipsoid",
    "field",
    "flat",
    "gyroid",
    "halfplane",
    "helicoid",
    "klein",
    "lens",
    "mobius",
    "monkey",
    "paraboloid",
    "pseudosphere",
    "rays",
    "ring",
    "ripples",
    "sextic",
    "sphere",
    "torus",
    "trefoil",
    "triangle",
    "tube",
    "wave",
    "zoll",
];

impl Example {
    /// Returns the description of the program: the first sentence of its initial comment.
    pub(crate) fn description(&self) -> String {
        first_sentence(self.text, "#")
    }
}

/// A short program to start from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Template {
    /// The object that it declares.
    pub(crate) title: &'static str,
    /// The program.
    pub(crate) text: &'static str,
}

macro_rules! templates {
    ($($title:literal in $file:literal),* $(,)?) => {
        &[$(Template {
            title: $title,
            text: include_str!(concat!("../../../examples/templates/", $file)),
        }),*]
    };
}

/// All templates, which the page offers too.
pub(crate) const TEMPLATES: &[Template] = templates![
    "Curve" in "curve.gtr",
    "Surface" in "surface.gtr",
    "Metric" in "metric.gtr",
    "Solid" in "solid.gtr",
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::Path;

    use super::{EXAMPLES, TEMPLATES};

    #[test]
    fn every_program_of_the_folder_is_an_example_with_a_description() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let files = std::fs::read_dir(folder).expect("the folder");
        let paths = files.map(|file| file.expect("a file").path());
        let programs = paths.filter(|path| path.extension().is_some_and(|it| it == "gtr"));
        let names = programs.map(|path| {
            let name = path.file_stem().expect("a name");
            name.to_string_lossy().into_owned()
        });
        let names: BTreeSet<String> = names.collect();
        let known: Vec<String> = EXAMPLES.iter().map(|it| it.name.to_owned()).collect();
        assert_eq!(names.into_iter().collect::<Vec<_>>(), known);
        for example in EXAMPLES {
            let description = example.description();
            assert!(
                description.ends_with('.') && description.chars().count() < 160,
                "{}: {description}",
                example.name
            );
            assert!(image::load_from_memory(example.picture).is_ok());
        }
    }

    #[test]
    fn every_template_is_sound_and_laid_out() {
        let languages = ide::Languages::standard();
        for template in TEMPLATES {
            let analysis = languages.default_language().read(template.text);
            assert_eq!(*analysis.diagnostics(), [], "{}", template.title);
            assert_eq!(analysis.format(None), [], "{}", template.title);
        }
    }
}
