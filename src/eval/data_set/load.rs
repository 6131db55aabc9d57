//! Reads the files of a pair.

use std::path::Path;

use super::PairFiles;
use crate::error::{Error, Result};
use crate::eval::GroundTruth;
use crate::eval::texture::gray_levels;
use crate::frame::{FlowField, Image, Size, UNKNOWN_FLOW};
use crate::io::{npy, picture, read_flow};

/// A pair of frames with its ground truth.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedPair {
    /// The two frames, of one size and pixel format.
    pub frames: [Image; 2],
    /// The ground truth, of their size.
    pub truth: GroundTruth,
}

impl PairFiles {
    /// Reads the pair.
    ///
    /// # Errors
    /// [`Error::Format`] for a frame that is missing, a file whose size or pixel format differs from the first frame's, and as in
    /// [`picture::read`], [`read_flow`] and [`npy::read_plane`]; [`Error::Io`].
    pub fn load(&self) -> Result<LoadedPair> {
        for (path, which) in self.frames.iter().zip(["first", "second"]) {
            if !path.is_file() {
                let expected = format!("the {which} frame of the pair {}", self.name);
                return Err(Error::format(path, "image", "missing", expected));
            }
        }
        let [one, two] = &self.frames;
        let frames = picture::read_pair(one, two)?;
        let size = frames[0].size;
        let same = |path: &Path, found: Size| match found == size {
            true => Ok(()),
            false => Err(Error::format(path, "size", found, format_args!("{size} as in {}", one.display()))),
        };
        let field = |path: &Path| -> Result<FlowField> {
            let flow = read_flow(path)?;
            same(path, flow.size).map(|()| flow)
        };
        let white = |path: &Path| -> Result<Vec<bool>> {
            let image = picture::read(path)?;
            same(path, image.size)?;
            Ok(gray_levels(&image.frame()?).into_iter().map(|gray| gray > 127.5).collect())
        };
        let mut flow = field(&self.flow)?;
        let seen = self.visible_flow.as_deref().map(field).transpose()?;
        let by_flow = seen.map(|seen| seen.data.iter().map(|&uv| !FlowField::is_known(uv)).collect());
        let by_image = self.occlusions.as_deref().map(white).transpose()?;
        for (path, unusable) in [(&self.invalid, true), (&self.mask, false)] {
            let Some(path) = path else { continue };
            let marked = white(path)?;
            let unusable = flow.data.iter_mut().zip(marked).filter(|(_, marked)| *marked == unusable);
            unusable.for_each(|(uv, _)| *uv = [UNKNOWN_FLOW; 2]);
        }
        if !flow.data.iter().any(|&uv| FlowField::is_known(uv)) {
            return Err(Error::format(&self.flow, "number of known pixels", 0, "at least 1"));
        }
        let depth_m = self.depth.as_deref().map(npy::read_plane).transpose()?;
        if let (Some(path), Some(depth_m)) = (&self.depth, &depth_m) {
            same(path, depth_m.size)?;
        }
        Ok(LoadedPair { frames, truth: GroundTruth { flow, occluded: by_flow.or(by_image), depth_m } })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Plane};
    use crate::io::{flo, kitti};

    fn gray(path: &Path, size: Size, data: Vec<u8>) {
        picture::write_png(path, &Image { size, format: PixelFormat::Gray8, data }).unwrap();
    }

    /// A pair of 3 × 1 pixels in a folder, with every further file.
    fn pair(folder: &Path) -> PairFiles {
        let (size, at) = (Size::new(3, 1), |name: &str| folder.join(name));
        gray(&at("a.png"), size, vec![1, 2, 3]);
        gray(&at("b.png"), size, vec![2, 3, 4]);
        flo::write(at("f.flo"), &FlowField { size, data: vec![[1.0, 0.0]; 3] }).unwrap();
        let seen = FlowField { size, data: vec![[1.0, 0.0], [UNKNOWN_FLOW; 2], [1.0, 0.0]] };
        kitti::write(at("noc.png"), &seen).unwrap();
        gray(&at("occluded.png"), size, vec![0, 0, 255]);
        gray(&at("invalid.png"), size, vec![255, 0, 0]);
        gray(&at("mask.png"), size, vec![0, 255, 255]);
        npy::write_plane(at("d.npy"), &Plane { size, data: vec![1.0, 2.0, f32::INFINITY] }).unwrap();
        PairFiles {
            name: "it".to_owned(),
            frames: [at("a.png"), at("b.png")],
            flow: at("f.flo"),
            ..PairFiles::default()
        }
    }

    #[test]
    fn every_part_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let (pair, at) = (pair(folder.path()), |name: &str| Some(folder.path().join(name)));
        let plain = pair.load().unwrap();
        assert_eq!((&plain.truth.occluded, &plain.truth.depth_m), (&None, &None));
        assert_eq!(plain.frames[1].data, [2, 3, 4]);
        let by_flow =
            PairFiles { visible_flow: at("noc.png"), depth: at("d.npy"), ..pair.clone() }.load().unwrap();
        assert_eq!(by_flow.truth.occluded, Some(vec![false, true, false]));
        assert_eq!(by_flow.truth.depth_m.unwrap().data[1], 2.0);
        for part in [
            PairFiles { invalid: at("invalid.png"), ..pair.clone() },
            PairFiles { mask: at("mask.png"), ..pair.clone() },
        ] {
            let known: Vec<bool> =
                part.load().unwrap().truth.flow.data.iter().map(|&uv| FlowField::is_known(uv)).collect();
            assert_eq!(known, [false, true, true]);
        }
        let by_image = PairFiles { occlusions: at("occluded.png"), ..pair }.load().unwrap();
        assert_eq!(by_image.truth.occluded, Some(vec![false, false, true]));
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let (pair, at) = (pair(folder.path()), |name: &str| folder.path().join(name));
        let small = Size::new(2, 1);
        gray(&at("small.png"), small, vec![0; 2]);
        flo::write(at("small.flo"), &FlowField { size: small, data: vec![[0.0; 2]; 2] }).unwrap();
        npy::write_plane(at("small.npy"), &Plane { size: small, data: vec![0.0; 2] }).unwrap();
        std::fs::write(at("cut.flo"), "PIEH").unwrap();
        gray(&at("dark.png"), Size::new(3, 1), vec![0; 3]);
        let rgb = Image { size: Size::new(3, 1), format: PixelFormat::Rgb8, data: vec![0; 9] };
        picture::write_png(at("rgb.png"), &rgb).unwrap();
        let frames = |name: &str| PairFiles { frames: [at("a.png"), at(name)], ..pair.clone() };
        for (wrong, words) in [
            (frames("missing.png"), ["missing.png", "is missing, expected the second frame of the pair it"]),
            (frames("small.png"), ["small.png", "size is 2×1, expected 3×1 as in"]),
            (frames("rgb.png"), ["rgb.png", "pixel format is rgb8, expected gray8 as in"]),
            (PairFiles { flow: at("small.flo"), ..pair.clone() }, ["small.flo", "2×1, expected 3×1"]),
            (PairFiles { flow: at("cut.flo"), ..pair.clone() }, ["cut.flo", "expected"]),
            (PairFiles { flow: at("no.flo"), ..pair.clone() }, ["no.flo", "No such file"]),
            (PairFiles { mask: Some(at("small.png")), ..pair.clone() }, ["small.png", "2×1"]),
            (PairFiles { depth: Some(at("small.npy")), ..pair.clone() }, ["small.npy", "2×1"]),
            (PairFiles { mask: Some(at("dark.png")), ..pair.clone() }, ["f.flo", "known pixels is 0"]),
        ] {
            let error = wrong.load().unwrap_err().to_string();
            assert!(words.iter().all(|word| error.contains(word)), "{error}");
        }
    }
}
