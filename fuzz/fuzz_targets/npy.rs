#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use viewsphere::io::npy;

fuzz_target!(|bytes: &[u8]| {
    let name = Path::new("fuzz");
    if let Ok(flow) = npy::decode(name, bytes) {
        let again = npy::encode(&flow).expect("what was read can be written");
        npy::decode(name, &again).expect("what was written can be read");
    }
    if let Ok(plane) = npy::decode_plane(name, bytes) {
        let again = npy::encode_plane(&plane).expect("what was read can be written");
        npy::decode_plane(name, &again).expect("what was written can be read");
    }
});
