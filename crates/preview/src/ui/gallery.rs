//! The gallery of examples: a card for each, with its picture, name and description.

use egui::{
    Align2, ColorImage, CursorIcon, FontId, Id, Image, Rect, Role, ScrollArea, Sense, Stroke,
    StrokeKind, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo,
};

use crate::examples::{EXAMPLES, Example};
use crate::ui::window::Next;

/// The size of a card's picture.
const PICTURE: Vec2 = egui::vec2(160.0, 120.0);
/// The height of the words below it.
const WORDS: f32 = 68.0;

/// Shows the gallery in the available height. Returns the step that opens the chosen example.
pub(crate) fn show(ui: &mut Ui, room: f32) -> Option<Next> {
    let mut chosen = None;
    let area = ScrollArea::vertical().id_salt("gallery").max_height(room);
    area.auto_shrink(false).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(10.0, 10.0);
            for example in EXAMPLES {
                if card(ui, example) {
                    chosen = Some(Next::New {
                        name: example.name,
                        text: example.text,
                    });
                }
            }
        });
    });
    chosen
}

/// Shows the card of an example. Returns whether it was chosen.
fn card(ui: &mut Ui, example: &Example) -> bool {
    let (rect, response) = ui.allocate_exact_size(PICTURE + egui::vec2(0.0, WORDS), Sense::click());
    let description = example.description();
    response.widget_info(|| {
        let name = format!("Example {}: {description}", example.name);
        WidgetInfo::labeled(Role::Button, true, name)
    });
    if ui.is_rect_visible(rect) {
        let visuals = ui.style().interact(&response);
        ui.painter()
            .rect_filled(rect, 4.0, ui.visuals().extreme_bg_color);
        let place = Rect::from_min_size(rect.min, PICTURE);
        if let Some(texture) = picture(ui, example) {
            Image::new(&texture).corner_radius(4.0).paint_at(ui, place);
        }
        let below = Rect::from_min_max(place.left_bottom(), rect.max).shrink(4.0);
        let strong = ui.visuals().strong_text_color();
        let painter = ui.painter_at(below);
        let font = FontId::proportional(13.0);
        let title = painter.text(below.min, Align2::LEFT_TOP, example.name, font, strong);
        let mut words = egui::text::LayoutJob::simple(
            description.clone(),
            FontId::proportional(11.0),
            ui.visuals().text_color(),
            below.width(),
        );
        words.wrap.max_rows = 3;
        let words = ui.fonts_mut(|fonts| fonts.layout_job(words));
        painter.galley(title.left_bottom(), words, strong);
        if response.hovered() || response.has_focus() {
            let stroke = Stroke::new(2.0, visuals.fg_stroke.color);
            ui.painter()
                .rect_stroke(rect, 4.0, stroke, StrokeKind::Inside);
        }
    }
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    response.on_hover_text(description).clicked()
}

/// Returns the picture of an example, cached in this context.
fn picture(ui: &Ui, example: &Example) -> Option<TextureHandle> {
    let id = Id::unique(("picture of example", example.name));
    if let Some(known) = ui.data(|data| data.get_temp::<TextureHandle>(id)) {
        return Some(known);
    }
    let image = image::load_from_memory(example.picture).ok()?.to_rgba8();
    let size = [image.width() as usize, image.height() as usize];
    let image = ColorImage::from_rgba_unmultiplied(size, image.as_raw());
    let texture = ui
        .ctx()
        .load_texture(example.name, image, TextureOptions::LINEAR);
    ui.data_mut(|data| data.insert_temp(id, texture.clone()));
    Some(texture)
}
