//! The benchmark's results as text.

use crate::benchmark::{PipelineFigures, StreamFigures};
use crate::cli::print::table;

/// The figures of one backend at one frame size, as text.
pub(super) fn stream(figures: &StreamFigures) -> String {
    let StreamFigures { startup, frame_ms, .. } = figures;
    let mut text = format!(
        "{}×{} on {}, {} frames\n\
         frame      median {:.2} ms, p99 {:.2} ms, best {:.2} ms; {:.0} frames/s\n\
         start-up   engine {:.1} ms, first frame {:.1} ms, first pair {:.1} ms\n\
         memory     {:.1} MiB of buffers\n\
         copy       {:.2} GB/s, read plus written\n\n",
        figures.width,
        figures.height,
        figures.backend,
        figures.frames,
        frame_ms.median,
        frame_ms.p99,
        frame_ms.min,
        1e3 / frame_ms.median,
        startup.engine_ms,
        startup.first_frame_ms,
        startup.first_pair_ms,
        figures.buffer_bytes as f64 / f64::from(1 << 20),
        figures.copy_gb_s,
    );
    if figures.kernels.is_empty() {
        return text + "kernels    no times: the device has no timestamps\n";
    }
    let head = ["kernel", "steps", "median ms", "p99 ms", "moved MB", "Mflop", "GB/s", "of copy"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for kernel in &figures.kernels {
        rows.push(vec![
            kernel.kernel.to_owned(),
            kernel.steps.to_string(),
            format!("{:.3}", kernel.ms.median),
            format!("{:.3}", kernel.ms.p99),
            format!("{:.2}", kernel.bytes as f64 / 1e6),
            kernel.flops.map_or_else(|| "-".to_owned(), |flops| format!("{:.1}", flops as f64 / 1e6)),
            format!("{:.2}", kernel.gb_s),
            format!("{:.0} %", 100.0 * kernel.share_of_copy),
        ]);
    }
    text += &table(&rows);
    let sum: f64 = figures.kernels.iter().map(|kernel| kernel.ms.median).sum();
    let used = || figures.kernels.iter().filter(|kernel| !kernel.optional);
    let flops: Option<u64> = used().map(|kernel| kernel.flops).sum();
    text + &format!(
        "all kernels {sum:.2} ms by the {} clock; a frame without options: {} steps, {:.0} MB, {}\n",
        if figures.clock == "gpu" { "GPU's" } else { "host's" },
        used().map(|kernel| kernel.steps).sum::<usize>(),
        used().map(|kernel| kernel.bytes).sum::<u64>() as f64 / 1e6,
        flops.map_or_else(
            || "operations not counted".to_owned(),
            |flops| format!("{:.0} Mflop", flops as f64 / 1e6)
        ),
    )
}

/// The figures of whole pipelines, as text.
pub(super) fn pipelines(figures: &PipelineFigures) -> String {
    let head = ["", "median ms", "p99 ms", "of the stream", "of the pairs"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for contender in &figures.contenders {
        rows.push(vec![
            contender.name.to_owned(),
            format!("{:.2}", contender.ms.median),
            format!("{:.2}", contender.ms.p99),
            format!("{:.2}", contender.of_stream),
            format!("{:.2}", contender.of_pairs),
        ]);
    }
    let PipelineFigures { width, height, backend, frames, .. } = figures;
    format!("{width}×{height} on {backend}, {frames} frames, interleaved\n{}", table(&rows))
}
