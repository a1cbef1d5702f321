//! A toy third view: all that a view needs to be offered by the command line, the window and the protocol.
//!
//! It shows the objects as a column of bands, the first one at the top, each in a shade of its own.
//! `Views::standard().with(BandsView)` registers it.

use image::{Rgba, RgbaImage};
use render::gpu::Pixels;
use render::request::{ViewOptions, ViewPart};
use render::view::{Setting, SharedState, View, ViewRenderer};
use render::{PictureRequest, RenderError, RenderedImage};
use scene::{Object, ObjectId, Scene};

/// The view's name.
const NAME: &str = "bands";

/// The view.
#[derive(Debug)]
pub struct BandsView;

/// What the view adds to a request.
#[derive(Clone, Debug, Default, PartialEq)]
struct BandsOptions {
    /// The last object is at the top.
    upside_down: bool,
}

impl ViewOptions for BandsOptions {
    fn view(&self) -> &'static str {
        NAME
    }

    fn set(&mut self, setting: &str, on: bool) -> bool {
        let is_known = setting == "upside-down";
        if is_known {
            self.upside_down = on;
        }
        is_known
    }

    fn is_on(&self, setting: &str) -> Option<bool> {
        (setting == "upside-down").then_some(self.upside_down)
    }
}

impl View for BandsView {
    fn name(&self) -> &'static str {
        NAME
    }

    fn title(&self) -> &'static str {
        "Bands"
    }

    fn purpose(&self) -> &'static str {
        "the objects as bands, one below the other"
    }

    fn shows(&self, _scene: &Scene, _object: &Object) -> bool {
        true
    }

    fn options(&self, _object: Option<ObjectId>) -> ViewPart {
        ViewPart::from(BandsOptions::default())
    }

    fn settings(&self) -> &'static [Setting] {
        &[Setting {
            name: "upside-down",
            title: "Upside down",
            default: false,
        }]
    }

    fn renderer(&self) -> Box<dyn ViewRenderer> {
        Box::new(BandsRenderer)
    }
}

#[derive(Debug)]
struct BandsRenderer;

impl ViewRenderer for BandsRenderer {
    fn draw(
        &mut self,
        _shared: &mut SharedState,
        request: &PictureRequest,
        _progress: &(dyn Fn(f32) + Sync),
    ) -> Result<RenderedImage, RenderError> {
        let [width, height] = request.size;
        let count = request.scene.objects.len().max(1) as u32;
        let is_turned = request
            .view
            .get::<BandsOptions>()
            .is_some_and(|options| options.upside_down);
        let image = RgbaImage::from_fn(width, height, |_, row| {
            let band = (u64::from(row) * u64::from(count) / u64::from(height)) as u32;
            let band = if is_turned { count - 1 - band } else { band };
            let shade = (255 * (band + 1) / count) as u8;
            Rgba([shade, shade, shade, 255])
        });
        Ok(RenderedImage::new(Pixels::Image(image)))
    }
}
