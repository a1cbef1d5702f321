//! The scene in the page's form: views, params, objects, cameras, images.

use std::collections::BTreeMap;

use render::style::Theme;
use render::view::View;
use scene::{Object, Scene};
use session::TextureChoice;
use session::camera_input::CameraKind;
use session::stated_colour::StatedColour;
use session::textures::ImageSource;
use syntax::span::Span;

use super::Core;
use crate::message::{
    ComponentInfo, ImageInfo, KeyInfo, ObjectInfo, ParamInfo, SceneInfo, SettingInfo, ViewInfo,
};

impl Core {
    pub(super) fn scene_info(&mut self) -> SceneInfo {
        let mut info = SceneInfo {
            version: self.model.program.version,
            stale: self.model.is_stale(),
            took: 1e3 * self.model.program.took.as_secs_f64(),
            views: self.view_infos(),
            cameras: self
                .model
                .declared_cameras()
                .map(|camera| camera.name.clone())
                .collect(),
            ..SceneInfo::default()
        };
        let Some(scene) = self.model.scene.clone() else {
            info.empty = Some("There is nothing to see yet.".to_owned());
            return info;
        };
        info.params = self.param_infos(&scene);
        info.objects = self.object_infos(&scene);
        let images = scene.image_words().into_iter();
        info.images = images
            .map(|word| ImageInfo {
                word: word.to_owned(),
                is_there: self.library.source.has(word),
            })
            .collect();
        if scene.objects.is_empty() {
            info.empty = Some("The program declares nothing to draw.".to_owned());
        }
        info
    }

    fn view_infos(&self) -> Vec<ViewInfo> {
        let scene = self.model.scene.as_deref();
        let ids = self.views.of_scene(scene).into_iter();
        let info = |id: render::ViewId| {
            let view = self.views.get(&id.kind)?;
            let camera = match CameraKind::of(Some(view)) {
                CameraKind::Space => Some("space"),
                CameraKind::Geodesic => Some("inside"),
                CameraKind::Fixed => None,
            };
            let opens_by_itself = match (&id.object, scene) {
                (Some(_), Some(scene)) => self.views.opens_by_itself(&id, scene),
                _ => true,
            };
            Some(ViewInfo {
                id: id.to_string(),
                kind: id.kind.clone(),
                title: self.views.title(&id, " of "),
                purpose: view.purpose(),
                opens_by_itself,
                camera,
                keys: keys(view),
                settings: settings(view),
                instead: self.views.instead_of(&id.kind).map(View::title),
                object: id.object,
            })
        };
        ids.filter_map(info).collect()
    }

    fn param_infos(&mut self, scene: &Scene) -> Vec<ParamInfo> {
        let values = self.model.param_values();
        let params = scene.params.iter().map(|param| {
            let values = values.as_ref().map_or(&[][..], |all| all.param(param));
            let components = param.ranges.iter().zip(&param.initial).enumerate();
            ParamInfo {
                name: param.name.clone(),
                components: components
                    .map(|(k, (range, initial))| ComponentInfo {
                        value: values.get(k).copied().unwrap_or(*initial),
                        initial: *initial,
                        min: range.min,
                        max: range.max,
                    })
                    .collect(),
            }
        });
        params.collect()
    }

    fn object_infos(&self, scene: &Scene) -> Vec<ObjectInfo> {
        let model = &self.model;
        let is_curved = |object: &Object| {
            let is_manifold = object.shape.manifold().is_some();
            is_manifold && *model.choices.texture(&object.name) == TextureChoice::Curvature
        };
        let shows_curvature = scene.objects.iter().any(is_curved);
        let colours = render::style::colours(scene, Theme::Screen, shows_curvature);
        let source = self.editing.source();
        let places = model.program.declared.iter().filter_map(|declared| {
            let name = declared.name_span;
            let name = model
                .program
                .text
                .get(name.start as usize..name.end as usize)?;
            Some((name, declared.name_span))
        });
        let places: BTreeMap<&str, Span> = places.collect();
        let info = |(object, usual): (&Object, &[u8; 3])| {
            let look = model.choices.look(&object.name);
            let stated = StatedColour::of(scene, object);
            let written = stated.and_then(StatedColour::rgb);
            ObjectInfo {
                name: object.name.clone(),
                kind: object.shape.kind(),
                colour: written.or(look.colour).unwrap_or(*usual),
                is_colour_chosen: look.colour.is_some(),
                stated_colour: stated.map(|stated| match stated {
                    StatedColour::Constant(_) => "constant",
                    StatedColour::Expression => "expression",
                }),
                hidden: look.hidden,
                has_texture: object.shape.manifold().is_some(),
                stale: model.faults.stale().contains(&object.name),
                range: places.get(&*object.name).map(|span| source.range(*span)),
            }
        };
        scene.objects.iter().zip(&colours).map(info).collect()
    }
}

fn keys(view: &dyn View) -> Vec<KeyInfo> {
    let keys = view.keys().iter();
    keys.map(|key| KeyInfo {
        keys: key.keys,
        action: key.action,
    })
    .collect()
}

fn settings(view: &dyn View) -> Vec<SettingInfo> {
    let settings = view.settings().iter();
    settings
        .map(|setting| SettingInfo {
            name: setting.name,
            title: setting.title,
            default: setting.default,
        })
        .collect()
}
