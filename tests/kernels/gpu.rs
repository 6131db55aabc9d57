//! The device: pipelines kept in memory and on disk, variants of kernels, and the asynchronous calls.

use std::future::Future;
use std::path::Path;
use std::task::{Context, Poll, Waker};

use viewsphere::Error;
use viewsphere::flow;
use viewsphere::frame::Size;
use viewsphere::gpu::{Finished, Gpu, GpuExecutor, GpuOptions, Tuning, reflect_variant};
use viewsphere::kernel::{Kernel, Variant};
use viewsphere::kernels::{luma, premultiply, window_y};

use crate::need::{self, Without};

/// A separate device: the shared one's pipelines would spoil the counts.
fn open(pipeline_cache: Option<&Path>) -> Option<Gpu> {
    let adapter = Some(need::gpu()?.adapter().name.clone());
    let pipeline_cache = pipeline_cache.map(Path::to_owned);
    let options = GpuOptions { adapter, allow_software: true, pipeline_cache, ..GpuOptions::default() };
    Some(Gpu::new(&options).unwrap())
}

fn run(gpu: &Gpu, kernel: &Kernel) -> Result<Vec<Vec<f32>>, Error> {
    let case = (kernel.cases)(Size::new(7, 5)).remove(0);
    let inputs: Vec<&[f32]> = case.inputs.iter().map(Vec::as_slice).collect();
    let extent = [case.extent.width, case.extent.height];
    gpu.run_kernel(kernel, &case.params, &inputs, &case.outputs, extent)
}

fn mutant(kernel: &Kernel, from: &str, to: &str) -> Kernel {
    let source = kernel.source.replace(from, to);
    assert_ne!(source, kernel.source, "{from:?} does not stand in the shader");
    Kernel { source: source.leak(), ..*kernel }
}

#[test]
fn a_kernel_is_compiled_once_for_a_device_and_its_clones() {
    let Some(gpu) = open(None) else { return };
    assert_eq!(gpu.pipelines(), 0);
    let first = run(&gpu, &luma::KERNEL).unwrap();
    assert_eq!(gpu.pipelines(), 1);
    assert_eq!(run(&gpu.clone(), &luma::KERNEL).unwrap(), first);
    assert_eq!(gpu.pipelines(), 1, "the same kernel was compiled again");
    run(&gpu.clone(), &premultiply::KERNEL).unwrap();
    assert_eq!(gpu.pipelines(), 2, "what a clone compiles is kept for all");
}

#[test]
fn a_plan_and_a_single_run_share_their_pipelines() {
    let Some(gpu) = open(None) else { return };
    let config = viewsphere::Config::default();
    let plan = flow::plan(&config.algorithm, Size::new(64, 48), config.format, config.options()).unwrap();
    GpuExecutor::new(&gpu, &plan).unwrap();
    let compiled = gpu.pipelines();
    assert!(compiled > 5, "{compiled} pipelines");
    run(&gpu, &window_y::KERNEL).unwrap();
    GpuExecutor::new(&gpu, &plan).unwrap();
    assert_eq!(gpu.pipelines(), compiled);
}

#[test]
fn a_mutated_shader_under_the_same_name_is_another_kernel() {
    let Some(gpu) = open(None) else { return };
    let right = run(&gpu, &luma::KERNEL).unwrap();
    let wrong = run(&gpu, &mutant(&luma::KERNEL, "0xffu", "0x7fu"));
    assert_eq!(gpu.pipelines(), 2);
    assert_ne!(wrong.unwrap(), right);
    assert_eq!(run(&gpu, &luma::KERNEL).unwrap(), right);
}

#[test]
fn a_compiled_shader_is_still_held_against_another_kernel() {
    let Some(gpu) = open(None) else { return };
    run(&gpu, &luma::KERNEL).unwrap();
    let renamed = Kernel { outputs: &["grey"], ..luma::KERNEL };
    let error = run(&gpu, &renamed).unwrap_err();
    assert!(matches!(error, Error::Kernel { .. }), "{error}");
}

#[test]
fn a_tuning_takes_its_variant_and_keeps_the_bits() {
    let Some(gpu) = open(None) else { return };
    let default = run(&gpu, &window_y::KERNEL).unwrap();
    let mut tuning = Tuning::default();
    tuning.set(gpu.adapter().class, &window_y::KERNEL, "wide").unwrap();
    let wide = gpu.with_tuning(tuning.clone());
    assert_eq!(run(&wide, &window_y::KERNEL).unwrap(), default);
    assert_eq!(gpu.pipelines(), 2, "each set of constants has its own pipeline");

    let options = GpuOptions {
        adapter: Some(gpu.adapter().name.clone()),
        allow_software: true,
        tuning: tuning.clone(),
        ..GpuOptions::default()
    };
    let opened = Gpu::new(&options).unwrap();
    assert_eq!(opened.tuning(), &tuning);
    assert_eq!(run(&opened, &window_y::KERNEL).unwrap(), default);
    assert_eq!(gpu.with_tuning(tuning.clone()).reopen().unwrap().tuning(), &tuning);
}

#[test]
fn constants_are_resolved_without_a_gpu() {
    let wide = Variant { name: "wide", constants: &[("WORKGROUP_X", 64.0)] };
    assert_eq!(reflect_variant(&window_y::KERNEL, &Variant::DEFAULT).unwrap().workgroup, [32, 1]);
    let shape = reflect_variant(&window_y::KERNEL, &wide).unwrap();
    assert_eq!((shape.workgroup, shape.tile, shape.side_by_side), ([64, 1], [256, 8], 5));

    // SPAN in two overrides, one of them given by an expression.
    let spans = "override SPAN_X = 4u; override ROWS = 4u; override SPAN_Y = 2u * ROWS;";
    let spans = mutant(&window_y::KERNEL, "const SPAN = vec2u(4u, 8u);", spans);
    let spans = mutant(&spans, "id.y * SPAN.y", "id.y * SPAN_Y + 0u * SPAN_X");
    assert_eq!(reflect_variant(&spans, &Variant::DEFAULT).unwrap().tile, [128, 8]);
    let rows = Variant { name: "rows", constants: &[("ROWS", 1.0)] };
    assert_eq!(reflect_variant(&spans, &rows).unwrap().tile, [128, 2]);
    // The bound of a loop may be an override, too.
    let steps = mutant(&window_y::KERNEL, "const MAX_STEPS = 257u;", "override MAX_STEPS = 257u;");
    reflect_variant(&steps, &Variant::DEFAULT).unwrap();
}

#[test]
fn constants_that_do_not_fit_the_shader_are_refused() {
    let refused = |kernel: &Kernel, constants: &'static [(&'static str, f64)], reason: &str| {
        let error = reflect_variant(kernel, &Variant { name: "odd", constants }).unwrap_err();
        assert!(matches!(error, Error::Kernel { .. }), "{error}");
        assert!(error.to_string().contains(reason), "{error}, expected {reason:?}");
    };
    let unknown = "window_y: variant odd sets the constant WORKGROUP_Z, expected an override of the shader: \
                   WORKGROUP_X, WORKGROUP_Y";
    refused(&window_y::KERNEL, &[("WORKGROUP_Z", 1.0)], unknown);
    // A constant that is no override.
    refused(&window_y::KERNEL, &[("SIDE_BY_SIDE", 3.0)], "sets the constant SIDE_BY_SIDE");
    refused(&luma::KERNEL, &[("WORKGROUP_X", 64.0)], "expected an override of the shader: none");
    refused(&window_y::KERNEL, &[("WORKGROUP_X", 512.0)], "workgroup is 512×1×1");
    refused(&window_y::KERNEL, &[("WORKGROUP_X", 0.0)], "variant odd");
    refused(&window_y::KERNEL, &[("WORKGROUP_X", -1.0)], "variant odd");
    refused(&window_y::KERNEL, &[("WORKGROUP_X", f64::NAN)], "variant odd");
    let Some(gpu) = need::gpu_if_any().map(|shared| shared.reopen().unwrap()) else { return };
    let variants = &[Variant { name: "odd", constants: &[("WORKGROUP_Z", 1.0)] }];
    let error = run(&gpu, &Kernel { variants, ..window_y::KERNEL }).unwrap_err();
    assert!(error.to_string().contains(unknown), "{error}");
    assert_eq!(gpu.pipelines(), 0);
}

/// The only file of a folder, and its content.
fn only_file(folder: &Path) -> (std::path::PathBuf, Vec<u8>) {
    let files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    let [file] = files.as_slice() else { panic!("{files:?}") };
    (file.clone(), std::fs::read(file).unwrap())
}

#[test]
fn pipelines_are_kept_on_disk_and_a_damaged_file_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("made/when/needed");
    let Some(gpu) = open(Some(&cache)) else { return };
    let has = gpu.features().contains(wgpu::Features::PIPELINE_CACHE);
    let has = if has { Ok(()) } else { Err("the adapter has none") };
    if need::found("a pipeline cache", has, Without::Nothing).is_none() {
        return;
    }
    assert!(!cache.exists(), "nothing is written before something was compiled");
    let expected = run(&gpu, &luma::KERNEL).unwrap();
    let (file, whole) = only_file(&cache);
    // Undamaged and with every kind of damage: the same result, and an intact file afterwards.
    let half = whole[..whole.len() / 2].to_vec();
    let mut changed = whole.clone();
    *changed.last_mut().unwrap() ^= 1;
    for (content, damage) in [
        (whole.clone(), "none"),
        (half, "cut"),
        (changed, "changed"),
        (Vec::new(), "empty"),
        (b"something else altogether".to_vec(), "foreign"),
    ] {
        std::fs::write(&file, &content).unwrap();
        let gpu = open(Some(&cache)).unwrap();
        assert_eq!(run(&gpu, &luma::KERNEL).unwrap(), expected, "{damage}");
        let (again, found) = only_file(&cache);
        assert_eq!(again, file);
        assert_eq!(found[..8], whole[..8], "{damage}");
        assert_eq!(found == content, damage == "none", "{damage}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "not a folder").unwrap();
    let Some(gpu) = open(Some(&file)) else { return };
    run(&gpu, &luma::KERNEL).unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), b"not a folder");
    assert_eq!(only_file(folder.path()).0, file);
}

/// Polls a future, and the device in between, as a caller with its own loop does.
fn drive<F: Future>(gpu: Option<&Gpu>, future: F) -> F::Output {
    let mut future = std::pin::pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    for _ in 0..100_000 {
        if let Poll::Ready(output) = future.as_mut().poll(&mut context) {
            return output;
        }
        if let Some(gpu) = gpu {
            gpu.device().poll(wgpu::PollType::Poll).unwrap();
        }
    }
    panic!("never ready");
}

fn sendable<T: Send>(value: T) -> T {
    value
}

#[test]
fn asynchronous_calls_do_what_the_blocking_ones_do() {
    let Some(shared) = need::gpu() else { return };
    let adapter = Some(shared.adapter().name.clone());
    let options = GpuOptions { adapter, allow_software: true, ..GpuOptions::default() };
    let gpu = drive(None, sendable(Gpu::open(&options))).unwrap();
    assert_eq!(gpu.adapter(), shared.adapter());
    let again = drive(None, sendable(gpu.open_again())).unwrap();
    assert_eq!(again.adapter(), gpu.adapter());
    let error = drive(None, Gpu::from_device(gpu.device().clone(), gpu.queue().clone()).open_again());
    assert!(matches!(error, Err(Error::DeviceLost { .. })));

    let config = viewsphere::Config::default();
    let plan = flow::plan(&config.algorithm, Size::new(64, 48), config.format, config.options()).unwrap();
    let executor = drive(Some(&gpu), sendable(GpuExecutor::open(&gpu, &plan))).unwrap();
    let values: Vec<f32> = (0..64).map(|i| i as f32).collect();
    executor.write(plan.inputs[0].bufs[0], &values);
    assert_eq!(drive(Some(&gpu), sendable(executor.fetch(plan.inputs[0].bufs[0], 64))).unwrap(), values);
    assert_eq!(executor.read(plan.inputs[0].bufs[0], 64).unwrap(), values);
    drive(Some(&gpu), sendable(gpu.finished())).unwrap();
}

#[test]
fn the_end_of_what_was_submitted_is_told_to_a_waiting_task() {
    struct Flag(std::sync::atomic::AtomicBool);
    impl std::task::Wake for Flag {
        fn wake(self: std::sync::Arc<Self>) {
            self.0.store(true, std::sync::atomic::Ordering::SeqCst);
        }
    }
    let Some(gpu) = open(None) else { return };
    let flag = std::sync::Arc::new(Flag(false.into()));
    let waker = Waker::from(flag.clone());
    let mut finished: Finished = gpu.finished();
    let mut poll = || std::pin::Pin::new(&mut finished).poll(&mut Context::from_waker(&waker));
    assert!(poll().is_pending());
    gpu.finish().unwrap();
    assert!(flag.0.load(std::sync::atomic::Ordering::SeqCst), "the task was not woken");
    assert!(matches!(poll(), Poll::Ready(Ok(()))));
}

#[test]
fn a_lost_device_ends_the_wait() {
    let Some(gpu) = open(None) else { return };
    gpu.device().destroy();
    let finished = gpu.finished();
    assert!(gpu.finish().is_err());
    assert!(matches!(drive(None, finished), Err(Error::DeviceLost { .. })));
    assert!(matches!(run(&gpu, &luma::KERNEL), Err(Error::DeviceLost { .. })));
    assert_eq!(gpu.pipelines(), 0);
}
