//! The allocations per frame of a running stream.
//!
//! This is a process of its own: the counting allocator serves the whole program, and no other test may run beside this
//! one.
//!
//! On the CPU there are none, but for the job queue of rayon, which allocates a block now and then when images are
//! large enough to be shared out. On the GPU wgpu allocates in every submission, so the engine is compared with the
//! same work done with wgpu by hand. The two differ by a few allocations, within [`SLACK`] per frame, as wgpu itself
//! does not allocate the same in both: a bare `unmap` took two more in the engine, a submission three fewer; the engine
//! had 2.3 more on an idle machine, 4.8 on one with twice as many busy processes as cores. So the bound shows that the
//! engine allocates nothing as large as a buffer, and nothing per step. The memory held is compared exactly.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/need.rs"]
#[expect(dead_code, reason = "the CPU is tested in any case")]
mod need;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering::Relaxed};

use viewsphere::flow;
use viewsphere::frame::{Frame, PixelFormat, Size};
use viewsphere::gpu::{Gpu, GpuExecutor};
use viewsphere::plan::Plan;
use viewsphere::{Backend, Config, Engine, StreamConfig};
use wgpu::{BufferDescriptor, BufferUsages, MapMode, PollType};

/// Counts the calls of the system's allocator.
struct Counting;

static COUNT: AtomicU64 = AtomicU64::new(0);
static LIVE: AtomicI64 = AtomicI64::new(0);

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[allow(unsafe_code, reason = "an allocator cannot be written without; every call is handed on as it is")]
// SAFETY: the system's allocator does all the work, with the given arguments.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Relaxed);
        LIVE.fetch_add(layout.size() as i64, Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size() as i64, Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

const WARM_UP: usize = 30;
const FRAMES: usize = 300;
/// The engine's allowance of allocations per frame, of about a hundred, over the work by hand.
const SLACK: u64 = 8;

/// Two frames of noise.
fn noise(size: Size) -> [Vec<u8>; 2] {
    let mut state = 1u32;
    [0, 1].map(|_| {
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..size.pixels()).map(|_| next()).collect()
    })
}

/// The number of allocations for these frames, and the growth of the memory held.
fn measure(mut frame: impl FnMut(usize)) -> (u64, i64) {
    (0..WARM_UP).for_each(&mut frame);
    let (count, live) = (COUNT.load(Relaxed), LIVE.load(Relaxed));
    (WARM_UP..WARM_UP + FRAMES).for_each(&mut frame);
    (COUNT.load(Relaxed) - count, LIVE.load(Relaxed) - live)
}

fn stream(backend: Backend, size: Size, config: &Config) -> (u64, i64) {
    let mut engine = Engine::new(backend, size, config).unwrap();
    let data = noise(size);
    measure(|i| {
        let frame = Frame::new(size, PixelFormat::Gray8, &data[i & 1]).unwrap();
        let output = engine.process(&frame).unwrap();
        assert!(i == 0 || output.unwrap().flow.unwrap().data.len() == size.pixels());
        assert!(i == 0 || engine.latency().count > 0);
    })
}

/// The engine's work, by hand.
fn by_hand(gpu: &Gpu, plan: &Plan) -> (u64, i64) {
    let (device, queue) = (gpu.device(), gpu.queue());
    let exec = GpuExecutor::new(gpu, plan).unwrap();
    let (frame, flow) = (&plan.inputs[0], plan.output("flow").unwrap());
    let (frame_bytes, flow_bytes) = (4 * frame.kind.len() as u64, 4 * flow.kind.len() as u64);
    let buffer = |size, usage, mapped_at_creation| {
        device.create_buffer(&BufferDescriptor { label: Some("by hand"), size, usage, mapped_at_creation })
    };
    let upload = buffer(frame_bytes, BufferUsages::MAP_WRITE | BufferUsages::COPY_SRC, true);
    let readback = buffer(flow_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST, false);
    measure(|i| {
        let mut view = upload.get_mapped_range_mut(..).unwrap();
        view.slice(..).fill(i as u8);
        drop(view);
        upload.unmap();
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&upload, 0, exec.buf(frame.bufs[i & 1]), 0, frame_bytes);
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            exec.record_ingest(&mut pass, i & 1);
            exec.record_pair(&mut pass, i & 1);
        }
        encoder.copy_buffer_to_buffer(exec.buf(flow.bufs[i & 1]), 0, &readback, 0, flow_bytes);
        let submission_index = Some(queue.submit([encoder.finish()]));
        upload.map_async(MapMode::Write, .., |_| {});
        readback.map_async(MapMode::Read, .., |_| {});
        device.poll(PollType::Wait { submission_index, timeout: None }).unwrap();
        drop(readback.get_mapped_range(..).unwrap());
        readback.unmap();
    })
}

/// A single test, as the counters belong to the process.
#[test]
fn a_frame_takes_no_memory() {
    let small = Size::new(64, 48);
    for config in [
        Config::default(),
        Config {
            stream: StreamConfig { timestamps: true, ..StreamConfig::default() },
            warm_start: true,
            ..Config::default()
        },
    ] {
        assert_eq!(stream(Backend::Cpu, small, &config), (0, 0), "on the CPU");
    }
    let (count, live) = stream(Backend::Cpu, Size::new(320, 240), &Config::default());
    eprintln!("CPU, shared out: {count} allocations in {FRAMES} frames, {live} bytes more held");
    assert!(count <= FRAMES as u64, "{count} allocations in {FRAMES} frames");
    assert!(live.abs() < 64 << 10, "{live} bytes");

    let Some(gpu) = need::gpu_if_any() else { return };
    let config = Config::default();
    let plan = flow::plan(&config.algorithm, small, config.format, config.options()).unwrap();
    // Each on its own device: wgpu's allocations depend on how many resources a device has had.
    let open = || gpu.reopen().unwrap();
    let (hand, hand_live) = by_hand(&open(), &plan);
    let (ours, live) = stream(Backend::Gpu(open()), small, &config);
    eprintln!("by hand: {hand} allocations in {FRAMES} frames, {hand_live} bytes more held");
    eprintln!("engine:  {ours} allocations in {FRAMES} frames, {live} bytes more held");
    assert!(hand > 0, "the counter does not count");
    assert!(ours <= hand + SLACK * FRAMES as u64, "{ours} allocations, {hand} by hand");
    assert!(live < 64 << 10, "{live} bytes more after {FRAMES} frames");
}
