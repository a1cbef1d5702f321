//! Exported files, read back by programs that did not write them, against closed forms.

#[path = "../../render/tests/suite/scenes/mod.rs"]
mod scenes;

use std::collections::HashMap;
use std::f64::consts::PI;

use export::mesh::{ExportError, FINE_SOLIDS, Geometry, MOST_CELLS, MeshFormat, Model, model};
use glam::DVec3;
use image::{Rgba, RgbaImage};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Ply, Property};
use render::texture::{Proportions, Texture};
use scene::{ObjectId, ParamValues};
use scenes::{Wanted, scene};

const SPHERE: &str = "surface s(u,v) = 2(cosu sinv, sinu sinv, cosv), u : [0,2pi,N], v : [0,pi,N];";
const TORUS: &str =
    "surface s(u,v) = ((2+cosv)cosu, (2+cosv)sinu, sinv), u : [0,2pi,N], v : [0,2pi,N];";
const MOBIUS: &str = "surface s(u,v) = ((2+v cos(u/2))cosu, (2+v cos(u/2))sinu, v sin(u/2)), u : [0,2pi,41], v : [-0.5,0.5,11];";
const KLEIN: &str = "function w(u,v) = 3+cos(u/2)sinv-sin(u/2)sin(2v); \
    surface s(u,v) = (w(u,v)cosu, w(u,v)sinu, sin(u/2)sinv+cos(u/2)sin(2v)), u : [0,2pi,41], v : [0,2pi,40];";

fn exported(source: &str) -> Model {
    let scene = scene(source);
    let params = ParamValues::initial(&scene);
    model(&Wanted::space([1, 1]).of(&scene, &params), None)
}

fn file(model: &Model, format: MeshFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    model.write(format, &mut bytes).expect("a file");
    bytes
}

/// Places and triangles of a surface.
struct Solid {
    places: Vec<DVec3>,
    triangles: Vec<[usize; 3]>,
}

impl Solid {
    /// The objects of an OBJ file, by another program's reader.
    fn of_obj(model: &Model) -> Self {
        let bytes = file(model, MeshFormat::Obj);
        let options = tobj::LoadOptions {
            triangulate: false,
            ..tobj::LoadOptions::default()
        };
        let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, |_| {
            Ok((Vec::new(), no_materials()))
        })
        .expect("an OBJ file");
        let mesh = &models[0].mesh;
        Self {
            places: mesh.positions.chunks(3).map(DVec3::from_slice).collect(),
            triangles: mesh
                .indices
                .chunks(3)
                .map(|t| [t[0] as usize, t[1] as usize, t[2] as usize])
                .collect(),
        }
    }

    /// A binary STL file by its specification: 80 bytes, a count, records of 50 bytes. Equal places are one.
    fn of_stl(model: &Model) -> Self {
        let bytes = file(model, MeshFormat::Stl);
        let count = u32::from_le_bytes(bytes[80..84].try_into().expect("four bytes")) as usize;
        assert_eq!(bytes.len(), 84 + 50 * count);
        let mut known: HashMap<[u32; 3], usize> = HashMap::new();
        let mut solid = Self {
            places: Vec::new(),
            triangles: Vec::new(),
        };
        for record in bytes[84..].chunks(50) {
            let numbers: Vec<f32> = record[..48]
                .chunks(4)
                .map(|b| f32::from_le_bytes(b.try_into().expect("four bytes")))
                .collect();
            let corners = [3, 6, 9].map(|at| [numbers[at], numbers[at + 1], numbers[at + 2]]);
            let [a, b, c] = corners.map(|p| DVec3::from(p.map(f64::from)));
            let normal = DVec3::from([0, 1, 2].map(|k| f64::from(numbers[k])));
            let own = (b - a).cross(c - a).normalize();
            assert!(normal.dot(own) > 0.999, "{normal} is not {own}");
            solid.triangles.push(corners.map(|corner| {
                *known.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                    solid.places.push(DVec3::from(corner.map(f64::from)));
                    solid.places.len() - 1
                })
            }));
        }
        solid
    }

    fn volume(&self) -> f64 {
        let six = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|corner| self.places[corner]);
            a.dot(b.cross(c))
        };
        self.triangles.iter().map(six).sum::<f64>() / 6.0
    }

    fn area(&self) -> f64 {
        let two = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|corner| self.places[corner]);
            (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(two).sum::<f64>() / 2.0
    }

    /// How often each edge is run through in the order of its ends, and against it.
    fn edges(&self) -> HashMap<[usize; 2], [usize; 2]> {
        let mut edges: HashMap<[usize; 2], [usize; 2]> = HashMap::new();
        for t in &self.triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                assert_ne!(a, b, "a degenerate triangle");
                edges.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
            }
        }
        edges
    }

    fn is_watertight(&self) -> bool {
        self.edges().values().all(|&ways| ways == [1, 1])
    }

    /// V − E + F of what the triangles use.
    fn euler(&self) -> i64 {
        let mut used: Vec<usize> = self.triangles.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        used.len() as i64 - self.edges().len() as i64 + self.triangles.len() as i64
    }
}

/// The reader wants a table of materials, of whatever kind of map it uses.
fn no_materials<M: Default>() -> M {
    M::default()
}

/// That errors fall by a factor of four when the grid is twice as fine.
fn assert_second_order(errors: &[f64]) {
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.7..4.3).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn volume_and_area_converge_to_the_closed_forms() {
    let forms = [
        (SPHERE, 4.0 / 3.0 * PI * 8.0, 4.0 * PI * 4.0),
        (TORUS, 2.0 * PI * PI * 2.0, 4.0 * PI * PI * 2.0),
    ];
    for (source, volume, area) in forms {
        let solids = [33, 65, 129].map(|n| {
            let source = source.replace('N', &n.to_string());
            Solid::of_obj(&exported(&source))
        });
        assert_second_order(&solids.each_ref().map(|s| volume - s.volume()));
        assert_second_order(&solids.each_ref().map(|s| area - s.area()));
    }
}

#[test]
fn closed_surfaces_are_watertight_with_their_euler_characteristic() {
    for (source, euler) in [(SPHERE, 2), (TORUS, 0)] {
        let model = exported(&source.replace('N', "40"));
        for solid in [Solid::of_stl(&model), Solid::of_obj(&model)] {
            assert!(solid.is_watertight());
            assert_eq!(solid.euler(), euler);
        }
    }
}

#[test]
fn a_closed_surface_faces_outwards_whichever_way_its_parameters_run() {
    let turned = SPHERE.replace("2(cosu sinv, sinu sinv,", "2(sinu sinv, cosu sinv,");
    for source in [SPHERE.to_owned(), turned] {
        let model = exported(&source.replace('N', "21"));
        assert!(Solid::of_stl(&model).volume() > 0.0);
        let Geometry::Surface(mesh, _) = &model.parts[0].geometry else {
            panic!("a surface")
        };
        for vertex in &mesh.vertices {
            let place = DVec3::from(mesh.places[vertex.place as usize]) / 2.0;
            let off = (DVec3::from(vertex.normal.map(f64::from)) - place).length();
            assert!(off < 1e-3, "{vertex:?} at {place}");
        }
    }
}

#[test]
fn a_mobius_band_has_one_border_and_a_klein_bottle_none() {
    let mobius = Solid::of_obj(&exported(MOBIUS));
    assert_eq!(mobius.euler(), 0);
    let border: Vec<[usize; 2]> = mobius
        .edges()
        .into_iter()
        .filter_map(|(edge, ways)| (ways[0] + ways[1] == 1).then_some(edge))
        .collect();
    // Twice along u.
    assert_eq!(border.len(), 80);
    let mut beside: HashMap<usize, Vec<usize>> = HashMap::new();
    for [a, b] in &border {
        beside.entry(*a).or_default().push(*b);
        beside.entry(*b).or_default().push(*a);
    }
    let (mut last, mut at, mut steps) = (border[0][0], border[0][1], 1);
    while at != border[0][0] {
        let next = beside[&at].iter().find(|next| **next != last).copied();
        (last, at) = (at, next.expect("a loop"));
        steps += 1;
    }
    assert_eq!(steps, 80, "one loop");

    let klein = Solid::of_obj(&exported(KLEIN));
    assert_eq!(klein.euler(), 0);
    let edges = klein.edges();
    assert!(edges.values().all(|ways| ways[0] + ways[1] == 2));
    // It has no sides: somewhere triangles must disagree.
    assert!(edges.values().any(|ways| ways[0] != 1));
}

#[test]
fn what_is_large_somewhere_is_joined_only_where_its_sides_meet() {
    // The places that each has, and its Euler characteristic.
    for (source, places, euler) in [
        ("(u, v, exp(10u)), u : [0,3,31], v : [0,1,11];", 31 * 11, 1),
        ("(u, v, exp(30u)), u : [0,1,31], v : [0,1,11];", 31 * 11, 1),
        (
            "(u, v, u^8 v^8), u : [-10,10,21], v : [-10,10,31];",
            21 * 31,
            1,
        ),
        // A catenoid is a ring, and its rims are 50 apart.
        (
            "(cosv coshu, sinv coshu, u), u : [-25,25,51], v : [0,2pi,21];",
            51 * 20,
            0,
        ),
        (
            "(sinhu cosv, sinhu sinv, coshu), u : [0,23,24], v : [0,2pi,21];",
            1 + 23 * 20,
            1,
        ),
        // Its sides are near each other as seen from (1e8, 1e8, 1e8).
        (
            "(exp(10u), exp(10u) v, exp(10u)), u : [-2,2,41], v : [0,1,5];",
            41 * 5,
            1,
        ),
        // A strip that is narrow, but has an area.
        ("(u, v, 0), u : [0,1e-10,5], v : [0,1,6];", 5 * 6, 1),
        ("(u, v, 1e9 + v), u : [0,1e-10,5], v : [0,1,6];", 5 * 6, 1),
    ] {
        let model = exported(&format!("surface s(u,v) = {source}"));
        let solid = Solid::of_obj(&model);
        assert_eq!(solid.places.len(), places, "{source}");
        assert_eq!(solid.euler(), euler, "{source}");
        let edges = solid.edges();
        assert!(
            edges
                .values()
                .all(|[with, against]| *with <= 1 && *against <= 1),
            "{source}"
        );
    }
    for (source, closes) in [
        ("(t, 1/(t^2 + 0.000001)^2, 0), t : [-1,1,101];", false),
        (
            "(1e9 cost, sint, (cost)^2 + (sint)^2), t : [0,2pi,41];",
            true,
        ),
        ("(1e9 + cost, sint, t - t), t : [0,2pi,41];", true),
        ("(cos(t^5), sin(t^5), 1), t : [0,(2pi)^0.2,41];", true),
        ("(t, t^2, 0) max(0, 1 - t^2), t : [-1,1,3];", true),
    ] {
        let model = exported(&format!("curve c(t) = {source}"));
        let Geometry::Lines(lines) = &model.parts[0].geometry else {
            panic!("a curve")
        };
        let strip = &lines.strips[0];
        assert_eq!(strip.first() == strip.last(), closes, "{source}");
    }
}

#[test]
fn what_has_no_area_is_left_out() {
    for source in [
        "(u + v, u + v, u + v)",
        "((sinu)^2 + (cosu)^2, u, 3v - 3v)",
        "((sinu)^2 + (cosu)^2, u v, u v 7)",
    ] {
        let model = exported(&format!(
            "surface s(u,v) = {source}, u : [0,3,31], v : [0,1,11];"
        ));
        assert!(model.parts.is_empty(), "{source}");
        assert_eq!(model.notes, ["`s` is left out: it has no area"], "{source}");
    }
}

#[test]
fn undefined_samples_leave_a_hole_and_no_number_that_is_none() {
    let model =
        exported("surface s(u,v) = (u, v, sqrt(1-u^2-v^2)), u : [-1.5,1.5,51], v : [-1.5,1.5,51];");
    assert!(model.notes.iter().any(|note| note.contains("undefined")));
    let solid = Solid::of_obj(&model);
    assert_eq!(solid.euler(), 1, "a disc");
    for place in &solid.places {
        assert!((place.length() - 1.0).abs() < 1e-12);
    }
    let ring = exported("surface s(u,v) = (u, v, sqrt(u^2+v^2-1)), u : [-2,2,51], v : [-2,2,51];");
    assert_eq!(Solid::of_stl(&ring).euler(), 0, "a ring");
}

#[test]
fn a_cone_through_its_tip_keeps_its_two_halves() {
    let cone = "surface s(u,v) = (v cosu, v sinu, v), u : [0,2pi,30], v : [-1,1,11];";
    let solid = Solid::of_obj(&exported(cone));
    // Two discs with a common point.
    assert_eq!(solid.euler(), 1);
}

#[test]
fn places_in_ply_are_exact_and_normals_unit() {
    let model = exported(&TORUS.replace('N', "12"));
    let ply = read_ply(&file(&model, MeshFormat::Ply));
    let Geometry::Surface(mesh, _) = &model.parts[0].geometry else {
        panic!("a surface")
    };
    let vertices = &ply.payload["vertex"];
    assert_eq!(vertices.len(), 11 * 11);
    let float = |vertex: &DefaultElement, name: &str| match vertex[name] {
        Property::Float(x) => f64::from(x),
        Property::Double(x) => x,
        ref other => panic!("{other:?}"),
    };
    for (vertex, place) in vertices.iter().zip(&mesh.places) {
        assert_eq!(["x", "y", "z"].map(|axis| float(vertex, axis)), *place);
        let normal = DVec3::from(["nx", "ny", "nz"].map(|axis| float(vertex, axis)));
        let [x, y, z] = *place;
        let ring = DVec3::new(x, y, 0.0).normalize() * 2.0;
        assert!((normal - (DVec3::new(x, y, z) - ring)).length() < 1e-5);
        assert!(matches!(vertex["red"], Property::UChar(_)));
    }
    let faces = &ply.payload["face"];
    assert_eq!(faces.len(), 2 * 11 * 11);
    for face in faces {
        match &face["vertex_indices"] {
            Property::ListInt(list) => {
                assert!(list.len() == 3 && list.iter().all(|&i| (0..121).contains(&i)));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn curves_vectors_and_points_have_their_places() {
    let source = "curve c(t) = (cost, sint, 0), t : [0, 2pi, 9]; point p = (1,2,3); vector d = (0,0,2) @ p; \
        curve h(t) = (t, 1/t, 0), t : [-1, 1, 5]; grid k : [0,1,2]; point q = (k,0,0);";
    let model = exported(source);
    let names: Vec<&str> = model.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["c", "p", "d", "h", "q"]);
    let lines = |part: usize| match &model.parts[part].geometry {
        Geometry::Lines(lines) => lines.clone(),
        other => panic!("{other:?}"),
    };
    // A closed curve ends with its first place.
    assert_eq!(lines(0).places.len(), 8);
    assert_eq!(lines(0).strips, [[0, 1, 2, 3, 4, 5, 6, 7, 0]]);
    assert_eq!(lines(2).places, [[1.0, 2.0, 3.0], [1.0, 2.0, 5.0]]);
    // 1/t has no value at 0.
    assert_eq!(lines(3).strips, [[0, 1], [2, 3]]);
    let obj = String::from_utf8(file(&model, MeshFormat::Obj)).expect("text");
    let starting = |start: &str| obj.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(["o ", "l ", "p "].map(starting), [5, 4, 3]);
    let ply = read_ply(&file(&model, MeshFormat::Ply));
    assert_eq!(ply.payload["edge"].len(), 8 + 1 + 2);
    assert_eq!(ply.payload["vertex"].len(), 8 + 1 + 2 + 4 + 2);
}

fn read_ply(bytes: &[u8]) -> Ply<DefaultElement> {
    Parser::<DefaultElement>::new()
        .read_ply(&mut &bytes[..])
        .expect("a PLY file")
}

#[test]
fn gltf_is_valid_and_holds_shape_and_image() {
    let source =
        SPHERE.replace('N', "17") + "curve c(t) = (3,t,0), t : [0,1,4]; point p = (0,0,3);";
    let model = exported(&source);
    let text = file(&model, MeshFormat::Gltf);
    let binary = gltf::Gltf::from_slice(&file(&model, MeshFormat::Glb)).expect("a valid file");
    let document = gltf::Gltf::from_slice(&text).expect("a valid file");
    let blob = binary.blob.clone().expect("data");
    let uri = match document.buffers().next().expect("a buffer").source() {
        gltf::buffer::Source::Uri(uri) => uri.to_owned(),
        gltf::buffer::Source::Bin => panic!("data outside the file"),
    };
    let encoded = uri.strip_prefix("data:application/octet-stream;base64,");
    let decoded = base64::Engine::decode(
        &base64::engine::general_purpose::STANDARD,
        encoded.expect("a data URI"),
    );
    assert_eq!(decoded.expect("base64"), blob);

    let meshes: Vec<_> = binary.meshes().collect();
    let names: Vec<_> = meshes
        .iter()
        .map(|mesh| mesh.name().unwrap_or(""))
        .collect();
    assert_eq!(names, ["s", "c", "p"]);
    let sphere = meshes[0].primitives().next().expect("a primitive");
    let reader = sphere.reader(|_| Some(&blob[..]));
    let positions: Vec<[f32; 3]> = reader.read_positions().expect("positions").collect();
    let normals: Vec<[f32; 3]> = reader.read_normals().expect("normals").collect();
    let uvs: Vec<[f32; 2]> = reader.read_tex_coords(0).expect("uvs").into_f32().collect();
    // Seams keep their vertices apart: images need that. Of each pole one corner belongs to no triangle.
    assert_eq!((positions.len(), normals.len(), uvs.len()), (287, 287, 287));
    assert_eq!(
        reader.read_indices().expect("indices").into_u32().count(),
        3 * (2 * 16 * 16 - 32)
    );
    for ((place, normal), uv) in positions.iter().zip(&normals).zip(&uvs) {
        let place = DVec3::from(place.map(f64::from));
        assert!((place.length() - 2.0).abs() < 1e-6);
        assert!((place / 2.0 - DVec3::from(normal.map(f64::from))).length() < 1e-3);
        let (u, v) = (2.0 * PI * f64::from(uv[0]), PI * f64::from(uv[1]));
        let expected = 2.0 * DVec3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos());
        assert!((place - expected).length() < 1e-5);
    }
    let image = binary.images().next().expect("an image");
    let gltf::image::Source::View { view, mime_type } = image.source() else {
        panic!("an image in the file")
    };
    assert_eq!(mime_type, "image/png");
    let bytes = &blob[view.offset()..view.offset() + view.length()];
    let image = image::load_from_memory(bytes)
        .expect("an image")
        .into_rgba8();
    let texture = Texture::orientation(Proportions::Even, true);
    assert_eq!(image.as_raw(), texture.levels()[0].texels.as_flattened());
    // What is up in the scene is up there.
    let top = binary
        .default_scene()
        .and_then(|scene| scene.nodes().next())
        .expect("a node");
    let turn = top.transform().matrix();
    assert!((turn[2][1] - 1.0).abs() < 1e-6, "{turn:?}");
}

#[test]
fn a_shape_far_from_zero_keeps_its_digits_in_gltf() {
    let source = SPHERE.replace('N', "17").replace("= 2", "= (1e7,0,0) + 2");
    let model = exported(&source);
    let binary = gltf::Gltf::from_slice(&file(&model, MeshFormat::Glb)).expect("a valid file");
    let blob = binary.blob.clone().expect("data");
    let mesh = binary.meshes().next().expect("a mesh");
    let primitive = mesh.primitives().next().expect("a primitive");
    let reader = primitive.reader(|_| Some(&blob[..]));
    for place in reader.read_positions().expect("positions") {
        let length = DVec3::from(place.map(f64::from)).length();
        assert!((length - 2.0).abs() < 1e-6, "{length}");
    }
}

#[test]
fn stl_without_a_surface_is_refused_and_lines_are_reported() {
    let model = exported("curve c(t) = (t,t,t), t : [0,1];");
    let refused = model.write(MeshFormat::Stl, &mut Vec::new());
    assert!(
        matches!(refused, Err(ExportError::Nothing { ref left_out, .. }) if left_out == &["c"])
    );
    let model = exported(
        "curve c(t) = (t,t,t), t : [0,1]; surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];",
    );
    let note = model
        .write(MeshFormat::Stl, &mut Vec::new())
        .expect("a file");
    assert_eq!(
        note,
        ["STL holds surfaces and solids only: `c` is left out"]
    );
    let nothing = exported("param a : [0,1];").write(MeshFormat::Obj, &mut Vec::new());
    assert!(
        matches!(nothing, Err(ExportError::Nothing { ref left_out, .. }) if left_out.is_empty())
    );
}

#[test]
fn every_instance_is_there_and_none_is_welded_to_another() {
    let source = "grid k : [0,1,3]; surface s(u,v) = (u, v, 0k), u : [0,1,4], v : [0,1,3];";
    let solid = Solid::of_obj(&exported(source));
    assert_eq!((solid.places.len(), solid.triangles.len()), (36, 36));
}

#[test]
fn every_example_can_be_exported_in_every_format() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "gtr") {
            continue;
        }
        let model = exported(&std::fs::read_to_string(&path).expect("an example"));
        let thin = model.notes.iter().find(|note| note.contains("thinner"));
        assert_eq!(thin, None, "{path:?}");
        // A metric has no shape, and STL has no lines.
        let mut parts = model.parts.iter();
        let has_surface = parts.any(|part| matches!(part.geometry, Geometry::Surface(..)));
        for format in MeshFormat::ALL {
            let is_written = match format.has_only_triangles() {
                true => has_surface,
                false => !model.parts.is_empty(),
            };
            match model.write(format, &mut std::io::sink()) {
                Ok(_) => assert!(is_written, "{path:?} as {format:?}"),
                Err(ExportError::Nothing { .. }) => {
                    assert!(!is_written, "{path:?} as {format:?}");
                }
                Err(error) => panic!("{path:?}: {error}"),
            }
            count += 1;
        }
    }
    assert!(count >= 100, "{count} files");
}

#[test]
fn many_solids_have_fewer_cells_each_and_say_so() {
    let balls = |count: usize| {
        let each = |k| format!("solid s{k}(x,y,z) = x^2 + y^2 + (z - {k})^2 - 1;\n");
        let model = exported(&(0..count).map(each).collect::<String>());
        (model.triangles(MeshFormat::Obj), model.notes)
    };
    let (one, notes) = balls(1);
    assert_eq!(notes, [] as [&str; 0]);
    let (few, notes) = balls(FINE_SOLIDS);
    assert!(few > FINE_SOLIDS * one * 9 / 10, "{few}");
    assert_eq!(notes, [] as [&str; 0]);
    let (many, notes) = balls(4 * FINE_SOLIDS);
    assert!(
        (9 * few / 10..11 * few / 10).contains(&many),
        "{many}, not {few}"
    );
    assert_eq!(
        notes,
        [
            "each of the 128 solids has 64 cells along its longest side, not 128, unless it states counts: fewer solids in a file have more"
        ]
    );
}

const TWO_BALLS: &str = "solid a(x,y,z) = x^2+y^2+z^2-1, color : (1,0,0); \
    solid b(x,y,z) = (x-3)^2+y^2+z^2-1, color : (0,x/4,0);";

/// The places and the colours of a PLY file's vertices.
fn coloured_places(model: &Model) -> Vec<(DVec3, [u8; 3])> {
    let ply = read_ply(&file(model, MeshFormat::Ply));
    let float = |vertex: &DefaultElement, name: &str| match vertex[name] {
        Property::Double(x) => x,
        ref other => panic!("{other:?}"),
    };
    let byte = |vertex: &DefaultElement, name: &str| match vertex[name] {
        Property::UChar(byte) => byte,
        ref other => panic!("{other:?}"),
    };
    let vertices = ply.payload["vertex"].iter();
    let each = vertices.map(|vertex| {
        let place = DVec3::from(["x", "y", "z"].map(|axis| float(vertex, axis)));
        (
            place,
            ["red", "green", "blue"].map(|name| byte(vertex, name)),
        )
    });
    each.collect()
}

/// The linear light of a part of an sRGB colour, from 0 to 1.
fn linear(part: f64) -> f64 {
    if part <= 0.04045 {
        part / 12.92
    } else {
        ((part + 0.055) / 1.055).powf(2.4)
    }
}

#[test]
fn vertices_of_solids_have_the_colours_of_their_faces() {
    let model = exported(TWO_BALLS);
    assert_eq!(model.notes, [] as [&str; 0]);
    let mut greens = Vec::new();
    for (place, colour) in coloured_places(&model) {
        if place.x < 1.5 {
            assert_eq!(colour, [255, 0, 0], "{place}");
        } else {
            let [red, green, blue] = colour;
            assert_eq!([red, blue], [0, 0]);
            assert!((f64::from(green) - 255.0 * place.x / 4.0).abs() <= 1.0);
            greens.push(green);
        }
    }
    assert_eq!(greens.iter().max(), Some(&255));
    assert!(greens.iter().any(|green| *green < 130));

    // A set shows the faces of its leaves; one colour is that of the whole, of glass too.
    let set = exported(
        "solid a(x,y,z) = x^2+y^2+z^2-1, color : (1,0,0); \
        solid b(x,y,z) = (x-1)^2+y^2+z^2-1, color : (0,0,1); \
        solid s = a | b; solid g = a \\ b @ (0,0,1), color : (0.2,0.4,0.6), glass : 0.8;",
    );
    let mut counts = [0; 3];
    for (place, colour) in coloured_places(&set) {
        let kind = match colour {
            [255, 0, 0] => 0,
            [0, 0, 255] => 1,
            _ => 2,
        };
        counts[kind] += 1;
        let [of_a, of_b] = [place, place - DVec3::X].map(|from| (from.length() - 1.0).abs() < 0.01);
        match kind {
            0 => assert!(of_a, "{place}"),
            1 => assert!(of_b, "{place}"),
            _ => assert_eq!(colour, [51, 102, 153]),
        }
    }
    assert!(counts.iter().all(|count| *count > 5000), "{counts:?}");
    assert_eq!(set.parts[1].colour, [51, 102, 153]);

    // Near an edge, a cell crosses both leaves, and its vertex may lie on one of them alone.
    let holed = exported(
        "solid ball(x,y,z) = x^2+y^2+z^2-1, color : (1,0,0); \
        solid cube(x,y,z) = max(abs x, abs y, abs z) - 0.7, color : (0,0,1); \
        solid s = cube \\ ball, x : [-1, 1, 128];",
    );
    for (place, colour) in coloured_places(&holed) {
        let off_ball = (place.length() - 1.0).abs();
        let off_cube = (place.abs().max_element() - 0.7).abs();
        match colour {
            [255, 0, 0] => assert!(off_ball < 1e-3 || off_ball < off_cube, "{place}"),
            _ => assert!(off_cube < 1e-3 || off_cube < off_ball, "{place}"),
        }
    }
}

#[test]
fn an_image_of_a_solid_is_reported() {
    let scene = scene(
        "solid b(x,y,z) = x^2+y^2+z^2-1, uv : (x, y), image : im; \
        solid c(x,y,z) = x^2+y^2+z^2-1; surface s(u,v) = (u,v,0), u : [0,1], v : [0,1], image : im;",
    );
    let params = ParamValues::initial(&scene);
    let image = RgbaImage::from_pixel(4, 4, Rgba([9, 99, 199, 255]));
    let mut request = Wanted::space([1, 1]).of(&scene, &params);
    request.images = vec![("im".to_owned(), Texture::from_image(image).into())];
    let note = "the image of `b` is left out: in a file of meshes only surfaces have images";
    assert_eq!(model(&request, None).notes, [note]);
    assert_eq!(model(&request, Some(&[ObjectId::new(1)])).notes, [""; 0]);
}

#[test]
fn vertices_of_obj_have_the_colours_of_ply() {
    let model = exported(&format!(
        "{TWO_BALLS} surface s(u,v) = (u,v,-2), u : [0,1,9], v : [0,1,9]; \
         curve c(t) = (t,0,5), t : [0,1,3], color : (0.2,0.4,0.6); point p = (0,0,9), color : (1,0,1);"
    ));
    let bits = |place: DVec3| place.to_array().map(f64::to_bits);
    let expected: HashMap<[u64; 3], [u8; 3]> = coloured_places(&model)
        .into_iter()
        .map(|(place, colour)| (bits(place), colour))
        .collect();
    let bytes = file(&model, MeshFormat::Obj);
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &tobj::LoadOptions::default(), |_| {
        Ok((Vec::new(), no_materials()))
    })
    .expect("an OBJ file");
    let mut names = Vec::new();
    for tobj::Model { mesh, name } in &models {
        names.push(&**name);
        assert_eq!(mesh.vertex_color.len(), mesh.positions.len(), "{name}");
        let places = mesh.positions.chunks(3).map(DVec3::from_slice);
        for (place, colour) in places.zip(mesh.vertex_color.chunks(3)) {
            let bytes = [0, 1, 2].map(|k: usize| (255.0 * colour[k]).round() as u8);
            assert_eq!(
                expected.get(&bits(place)),
                Some(&bytes),
                "{name} at {place}"
            );
        }
    }
    assert_eq!(names, ["a", "b", "s", "c", "p"]);
}

#[test]
fn each_instance_has_the_colour_of_its_grid_value() {
    let objects = [
        "point p = (k, 0, 0)",
        "vector v = (0, 0.5, 0) @ (k, -0.25, 0)",
        "curve c(t) = (k, t, 0), t : [-0.5, 0.5, 9]",
        "surface s(u, v) = (k + u, v, 0), u : [-0.3, 0.3, 5], v : [-0.3, 0.3, 5]",
    ];
    let colours = "color : ((k(k-1))/2, 1 - k^2, (k(k+1))/2)";
    for object in objects {
        let model = exported(&format!("grid k : [-1, 1, 3]; {object}, {colours};"));
        let mut counts = [0; 3];
        for (place, colour) in coloured_places(&model) {
            let instance = (place.x.round() + 1.0) as usize;
            let expected = [[255, 0, 0], [0, 255, 0], [0, 0, 255]][instance];
            assert_eq!(colour, expected, "{object} at {place}");
            counts[instance] += 1;
        }
        assert!(
            counts.iter().all(|count| *count > 0),
            "{object}: {counts:?}"
        );
        let binary = file(&model, MeshFormat::Glb);
        let binary = gltf::Gltf::from_slice(&binary).expect("a valid file");
        let blob = binary.blob.clone().expect("data");
        let mesh = binary.meshes().next().expect("a mesh");
        let primitive = mesh.primitives().next().expect("a primitive");
        let base = primitive
            .material()
            .pbr_metallic_roughness()
            .base_color_factor();
        assert_eq!(base, [1.0; 4]);
        let reader = primitive.reader(|_| Some(&blob[..]));
        let colours = reader.read_colors(0).expect("colours").into_rgb_f32();
        for (colour, [x, _, _]) in colours.zip(reader.read_positions().expect("positions")) {
            assert_eq!(colour[(x.round() + 1.0) as usize], 1.0, "{object} at {x}");
        }
    }
}

#[test]
fn images_of_gltf_end_at_sides_that_are_not_glued() {
    let text = "surface square(u,v) = (u, v, 0), u : [0,1,3], v : [0,1,3];".to_owned();
    let binary = file(
        &exported(&(text + &SPHERE.replace('N', "9"))),
        MeshFormat::Glb,
    );
    let binary = gltf::Gltf::from_slice(&binary).expect("a valid file");
    use gltf::texture::WrappingMode::{ClampToEdge, Repeat};
    let found: Vec<_> = binary
        .textures()
        .map(|it| [it.sampler().wrap_s(), it.sampler().wrap_t()])
        .collect();
    assert_eq!(found, [[ClampToEdge; 2], [Repeat, ClampToEdge]]);
}

#[test]
fn gltf_has_the_curvature_of_each_instance_in_its_own_colours() {
    let scene = scene(
        "grid k : [1, 3, 3];
        surface s(u, v) = (10k, 0, 0) + k (cosu cosv, sinu cosv, sinv), u : [-pi, pi, 9], v : [-pi/2, pi/2, 9],
            color : (0.9, 0.1, 0.1);",
    );
    let params = ParamValues::initial(&scene);
    let mut request = Wanted::space([1, 1]).of(&scene, &params);
    request.curved = vec![ObjectId::new(0)];
    let model = model(&request, None);
    assert_eq!(model.parts.len(), 3);
    let binary = file(&model, MeshFormat::Glb);
    let binary = gltf::Gltf::from_slice(&binary).expect("a valid file");
    assert_eq!((binary.meshes().count(), binary.images().count()), (3, 3));
    for material in binary.materials() {
        let base = material.pbr_metallic_roughness().base_color_factor();
        assert_eq!(base, [1.0; 4]);
    }
    // The share of green in red falls as the curvature grows.
    let mut greens = [0; 3];
    for (place, [_, green, _]) in coloured_places(&model) {
        greens[(place.x / 10.0).round() as usize - 1] = green;
    }
    assert!(
        greens.is_sorted() && greens[0] + 30 < greens[2],
        "{greens:?}"
    );
}

#[test]
fn gltf_has_the_colour_of_a_solid_or_those_of_its_vertices() {
    let binary = file(&exported(TWO_BALLS), MeshFormat::Glb);
    let binary = gltf::Gltf::from_slice(&binary).expect("a valid file");
    let blob = binary.blob.clone().expect("data");
    let primitives = binary
        .meshes()
        .map(|mesh| mesh.primitives().next().expect("a primitive"));
    let [a, b] = primitives
        .collect::<Vec<_>>()
        .try_into()
        .expect("two meshes");
    let base = |of: &gltf::Primitive<'_>| {
        let material = of.material();
        material.pbr_metallic_roughness().base_color_factor()
    };
    assert_eq!(base(&a), [1.0, 0.0, 0.0, 1.0]);
    assert!(a.get(&gltf::Semantic::Colors(0)).is_none());
    assert_eq!(base(&b), [1.0; 4]);
    let reader = b.reader(|_| Some(&blob[..]));
    let colours = reader.read_colors(0).expect("colours").into_rgb_f32();
    let positions = reader.read_positions().expect("positions");
    assert_eq!(colours.len(), positions.len());
    for ([red, green, blue], [x, _, _]) in colours.zip(positions) {
        assert_eq!([red, blue], [0.0; 2]);
        let expected = linear(f64::from(x) / 4.0);
        assert!(
            (f64::from(green) - expected).abs() < 0.01,
            "{green} at {x}, not {expected}"
        );
    }
}

#[test]
fn counts_of_intervals_say_how_fine_a_solid_is() {
    let ball = |intervals: &str| {
        let source = format!("solid b(x,y,z) = x^2+y^2+z^2-1{intervals};");
        let model = exported(&source);
        assert_eq!(model.notes, [] as [&str; 0]);
        let solid = Solid::of_obj(&model);
        assert!(solid.is_watertight());
        assert_eq!(solid.euler(), 2);
        solid
    };
    let usual = ball("").triangles.len();
    assert_eq!(ball(", x : [-1.1,1.1]").triangles.len(), usual);
    let sizes = [20, 40, 80, 160].map(|n| {
        let fine = format!(", x : [-1.1,1.1,{n}]");
        let same = format!("{fine}, z : [-1.1,1.1,{}]", n / 2);
        let solid = ball(&fine);
        assert_eq!(
            ball(&same).places,
            solid.places,
            "the smallest cell is taken"
        );
        let cell = 2.2 / f64::from(n);
        for triangle in &solid.triangles {
            let [a, b] = [triangle[0], triangle[1]].map(|corner| solid.places[corner]);
            // The vertices of neighbouring cells.
            assert!((a - b).abs().max_element() < 2.0 * cell + 1e-9);
        }
        solid.triangles.len()
    });
    for pair in sizes.windows(2) {
        let ratio = pair[1] as f64 / pair[0] as f64;
        assert!((3.5..4.5).contains(&ratio), "{sizes:?}");
    }
    assert!(sizes[2] < usual && usual < sizes[3]);

    // A part's cells are scaled with it.
    let part = "solid p(x,y,z) = x^2+y^2+z^2-1, x : [-1.1,1.1,40]; solid s = p @ scale 3;";
    assert_eq!(Solid::of_obj(&exported(part)).triangles.len(), sizes[1]);
    let set = "solid p(x,y,z) = x^2+y^2+z^2-1; solid s = p, x : [-1.1,1.1,40], y : [-1.1,1.1];";
    assert_eq!(Solid::of_obj(&exported(set)).triangles.len(), sizes[1]);
}

#[test]
fn an_endless_solid_is_reported_with_the_intervals_that_it_needs() {
    for (source, along, cut) in [
        (
            "solid p(x,y) = x^2+y^2-1;",
            "z",
            "`z : [-3, 3]`, which needs the parameter z: `solid p(x, y, z)`",
        ),
        (
            "solid p(x,y,z) = y^2+z^2-1, y : [-0.5, 0.5];",
            "x",
            "`x : [-3, 3]`",
        ),
        ("solid p(x,y,z) = x^2+y^2-1;", "z", "`z : [-3, 3]`"),
        (
            "solid p(a,b,c) = c^2-1;",
            "a and b",
            "`a : [-3, 3], b : [-3, 3]`",
        ),
        (
            "solid p(y,z) = y, z : [0, 1];",
            "y and x",
            "`y : [-3, 3], x : [-3, 3]`, which needs the parameter x: `solid p(y, z, x)`",
        ),
        (
            "solid part(a,b,c) = a^2+b^2-1; solid p = part;",
            "z",
            "`z : [-3, 3]`",
        ),
        (
            "function f(x,y) = x^2+y^2-1; solid p = f \\ f @ scale 0.5;",
            "z",
            "`z : [-3, 3]`",
        ),
        (
            "solid p(x,y) = x, y : [0, 1];",
            "x and z",
            "`x : [-3, 3], z : [-3, 3]`, which needs the parameter z: `solid p(x, y, z)`",
        ),
    ] {
        let note = format!(
            "`p` has no mesh, because it may be unbounded: no bound was found along {along}; cut it by {cut}"
        );
        assert_eq!(exported(source).notes, [note], "{source}");
    }
    // What the notes advise.
    for cut in [
        "solid p(x,y,z) = x^2+y^2-1, z : [-3, 3];",
        "function f(x,y) = x^2+y^2-1; solid p = f \\ f @ scale 0.5, z : [-3, 3];",
        "solid p(x,y,z) = x, x : [-3, 3], y : [0, 1], z : [-3, 3];",
        "solid p(a,b,c) = c^2-1, a : [-3, 3], b : [-3, 3];",
        "solid p(y,z,x) = y, z : [0, 1], y : [-3, 3], x : [-3, 3];",
    ] {
        assert!(Solid::of_obj(&exported(cut)).is_watertight(), "{cut}");
    }
}

#[test]
fn a_count_that_is_too_large_is_reported() {
    let bar = |count: u32| {
        let source = format!("solid b(x,y,z) = max(abs y, abs z) - 0.005, x : [0, 1, {count}];");
        let model = exported(&source);
        (Solid::of_obj(&model).triangles.len(), model.notes)
    };
    let (most, notes) = bar(MOST_CELLS);
    assert_eq!(notes, [] as [&str; 0]);
    assert_eq!(
        bar(4000),
        (
            most,
            vec![
                "`b` is meshed with 512 cells along its longest side, the maximum: its counts request 4000"
                    .to_owned()
            ]
        )
    );
}

#[test]
fn what_is_thinner_than_a_cell_is_reported() {
    let plate = "solid plate(x,y,z) = max(abs x - 5, abs y - 5, abs z - 0.02); \
        solid hole(x,y) = x^2+y^2-0.09; solid s = plate \\ hole @ (1,0,0)";
    let model = exported(&format!("{plate};"));
    let note = "`s` has no mesh: it is thinner than a cell of 0.078 everywhere; make the cells smaller by counts: `x : [-5.1, 5.1, 512]`";
    assert_eq!(model.notes, [note]);
    let error = model
        .write(MeshFormat::Obj, &mut Vec::new())
        .expect_err("nothing");
    assert_eq!(
        error.to_string(),
        format!("there is nothing to export: {note}")
    );
    // Smaller cells help.
    let model = exported(&format!("{plate}, x : [-5.1, 5.1, 300];"));
    assert_eq!(model.notes, [] as [&str; 0]);
    let solid = Solid::of_obj(&model);
    assert!(solid.is_watertight());
    assert_eq!(solid.euler(), 0, "a plate with a hole");
    let volume = 0.04 * (100.0 - PI * 0.09);
    assert!((solid.volume() / volume - 1.0).abs() < 1e-3);

    // Counts cannot help.
    for point in [
        "solid p(x,y,z) = (x-3)^2+y^2+z^2;",
        "solid p(x,y,z) = x^2+y^2+z^2, z : [-0.5,0.5];",
        "solid ball(x,y,z) = x^2+y^2+z^2, z : [-0.5,0.5]; solid p = ball @ (300,0,0);",
    ] {
        let notes = exported(point).notes;
        let start = "`p` has no mesh: it is empty, or smaller than ";
        let size = notes[0].strip_prefix(start).map(str::parse::<f64>);
        assert!(size.is_some_and(|size| size.is_ok()), "{notes:?}");
    }
    let named = exported("solid p(a,b,c) = max(abs a - 5, abs b - 4, abs c - 0.02);");
    let note = "`p` has no mesh: it is thinner than a cell of 0.078 everywhere; make the cells smaller by counts: `a : [-5.1, 5.1, 512]`";
    assert_eq!(named.notes, [note]);

    let empty = exported("solid none(x,y,z) = x^2+y^2+z^2+1, x : [0,1], y : [0,1], z : [0,1];");
    assert!(empty.notes[0].starts_with("`none` has no mesh: it is empty"));
    let unknown = exported("solid star(x,y,z) = x^(2/3) + y^(2/3) + z^(2/3) - 1;");
    let note = "`star` has no mesh, because it may be unbounded: no bound was found along x, y and z; \
                cut it by `x : [-3, 3], y : [-3, 3], z : [-3, 3]`";
    assert_eq!(unknown.notes, [note]);

    for (source, is_partly_thin) in [
        // A brim, a shell, and a plate that no axis is normal to.
        ("solid t = ball | brim", true),
        ("solid t(x,y,z) = abs(x^2+y^2+z^2-1) - 0.005", true),
        ("solid t = plate @ rotate (0.5,0.7,0)", true),
        // Shells of which the lines that meet them obliquely find corners.
        ("solid t = ball \\ ball @ scale 0.99", true),
        ("solid t(x,y,z) = abs(sqrt(x^2+y^2+z^2) - 1) - 0.004", true),
        ("solid t = ball", false),
        (
            "solid t = ball @ scale (3,1,1) @ rotate (0.3,0.4,0.5)",
            false,
        ),
        ("solid t = cube", false),
        ("solid t = cube @ rotate (0,0,pi/4)", false),
        ("solid t = cube @ rotate (0.3,0.4,0.5)", false),
        ("solid t = cube \\ ball @ scale 1.2", false),
        ("solid t(x,y,z) = x^2+y^2-1, z : [-1,1]", false),
        ("solid t(x,y,z) = x^2+y^2-z^2, z : [-1,1]", false),
        ("solid t(x,y,z) = (sqrt(x^2+y^2)-2)^2+z^2-1/4", false),
        (
            "solid t = ball & ball @ (1,0,0) & ball @ (0.4,0.3,0.8)",
            false,
        ),
        ("solid t(x,y,z) = abs x + abs y + abs z - 1", false),
        // Rods that are three cells thick.
        ("solid t = rod", false),
        ("solid t = rod @ rotate (0.3,0.4,0.5)", false),
    ] {
        let source = format!(
            "function brim(x,y,z) = max(x^2+y^2-9, abs z - 0.01); \
            function plate(x,y,z) = max(abs x - 5, abs y - 5, abs z - 0.02); \
            function ball(x,y,z) = x^2+y^2+z^2-1; \
            function cube(x,y,z) = max(abs x, abs y, abs z) - 1; \
            function rod(x,y,z) = max(x^2+y^2-0.005, abs z - 3); {source};"
        );
        let model = exported(&source);
        assert!(model.triangles(MeshFormat::Stl) > 0, "{source}");
        let notes = &model.notes;
        let note = "parts of `t` are thinner than a cell (0.";
        assert!(
            notes.iter().all(|it| it.starts_with(note)),
            "{source}: {notes:?}"
        );
        assert_eq!(notes.len(), usize::from(is_partly_thin), "{source}");
    }
}

#[test]
fn what_single_precision_does_not_hold_is_left_open() {
    let lines = |source: &str| {
        let model = exported(source);
        let lines = model.parts.iter().map(|part| match &part.geometry {
            Geometry::Lines(lines) => lines.places.len(),
            Geometry::Points(places) => places.len(),
            Geometry::Surface(mesh, _) => mesh.places.len(),
        });
        lines.sum::<usize>()
    };
    let near = "point p = (0, 0, 1); ";
    assert_eq!(
        lines(&format!(
            "{near}curve c(t) = (1e39 t, t, 0), t : [0, 1, 3];"
        )),
        1
    );
    assert_eq!(lines(&format!("{near}point far = (1e39, 0, 0);")), 1);
    assert_eq!(
        lines(&format!("{near}vector v = (1e39, 0, 0) @ (0, 0, 0);")),
        1
    );
    let model = exported(&format!(
        "{near}solid b(x, y, z) = (x - 1e39)^2 + y^2 + z^2 - 1e76;"
    ));
    assert!(
        model
            .notes
            .iter()
            .any(|note| note.contains("single precision")),
        "{:?}",
        model.notes
    );
}

#[test]
fn a_closed_surface_has_the_image_that_is_read_from_outside() {
    // σu×σv points inwards on the first, and outwards on the second.
    let image = |source: &str| match &exported(&source.replace('N', "20")).parts[0].geometry {
        Geometry::Surface(_, image) => image.texture.levels()[0].texels.clone(),
        _ => panic!("a surface"),
    };
    let inwards = image(SPHERE);
    let outwards =
        image("surface s(u,v) = (cosv sinu, sinv sinu, cosu), u : [0,pi,N], v : [0,2pi,N];");
    assert!(inwards == Texture::orientation(Proportions::Even, true).levels()[0].texels);
    assert!(outwards == Texture::orientation(Proportions::Even, false).levels()[0].texels);
}

#[test]
fn vertices_have_the_colours_of_a_square_image() {
    let scene = scene("surface s(u, v) = (u, v, 0), u : [0, 1, 21], v : [0, 1, 21];");
    let params = ParamValues::initial(&scene);
    let colour = |right: bool, below: bool| [255 * u8::from(right), 255 * u8::from(below), 99, 255];
    let image = RgbaImage::from_fn(512, 512, |x, y| Rgba(colour(x >= 256, y >= 256)));
    let mut request = Wanted::space([1, 1]).of(&scene, &params);
    request.textures = vec![(ObjectId::new(0), Texture::from_image(image).into())];
    let mut count = 0;
    for (place, found) in coloured_places(&model(&request, None)) {
        let [u, v, _] = place.to_array();
        // Colours are averaged over the distance to the next vertex.
        let is_inside = |x: f64| (0.06..0.44).contains(&(x % 0.5));
        if is_inside(u) && is_inside(v) {
            let [r, g, b, _] = colour(u > 0.5, v > 0.5);
            assert_eq!(found, [r, g, b], "({u}, {v})");
            count += 1;
        }
    }
    assert_eq!(count, 14 * 14);
}

#[test]
fn a_colour_that_depends_on_the_place_is_that_of_the_vertices() {
    let torus = "surface s(u,v) = ((3+cosv)cosu, (3+cosv)sinu, sinv), u : [0,2pi,61], v : [0,2pi,41], \
        color : ((1+cosu)/2, 0, 0);";
    let model = exported(torus);
    for (place, found) in coloured_places(&model) {
        let [x, y, _] = place.to_array();
        let cosine = x / x.hypot(y);
        let red = 255.0 * 0.5 * (1.0 + cosine);
        let off = f64::from(found[0]) - red;
        assert!(
            off.abs() < 0.51 && found[1..] == [0, 0],
            "{found:?} at {place}"
        );
    }
    let Geometry::Surface(_, image) = &model.parts[0].geometry else {
        panic!("a surface")
    };
    assert!(
        image.texture.levels()[0]
            .texels
            .iter()
            .all(|texel| texel[1..3] == [0, 0])
    );
}

#[test]
fn colours_of_coarse_surfaces_are_those_of_their_samples() {
    let reds = |surface: &str| -> Vec<u8> {
        let model = exported(&format!("surface s(u,v) = {surface}"));
        let colours = coloured_places(&model).into_iter();
        colours.map(|(_, [red, ..])| red).collect()
    };
    let ramp = [0, 64, 128, 191, 255];
    let flat = reds("(u, v, 0), u : [0,1,5], v : [0,1,5], color : (u, 0, 0);");
    assert_eq!(flat, ramp.repeat(5));
    // Where a surface meets itself, a point has the colour of the first sample.
    let tube = reds("(cosu, sinu, v), u : [0,2pi,5], v : [0,1,3], color : (u/(2pi), 0, 0);");
    assert_eq!(tube, ramp[..4].repeat(3));
    let fine = reds("(u, v, 0), u : [0,1,11], v : [0,1,3], color : ((1 + cos(20pi u))/2, 0, 0);");
    assert_eq!(fine, [255; 33]);
    let two = exported(
        "grid k : [1, 2, 2]; \
        surface s(u,v) = (u, v, k), u : [0,1,3], v : [0,1,2], color : (u/k, 0, 0);",
    );
    let colours = coloured_places(&two).into_iter();
    let reds: Vec<u8> = colours.map(|(_, [red, ..])| red).collect();
    assert_eq!(
        reds,
        [[0, 128, 255].repeat(2), [0, 64, 128].repeat(2)].concat()
    );
}

#[test]
fn triangles_without_an_area_in_single_precision_are_reported() {
    let tiny = exported(
        "surface s(u,v) = (cosu cosv, sinu cosv, sinv) 1e-46, u : [-pi,pi,9], v : [-pi/2,pi/2,9];",
    );
    let triangles = tiny.triangles(MeshFormat::Obj);
    assert_eq!(triangles, 8 * 7 * 2);
    assert_eq!(tiny.triangles(MeshFormat::Stl), 0);
    let error = tiny.write(MeshFormat::Stl, &mut Vec::new());
    let Err(error @ ExportError::Nothing { .. }) = error else {
        panic!("{error:?}")
    };
    let note = format!("{triangles} of the {triangles} triangles of `s` are left out: STL has");
    assert!(error.to_string().contains(&note), "{error}");
    let notes = tiny
        .write(MeshFormat::Glb, &mut Vec::new())
        .expect("a file");
    assert!(notes[0].contains("have no area: glTF has"), "{notes:?}");

    // Far from zero STL has no digits for the shape; glTF shifts it.
    let ball = |place: &str| {
        exported(&format!(
            "surface s(u,v) = {place} + 200 (cosu cosv, sinu cosv, sinv), u : [-pi,pi,41], v : [-pi/2,pi/2,41];"
        ))
    };
    for place in ["(1e9, 0, 0)", "(1e9, 1e9, 1e9)"] {
        let far = ball(place);
        let mut bytes = Vec::new();
        let notes = far.write(MeshFormat::Stl, &mut bytes).expect("a file");
        assert_eq!(notes.len(), 1, "{notes:?}");
        let count = u32::from_le_bytes(bytes[80..84].try_into().expect("four bytes"));
        assert_eq!(far.triangles(MeshFormat::Stl), count as usize);
        let lost = 40 * 39 * 2 - count;
        let note = match lost {
            0 => "the shape of `s` is rounded roughly: STL".to_owned(),
            lost => format!("{lost} of the 3120 triangles of `s` are left out: STL"),
        };
        assert!(notes[0].starts_with(&note), "{notes:?}");
        assert_eq!(lost > 0, place == "(1e9, 1e9, 1e9)");
        let notes = far.write(MeshFormat::Glb, &mut Vec::new()).expect("a file");
        assert_eq!(notes, [] as [&str; 0]);
    }
}

#[test]
fn lines_and_points_that_single_precision_rounds_roughly_are_reported() {
    let far = exported(
        "point o = (0, 0, 0); curve c(t) = (1e7, 1e7 + 0.001cos t, 0.001sin t), t : [0, 2pi]; \
        vector v = (0.01, 0, 0) @ (1e7, 0, 0); curve fine(t) = (1e7 + 100t, t, 0), t : [0, 1e4];",
    );
    let notes = far.write(MeshFormat::Glb, &mut Vec::new()).expect("a file");
    let rough = |name: &str| format!("the shape of `{name}` is rounded roughly: glTF");
    assert_eq!(notes.len(), 2, "{notes:?}");
    for (note, name) in notes.iter().zip(["c", "v"]) {
        assert!(note.starts_with(&rough(name)), "{notes:?}");
    }
    let notes = far.write(MeshFormat::Obj, &mut Vec::new()).expect("a file");
    assert_eq!(notes, [] as [&str; 0]);
}

#[test]
fn vectors_without_a_length_are_left_out_and_reported() {
    let model = exported(
        "grid k : [0, 2, 3]; vector v = (k, 0, 0) @ (k, 1, 0); vector z = (0, 0, 0) @ (0.5, 0, 0);",
    );
    let names: Vec<&str> = model.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["v"]);
    assert_eq!(
        model.notes,
        [
            "1 of the 3 vectors of `v` are left out: they have no length",
            "`z` is left out: it has no length",
        ]
    );
    let obj = String::from_utf8(file(&model, MeshFormat::Obj)).expect("text");
    assert_eq!(obj.lines().filter(|line| line.starts_with("l ")).count(), 2);
}

#[test]
fn what_is_left_out_of_a_mesh_is_reported() {
    let model = exported(
        "surface s(u,v) = (1e39u, v, 0), u : [1, 2, 11], v : [0, 1, 3]; \
        curve c(t) = (t 1e39, 0, 0), t : [-1, 1, 11]; \
        vector big = (1e300, 0, 0) @ (0, 0, 0); point p = (1e39, 0, 0); surface line(u, v) = (u, u, u), \
        u : [0, 1, 3], v : [0, 1, 3]; point q = (0, 0, 0);",
    );
    let assert_noted = |start: &str| {
        let notes = model.notes.iter();
        let found = notes.filter(|note| note.starts_with(start)).count();
        assert_eq!(found, 1, "{start}: {:?}", model.notes);
    };
    assert_noted("`s` is left out: mesh files have single precision");
    assert_noted("8 of the 11 points of `c` are left out: ");
    assert_noted("`big` is left out: mesh files");
    assert_noted("`p` is left out: mesh files");
    assert_noted("`line` is left out: it has no area");
    assert_eq!(model.notes.len(), 5, "{:?}", model.notes);
}

#[test]
fn closed_surfaces_of_any_size_face_outwards() {
    for size in ["1e-30", "1e-115", "1e-170"] {
        let model = exported(&format!(
            "surface s(u,v) = (cosu cosv, sinu cosv, -sinv) {size}, u : [-pi,pi,9], v : [-pi/2,pi/2,9];"
        ));
        let Geometry::Surface(mesh, _) = &model.parts[0].geometry else {
            panic!("a surface")
        };
        assert_eq!(mesh.triangles.len(), 8 * 7 * 2, "{size}");
        let scale: f64 = size.parse().expect("a number");
        for triangle in &mesh.triangles {
            for corner in triangle {
                let vertex = &mesh.vertices[*corner as usize];
                let place = DVec3::from(mesh.places[vertex.place as usize]) / scale;
                let normal = DVec3::from(vertex.normal.map(f64::from));
                assert!(normal.dot(place) > 0.9, "{size}: {normal} at {place}");
            }
            let [a, b, c] = mesh
                .corners(*triangle)
                .map(|place| DVec3::from(place) / scale);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0, "{size}");
        }
    }
}

#[test]
fn notes_about_thin_solids_have_short_numbers() {
    let model = exported("solid t(x,y,z) = max(abs x - 1e-60, abs y - 1e-60, abs z - 1e-63);");
    let notes = &model.notes;
    assert!(notes[0].contains("e-"), "{notes:?}");
    assert!(
        notes.iter().all(|note| !note.contains("0.0000000")),
        "{notes:?}"
    );
}
