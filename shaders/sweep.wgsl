// Two red-black sweeps of over-relaxation: all pixels of even x + y, then all odd ones, twice. Young 1954.
//
// A workgroup relaxes a tile and a rim of four pixels around it, from which nothing reaches the tile's own pixels in four
// half sweeps. An invocation has a square of four pixels, two of each colour.

struct Params {
    width: u32,
    height: u32,
    omega: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> system: array<f32>; // channels: (G + S)⁻¹ xx, xy, yy, and c_x, c_y
@group(0) @binding(2) var<storage, read> link: array<f32>;   // channels: to the right, down
@group(0) @binding(3) var<storage, read> flow: array<f32>;
@group(0) @binding(4) var<storage, read_write> relaxed: array<f32>;

// Pixels of a workgroup in x and y; with the rim there are 32.
const TILE = vec2u(24u, 24u);
const RIM = 4;
const SIDE = 32;

var<workgroup> tile: array<vec2f, 1024>;

@compute @workgroup_size(16, 16)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    // The upper left one of the four pixels, in the tile with its rim, and in the image.
    let here = 2 * vec2i(local.xy);
    let place = here + vec2i(group.xy * TILE) - RIM;
    // As the tile begins at even places, a pixel's colour is that of its place within the four.
    let a = pixel(place);
    let b = pixel(place + vec2i(1, 0));
    let c = pixel(place + vec2i(0, 1));
    let d = pixel(place + vec2i(1, 1));
    tile[at(here)] = displacement(place);
    tile[at(here + vec2i(1, 0))] = displacement(place + vec2i(1, 0));
    tile[at(here + vec2i(0, 1))] = displacement(place + vec2i(0, 1));
    tile[at(here + vec2i(1, 1))] = displacement(place + vec2i(1, 1));
    workgroupBarrier();
    for (var sweep = 0; sweep < 2; sweep++) {
        relax(here, a);
        relax(here + vec2i(1, 1), d);
        workgroupBarrier();
        relax(here + vec2i(1, 0), b);
        relax(here + vec2i(0, 1), c);
        workgroupBarrier();
    }
    store(here, place);
    store(here + vec2i(1, 0), place + vec2i(1, 0));
    store(here + vec2i(0, 1), place + vec2i(0, 1));
    store(here + vec2i(1, 1), place + vec2i(1, 1));
}

// A pixel's equations.
struct Pixel {
    inverse: vec3f, // (G + S)⁻¹: xx, xy, yy
    c: vec2f,
    links: vec4f, // to the left, to the right, up, down
}

fn inside(place: vec2i) -> bool {
    return all(place >= vec2i()) && all(place < vec2i(vec2u(params.width, params.height)));
}

fn pixel(place: vec2i) -> Pixel {
    if !inside(place) {
        return Pixel();
    }
    let stride = (params.width + 3u) / 4u * 4u;
    let x = u32(place.x);
    let y = u32(place.y);
    let i = 5u * y * stride + x;
    let right = 2u * y * stride + x;
    let down = right + stride;
    return Pixel(
        vec3f(system[i], system[i + stride], system[i + 2u * stride]),
        vec2f(system[i + 3u * stride], system[i + 4u * stride]),
        vec4f(
            select(0.0, link[max(right, 1u) - 1u], x > 0u),
            link[right],
            select(0.0, link[max(down, 2u * stride) - 2u * stride], y > 0u),
            link[down],
        ),
    );
}

fn displacement(place: vec2i) -> vec2f {
    if !inside(place) {
        return vec2f();
    }
    let i = 2u * u32(place.y) * ((params.width + 3u) / 4u * 4u) + u32(place.x);
    return vec2f(flow[i], flow[i + (params.width + 3u) / 4u * 4u]);
}

fn at(here: vec2i) -> i32 {
    // Beyond the tile's rim any value will do.
    let clamped = clamp(here, vec2i(), vec2i(SIDE - 1));
    return clamped.y * SIDE + clamped.x;
}

fn relax(here: vec2i, p: Pixel) {
    let d = tile[at(here)];
    let pulled = p.c
        + p.links.y * tile[at(here + vec2i(1, 0))]
        + p.links.x * tile[at(here - vec2i(1, 0))]
        + p.links.w * tile[at(here + vec2i(0, 1))]
        + p.links.z * tile[at(here - vec2i(0, 1))];
    let wanted = vec2f(dot(p.inverse.xy, pulled), dot(p.inverse.yz, pulled));
    tile[at(here)] = d + params.omega * (wanted - d);
}

fn store(here: vec2i, place: vec2i) {
    let stride = (params.width + 3u) / 4u * 4u;
    let own = all(here >= vec2i(RIM)) && all(here < vec2i(SIDE - RIM));
    if own && inside(place) {
        let x = u32(place.x);
        let row = 2u * u32(place.y) * stride;
        let d = tile[at(here)];
        relaxed[row + x] = d.x;
        relaxed[row + stride + x] = d.y;
        if x == params.width - 1u {
            // The surplus repeats the row's last pixel; there are three at most.
            for (var i = 1u; i < 4u; i++) {
                if x + i < stride {
                    relaxed[row + x + i] = d.x;
                    relaxed[row + stride + x + i] = d.y;
                }
            }
        }
    }
}
