// The summary of the cells in each sector of the view.

struct Params {
    columns: u32,
    rows: u32,
    cell_columns: u32,
    least_confidence: f32,
    least_both: f32,
    quantile: f32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> cells: array<f32>;   // channels: confidence along, x, y, dx/dt, dy/dt, confidence in every direction
@group(0) @binding(2) var<storage, read> looming: array<f32>; // channels: N, div, standard error of N, confidence
@group(0) @binding(3) var<storage, read> ranges: array<vec2f>; // of members: first and count, sector by sector
@group(0) @binding(4) var<storage, read> members: array<f32>; // cells, by their number
// Channels: coverage, N low, median and high, div, confidence, F (3), Σw n nᵀ (xx, xy, xz, yy, yz, zz), standard error
// of N.
@group(0) @binding(5) var<storage, read_write> sectors: array<f32>;

const SPAN = vec2u(1u, 1u);
const MAX_MEMBERS = 65536u;
const FEW = 24u; // up to so many members, ranks are found by comparing each with each

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let sector = min(id.xy, vec2u(params.columns, params.rows) - 1u);
    let range = ranges[sector.y * params.columns + sector.x];
    let first = u32(range.x);
    let count = u32(range.y);
    var valid = 0u;
    var confidence = 0.0;
    var error = 0.0;
    var flow = vec3f();
    var along = vec3f();  // moment xx, yy, zz
    var across = vec3f(); // moment xy, xz, yz
    for (var k = 0u; k < min(count, MAX_MEMBERS); k++) {
        let at = place(u32(members[first + k]));
        let w = looming[at.y + 3u * at.z];
        let known = w >= params.least_confidence;
        let sight = normalize(vec3f(cells[at.x + at.z], cells[at.x + 2u * at.z], 1.0));
        let rate = vec3f(cells[at.x + 3u * at.z], cells[at.x + 4u * at.z], 0.0);
        let f = (rate - sight * dot(sight, rate)) * sight.z;
        let normal = cross(sight, f);
        let share = select(0.0, w, known);
        // The direction of motion follows only from flow that is known in every direction.
        let every = cells[at.x + 5u * at.z];
        let certain = known && every >= params.least_both;
        let both = select(0.0, w * min(every / max(cells[at.x], 1e-6), 1.0), certain);
        valid += select(0u, 1u, known);
        confidence += share;
        error += share * looming[at.y + 2u * at.z];
        flow += share * f;
        along += both * normal * normal;
        across += both * normal.xxy * normal.yzz;
    }
    let low = f32(max(valid, 1u) - 1u);
    let ranks = vec3u(vec3f(floor(low * (1.0 - params.quantile) + 0.5), floor(low * 0.5 + 0.5),
        floor(low * params.quantile + 0.5)));
    let found = select_ranks(first, count, vec4u(ranks, ranks.z));
    let stride = (params.columns + 3u) / 4u * 4u;
    if id.x < stride && id.y < params.rows {
        let known = valid > 0u;
        let share = 1.0 / max(confidence, 1e-20);
        let out = 16u * id.y * stride + id.x;
        sectors[out] = f32(valid) / f32(max(count, 1u));
        sectors[out + stride] = select(0.0, value(found.x), known);
        sectors[out + 2u * stride] = select(0.0, value(found.y), known);
        sectors[out + 3u * stride] = select(0.0, value(found.z), known);
        sectors[out + 4u * stride] = select(0.0, value(found.w), known);
        sectors[out + 5u * stride] = confidence / f32(max(valid, 1u));
        sectors[out + 6u * stride] = flow.x * share;
        sectors[out + 7u * stride] = flow.y * share;
        sectors[out + 8u * stride] = flow.z * share;
        sectors[out + 9u * stride] = along.x;
        sectors[out + 10u * stride] = across.x;
        sectors[out + 11u * stride] = across.y;
        sectors[out + 12u * stride] = along.y;
        sectors[out + 13u * stride] = across.z;
        sectors[out + 14u * stride] = along.z;
        sectors[out + 15u * stride] = error * share;
    }
}

// Of the known members, the keys of N at three ranks, and of the divergence at the last one.
fn select_ranks(first: u32, count: u32, ranks: vec4u) -> vec4u {
    var found = vec4u();
    if count <= FEW {
        // A member's rank is the number of members that are smaller, or equal and before it.
        for (var k = 0u; k < min(count, FEW); k++) {
            let one = keys_of(first + k);
            var below = vec4u();
            for (var j = 0u; j < min(count, FEW); j++) {
                let other = keys_of(first + j);
                let before = (other.keys < one.keys) | ((other.keys == one.keys) & vec4<bool>(j < k));
                below += select(vec4u(), vec4u(1u), before & vec4<bool>(other.known));
            }
            found = select(found, one.keys, (below == ranks) & vec4<bool>(one.known));
        }
        return found;
    }
    // From the highest bit to the lowest, by counting smaller members.
    for (var bit = 0u; bit < 32u; bit++) {
        let guess = found | vec4u(0x80000000u >> bit);
        var below = vec4u();
        for (var k = 0u; k < min(count, MAX_MEMBERS); k++) {
            let one = keys_of(first + k);
            below += select(vec4u(), vec4u(1u), (one.keys < guess) & vec4<bool>(one.known));
        }
        found = select(guess, found, below > ranks);
    }
    return found;
}

struct Keys {
    keys: vec4u, // N three times, and the divergence
    known: bool,
}

fn keys_of(member: u32) -> Keys {
    let at = place(u32(members[member]));
    let n = key(looming[at.y]);
    let known = looming[at.y + 3u * at.z] >= params.least_confidence;
    return Keys(vec4u(n, n, n, key(max(looming[at.y + at.z], 0.0))), known);
}

// The indices of a cell in cells and in looming, and the distance of the channels there.
fn place(cell: u32) -> vec3u {
    let stride = (params.cell_columns + 3u) / 4u * 4u;
    let row = cell / params.cell_columns;
    let column = cell - row * params.cell_columns;
    return vec3u(6u * row * stride + column, 4u * row * stride + column, stride);
}

// Bits whose order is that of the numbers.
fn key(v: f32) -> u32 {
    // Both zeros are the same number.
    let bits = bitcast<u32>(v + 0.0);
    return select(bits | 0x80000000u, ~bits, bits >= 0x80000000u);
}

fn value(key: u32) -> f32 {
    return bitcast<f32>(select(~key, key & 0x7fffffffu, key >= 0x80000000u));
}
