//! The cameras of the geodesic views: points with two tangent vectors.

use geodesic::ends::Coordinates;
use geodesic::frame::Frame;
use geodesic::implicit::SpaceFrame;
use render::viewpoint::{GeodesicCamera, Pose};
use scene::ObjectId;
use serde::{Deserialize, Serialize};

/// The camera of a geodesic view.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
pub enum InsideCamera {
    /// On a surface or a metric.
    Chart(ChartCamera),
    /// On a solid.
    Solid(SolidCamera),
}

impl InsideCamera {
    /// Returns the distance on the surface from the picture's centre to the midpoint of an edge, along the shorter
    /// side.
    pub fn zoom(&self) -> f64 {
        match self {
            Self::Chart(camera) => camera.zoom,
            Self::Solid(camera) => camera.zoom(),
        }
    }

    /// Returns whether the user has moved it.
    pub fn is_moved(&self) -> bool {
        match self {
            Self::Chart(camera) => camera.moved,
            Self::Solid(camera) => camera.moved,
        }
    }

    /// Returns the camera on a surface or a metric, if it is one.
    pub fn chart(&self) -> Option<&ChartCamera> {
        match self {
            Self::Chart(camera) => Some(camera),
            Self::Solid(_) => None,
        }
    }

    /// Returns its position: (u, v), or (x, y, z).
    pub fn place(&self) -> &[f64] {
        match self {
            Self::Chart(camera) => &camera.at,
            Self::Solid(camera) => &camera.at,
        }
    }

    /// Returns whether a picture can be drawn from it.
    pub fn is_sane(&self) -> bool {
        match self {
            Self::Chart(camera) => camera.is_sane(),
            Self::Solid(camera) => camera.is_sane(),
        }
    }

    /// Returns the camera of a request.
    pub fn on(&self, surface: ObjectId) -> GeodesicCamera {
        GeodesicCamera {
            surface,
            pose: match self {
                Self::Chart(camera) => Pose::Frame(camera.frame()),
                Self::Solid(camera) => Pose::SpaceFrame(camera.frame()),
            },
            zoom: None,
        }
    }
}

/// The range of valid zooms.
const ZOOMS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;

/// The camera of the geodesic view of a surface or a metric.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ChartCamera {
    /// Its (u, v).
    pub at: [f64; 2],
    /// X, in (u, v), or in the pole's coordinates.
    pub x: [f64; 2],
    /// Y likewise.
    pub y: [f64; 2],
    /// The pole in whose coordinates X and Y are: axis and end, see `geodesic::ends::Coordinates`.
    #[serde(default)]
    pub pole: Option<[u8; 2]>,
    /// The length of X and Y on the surface.
    pub zoom: f64,
    /// True if the user has moved it; otherwise it is placed anew when its surface changes.
    #[serde(default)]
    pub moved: bool,
}

impl ChartCamera {
    /// Returns the camera of a frame.
    pub fn of(frame: &Frame, zoom: f64, moved: bool) -> Self {
        Self {
            at: frame.uv.0,
            x: frame.x.0,
            y: frame.y.0,
            pole: match frame.coordinates {
                Coordinates::Plain => None,
                Coordinates::Apex { axis, end } => Some([axis, end]),
            },
            zoom,
            moved,
        }
    }

    /// Returns its frame.
    pub fn frame(&self) -> Frame {
        Frame {
            uv: self.at.into(),
            coordinates: self
                .pole
                .map_or(Coordinates::Plain, |[axis, end]| Coordinates::Apex {
                    axis,
                    end,
                }),
            x: self.x.into(),
            y: self.y.into(),
        }
    }

    /// Returns whether all its numbers are finite.
    pub fn is_sane(&self) -> bool {
        let all = [self.at, self.x, self.y].concat();
        let pole = self.pole.unwrap_or_default();
        all.iter().all(|x| x.is_finite())
            && ZOOMS.contains(&self.zoom)
            && pole.iter().all(|k| *k <= 1)
    }
}

/// The camera of the geodesic view of a solid.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct SolidCamera {
    /// Its position in space.
    pub at: [f64; 3],
    /// X, whose length is the zoom.
    pub x: [f64; 3],
    /// Y likewise.
    pub y: [f64; 3],
    /// True if the user has moved it; otherwise it is placed anew when its solid changes.
    #[serde(default)]
    pub moved: bool,
}

impl SolidCamera {
    /// Returns the camera of a frame.
    pub fn of(frame: &SpaceFrame, moved: bool) -> Self {
        let SpaceFrame { at, x, y } = *frame;
        Self { at, x, y, moved }
    }

    /// Returns its frame.
    pub fn frame(&self) -> SpaceFrame {
        let Self { at, x, y, .. } = *self;
        SpaceFrame { at, x, y }
    }

    /// Returns the length of X and Y.
    pub fn zoom(&self) -> f64 {
        self.frame().zoom()
    }

    fn is_sane(&self) -> bool {
        let all = [self.at, self.x, self.y].concat();
        all.iter().all(|x| x.is_finite()) && ZOOMS.contains(&self.zoom())
    }
}

#[cfg(test)]
mod tests {
    use super::{ChartCamera, InsideCamera, SolidCamera};

    #[test]
    fn a_file_says_by_the_numbers_of_a_place_whether_it_is_on_a_solid() {
        let chart = InsideCamera::Chart(ChartCamera {
            at: [1.0, 2.0],
            x: [1.0, 0.0],
            y: [0.0, 1.0],
            pole: None,
            zoom: 1.0,
            moved: true,
        });
        let solid = InsideCamera::Solid(SolidCamera {
            at: [1.0, 2.0, 3.0],
            x: [2.0, 0.0, 0.0],
            y: [0.0, 2.0, 0.0],
            moved: true,
        });
        for camera in [chart, solid] {
            let text = serde_json::to_string(&camera).expect("it is written");
            let read: InsideCamera = serde_json::from_str(&text).expect("it is read");
            assert_eq!(read, camera, "{text}");
        }
        assert_eq!(solid.zoom(), 2.0);
    }
}
