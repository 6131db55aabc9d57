
// The finaliser of MurmurHash3, of a number that is not 0.
fn scrambled(number: vec4u) -> vec4u {
    var hash = number ^ vec4u(0x5bd1e995u);
    hash ^= hash >> vec4u(16u);
    hash *= 0x85ebca6bu;
    hash ^= hash >> vec4u(13u);
    hash *= 0xc2b2ae35u;
    return hash ^ (hash >> vec4u(16u));
}

fn scrambled_one(number: u32) -> u32 {
    var hash = number ^ 0x5bd1e995u;
    hash ^= hash >> 16u;
    hash *= 0x85ebca6bu;
    hash ^= hash >> 13u;
    hash *= 0xc2b2ae35u;
    return hash ^ (hash >> 16u);
}
