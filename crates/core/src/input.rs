//! Files named by a user are read with a limit on their size. Only regular files are read.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Size limit of a table: a curve, a record, an amplitude, the path of a point [bytes].
pub const MOST_OF_TABLE: u64 = 1 << 26;

/// Size limit of a mesh, of all files that it includes, and of a grid of nodes [bytes].
pub const MOST_OF_MESH: u64 = 1 << 30;

/// Reads a file of at most `most` bytes.
///
/// # Errors
/// The file cannot be read, is too large, or is not a regular file (a folder, a device, a pipe, or a link to one of
/// them).
pub fn bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    // Checked before opening, because opening a pipe waits for a writer.
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if !kind.is_file() {
        let why = "this is no regular file but a device, a pipe or the like: copy what it gives into a file";
        return Err(io::Error::new(ErrorKind::InvalidInput, why));
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let why = format!(
            "larger than the {} that are read of such a file",
            size(most)
        );
        return Err(io::Error::new(ErrorKind::FileTooLarge, why));
    }
    Ok(bytes)
}

/// Reads a text file of at most `most` bytes.
///
/// # Errors
/// As [`bytes`], or the file is not UTF-8.
pub fn text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(bytes(path, most)?)
        .map_err(|_| io::Error::new(ErrorKind::InvalidData, "stream did not contain valid UTF-8"))
}

fn size(bytes: u64) -> String {
    match bytes >> 20 {
        0 => format!("{bytes} bytes"),
        megabytes => format!("{megabytes} MB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_binary_and_oversized_files_are_rejected() {
        let folder = std::env::temp_dir().join(format!("wythe-input-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("table.csv");
        std::fs::write(&file, "0,1\n").unwrap();
        assert_eq!(text(&file, 4).unwrap(), "0,1\n");
        let large = text(&file, 3).unwrap_err();
        assert_eq!(large.kind(), ErrorKind::FileTooLarge);
        assert!(large.to_string().contains("3 bytes"), "{large}");
        std::fs::write(&file, [0xff, 0xfe]).unwrap();
        assert_eq!(text(&file, 4).unwrap_err().kind(), ErrorKind::InvalidData);
        assert_eq!(
            bytes(&folder, 4).unwrap_err().kind(),
            ErrorKind::IsADirectory
        );
        #[cfg(unix)]
        {
            let link = folder.join("link");
            std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
            let endless = bytes(&link, 4).unwrap_err();
            assert!(endless.to_string().contains("no regular file"), "{endless}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
