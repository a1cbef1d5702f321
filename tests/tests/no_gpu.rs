//! A machine without any GPU driver: pointing the Vulkan loader at nothing makes one.

use testing::binary::{Geotrace, geotrace};
use testing::examples;

fn without_driver(arguments: &[&str]) -> Geotrace {
    geotrace(arguments)
        .environment("VK_DRIVER_FILES", "/nonexistent/driver.json")
        .environment("VK_ICD_FILENAMES", "/nonexistent/driver.json")
}

#[test]
fn both_views_are_drawn_in_software_and_that_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    for view in ["3d", "geodesic"] {
        let picture = folder.path().join(format!("{view}.png"));
        let run = without_driver(&["render", "--size", "40x30", "--view", view, "-o"])
            .argument(&picture)
            .argument(examples::one("sphere").path)
            .run();
        run.expect_status(0).expect_text("software");
        let image = image::open(&picture).expect("a picture").to_rgba8();
        assert_eq!(image.dimensions(), (40, 30));
    }
}

#[test]
fn asking_for_a_gpu_is_an_error_that_names_the_way_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = without_driver(&["render", "--backend", "gpu", "-o", "out.png"])
        .argument(examples::one("sphere").path)
        .folder(folder.path())
        .run();
    run.expect_status(2).expect_text("auto");
    assert!(!folder.path().join("out.png").exists());
}

#[test]
fn what_needs_no_gpu_never_asks_for_one() {
    let torus = examples::one("torus").path;
    for command in ["check", "explain"] {
        without_driver(&[command])
            .argument(&torus)
            .run()
            .expect_status(0);
    }
}
