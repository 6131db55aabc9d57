//! Synthetic moving images, and both backends.

use viewsphere::frame::{FlowField, Image, PixelFormat, Size};
use viewsphere::{Backend, Config, Engine};

use crate::need;

/// The backends of this machine.
pub(crate) fn backends() -> Vec<(&'static str, Backend)> {
    let mut all = vec![("CPU", Backend::Cpu)];
    all.extend(need::gpu_if_any().map(|gpu| ("GPU", Backend::Gpu(gpu))));
    all
}

pub(crate) fn engine(backend: &Backend, size: Size, config: &Config) -> Engine {
    Engine::new(backend.clone(), size, config).unwrap()
}

/// Frame `n` of a scene that moves, waves and flickers, so that no two pairs have the same flow.
pub(crate) fn picture(n: u32, size: Size, format: PixelFormat) -> Image {
    let mut data = Vec::new();
    for y in 0..size.height {
        for x in 0..size.width {
            let t = f64::from(n);
            let (x, y) = (f64::from(x) + 1.3 * t, f64::from(y) - 0.7 * t + 0.1 * t * t);
            let value = |k: f64| {
                let wave =
                    (x * (0.31 + 0.01 * k)).sin() + (y * 0.23 + x * 0.05).cos() + (x * y * 0.003).sin();
                (wave + 3.0) / 6.0
            };
            match format {
                PixelFormat::Gray8 => data.push((255.0 * value(0.0)) as u8),
                PixelFormat::Gray16 => data.extend(((65535.0 * value(0.0)) as u16).to_ne_bytes()),
                PixelFormat::Rgb8 => data.extend([0.0, 1.0, 2.0].map(|k| (255.0 * value(k)) as u8)),
                PixelFormat::Rgba8 => {
                    data.extend([0.0, 1.0, 2.0, 9.0].map(|k| (255.0 * value(k)) as u8));
                }
            }
        }
    }
    Image { size, format, data }
}

pub(crate) fn gray(n: u32, size: Size) -> Image {
    picture(n, size, PixelFormat::Gray8)
}

/// Computes frames one after another and keeps the flows. The first frame gives none.
pub(crate) fn flows(engine: &mut Engine, images: &[Image]) -> Vec<FlowField> {
    let flow = |image: &Image| {
        let output = engine.process(&image.frame().unwrap()).unwrap();
        output.map(|output| output.flow.unwrap().clone())
    };
    let all: Vec<Option<FlowField>> = images.iter().map(flow).collect();
    assert!(all[0].is_none() && all[1..].iter().all(Option::is_some));
    all.into_iter().flatten().collect()
}

/// The bits of a flow, so that equal means the same bytes.
pub(crate) fn bits(flow: &FlowField) -> Vec<[u32; 2]> {
    flow.data.iter().map(|uv| uv.map(f32::to_bits)).collect()
}

/// Fails unless two flows have the same bytes and are not zero everywhere.
pub(crate) fn assert_same(a: &FlowField, b: &FlowField, what: &str) {
    assert_eq!(a.size, b.size, "{what}");
    assert!(a.data.iter().flatten().all(|v| v.is_finite()), "{what}: not finite");
    assert!(a.data.iter().flatten().any(|v| *v != 0.0), "{what}: no motion at all");
    let differing = bits(a).iter().zip(bits(b)).filter(|(a, b)| *a != b).count();
    assert_eq!(differing, 0, "{what}: pixels that differ");
}
