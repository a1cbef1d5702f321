//! The button for a colour. It opens a palette, a field for hexadecimal digits, and sliders.

use egui::ecolor::Hsva;

use crate::ui::number_field;
use egui::{
    Color32, FontId, Grid, Id, Popup, PopupCloseBehavior, Response, Role, Sense, Slider, Stroke,
    StrokeKind, TextEdit, Ui, Vec2, WidgetInfo,
};

/// Colours that are distinguishable with any colour vision (M. Okabe and K. Ito, "Color universal design", 2008), grey
/// and white.
const PALETTE: [(&str, [u8; 3]); 10] = [
    ("Vermilion", [213, 94, 0]),
    ("Orange", [230, 159, 0]),
    ("Yellow", [240, 228, 66]),
    ("Bluish green", [0, 158, 115]),
    ("Sky blue", [86, 180, 233]),
    ("Blue", [0, 114, 178]),
    ("Reddish purple", [204, 121, 167]),
    ("Black", [0, 0, 0]),
    ("Grey", [150, 150, 150]),
    ("White", [255, 255, 255]),
];
/// The number of colours in a row of the palette.
const IN_ROW: usize = 5;

/// Shows the button of a colour (sRGB); the response reports whether it was changed.
pub(crate) fn button(ui: &mut Ui, colour: &mut [u8; 3]) -> Response {
    let before = *colour;
    let mut response = swatch(ui, before, ui.spacing().interact_size);
    Popup::menu(&response)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| picker(ui, colour));
    if *colour != before {
        response.mark_changed();
    }
    response
}

/// Shows a clickable swatch of a colour.
fn swatch(ui: &mut Ui, colour: [u8; 3], size: Vec2) -> Response {
    let (place, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ColorWell, ui.is_enabled(), "Colour");
        info.current_text_value = Some(hex(colour));
        info
    });
    let stroke = match response.hovered() || response.has_focus() {
        true => Stroke::new(2.0, ui.visuals().strong_text_color()),
        false => Stroke::new(1.0, ui.visuals().weak_text_color()),
    };
    let [r, g, b] = colour;
    let painter = ui.painter();
    painter.rect_filled(place, 2.0, Color32::from_rgb(r, g, b));
    painter.rect_stroke(place, 2.0, stroke, StrokeKind::Inside);
    response
}

fn picker(ui: &mut Ui, colour: &mut [u8; 3]) {
    for row in PALETTE.chunks(IN_ROW) {
        ui.horizontal(|ui| {
            for (name, other) in row {
                let plate = swatch(ui, *other, Vec2::splat(26.0));
                if plate.accessible_name(*name).on_hover_text(*name).clicked() {
                    *colour = *other;
                }
            }
        });
    }
    Grid::new("colour").num_columns(2).show(ui, |ui| {
        let label = ui.label("Hex");
        field(ui, label.id, colour);
        ui.end_row();
        sliders(ui, colour);
    });
}

/// Shows the digits of a colour. While they are typed they stay as they are, even if they are not a valid colour yet.
fn field(ui: &mut Ui, label: Id, colour: &mut [u8; 3]) {
    let id = ui.make_persistent_id("hex");
    let typed = ui.data(|data| data.get_temp::<String>(id));
    let typed = typed.filter(|_| ui.memory(|memory| memory.has_focus(id)));
    let mut text = typed.unwrap_or_else(|| hex(*colour));
    let edit = TextEdit::singleline(&mut text).id(id).desired_width(90.0);
    let edit = ui
        .add(edit.font(FontId::monospace(13.0)))
        .labelled_by(label);
    if edit.changed()
        && let Some(other) = from_hex(&text)
    {
        *colour = other;
    }
    ui.data_mut(|data| data.insert_temp(id, text));
}

/// Shows the sliders of hue, saturation and brightness. Grey keeps the hue from which it was made.
fn sliders(ui: &mut Ui, colour: &mut [u8; 3]) {
    let id = ui.make_persistent_id("hsv");
    let known = ui.data(|data| data.get_temp::<[f32; 3]>(id));
    let known = known.filter(|known| rgb(*known) == *colour);
    let mut parts = known.unwrap_or_else(|| {
        let Hsva { h, s, v, .. } = Hsva::from_srgb(*colour);
        [360.0 * h, 100.0 * s, 100.0 * v]
    });
    let mut is_moved = false;
    let rows = [
        ("Hue", 360.0, "°"),
        ("Saturation", 100.0, " %"),
        ("Brightness", 100.0, " %"),
    ];
    for ((name, most, unit), part) in rows.into_iter().zip(&mut parts) {
        let label = ui.label(name);
        let slider = Slider::new(part, 0.0..=most).suffix(unit);
        let slider = number_field::of_slider(ui, slider, |number, _| format!("{number:.0}"));
        let slider = ui.add(slider).labelled_by(label.id);
        is_moved |= slider.changed();
        ui.end_row();
    }
    if is_moved {
        *colour = rgb(parts);
    }
    ui.data_mut(|data| data.insert_temp(id, parts));
}

/// Returns the colour of a hue in degrees, and a saturation and a brightness in percent.
fn rgb([hue, saturation, brightness]: [f32; 3]) -> [u8; 3] {
    Hsva::new(hue / 360.0, saturation / 100.0, brightness / 100.0, 1.0).to_srgb()
}

/// Returns the hexadecimal digits of a colour: `#d55e00`.
fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns the colour with six or three hexadecimal digits, with or without `#`.
fn from_hex(text: &str) -> Option<[u8; 3]> {
    let text = text.trim();
    let digits: Option<Vec<u8>> = text
        .strip_prefix('#')
        .unwrap_or(text)
        .chars()
        .map(|digit| Some(digit.to_digit(16)? as u8))
        .collect();
    match digits?[..] {
        [r, g, b] => Some([r, g, b].map(|digit| 17 * digit)),
        [a, b, c, d, e, f] => Some([16 * a + b, 16 * c + d, 16 * e + f]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{PALETTE, from_hex, hex};

    #[test]
    fn digits_name_a_colour_and_come_back() {
        for (_, colour) in PALETTE {
            assert_eq!(from_hex(&hex(colour)), Some(colour));
        }
        assert_eq!(from_hex(" D55E00 "), Some([213, 94, 0]));
        assert_eq!(from_hex("#f80"), Some([255, 136, 0]));
        for text in ["", "#", "#12", "#12345", "#1234567", "red", "#ggg"] {
            assert_eq!(from_hex(text), None, "{text}");
        }
    }
}
