//! The window offers a third view and a second language, each registered in one place: their panes show their pictures.

use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use egui::{ColorImage, FullOutput, ImageData, TexturesDelta};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, TestRenderer};
use ide::Languages;
use image::RgbaImage;
use preview::Window;
use protocol::{Command, Hello, ViewName};
use render::Views;
use testing::toy_language::Dots;
use testing::toy_view::BandsView;

const TWO_POINTS: &str = "point p = (0, 0, 1); point q = (1, 0, 0);\n";

/// A window without a display, and the pictures that its panes have shown.
struct Shown {
    harness: Harness<'static, Window>,
    pictures: Pictures,
}

/// The images of the textures that were set as a whole. They take the place of a GPU.
#[derive(Clone, Default)]
struct Pictures(Arc<Mutex<Vec<ColorImage>>>);

impl TestRenderer for Pictures {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let whole = delta.set.values().flatten().filter(|it| it.pos.is_none());
        let images = whole.map(|it| match &it.image {
            ImageData::Color(image) => (**image).clone(),
        });
        self.0.lock().expect("no panic").extend(images);
        delta.clear();
    }

    fn render(&mut self, _: &egui::Context, _: &FullOutput) -> Result<RgbaImage, String> {
        Err("nothing is painted".to_owned())
    }
}

impl Pictures {
    fn any(&self, holds: impl Fn(&ColorImage) -> bool) -> bool {
        self.0.lock().expect("no panic").iter().any(holds)
    }
}

impl Shown {
    fn new(window: Window) -> Self {
        let show = |ui: &mut egui::Ui, window: &mut Window| window.show(ui);
        let pictures = Pictures::default();
        let harness = Harness::builder()
            .with_size([1200.0, 800.0])
            .renderer(pictures.clone())
            .build_ui_state(show, window);
        Self { harness, pictures }
    }

    /// Opens a file that is written into a folder.
    fn of_file(folder: &Path, name: &str, text: &str, languages: &Languages) -> Self {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("written");
        let views = Views::standard().with(BandsView);
        let context = egui::Context::default();
        let window = Window::of_file(&context, languages, views, path, false);
        Self::new(window.expect("the file is there"))
    }

    /// Draws frames until something holds.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        let start = Instant::now();
        while !holds(self) {
            self.harness.step();
            assert!(start.elapsed() < Duration::from_secs(60), "{what}");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn has(&self, label: &str) -> bool {
        let mut found = self.harness.query_all_by_label_contains(label);
        found.next().is_some()
    }

    fn click(&mut self, label: &str) {
        self.harness.get_by_label(label).click();
        self.harness.run_steps(3);
    }

    /// Whether a pane has shown two bands, the darker one above.
    fn has_bands(&self) -> bool {
        self.pictures.any(|image| {
            let [width, height] = image.size;
            let mut shades: Vec<[u8; 4]> = (0..height)
                .map(|row| image.pixels[row * width + width / 2].to_array())
                .collect();
            shades.dedup();
            shades == [[127, 127, 127, 255], [255; 4]]
        })
    }
}

#[test]
fn the_menu_offers_a_third_view_and_its_pane_shows_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let languages = Languages::standard();
    let mut shown = Shown::of_file(folder.path(), "a.gtr", TWO_POINTS, &languages);
    shown.until("the 3D view", |shown| shown.has("3D view of 2 objects"));
    assert!(!shown.has("Bands of"));
    shown.click("View");
    shown.click("Bands");
    shown.until("its pane", |shown| shown.has("Bands of 2 objects"));
    shown.until("its picture", Shown::has_bands);
    // Its setting stands with those of the other views.
    shown.click("Overlays");
    assert!(shown.has("Upside down") && shown.has("Ring at the centre"));
}

#[test]
fn a_message_of_the_server_opens_a_third_view() {
    let (input, mut server) = std::io::pipe().expect("a pipe");
    let (_events, output) = std::io::pipe().expect("a pipe");
    let text = Command::Text {
        uri: "file:///nowhere/a.gtr".to_owned(),
        path: None,
        version: 1,
        text: TWO_POINTS.into(),
    };
    let show = Command::Show {
        view: Some(ViewName::of_scene("bands")),
    };
    for command in [Command::Hello(Hello::own()), text, show] {
        let line = serde_json::to_string(&command).expect("a message");
        writeln!(server, "{line}").expect("read");
    }
    let views = Views::standard().with(BandsView);
    let context = egui::Context::default();
    let languages = Languages::standard();
    let window = Window::attached(&context, languages, views, input, output);
    let mut shown = Shown::new(window.expect("its threads start"));
    shown.until("its pane", |shown| shown.has("Bands of 2 objects"));
    shown.until("its picture", Shown::has_bands);
}

#[test]
fn a_file_of_a_second_language_shows_its_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let by_extension = Languages::standard().with(Dots);
    let by_name = by_extension
        .named("dots")
        .expect("it is registered")
        .clone();
    // The language of a window that was opened with `--language dots`.
    let by_name = Languages::only(by_name);
    let text = "dot 0 0 0\ndot 1 0 0\ndot 0 1 0.5\n";
    for (name, languages) in [("a.dots", by_extension), ("a.txt", by_name)] {
        let mut shown = Shown::of_file(folder.path(), name, text, &languages);
        shown.until(name, |shown| shown.has("3D view of 3 objects"));
        assert!(shown.has("Status: no errors"), "{name}");
        let is_drawn = |image: &ColorImage| {
            let first = image.pixels.first();
            image.size[0] > 100 && image.pixels.iter().any(|pixel| Some(pixel) != first)
        };
        shown.until(name, |shown| shown.pictures.any(is_drawn));
    }
}
