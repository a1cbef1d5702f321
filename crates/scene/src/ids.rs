//! The numbers of what a scene holds.

/// A position in [`Scene::params`](crate::Scene::params).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ParamId(pub u32);
/// A position in [`Scene::grids`](crate::Scene::grids).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct GridId(pub u32);
/// A position in [`Scene::objects`](crate::Scene::objects).
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct ObjectId(u32);

impl ObjectId {
    /// Returns the number of the object at a position.
    pub const fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Returns the position.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}
