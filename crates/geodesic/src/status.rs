//! The ways in which a geodesic ends.

/// The reason why a geodesic ended.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub enum Status {
    /// It has its full length.
    #[default]
    Complete,
    /// It left the domain through a true edge.
    LeftDomain,
    /// It ran into the tip of a cone.
    ConePoint,
    /// The parametrisation lost its rank: σu and σv are parallel.
    Degenerate,
    /// The surface is undefined there (NaN).
    Undefined,
    /// It used up its evaluations.
    WorkLimit,
}
