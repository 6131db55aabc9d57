//! A rendered frame of the simulator at 320×240, on the CPU and on a GPU if there is one: `cargo bench --bench sim`.

use divan::Bencher;
use viewsphere::Backend;
use viewsphere::camera::{FRD_FROM_CAMERA, Pose, world_from_body};
use viewsphere::frame::Size;
use viewsphere::glam::DVec3;
use viewsphere::gpu::{Gpu, GpuOptions};
use viewsphere::sim::flight::camera;
use viewsphere::sim::{CourseKind, Renderer, RendererConfig};

fn main() {
    divan::main();
}

fn render(bencher: Bencher<'_, '_>, backend: Backend, course: &str) {
    let kind: CourseKind = course.parse().expect("a kind of course");
    let course = kind.course(3).expect("a legal seed");
    let mut renderer =
        Renderer::new(backend, &camera(Size::new(320, 240)), &course.world, &RendererConfig::default())
            .expect("the course fits");
    let position_world = course.start_ned_m + 30.0 * DVec3::X;
    let pose = Pose { position_world, world_from_camera: world_from_body(0.3, -0.05, 0.1) * FRD_FROM_CAMERA };
    let mut frame_seed = 0;
    bencher.bench_local(|| {
        frame_seed += 1;
        renderer.render(&pose, frame_seed).map(|image| image.data[0]).expect("the device is there")
    });
}

#[divan::bench(args = ["wall", "corridor", "city", "forest"])]
fn cpu(bencher: Bencher<'_, '_>, course: &str) {
    render(bencher, Backend::Cpu, course);
}

#[divan::bench(args = ["wall", "corridor", "city", "forest"])]
fn gpu(bencher: Bencher<'_, '_>, course: &str) {
    match Gpu::new(&GpuOptions { allow_software: true, ..GpuOptions::default() }) {
        Ok(gpu) => render(bencher, Backend::Gpu(gpu), course),
        Err(error) => println!("no GPU: {error}"),
    }
}
