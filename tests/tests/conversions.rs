//! `geotrace convert` and the code action: a script and the program that is made of it give the same picture.

use std::path::Path;

use image::RgbImage;
use serde_json::{Value, json};
use testing::binary::geotrace;
use testing::editor::{Editor, Place};

/// Draws by the words behind `geotrace`, in a folder.
fn draw(folder: &Path, words: &[&str], picture: &str) -> RgbImage {
    let run = geotrace(words.iter().copied()).folder(folder).run();
    run.expect_status(0);
    image::open(folder.join(picture))
        .expect("a picture")
        .to_rgb8()
}

/// Converts a script in a folder, and draws both with one sample: the script as it is, the program by the command of its first
/// comment. Returns the program.
fn expect_same(folder: &Path, name: &str, size: &str, set: &[&str]) -> String {
    let (script, program) = (format!("{name}.crt"), format!("{name}.gtr"));
    let words = [&["convert", &script, "-o", &program], set].concat();
    geotrace(words).folder(folder).run().expect_status(0);
    let text = std::fs::read_to_string(folder.join(&program)).expect("written");
    let check = geotrace(["check", &program]).folder(folder).run();
    check.expect_status(0);
    assert_eq!(
        check.stderr.trim(),
        format!("{program}: no errors"),
        "{text}"
    );
    geotrace(["format", "--check", &program])
        .folder(folder)
        .run()
        .expect_status(0);
    let command = text.lines().next().expect("a comment");
    let command = command.strip_prefix("# geotrace ").expect("the command");
    let words: Vec<&str> = command.split(' ').collect();
    // Only the number of samples, and the size, are others than those of the script.
    let words: Vec<&str> = words
        .into_iter()
        .filter(|word| !word.starts_with("--samples") && !word.starts_with("--size"))
        .collect();
    let options = ["--samples", "1", "--size", size];
    let converted = draw(
        folder,
        &[&words[..], &options].concat(),
        &format!("{name}.png"),
    );
    let own = ["render", &script, "-o", "own.png"];
    let own = draw(folder, &[&own[..], &options, set].concat(), "own.png");
    let far = own.pixels().zip(converted.pixels()).filter(|(a, b)| {
        let mut parts = a.0.iter().zip(b.0);
        parts.any(|(a, b)| a.abs_diff(b) > 1)
    });
    assert_eq!(far.count(), 0, "{name}: pixels differ\n{text}");
    let mut colours: Vec<_> = own.pixels().map(|pixel| pixel.0).collect();
    colours.sort_unstable();
    colours.dedup();
    assert!(colours.len() > 20, "{name} shows {} colours", colours.len());
    text
}

#[test]
fn every_example_gives_the_same_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(examples).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "crt") {
            continue;
        }
        std::fs::copy(&path, folder.path().join(path.file_name().expect("a name")))
            .expect("copied");
        let name = path
            .file_stem()
            .expect("a stem")
            .to_string_lossy()
            .into_owned();
        expect_same(folder.path(), &name, "160x120", &[]);
        count += 1;
    }
    assert!(count >= 6, "{count} scripts");
    let still = std::fs::read_to_string(folder.path().join("gears.gtr")).expect("written");
    let turned = expect_same(folder.path(), "gears", "160x120", &["--set", "t=7"]);
    assert!(still != turned, "t moves the gears");
}

#[test]
fn a_transparent_plane_that_is_alone_refracts() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = r#"
Settings {
    camera -> Camera { position -> vec3(0, 1, -4)  pointing -> vec3(0, 0, 0)  fov -> 60 }
    lights -> [ PointLight { origin -> vec3(2, 4, -3)  color -> rgb(1, 1, 1)  ambient -> 0.2 } ]
    background -> Background { horizon -> rgb(0.9, 0.9, 0.9)  sky -> rgb(0.2, 0.4, 0.9) }
}
Scene {
    Plane { normal -> vec3(0, 1, 0)  position -> vec3(0, 0, 0)  material -> Material { color -> rgb(0.5, 0.8, 0.6)  transparency -> 0.8 } }
    Sphere { center -> vec3(0, 0.8, 0)  radius -> 0.5  material -> Material { color -> rgb(0.9, 0.3, 0.2) } }
}
"#;
    std::fs::write(folder.path().join("water.crt"), script).expect("written");
    let text = expect_same(folder.path(), "water", "160x120", &[]);
    assert!(text.contains("\nsolid "), "{text}");
}

#[test]
fn the_image_of_a_script_in_another_folder_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let [scripts, programs] = ["scripts", "programs"].map(|name| folder.path().join(name));
    std::fs::create_dir_all(scripts.join("sub")).expect("a folder");
    std::fs::create_dir(&programs).expect("a folder");
    let blue = image::Rgb([0, 0, 255]);
    for file in ["sky.png", "sub/sky.png"] {
        let image = image::RgbImage::from_pixel(8, 4, blue);
        image.save(scripts.join(file)).expect("written");
    }
    for (image, by_option) in [("sky", false), ("sub/sky", true), ("sub/sky.png", true)] {
        let script = format!(
            "Settings {{ background -> Background {{ image -> \"{image}\" }} }}\nScene {{ }}\n"
        );
        std::fs::write(scripts.join("s.crt"), script).expect("written");
        geotrace(["convert", "../scripts/s.crt", "-o", "s.gtr"])
            .folder(&programs)
            .run()
            .expect_status(0);
        let text = std::fs::read_to_string(programs.join("s.gtr")).expect("written");
        assert_eq!(text.contains("--texture"), by_option, "{text}");
        let command = text
            .lines()
            .find_map(|line| line.strip_prefix("# geotrace "));
        let command = command.expect("a command").split_whitespace();
        let command = command.filter(|word| !word.starts_with("--size"));
        let options = ["--size", "16x16", "--images", "../scripts"];
        let picture = draw(
            &programs,
            &command.chain(options).collect::<Vec<_>>(),
            "s.png",
        );
        assert_eq!(picture.get_pixel(8, 8).0, [0, 0, 255], "{image}");
    }
}

/// Everything that a script may state, in one picture.
const ALL: &str = r#"
x = Sphere { center -> vec3(0, 0.3, 0)  radius -> 0.8  material -> Material { color -> rgb(1.6, 0.4, 0.2)  specularity -> 0.4  shininess -> 9 } }
light = Cylinder { base -> vec3(-1, -1, 0.2)  top -> vec3(1, 1, -0.3)  radius -> 0.4  material -> Material { color -> rgb(0.2, 0.5, 0.9)  reflectivity -> 0.3 } }
sin = Cone { base -> vec3(1.8, -1, 1)  apex -> vec3(1.5, 1, 0.5)  radius -> 0.6 }
ring = Torus { center -> vec3(-1.7, 0, 0.4)  radius -> 0.6  tube -> 0.2  normal -> vec3(1, 2, -0.5)  material -> Material { color -> rgb(0.9, 0.8, 0.2)  diffuse -> 0.5 } }
box = Box { cornerA -> vec3(-0.5, -0.5, -0.5)  cornerB -> vec3(0.5, 0.6, 0.7) }
glass = Sphere { center -> vec3(0.7, -0.4, -1.4)  radius -> 0.4  material -> Material { color -> rgb(0.9, 1, 0.9)  transparency -> 0.8  reflectivity -> 0.1 } }
cut = Plane { normal -> vec3(1, 1, 0.3)  position -> vec3(0.2, 0.4, 0) }
wedge = HalfPlane { normal -> vec3(0, 0, 1)  position -> vec3(0, 0, 0.3)  direction -> vec3(1, 0, 0) }
Settings {
    gamma -> 1.8
    recursiondepth -> 2
    camera -> Camera { position -> vec3(0.4, 1.4, -5)  pointing -> vec3(0, 0.1, 0)  fov -> 48  roll -> 7 }
    background -> Background { horizon -> rgb(0.9, 0.9, 1)  sky -> rgb(0.2, 0.4, 0.9) }
    lights -> [
        PointLight { origin -> vec3(-3, 4, -3)  color -> rgb(0.5, 0.5, 0.4)  ambient -> 0.1  falloff -> 60 },
        ParallelLight { from -> vec3(3, 5, -2)  pointing -> vec3(0, 0, 0)  color -> rgb(0.3, 0.3, 0.3) },
        SpotLight { origin -> vec3(0, 5, -1)  pointing -> vec3(0, 0, 0)  color -> rgb(0.5, 0.4, 0.4)  angle -> 30  softness -> 0.5 },
        CylinderLight { origin -> vec3(-2, 3, -4)  pointing -> vec3(-1, 0, 0)  color -> rgb(0.2, 0.5, 0.2)  radius -> 1 }
    ]
}
Scene {
    (x ^ box <rotate vec3(10, 20, 30)>) - light
    light <translate vec3(0, 0, 1.5)>
    sin - (sin <scale 0.7, translate vec3(0.4, 0.2, -0.3)> - cut)
    ring <scale vec3(1, 1.3, 1)>
    glass
    box <translate vec3(1.4, 0.1, -0.6)> ^ wedge <translate vec3(1.4, 0, -0.6)>
    Plane { normal -> vec3(0, 1, 0)  position -> vec3(0, -1.1, 0)  material -> Material { color -> rgb(0.5, 0.5, 0.55)  reflectivity -> 0.2 } }
    HalfPlane { normal -> vec3(0, 0, -1)  position -> vec3(0.5, 0, 3)  direction -> vec3(1, 0.4, 0)  material -> Material { color -> rgb(0.7, 0.3, 0.5) } }
}
"#;

#[test]
fn all_that_a_script_states_is_in_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("all.crt"), ALL).expect("written");
    let text = expect_same(folder.path(), "all", "200x150", &[]);
    for taken in ["solid x ", "solid sin "] {
        assert!(!text.contains(taken), "`{taken}` is no free name\n{text}");
    }
    assert!(text.contains("solid ring = "), "{text}");
    for (camera, projection) in [("spherical", 40), ("cylindrical", 70)] {
        let name = format!("all-{camera}");
        let states = format!("fov -> {projection}  projection -> \"{camera}\"");
        let script = ALL.replace("fov -> 48", &states);
        std::fs::write(folder.path().join(format!("{name}.crt")), script).expect("written");
        expect_same(folder.path(), &name, "160x120", &[]);
    }
    // A camera that looks straight down, and a lens: with one sample there is none.
    let down = ALL
        .replace(
            "position -> vec3(0.4, 1.4, -5)",
            "position -> vec3(0, 6, 0)",
        )
        .replace(
            "pointing -> vec3(0, 0.1, 0)",
            "pointing -> vec3(0.03, 0, 0.01)",
        );
    std::fs::write(folder.path().join("down.crt"), down).expect("written");
    expect_same(folder.path(), "down", "160x120", &[]);
}

#[test]
fn a_lens_is_as_large_in_the_program_as_in_the_script() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "
Settings {
    camera -> Camera { position -> vec3(2, 2, -6)  pointing -> vec3(2, 0.5, 0)  fov -> 50 }
    lights -> [ParallelLight { from -> vec3(1, 2, -1)  pointing -> vec3(0, 0, 0)  color -> rgb(1, 1, 1) }]
    dofsamples -> 16
}
Scene { Sphere { center -> vec3(2, 0.5, 0)  radius -> 1 } }
";
    std::fs::write(folder.path().join("lens.crt"), script).expect("written");
    let text = expect_same(folder.path(), "lens", "80x60", &[]);
    assert!(text.contains("aperture : 3/720"), "{text}");
    let pictures = [
        ("lens.crt", "crt"),
        ("lens.gtr", "crt"),
        ("lens.gtr", "geotrace"),
    ];
    let pictures = pictures.map(|(file, look)| {
        let words = "--view traced --size 80x60 --samples 16 --bounces 3 -o lens.png --look";
        let words: Vec<&str> = ["render", file]
            .into_iter()
            .chain(words.split(' '))
            .collect();
        draw(folder.path(), &[&words[..], &[look]].concat(), "lens.png")
    });
    for picture in &pictures {
        // The ball is grey, the background white.
        let [middle, corner] = [(40, 30), (2, 2)].map(|(x, y)| picture.get_pixel(x, y).0[0]);
        assert!(middle < 200 && corner > 250, "{middle}, {corner}");
    }
    let [script, program, _] = &pictures;
    assert_eq!(script.get_pixel(40, 30), program.get_pixel(40, 30));
}

#[test]
fn sets_within_sets_stay_what_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    // Sixty shells, each cut out of the one around it: brackets within brackets.
    let script = "
a = Sphere { center -> vec3(0, 0, 0)  radius -> 0.02  material -> Material { color -> rgb(0.9, 0.3, 0.2) } }
i = 0
while (i < 60) {
    r = 0.05 + i * 0.03
    b = Sphere { center -> vec3(0, 0, 0)  radius -> r  material -> Material { color -> rgb(0.9, 0.3, 0.2) } }
    a = (b - a) ^ Plane { normal -> vec3(0, 0, -1)  position -> vec3(0, 0, 0)  material -> Material { color -> rgb(0.9, 0.3, 0.2) } }
    i = i + 1
}
Settings {
    camera -> Camera { position -> vec3(0, 0, -5)  pointing -> vec3(0, 0, 0)  fov -> 45 }
    lights -> [PointLight { origin -> vec3(-3, 4, -3)  color -> rgb(1, 1, 1)  ambient -> 0.1 }]
}
Scene { a }
";
    std::fs::write(folder.path().join("shells.crt"), script).expect("written");
    let text = expect_same(folder.path(), "shells", "120x90", &[]);
    assert!(!text.contains(&"(".repeat(20)), "{text}");
}

#[test]
fn a_shape_without_a_volume_is_left_out_as_it_is_not_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = "
Settings {
    camera -> Camera { position -> vec3(0, 0, -5)  pointing -> vec3(0, 0, 0)  fov -> 45 }
    lights -> [PointLight { origin -> vec3(-3, 4, -3)  color -> rgb(1, 1, 1)  ambient -> 0.1 }]
}
Scene {
    Sphere { center -> vec3(0, 0, 0)  radius -> 1 } <scale 0>
    Box { cornerA -> vec3(1, 0, 0)  cornerB -> vec3(2, 1, 0) }
    Sphere { center -> vec3(0, 0, 0)  radius -> 0.5 }
}
";
    std::fs::write(folder.path().join("flat.crt"), script).expect("written");
    let text = expect_same(folder.path(), "flat", "120x90", &[]);
    assert_eq!(text.matches("\nsolid ").count(), 1, "{text}");
}

#[test]
fn what_the_script_draws_otherwise_than_it_says_is_converted_as_it_is_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "Scene { Sphere { center -> vec3(0,1,0) radius -> 1 }
    HalfPlane { normal -> vec3(0,1,0) position -> vec3(0,0,0) direction -> vec3(0,2,0) } }";
    let camera =
        "camera -> Camera { position -> vec3(0,2,-5) pointing -> vec3(0,0.5,0) fov -> 50 }";
    for (name, rest) in [
        (
            "dark",
            "lights -> [PointLight { origin -> vec3(3,5,-4) color -> rgb(-0.5,0.5,0.5) }]",
        ),
        (
            "out",
            "background -> Background { image -> \"dir/../earth.png\" angle -> 1.2 }",
        ),
        (
            "none",
            "background -> Background { image -> \"\" angle -> 1.2 }",
        ),
    ] {
        let lamp = "lights -> [PointLight { origin -> vec3(3,5,-4) color -> rgb(1,1,1) }]";
        let lamp = if rest.starts_with("lights") { "" } else { lamp };
        let text = format!("Settings {{ {camera} {rest} {lamp} }}\n{scene}\n");
        std::fs::write(folder.path().join(format!("{name}.crt")), text).expect("written");
        std::fs::write(folder.path().join("earth.png"), "not opened").expect("written");
        let program = expect_same(folder.path(), name, "64x48", &[]);
        assert_eq!(
            program.contains("is not shown"),
            name != "dark",
            "{program}"
        );
    }
}

#[test]
fn what_cannot_be_converted_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::write(path.join("a.gtr"), "point p = (0, 0, 0);").expect("written");
    std::fs::write(path.join("wrong.crt"), "Scene { b }").expect("written");
    std::fs::write(
        path.join("good.crt"),
        "Scene { Sphere { center -> vec3(0, 0, 0)  radius -> 1 } }",
    )
    .expect("written");
    let many = "s = Sphere { center -> vec3(0, 0, 0)  radius -> 1 }
m = Macro () { i = 0  while (i < 10001) { s <translate vec3(i, 0, 0)>  i = i + 1 } }
Scene { m() }";
    std::fs::write(path.join("many.crt"), many).expect("written");
    for (words, status, sentence) in [
        (["a.gtr", "b.gtr"], 1, "only CRT scripts are converted"),
        (["wrong.crt", "b.gtr"], 1, "b"),
        (["many.crt", "b.gtr"], 1, "more than 10000 shapes"),
        (["good.crt", "b.crt"], 2, "ends in .gtr"),
        (["good.crt", "b"], 2, "ends in .gtr"),
    ] {
        let [script, program] = words;
        let run = geotrace(["convert", script, "-o", program])
            .folder(path)
            .run();
        run.expect_status(status);
        assert!(run.stderr.contains(sentence), "{words:?}: {}", run.stderr);
        assert!(
            !path.join("b.gtr").exists() && !path.join("b.crt").exists(),
            "{words:?}"
        );
    }
    // To standard output; the name in the comment is that of the script.
    let run = geotrace(["convert", "good.crt", "-o", "-"])
        .folder(path)
        .run();
    run.expect_status(0);
    assert!(
        run.stdout
            .starts_with("# geotrace render good.gtr -o good.png --view=traced"),
        "{}",
        run.stdout
    );
    assert!(
        run.stdout.contains("power : 0"),
        "without lights it is dark\n{}",
        run.stdout
    );
}

/// Opens a script; the code actions on its first line.
async fn actions(editor: &mut Editor, uri: &str, text: &str, only: &[&str]) -> Value {
    let document = json!({ "uri": uri, "languageId": "crt", "version": 1, "text": text });
    editor
        .notify("textDocument/didOpen", json!({ "textDocument": document }))
        .await;
    let start = json!({ "line": 0, "character": 0 });
    let params = json!({
        "textDocument": { "uri": uri },
        "range": { "start": start, "end": start },
        "context": { "diagnostics": [], "only": only },
    });
    editor.ask("textDocument/codeAction", params).await
}

const GOOD: &str = "Scene { Sphere { center -> vec3(0, 0, 0)  radius -> 1 } }";

fn creating_files() -> Value {
    // As Neovim has it: it does not say that it takes lists of changes.
    let edit = json!({ "resourceOperations": ["create", "rename"] });
    json!({
        "workspace": { "applyEdit": true, "workspaceEdit": edit },
        "window": { "showDocument": { "support": true } },
    })
}

#[tokio::test]
async fn an_editor_converts_a_script_into_a_new_file_and_shows_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let uri = |name: &str| format!("file://{}", folder.path().join(name).display());
    let mut editor = Editor::start(Place::Here, "convert");
    editor.initialize(creating_files()).await;
    let found = actions(&mut editor, &uri("good.crt"), GOOD, &["source"]).await;
    assert_eq!(found[0]["title"], "Convert to Geotrace's language");
    assert_eq!(found[0]["kind"], "source.convert");
    assert_eq!(found.as_array().map(Vec::len), Some(1));
    let command = found[0]["command"].clone();
    let run = json!({ "command": command["command"], "arguments": command["arguments"] });
    for name in ["good.gtr", "good-2.gtr"] {
        // What is there is never written over.
        editor.ask("workspace/executeCommand", run.clone()).await;
        let asked = editor.asked("workspace/applyEdit").await;
        let changes = &asked["edit"]["documentChanges"];
        assert_eq!(changes[0], json!({ "kind": "create", "uri": uri(name) }));
        assert_eq!(changes[1]["textDocument"]["uri"], uri(name));
        let text = changes[1]["edits"][0]["newText"].as_str().expect("a text");
        assert!(
            text.starts_with(&format!("# geotrace render {name} ")),
            "{text}"
        );
        assert!(text.contains("solid sphere = "), "{text}");
        let shown = editor.asked("window/showDocument").await;
        assert_eq!(shown["uri"], uri(name));
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    // The user is notified of what the editor refuses, and of what cannot be converted.
    editor.applied = json!({ "applied": false, "failureReason": "it is read-only" });
    editor.ask("workspace/executeCommand", run).await;
    let notification = editor.notified("window/showMessage", |_| true).await;
    assert!(
        notification["message"]
            .as_str()
            .expect("a text")
            .contains("it is read-only"),
        "{notification}"
    );
    let wrong = uri("wrong.crt");
    actions(&mut editor, &wrong, "Scene { b }", &[]).await;
    let run = json!({ "command": "geotrace.convert", "arguments": [wrong] });
    editor.ask("workspace/executeCommand", run).await;
    let notification = editor.notified("window/showMessage", |_| true).await;
    assert!(
        notification["message"]
            .as_str()
            .expect("a text")
            .contains("with errors"),
        "{notification}"
    );
    // Other documents are not converted.
    let document =
        json!({ "uri": uri("a.gtr"), "languageId": "geotrace", "version": 1, "text": "" });
    editor
        .notify("textDocument/didOpen", json!({ "textDocument": document }))
        .await;
    let none = actions(&mut editor, &uri("a.gtr"), "", &[]).await;
    assert_eq!(none, json!([]));
    assert_eq!(editor.quit().await, 0);

    // An editor that creates no files is not offered it.
    let mut editor = Editor::start(Place::Here, "convert-no-files");
    editor
        .initialize(json!({ "workspace": { "applyEdit": true } }))
        .await;
    let found = actions(&mut editor, &uri("good.crt"), GOOD, &[]).await;
    assert_eq!(found, json!([]));
    let run = json!({ "command": "geotrace.convert", "arguments": [uri("good.crt")] });
    editor.ask("workspace/executeCommand", run).await;
    let notification = editor.notified("window/showMessage", |_| true).await;
    assert!(
        notification["message"]
            .as_str()
            .expect("a text")
            .contains("geotrace convert"),
        "{notification}"
    );
    assert_eq!(editor.quit().await, 0);
}
