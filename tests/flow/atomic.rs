//! Atomic writes: a file is complete or unchanged, and no temporary file is left.

use std::fs;
use std::path::Path;

use viewsphere::Error;
use viewsphere::frame::{FlowField, Image, PixelFormat, Size};
use viewsphere::io::{flo, kitti, npy, picture, write_atomic, write_bytes, write_flow};

use crate::need::{self, Without};

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn broken(path: &Path) -> viewsphere::Result<()> {
    write_atomic(path, |out| {
        // Larger than any buffer, so that a part is already on disk.
        out.write_all(&vec![7; 1 << 20]).unwrap();
        Err(Error::io(path, std::io::Error::other("the disk is full")))
    })
}

#[test]
fn a_failure_midway_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.flo");
    write_bytes(&path, b"old").unwrap();
    let text = broken(&path).unwrap_err().to_string();
    assert!(text.ends_with("the disk is full"), "{text}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.flo"]);
}

#[test]
fn a_failure_midway_makes_no_file() {
    let folder = tempfile::tempdir().unwrap();
    broken(&folder.path().join("a.flo")).unwrap_err();
    assert!(names(folder.path()).is_empty());
}

#[test]
fn the_new_file_replaces_the_old_one_whole() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write_bytes(&path, &[1; 1000]).unwrap();
    write_bytes(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(folder.path()), ["a.txt"]);
}

#[test]
fn what_nobody_writes_any_more_goes_with_the_next_file_of_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let others =
        [".a.txt.4000000000-2.tmp", ".a.txt.4000000000.tmp", ".a.txt.x-1.tmp", ".b.4000000000-1.tmp"];
    for name in others.iter().chain(&[".a.txt.4000000000-1.tmp", ".a.txt.7-0.tmp"]) {
        fs::write(folder.join(name), b"part").unwrap();
    }
    // One of them is in use.
    let held = fs::OpenOptions::new().write(true).open(folder.join(others[0])).unwrap();
    held.lock().unwrap();
    write_atomic(folder.join("a.txt"), |out| {
        // The temporary file of the file itself must not be mistaken for an abandoned one.
        write_bytes(folder.join("a.txt"), b"first").unwrap();
        out.write_all(b"second").map_err(|source| Error::io("a.txt", source))
    })
    .unwrap();
    assert_eq!(names(folder), [&others[..], &["a.txt"]].concat());
    assert_eq!(fs::read(folder.join("a.txt")).unwrap(), b"second");
}

#[test]
fn until_it_is_done_the_old_file_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    write_bytes(&path, b"old").unwrap();
    write_atomic(&path, |out| {
        out.write_all(&vec![1; 1 << 20]).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        Ok(())
    })
    .unwrap();
    assert_eq!(fs::read(&path).unwrap().len(), 1 << 20);
}

#[test]
fn a_folder_that_cannot_be_written_to_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let flow = FlowField { size: Size::new(1, 1), data: vec![[0.0; 2]] };
    let image = Image { size: Size::new(1, 1), format: PixelFormat::Gray8, data: vec![0] };
    for parent in [file, folder.path().join("missing")] {
        let at = |name| parent.join(name);
        let results = [
            write_bytes(at("a"), b"x"),
            flo::write(at("a.flo"), &flow),
            kitti::write(at("a.png"), &flow),
            npy::write(at("a.npy"), &flow),
            write_flow(at("b.flo"), &flow),
            picture::write_png(at("b.png"), &image),
        ];
        for result in results {
            let error = result.unwrap_err();
            assert!(matches!(&error, Error::Io { path, .. } if *path == parent), "{error}");
        }
    }
    assert_eq!(names(folder.path()), ["file"]);
}

#[test]
fn a_folder_in_the_place_of_the_file_is_named_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("taken");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("inside"), "").unwrap();
    let error = write_bytes(&path, b"x").unwrap_err();
    assert!(matches!(&error, Error::Io { path: p, .. } if *p == path), "{error}");
    assert_eq!(names(folder.path()), ["taken"]);
    assert!(write_bytes("/", b"x").is_err());
    assert!(write_bytes("", b"x").is_err());
}

#[test]
fn a_field_that_contradicts_itself_touches_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.flo");
    write_bytes(&path, b"old").unwrap();
    let flow = FlowField { size: Size::new(2, 2), data: vec![[0.0; 2]] };
    assert!(matches!(write_flow(&path, &flow), Err(Error::Length { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn many_writers_of_one_file_never_mix() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.bin");
    std::thread::scope(|scope| {
        for writer in 0..8_u8 {
            let path = &path;
            scope.spawn(move || {
                for _ in 0..4 {
                    write_bytes(path, &vec![writer; 50_000]).unwrap();
                }
            });
        }
    });
    let bytes = fs::read(&path).unwrap();
    assert_eq!(bytes.len(), 50_000);
    assert!(bytes.iter().all(|b| *b == bytes[0]));
    assert_eq!(names(folder.path()), ["a.bin"]);
}

#[cfg(unix)]
#[test]
fn a_link_stays_and_its_target_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_bytes(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_written_to_and_stays_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    let status = std::process::Command::new("mkfifo").arg(&pipe).status();
    let Some(status) = need::found("mkfifo", status, Without::Nothing) else { return };
    assert!(status.success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    write_bytes(&pipe, b"through").unwrap();
    assert_eq!(reader.join().unwrap(), b"through");
    assert!(!fs::metadata(&pipe).unwrap().is_file());
}
