// Shading: the gray level and the nearness of each pixel, from the surfaces that its samples hit.

struct Params {
    width: u32,
    height: u32,
    share: f32, // of this image in the sum
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rays: array<vec4f>;     // x/z, y/z, width; their change per pixel
@group(0) @binding(2) var<storage, read> surfaces: array<vec4f>; // up, then six vectors per surface
@group(0) @binding(3) var<storage, read> ids: array<vec4f>;      // of the four samples
@group(0) @binding(4) var<storage, read> before: array<f32>;     // the sum so far
@group(0) @binding(5) var<storage, read_write> gray: array<f32>;
@group(0) @binding(6) var<storage, read_write> nearness: array<f32>;

const SPAN = vec2u(1u, 1u);
const HORIZON = 170.0;
const ZENITH = 60.0;
const LIGHT = 0.15;
const TURN = 6.2831855;
// The angle's tangent, by its square, to 4e-8 turns.
const ATAN = array<f32, 7>(0.15915433, -0.05302624, 0.03152512, -0.02106151, 0.0126725, -0.00534827, 0.00108413);

@compute @workgroup_size(64, 1)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let stride = (params.width + 3u) / 4u * 4u;
    let pixel = min(id.xy, vec2u(params.width, params.height) - 1u);
    let at = pixel.y * stride + pixel.x;
    let ray = rays[2u * at];
    let slope = rays[2u * at + 1u];
    let seen = ids[at];
    let up = surfaces[0].xyz;
    let centre = normalize(vec3f(ray.xy, 1.0));
    var left = vec4f(1.0);
    var sum = 0.0;
    // The inverse distance at the centre, of the face that the centre hits and of all faces that the samples hit.
    var met = 0.0;
    var any_met = 0.0;
    var sky = false;
    // One iteration for each face that is seen.
    for (var i = 0u; i < 4u; i++) {
        if !(dot(left, vec4f(1.0)) > 0.0) {
            break;
        }
        let one = select(select(select(seen.w, seen.z, left.z > 0.0), seen.y, left.y > 0.0), seen.x, left.x > 0.0);
        let same = select(vec4f(), left, seen == vec4f(one));
        left -= same;
        let share = dot(same, vec4f(1.0));
        let offset = vec2f(dot(same, OFFSET_X), dot(same, OFFSET_Y)) / share;
        let d = normalize(vec3f(ray.xy + slope.xz * offset.x + slope.yw * offset.y, 1.0));
        let code = u32(max(one - 1.0, 0.0));
        let face = face_of(code);
        let middle = meet(face, centre);
        let inverse = 1.0 / middle.distance;
        met = max(met, select(0.0, inverse, one > 0.0 && middle.within));
        any_met = max(any_met, select(0.0, inverse, one > 0.0));
        sky = sky || !(one > 0.0);
        var level = HORIZON + ZENITH * dot(d, up);
        let of_surface = lit(face, meet(face, d), up, select(0.0, ray.z, one > 0.0));
        level = clamp(select(level, of_surface, one > 0.0), 0.0, 255.0);
        sum += 0.25 * share * level;
    }
    // The area between the samples is assumed to show what they hit.
    let near = select(any_met, met, met > 0.0 || sky);
    if id.x < stride && id.y < params.height {
        let shown = ray.z > 0.0;
        let out = id.y * stride + id.x;
        gray[out] = before[out] + params.share * select(0.0, sum, shown);
        nearness[out] = select(0.0, near, shown);
    }
}

// A face that is seen. Its axes are those of its surface, in such an order that the last one leads across the face, or
// along the axis of a mantle.
struct Face {
    u: vec4f, // the axes, and the camera's place along them
    v: vec4f,
    n: vec4f,
    half: vec3f,
    rest: vec3f, // the camera's place in the texture beyond the cells
    cells: vec3f,
    side: f32, // on which side the face lies
    mantle: bool,
    lid: bool,
    seed: u32,
}

fn face_of(code: u32) -> Face {
    let at = 6u * (code / 8u) + 1u;
    let size = surfaces[at + 3u];
    let texture = surfaces[at + 4u];
    let cells = surfaces[at + 5u];
    let face = code % 8u;
    let round = cells.w == 2.0;
    let across = select(face / 2u, 2u, cells.w > 0.0);
    let first = (across + 1u) % 3u;
    let second = (across + 2u) % 3u;
    let upper = select(face % 2u == 1u, face == 2u, round);
    return Face(surfaces[at + first], surfaces[at + second], surfaces[at + across], turned(size, across),
        turned(texture, across), turned(cells, across), select(-1.0, 1.0, upper), round && face == 0u,
        round && face > 0u, 8u * u32(texture.w) + face);
}

// In the order of a face's axes.
fn turned(v: vec4f, across: u32) -> vec3f {
    return select(select(v.xyz, v.zxy, across == 1u), v.yzx, across == 0u);
}

struct Met {
    distance: f32,
    l: vec3f,     // the ray along the face's axes
    place: vec3f, // along the face's axes
    within: bool, // whether the ray meets the face, and not only its continuation
}

fn meet(f: Face, d: vec3f) -> Met {
    let l = vec3f(dot(f.u.xyz, d), dot(f.v.xyz, d), dot(f.n.xyz, d));
    let o = vec3f(f.u.w, f.v.w, f.n.w);
    let flat = (f.side * f.half.z - o.z) / select(l.z, 1e-12, abs(l.z) < 1e-12);
    let a = max(l.x * l.x + l.y * l.y, 1e-24);
    let b = o.x * l.x + o.y * l.y;
    let w = o.x * l.y - o.y * l.x;
    let radius = f.half.x;
    let square = radius * radius * a - w * w;
    let inside = o.x * o.x + o.y * o.y < radius * radius && abs(o.z) <= f.half.z;
    let root = sqrt(max(square, 0.0));
    let curved = (-b + select(-root, root, inside)) / a;
    let met = select(flat, curved, f.mantle);
    let distance = max(met, 1e-6);
    let place = o + distance * l;
    let beyond = abs(place) - f.half;
    // What is negative is on the face.
    let off_lid = place.x * place.x + place.y * place.y - radius * radius;
    let off_flat = select(max(beyond.x, beyond.y), off_lid, f.lid);
    let off = select(off_flat, max(beyond.z, -square), f.mantle);
    return Met(distance, l, place, met > 0.0 && off <= 0.0);
}

// Of a pixel that is `width` wide; of width 0, without texture.
fn lit(f: Face, met: Met, up: vec3f, width: f32) -> f32 {
    let normal = select(vec3f(0.0, 0.0, 1.0), vec3f(met.place.xy / f.half.x, 0.0), f.mantle);
    let facing = dot(normal, met.l);
    let up_along = vec3f(dot(f.u.xyz, up), dot(f.v.xyz, up), dot(f.n.xyz, up));
    let light = 1.0 + LIGHT * select(1.0, -1.0, facing > 0.0) * dot(normal, up_along);
    let rest = f.rest + met.distance * met.l;
    let place = select(rest.xy, vec2f(turns(met.place.xy), rest.z), f.mantle);
    let cells = select(f.cells.xy, vec2f(0.0, f.cells.z), f.mantle);
    let footprint = log2_of(met.distance * width) - 2.0 / 3.0 * log2_of(max(abs(facing), 1e-12));
    // Seen from nowhere, the finest octave is too fine.
    return light * textured(place, vec2i(cells), select(0.0, TURN * f.half.x, f.mantle), f.seed,
        select(99.0, footprint, width > 0.0));
}

// The angle of a place about the origin, in turns from −½ to ½, without WGSL's atan2, which may be off by more.
fn turns(v: vec2f) -> f32 {
    let a = abs(v);
    let t = min(a.x, a.y) / max(max(a.x, a.y), 1e-30);
    let q = t * t;
    let octant = t * (ATAN[0] + q * (ATAN[1] + q * (ATAN[2] + q * (ATAN[3] + q * (ATAN[4] + q * (ATAN[5] + q * ATAN[6]))))));
    let quadrant = select(octant, 0.25 - octant, a.y > a.x);
    let half = select(quadrant, 0.5 - quadrant, v.x < 0.0);
    return select(half, -half, v.y < 0.0);
}
