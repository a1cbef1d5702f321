//! Files are whole or absent, and no temporary file stays.

use std::sync::atomic::{AtomicBool, Ordering};

use super::*;

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the directory");
    let name = |entry: io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry).to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_whole_and_nothing_else_is_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    fs::write(&path, b"the old picture, longer").expect("writing");
    write_whole(&path, b"new").expect("writing");
    assert_eq!(fs::read(&path).expect("reading"), b"new");
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn checking_a_target_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    check_target(&folder.path().join("a.png")).expect("a target");
    assert!(names(folder.path()).is_empty());
}

#[test]
fn what_cannot_be_made_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    fs::write(&path, b"old").expect("writing");
    let result = write_whole_with(&path, |out| {
        out.write_all(b"the first half")?;
        Err(io::Error::other("no"))
    });
    assert_eq!(result.expect_err("a failure").to_string(), "no");
    assert_eq!(fs::read(&path).expect("reading"), b"old");
    assert_eq!(names(folder.path()), ["a.obj"]);
}

#[test]
fn directories_and_missing_directories_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let message = |path: &Path| check_target(path).expect_err("refused").to_string();
    assert_eq!(message(folder.path()), "it is a directory");
    assert!(message(&folder.path().join("no/a.png")).contains("does not exist"));
    fs::write(folder.path().join("file"), b"").expect("writing");
    assert!(!message(&folder.path().join("file/a.png")).is_empty());
}

#[test]
fn a_series_appears_together_or_not_at_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let visible = || {
        let mut names = names(folder.path());
        names.retain(|name| !name.starts_with(PREFIX));
        names
    };
    let mut series = FileSeries::default();
    for number in 1..=3 {
        let path = folder.path().join(format!("{number}.png"));
        series.add(&path, &[number]).expect("writing");
        assert!(visible().is_empty());
    }
    series.finish().expect("renaming");
    assert_eq!(names(folder.path()), ["1.png", "2.png", "3.png"]);
    let mut abandoned = FileSeries::default();
    let path = folder.path().join("4.png");
    abandoned.add(&path, &[4]).expect("writing");
    drop(abandoned);
    assert_eq!(names(folder.path()), ["1.png", "2.png", "3.png"]);
}

#[test]
fn a_series_with_a_directory_in_its_way_replaces_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |number: u8| folder.path().join(format!("{number}.png"));
    fs::write(path(1), b"old").expect("writing");
    let mut series = FileSeries::default();
    for number in 1..=3 {
        series.add(&path(number), &[number]).expect("writing");
    }
    fs::create_dir(path(2)).expect("a folder");
    let (target, error) = series.finish().expect_err("a directory");
    assert_eq!(target.file_name(), path(2).file_name());
    assert_eq!(error.kind(), ErrorKind::IsADirectory);
    assert_eq!(fs::read(path(1)).expect("reading"), b"old");
    assert_eq!(names(folder.path()), ["1.png", "2.png"]);
}

#[test]
fn an_interruption_finds_no_name_of_a_series_or_all() {
    const FILES: usize = 300;
    let folder = tempfile::tempdir().expect("a folder");
    let path = |number: usize| folder.path().join(format!("{number}.png"));
    let mut series = FileSeries::default();
    for number in 0..FILES {
        series.add(&path(number), b"new").expect("writing");
    }
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let interruption = scope.spawn(|| {
            while !path(0).exists() && !is_over.load(Ordering::Relaxed) {
                std::hint::spin_loop();
            }
            // As `abandon_all` does.
            let _all = temporaries();
            (0..FILES).filter(|&number| path(number).exists()).count()
        });
        series.finish().expect("renaming");
        is_over.store(true, Ordering::Relaxed);
        let found = interruption.join().expect("it ends");
        assert_eq!(found, FILES);
    });
}

#[cfg(unix)]
#[test]
fn a_series_replaces_no_pipe_and_no_device() {
    use std::os::unix::fs::{FileTypeExt as _, symlink};

    let folder = tempfile::tempdir().expect("a folder");
    let (pipe, link) = (folder.path().join("1.png"), folder.path().join("2.png"));
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo runs").success());
    symlink(&pipe, &link).expect("a link");
    let is_pipe = || {
        fs::metadata(&link)
            .expect("it is there")
            .file_type()
            .is_fifo()
    };
    let mut series = FileSeries::default();
    for path in [&pipe, &link] {
        let error = series.add(path, b"new").expect_err("a pipe");
        assert_eq!(error.to_string(), "it is not a file");
        let create = |path: &Path| File::create_new(path);
        write_whole_created(path, create, b"new").expect_err("a pipe");
    }
    // It may come while the pictures are drawn.
    let late = folder.path().join("3.png");
    series.add(&late, b"new").expect("writing");
    fs::rename(&pipe, &late).expect("renamed");
    let (target, _) = series.finish().expect_err("a pipe");
    assert_eq!(target.file_name(), late.file_name());
    fs::rename(&late, &pipe).expect("renamed");
    assert!(is_pipe());
    assert_eq!(names(folder.path()), ["1.png", "2.png"]);
}

#[test]
fn a_new_file_replaces_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = |number| format!("{number}.txt");
    for number in 1..=3 {
        let path = write_new(folder.path(), name, &[number]).expect("written");
        assert_eq!(path, folder.path().join(format!("{number}.txt")));
    }
    for number in 1..=3 {
        let bytes = fs::read(folder.path().join(format!("{number}.txt")));
        assert_eq!(bytes.expect("there"), [number]);
    }
    assert!(write_new(&folder.path().join("none"), name, &[]).is_err());
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_keeps_pointing_to_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, link) = (folder.path().join("a.png"), folder.path().join("b.png"));
    fs::write(&file, b"old").expect("writing");
    std::os::unix::fs::symlink(&file, &link).expect("a link");
    write_whole(&link, b"new").expect("writing");
    assert_eq!(fs::read(&file).expect("reading"), b"new");
    assert!(fs::symlink_metadata(&link).expect("the link").is_symlink());
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_the_replaced_file_or_of_any_new_one() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let mode = |path: &Path| fs::metadata(path).expect("the file").permissions().mode();
    let (plain, whole) = (folder.path().join("plain"), folder.path().join("whole"));
    fs::write(&plain, b"x").expect("writing");
    write_whole(&whole, b"x").expect("writing");
    assert_eq!(mode(&plain), mode(&whole));
    fs::set_permissions(&whole, fs::Permissions::from_mode(0o640)).expect("permissions");
    write_whole(&whole, b"y").expect("writing");
    assert_eq!(mode(&whole) & 0o777, 0o640);
}

#[cfg(unix)]
#[test]
fn a_device_is_written_to_and_not_replaced() {
    use std::os::unix::fs::FileTypeExt as _;
    let device = Path::new("/dev/null");
    check_target(device).expect("a target");
    write_whole(device, b"x").expect("writing");
    let kind = fs::metadata(device).expect("the device").file_type();
    assert!(kind.is_char_device());
}

#[cfg(target_os = "linux")]
#[test]
fn an_open_file_is_written_to_and_not_replaced() {
    use std::os::fd::AsRawFd as _;

    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    let link = folder.path().join("link.png");
    let open = File::create_new(&path).expect("a file");
    let entry = format!("/proc/self/fd/{}", open.as_raw_fd());
    std::os::unix::fs::symlink(&entry, &link).expect("a link");
    for (path, text) in [(Path::new(&entry), "first, "), (&link, "second")] {
        check_target(path).expect("a target");
        write_whole(path, text.as_bytes()).expect("writing");
    }
    assert_eq!(fs::read(&path).expect("reading"), b"first, second");
    // Without a name it is still open.
    let reader = File::open(&path).expect("a file");
    fs::remove_file(&path).expect("removed");
    write_whole(Path::new(&link), b", third").expect("writing");
    let text = io::read_to_string(&reader).expect("reading");
    assert_eq!(text, "first, second, third");
    assert_eq!(names(folder.path()), ["link.png"]);
    let mut series = FileSeries::default();
    series.add(&link, b"new").expect_err("an open file");
    let read_only = format!("/proc/self/fd/{}", reader.as_raw_fd());
    check_target(Path::new(&read_only)).expect_err("a file that is read");
}

#[test]
fn system_errors_read_as_a_phrase() {
    let error = "No such file or directory (os error 2)";
    assert_eq!(phrase(error), "no such file or directory");
}

#[cfg(unix)]
#[test]
fn a_link_to_a_file_that_does_not_exist_yet_is_kept() {
    use std::os::unix::fs::symlink;

    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    symlink("below/target.obj", path("link.obj")).expect("a link");
    symlink("link.obj", path("other.obj")).expect("a link");
    let missing = check_target(&path("other.obj")).expect_err("no directory");
    assert!(missing.to_string().contains("below"), "{missing}");
    fs::create_dir(path("below")).expect("a directory");
    check_target(&path("other.obj")).expect("a target");
    write_whole(&path("other.obj"), b"new").expect("writing");
    assert_eq!(fs::read(path("below/target.obj")).expect("reading"), b"new");
    assert!(path("link.obj").is_symlink() && path("other.obj").is_symlink());
    // A link to itself ends.
    symlink("round.obj", path("round.obj")).expect("a link");
    let _ = check_target(&path("round.obj"));
}
