//! The icons of buttons. They are drawn: the fonts of the window have no such characters.

use egui::{Button, Color32, Painter, Pos2, Rect, Response, Shape, Stroke, Ui, Vec2};

/// An icon.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Icon {
    Play,
    Pause,
    Up,
    Down,
    Close,
}

/// The side of an icon, in points.
const SIDE: f32 = 10.0;

/// Shows a button with an icon; its name is that for assistive tools, and its hint is shown where the pointer rests.
pub(crate) fn button(
    ui: &mut Ui,
    icon: Icon,
    is_selected: bool,
    name: impl Into<String>,
    hint: &str,
) -> Response {
    let size = Vec2::splat(ui.spacing().interact_size.y);
    let button = ui.add(Button::selectable(is_selected, "").min_size(size));
    let colour = match is_selected {
        true => ui.visuals().selection.stroke.color,
        false => ui.style().interact(&button).text_color(),
    };
    let place = Rect::from_center_size(button.rect.center(), Vec2::splat(SIDE));
    draw(ui.painter(), icon, place, colour);
    button.accessible_name(name).on_hover_text(hint)
}

fn draw(painter: &Painter, icon: Icon, place: Rect, colour: Color32) {
    let at = |x: f32, y: f32| place.lerp_inside(egui::vec2(x, y));
    let triangle = |corners: [Pos2; 3]| {
        painter.add(Shape::convex_polygon(corners.into(), colour, Stroke::NONE));
    };
    match icon {
        Icon::Play => triangle([at(0.15, 0.0), at(1.0, 0.5), at(0.15, 1.0)]),
        Icon::Up => triangle([at(0.0, 0.8), at(0.5, 0.1), at(1.0, 0.8)]),
        Icon::Down => triangle([at(0.0, 0.2), at(1.0, 0.2), at(0.5, 0.9)]),
        Icon::Pause => {
            for x in [0.1, 0.6] {
                let bar = Rect::from_min_max(at(x, 0.0), at(x + 0.3, 1.0));
                painter.rect_filled(bar, 0.0, colour);
            }
        }
        Icon::Close => {
            let stroke = Stroke::new(1.5, colour);
            painter.line_segment([at(0.1, 0.1), at(0.9, 0.9)], stroke);
            painter.line_segment([at(0.9, 0.1), at(0.1, 0.9)], stroke);
        }
    }
}
