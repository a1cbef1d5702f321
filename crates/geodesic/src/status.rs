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
    /// The parametrisation lost its rank: σu and σv are parallel, or a metric is not positive definite.
    Degenerate,
    /// The surface is undefined there (NaN).
    Undefined,
    /// It used up its evaluations.
    WorkLimit,
}

impl Status {
    /// Returns the reason for an early end on a surface with parameters, as the predicate of a sentence about the geodesic.
    pub fn predicate(self) -> &'static str {
        match self {
            Self::LeftDomain => "leaves the domain",
            Self::ConePoint => "runs into the tip of a cone",
            Self::Degenerate => {
                "reaches a point where σu and σv are parallel or the metric is not positive definite"
            }
            Self::Undefined => "reaches a point where the surface is undefined",
            Self::Complete | Self::WorkLimit => "reaches the limit of evaluations",
        }
    }
}
