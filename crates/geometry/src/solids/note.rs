//! Notes on the deviations of a scene from its declarations.

use scene::limits::MAX_LEAVES;

use super::{MAX_BODIES, MAX_SHEETS};

/// A deviation from a declaration.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct RayNote {
    /// The object.
    pub object: String,
    /// The kind of deviation.
    pub fault: RayFault,
}

/// The kinds of deviations from a declaration.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum RayFault {
    /// `skipped` of `instances` instances are not drawn, because the map of `leaf` is singular.
    SingularMap {
        /// The number of instances that are not drawn.
        skipped: u64,
        /// The total number of instances.
        instances: u64,
        /// The name of the leaf.
        leaf: String,
    },
    /// Invisible: the object contains no point.
    Empty,
    /// No bounding box was found.
    Endless(MissingCuts),
    /// Not drawn: there are more than [`MAX_LEAVES`] leaves.
    TooManyLeaves,
    /// Not drawn: its derivatives are too large.
    TooLarge,
    /// Not drawn: with it, reading the shapes of the solids exceeds the limit on work.
    TooMuchWork,
    /// Not completely drawn: there are more than [`MAX_BODIES`] pieces of points, arrows and curves.
    TooManyBodies,
    /// Not all instances of a surface are drawn: there are more than [`MAX_SHEETS`].
    TooManySheets,
    /// This many instances of a light or a camera have no finite position, or no direction of a finite length.
    UndefinedStage(u64),
    /// The attribute is undefined somewhere: its default is used there.
    UndefinedAttribute(&'static str),
    /// The attribute is out of its range somewhere: the nearest number in the range is used.
    ClampedAttribute(&'static str),
    /// The attribute is one number for a whole solid: its value at the origin is used.
    NotUniform(&'static str),
    /// The colour of the background is undefined somewhere.
    UndefinedBackground,
    /// A component of the background's colour is negative somewhere.
    NegativeBackground,
    /// An image is not shown: no `uv` specifies its position.
    UnplacedImage,
}

/// The axes along which no bound of a solid was found. Displayed as a clause with the intervals to state, or for a script,
/// which has none, with the box to intersect.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct MissingCuts {
    /// True for x, y and z of the text if no bound along the axis was found.
    pub axes: [bool; 3],
    /// The names of the axes.
    pub coordinates: [String; 3],
    /// True for a solid of a script.
    pub is_script: bool,
    /// The name of a solid whose declaration must name its last coordinate before it can cut it.
    pub prism: Option<String>,
}

impl std::fmt::Display for MissingCuts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let axes = self.coordinates.iter().zip(self.axes);
        let missing = axes.filter(|(_, is)| *is).map(|(axis, _)| &**axis);
        let missing: Vec<&str> = missing.collect();
        let along = match &missing[..] {
            [all @ .., last] if !all.is_empty() => format!("{} and {last}", all.join(", ")),
            all => all.concat(),
        };
        write!(f, "no bound was found along {along}; ")?;
        if self.is_script {
            return write!(
                f,
                "intersect it with a box: `^ Box {{ cornerA -> vec3(-3, -3, -3) cornerB -> vec3(3, 3, 3) }}`"
            );
        }
        let cuts: Vec<String> = missing
            .iter()
            .map(|axis| format!("{axis} : [-3, 3]"))
            .collect();
        let cuts = cuts.join(", ");
        write!(f, "cut it by `{cuts}`")?;
        match &self.prism {
            Some(name) if self.axes[2] => {
                let [_, _, last] = &self.coordinates;
                let all = self.coordinates.join(", ");
                write!(
                    f,
                    ", which needs the parameter {last}: `solid {name}({all})`"
                )
            }
            _ => Ok(()),
        }
    }
}

impl std::fmt::Display for RayNote {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = &self.object;
        match &self.fault {
            RayFault::SingularMap {
                skipped: 1,
                instances: 1,
                leaf,
            } => {
                write!(f, "`{name}` is not drawn: the map of `{leaf}` is singular")
            }
            RayFault::SingularMap {
                skipped,
                instances,
                leaf,
            } => write!(
                f,
                "{skipped} of the {instances} instances of `{name}` are not drawn: the map of `{leaf}` is singular"
            ),
            RayFault::Empty => write!(f, "`{name}` is not visible: it contains no point"),
            RayFault::Endless(cuts) => {
                write!(
                    f,
                    "`{name}` may be unbounded, so the picture does not frame it: {cuts}"
                )
            }
            RayFault::TooManyLeaves => write!(
                f,
                "`{name}` is not drawn: with it the solids have more than {MAX_LEAVES} leaves"
            ),
            RayFault::TooLarge => {
                write!(f, "`{name}` is not drawn: its derivatives are too large")
            }
            RayFault::TooMuchWork => write!(
                f,
                "`{name}` is not drawn: locating the solids exceeds the work limit; use fewer instances"
            ),
            RayFault::TooManyBodies => write!(
                f,
                "not all of `{name}` is drawn: points, arrows and curves have more than {MAX_BODIES} pieces"
            ),
            RayFault::TooManySheets => write!(
                f,
                "not all instances of `{name}` are drawn: there are more than {MAX_SHEETS} surfaces"
            ),
            RayFault::UndefinedStage(1) => {
                write!(
                    f,
                    "`{name}` is left out: its position or direction is undefined, or the direction's length is 0 or too large"
                )
            }
            RayFault::UndefinedStage(count) => write!(
                f,
                "{count} instances of `{name}` are left out: their position or direction is undefined, or the direction's length is 0 or too large"
            ),
            RayFault::UndefinedAttribute(word) => write!(
                f,
                "`{word}` of `{name}` is undefined somewhere: its default is used there"
            ),
            RayFault::ClampedAttribute(word) => write!(
                f,
                "`{word}` of `{name}` is out of range somewhere: it is clamped there"
            ),
            RayFault::NotUniform(word) => write!(
                f,
                "`{word}` of `{name}` is one number for the whole solid: its value at the origin is used"
            ),
            RayFault::UndefinedBackground => {
                write!(
                    f,
                    "the background `{name}` is undefined somewhere: it is black there"
                )
            }
            RayFault::NegativeBackground => {
                write!(
                    f,
                    "the background `{name}` is negative somewhere: 0 is used there"
                )
            }
            RayFault::UnplacedImage => {
                write!(f, "`{name}` has no `uv`, so its image is not shown")
            }
        }
    }
}
