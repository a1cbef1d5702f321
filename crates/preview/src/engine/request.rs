//! What is to be seen, as data that can be compared: a picture is asked for again only where its order has changed.

use std::sync::Arc;

use render::PictureRequest;
use render::request::{Overlays, Spacing, ViewPart};
use render::shared::Shared;
use render::texture::Texture;
use render::trail::Trail;
use render::view::geodesic::GeodesicOptions;
use render::view::space::SpaceOptions;
use render::viewpoint::{GeodesicCamera, PerspectiveCamera};
use scene::ParamValues;
use scene::{ObjectId, Scene};

use crate::engine::textures::Library;
use crate::state::pane::PaneKey;
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
        /// A geodesic camera to be shown, and its surface.
        standpoint: Option<(ObjectId, InsideCamera)>,
        /// An object to be told apart.
        highlight: Option<ObjectId>,
        /// Behind everything, sRGB.
        background: [u8; 3],
        /// The trails that are shown.
        trails: Vec<Arc<Trail>>,
        /// What is not drawn.
        hidden: Vec<ObjectId>,
    },
    /// A geodesic view.
    Inside {
        surface: ObjectId,
        /// From the first place where there is none.
        camera: Option<InsideCamera>,
        /// The trail that the camera has left, if it does.
        trail: Option<Arc<Trail>>,
    },
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

    /// Returns whether another request differs from this one only by the geodesic camera that the 3D view shows, and
    /// its
    /// trail.
    pub(crate) fn differs_by_shown_camera(&self, other: &Self) -> bool {
        let mut like = self.clone();
        if let (
            Look::Space {
                standpoint, trails, ..
            },
            Look::Space {
                standpoint: standpoint2,
                trails: trails2,
                ..
            },
        ) = (&mut like.look, &other.look)
        {
            *standpoint = *standpoint2;
            trails.clone_from(trails2);
        }
        !self.is_like(other) && like.is_like(other)
    }

    /// Returns whether the same picture is asked for.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        let same_look = match (&self.look, &other.look) {
            (
                Look::Space {
                    camera,
                    standpoint,
                    highlight,
                    background,
                    trails,
                    hidden,
                },
                Look::Space {
                    camera: camera2,
                    standpoint: standpoint2,
                    highlight: highlight2,
                    background: background2,
                    trails: trails2,
                    hidden: hidden2,
                },
            ) => {
                let place = |camera: &Option<SpaceCamera>| camera.map(|it| (it.eye, it.target));
                place(camera) == place(camera2)
                    && standpoint == standpoint2
                    && highlight == highlight2
                    && background == background2
                    && hidden == hidden2
                    && trails.len() == trails2.len()
                    && trails.iter().zip(trails2).all(|(a, b)| Arc::ptr_eq(a, b))
            }
            (
                Look::Inside {
                    surface,
                    camera,
                    trail,
                },
                Look::Inside {
                    surface: surface2,
                    camera: camera2,
                    trail: trail2,
                },
            ) => {
                let pose = |camera: &Option<InsideCamera>| camera.map(|it| (it.frame(), it.zoom));
                let same_trail = match (trail, trail2) {
                    (Some(trail), Some(trail2)) => Arc::ptr_eq(trail, trail2),
                    (trail, trail2) => trail.is_none() && trail2.is_none(),
                };
                surface == surface2 && pose(camera) == pose(camera2) && same_trail
            }
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

    /// As [`Order::request`], with the textures of curvature: for a mesh.
    pub(crate) fn whole_request(&self) -> PictureRequest {
        let mut request = self.request();
        let texture = |id: ObjectId| {
            // A surface whose derivatives are too large shows what it would show otherwise.
            let texture = Texture::curvature(&self.scene, &self.settings, id).ok()?;
            Some((id, texture.into()))
        };
        let curved = std::mem::take(&mut request.curved).into_iter();
        request.textures.extend(curved.filter_map(texture));
        request
    }

    /// The request for the picture.
    pub(crate) fn request(&self) -> PictureRequest {
        let (view, trails): (ViewPart, Vec<Shared<Trail>>) = match &self.look {
            Look::Space {
                camera,
                standpoint,
                highlight,
                background: [r, g, b],
                trails,
                hidden,
            } => {
                let options = SpaceOptions {
                    camera: PerspectiveCamera {
                        eye: camera.map(|it| it.eye),
                        target: camera.map(|it| it.target),
                    },
                    show_camera: standpoint.map(|(surface, camera)| {
                        GeodesicCamera::new(surface).with_frame(camera.frame())
                    }),
                    background: Some([*r, *g, *b, 255]),
                    highlight: *highlight,
                    hidden: hidden.clone(),
                };
                (options.into(), trails.iter().map(Shared::from).collect())
            }
            Look::Inside {
                surface,
                camera,
                trail,
            } => {
                let first = GeodesicCamera::new(*surface);
                let options = GeodesicOptions {
                    mark_centre: self.marks.centre,
                    ..GeodesicOptions::from(
                        camera.map_or(first, |camera| first.with_frame(camera.frame())),
                    )
                };
                (options.into(), trail.iter().map(Shared::from).collect())
            }
        };
        let shared = |(id, texture): &(ObjectId, Arc<Texture>)| (*id, texture.into());
        PictureRequest {
            textures: self.textures.iter().map(shared).collect(),
            curved: self.curved.clone(),
            colours: self.colours.clone(),
            overlays: Overlays {
                legend: self.marks.legend,
                wavefronts: self.marks.wavefronts.then_some(Spacing::Auto),
                conjugate_points: self.marks.conjugate,
                cut_locus: self.marks.cut_locus,
                error: self.marks.error,
            },
            trails,
            moving: self.moving,
            ..PictureRequest::new(&self.scene, Arc::clone(&self.settings), view, self.size)
        }
    }
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
    let marks = model.view.preferences.marks;
    let camera = match pane {
        PaneKey::Space => active
            .filter(|_| marks.cameras)
            .and_then(|name| model.settle_camera(name, false)),
        PaneKey::Inside(name) => model.settle_camera(name, true),
    };
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
    let look = match pane {
        PaneKey::Space => {
            let shown = active.and_then(id_of);
            let paths = model.paths.iter().filter(|_| marks.trail);
            let paths = paths.filter(|(name, _)| id_of(name).is_some());
            let highlighted = model.highlighted.as_deref();
            Look::Space {
                camera: view.space,
                standpoint: shown.zip(camera),
                highlight: highlighted.and_then(id_of),
                background: view
                    .preferences
                    .background
                    .unwrap_or(render::style::BACKGROUND),
                trails: paths.map(|(_, path)| Arc::clone(&path.trail)).collect(),
                hidden,
            }
        }
        PaneKey::Inside(name) => {
            let path = model.paths.get(name).filter(|_| marks.trail);
            Look::Inside {
                surface: id_of(name)?,
                camera,
                trail: path.map(|path| Arc::clone(&path.trail)),
            }
        }
    };
    Some(Order {
        look,
        size,
        textures,
        curved,
        colours,
        marks,
        moving,
        version: model.version,
        scene,
        settings,
    })
}
