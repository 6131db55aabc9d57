//! Flow of frames with a certainty: masked pixels do no harm, and the flow of the others does not change.

use viewsphere::flow::Farneback;
use viewsphere::frame::{FlowField, Image, PixelFormat, Plane, Size};
use viewsphere::kernels::{normalized_expansion_x, normalized_expansion_y, tables, test_inputs::Random};

use crate::need;
use crate::pair::{Beside, On, flow_with};

const SIZE: Size = Size::new(161, 121);
const MOTION: [f32; 2] = [2.5, -1.25];
/// Left, top, right and bottom of a region that does not move with the rest.
const LOGO: [usize; 4] = [60, 45, 100, 75];

/// An image and its certainty.
type Frame = (Image, Plane);

fn farneback() -> Farneback {
    Farneback { levels: 2, ..Farneback::default() }
}

/// Whether a pixel is in the region or at most `margin` pixels from it.
fn near_logo(x: usize, y: usize, margin: usize) -> bool {
    let [left, top, right, bottom] = LOGO;
    (left..right + 2 * margin).contains(&(x + margin)) && (top..bottom + 2 * margin).contains(&(y + margin))
}

/// A texture that moves by [`MOTION`], with or without a logo that stays, and the certainty of its pixels.
fn frames(logo: bool, certainty: impl Fn(usize, usize) -> f32) -> [Frame; 2] {
    [0.0, 1.0].map(|time| {
        let mut random = Random::new(5);
        let mut bytes = Vec::new();
        let mut certainties = Vec::new();
        for y in 0..SIZE.height as usize {
            for x in 0..SIZE.width as usize {
                let [u, v] = [x as f32 - time * MOTION[0], y as f32 - time * MOTION[1]];
                let waves = [[0.31, 0.17], [-0.23, 0.29], [0.11, -0.37], [0.43, 0.05]];
                let sum: f32 =
                    waves.iter().zip(1..).map(|([a, b], n)| (a * u + b * v + n as f32).sin()).sum();
                let noise = 255.0 * random.next();
                let value = if logo && near_logo(x, y, 0) { noise } else { 128.0 + 28.0 * sum };
                bytes.push(value.round() as u8);
                certainties.push(certainty(x, y));
            }
        }
        (
            Image { size: SIZE, format: PixelFormat::Gray8, data: bytes },
            Plane { size: SIZE, data: certainties },
        )
    })
}

/// The flow of two images, with or without their certainty.
fn flow_of(on: On<'_>, farneback: Farneback, with: bool, frames: &[Frame; 2]) -> FlowField {
    let [(first, first_certainty), (second, second_certainty)] = frames;
    let certainty = with.then_some([first_certainty, second_certainty]);
    flow_with(on, farneback, [first, second], Beside { certainty, ..Beside::default() })
}

fn flow_on_cpu(with: bool, frames: &[Frame; 2]) -> FlowField {
    flow_of(On::Cpu, farneback(), with, frames)
}

/// The flow of each pixel: column, row, x, y.
fn pixels(flow: &FlowField) -> impl Iterator<Item = (usize, usize, [f32; 2])> + '_ {
    let width = SIZE.width as usize;
    flow.data.iter().enumerate().map(move |(i, flow)| (i % width, i / width, *flow))
}

/// The mean error of the flow around the logo, not in it.
fn error_around(flow: &FlowField) -> f32 {
    let errors: Vec<f32> = pixels(flow)
        .filter(|&(x, y, _)| near_logo(x, y, 12) && !near_logo(x, y, 0))
        .map(|(_, _, [u, v])| (u - MOTION[0]).hypot(v - MOTION[1]))
        .collect();
    errors.iter().sum::<f32>() / errors.len() as f32
}

fn largest_difference(a: &FlowField, b: &FlowField) -> f32 {
    let (a, b) = (a.data.as_flattened(), b.data.as_flattened());
    assert!(a.iter().chain(b).all(|d| d.is_finite()), "every flow is a number");
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn certainty_of_one_changes_nothing() {
    let frames = frames(true, |_, _| 1.0);
    for (poly_n, poly_sigma) in [(5, 1.2), (7, 1.5), (1, 0.0), (32, 0.0), (32, 100.0)] {
        let [without, with] = [false, true].map(|certainty| {
            flow_of(On::Cpu, Farneback { poly_n, poly_sigma, ..farneback() }, certainty, &frames)
        });
        let difference = largest_difference(&without, &with);
        let largest = without.data.as_flattened().iter().fold(0.0f32, |largest, d| largest.max(d.abs()));
        println!("radius {poly_n}, sigma {poly_sigma}: {difference:e} of {largest:e} px");
        // Rounding of the expansion, some 10⁻⁴ of a gray level, through two levels of three iterations. Relative to the
        // largest flow, because that of the widest neighbourhoods is small.
        assert!(difference < 1e-3 * largest, "radius {poly_n}, sigma {poly_sigma}: {difference} px");
    }
}

/// The equations are quadratic in the contrast, so a certainty of a half in both frames acts as half the contrast.
#[test]
fn a_certainty_of_a_half_is_as_half_the_contrast() {
    let with_bytes = |change: fn(u8) -> u8| {
        frames(true, |_, _| 0.5).map(|(mut image, certainty)| {
            image.data.iter_mut().for_each(|byte| *byte = change(*byte));
            (image, certainty)
        })
    };
    let (whole, half) = (with_bytes(|byte| byte & !1), with_bytes(|byte| byte / 2));
    let difference = largest_difference(&flow_on_cpu(false, &half), &flow_on_cpu(true, &whole));
    println!("{difference:e} px");
    // Rounding, as in the comparison of a certainty of 1 with none.
    assert!(difference < 2e-3, "{difference} px");
}

#[test]
fn masked_region_does_not_disturb_its_surroundings() {
    let frames = frames(true, |x, y| if near_logo(x, y, 0) { 0.0 } else { 1.0 });
    let without = error_around(&flow_on_cpu(false, &frames));
    let with = error_around(&flow_on_cpu(true, &frames));
    println!("without {without} px, with {with} px");
    assert!(with < 0.1 && 3.0 * with < without, "without {without} px, with {with} px");
}

#[test]
fn what_is_in_a_masked_region_has_no_effect() {
    let mask = |x, y| if near_logo(x, y, 0) { 0.0 } else { 1.0 };
    let (blank, full) = (frames(false, mask), frames(true, mask));
    assert_ne!(blank, full);
    assert_eq!(flow_on_cpu(true, &blank), flow_on_cpu(true, &full));
}

#[test]
fn no_certainty_gives_no_flow() {
    for nothing in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        let flow = flow_on_cpu(true, &frames(true, |_, _| nothing));
        assert!(flow.data.iter().all(|d| *d == [0.0; 2]), "of certainty {nothing}");
    }
}

#[test]
fn certainties_out_of_range_are_clamped_to_it() {
    let held = frames(true, |x, y| if near_logo(x, y, 0) { 0.0 } else { 1.0 });
    let wild = frames(true, |x, y| if near_logo(x, y, 0) { f32::NAN } else { 7.0 + x as f32 });
    assert_eq!(flow_on_cpu(true, &held), flow_on_cpu(true, &wild));
}

#[test]
fn both_executors_agree() {
    let Some(gpu) = need::gpu() else { return };
    let frames = frames(true, |x, y| match near_logo(x, y, 0) {
        true => 0.0,
        false => 0.25 + 0.75 * (x % 16) as f32 / 15.0,
    });
    let expected = flow_on_cpu(true, &frames);
    let found = flow_of(On::Gpu(&gpu), farneback(), true, &frames);
    let difference = largest_difference(&expected, &found);
    println!("{difference:e} px");
    // Rounding of the expansion, as in the comparison of a certainty of 1 with none.
    assert!(difference < 2e-3, "{difference} px");
}

/// A quadratic that is known in a half-plane gives its own coefficients up to a pixel beyond the edge, and zero where
/// too little is known.
#[test]
fn expansion_is_exact_up_to_the_edge_of_a_mask() {
    const EDGE: usize = 24;
    const NOTHING_FROM: usize = EDGE + 2;
    let size = Size::new(48, 40);
    let stride = size.stride();
    let quadratic = |x: f32, y: f32| 60.0 + 0.5 * x - 0.25 * y + 0.02 * x * x - 0.01 * y * y + 0.03 * x * y;
    let mut weighted = vec![0.0; stride * size.height as usize];
    let mut certainty = weighted.clone();
    for (i, (f, c)) in weighted.iter_mut().zip(&mut certainty).enumerate() {
        // A mask's edge after smoothing.
        *c = [1.0, 0.75, 0.25, 0.0][(i % stride + 1).saturating_sub(EDGE).min(3)];
        *f = *c * quadratic((i % stride) as f32, (i / stride) as f32);
    }
    let applicability = tables::applicability(5, 1.2);
    let mut moments = vec![0.0; 8 * weighted.len()];
    let params =
        normalized_expansion_y::Params { width: size.width, height: size.height, radius: 5, outside: 1.0 };
    let weights = tables::applicability_from(&applicability.weights, 5);
    (normalized_expansion_y::KERNEL.reference)(
        bytemuck::bytes_of(&params),
        &[&weighted, &certainty, &weights],
        &mut [&mut moments],
    );
    let mut quad = vec![f32::NAN; 4 * weighted.len()];
    let mut cross_term = vec![f32::NAN; weighted.len()];
    let mut known = vec![f32::NAN; weighted.len()];
    (normalized_expansion_x::KERNEL.reference)(
        bytemuck::bytes_of(&normalized_expansion_x::Params::new(size, 5, 1.0)),
        &[&moments, &tables::applicability_from(&applicability.weights, 8)],
        &mut [&mut quad, &mut cross_term, &mut known],
    );
    for y in 5..size.height as usize - 5 {
        for x in 5..size.width as usize {
            let i = y * stride + x;
            let found = [quad[4 * i], quad[4 * i + 1], quad[4 * i + 2], quad[4 * i + 3], cross_term[i]];
            if x >= NOTHING_FROM {
                assert_eq!((found, known[i]), ([0.0; 5], 0.0), "at {x}, {y}");
            } else if x <= EDGE + 1 {
                let (fx, fy) = (x as f32, y as f32);
                let [b_x, b_y] = [0.5 + 0.04 * fx + 0.03 * fy, -0.25 - 0.02 * fy + 0.03 * fx];
                for (found, expected) in found.into_iter().zip([b_x, b_y, 0.02, -0.01, 0.03]) {
                    // Roundings of sums of up to 130, times ten for the small pivots there.
                    assert!((found - expected).abs() < 1e-3, "at {x}, {y}: {found} for {expected}");
                }
                assert!(known[i] > 0.1 && known[i] < 1.0 + 1e-6, "at {x}, {y}: certainty {}", known[i]);
            }
        }
    }
}
