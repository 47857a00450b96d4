//! Arrays of 64-bit numbers as the bench in C++ writes them and reads them back, on the same machine: no more than their bytes.

use std::path::PathBuf;

use crate::Outcome;

pub struct Folder(PathBuf);

impl Folder {
    pub fn new(path: impl Into<PathBuf>) -> Folder {
        Folder(path.into())
    }

    pub fn read(&self, name: &str) -> Outcome<Vec<f64>> {
        let path = self.0.join(name);
        let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let (numbers, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(format!("{}: {} bytes are no whole numbers", path.display(), bytes.len()).into());
        }
        Ok(numbers.iter().map(|&number| f64::from_ne_bytes(number)).collect())
    }

    pub fn write(&self, name: &str, numbers: &[f64]) -> Outcome<()> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_ne_bytes()).collect();
        Ok(std::fs::write(self.0.join(name), bytes)?)
    }
}

/// The version of a crate that this program was built with.
pub fn locked_version(name: &str) -> Outcome<&'static str> {
    let (_, behind) = include_str!("../Cargo.lock")
        .split_once(&format!("name = \"{name}\"\nversion = \""))
        .ok_or("not in the lock")?;
    Ok(behind.split('"').next().unwrap_or(""))
}
