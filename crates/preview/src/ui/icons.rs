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
    Undo,
    Redo,
    Frame,
    Parallel,
    Traced,
    Labels,
    Axes,
    Legend,
    Measure,
    Picture,
    Record,
}

/// The side of an icon, in points.
const SIDE: f32 = 10.0;

/// Shows a button with an icon, a name for assistive tools, and a hint that is shown on hover.
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
    let stroke = Stroke::new(1.5, colour);
    let line = |points: Vec<Pos2>| {
        painter.add(Shape::line(points, stroke));
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
        Icon::Undo => arrow_back(painter, place, stroke, false),
        Icon::Redo => arrow_back(painter, place, stroke, true),
        Icon::Frame => {
            for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                let towards = |from: f32| from + 0.35 * (1.0 - 2.0 * from);
                line([at(towards(x), y), at(x, y), at(x, towards(y))].to_vec());
            }
        }
        Icon::Parallel => {
            // A cube in parallel projection.
            let [a, b, c, d] = [at(0.0, 0.3), at(0.7, 0.3), at(0.7, 1.0), at(0.0, 1.0)];
            line(vec![
                a,
                b,
                c,
                d,
                a,
                at(0.3, 0.0),
                at(1.0, 0.0),
                at(1.0, 0.7),
                c,
            ]);
            line(vec![b, at(1.0, 0.0)]);
        }
        Icon::Traced => {
            // A ray that is reflected by a ball.
            painter.circle_stroke(at(0.62, 0.68), 0.32 * place.width(), stroke);
            line(vec![at(0.0, 0.0), at(0.4, 0.42), at(0.75, 0.0)]);
        }
        Icon::Labels => {
            line(vec![at(0.0, 0.1), at(1.0, 0.1)]);
            line(vec![at(0.5, 0.1), at(0.5, 1.0)]);
        }
        Icon::Axes => {
            line(vec![at(0.35, 0.0), at(0.35, 0.65), at(1.0, 0.65)]);
            line(vec![at(0.35, 0.65), at(0.0, 1.0)]);
        }
        Icon::Legend => {
            for y in [0.15, 0.5, 0.85] {
                painter.circle_filled(at(0.08, y), 1.5, colour);
                line(vec![at(0.35, y), at(1.0, y)]);
            }
        }
        Icon::Measure => {
            line(vec![
                at(0.0, 0.3),
                at(1.0, 0.3),
                at(1.0, 0.8),
                at(0.0, 0.8),
                at(0.0, 0.3),
            ]);
            for x in [0.25, 0.5, 0.75] {
                line(vec![at(x, 0.3), at(x, 0.55)]);
            }
        }
        Icon::Picture => {
            line(vec![
                at(0.0, 0.1),
                at(1.0, 0.1),
                at(1.0, 0.9),
                at(0.0, 0.9),
                at(0.0, 0.1),
            ]);
            line(vec![
                at(0.1, 0.8),
                at(0.4, 0.45),
                at(0.6, 0.7),
                at(0.75, 0.55),
                at(0.9, 0.8),
            ]);
        }
        Icon::Record => {
            painter.circle_filled(place.center(), 0.42 * place.width(), colour);
        }
        Icon::Close => {
            painter.line_segment([at(0.1, 0.1), at(0.9, 0.9)], stroke);
            painter.line_segment([at(0.9, 0.1), at(0.1, 0.9)], stroke);
        }
    }
}

/// Draws an arrow that bends back to the left, or to the right.
fn arrow_back(painter: &Painter, place: Rect, stroke: Stroke, to_right: bool) {
    let at = |x: f32, y: f32| {
        let x = if to_right { 1.0 - x } else { x };
        place.lerp_inside(egui::vec2(x, y))
    };
    let bend = (0..=12).map(|k| {
        let angle = std::f32::consts::PI * (k as f32 / 12.0 - 0.5);
        at(0.6 + 0.35 * angle.cos(), 0.6 + 0.3 * angle.sin())
    });
    let shaft = std::iter::once(at(0.0, 0.3)).chain(bend);
    let points = shaft.chain([at(0.25, 0.9)]).collect();
    painter.add(Shape::line(points, stroke));
    let head = vec![at(0.3, 0.0), at(0.0, 0.3), at(0.3, 0.6)];
    painter.add(Shape::line(head, stroke));
}
