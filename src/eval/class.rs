//! The classes of pixels whose errors are told apart.

use super::GroundTruth;
use super::boundaries::{Near, depth_edges, motion_edges, thin_things};
use super::texture::textured;
use crate::error::Result;
use crate::frame::{FlowField, Frame, Size};
use crate::named::named;

/// A class of pixels. All but [`Class::Sky`] leave out the sky, which has a true flow but no texture. Those that need a depth
/// leave out what leaves the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Class {
    /// Every pixel whose flow is known.
    All,
    /// A true displacement under 10 px.
    Slow,
    /// From 10 to 40 px.
    Medium,
    /// Over 40 px.
    Fast,
    /// Within 3 px of a motion edge: neighbours whose true flow differs by over ½ px and 5 % of the longer displacement.
    Edge,
    /// Within 3 to 10 px of one.
    NearEdge,
    /// Farther away.
    Far,
    /// The root mean square of the first frame's gradient over 7 × 7 pixels is under 3 gray levels per pixel.
    Flat,
    /// It is not.
    Textured,
    /// The second frame does not show it.
    Occluded,
    /// It does.
    Visible,
    /// The true flow leads to a place between the centres of the second frame's pixels.
    Inside,
    /// It leads out of the second frame.
    Leaving,
    /// Within 3 px along the row of a depth edge: neighbours in a row whose depths have a ratio over 1.3.
    DepthEdge,
    /// Inside a thin thing: from 2 to 6 px along the row between depth edges, nearer than what is on both sides by a ratio
    /// over 1.3, with a flow that differs from theirs by over ½ px.
    Thin,
    /// Neither thin nor near a depth edge.
    Calm,
    /// The depth is infinite. Sky that leaves the frame is in no class.
    Sky,
}

named!(Class, "class");

impl Class {
    /// All classes, in the order of tables.
    pub const ALL: [Self; 17] = [
        Self::All,
        Self::Slow,
        Self::Medium,
        Self::Fast,
        Self::Edge,
        Self::NearEdge,
        Self::Far,
        Self::Flat,
        Self::Textured,
        Self::Occluded,
        Self::Visible,
        Self::Inside,
        Self::Leaving,
        Self::DepthEdge,
        Self::Thin,
        Self::Calm,
        Self::Sky,
    ];

    /// The name, as in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Slow => "slow",
            Self::Medium => "medium",
            Self::Fast => "fast",
            Self::Edge => "edge",
            Self::NearEdge => "near-edge",
            Self::Far => "far",
            Self::Flat => "flat",
            Self::Textured => "textured",
            Self::Occluded => "occluded",
            Self::Visible => "visible",
            Self::Inside => "inside",
            Self::Leaving => "leaving",
            Self::DepthEdge => "depth-edge",
            Self::Thin => "thin",
            Self::Calm => "calm",
            Self::Sky => "sky",
        }
    }

    const fn bit(self) -> u32 {
        1 << self as u16
    }
}

/// The classes of every pixel of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Classes(Vec<u32>);

impl Classes {
    /// Finds the classes of a pair from its first frame and its truth. A pixel whose true flow is unknown has none.
    ///
    /// # Errors
    /// As in [`GroundTruth::validate`]; [`Error::SizeMismatch`](crate::Error::SizeMismatch) if the frame and the truth differ in size.
    pub fn new(first: &Frame<'_>, truth: &GroundTruth) -> Result<Self> {
        truth.validate()?;
        super::metrics::check_size("first frame", first.size(), truth.flow.size)?;
        let motion = motion_edges(&truth.flow);
        let texture = textured(first);
        let depth = truth.depth_m.as_ref();
        let sky = |i: usize| depth.is_some_and(|depth| depth.data[i] == f32::INFINITY);
        let jumps = depth.map(|depth| (depth_edges(depth), thin_things(depth, &truth.flow)));
        let classes = truth.flow.data.iter().enumerate().map(|(i, &uv)| {
            if !FlowField::is_known(uv) {
                return 0;
            }
            let is_inside = is_inside(i, uv, truth.flow.size);
            if sky(i) {
                return if is_inside { Class::Sky.bit() } else { 0 };
            }
            let speed = match f64::from(uv[0]).hypot(f64::from(uv[1])) {
                ..10.0 => Class::Slow,
                10.0..=40.0 => Class::Medium,
                _ => Class::Fast,
            };
            let edge = match motion[i] {
                Near::Within3 => Class::Edge,
                Near::Within10 => Class::NearEdge,
                Near::Beyond => Class::Far,
            };
            let texture = if texture[i] { Class::Textured } else { Class::Flat };
            let place = if is_inside { Class::Inside } else { Class::Leaving };
            let mut bits =
                [Class::All, speed, edge, texture, place].iter().fold(0, |bits, class| bits | class.bit());
            if let Some(occluded) = &truth.occluded {
                bits |= if occluded[i] { Class::Occluded } else { Class::Visible }.bit();
            }
            if let Some((edges, thin)) = jumps.as_ref().filter(|_| is_inside) {
                let found = [(edges[i], Class::DepthEdge), (thin[i], Class::Thin)];
                bits |= found.iter().map(|(is, class)| if *is { class.bit() } else { 0 }).sum::<u32>();
                bits |= if edges[i] || thin[i] { 0 } else { Class::Calm.bit() };
            }
            bits
        });
        Ok(Self(classes.collect()))
    }

    /// The classes of the pixel with this index, in row-major order.
    pub fn of(&self, pixel: usize) -> impl Iterator<Item = Class> + '_ {
        Class::ALL.into_iter().filter(move |class| self.has(pixel, *class))
    }

    /// Whether a pixel is in a class.
    pub fn has(&self, pixel: usize, class: Class) -> bool {
        self.0[pixel] & class.bit() != 0
    }
}

/// Whether the flow of a pixel leads to a place between the centres of an image's pixels.
fn is_inside(pixel: usize, [u, v]: [f32; 2], size: Size) -> bool {
    let width = size.width as usize;
    size.contains([(pixel % width) as f32 + u, (pixel / width) as f32 + v])
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::frame::{PixelFormat, Plane, UNKNOWN_FLOW};

    fn classes(flow: Vec<[f32; 2]>, occluded: Option<Vec<bool>>, depth_m: Option<Vec<f32>>) -> Vec<String> {
        let size = Size::new(flow.len() as u32, 1);
        let depth_m = depth_m.map(|data| Plane { size, data });
        let gray = vec![7; size.pixels()];
        let frame = Frame::new(size, PixelFormat::Gray8, &gray).unwrap();
        let count = flow.len();
        let truth = GroundTruth { flow: FlowField { size, data: flow }, occluded, depth_m };
        let found = Classes::new(&frame, &truth).unwrap();
        (0..count).map(|i| found.of(i).map(Class::name).collect::<Vec<_>>().join(" ")).collect()
    }

    #[test]
    fn every_class_of_a_row() {
        let flow = vec![[0.0, 9.9], [10.0, 0.0], [40.0, 0.0], [0.0, 40.1], [UNKNOWN_FLOW; 2]];
        let occluded = vec![true, false, false, false, false];
        let found = classes(flow, Some(occluded), None);
        let expected = [
            "slow edge flat occluded leaving",
            "medium edge flat visible leaving",
            "medium edge flat visible leaving",
            "fast edge flat visible leaving",
        ];
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(*found, format!("all {expected}"));
        }
        assert_eq!(found[4], "");
    }

    #[test]
    fn the_sky_is_a_class_of_its_own() {
        let found = classes(vec![[0.0; 2]; 3], None, Some(vec![f32::INFINITY, 5.0, f32::NAN]));
        assert_eq!(found[0], "sky");
        assert_eq!(found[1], "all slow far flat inside depth-edge");
    }

    #[test]
    fn what_leaves_the_frame_is_in_no_class_of_depth() {
        let still = [0.0; 2];
        let flow = vec![[-0.01, 0.0], still, [1.0, 0.0], [0.5, 0.0]];
        let found = classes(flow, None, Some(vec![5.0, 5.0, 5.0, f32::INFINITY]));
        assert_eq!(found[0], "all slow edge flat leaving");
        assert!(
            found[1].ends_with("inside depth-edge") && found[2].ends_with("inside depth-edge"),
            "{found:?}"
        );
        // The sky that leaves counts nowhere.
        assert_eq!(found[3], "");
    }

    #[test]
    fn parts_of_another_size_are_refused() {
        let frame = Frame::new(Size::new(2, 1), PixelFormat::Gray8, &[0; 2]).unwrap();
        let flow = |width: u32| FlowField { size: Size::new(width, 1), data: vec![[0.0; 2]; width as usize] };
        let error = Classes::new(&frame, &flow(3).into()).unwrap_err().to_string();
        assert_eq!(error, "first frame is 2×1, expected 3×1");
        let truth = GroundTruth { occluded: Some(vec![true]), ..flow(2).into() };
        assert_eq!(
            Classes::new(&frame, &truth).unwrap_err().to_string(),
            "occluded holds 1 elements, expected 2"
        );
        let depth_m = Some(Plane { size: Size::new(1, 1), data: vec![1.0] });
        let truth = GroundTruth { depth_m, ..flow(2).into() };
        assert_eq!(Classes::new(&frame, &truth).unwrap_err().to_string(), "depth is 1×1, expected 2×1");
    }

    #[test]
    fn names_are_read_back() {
        for class in Class::ALL {
            assert_eq!(class.name().parse::<Class>().unwrap(), class);
        }
        assert!("edges".parse::<Class>().is_err());
    }
}
