//! Files that are read up to a limit.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Reads a regular file of at most `limit` bytes: a device or a pipe might never end.
///
/// # Errors
/// The system's error, or an error if it is not a regular file or is longer.
pub fn read_file(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    read(File::open(path)?, limit)
}

/// Reads an input of at most `limit` bytes to its end.
///
/// # Errors
/// The system's error, or an error if the input is longer.
pub fn read(input: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let sentence = format!("it is longer than {} MB", limit >> 20);
        return Err(io::Error::other(sentence));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{read, read_file};

    #[test]
    fn an_input_of_some_length_is_read() {
        assert_eq!(read(&[7; 10][..], 10).expect("ten bytes"), [7; 10]);
        let error = read(&[7; 10][..], 9).expect_err("too long");
        assert!(
            error.to_string().starts_with("it is longer than"),
            "{error}"
        );
    }

    #[test]
    fn only_regular_files_are_read() {
        let own = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
        assert!(read_file(own.as_ref(), 1 << 20).is_ok());
        assert!(read_file(env!("CARGO_MANIFEST_DIR").as_ref(), 10).is_err());
        #[cfg(unix)]
        assert!(read_file("/dev/zero".as_ref(), 10).is_err());
    }
}
