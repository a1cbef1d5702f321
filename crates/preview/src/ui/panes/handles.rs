//! The lines between panes and the backgrounds of their tab bars can only be dragged. They have no keyboard function
//! and no name, so Tab skips them.

use egui::{Response, Ui};

use crate::ui::event_splitter::EventSplitter;

/// Passes the focus on if it has reached a drag handle; `tabs` are those that were drawn.
pub(super) fn pass_on(ui: &Ui, tabs: &[Response]) {
    let context = ui.ctx();
    let focused = context.memory(|memory| memory.focused());
    let Some(focused) = focused.and_then(|id| context.read_response(id)) else {
        return;
    };
    // A line's grip extends to both sides.
    let breadth = 2.0 * ui.style().interaction.resize_grab_radius_side + 0.5;
    let is_line = focused.rect.size().min_elem() <= breadth;
    let behind = |tab: &Response| tab.id != focused.id && focused.rect.contains_rect(tab.rect);
    if focused.sense.senses_drag() && (is_line || tabs.iter().any(behind)) {
        EventSplitter::press_tab(context);
    }
}
