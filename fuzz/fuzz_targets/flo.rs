#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use viewsphere::io::flo;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(flow) = flo::decode(Path::new("fuzz"), bytes) {
        let again = flo::encode(&flow).expect("what was read can be written");
        flo::decode(Path::new("fuzz"), &again).expect("what was written can be read");
    }
});
