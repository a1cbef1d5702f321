//! The lines between panes, and the grounds behind their tabs, are there to be dragged. The keyboard does nothing with
//! them and they have no name, so Tab goes on to what comes next.

use egui::{Response, Ui};

use crate::ui::event_splitter::EventSplitter;

/// Passes the focus on, where it has come to something that is there to be dragged; `tabs` are those that were drawn.
pub(super) fn pass_on(ui: &Ui, tabs: &[Response]) {
    let context = ui.ctx();
    let focused = context.memory(|memory| memory.focused());
    let Some(focused) = focused.and_then(|id| context.read_response(id)) else {
        return;
    };
    // A line is as broad as its grip on both sides.
    let breadth = 2.0 * ui.style().interaction.resize_grab_radius_side + 0.5;
    let is_line = focused.rect.size().min_elem() <= breadth;
    let behind = |tab: &Response| tab.id != focused.id && focused.rect.contains_rect(tab.rect);
    if focused.sense.senses_drag() && (is_line || tabs.iter().any(behind)) {
        EventSplitter::press_tab(context);
    }
}
