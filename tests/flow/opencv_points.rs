//! OpenCV's corners and sparse Lucas–Kanade on the golden pairs, compared with both executors'; and how the executors
//! agree with each other.

use std::collections::HashSet;
use std::path::Path;

use viewsphere::Backend;
use viewsphere::features::{CornerParameters, CornerResponse, good_features};
use viewsphere::frame::Image;
use viewsphere::io::picture;
use viewsphere::tracking::{PointTracker, TrackParameters, TrackedPoint};

use crate::need;

/// The largest median distance of points that both find, px: 0.02 is the promise for any pair, 0.0003 was measured on these.
/// OpenCV rounds the samples of its windows to 1/32 of a gray level.
const MEDIAN: f64 = 0.002;

/// The least share of points of the same status. OpenCV's roundings decide those at the limits.
const SAME_STATUS: f64 = 0.99;

/// The least share of corners in both lists. A corner differs only where two responses are equal but for roundings.
const SAME_CORNERS: f64 = 0.99;

fn image(name: &str) -> Image {
    picture::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.pgm"))).unwrap()
}

/// The lines of a table, in groups with the same first columns.
fn groups(name: &str, header: &str, key: usize) -> Vec<(Vec<String>, Vec<Vec<String>>)> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next().unwrap(), header);
    let mut groups: Vec<(Vec<String>, Vec<Vec<String>>)> = Vec::new();
    for line in lines {
        let columns: Vec<String> = line.split(',').map(str::to_owned).collect();
        let (settings, values) = columns.split_at(key);
        match groups.last_mut().filter(|(known, _)| known == settings) {
            Some((_, rows)) => rows.push(values.to_vec()),
            None => groups.push((settings.to_vec(), vec![values.to_vec()])),
        }
    }
    groups
}

fn numbers(columns: &[String]) -> Vec<f32> {
    columns.iter().map(|column| column.parse().unwrap()).collect()
}

fn corners(backend: &Backend) {
    let groups = groups("corners.csv", "image,quality_level,min_distance,block_size,k,x,y", 5);
    assert_eq!(groups.len(), 7, "corners.csv was read whole");
    let (mut all, mut same) = (0, 0);
    for (settings, rows) in groups {
        let [name, quality, distance, block, k] = settings.as_slice() else { panic!("{settings:?}") };
        let parameters = CornerParameters {
            max_corners: 60,
            quality_level: quality.parse().unwrap(),
            min_distance: distance.parse().unwrap(),
            block_size: block.parse().unwrap(),
            response: match k.as_str() {
                "" => CornerResponse::MinEigenvalue,
                k => CornerResponse::Harris { k: k.parse().unwrap() },
            },
        };
        let image = image(name);
        let found = good_features(backend, &image.frame().unwrap(), None, &parameters).unwrap();
        let found: HashSet<[i64; 2]> =
            found.iter().map(|corner| [corner.x as i64, corner.y as i64]).collect();
        let expected: HashSet<[i64; 2]> =
            rows.iter().map(|row| [row[0].parse().unwrap(), row[1].parse().unwrap()]).collect();
        println!(
            "{settings:?} on {}: {} of {}",
            backend.name(),
            found.intersection(&expected).count(),
            expected.len()
        );
        all += expected.len().max(found.len());
        same += found.intersection(&expected).count();
    }
    let share = same as f64 / all as f64;
    assert!(share >= SAME_CORNERS, "{same} of {all} corners are the same on {}", backend.name());
}

/// The settings and points of a group, and what OpenCV has found.
struct Case {
    name: String,
    images: [Image; 2],
    parameters: TrackParameters,
    points: Vec<[f32; 2]>,
    initial: Vec<[f32; 2]>,
    expected: Vec<TrackedPoint>,
}

fn cases() -> Vec<Case> {
    let header = "pair,window,levels,iterations,epsilon,x,y,from_x,from_y,to_x,to_y,status,error";
    let groups = groups("tracks.csv", header, 5);
    assert_eq!(groups.len(), 7, "tracks.csv was read whole");
    let case = |(settings, rows): (Vec<String>, Vec<Vec<String>>)| {
        let [pair, window, levels, iterations, epsilon] = settings.as_slice() else { panic!("{settings:?}") };
        let (columns, lines) = window.split_once('x').unwrap();
        let rows: Vec<Vec<f32>> = rows.iter().map(|row| numbers(row)).collect();
        let expected = |row: &Vec<f32>| TrackedPoint {
            x: row[4],
            y: row[5],
            found: row[6] == 1.0,
            error: row[7],
            forward_backward_px: None,
        };
        Case {
            name: settings.join(", "),
            images: [0, 1].map(|i| image(&format!("{pair}_{i}"))),
            parameters: TrackParameters {
                window: [columns.parse().unwrap(), lines.parse().unwrap()],
                levels: levels.parse().unwrap(),
                iterations: iterations.parse().unwrap(),
                epsilon: epsilon.parse().unwrap(),
                ..TrackParameters::default()
            },
            points: rows.iter().map(|row| [row[0], row[1]]).collect(),
            initial: rows.iter().map(|row| [row[2], row[3]]).collect(),
            expected: rows.iter().map(expected).collect(),
        }
    };
    groups.into_iter().map(case).collect()
}

fn followed(backend: &Backend, case: &Case) -> Vec<TrackedPoint> {
    let Image { size, format, .. } = case.images[0];
    let mut tracker =
        PointTracker::new(backend, size, format, &case.parameters, case.points.len() + 3, false).unwrap();
    tracker.track(&case.images[0].frame().unwrap(), &[], None).unwrap();
    tracker.track(&case.images[1].frame().unwrap(), &case.points, Some(&case.initial)).unwrap().to_vec()
}

fn distance(a: &TrackedPoint, b: &TrackedPoint) -> f64 {
    f64::from((a.x - b.x).hypot(a.y - b.y))
}

fn tracks(backend: &Backend) {
    let (mut same, mut all) = (0, 0);
    let mut problems = Vec::new();
    for case in &cases() {
        let found = followed(backend, case);
        let pairs = || found.iter().zip(&case.expected);
        same += pairs().filter(|(a, b)| a.found == b.found).count();
        all += pairs().count();
        let both = || pairs().filter(|(a, b)| a.found && b.found);
        let mut apart: Vec<f64> = both().map(|(a, b)| distance(a, b)).collect();
        apart.sort_by(f64::total_cmp);
        let mut errors: Vec<f64> = both().map(|(a, b)| f64::from((a.error - b.error).abs())).collect();
        errors.sort_by(f64::total_cmp);
        let [median, most, error] =
            [apart[apart.len() / 2], apart[apart.len() * 9 / 10], errors[errors.len() / 2]];
        println!(
            "{} on {}: median {median:.5} px, 90 % {most:.4} px, error {error:.4}",
            case.name,
            backend.name()
        );
        // The error's median is within a gray level's rounding.
        if !(median <= MEDIAN && error <= 0.05) {
            problems.push(format!("{}: median {median} px, error {error}", case.name));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    assert!(same as f64 >= SAME_STATUS * all as f64, "{same} of {all} points have the same status");
}

#[test]
fn the_cpu_finds_the_corners_of_opencv() {
    corners(&Backend::Cpu);
}

#[test]
fn the_gpu_finds_the_corners_of_opencv() {
    let Some(gpu) = need::gpu() else { return };
    corners(&Backend::Gpu(gpu));
}

#[test]
fn the_cpu_follows_points_as_opencv_does() {
    tracks(&Backend::Cpu);
}

#[test]
fn the_gpu_follows_points_as_opencv_does() {
    let Some(gpu) = need::gpu() else { return };
    tracks(&Backend::Gpu(gpu));
}

/// The same bytes on two runs; and on both executors the same status, and places that differ by no more than the step
/// that ends the iterations where the search converges: 99 % of the points, as a search that does not may end anywhere.
#[test]
fn both_executors_follow_points_alike_and_always_the_same_way() {
    let Some(gpu) = need::gpu() else { return };
    let gpu = Backend::Gpu(gpu);
    let (mut near, mut all) = (0, 0);
    for case in &cases() {
        let [on_gpu, again] = [followed(&gpu, case), followed(&gpu, case)];
        assert_eq!(on_gpu, again, "{}", case.name);
        let on_cpu = followed(&Backend::Cpu, case);
        assert_eq!(on_cpu, followed(&Backend::Cpu, case), "{}", case.name);
        let agree = |(a, b): &(&TrackedPoint, &TrackedPoint)| {
            a.found == b.found && (!a.found || distance(a, b) <= case.parameters.epsilon)
        };
        near += on_gpu.iter().zip(&on_cpu).filter(agree).count();
        all += on_gpu.len();
        let largest = on_gpu.iter().zip(&on_cpu).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
        println!("{}: at most {largest:.1e} px apart", case.name);
    }
    assert!(near as f64 >= 0.99 * all as f64, "{near} of {all}");
}
