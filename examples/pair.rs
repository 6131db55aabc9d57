//! The flow from one image to another, as a `.flo` file: `pair a.png b.png out.flo`.

use viewsphere::gpu::{Gpu, GpuOptions};
use viewsphere::io::{flo, picture};
use viewsphere::{Backend, Config, Engine};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [first, second, out] = args.as_slice() else {
        return Err("usage: pair FIRST SECOND OUT.flo".into());
    };
    let (first, second) = (picture::read(first)?, picture::read(second)?);
    let backend = match Gpu::new(&GpuOptions::default()) {
        Ok(gpu) => Backend::Gpu(gpu),
        Err(error) => {
            eprintln!("{error}");
            Backend::Cpu
        }
    };
    let config = Config { format: first.format, ..Config::default() };
    let mut engine = Engine::new(backend, first.size, &config)?;
    eprintln!("on {}", engine.adapter());
    engine.process(&first.frame()?)?;
    let output = engine.process(&second.frame()?)?;
    if let Some(flow) = output.and_then(|output| output.flow) {
        flo::write(out, flow)?;
    }
    Ok(())
}
