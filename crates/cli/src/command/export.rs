//! `geotrace export`: the objects of a program as a file for other programs.

use std::path::{Path, PathBuf};

use clap::Args;
use export::mesh::{self, ExportError, MeshFormat};
use render::PictureRequest;
use scene::ObjectId;

use super::render::textures;
use crate::argument::{self, Assignment, Choice, Format, TextureFile};
use crate::failure::Failure;
use crate::number;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::registry::Context;

/// Write a program's solids, surfaces, curves, geodesics, vectors and points as a mesh, for modelling, printing, or a paper.
///
/// Positions are in the program's units, as precise as the format allows. Where a surface closes (a sphere's poles, a
/// torus' seams) the mesh closes too; where it is undefined the mesh has a hole. The mesh of a solid is closed and keeps
/// sharp edges; OBJ, PLY and glTF have its colours.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  geotrace export sphere.gtr -o sphere.stl                  surfaces and solids, watertight if closed
  geotrace export torus.gtr -o torus.glb --texture s=a.png  with its image, for viewers and the web
  geotrace export circle.gtr -o - --format obj --set r=0.7  all objects, as text
  geotrace export torus.gtr -o s.ply --object s             one object, with normals and colours

obj   text: an object for each name, with normals and texture coordinates; lines and points
ply   binary: places in double precision, normals, the picture's colours at the vertices; edges
stl   binary: the triangles of surfaces and solids, and nothing else
gltf  JSON with everything in it: materials, images, lines and points; glb is the same, binary

The intervals set the resolution of a surface: `u : [0, 1, 200]` has 200 samples. For a solid, `x : [0, 1, 200]` sets \
cells of 1/200. The file is written whole or not at all.")]
pub(super) struct Arguments {
    /// The program; `-` is standard input
    file: PathBuf,
    /// The file to write, in the format of its extension; `-` is standard output
    #[arg(short, long, value_name = "OUT.{obj,ply,stl,gltf,glb}")]
    output: PathBuf,
    /// The format, overriding the file's extension
    #[arg(long, value_parser = argument::choice(&FORMATS), value_name = "FORMAT")]
    format: Option<MeshFormat>,
    /// An object to write; may be given several times [default: all objects]
    #[arg(long, value_name = "NAME")]
    object: Vec<String>,
    /// A value for a param or a grid, NAME=A,B for components; may be given several times
    #[arg(long, value_name = "NAME=VALUE", value_parser = argument::assignment, allow_hyphen_values = true)]
    set: Vec<Assignment>,
    /// An image (PNG or JPEG) for a surface: its left edge is at u min, its top edge at v min. `SURFACE=curvature` colours it
    /// by its Gaussian curvature
    #[arg(long, value_name = "SURFACE=IMAGE", value_parser = argument::texture)]
    texture: Vec<TextureFile>,
    /// A folder with the images that the program names, such as `image : earth`, if they are not beside it
    #[arg(long, value_name = "DIR")]
    images: Option<PathBuf>,
}

/// Every format, by its extension.
const FORMATS: [Choice<MeshFormat>; MeshFormat::ALL.len()] = {
    let mut choices = [Choice::new("", "", MeshFormat::Obj); MeshFormat::ALL.len()];
    let mut k = 0;
    while k < choices.len() {
        let format = MeshFormat::ALL[k];
        choices[k] = Choice::new(format.extension(), format.title(), format);
        k += 1;
    }
    choices
};

/// Builds the meshes and writes the file.
pub(super) fn run(arguments: &Arguments, context: &Context) -> Result<(), Failure> {
    let format = file_format(arguments)?;
    let mut program = LoadedProgram::load(context, &arguments.file, Format::Human)?;
    let params = program.set_params(&arguments.set)?;
    let scene = program.scene();
    let objects = objects(&program, &arguments.object)?;
    let images = textures(&arguments.texture, arguments.images.as_deref(), &program)?;
    let request = PictureRequest {
        textures: images.at(scene, &params)?,
        images: images.named.clone(),
        ..PictureRequest::new(
            scene,
            params,
            context.registry.views.first().options(None),
            [1, 1],
        )
    };
    let inputs = Inputs::new(&arguments.file, images.files());
    let target = OutputTarget::apart_from(&arguments.output, &inputs)?;
    let model = mesh::model(&request, objects.as_deref());
    let mut notes = images.notes(&program, &request);
    let background = scene.background().map(|object| &object.name);
    let mut chosen = arguments.texture.iter();
    if let Some(name) = background.filter(|name| chosen.any(|it| it.object == **name)) {
        notes.push(format!(
            "the image of `{name}` is left out: in a file of meshes only surfaces have images"
        ));
    }
    notes.extend(model.notes.clone());
    target.write_with(|out| {
        model
            .write(format, out)
            .map(|more| notes.extend(more))
            .map_err(|error| match error {
                ExportError::Write(error) => output::WriteError::System(error),
                ExportError::Nothing { .. } | ExportError::TooLarge { .. } => {
                    output::WriteError::Content(Failure::Input {
                        message: error.to_string(),
                        hint: hint(&error),
                    })
                }
            })
    })?;
    for note in notes {
        output::print_error(&format!("note: {note}\n"));
    }
    let triangles = model.triangles(format);
    let vertices: usize = model.parts.iter().map(|part| part.vertices(format)).sum();
    let mut size = number::count(triangles, "triangle");
    if !format.has_only_triangles() {
        size = format!("{} vertices, {size}", number::grouped(vertices as u64));
    }
    output::print_error(&format!("{}: {}, {size}\n", target.name(), format.name()));
    Ok(())
}

fn file_format(arguments: &Arguments) -> Result<MeshFormat, Failure> {
    if let Some(format) = arguments.format {
        return Ok(format);
    }
    let path: &Path = &arguments.output;
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy());
    let found = extension.as_deref().and_then(MeshFormat::from_extension);
    found.ok_or_else(|| {
        let known = MeshFormat::ALL.map(|format| format!(".{}", format.extension()));
        let name = path.display();
        let (message, example) = if path.as_os_str() == "-" {
            (
                "standard output has no extension that determines a format".to_owned(),
                None,
            )
        } else {
            let message = format!("the extension of `{name}` does not determine a format");
            let file = path.file_name().map(|_| path.with_extension("glb"));
            (message, Some(file.unwrap_or_else(|| path.join("out.glb"))))
        };
        let known = known.join(", ");
        Failure::Usage {
            message,
            hint: Some(match example {
                Some(example) => format!(
                    "write to `{}`, or give `--format`; there are {known}",
                    example.display()
                ),
                None => "give `--format obj`, or another".into(),
            }),
        }
    })
}

/// Finds the objects by their names; `None` if no names are given.
fn objects(program: &LoadedProgram, names: &[String]) -> Result<Option<Vec<ObjectId>>, Failure> {
    if names.is_empty() {
        return Ok(None);
    }
    let found: Result<Vec<_>, Failure> = names.iter().map(|name| program.objects(name)).collect();
    Ok(Some(found?.concat()))
}

fn hint(error: &ExportError) -> Option<String> {
    match error {
        ExportError::Nothing { left_out, .. } if left_out.is_empty() => None,
        ExportError::Nothing { .. } => Some("OBJ, PLY and glTF hold lines and points too".into()),
        ExportError::TooLarge { .. } => {
            Some("`--object NAME` writes one object; fewer samples make it smaller".into())
        }
        ExportError::Write(_) => None,
    }
}
