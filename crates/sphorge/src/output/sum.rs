//! SHA-256 sums of files that a run has written, by which it knows them again.

use super::folder::Folder;
use sha2::{Digest, Sha256};
use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
};

/// SHA-256 of a file.
pub(crate) type Sum = [u8; 32];

/// Bytes read at once.
const BLOCK: usize = 1 << 17;

/// The sum of all of a file.
pub(super) fn sum_of(file: &mut File) -> io::Result<Sum> {
    file.seek(SeekFrom::Start(0))?;
    let (mut sum, mut block) = (Sha256::new(), vec![0; BLOCK]);
    loop {
        match file.read(&mut block) {
            Ok(0) => return Ok(sum.finalize().into()),
            Ok(length) => sum.update(&block[..length]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// The sum of a file in a folder, of at most so many bytes; none of a longer one is read.
pub(super) fn sum_in(folder: &Folder, name: &str, most: u64) -> io::Result<Sum> {
    let mut file = folder.open_file(name)?;
    if file.metadata()?.len() > most {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    sum_of(&mut file)
}

/// Bytes in hexadecimal digits.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_sum_is_that_of_the_standard() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a"), "abc").unwrap();
        let folder = Folder::open(place.path()).unwrap();
        let sum = sum_in(&folder, "a", 3).unwrap();
        // The example of FIPS 180-4.
        assert_eq!(hexadecimal(&sum), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        assert_eq!(sum_in(&folder, "a", 2).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}
