//! Whether the last flush of an HDF5 file came to its end.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// First bytes of the file (HDF5 File Format Specification, III.A).
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";

/// A flush writes the fields first, beyond the end that the superblock names, and the superblock last:
/// if that names the length of the file, everything before it is there.
///
/// # Errors
/// The file cannot be read.
pub fn is_whole(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut head = [0; 52];
    if length < head.len() as u64 {
        return Ok(false);
    }
    file.read_exact(&mut head)?;
    // Place of the end-of-file address in the versions of the superblock.
    let at = match head[8] {
        0 => 40,
        1 => 44,
        2 | 3 => 28,
        _ => return Ok(false),
    };
    let mut end = [0; 8];
    end.copy_from_slice(&head[at..at + 8]);
    Ok(head[..8] == SIGNATURE && u64::from_le_bytes(end) == length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{VtkHdfWriter, fake};

    #[test]
    fn a_file_is_whole_after_each_frame_and_not_while_one_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        for time in [1.0, 2.0, 3.0] {
            writer.append(&fake::frame(&model, time)).unwrap();
            assert!(is_whole(&path).unwrap());
        }
        let bytes = std::fs::read(&path).unwrap();
        for length in [0, 40, 1000, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..length]).unwrap();
            assert!(!is_whole(&path).unwrap(), "{length}");
        }
        let mut more = bytes;
        more.push(0);
        std::fs::write(&path, more).unwrap();
        assert!(!is_whole(&path).unwrap());
    }
}
