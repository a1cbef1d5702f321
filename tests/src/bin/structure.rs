//! Prints the structure of the code: `cargo run -p geotrace-tests --bin structure`.

use testing::structure::{self, limits};

fn main() {
    let files = structure::files();
    println!("lines of code, without comments and tests");
    let lines = structure::lines(files);
    for (krate, count) in &lines {
        println!("  {krate:<10} {count:>7}");
    }
    println!("  {:<10} {:>7}", "all", lines.values().sum::<usize>());
    println!("top-level modules that import each other");
    for (krate, groups) in structure::cycles(files) {
        for group in groups {
            let names: Vec<String> = group.into_iter().collect();
            println!("  {krate}: {} of them: {}", names.len(), names.join(" "));
        }
    }
    for limit in limits(files) {
        println!(
            "{}: {} (at most {})",
            limit.what,
            limit.files.len(),
            limit.most
        );
        for path in &limit.files {
            println!("  {}", path.display());
        }
    }
    println!("type names that are declared three times or more");
    for (name, places) in structure::types(files) {
        if places.len() > 2 {
            println!("  {name} ×{}: {}", places.len(), places.join(" "));
        }
    }
}
