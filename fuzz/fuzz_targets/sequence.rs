#![no_main]

use libfuzzer_sys::fuzz_target;
use viewsphere::frame::sequence::{expand, natural};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    // Without its slashes a pattern stays in the working folder, which it only lists.
    let _ = expand(&text.replace('/', "_"));
    if let Some((a, b)) = text.split_once('/') {
        assert_eq!(natural(a, b), natural(b, a).reverse());
        assert_eq!(natural(a, b).is_eq(), a == b);
    }
});
