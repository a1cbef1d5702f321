//! The arrangement of the panes as data: it is saved between runs.

use serde::{Deserialize, Serialize};

use super::pane::Pane;

/// An arrangement of the views.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Arrangement {
    /// The initial arrangement of a program.
    First,
    /// All in a row.
    Row,
    /// All in a column.
    Column,
    /// One behind the other, as tabs.
    Tabs,
}

impl Arrangement {
    /// All arrangements, with their titles.
    pub const ALL: [(&'static str, Self); 4] = [
        ("As at first", Self::First),
        ("Views side by side", Self::Row),
        ("Views one above the other", Self::Column),
        ("Views as tabs", Self::Tabs),
    ];
}

/// Panes and their arrangement.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub enum Layout {
    /// A pane.
    Pane(Pane),
    /// One behind the other.
    Tabs {
        /// From left to right.
        children: Vec<Self>,
        /// The index of the tab in front.
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
pub struct Share {
    /// Its size relative to those of its neighbours.
    pub share: f32,
    /// The panes in it.
    pub content: Layout,
}

impl Layout {
    /// Lays out text and settings one above the other, with the width `side`, and beside them the views, each with the
    /// width 1.
    pub fn set_out(written: &[Pane], views: &[Pane], arrangement: Arrangement, side: f32) -> Self {
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
                let views = views.iter().cloned();
                let (objects, scene): (Vec<Pane>, _) = views.partition(Pane::is_of_object);
                Self::Row(even(vec![tabs(&scene), tabs(&objects)]))
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
}
