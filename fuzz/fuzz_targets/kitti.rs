#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use viewsphere::io::kitti;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(flow) = kitti::decode(Path::new("fuzz"), bytes) {
        let again = kitti::encode(&flow).expect("what was read can be written");
        kitti::decode(Path::new("fuzz"), &again).expect("what was written can be read");
    }
});
