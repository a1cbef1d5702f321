//! Pictures that tests ask of one scene after another: a request without its scene, with the backend that draws it.

use std::sync::Arc;

use image::RgbaImage;
use render::geodesic_view::PlacedCamera;
use render::gpu::Gpu;
use render::plan::{Built, Plan};
use render::request::part::SpaceOptions;
use render::request::{Overlays, ViewPart};
use render::shared::Shared;
use render::texture::Texture;
use render::trail::Trail;
use render::view::geodesic::GeodesicOptions;
use render::{Backend, PictureRequest, RenderError, RenderedImage, Renderer, Views};
use scene::{ObjectId, ParamValues, Scene};

/// A picture in memory, or why there is none.
pub type Drawn = Result<RenderedImage<RgbaImage>, RenderError>;

/// A request without its scene, with the backend that draws it.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The view and its options.
    pub view: ViewPart,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// What draws it.
    pub backend: Backend,
    /// The images of surfaces.
    pub textures: Vec<(ObjectId, Arc<Texture>)>,
    /// Colours other than the usual ones.
    pub colours: Vec<(ObjectId, [u8; 3])>,
    /// What is drawn over it.
    pub overlays: Overlays,
    /// Paths that cameras have walked.
    pub trails: Vec<Arc<Trail>>,
    /// Whether the view moves.
    pub moving: bool,
}

impl Wanted {
    /// A picture of any view.
    pub fn new(view: impl Into<ViewPart>, size: [u32; 2]) -> Self {
        Self {
            view: view.into(),
            size,
            backend: Backend::Auto,
            textures: Vec::new(),
            colours: Vec::new(),
            overlays: Overlays::default(),
            trails: Vec::new(),
            moving: false,
        }
    }

    /// A picture of the 3D view.
    pub fn space(size: [u32; 2]) -> Self {
        Self::new(SpaceOptions::default(), size)
    }

    /// A picture of the geodesic view of a surface.
    pub fn geodesic(surface: ObjectId, size: [u32; 2]) -> Self {
        Self::new(GeodesicOptions::new(surface), size)
    }

    /// The options of the 3D view.
    ///
    /// # Panics
    /// When it is a picture of another view.
    pub fn in_space(&mut self) -> &mut SpaceOptions {
        self.view.get_mut().expect("a picture of the 3D view")
    }

    /// The options of the geodesic view.
    ///
    /// # Panics
    /// When it is a picture of another view.
    pub fn inside(&mut self) -> &mut GeodesicOptions {
        self.view.get_mut().expect("a picture of a geodesic view")
    }

    /// The same picture with other options of the 3D view.
    #[must_use]
    pub fn with_space(mut self, change: impl FnOnce(&mut SpaceOptions)) -> Self {
        change(self.in_space());
        self
    }

    /// The same picture with other options of the geodesic view.
    #[must_use]
    pub fn with_inside(mut self, change: impl FnOnce(&mut GeodesicOptions)) -> Self {
        change(self.inside());
        self
    }

    /// The request for a scene.
    pub fn of(&self, scene: &Arc<Scene>, settings: &ParamValues) -> PictureRequest {
        let shared = |(id, texture): &(ObjectId, Arc<Texture>)| (*id, Shared::from(texture));
        PictureRequest {
            textures: self.textures.iter().map(shared).collect(),
            colours: self.colours.clone(),
            overlays: self.overlays,
            trails: self.trails.iter().map(Shared::from).collect(),
            moving: self.moving,
            ..PictureRequest::new(scene, settings.clone(), self.view.clone(), self.size)
        }
    }

    /// The picture of a scene, as for a file.
    ///
    /// # Errors
    /// Those of [`render::render`].
    pub fn draw(&self, scene: &Arc<Scene>, settings: &ParamValues) -> Drawn {
        let request = self.of(scene, settings);
        render::render(&Views::standard(), &request, self.backend, &|_| {})
    }

    /// The picture of a scene by the GPU, with what was built for it.
    ///
    /// # Errors
    /// Those of [`Renderer::draw_counted`].
    pub fn draw_counted(
        &self,
        scene: &Arc<Scene>,
        settings: &ParamValues,
    ) -> Result<(RenderedImage<RgbaImage>, Built), RenderError> {
        let mut renderer = Renderer::on_gpu(Gpu::shared()?);
        renderer.draw_counted(&self.of(scene, settings), &|_| {})
    }

    /// What the picture needs.
    pub fn plan(&self, scene: &Arc<Scene>, settings: &ParamValues) -> Plan {
        Views::standard().plan(&self.of(scene, settings), self.backend)
    }

    /// The camera of a geodesic view on its surface.
    ///
    /// # Errors
    /// Those of [`PlacedCamera::new`].
    pub fn placed(
        &self,
        scene: &Scene,
        settings: &ParamValues,
    ) -> Result<PlacedCamera, RenderError> {
        let options: &GeodesicOptions = self.view.get().expect("a picture of a geodesic view");
        let camera = PlacedCamera::new(scene, settings, &options.camera, self.size)?;
        Ok(camera.with_method(options.method))
    }
}
