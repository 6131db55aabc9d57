//! A pair and a stream at 640×480, on the CPU and on a GPU if there is one: `cargo bench --bench flow`.
//!
//! `-- --test` runs each once. `python benches/opencv.py` compares with OpenCV, running both in alternation.

use std::fmt;
use std::sync::OnceLock;

use divan::Bencher;
use viewsphere::eval::Scene;
use viewsphere::frame::{Image, Size};
use viewsphere::gpu::{Gpu, GpuOptions};
use viewsphere::{Backend, Config, Engine};

const SIZE: Size = Size::new(640, 480);

fn main() {
    for on in backends() {
        println!("{on}: {}", engine(on).adapter());
    }
    divan::main();
}

/// A backend, displayed as `cpu` or `gpu`.
struct On(Backend);

impl fmt::Display for On {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self.0, Backend::Cpu) { "cpu" } else { "gpu" })
    }
}

fn backends() -> &'static [On] {
    static BACKENDS: OnceLock<Vec<On>> = OnceLock::new();
    BACKENDS.get_or_init(|| {
        let gpu = Gpu::new(&GpuOptions { allow_software: true, ..GpuOptions::default() });
        std::iter::once(Backend::Cpu).chain(gpu.ok().map(Backend::Gpu)).map(On).collect()
    })
}

fn engine(On(backend): &On) -> Engine {
    Engine::new(backend.clone(), SIZE, &Config::default()).expect("the default fits every adapter")
}

fn scene() -> [Image; 2] {
    let scene = Scene::new(SIZE).expect("a legal size");
    [0, 1].map(|number| scene.frame(number))
}

/// Computes the flow from the previous image and reads it back.
fn process(engine: &mut Engine, image: &Image) -> bool {
    let frame = image.frame().expect("a whole image");
    engine.process(&frame).expect("the device is there").is_some()
}

/// Both frames are new, as with unrelated pairs.
#[divan::bench(args = backends())]
fn pair(bencher: Bencher<'_, '_>, on: &On) {
    let (mut engine, images) = (engine(on), scene());
    bencher.bench_local(|| {
        engine.reset();
        images.each_ref().map(|image| process(&mut engine, image))
    });
}

/// The previous frame's expansion is reused.
#[divan::bench(args = backends())]
fn stream(bencher: Bencher<'_, '_>, on: &On) {
    let (mut engine, images) = (engine(on), scene());
    process(&mut engine, &images[1]);
    let mut next = images.iter().cycle();
    bencher.bench_local(|| next.next().map(|image| process(&mut engine, image)));
}
