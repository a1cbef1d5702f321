//! The panes' places as data: what is remembered between runs.
//!
//! A tree of tiles becomes a [`Layout`] and comes back from one. What a file says is not trusted: no pane comes twice,
//! what is empty is left out, and shares are numbers.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use super::{Arrangement, Pane};

/// Panes and how they are arranged.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) enum Layout {
    /// A pane.
    Pane(Pane),
    /// One behind the other.
    Tabs {
        /// From left to right.
        children: Vec<Self>,
        /// Which one is in front, counted from 0.
        active: usize,
    },
    /// Side by side.
    Row(Vec<Share>),
    /// One above the other.
    Column(Vec<Share>),
}

/// A part of a row or a column.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Share {
    /// How much room it has, compared with its neighbours.
    share: f32,
    content: Layout,
}

impl Layout {
    /// What is written, one above the other and `side` wide, and beside it the views, which have the room 1 together.
    pub(super) fn set_out(
        written: &[Pane],
        views: &[Pane],
        arrangement: Arrangement,
        side: f32,
    ) -> Self {
        let even = |layouts: Vec<Self>| -> Vec<Share> {
            let share = |content| Share {
                share: 1.0,
                content,
            };
            layouts.into_iter().map(share).collect()
        };
        let alone = |pane: &Pane| Self::Pane(pane.clone());
        let tabs = |panes: &[Pane]| Self::Tabs {
            children: panes.iter().map(alone).collect(),
            active: 0,
        };
        let each: Vec<Self> = views.iter().map(alone).collect();
        let shown = match arrangement {
            Arrangement::Row => Self::Row(even(each)),
            Arrangement::Column => Self::Column(even(each)),
            Arrangement::Tabs => tabs(views),
            Arrangement::First => {
                let (space, inside): (Vec<Pane>, Vec<Pane>) =
                    views.iter().cloned().partition(|pane| *pane == Pane::Space);
                Self::Row(even(vec![tabs(&space), tabs(&inside)]))
            }
        };
        let width = match arrangement {
            Arrangement::Row => views.len() as f32,
            Arrangement::First => 2.0,
            Arrangement::Column | Arrangement::Tabs => 1.0,
        };
        Self::Row(vec![
            Share {
                share: side,
                content: Self::Column(even(written.iter().map(alone).collect())),
            },
            Share {
                share: width,
                content: shown,
            },
        ])
    }

    /// Of a tree; nothing of an empty one.
    pub(crate) fn of(tree: &Tree<Pane>) -> Option<Self> {
        of_tile(&tree.tiles, tree.root()?)
    }

    /// A tree of these panes; nothing if there is none.
    pub(crate) fn tree(&self, id: egui::Id) -> Option<Tree<Pane>> {
        let mut tiles = Tiles::default();
        let mut known = Vec::new();
        let root = self.insert(&mut tiles, &mut known)?;
        Some(Tree::new(id, root, tiles))
    }

    fn insert(&self, tiles: &mut Tiles<Pane>, known: &mut Vec<Pane>) -> Option<TileId> {
        match self {
            Self::Pane(pane) => {
                if known.contains(pane) {
                    return None;
                }
                known.push(pane.clone());
                Some(tiles.insert_pane(pane.clone()))
            }
            Self::Tabs { children, active } => {
                let mut front = None;
                let mut tabs = Vec::new();
                for (at, child) in children.iter().enumerate() {
                    let child = child.insert(tiles, known);
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
            Self::Row(parts) => linear(LinearDir::Horizontal, parts, tiles, known),
            Self::Column(parts) => linear(LinearDir::Vertical, parts, tiles, known),
        }
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
        if let Some(child) = content.insert(tiles, known) {
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
        // Nothing here makes one; its panes stand side by side then.
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
    use super::{Layout, Share};
    use crate::panes::Pane;

    fn inside(name: &str) -> Layout {
        Layout::Pane(Pane::Inside(name.to_owned()))
    }

    fn part(share: f32, content: Layout) -> Share {
        Share { share, content }
    }

    fn again(layout: &Layout) -> Option<Layout> {
        let tree = layout.tree(egui::Id::unique("test"))?;
        Layout::of(&tree)
    }

    #[test]
    fn a_layout_comes_back_as_it_was() {
        let layout = Layout::Row(vec![
            part(0.25, Layout::Pane(Pane::Settings)),
            part(
                2.0,
                Layout::Column(vec![
                    part(1.0, Layout::Pane(Pane::Space)),
                    part(
                        0.5,
                        Layout::Tabs {
                            children: vec![inside("a"), inside("b")],
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
            part(f32::NAN, Layout::Pane(Pane::Space)),
            part(-3.0, Layout::Pane(Pane::Settings)),
            part(1.0, Layout::Pane(Pane::Space)),
            part(
                1.0,
                Layout::Tabs {
                    children: vec![Layout::Row(vec![])],
                    active: 7,
                },
            ),
        ]);
        let left = Layout::Row(vec![
            part(1.0, Layout::Pane(Pane::Space)),
            part(1e-3, Layout::Pane(Pane::Settings)),
        ]);
        assert_eq!(again(&layout), Some(left));
        assert_eq!(again(&Layout::Row(vec![])), None);
    }
}
