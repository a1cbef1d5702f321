//! Figures on a surface: places of which something is measured, as a window and a command line state them.

/// The kind of a figure.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum FigureKind {
    /// A place: its curvatures.
    #[default]
    Place,
    /// Two places: the geodesics between them.
    Distance,
    /// A circle about its first place, through the second one or of a given radius.
    Circle,
    /// Three places: a triangle of shortest geodesics.
    Triangle,
}

impl FigureKind {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::Place, Self::Distance, Self::Circle, Self::Triangle];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Place => "place",
            Self::Distance => "distance",
            Self::Circle => "circle",
            Self::Triangle => "triangle",
        }
    }

    /// The number of its places; of a circle with a radius one is enough.
    pub fn places(self) -> usize {
        match self {
            Self::Place => 1,
            Self::Distance | Self::Circle => 2,
            Self::Triangle => 3,
        }
    }
}

/// Places on a surface with what is measured of them. One that lacks places shows those that it has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Its kind.
    pub kind: FigureKind,
    /// The places (u, v) in the order of their letters.
    pub places: Vec<[f64; 2]>,
    /// The radius of a circle that does not go through its second place, in the surface's units.
    pub radius: Option<f64>,
}

impl Figure {
    /// Its places in order, each with its letter from A on.
    pub fn lettered(&self) -> impl Iterator<Item = (char, [f64; 2])> + '_ {
        ('A'..='Z').zip(self.places.iter().copied())
    }
}
