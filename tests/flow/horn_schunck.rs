//! Horn and Schunck's method: the minimum of its energy against one computed in f64, the residual that each preset
//! reaches, and its parameters' ranges.

use viewsphere::Backend;
use viewsphere::flow::{self, Algorithm, FlowOptions, HornSchunck, Parameters, Penalty};
use viewsphere::frame::{FlowField, Image, PixelFormat, Size};
use viewsphere::io::picture;
use viewsphere::plan::Value;
use viewsphere::runner::Runner;

use crate::energy::Energy;
use crate::pair::{On, flow};
use crate::public_pairs::images_of_pairs;
use crate::{data, need};

/// One level and one warp with enough sweeps: the residual is some 10⁻⁶ px.
fn solved(alpha: f64) -> HornSchunck {
    HornSchunck { alpha, sweeps: 1000, omega: 1.98, ..HornSchunck::classic() }
}

/// A texture that moves by about a pixel, beside an area without texture, which the flow must fill.
fn synthetic() -> [Image; 2] {
    let size = Size::new(75, 58);
    [0.0, 1.0].map(|time| {
        let level = |i: usize| {
            let (x, y) = ((i % 75) as f64, (i / 75) as f64);
            if x + 0.5 * y > 62.0 {
                return 90;
            }
            let (u, v) = (x - time * (0.8 + 0.004 * y), y + time * (0.5 - 0.003 * x));
            let waves = [[0.51, 0.17], [-0.23, 0.49], [0.11, -0.37], [0.33, 0.05]];
            let sum: f64 =
                waves.iter().zip(1..).map(|([a, b], n)| (a * u + b * v + f64::from(n)).sin()).sum();
            (128.0 + 28.0 * sum).round() as u8
        };
        Image { size, format: PixelFormat::Gray8, data: (0..size.pixels()).map(level).collect() }
    })
}

/// Part of a recorded pair, with motion of up to two pixels.
fn recorded() -> Option<[Image; 2]> {
    let folder = data::set("yosemite")?;
    let (x0, y0, size) = (90, 100, Size::new(101, 83));
    Some(["derived_yos09.png", "derived_yos10.png"].map(|name| {
        let image = picture::read(folder.join(name)).unwrap();
        assert_eq!(image.format, PixelFormat::Gray8);
        let width = image.size.width as usize;
        let row = |y: usize| &image.data[(y0 + y) * width + x0..][..size.width as usize];
        Image { size, format: image.format, data: (0..size.height as usize).flat_map(row).copied().collect() }
    }))
}

/// The largest difference of a flow from the minimum in f64, in pixels.
fn largest(found: &FlowField, minimum: &[[f64; 2]]) -> f64 {
    let differences =
        found.data.iter().zip(minimum).map(|(d, e)| (f64::from(d[0]) - e[0]).hypot(f64::from(d[1]) - e[1]));
    differences.fold(0.0, f64::max)
}

/// f32 keeps 10⁻⁷ of a flow of a pixel or two; where no texture holds the flow, roundings add up over the distance to where
/// one does, squared. Measured are up to 4·10⁻⁵ px.
const BOUND_PX: f64 = 2e-4;

fn is_the_minimum(images: [&Image; 2], what: &str) {
    let minimum = |alpha: f64| Energy::new(images, alpha).minimum();
    for alpha in [4.0, 15.0, 60.0] {
        let expected = minimum(alpha);
        let check = |on: On<'_>| {
            let found = flow(on, solved(alpha), images, None);
            let off = largest(&found, &expected);
            println!("{what}, α {alpha}, {}: {off:.2e} px", on.name());
            assert!(off <= BOUND_PX, "{what}, α {alpha}, {}: {off} px", on.name());
            // Another α is another minimum.
            assert!(!(largest(&found, &minimum(1.05 * alpha)) <= BOUND_PX), "{what}, α {alpha}: blind");
        };
        check(On::Cpu);
        if let Some(gpu) = need::gpu_if_any() {
            check(On::Gpu(&gpu));
        }
    }
}

#[test]
fn a_synthetic_pair_has_the_minimum_of_the_energy() {
    is_the_minimum(synthetic().each_ref(), "synthetic");
}

#[test]
fn a_recorded_pair_has_the_minimum_of_the_energy() {
    let Some(images) = recorded() else { return };
    is_the_minimum(images.each_ref(), "recorded");
}

/// Root mean square, in pixels, of the steps that each pixel's own equations still ask for after the last sweep.
fn residual_px(config: &HornSchunck, images: [&Image; 2]) -> f64 {
    let size = images[0].size;
    let plan = flow::plan(&config.into(), size, images[0].format, FlowOptions::default()).unwrap();
    let last = plan.pair[1].last().unwrap().clone();
    assert_eq!(last.kernel.name, "sweep");
    let mut runner = Runner::new(&Backend::Cpu, plan).unwrap();
    for (parity, image) in images.into_iter().enumerate() {
        let frame = image.frame().unwrap();
        runner.frame(parity, parity == 1, &[("frame", Some(Value::Frame(&frame)))]).unwrap();
    }
    let (width, height, stride) = (size.width as usize, size.height as usize, size.stride());
    let read = |id, channels: usize| runner.read(id, channels * stride * height).unwrap();
    let (system, link, flow) = (read(last.inputs[0], 5), read(last.inputs[1], 2), read(last.outputs[0].0, 2));
    let at = |image: &[f32], channels: usize, channel: usize, x: usize, y: usize| {
        f64::from(image[(channels * y + channel) * stride + x])
    };
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            let mut neighbours = Vec::new();
            if x > 0 {
                neighbours.push((at(&link, 2, 0, x - 1, y), x - 1, y));
            }
            if y > 0 {
                neighbours.push((at(&link, 2, 1, x, y - 1), x, y - 1));
            }
            if x + 1 < width {
                neighbours.push((at(&link, 2, 0, x, y), x + 1, y));
            }
            if y + 1 < height {
                neighbours.push((at(&link, 2, 1, x, y), x, y + 1));
            }
            let pulled = [0, 1].map(|channel| {
                let links = neighbours.iter().map(|(link, x, y)| link * at(&flow, 2, channel, *x, *y));
                at(&system, 5, 3 + channel, x, y) + links.sum::<f64>()
            });
            let [xx, xy, yy] = [0, 1, 2].map(|channel| at(&system, 5, channel, x, y));
            let u = xx * pulled[0] + xy * pulled[1] - at(&flow, 2, 0, x, y);
            let v = xy * pulled[0] + yy * pulled[1] - at(&flow, 2, 1, x, y);
            sum += u * u + v * v;
        }
    }
    (sum / size.pixels() as f64).sqrt()
}

/// The largest residual over the public pairs of each preset, in pixels, as the documentation states them.
const RESIDUALS_PX: [(&str, f64); 5] =
    [("fast", 0.025), ("default", 0.003), ("accurate", 5e-4), ("robust", 0.01), ("classic", 2e-6)];

#[test]
fn presets_reach_their_residuals() {
    let Some(pairs) = images_of_pairs() else { return };
    let mut problems = Vec::new();
    for (preset, bound) in RESIDUALS_PX {
        let config = HornSchunck::preset(preset).unwrap();
        let residuals: Vec<f64> =
            pairs.iter().map(|images| residual_px(&config, images.each_ref())).collect();
        println!("{preset}: {residuals:.6?} px");
        if !residuals.iter().all(|residual| *residual <= bound) {
            problems.push(format!("{preset}: {residuals:?} px, expected {bound} px at most"));
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
    // A fifth of the sweeps does not do.
    let config = HornSchunck { sweeps: HornSchunck::default().sweeps / 5, ..HornSchunck::default() };
    assert!(residual_px(&config, pairs[0].each_ref()) > RESIDUALS_PX[1].1);
}

#[test]
fn parameters_out_of_range_are_refused() {
    let refused = |name: &str, value: &str| {
        let mut algorithm = Algorithm::named("horn-schunck", "default").unwrap();
        let error = algorithm.set(name, value).and_then(|()| algorithm.validate()).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(value) && error.lines().count() == 1, "{error}");
    };
    for value in ["0", "-3", "NaN", "inf", "1001", "0.09"] {
        refused("alpha", value);
    }
    for value in ["0", "1", "NaN"] {
        refused("pyr_scale", value);
    }
    for (name, value) in
        [("levels", "33"), ("smallest", "7"), ("warps", "0"), ("warps", "101"), ("sweeps", "0")]
    {
        refused(name, value);
    }
    for (name, value) in
        [("sweeps", "21"), ("sweeps", "10002"), ("omega", "2"), ("omega", "0.5"), ("penalty", "cubic")]
    {
        refused(name, value);
    }
    let mut algorithm = Algorithm::named("horn-schunck", "default").unwrap();
    algorithm.set("penalty", "robust").unwrap();
    assert_eq!(algorithm, HornSchunck { penalty: Penalty::Robust, ..HornSchunck::default() }.into());
}
