//! Layouts as trees of tiles, and back.
//!
//! A tree of tiles is converted to a [`Layout`] and back. Files are not trusted: no pane occurs twice, empty parts are
//! left out, and shares are finite numbers.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use session::layout::{Layout, Share};
use session::pane::Pane;

/// Returns the layout of a tree; `None` for an empty one.
pub(super) fn layout_of(tree: &Tree<Pane>) -> Option<Layout> {
    of_tile(&tree.tiles, tree.root()?)
}

/// Returns a tree of the panes of a layout; `None` if it has none.
pub(super) fn tree(layout: &Layout, id: egui::Id) -> Option<Tree<Pane>> {
    let mut tiles = Tiles::default();
    let mut known = Vec::new();
    let root = insert(layout, &mut tiles, &mut known)?;
    Some(Tree::new(id, root, tiles))
}

fn insert(layout: &Layout, tiles: &mut Tiles<Pane>, known: &mut Vec<Pane>) -> Option<TileId> {
    match layout {
        Layout::Pane(pane) => {
            if known.contains(pane) {
                return None;
            }
            known.push(pane.clone());
            Some(tiles.insert_pane(pane.clone()))
        }
        Layout::Tabs { children, active } => {
            let mut front = None;
            let mut tabs = Vec::new();
            for (at, child) in children.iter().enumerate() {
                let child = insert(child, tiles, known);
                tabs.extend(child);
                if at == *active {
                    front = child;
                }
            }
            if tabs.is_empty() {
                return None;
            }
            let mut tabs = Tabs::new(tabs);
            if front.is_some() {
                tabs.active = front;
            }
            Some(tiles.insert_container(Container::Tabs(tabs)))
        }
        Layout::Row(parts) => linear(LinearDir::Horizontal, parts, tiles, known),
        Layout::Column(parts) => linear(LinearDir::Vertical, parts, tiles, known),
    }
}

fn linear(
    direction: LinearDir,
    parts: &[Share],
    tiles: &mut Tiles<Pane>,
    known: &mut Vec<Pane>,
) -> Option<TileId> {
    let mut line = Linear::new(direction, Vec::new());
    for Share { share, content } in parts {
        if let Some(child) = insert(content, tiles, known) {
            line.add_child(child);
            let share = if share.is_finite() { *share } else { 1.0 };
            line.shares.set_share(child, share.clamp(1e-3, 1e3));
        }
    }
    (!line.children.is_empty()).then(|| tiles.insert_container(Container::Linear(line)))
}

fn of_tile(tiles: &Tiles<Pane>, tile: TileId) -> Option<Layout> {
    let each = |children: &[TileId]| -> Vec<(TileId, Layout)> {
        let children = children.iter();
        children
            .filter_map(|child| Some((*child, of_tile(tiles, *child)?)))
            .collect()
    };
    Some(match tiles.get(tile)? {
        Tile::Pane(pane) => Layout::Pane(pane.clone()),
        Tile::Container(Container::Tabs(tabs)) => {
            let children = each(&tabs.children);
            let front = |(child, _): &(TileId, Layout)| Some(*child) == tabs.active;
            Layout::Tabs {
                active: children.iter().position(front).unwrap_or(0),
                children: children.into_iter().map(|(_, child)| child).collect(),
            }
        }
        Tile::Container(Container::Linear(line)) => {
            let share = |(child, content): (TileId, Layout)| Share {
                share: line.shares[child],
                content,
            };
            let parts = each(&line.children).into_iter().map(share).collect();
            match line.dir {
                LinearDir::Horizontal => Layout::Row(parts),
                LinearDir::Vertical => Layout::Column(parts),
            }
        }
        // Grids are never created here; the panes of one are put side by side.
        Tile::Container(Container::Grid(grid)) => {
            let children: Vec<TileId> = grid.children().copied().collect();
            let share = |(_, content)| Share {
                share: 1.0,
                content,
            };
            Layout::Row(each(&children).into_iter().map(share).collect())
        }
    })
}

#[cfg(test)]
mod tests {
    use session::layout::{Layout, Share};
    use session::pane::Pane;

    fn view(name: &str) -> Layout {
        Layout::Pane(Pane::View(name.into()))
    }

    fn part(share: f32, content: Layout) -> Share {
        Share { share, content }
    }

    fn again(layout: &Layout) -> Option<Layout> {
        let tree = super::tree(layout, egui::Id::unique("test"))?;
        super::layout_of(&tree)
    }

    #[test]
    fn a_layout_comes_back_as_it_was() {
        let layout = Layout::Row(vec![
            part(0.25, Layout::Pane(Pane::Settings)),
            part(
                2.0,
                Layout::Column(vec![
                    part(1.0, view("3d")),
                    part(
                        0.5,
                        Layout::Tabs {
                            children: vec![view("geodesic:a"), view("geodesic:b")],
                            active: 1,
                        },
                    ),
                ]),
            ),
        ]);
        assert_eq!(again(&layout), Some(layout.clone()));
        let text = serde_json::to_string(&layout).expect("data");
        assert_eq!(serde_json::from_str::<Layout>(&text).expect("data"), layout);
    }

    #[test]
    fn what_makes_no_sense_is_left_out() {
        let layout = Layout::Row(vec![
            part(f32::NAN, view("3d")),
            part(-3.0, Layout::Pane(Pane::Settings)),
            part(1.0, view("3d")),
            part(
                1.0,
                Layout::Tabs {
                    children: vec![Layout::Row(vec![])],
                    active: 7,
                },
            ),
        ]);
        let left = Layout::Row(vec![
            part(1.0, view("3d")),
            part(1e-3, Layout::Pane(Pane::Settings)),
        ]);
        assert_eq!(again(&layout), Some(left));
        assert_eq!(again(&Layout::Row(vec![])), None);
    }
}
