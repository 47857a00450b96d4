//! Files that are replaced whole, or on failure left as they were.

use crate::Result;
use crate::error::Error;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Makes the file at `path` what `write` puts out. What stood there is replaced whole or, on failure, left as it was; a link stays a
/// link to the replaced file; a device or a pipe is written to.
pub(crate) fn replace(path: &Path, write: impl Fn(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    let io_error = |e: io::Error| Error::io(path, &e);
    // A device or a pipe cannot be replaced, only written to.
    if fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        let written = File::create(path).and_then(|file| write_through(file, &write));
        return written.map_err(io_error);
    }
    // A link stays a link: its target is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (temporary, file) = create_beside(&target).map_err(io_error)?;
    let replaced = || {
        if let Ok(old) = fs::metadata(&target) {
            file.set_permissions(old.permissions())?;
        }
        write_through(file, &write)?;
        fs::rename(&temporary, &target)
    };
    replaced().map_err(|e| {
        // The first error is the one to tell.
        let _ = fs::remove_file(&temporary);
        io_error(e)
    })
}

/// Writes to `file`, as far as the disk.
fn write_through(file: File, write: impl Fn(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    out.flush()?;
    match out.get_ref().sync_all() {
        // A device need not know what syncing is.
        Err(e) if e.kind() == io::ErrorKind::InvalidInput => Ok(()),
        other => other,
    }
}

/// A new file beside `target`. Names that are taken are passed over: they are another save's, or were left by a process of this number
/// that was killed in one. File systems take names of 255 bytes: where target's leaves no room for an ending, its beginning is used.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    const MOST: u32 = 1000;
    const LONGEST: usize = 255 - ".4294967295-1000.tmp".len();
    let name = target.file_name().unwrap_or_default();
    let mut stem = name.to_owned();
    if name.len() > LONGEST {
        let text = name.to_string_lossy();
        let cut = text.char_indices().take_while(|(i, c)| i + c.len_utf8() <= LONGEST).map(|(_, c)| c);
        stem = cut.collect::<String>().into();
    }
    let mut number = 0;
    loop {
        let mut name = stem.clone();
        name.push(format!(".{}-{number}.tmp", std::process::id()));
        let path = target.with_file_name(name);
        match File::options().write(true).create_new(true).open(&path) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && number < MOST => number += 1,
            made => return made.map(|file| (path, file)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("keepout-replace-{}-{name}", std::process::id()));
        fs::create_dir_all(&dir).unwrap();
        dir
    }

    #[test]
    fn a_failure_leaves_what_stood_there_and_nothing_else() {
        let dir = folder("failure");
        let path = dir.join("x");
        fs::write(&path, "old").unwrap();
        let failed = replace(&path, |out| {
            out.write_all(b"half of the ne")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(matches!(failed, Err(Error::Io { message, .. }) if message.contains("full")));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        replace(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        fs::remove_dir_all(dir).unwrap();
    }

    #[test]
    fn what_a_killed_save_left_is_in_nobodys_way() {
        let dir = folder("killed");
        let path = dir.join("x");
        let (left, _) = create_beside(&path).unwrap();
        replace(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(left.exists() && fs::read_dir(&dir).unwrap().count() == 2);
        fs::remove_dir_all(dir).unwrap();
    }

    #[test]
    fn names_may_be_as_long_as_the_file_system_takes() {
        let dir = folder("long");
        for name in ["x".repeat(255), "x".repeat(240), format!("x{}", "\u{e4}".repeat(127))] {
            let path = dir.join(name);
            for content in ["new", "newer"] {
                replace(&path, |out| out.write_all(content.as_bytes())).unwrap();
                assert_eq!(fs::read(&path).unwrap(), content.as_bytes());
            }
        }
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 3);
        fs::remove_dir_all(dir).unwrap();
    }

    #[test]
    fn a_folder_that_is_not_there_is_named() {
        let path = folder("missing").join("none").join("x");
        assert!(matches!(replace(&path, |_| Ok(())), Err(Error::Io { path: named, .. }) if named == path));
        fs::remove_dir_all(path.ancestors().nth(2).unwrap()).unwrap();
    }
}
