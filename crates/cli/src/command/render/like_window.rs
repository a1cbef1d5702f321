//! `--like-window`: the options of what the window remembers of a program, before those that are given.

use std::ffi::OsString;

use render::{PictureRequest, ViewId};

use super::Arguments;
use crate::failure::Failure;
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Returns the arguments that follow from the options of the window and from those that were given: of an option that
/// both have, the one that was given applies.
pub(super) fn completed(
    arguments: &Arguments,
    program: &LoadedProgram,
    context: &Context,
) -> Result<Box<Arguments>, Failure> {
    let views = &context.registry.views;
    let ViewId { kind, object } = arguments.view(views, program.scene());
    let of_object = views.get(&kind).is_some_and(|view| view.is_of_object());
    // The objects of a name are those of the values that the window remembers, or of those that are given.
    let object = match (of_object, object) {
        (true, Some(name)) => Some(name),
        (true, None) => Some(program.ground(None)?.1.name.clone()),
        (false, _) => None,
    };
    let request = remembered(arguments, program, context, &ViewId { kind, object })?;
    let options = export::command_line::options(&request, views);
    // The picture is of the view and has the size that were asked for.
    let options = options
        .iter()
        .filter(|it| it.name != "view" && it.name != "size");
    let window = options.map(|option| OsString::from(option.word()));
    let mut words = arguments.words.clone();
    let render = words.iter().position(|word| word == super::NAME);
    let after = render.map_or(words.len(), |at| at + 1);
    words.splice(after..after, window);
    crate::command::Arguments::parse_render(&context.registry, words)
}

#[cfg(feature = "window")]
fn remembered(
    arguments: &Arguments,
    program: &LoadedProgram,
    context: &Context,
    id: &ViewId,
) -> Result<PictureRequest, Failure> {
    let (scene, views) = (program.scene(), &context.registry.views);
    let remembered = preview::remembered(&arguments.file, scene, views, id, arguments.size(scene));
    remembered.map_err(|message| Failure::Input {
        message: format!("--like-window: {message}"),
        // The window shows no standard input.
        hint: (arguments.file.as_os_str() != "-").then(|| {
            format!(
                "`geotrace show {}` opens the window, which remembers what it shows",
                arguments.file.display()
            )
        }),
    })
}

#[cfg(not(feature = "window"))]
fn remembered(
    _: &Arguments,
    _: &LoadedProgram,
    _: &Context,
    _: &ViewId,
) -> Result<PictureRequest, Failure> {
    let message =
        "--like-window: this build of geotrace has no window, and does not read what one remembers";
    Err(Failure::usage(message))
}
