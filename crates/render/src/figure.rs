//! Figures on a surface: points with a measurement, as specified in a window or on a command line.

/// The kind of a figure.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum FigureKind {
    /// A point: its curvatures.
    #[default]
    Place,
    /// Two points: the geodesics between them.
    Distance,
    /// A circle about its first point, through the second one or with a given radius.
    Circle,
    /// Three points: a triangle of shortest geodesics.
    Triangle,
}

impl FigureKind {
    /// All kinds, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::Place, Self::Distance, Self::Circle, Self::Triangle];

    /// Returns its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Place => "place",
            Self::Distance => "distance",
            Self::Circle => "circle",
            Self::Triangle => "triangle",
        }
    }

    /// Returns the number of its points; a circle with a radius needs only one.
    pub fn places(self) -> usize {
        match self {
            Self::Place => 1,
            Self::Distance | Self::Circle => 2,
            Self::Triangle => 3,
        }
    }
}

/// Points on a surface with the kind of measurement. A figure with too few points shows those that it has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Its kind.
    pub kind: FigureKind,
    /// The points (u, v) in the order of their letters.
    pub places: Vec<[f64; 2]>,
    /// The radius of a circle that does not pass through its second point, in the surface's units.
    pub radius: Option<f64>,
}

impl Figure {
    /// Returns its points in order, each with its letter from A on.
    pub fn lettered(&self) -> impl Iterator<Item = (char, [f64; 2])> + '_ {
        ('A'..='Z').zip(self.places.iter().copied())
    }
}
