//! CRT scripts as programs: what is declared, and which options the picture requires.

use scene::crt::{Converted, convert};
use scene::geotrace::compile;
use syntax::crt::document::Document;

/// The program of a script at t = 0. All names are available.
fn converted(text: &str) -> Converted {
    let document = Document::new(text, &()).expect("short");
    let script = document.snapshot().script();
    convert(&script, text, 0.0, &|_| true).expect("few leaves")
}

#[test]
fn a_set_that_is_not_drawn_leaves_no_parts() {
    let program = converted(
        "r = Material { color -> rgb(1, 0, 0) }
a = Box { cornerA -> vec3(-1, -1, -1) cornerB -> vec3(1, 1, 1) material -> r }
b = Sphere { center -> vec3(0, 0, -1) radius -> .7 }
c = Plane { normal -> vec3(0, 1, 0) position -> vec3(0, 0, 0) }
Scene { (a - b) + (b <scale vec3(1, 0, 1)>)  c <scale 0> }
",
    );
    let text = program.declarations;
    assert!(
        !text.contains("solid ") && !text.contains("surface "),
        "{text}"
    );
    for name in ["5:9", "5:46"] {
        let remark = format!("# `{name}` is not drawn: its map is singular.");
        assert!(text.contains(&remark), "{text}");
    }
}

#[test]
fn the_image_of_the_background_is_the_script_s_file() {
    for (file, word, option) in [
        ("sky.png", true, None),
        ("sky.jpg", true, Some("--texture=sky2=sky.jpg")),
        ("sky.jpeg", true, Some("--texture=sky2=sky.jpeg")),
        ("sky.PNG", false, Some("--texture=sky2=sky.PNG")),
        ("sky.png.webp", false, Some("--texture=sky2=sky.png.webp")),
        ("sky", true, None),
        ("a/b.png", false, Some("--texture=sky2=a/b.png")),
    ] {
        let sphere = "sky = Sphere { center -> vec3(0, 0, 0) radius -> 1 }";
        let background =
            format!("Settings {{ background -> Background {{ image -> \"{file}\" }} }}");
        let program = converted(&format!("{sphere}\n{background}\nScene {{ sky }}\n"));
        let text = program.declarations;
        assert_eq!(text.contains("image : sky,"), word, "{file}: {text}");
        let texture = program
            .options
            .iter()
            .find(|it| it.starts_with("--texture"));
        assert_eq!(texture.map(String::as_str), option, "{file}");
    }
}

#[test]
fn a_plane_extends_far_beyond_where_its_map_brings_it() {
    let program = converted(
        "Scene { Plane { normal -> vec3(0, -1, 0) position -> vec3(0, 10, 0) } <scale 100000> }",
    );
    let text = program.declarations;
    assert!(
        text.contains("u : [-100000000000, 100000000000, 2]"),
        "{text}"
    );
}

#[test]
fn sets_nested_to_the_right_stay_within_the_leaves_of_a_program() {
    let text = "s = Sphere { center -> vec3(0, 0, 0) radius -> 1 }
set = Box { cornerA -> vec3(-1, -1, -1) cornerB -> vec3(1, 1, 1) }
i = 0
while (i < 9990) { set = (s <translate vec3(i * .01, 0, 0)>) - set  i = i + 1 }
Scene { set }
";
    let found = compile(&converted(text).declarations).diagnostics;
    assert_eq!(found, []);
}
