//! Tracks over a sequence: their lifecycle, and bad input.

use viewsphere::features::{CornerParameters, CornerResponse, good_features};
use viewsphere::frame::{Frame, Image, PixelFormat, Plane, Size};
use viewsphere::tracking::{
    PointTracker, Track, TrackParameters, TrackStatus, Tracker, TrackerConfig, pyramid,
};
use viewsphere::{Backend, Error};

const SIZE: Size = Size::new(160, 120);

/// A texture that has moved by so many pixels; with a bar of one gray level from column `bar` on, 40 px wide.
fn image([u, v]: [f64; 2], bar: Option<u32>) -> Image {
    const WAVES: [[f64; 3]; 5] =
        [[0.31, 0.12, 0.4], [-0.17, 0.43, 1.9], [0.52, -0.36, 0.8], [0.07, 0.21, 2.6], [-0.62, -0.28, 0.1]];
    let pixel = |i: u32| {
        let (x, y) = (i % SIZE.width, i / SIZE.width);
        if bar.is_some_and(|bar| (bar..bar + 40).contains(&x)) {
            return 200;
        }
        let (x, y) = (f64::from(x) - u, f64::from(y) - v);
        let sum: f64 = WAVES.iter().map(|[a, b, phase]| (a * x + b * y + phase).sin()).sum();
        (128.0 + 22.0 * sum).round() as u8
    };
    let data = (0..SIZE.pixels() as u32).map(pixel).collect();
    Image { size: SIZE, format: PixelFormat::Gray8, data }
}

fn tracker(config: &TrackerConfig) -> Tracker {
    Tracker::new(&Backend::Cpu, SIZE, PixelFormat::Gray8, config).unwrap()
}

fn process(tracker: &mut Tracker, image: &Image) -> Vec<Track> {
    tracker.process(&image.frame().unwrap(), None).unwrap().to_vec()
}

fn live(tracks: &[Track]) -> usize {
    tracks.iter().filter(|track| track.status.is_live()).count()
}

fn config(max_corners: usize, min_tracks: usize) -> TrackerConfig {
    TrackerConfig {
        corners: CornerParameters { max_corners, ..CornerParameters::default() },
        min_tracks,
        ..TrackerConfig::default()
    }
}

#[test]
fn tracks_follow_a_texture_and_end_where_it_leaves_or_is_hidden() {
    let mut tracker = tracker(&config(60, 0));
    let first = process(&mut tracker, &image([0.0, 0.0], None));
    assert_eq!(live(&first), 60);
    assert!(first.iter().all(|track| track.status == TrackStatus::New && track.age == 0));
    let ids: Vec<u64> = first.iter().map(|track| track.id).collect();
    assert_eq!(ids, (0..60).collect::<Vec<_>>());

    let second = process(&mut tracker, &image([-3.4, 1.2], None));
    assert_eq!(second.len(), 60);
    for track in second.iter().filter(|track| track.status == TrackStatus::Tracked) {
        let inside = (15.0..145.0).contains(&track.x) && (15.0..105.0).contains(&track.y);
        let off = (track.shift[0] + 3.4).hypot(track.shift[1] - 1.2);
        // Gray levels are rounded, which moves a window of 441 by some thousandths of a pixel.
        assert!(!inside || off < 0.02, "{track:?}");
        assert!(track.forward_backward_px.is_some_and(|error| error <= 1.0) && track.age == 1);
    }
    let ended = 60 - live(&second);
    assert!(ended > 0 && ended < 20, "{ended} leave the image");

    // What the bar hides is lost, or is not found again on the way back.
    let third = process(&mut tracker, &image([-3.4, 1.2], Some(60)));
    assert_eq!(third.len(), live(&second), "ended tracks are told once");
    let hidden = |track: &&Track| {
        let before = track.x - track.shift[0];
        (72.0..88.0).contains(&before) && (10.0..110.0).contains(&track.y)
    };
    assert!(third.iter().filter(hidden).count() > 0);
    assert!(third.iter().filter(hidden).all(|track| !track.status.is_live()), "{third:?}");
    assert!(
        third
            .iter()
            .any(|track| track.status == TrackStatus::Inconsistent || track.status == TrackStatus::Lost)
    );
}

#[test]
fn new_corners_replace_ended_tracks_and_keep_their_distance() {
    let mut tracker = tracker(&config(60, 60));
    let first = process(&mut tracker, &image([0.0, 0.0], None));
    let second = process(&mut tracker, &image([-6.0, 0.0], None));
    let new: Vec<&Track> = second.iter().filter(|track| track.status == TrackStatus::New).collect();
    assert!(!new.is_empty() && live(&second) <= 60);
    assert!(new.iter().all(|track| track.id >= first.len() as u64), "numbers are never used again");
    for track in &new {
        let others = second.iter().filter(|other| other.status.is_live() && other.id != track.id);
        let nearest = others.map(|o| (o.x - track.x).hypot(o.y - track.y)).fold(f32::INFINITY, f32::min);
        assert!(nearest >= 7.0, "{track:?}: {nearest}");
    }
}

#[test]
fn given_points_replace_corners() {
    let mut tracker = tracker(&config(10, 0));
    tracker.set_points(vec![[40.5, 50.25], [0.0, 0.0]]).unwrap();
    let first = process(&mut tracker, &image([0.0, 0.0], None));
    assert_eq!([first[0].x, first[0].y, first[1].x], [40.5, 50.25, 0.0]);
    assert_eq!(first.len(), 2);
    let second = process(&mut tracker, &image([1.5, -0.5], None));
    assert!((second[0].x - 42.0).hypot(second[0].y - 49.75) < 0.02, "{:?}", second[0]);
    assert!(tracker.set_points(vec![[1.0, 1.0]]).is_err());
}

#[test]
fn corners_lie_inside_the_mask() {
    let image = image([0.0, 0.0], None);
    let frame = image.frame().unwrap();
    let data = (0..SIZE.pixels()).map(|i| if i % 160 < 50 { 1.0 } else { 0.0 }).collect();
    let mask = Plane { size: SIZE, data };
    let parameters = CornerParameters::default();
    let corners = good_features(&Backend::Cpu, &frame, Some(&mask), &parameters).unwrap();
    assert!(!corners.is_empty() && corners.iter().all(|corner| corner.x < 50.0), "{corners:?}");
    let none = Plane { size: SIZE, data: vec![0.0; SIZE.pixels()] };
    assert!(good_features(&Backend::Cpu, &frame, Some(&none), &parameters).unwrap().is_empty());
    let flat = vec![7; SIZE.pixels()];
    let flat = Frame::new(SIZE, PixelFormat::Gray8, &flat).unwrap();
    for response in [CornerResponse::MinEigenvalue, CornerResponse::Harris { k: 0.04 }] {
        let parameters = CornerParameters { response, ..parameters };
        assert!(good_features(&Backend::Cpu, &flat, None, &parameters).unwrap().is_empty());
    }
}

#[test]
fn levels_that_the_window_would_cover_are_left_out() {
    let parameters =
        |side, levels| TrackParameters { window: [side; 2], levels, ..TrackParameters::default() };
    let widths = |side, levels| -> Vec<u32> {
        pyramid(SIZE, &parameters(side, levels)).iter().map(|size| size.width).collect()
    };
    assert_eq!(widths(21, 3), [160, 80, 40]);
    assert_eq!(widths(29, 8), [160, 80, 40]);
    assert_eq!(widths(30, 8), [160, 80]);
    assert_eq!(widths(3, 1), [160, 80]);
}

#[track_caller]
fn refused<T>(result: Result<T, Error>, words: &str) {
    let error = result.err().expect("an error").to_string();
    assert!(error.contains(words), "{error}, expected {words}");
}

#[test]
fn wrong_parameters_and_points_are_refused() {
    let with = |change: &dyn Fn(&mut TrackerConfig)| {
        let mut config = config(10, 0);
        change(&mut config);
        Tracker::new(&Backend::Cpu, SIZE, PixelFormat::Gray8, &config)
    };
    refused(with(&|c| c.min_tracks = 11), "min_tracks is 11, expected at most max_corners, 10");
    refused(with(&|c| c.corners.max_corners = 0), "max_corners is 0, expected 1 to 65535");
    refused(with(&|c| c.corners.quality_level = f64::NAN), "quality_level is NaN");
    refused(with(&|c| c.corners.quality_level = 0.0), "quality_level is 0");
    refused(with(&|c| c.corners.min_distance = -1.0), "min_distance is -1");
    refused(with(&|c| c.corners.block_size = 65), "block_size is 65");
    refused(with(&|c| c.corners.response = CornerResponse::Harris { k: f64::NAN }), "k is NaN");
    refused(with(&|c| c.track.window = [2, 21]), "window is 2×21");
    refused(with(&|c| c.track.window = [65, 64]), "window is 65×64");
    refused(with(&|c| c.track.window = [21, 121]), "window is 21×121, expected at most the frame's 160×120");
    refused(with(&|c| c.track.levels = 17), "levels is 17");
    refused(with(&|c| c.track.iterations = 0), "iterations is 0");
    refused(with(&|c| c.track.epsilon = f64::NAN), "epsilon is NaN");
    refused(with(&|c| c.track.min_eigenvalue = -1.0), "min_eigenvalue is -1");
    refused(with(&|c| c.forward_backward_px = Some(0.0)), "forward_backward_px is 0");
    refused(tracker(&config(10, 0)).set_points(vec![[160.0, 3.0]]), "(160, 3) at index 0");
    refused(tracker(&config(10, 0)).set_points(vec![[f32::NAN, 3.0]]), "(NaN, 3) at index 0");
    refused(tracker(&config(1, 0)).set_points(vec![[1.0, 3.0]; 2]), "number of points is 2");

    let parameters = TrackParameters::default();
    let mut points =
        PointTracker::new(&Backend::Cpu, SIZE, PixelFormat::Gray8, &parameters, 2, true).unwrap();
    let image = image([0.0, 0.0], None);
    let frame = image.frame().unwrap();
    refused(points.track(&frame, &[[1.0, 1.0]], None), "none in the first frame");
    points.track(&frame, &[], None).unwrap();
    refused(points.track(&frame, &[[1.0, 1.0]; 3], None), "number of points is 3, expected at most 2");
    refused(points.track(&frame, &[[1.0, f32::INFINITY]], None), "finite coordinates");
    refused(points.track(&frame, &[[1.0, 1.0]], Some(&[])), "number of initial places is 0, expected 1");
    let small = Frame::new(Size::new(1, 1), PixelFormat::Gray8, &[0]).unwrap();
    refused(points.track(&small, &[], None), "frame is 1×1, expected 160×120");
    // After errors the sequence goes on.
    let still = points.track(&frame, &[[80.0, 60.0]], None).unwrap()[0];
    assert!(
        still.found && [still.x, still.y] == [80.0, 60.0] && still.forward_backward_px == Some(0.0),
        "{still:?}"
    );
}
