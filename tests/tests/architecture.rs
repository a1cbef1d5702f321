//! Holds the level table of ARCHITECTURE.md against what cargo says, and what is absent on purpose.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand};
use testing::examples::repository;
use testing::structure;

/// A row of the table.
#[derive(Debug)]
struct Row {
    level: u32,
    depends_on: BTreeSet<String>,
}

/// The rows by the crates' short names.
fn table() -> BTreeMap<String, Row> {
    let text = std::fs::read_to_string(repository().join("ARCHITECTURE.md")).expect("a map");
    let mut rows = BTreeMap::new();
    for line in text.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, level, name, _, depends_on, _] = cells[..] else {
            continue;
        };
        let (Ok(level), Some(name_end)) = (level.parse(), name.get(1..).and_then(|n| n.find('`')))
        else {
            continue;
        };
        let depends_on = depends_on
            .split([',', ';'])
            .map(|name| {
                name.split('(')
                    .next()
                    .unwrap_or(name)
                    .trim()
                    .trim_matches('`')
            })
            .filter(|name| !name.is_empty() && *name != "–")
            .map(str::to_owned)
            .collect();
        let row = Row { level, depends_on };
        rows.insert(name[1..=name_end].to_owned(), row);
    }
    assert!(rows.len() >= 7, "the table was not read: {rows:?}");
    rows
}

fn metadata() -> Metadata {
    MetadataCommand::new()
        .manifest_path(repository().join("Cargo.toml"))
        .no_deps()
        .exec()
        .expect("cargo metadata")
}

/// `geotrace-syntax` is `syntax`, `geotrace` is `cli`.
fn short(package: &str) -> String {
    match package.strip_prefix("geotrace-") {
        Some(name) => name.to_owned(),
        None if package == "geotrace" => "cli".to_owned(),
        None => package.to_owned(),
    }
}

/// Each crate's dependencies inside the workspace, but for those of some kinds.
fn internal_dependencies_but(left_out: &[DependencyKind]) -> BTreeMap<String, BTreeSet<String>> {
    let metadata = metadata();
    let crates = metadata.packages.iter().map(|package| {
        let internal = package
            .dependencies
            .iter()
            .filter(|dependency| dependency.path.is_some() && !left_out.contains(&dependency.kind))
            .map(|dependency| short(&dependency.name))
            .collect();
        (short(&package.name), internal)
    });
    crates.collect()
}

/// Each crate's dependencies inside the workspace, whatever their kind.
fn internal_dependencies() -> BTreeMap<String, BTreeSet<String>> {
    internal_dependencies_but(&[])
}

/// Outside the table: they may use every crate, and no crate may use them, but benches and fuzz.
const EXEMPT: &[&str] = &["tests", "fuzz", "benches"];

#[test]
fn every_crate_stands_in_the_table_and_every_row_is_a_crate() {
    let (table, crates) = (table(), internal_dependencies());
    for name in crates
        .keys()
        .filter(|name| !EXEMPT.contains(&name.as_str()))
    {
        assert!(table.contains_key(name), "`{name}` is not in the table");
    }
    for name in table.keys() {
        assert!(
            crates.contains_key(name),
            "`{name}` is in the table, but does not exist"
        );
    }
}

#[test]
fn arrows_point_downward_only() {
    let (table, crates) = (table(), internal_dependencies());
    for (name, dependencies) in &crates {
        for dependency in dependencies {
            assert!(
                !EXEMPT.contains(&dependency.as_str())
                    || ["benches", "fuzz"].contains(&name.as_str()),
                "`{name}` uses `{dependency}`"
            );
            if EXEMPT.contains(&name.as_str()) {
                continue;
            }
            let (from, to) = (&table[name], &table[dependency]);
            assert!(
                to.level < from.level,
                "`{name}` (level {}) uses `{dependency}` (level {})",
                from.level,
                to.level
            );
        }
    }
}

#[test]
fn the_table_lists_the_dependencies_of_each_crate() {
    let crates = internal_dependencies_but(&[DependencyKind::Development]);
    let table = table();
    for (name, row) in &table {
        assert_eq!(row.depends_on, crates[name], "the row of `{name}`");
        let below = row.depends_on.iter().map(|name| table[name].level);
        let expected = below.max().map_or(0, |most| most + 1);
        assert!(row.level >= expected, "`{name}` lies too low");
    }
}

/// Packages that belong to one place only.
const PLACES: &[(&str, &[&str])] = &[
    ("wgpu", &["render"]),
    ("naga", &["wgsl"]),
    ("egui", &["preview"]),
    ("eframe", &["preview"]),
    ("winit", &["preview"]),
    ("tower-lsp-server", &["server"]),
    ("tokio", &["server"]),
    ("clap", &["cli"]),
    ("annotate-snippets", &["cli"]),
    ("indicatif", &["cli"]),
];

#[test]
fn each_heavy_package_stays_in_its_place() {
    let mut found = BTreeSet::new();
    for package in metadata().packages {
        let name = short(&package.name);
        if EXEMPT.contains(&name.as_str()) {
            continue;
        }
        for dependency in &package.dependencies {
            if dependency.kind == DependencyKind::Development {
                continue;
            }
            let row = PLACES.iter().find(|(it, _)| *it == dependency.name);
            if let Some((guarded, places)) = row {
                found.insert(*guarded);
                assert!(
                    places.contains(&name.as_str()),
                    "`{name}` depends on `{guarded}`"
                );
            }
        }
    }
    // A row whose package has another name by now would guard nothing.
    let guarded: BTreeSet<&str> = PLACES.iter().map(|(guarded, _)| *guarded).collect();
    assert_eq!(found, guarded);
}

#[test]
fn syntax_knows_no_mathematics_and_expr_and_geodesic_know_no_syntax() {
    let crates = internal_dependencies();
    assert!(crates["syntax"].is_empty());
    assert!(crates["expr"].is_empty());
    assert!(!crates["geodesic"].contains("syntax"));
    for builtin in ["\"sinh\"", "\"acos\"", "\"tanh\""] {
        for (path, text) in code("syntax") {
            assert!(
                !text.contains(builtin),
                "{} names {builtin}",
                path.display()
            );
        }
    }
}

#[test]
fn wgpu_appears_under_render_gpu_only() {
    for (path, text) in code("render") {
        if path.iter().any(|part| part == "gpu" || part == "gpu.rs") {
            continue;
        }
        for word in ["wgpu::", "use wgpu"] {
            assert!(!text.contains(word), "{} uses wgpu", path.display());
        }
    }
}

#[test]
fn no_code_unwraps_without_a_reason() {
    // `expect` states one; `unwrap` does not.
    let mut found = Vec::new();
    for name in internal_dependencies()
        .keys()
        .filter(|name| !EXEMPT.contains(&name.as_str()))
    {
        for (path, text) in code(name) {
            let lines = text
                .lines()
                .enumerate()
                .filter(|(_, line)| line.contains(".unwrap()"));
            found.extend(lines.map(|(line, _)| format!("{}:{}", path.display(), line + 1)));
        }
    }
    assert!(found.is_empty(), "unwrap in {found:#?}");
}

/// The Rust files of a crate with their code: comments, documentation and tests become empty lines.
fn code(name: &str) -> Vec<(&'static Path, String)> {
    let files = structure::files().iter().filter(|file| file.krate == name);
    let read: Vec<_> = files
        .map(|file| {
            let lines = file.text.lines().enumerate();
            let code = lines.map(|(k, line)| match file.code.contains(&(k + 1)) {
                true => line,
                false => "",
            });
            (file.path.as_path(), code.collect::<Vec<_>>().join("\n"))
        })
        .collect();
    assert!(!read.is_empty(), "no code in `{name}`");
    read
}

#[test]
fn code_behind_a_test_item_is_read() {
    // The file begins with an import for its tests.
    let (_, text) = code("server")
        .into_iter()
        .find(|(path, _)| path.ends_with("encoding.rs"))
        .expect("a file that begins with a test item");
    assert!(!text.contains("use syntax::span::Span;"));
    assert!(text.contains("enum Encoding {"));
}
