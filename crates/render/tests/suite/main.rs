//! The tests of pictures, a module for each subject. They are one program: linking one for each takes minutes.

mod annotations;
mod background;
mod curvature;
mod gpu;
mod inside;
mod live;
mod orthographic;
mod overlays;
mod pick;
mod plans;
mod resolve;
mod samples;
mod scenes;
mod shown;
mod shown_solids;
mod solid_overlays;
mod space;
mod stated_colours;
mod surface_images;
mod textures;
