//! The figures of an estimated flow field.

use std::collections::BTreeMap;

use super::metrics::{check, check_size};
use super::{Class, Classes, ConfidenceScore, GroundTruth, Tally};
use crate::error::Result;
use crate::frame::{FlowField, Plane};

/// The figures of an estimated flow field, which can be added up over pairs.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Score {
    /// The errors of each class that has pixels.
    classes: BTreeMap<Class, Tally>,
    /// How well the confidence tells bad pixels; `None` without a confidence.
    confidence: Option<ConfidenceScore>,
}

impl Score {
    /// Compares an estimated flow field and its confidence, if there is one, with the ground truth. `classes` are those of
    /// the same truth.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`](crate::Error::SizeMismatch) if the sizes differ; as in [`FlowField::validate`] and
    /// [`Plane::validate`].
    pub fn new(
        truth: &GroundTruth,
        classes: &Classes,
        estimate: &FlowField,
        confidence: Option<&Plane>,
    ) -> Result<Self> {
        check(&truth.flow, estimate)?;
        if let Some(confidence) = confidence {
            confidence.validate()?;
            check_size("confidence", confidence.size, truth.flow.size)?;
        }
        let mut tallies = [Tally::default(); Class::ALL.len()];
        let mut pixels = Vec::new();
        for (i, (&a, &b)) in truth.flow.data.iter().zip(&estimate.data).enumerate() {
            if !FlowField::is_known(a) {
                continue;
            }
            let mut error = None;
            for class in classes.of(i) {
                error = tallies[class as usize].add(a, b);
            }
            if let (Some(error), Some(confidence)) = (error, confidence) {
                pixels.push((confidence.data[i], error, classes.has(i, Class::Sky)));
            }
        }
        let found = Class::ALL.into_iter().zip(tallies).filter(|(_, tally)| tally.known() > 0);
        let confidence = confidence.and_then(|_| ConfidenceScore::new(&pixels));
        Ok(Self { classes: found.collect(), confidence })
    }

    /// Includes the figures of another pair.
    pub fn merge(&mut self, other: &Self) {
        for (class, tally) in &other.classes {
            self.classes.entry(*class).or_default().merge(tally);
        }
        match (&mut self.confidence, &other.confidence) {
            (Some(mine), Some(other)) => mine.merge(other),
            (mine @ None, Some(other)) => *mine = Some(other.clone()),
            (_, None) => (),
        }
    }

    /// The errors of a class; `None` if it has no pixels.
    pub fn class(&self, class: Class) -> Option<&Tally> {
        self.classes.get(&class)
    }

    /// How well the confidence tells bad pixels.
    pub fn confidence(&self) -> Option<&ConfidenceScore> {
        self.confidence.as_ref()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{Frame, PixelFormat, Size, UNKNOWN_FLOW};

    const SIZE: Size = Size::new(4, 1);

    fn score(confidence: Option<&Plane>) -> Score {
        let flow = FlowField { size: SIZE, data: vec![[0.0; 2], [0.0; 2], [0.0; 2], [UNKNOWN_FLOW; 2]] };
        let depth_m = Some(Plane { size: SIZE, data: vec![5.0, 5.0, f32::INFINITY, 5.0] });
        let truth = GroundTruth { depth_m, ..flow.into() };
        let classes = Classes::new(&Frame::new(SIZE, PixelFormat::Gray8, &[0; 4]).unwrap(), &truth).unwrap();
        let estimate =
            FlowField { size: SIZE, data: vec![[1.0, 0.0], [f32::NAN, 0.0], [7.0, 0.0], [9.0, 0.0]] };
        Score::new(&truth, &classes, &estimate, confidence).unwrap()
    }

    #[test]
    fn the_sky_is_told_apart_and_what_is_unknown_left_out() {
        let score = score(None);
        let all = score.class(Class::All).unwrap().error();
        assert_eq!((all.aee_px, all.pixels, all.density), (1.0, 1, 0.5));
        assert_eq!(score.class(Class::Sky).unwrap().error().aee_px, 7.0);
        assert_eq!((score.class(Class::Thin), score.class(Class::Occluded)), (None, None));
        assert!(score.confidence().is_none());
    }

    #[test]
    fn two_pairs_have_the_pixels_of_both() {
        let plane = Plane { size: SIZE, data: vec![0.5; 4] };
        let (mut sum, one) = (score(None), score(Some(&plane)));
        sum.merge(&one);
        sum.merge(&one);
        let all = sum.class(Class::All).unwrap().error();
        assert_eq!((all.aee_px, all.pixels, all.density), (1.0, 3, 0.5));
        assert_eq!(sum.confidence().unwrap().pixels(), 4);
    }
}
