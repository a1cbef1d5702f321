//! The panes: docked side by side or in tabs, and moved by dragging their titles.

mod handles;
pub(crate) mod picture;
pub(crate) mod program;
pub(crate) mod settings;
mod tiles;

use egui::{Response, Ui, WidgetText};
use egui_tiles::{
    Behavior, Container, EditAction, Linear, LinearDir, SimplificationOptions, TabState, Tile,
    TileId, Tiles, Tree, UiResponse,
};
use render::ViewId;
use session::layout::{Arrangement, Layout};
use session::pane::Pane;

use crate::ui::window::Window;
use settings::{DefineValues, SettingsTab};

/// The width of text and settings relative to that of a picture.
const SIDE: f32 = 0.8;
/// The maximum number of views of objects that are opened without a request.
const OPENED: usize = 8;

/// The open panes, and their layout.
#[derive(Debug)]
pub(crate) struct Panes {
    tree: Tree<Pane>,
    /// True if the user has arranged them.
    pub(crate) arranged: bool,
    /// The first view, which is open unless the user closes it, or it would show nothing.
    first: Pane,
    /// True if no program has been opened yet: the welcome is shown instead of the panes.
    pub(crate) is_welcome: bool,
    /// True if the program and the settings are hidden.
    pub(crate) shows_views_alone: bool,
    /// The open tab of the settings.
    pub(crate) settings_tab: SettingsTab,
    /// The values of defines that were last shown, with their text's version and params.
    pub(crate) defines: Option<DefineValues>,
    /// True if the first view was left out because it would show nothing.
    without_first: bool,
}

impl Panes {
    /// Returns the initial layout.
    pub(crate) fn new(first: ViewId, with_program: bool) -> Self {
        let first = Pane::View(first);
        let mut tiles = Tiles::default();
        let view = tiles.insert_pane(first.clone());
        let settings = tiles.insert_pane(Pane::Settings);
        let views = tabs(&mut tiles, view);
        let settings = tabs(&mut tiles, settings);
        let side = if with_program {
            let program = tiles.insert_pane(Pane::Program);
            let program = tabs(&mut tiles, program);
            let column = Linear::new(LinearDir::Vertical, vec![program, settings]);
            tiles.insert_container(Container::Linear(column))
        } else {
            settings
        };
        let mut row = Linear::new(LinearDir::Horizontal, vec![side, views]);
        row.shares.set_share(side, SIDE);
        row.shares.set_share(views, 1.0);
        let root = tiles.insert_container(Container::Linear(row));
        Self {
            tree: Tree::new(egui::Id::unique("panes"), root, tiles),
            arranged: false,
            first,
            is_welcome: false,
            shows_views_alone: false,
            settings_tab: SettingsTab::default(),
            defines: None,
            without_first: false,
        }
    }

    /// Returns the layout, if the user has arranged it.
    pub(crate) fn layout(&self) -> Option<Layout> {
        let arranged = self.arranged.then(|| tiles::layout_of(&self.tree));
        arranged.flatten()
    }

    /// Restores a layout. Returns whether it has any panes.
    pub(crate) fn arrange(&mut self, layout: &Layout) -> bool {
        let Some(tree) = tiles::tree(layout, egui::Id::unique("panes")) else {
            return false;
        };
        self.tree = tree;
        self.arranged = true;
        true
    }

    /// Arranges the open panes anew: text and settings on the left, the views beside them.
    pub(crate) fn set_out(&mut self, arrangement: Arrangement) {
        let panes = self.tree.tiles.tiles().filter_map(|tile| match tile {
            Tile::Pane(pane) => Some(pane.clone()),
            Tile::Container(_) => None,
        });
        let (mut views, mut written): (Vec<Pane>, Vec<Pane>) =
            panes.partition(|pane| pane.view().is_some());
        views.sort_by_key(|pane| (pane.is_of_object(), pane.view().cloned()));
        written.sort_by_key(|pane| *pane == Pane::Settings);
        let layout = Layout::set_out(&written, &views, arrangement, SIDE);
        if let Some(tree) = tiles::tree(&layout, self.tree.id()) {
            self.tree = tree;
            self.arranged = arrangement != Arrangement::First;
        }
    }

    /// Multiplies a pane's share of the room by a factor.
    pub(crate) fn resize(&mut self, pane: &Pane, factor: f32) {
        let mut tile = self.tree.tiles.find_pane(pane);
        while let Some(child) = tile {
            tile = self.tree.tiles.parent_of(child);
            let Some(parent) = tile else {
                return;
            };
            if let Some(Tile::Container(Container::Linear(line))) = self.tree.tiles.get_mut(parent)
                && line.children.len() > 1
            {
                let share = (line.shares[child] * factor).clamp(0.1, 10.0);
                line.shares.set_share(child, share);
                self.arranged = true;
                return;
            }
        }
    }

    /// Leaves the first view out of the initial layout, until it shows something.
    pub(crate) fn leave_out_first(&mut self) {
        if !self.arranged && self.is_open(&self.first) {
            self.close(&self.first.clone());
            self.without_first = true;
        }
    }

    /// Opens the first view if it was left out.
    pub(crate) fn bring_back_first(&mut self) {
        if std::mem::take(&mut self.without_first) && !self.arranged {
            self.open(&self.first.clone());
        }
    }

    /// Returns whether the first view is open.
    pub(crate) fn has_first(&self) -> bool {
        self.is_open(&self.first)
    }

    /// Returns whether a pane is open.
    pub(crate) fn is_open(&self, pane: &Pane) -> bool {
        self.tree.tiles.find_pane(pane).is_some()
    }

    /// Returns the visible views: open, and not behind another tab.
    pub(crate) fn in_front(&self) -> Vec<ViewId> {
        let tiles = self.tree.active_tiles().into_iter();
        let panes = tiles.filter_map(|tile| self.tree.tiles.get_pane(&tile));
        panes.filter_map(Pane::view).cloned().collect()
    }

    /// Returns the rectangle of a view on the screen; if the view is not visible, that of the first visible one, in the
    /// order of the layout.
    pub(crate) fn place_of(&self, view: &ViewId) -> Option<egui::Rect> {
        let tiles = &self.tree.tiles;
        let view_of = |tile: &TileId| tiles.get_pane(tile).and_then(Pane::view);
        let active = self.tree.active_tiles().into_iter();
        let seen = active.filter_map(|tile| Some((view_of(&tile)?, tiles.rect(tile)?)));
        let first = seen.min_by(|(a, a_place), (b, b_place)| {
            // The view itself precedes all others.
            let order = (*b == view).cmp(&(*a == view));
            order
                .then(a_place.left().total_cmp(&b_place.left()))
                .then(a_place.top().total_cmp(&b_place.top()))
        });
        first.map(|(_, place)| place)
    }

    /// Brings a pane to the front.
    pub(crate) fn bring_forward(&mut self, pane: &Pane) {
        self.shows_views_alone &= pane.view().is_some();
        self.open(pane);
        let Some(wanted) = self.tree.tiles.find_pane(pane) else {
            return;
        };
        self.tree.make_active(|tile, _| tile == wanted);
    }

    /// Opens a pane, beside the most similar ones.
    pub(crate) fn open(&mut self, pane: &Pane) {
        if self.is_open(pane) {
            return;
        }
        let alike = self.tree.tiles.iter().find_map(|(tile, it)| match it {
            Tile::Pane(it) if it.is_of_object() && pane.is_of_object() => Some(*tile),
            _ => None,
        });
        let new = self.tree.tiles.insert_pane(pane.clone());
        let group = alike.and_then(|tile| self.tree.tiles.parent_of(tile));
        if let Some(group) = group
            && let Some(Tile::Container(Container::Tabs(tabs))) = self.tree.tiles.get_mut(group)
        {
            tabs.add_child(new);
            return;
        }
        let new = tabs(&mut self.tree.tiles, new);
        // After the first view, if that is in a row; otherwise at the end of the root.
        let first = self.tree.tiles.find_pane(&self.first);
        let group = first.and_then(|tile| self.tree.tiles.parent_of(tile));
        let row = group.and_then(|tile| self.tree.tiles.parent_of(tile));
        if let (Some(group), Some(row)) = (group, row)
            && let Some(Tile::Container(Container::Linear(row))) = self.tree.tiles.get_mut(row)
        {
            let at = row.children.iter().position(|child| *child == group);
            let at = match pane {
                Pane::Program => 0,
                Pane::Settings => row.children.len(),
                _ => at.map_or(row.children.len(), |at| at + 1),
            };
            row.children.insert(at, new);
            row.shares
                .set_share(new, if *pane == Pane::Settings { SIDE } else { 1.0 });
            return;
        }
        let root = match self.tree.root() {
            Some(root) => {
                let row = Linear::new(LinearDir::Horizontal, vec![root, new]);
                self.tree.tiles.insert_container(Container::Linear(row))
            }
            None => new,
        };
        self.tree.root = Some(root);
    }

    /// Closes a pane.
    pub(crate) fn close(&mut self, pane: &Pane) {
        if let Some(tile) = self.tree.tiles.find_pane(pane) {
            self.tree.remove_recursively(tile);
        }
    }

    /// Opens the wanted views of new objects, and closes views that the scene does not have; a text with errors may
    /// lack them only temporarily.
    pub(crate) fn follow(&mut self, views: &[ViewId], wanted: &[ViewId], ok: bool) {
        let gone: Vec<Pane> = self
            .tree
            .tiles
            .tiles()
            .filter_map(|tile| match tile {
                Tile::Pane(pane @ Pane::View(id)) if ok && !views.contains(id) => {
                    Some(pane.clone())
                }
                _ => None,
            })
            .collect();
        for pane in gone {
            self.close(&pane);
        }
        for id in wanted.iter().take(OPENED) {
            self.open(&Pane::View(id.clone()));
        }
    }
}

fn tabs(tiles: &mut Tiles<Pane>, pane: TileId) -> TileId {
    tiles.insert_tab_tile(vec![pane])
}

/// Draws the panes, or the welcome.
pub(crate) fn show(window: &mut Window, ui: &mut Ui) {
    if window.panes.is_welcome {
        crate::ui::welcome::show(window, ui);
        return;
    }
    let empty = Tree::empty(egui::Id::unique("no panes"));
    let mut tree = std::mem::replace(&mut window.panes.tree, empty);
    for pane in [Pane::Program, Pane::Settings] {
        if let Some(tile) = tree.tiles.find_pane(&pane) {
            tree.set_visible(tile, !window.panes.shows_views_alone);
        }
    }
    // No background behind pictures that cover it: a driver without a GPU would paint each of its pixels.
    let frame = egui::Frame::NONE;
    let mut closed = Vec::new();
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        let mut drawer = Drawer {
            window,
            closed: &mut closed,
            tabs: Vec::new(),
        };
        tree.ui(&mut drawer, ui);
        let tabs = drawer.tabs;
        handles::pass_on(ui, &tabs);
    });
    // Panes that were opened during drawing were added to the empty tree that replaced this one.
    let opened = std::mem::replace(&mut window.panes.tree, tree);
    for tile in opened.tiles.tiles() {
        if let Tile::Pane(pane) = tile {
            window.bring_forward(pane);
        }
    }
    for pane in closed {
        window.note_closed(&pane);
    }
}

/// Draws a pane of text or controls, on its background.
fn written(window: &mut Window, ui: &mut Ui, show: impl FnOnce(&mut Window, &mut Ui)) {
    ui.painter()
        .rect_filled(ui.max_rect(), 0.0, window.display.background(ui));
    show(window, ui);
}

struct Drawer<'a> {
    window: &'a mut Window,
    closed: &'a mut Vec<Pane>,
    tabs: Vec<Response>,
}

impl Behavior<Pane> for Drawer<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _tile: TileId, pane: &mut Pane) -> UiResponse {
        match pane {
            Pane::View(id) => picture::show(self.window, ui, id),
            Pane::Settings => written(self.window, ui, settings::show),
            Pane::Program => written(self.window, ui, program::show),
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> WidgetText {
        match pane {
            Pane::View(id) => self.window.views.title(id, " – ").into(),
            Pane::Settings => "Settings".into(),
            Pane::Program => "Program".into(),
        }
    }

    fn is_tab_closable(&self, _tiles: &Tiles<Pane>, _tile: TileId) -> bool {
        true
    }

    fn on_edit(&mut self, action: EditAction) {
        // A tab may come to the front by itself.
        if matches!(action, EditAction::TileDropped | EditAction::TileResized) {
            self.window.panes.arranged = true;
        }
    }

    fn close_button_outer_size(&self) -> f32 {
        16.0
    }

    fn on_tab_button(
        &mut self,
        tiles: &mut Tiles<Pane>,
        tile: TileId,
        button: Response,
    ) -> Response {
        if button.clicked() {
            self.window.panes.arranged = true;
            if let Some(id) = tiles.get_pane(&tile).and_then(Pane::view) {
                self.window.activate(id);
            }
        }
        self.tabs.push(button.clone());
        button
    }

    fn on_tab_close(&mut self, tiles: &mut Tiles<Pane>, tile: TileId) -> bool {
        if let Some(Tile::Pane(pane)) = tiles.get(tile) {
            self.closed.push(pane.clone());
            self.window.panes.arranged = true;
        }
        true
    }

    fn tab_text_color(
        &self,
        visuals: &egui::Visuals,
        _tiles: &Tiles<Pane>,
        _tile: TileId,
        state: &TabState,
    ) -> egui::Color32 {
        if state.active {
            visuals.strong_text_color()
        } else {
            visuals.text_color()
        }
    }

    fn gap_width(&self, _style: &egui::Style) -> f32 {
        4.0
    }

    fn min_size(&self) -> f32 {
        80.0
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            all_panes_must_have_tabs: true,
            ..SimplificationOptions::default()
        }
    }
}
