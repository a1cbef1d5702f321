//! `geotrace format` and `geotrace lsp` from outside.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

const UNTIDY: &str = "define   a=1 ;define b = a+1; # twice\n";
const TIDY: &str = "define a = 1;\ndefine b = a + 1; # twice\n";

/// The status, the standard output and the standard error.
fn run(folder: &Path, arguments: &[&str], input: &[u8]) -> (i32, String, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_geotrace"))
        .current_dir(folder)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    // A command that reads no input may have ended already.
    let _ = child.stdin.take().map(|mut stdin| stdin.write_all(input));
    let output = child.wait_with_output().expect("the binary ends");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (
        output.status.code().unwrap_or(-1),
        text(output.stdout),
        text(output.stderr),
    )
}

fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = TempDir::new().expect("a temporary directory");
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).expect("writing");
    }
    folder
}

fn content(folder: &TempDir, name: &str) -> String {
    std::fs::read_to_string(folder.path().join(name)).expect("the file")
}

#[test]
fn files_are_laid_out_in_place_and_silently() {
    let folder = folder(&[("a.gtr", UNTIDY.as_bytes()), ("b.gtr", TIDY.as_bytes())]);
    let before = std::fs::metadata(folder.path().join("b.gtr")).and_then(|it| it.modified());
    let printed = run(folder.path(), &["format", "a.gtr", "b.gtr"], b"");
    assert_eq!(printed, (0, String::new(), String::new()));
    assert_eq!(content(&folder, "a.gtr"), TIDY);
    assert_eq!(content(&folder, "b.gtr"), TIDY);
    // What is laid out already is not written.
    let after = std::fs::metadata(folder.path().join("b.gtr")).and_then(|it| it.modified());
    assert_eq!(before.expect("a time"), after.expect("a time"));
    let files = std::fs::read_dir(folder.path()).expect("the directory");
    assert_eq!(files.count(), 2);
}

#[test]
fn standard_input_is_laid_out_on_standard_output() {
    let folder = folder(&[]);
    let printed = run(folder.path(), &["format", "-"], UNTIDY.as_bytes());
    assert_eq!(printed, (0, TIDY.to_owned(), String::new()));
    let printed = run(folder.path(), &["format", "-"], b"");
    assert_eq!(printed, (0, String::new(), String::new()));
    let (status, out, error) = run(folder.path(), &["format", "-", "-"], b"");
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(error.contains("only once"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_not_rewritten() {
    let folder = folder(&[]);
    let pipe = folder.path().join("pipe.gtr");
    let made = std::process::Command::new("mkfifo").arg(pipe).status();
    assert!(made.expect("mkfifo runs").success());
    let (status, out, error) = run(folder.path(), &["format", "pipe.gtr"], b"");
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(error.contains("`pipe.gtr` is not a file"), "{error}");
    let standard = ["format", "/dev/stdin"];
    let (status, out, error) = run(folder.path(), &standard, UNTIDY.as_bytes());
    assert_eq!((status, out.as_str()), (2, ""));
    assert!(error.contains("help: `-` is read"), "{error}");
}

#[test]
fn a_check_names_what_is_laid_out_otherwise_and_changes_nothing() {
    let folder = folder(&[("a.gtr", UNTIDY.as_bytes()), ("b.gtr", TIDY.as_bytes())]);
    let (status, out, error) = run(folder.path(), &["format", "--check", "a.gtr", "b.gtr"], b"");
    assert_eq!((status, out.as_str()), (1, "a.gtr\n"));
    assert!(
        error.contains("1 program not in the canonical layout"),
        "{error}"
    );
    assert_eq!(content(&folder, "a.gtr"), UNTIDY);
    let printed = run(folder.path(), &["format", "--check", "b.gtr"], b"");
    assert_eq!(printed, (0, String::new(), String::new()));
    let (status, out, _) = run(
        folder.path(),
        &["format", "--check", "-"],
        UNTIDY.as_bytes(),
    );
    assert_eq!((status, out.as_str()), (1, "-\n"));
}

#[test]
fn a_program_with_errors_is_laid_out_as_far_as_it_can_be_read() {
    let folder = folder(&[]);
    let input = "define   a=1 ;define b = sinn+;\nnonsense ( here\n";
    let (status, out, error) = run(folder.path(), &["format", "-"], input.as_bytes());
    assert_eq!((status, error.as_str()), (0, ""));
    assert!(out.starts_with("define a = 1;\ndefine b = sinn"), "{out}");
    assert_eq!(
        out.split_whitespace().collect::<String>(),
        input.split_whitespace().collect::<String>()
    );
}

#[test]
fn what_cannot_be_read_is_reported_and_the_others_are_laid_out_all_the_same() {
    let latin = b"define a = 1; # \xE9\n";
    let folder = folder(&[("a.gtr", UNTIDY.as_bytes()), ("l.gtr", latin)]);
    let arguments = ["format", "l.gtr", "missing.gtr", ".", "a.gtr"];
    let (status, out, error) = run(folder.path(), &arguments, b"");
    assert_eq!((status, out.as_str()), (2, ""));
    for part in ["l.gtr", "not UTF-8", "missing.gtr", "directory"] {
        assert!(error.contains(part), "no {part} in {error}");
    }
    assert_eq!(content(&folder, "a.gtr"), TIDY);
    let bytes = std::fs::read(folder.path().join("l.gtr")).expect("the file");
    assert_eq!(bytes, latin);
}

#[test]
fn a_byte_order_mark_and_the_ends_of_lines_survive() {
    let folder = folder(&[]);
    let input = "\u{FEFF}define  a=1;\r\ndefine b=2;\r\n";
    let (status, out, _) = run(folder.path(), &["format", "-"], input.as_bytes());
    assert_eq!(status, 0);
    assert_eq!(out, "\u{FEFF}define a = 1;\r\ndefine b = 2;\r\n");
    let (_, again, _) = run(folder.path(), &["format", "-"], out.as_bytes());
    assert_eq!(again, out);
}

#[test]
fn both_commands_are_found_by_their_help() {
    let folder = folder(&[]);
    let (status, out, _) = run(folder.path(), &["--help"], b"");
    assert_eq!(status, 0);
    for command in ["format", "lsp"] {
        let named = out
            .lines()
            .any(|line| line.trim_start().starts_with(command));
        assert!(named, "no {command} in {out}");
    }
    for (command, part) in [("format", "--check"), ("lsp", "Editors start it")] {
        let (status, out, error) = run(folder.path(), &[command, "--help"], b"");
        assert_eq!((status, error.as_str()), (0, ""));
        assert!(out.contains(part), "{out}");
    }
}

#[test]
fn a_server_whose_input_ends_at_once_ends_with_1_and_says_nothing() {
    let folder = folder(&[]);
    for arguments in [&["lsp"][..], &["lsp", "--stdio"]] {
        let printed = run(folder.path(), arguments, b"");
        assert_eq!(printed, (1, String::new(), String::new()));
    }
}
