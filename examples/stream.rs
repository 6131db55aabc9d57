//! The mean flow of each frame of a sequence: `stream frames/%04d.png`, `stream video.y4m` or `stream a.png b.png …`.
//! One frame is computed while the next one is read from disk.

use viewsphere::frame::{FlowField, Image};
use viewsphere::gpu::{Gpu, GpuOptions};
use viewsphere::io::Frames;
use viewsphere::stream::Ticket;
use viewsphere::{Backend, Config, Engine};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let mut frames = Frames::open(&args, None)?;
    let mut image = Image::default();
    if !frames.next_frame(&mut image)? {
        return Err("no frames".into());
    }
    let backend = match Gpu::new(&GpuOptions::default()) {
        Ok(gpu) => Backend::Gpu(gpu),
        Err(error) => {
            eprintln!("{error}");
            Backend::Cpu
        }
    };
    let config = Config { format: image.format, warm_start: true, ..Config::default() };
    let mut engine = Engine::new(backend, image.size, &config)?;
    eprintln!("on {}", engine.adapter());
    let mut pending = engine.submit(&image.frame()?)?;
    while frames.next_frame(&mut image)? {
        let next = engine.submit(&image.frame()?)?;
        show(&mut engine, pending)?;
        pending = next;
    }
    show(&mut engine, pending)?;
    let latency = engine.latency();
    eprintln!("latency: half within {:.1?}, 99 % within {:.1?}", latency.p50, latency.p99);
    Ok(())
}

fn show(engine: &mut Engine, ticket: Ticket) -> Result<(), Failure> {
    let Some(output) = engine.wait(ticket)? else { return Ok(()) };
    if let Some(FlowField { data, .. }) = output.flow {
        let sum = data.iter().fold([0.0, 0.0], |[u, v], uv| [u + f64::from(uv[0]), v + f64::from(uv[1])]);
        let [u, v] = sum.map(|sum| sum / data.len() as f64);
        println!("frame {}: {u:.3} {v:.3} pixels, {:.1?}", output.frame, output.latency);
    }
    Ok(())
}
