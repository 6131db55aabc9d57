#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use viewsphere::io::picture;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(image) = picture::decode(Path::new("fuzz"), bytes) {
        let again = picture::encode_png(&image).expect("what was read can be written");
        let back = picture::decode(Path::new("fuzz"), &again).expect("what was written can be read");
        assert_eq!(image, back);
    }
});
