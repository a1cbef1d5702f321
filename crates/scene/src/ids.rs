//! The indexes of the elements of a scene.

/// An index into [`Scene::params`](crate::Scene::params).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ParamId(pub u32);
/// An index into [`Scene::grids`](crate::Scene::grids).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct GridId(pub u32);
/// An index into [`Scene::objects`](crate::Scene::objects).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ObjectId(u32);

impl ObjectId {
    /// Creates the id of the object at an index.
    pub const fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Returns the index.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}
