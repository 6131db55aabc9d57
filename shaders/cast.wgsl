// Ray casting: the first surface that each of a pixel's four samples hits, of those that its tile can see.

struct Params {
    width: u32,
    height: u32,
    tiles: u32, // in a row
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rays: array<vec4f>;     // x/z, y/z, width; their change per pixel
@group(0) @binding(2) var<storage, read> surfaces: array<vec4f>; // up, then six vectors per surface
@group(0) @binding(3) var<storage, read> tiles: array<vec4f>;    // of members: first box, boxes, first cylinder, cylinders
@group(0) @binding(4) var<storage, read> members: array<f32>;    // surfaces, nearest first
@group(0) @binding(5) var<storage, read_write> ids: array<vec4f>;

const SPAN = vec2u(1u, 2u);
const TILE = vec2u(16u, 8u);
const MAX_MEMBERS = 16384u;

@compute @workgroup_size(16, 4)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // Two rows of one tile, so that a surface is loaded once for both.
    let x = min(id.x, params.width - 1u);
    let y = min(vec2u(2u * id.y, 2u * id.y + 1u), vec2u(params.height - 1u));
    let stride = (params.width + 3u) / 4u * 4u;
    let upper = samples(2u * (y.x * stride + x));
    let lower = samples(2u * (y.y * stride + x));
    var seen = Samples(vec4f(FAR), vec4f());
    var below = seen;
    let tile = tiles[y.x / TILE.y * params.tiles + x / TILE.x];
    let first_box = u32(tile.x);
    for (var i = 0u; i < min(u32(tile.y), MAX_MEMBERS); i++) {
        let at = 6u * u32(members[first_box + i]) + 1u;
        let size = surfaces[at + 3u];
        // All surfaces that follow are as far away or further.
        if all(max(seen.distance, below.distance) < vec4f(size.w)) {
            break;
        }
        let lx = surfaces[at];
        let ly = surfaces[at + 1u];
        let lz = surfaces[at + 2u];
        seen = cuboid(upper, lx, ly, lz, size.xyz, f32(8u * (at / 6u)), seen);
        below = cuboid(lower, lx, ly, lz, size.xyz, f32(8u * (at / 6u)), below);
    }
    let first_cylinder = u32(tile.z);
    for (var i = 0u; i < min(u32(tile.w), MAX_MEMBERS); i++) {
        let at = 6u * u32(members[first_cylinder + i]) + 1u;
        let size = surfaces[at + 3u];
        if all(max(seen.distance, below.distance) < vec4f(size.w)) {
            break;
        }
        let lx = surfaces[at];
        let ly = surfaces[at + 1u];
        let lz = surfaces[at + 2u];
        seen = cylinder(upper, lx, ly, lz, size.xz, f32(8u * (at / 6u)), seen);
        below = cylinder(lower, lx, ly, lz, size.xz, f32(8u * (at / 6u)), below);
    }
    if id.x < stride && 2u * id.y < params.height {
        ids[2u * id.y * stride + id.x] = seen.id;
    }
    if id.x < stride && 2u * id.y + 1u < params.height {
        ids[(2u * id.y + 1u) * stride + id.x] = below.id;
    }
}

fn samples(at: u32) -> Rays {
    let ray = rays[at];
    let slope = rays[at + 1u];
    let x = ray.x + slope.x * OFFSET_X + slope.y * OFFSET_Y;
    let y = ray.y + slope.z * OFFSET_X + slope.w * OFFSET_Y;
    let z = inverseSqrt(x * x + y * y + 1.0);
    return Rays(x * z, y * z, z);
}

// Four unit rays.
struct Rays {
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

struct Samples {
    distance: vec4f,
    id: vec4f,
}

const FAR = 1e30;

fn along(d: Rays, row: vec4f) -> vec4f {
    let l = row.x * d.x + row.y * d.y + row.z * d.z;
    // Nothing is quite parallel to anything.
    return select(l, vec4f(1e-12), abs(l) < vec4f(1e-12));
}

fn cuboid(d: Rays, x: vec4f, y: vec4f, z: vec4f, half: vec3f, base: f32, seen: Samples) -> Samples {
    let lx = along(d, x);
    let ly = along(d, y);
    let lz = along(d, z);
    let ix = 1.0 / lx;
    let iy = 1.0 / ly;
    let iz = 1.0 / lz;
    let hx = half.x * abs(ix);
    let hy = half.y * abs(iy);
    let hz = half.z * abs(iz);
    let near_x = -x.w * ix - hx;
    let near_y = -y.w * iy - hy;
    let near_z = -z.w * iz - hz;
    let far_x = -x.w * ix + hx;
    let far_y = -y.w * iy + hy;
    let far_z = -z.w * iz + hz;
    let enter = max(max(near_x, near_y), near_z);
    let leave = min(min(far_x, far_y), far_z);
    // From the inside, the face behind is visible.
    let outside = enter > vec4f();
    let distance = select(leave, enter, outside);
    let hit = (enter <= leave) & (leave > vec4f()) & (distance < seen.distance);
    let on_x = distance == select(far_x, near_x, outside);
    let on_y = distance == select(far_y, near_y, outside);
    let l = select(select(lz, ly, on_y), lx, on_x);
    let axis = select(select(vec4f(4.0), vec4f(2.0), on_y), vec4f(), on_x);
    let side = select(vec4f(), vec4f(1.0), (l > vec4f()) != outside);
    // A surface without height has one face.
    let face = select(axis + side, vec4f(), vec4<bool>(half.z == 0.0));
    return Samples(select(seen.distance, distance, hit), select(seen.id, base + face + 1.0, hit));
}

fn cylinder(d: Rays, x: vec4f, y: vec4f, z: vec4f, size: vec2f, base: f32, seen: Samples) -> Samples {
    let lx = along(d, x);
    let ly = along(d, y);
    let lz = along(d, z);
    let a = lx * lx + ly * ly;
    let b = x.w * lx + y.w * ly;
    // Moment of the ray about the axis: no two large numbers are subtracted.
    let w = x.w * ly - y.w * lx;
    let square = size.x * size.x * a - w * w;
    let root = sqrt(max(square, vec4f()));
    let ia = 1.0 / a;
    let iz = 1.0 / lz;
    let hz = size.y * abs(iz);
    let near = (-b - root) * ia;
    let far = (-b + root) * ia;
    let near_z = -z.w * iz - hz;
    let far_z = -z.w * iz + hz;
    let enter = max(near, near_z);
    let leave = min(far, far_z);
    let outside = enter > vec4f();
    let distance = select(leave, enter, outside);
    let hit = (square >= vec4f()) & (enter <= leave) & (leave > vec4f()) & (distance < seen.distance);
    let mantle = distance == select(far, near, outside);
    let lid = select(vec4f(1.0), vec4f(2.0), (lz > vec4f()) != outside);
    let face = select(lid, vec4f(), mantle);
    return Samples(select(seen.distance, distance, hit), select(seen.id, base + face + 1.0, hit));
}
