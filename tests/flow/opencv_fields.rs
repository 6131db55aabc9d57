//! OpenCV's flow fields of synthetic pairs and of a real one, compared with both executors'.

use std::path::Path;

use viewsphere::eval::endpoint_error;
use viewsphere::flow::{Farneback, Window};
use viewsphere::frame::{FlowField, Image};
use viewsphere::io::{flo, picture};
use viewsphere::kernel::Bound;
use viewsphere::kernels::compare::{Difference, compare};

use crate::pair::{On, flow};
use crate::{data, need};

/// The largest allowed distance of a vector from OpenCV's. The promise for any pair is 10⁻⁴ px in the mean and 10⁻² px
/// for 99.9 % of the vectors. These pairs are well conditioned, so that a tighter bound holds: OpenCV's own fields vary
/// by some 1e-5 px with the processor's instruction set, ours were at most 4e-5 px away, and other GPUs round
/// differently.
const BOUND: Bound = Bound { absolute: 2e-4, relative: 0.0, own: Vec::new() };

/// The largest allowed mean distance of vectors from OpenCV's, px: 1.4e-6 was measured.
const MEAN: f64 = 5e-6;

struct Case {
    name: String,
    config: Farneback,
    images: [Image; 2],
    init: Option<FlowField>,
    expected: FlowField,
}

fn cases() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let table = std::fs::read_to_string(folder.join("cases.csv")).unwrap();
    let mut lines = table.lines();
    let header = "name,image0,image1,pyr_scale,levels,winsize,iterations,poly_n,poly_sigma,window,init,flow";
    assert_eq!(lines.next().unwrap(), header);
    lines.map(|line| case(&folder, line)).collect()
}

fn case(folder: &Path, line: &str) -> Case {
    let Ok(
        [
            name,
            image0,
            image1,
            pyr_scale,
            levels,
            winsize,
            iterations,
            poly_n,
            poly_sigma,
            window,
            init,
            flow,
        ],
    ) = <[&str; 12]>::try_from(line.split(',').collect::<Vec<_>>())
    else {
        panic!("{line}: expected 12 columns");
    };
    let window = match window {
        "box" => Window::Box,
        "gaussian" => Window::Gaussian,
        other => panic!("{name}: window is {other}"),
    };
    let config = Farneback {
        pyr_scale: pyr_scale.parse().unwrap(),
        levels: levels.parse().unwrap(),
        winsize: winsize.parse().unwrap(),
        iterations: iterations.parse().unwrap(),
        poly_n: poly_n.parse().unwrap(),
        poly_sigma: poly_sigma.parse().unwrap(),
        window,
        ..Farneback::default()
    };
    Case {
        name: name.to_owned(),
        config,
        images: [image0, image1].map(|file| picture::read(folder.join(file)).unwrap()),
        init: (!init.is_empty()).then(|| flo::read(folder.join(init)).unwrap()),
        expected: flo::read(folder.join(flow)).unwrap(),
    }
}

/// The length of the difference at each pixel.
fn distance(expected: &FlowField, found: &FlowField, bound: &Bound) -> Difference {
    let distance = endpoint_error(expected, found).unwrap();
    compare(&vec![0.0; distance.data.len()], &distance.data, bound)
}

/// OpenCV's fields of a crop of a real pair.
fn real_cases(on: On<'_>) {
    let Some(folder) = data::set("golden_cv2") else { return };
    let table = std::fs::read_to_string(folder.join("farneback_params.csv")).unwrap();
    let case = |line: &str| {
        // The names of OpenCV's parameters, and its flags in place of the window's shape.
        let (rest, flags) = line.rsplit_once(',').unwrap();
        let (name, parameters) = rest.split_once(',').unwrap();
        let window = if flags == "256" { "gaussian" } else { "box" };
        self::case(&folder, &format!("{name},rw_crop_0.png,rw_crop_1.png,{parameters},{window},,{name}"))
    };
    let cases: Vec<Case> = table.lines().skip(1).map(case).collect();
    assert_eq!(cases.len(), 7, "farneback_params.csv was read whole");
    every_case(on, &cases);
}

fn made_up_cases(on: On<'_>) {
    let cases = cases();
    assert_eq!(cases.len(), 24, "cases.csv was read whole");
    every_case(on, &cases);
}

fn every_case(on: On<'_>, cases: &[Case]) {
    let mut problems = Vec::new();
    for Case { name, config, images, init, expected } in cases {
        let found = flow(on, config, images.each_ref(), init.as_ref());
        let found = distance(expected, &found, &BOUND);
        let Difference { mean, p999, max, .. } = found;
        println!("{name} on the {}: mean {mean:.1e} px, p99.9 {p999:.1e} px, max {max:.1e} px", on.name());
        if mean > MEAN || found.breaches > 0 {
            problems.push(format!("{name} on the {}: {found:?}", on.name()));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_cpu_finds_the_fields_of_opencv() {
    made_up_cases(On::Cpu);
}

#[test]
fn the_gpu_finds_the_fields_of_opencv() {
    let Some(gpu) = need::gpu() else { return };
    made_up_cases(On::Gpu(&gpu));
}

#[test]
fn the_cpu_finds_the_fields_of_a_real_pair() {
    real_cases(On::Cpu);
}

#[test]
fn the_gpu_finds_the_fields_of_a_real_pair() {
    let Some(gpu) = need::gpu() else { return };
    real_cases(On::Gpu(&gpu));
}
