//! The difference between two views: the entries of one that differ in the other.
//!
//! A step stores only what it has replaced. Exchanging that with the current choices undoes the step, and exchanging it
//! again redoes the step; entries that other steps have changed meanwhile stay as they are.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::camera::SpaceCamera;
use super::choices::{Animation, Choices, Look, Preferences, TextureChoice};
use super::inside_camera::InsideCamera;

/// Entries by their keys; `None` for an absent entry.
type Entries<K, V> = BTreeMap<K, Option<V>>;
/// A param's name and one of its components, from 0.
type Component = (String, usize);

/// Some entries of the choices. The closed panes are not among them: closing one is not a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Difference {
    looks: Entries<String, Look>,
    params: Entries<Component, f64>,
    animated: Entries<Component, bool>,
    space: Option<Option<SpaceCamera>>,
    inside: Entries<String, InsideCamera>,
    textures: Option<Vec<PathBuf>>,
    default_texture: Option<TextureChoice>,
    preferences: Option<Preferences>,
}

impl Difference {
    /// Returns the entries of choices that differ in others.
    pub(super) fn of(choices: &Choices, other: &Choices) -> Self {
        Self {
            looks: entries(&choices.looks, &other.looks),
            params: entries(&values(choices), &values(other)),
            animated: entries(&animated(choices), &animated(other)),
            space: (choices.space != other.space).then_some(choices.space),
            inside: entries(&choices.inside, &other.inside),
            textures: differing(&choices.textures, &other.textures),
            default_texture: differing(&choices.default_texture, &other.default_texture),
            preferences: differing(&choices.preferences, &other.preferences),
        }
    }

    /// Returns the difference that holds the geodesic camera of a surface.
    pub(super) fn camera(surface: &str, camera: Option<InsideCamera>) -> Self {
        Self {
            inside: [(surface.to_owned(), camera)].into(),
            ..Self::default()
        }
    }

    /// Returns whether there are no entries.
    pub(super) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Adds the entries that it does not have.
    pub(super) fn add(&mut self, other: Self) {
        add(&mut self.looks, other.looks);
        add(&mut self.params, other.params);
        add(&mut self.animated, other.animated);
        self.space = self.space.or(other.space);
        add(&mut self.inside, other.inside);
        self.textures = self.textures.take().or(other.textures);
        self.default_texture = self.default_texture.take().or(other.default_texture);
        self.preferences = self.preferences.take().or(other.preferences);
    }

    /// Exchanges its entries with those of the choices. Returns what has changed in them.
    pub(super) fn exchange(&mut self, choices: &mut Choices) -> Exchanged {
        let mut params = values(choices);
        let mut animations = animated(choices);
        let cameras = exchange(&mut self.inside, &mut choices.inside);
        let values = exchange(&mut self.params, &mut params);
        let animated = exchange(&mut self.animated, &mut animations);
        let looks = exchange(&mut self.looks, &mut choices.looks);
        for (name, component) in &values {
            let value = params.get(&(name.clone(), *component)).copied();
            choices.choose(name, *component, value);
        }
        for key in &animated {
            let on = animations.get(key).copied().unwrap_or_default();
            choices.animate(&key.0, key.1, on);
        }
        let others = [
            swap(&mut self.space, &mut choices.space),
            swap(&mut self.textures, &mut choices.textures),
            swap(&mut self.default_texture, &mut choices.default_texture),
            swap(&mut self.preferences, &mut choices.preferences),
        ];
        let any = others.contains(&true) || !values.is_empty() || !looks.is_empty();
        Exchanged {
            any: any || !animated.is_empty() || !cameras.is_empty(),
            cameras,
        }
    }

    /// Drops the value of a component of a param.
    pub(super) fn drop_value(&mut self, param: &str, component: usize) {
        self.params.remove(&(param.to_owned(), component));
    }

    /// Drops the 3D camera unless the user has moved it.
    pub(super) fn reframe(&mut self) {
        self.space = self.space.map(|it| it.filter(|camera| camera.moved));
    }

    /// Drops the geodesic cameras that the user has not moved.
    pub(super) fn settle_anew(&mut self) {
        for camera in self.inside.values_mut() {
            *camera = camera.filter(InsideCamera::is_moved);
        }
    }
}

/// The effect of an exchange.
#[derive(Debug)]
pub(super) struct Exchanged {
    /// True if anything has changed.
    pub(super) any: bool,
    /// The surfaces whose geodesic cameras have changed.
    pub(super) cameras: Vec<String>,
}

fn entries<K: Clone + Ord, V: Clone + PartialEq>(
    own: &BTreeMap<K, V>,
    other: &BTreeMap<K, V>,
) -> Entries<K, V> {
    let keys = own.keys().chain(other.keys());
    let differs = keys.filter(|key| own.get(*key) != other.get(*key));
    differs
        .map(|key| (key.clone(), own.get(key).cloned()))
        .collect()
}

fn differing<V: Clone + PartialEq>(own: &V, other: &V) -> Option<V> {
    (own != other).then(|| own.clone())
}

fn add<K: Ord, V>(entries: &mut Entries<K, V>, others: Entries<K, V>) {
    for (key, value) in others {
        entries.entry(key).or_insert(value);
    }
}

/// Exchanges entries. Returns the keys of those that differed.
fn exchange<K: Clone + Ord, V: PartialEq>(
    entries: &mut Entries<K, V>,
    all: &mut BTreeMap<K, V>,
) -> Vec<K> {
    let mut differed = Vec::new();
    for (key, value) in entries {
        let before = all.remove(key);
        let after = std::mem::replace(value, before);
        if after != *value {
            differed.push(key.clone());
        }
        all.extend(after.map(|after| (key.clone(), after)));
    }
    differed
}

/// Exchanges a value, if there is one. Returns whether the two differed.
fn swap<V: PartialEq>(value: &mut Option<V>, other: &mut V) -> bool {
    let Some(value) = value else {
        return false;
    };
    std::mem::swap(value, other);
    value != other
}

/// Returns the chosen values, by component.
fn values(choices: &Choices) -> BTreeMap<Component, f64> {
    let params = choices.params.iter();
    let all = params.flat_map(|(name, values)| {
        let numbered = values.iter().enumerate();
        numbered.filter_map(|(k, value)| Some(((name.clone(), k), (*value)?)))
    });
    all.collect()
}

/// Returns the animated components.
fn animated(choices: &Choices) -> BTreeMap<Component, bool> {
    let animations = choices.animations.iter();
    let all = animations.flat_map(|(name, Animation { on, .. })| {
        let numbered = on.iter().enumerate();
        numbered
            .filter(|(_, on)| **on)
            .map(|(k, _)| ((name.clone(), k), true))
    });
    all.collect()
}
