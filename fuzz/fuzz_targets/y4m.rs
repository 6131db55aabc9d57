#![no_main]

use libfuzzer_sys::fuzz_target;
use viewsphere::frame::Image;
use viewsphere::io::Y4mReader;

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut video) = Y4mReader::new(bytes, "fuzz") else { return };
    let mut image = Image::default();
    while let Ok(true) = video.next_frame(&mut image) {
        image.frame().expect("a frame that was read is whole");
    }
});
