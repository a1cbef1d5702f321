//! What is to be seen, as data that can be compared: a picture is asked for again only where its order has changed.

use std::sync::Arc;

use render::overlay::{Overlays, Spacing, Standpoint, Trail};
use render::request::{Request, View};
use render::texture::Texture;
use scene::ParamValues;
use scene::{ObjectId, Scene};

use crate::engine::textures::Library;
use crate::state::pane::PaneKey;
use crate::state::path::CameraPath;
use crate::state::{Choice, InsideCamera, Marks, Model, SpaceCamera};

/// A picture that is wanted.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    pub(crate) scene: Arc<Scene>,
    pub(crate) settings: Arc<ParamValues>,
    pub(crate) look: Look,
    pub(crate) size: [u32; 2],
    pub(crate) textures: Vec<(ObjectId, Arc<Texture>)>,
    /// The surfaces that show their curvature.
    pub(crate) curved: Vec<ObjectId>,
    pub(crate) colours: Vec<(ObjectId, [u8; 3])>,
    pub(crate) marks: Marks,
    /// A camera is being moved, or a param: a picture at once is worth more than a fine one.
    pub(crate) moving: bool,
    /// The text's version, for who asks what is on the screen; the picture does not depend on it.
    pub(crate) version: i32,
}

/// From where.
#[derive(Clone, Debug)]
pub(crate) enum Look {
    /// The 3D view.
    Space {
        /// None: from where everything is seen.
        camera: Option<SpaceCamera>,
        /// A geodesic camera to be shown.
        standpoint: Option<Standing>,
        /// An object to be told apart.
        highlight: Option<ObjectId>,
        /// Behind everything, sRGB.
        background: [u8; 3],
        /// The ways whose trails are shown, with the surfaces that they are on.
        ways: Vec<(ObjectId, Arc<CameraPath>)>,
        /// What is not drawn.
        hidden: Vec<ObjectId>,
    },
    /// A geodesic view. Its pilot knows where the camera is, unless it has been put somewhere.
    Inside {
        surface: ObjectId,
        name: String,
        placed: u64,
        camera: Option<InsideCamera>,
        /// The way that the camera has gone, if it leaves a trail.
        way: Option<Arc<CameraPath>>,
        /// The number of the trail that the camera leaves, if it does.
        trail: Option<u64>,
    },
}

/// A geodesic camera as it was last told. Its pilot knows where it is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Standing {
    pub(crate) surface: ObjectId,
    pub(crate) name: String,
    pub(crate) placed: u64,
    pub(crate) camera: Option<InsideCamera>,
}

impl Order {
    /// For a picture that is kept: of a view at rest, with nothing set off.
    #[must_use]
    pub(crate) fn kept(mut self, size: [u32; 2]) -> Self {
        self.size = size;
        self.moving = false;
        if let Look::Space { highlight, .. } = &mut self.look {
            *highlight = None;
        }
        self
    }

    /// Whether the same picture is asked for.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let same_look = match (&self.look, &other.look) {
            (
                Look::Space {
                    camera,
                    standpoint,
                    highlight,
                    background,
                    ways,
                    hidden,
                },
                Look::Space {
                    camera: camera2,
                    standpoint: standpoint2,
                    highlight: highlight2,
                    background: background2,
                    ways: ways2,
                    hidden: hidden2,
                },
            ) => {
                let place = |camera: &Option<SpaceCamera>| camera.map(|it| (it.eye, it.target));
                place(camera) == place(camera2)
                    && standpoint == standpoint2
                    && highlight == highlight2
                    && background == background2
                    && hidden == hidden2
                    && ways.len() == ways2.len()
                    && ways
                        .iter()
                        .zip(ways2)
                        .all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1))
            }
            // The camera comes back with each picture: only its placing is news.
            (
                Look::Inside {
                    surface,
                    placed,
                    trail,
                    ..
                },
                Look::Inside {
                    surface: surface2,
                    placed: placed2,
                    trail: trail2,
                    ..
                },
            ) => surface == surface2 && placed == placed2 && trail == trail2,
            _ => false,
        };
        let same_textures = self.textures.len() == other.textures.len()
            && self
                .textures
                .iter()
                .zip(&other.textures)
                .all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1));
        same_look
            && same_textures
            && Arc::ptr_eq(&self.scene, &other.scene)
            && self.settings == other.settings
            && self.size == other.size
            && self.colours == other.colours
            && self.curved == other.curved
            && self.marks == other.marks
            && self.moving == other.moving
    }

    /// The textures of the surfaces that show their curvature, with the params as they are.
    pub(crate) fn curvatures(&self) -> Vec<(ObjectId, Arc<Texture>)> {
        let texture = |id: &ObjectId| {
            // A surface whose derivatives are too large shows what it would show otherwise.
            let texture = Texture::curvature(&self.scene, &self.settings, *id).ok()?;
            Some((*id, texture))
        };
        self.curved.iter().filter_map(texture).collect()
    }

    /// As [`Order::request`], with all that takes time to make: for a thread that has it.
    pub(crate) fn whole_request(&self, inside: Option<InsideCamera>) -> Request {
        let mut request = self.request(inside);
        request.textures.extend(self.curvatures());
        request
    }

    /// As the stage takes it, but for curvatures. The camera of a geodesic view is where its pilot says.
    pub(crate) fn request(&self, inside: Option<InsideCamera>) -> Request {
        let mut request = match &self.look {
            Look::Space {
                camera,
                standpoint,
                highlight,
                background: [r, g, b],
                ways,
                hidden,
            } => {
                let mut request = Request::space(self.size);
                request.hidden = hidden.clone();
                request.highlight = *highlight;
                request.background = Some([*r, *g, *b, 255]);
                request.view = View::Space {
                    eye: camera.map(|it| it.eye),
                    target: camera.map(|it| it.target),
                };
                let standing = standpoint.as_ref();
                request.show_camera = standing.and_then(|it| {
                    let camera = it.camera?;
                    Some(Standpoint {
                        surface: it.surface,
                        at: None,
                        angle: 0.0,
                        zoom: Some(camera.zoom),
                        frame: Some(camera.frame()),
                    })
                });
                request.trails = ways.iter().map(|(id, way)| trail_on(*id, way)).collect();
                request
            }
            Look::Inside { surface, .. } => {
                let mut request = Request::geodesic(*surface, self.size);
                if let View::Geodesic { frame, .. } = &mut request.view {
                    *frame = inside.map(|camera| camera.frame());
                }
                request.mark_centre = self.marks.centre;
                request
            }
        };
        request.moving = self.moving;
        request.textures = self.textures.clone();
        request.colours = self.colours.clone();
        request.overlays = Overlays {
            legend: self.marks.legend,
            wavefronts: self.marks.wavefronts.then_some(Spacing::Auto),
            conjugate_points: self.marks.conjugate,
            cut_locus: self.marks.cut_locus,
            error: self.marks.error,
        };
        request
    }
}

/// The trail of a way, on its surface as it is numbered now: what is declared above it may have become more or less since
/// it was walked, and nobody walks while its geodesic view is not on the screen.
fn trail_on(surface: ObjectId, way: &CameraPath) -> Arc<Trail> {
    if way.trail.surface == surface {
        return Arc::clone(&way.trail);
    }
    let mut trail = (*way.trail).clone();
    trail.surface = surface;
    Arc::new(trail)
}

/// The order of a pane, of so many pixels; none where there is nothing to be seen.
pub(crate) fn order(
    model: &mut Model,
    library: &mut Library,
    pane: &PaneKey,
    size: [u32; 2],
    active: Option<&str>,
    moving: bool,
) -> Option<Order> {
    let scene = model.scene.clone()?;
    let settings = model.settings()?;
    let hidden = match pane {
        PaneKey::Space => model.hidden(),
        PaneKey::Inside(_) => Vec::new(),
    };
    let view = &model.view;
    let id_of = |name: &str| scene.object(name).map(|(id, _)| id);
    let mut textures = Vec::new();
    let mut curved = Vec::new();
    let mut colours = Vec::new();
    for (id, object) in scene.numbered() {
        if hidden.contains(&id) {
            continue;
        }
        if let Some(colour) = view.looks.get(&object.name).and_then(|look| look.colour) {
            colours.push((id, colour));
        }
        if object.shape.manifold().is_some() {
            let choice = view.texture(&object.name);
            if *choice == Choice::Curvature {
                curved.push(id);
            }
            if *choice != Choice::Default
                && let Some(texture) = library.texture(choice)
            {
                textures.push((id, texture));
            }
        }
    }
    let camera_of = |name: &str| view.inside.get(name).copied();
    let look = match pane {
        PaneKey::Space => {
            let standpoint = active
                .filter(|_| view.preferences.marks.cameras)
                .and_then(|name| {
                    Some(Standing {
                        surface: id_of(name)?,
                        name: name.to_owned(),
                        placed: model.placed(name),
                        camera: camera_of(name),
                    })
                });
            let walked = model.walked.iter().filter(|_| view.preferences.marks.trail);
            let ways = walked.filter_map(|(name, way)| Some((id_of(name)?, Arc::clone(way))));
            let highlighted = model.highlighted.as_deref();
            Look::Space {
                camera: view.space,
                standpoint,
                highlight: highlighted.and_then(id_of),
                background: view
                    .preferences
                    .background
                    .unwrap_or(render::style::BACKGROUND),
                ways: ways.collect(),
                hidden,
            }
        }
        PaneKey::Inside(name) => Look::Inside {
            surface: id_of(name)?,
            name: name.clone(),
            placed: model.placed(name),
            camera: camera_of(name),
            way: model.walked.get(name).cloned(),
            trail: view.preferences.marks.trail.then_some(model.trails_begun),
        },
    };
    Some(Order {
        look,
        size,
        textures,
        curved,
        colours,
        marks: view.preferences.marks,
        moving,
        version: model.version,
        scene,
        settings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(text: &str) -> Model {
        let mut model = Model::default();
        model.scene = scene::geotrace::compile(text).scene.map(Arc::new);
        model.view.preferences.marks.trail = true;
        model
    }

    #[test]
    fn a_trail_is_on_its_surface_also_where_that_has_another_number_than_when_it_was_walked() {
        const SURFACE: &str = "surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];";
        let trail = Trail {
            surface: ObjectId(0),
            points: vec![[0.1, 0.2], [0.3, 0.4]],
            length: 0.3,
        };
        let camera = InsideCamera {
            at: [0.3, 0.4],
            x: [0.1, 0.0],
            y: [0.0, 0.1],
            pole: None,
            zoom: 0.1,
            moved: true,
        };
        let way = Arc::new(CameraPath::new(trail, camera));
        for (text, number) in [
            (SURFACE.to_owned(), 0),
            (format!("point p = (0,0,1); {SURFACE}"), 1),
        ] {
            let mut model = model(&text);
            model.walked.insert("s".to_owned(), Arc::clone(&way));
            let mut library = Library::default();
            let space = PaneKey::Space;
            let order = order(&mut model, &mut library, &space, [32, 32], None, false);
            let request = order.expect("a picture").request(None);
            let [trail] = request.trails.as_slice() else {
                panic!("{} trails", request.trails.len());
            };
            assert_eq!(trail.surface, ObjectId(number));
            assert_eq!(trail.points, way.trail.points);
            // One that has been numbered right is not copied.
            assert_eq!(Arc::ptr_eq(trail, &way.trail), number == 0);
        }
    }
}
