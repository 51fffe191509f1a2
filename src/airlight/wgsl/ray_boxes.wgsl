
// Rays against the boxes of a hierarchy's nodes, which rays/words.py lays out.

const RAY_LEAF = 0x80000000u;
const RAY_INDEX = 0x0fffffffu;
const RAY_PRESENT_SHIFT = 6u;    // of a bit for each child that a node has

// A ray in the space of the boxes and triangles that it is tested against.
struct RayIn {
    origin: vec3f,
    inverse: vec3f,         // of its direction
    x: vec3f,               // at right angles to it
    y: vec3f,
    z: vec3f,               // along it; the point at t is t along z
    near: vec3<bool>,       // whether boxes are entered through their lower sides
}

fn ray_in(origin: vec3f, direction: vec3f) -> RayIn {
    let squared = max(dot(direction, direction), 1e-37);
    let d = direction * inverseSqrt(squared);
    // A basis around d (Duff2017).
    let side = select(-1.0, 1.0, d.z >= 0.0);
    let a = -1.0 / (side + d.z);
    let b = d.x * d.y * a;
    let x = vec3f(1.0 + side * d.x * d.x * a, side * b, -side * d.x);
    let y = vec3f(b, side + d.y * d.y * a, -d.y);
    let least = 1e-18 * sqrt(squared);
    let steep = select(direction, select(vec3f(least), vec3f(-least), direction < vec3f(0.0)),
        abs(direction) < vec3f(least));
    return RayIn(origin, 1.0 / steep, x, y, direction / squared, steep > vec3f(0.0));
}

fn ray_bytes(word: u32) -> vec4f {
    return vec4f((vec4u(word) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u));
}

// The children of a node that a ray meets between t_min and t_max: its number << 7, for each of the three axes that
// divide it whether the ray comes from the upper side << 4, and a bit for each child, the nearest side's lowest.
fn ray_group(node: u32, ray: RayIn, t_min: f32, t_max: f32) -> u32 {
    let a = row_of_ray_nodes(4u * node);
    let b = row_of_ray_nodes(4u * node + 1u);
    let c = row_of_ray_nodes(4u * node + 2u);

    // A child's box begins and ends at begin + step * byte along each axis. What rounding can do to these is added
    // to both ends, so that no box is missed whose triangles are hit.
    let step = bitcast<vec3f>(vec3u(a.w << 16u, a.w & 0xffff0000u, b.x & 0xffff0000u)) * ray.inverse;
    let begin = (bitcast<vec3f>(a.xyz) - ray.origin) * ray.inverse;
    let slack = (abs(begin) + 255.0 * abs(step)) * 1e-6;
    let low = b.yzw;
    let high = c.xyz;
    let near = select(high, low, ray.near);
    let far = select(low, high, ray.near);
    let first = begin - slack;
    let last = begin + slack;
    let enter = max(max(first.x + step.x * ray_bytes(near.x), first.y + step.y * ray_bytes(near.y)),
        max(first.z + step.z * ray_bytes(near.z), vec4f(t_min)));
    let leave = min(min(last.x + step.x * ray_bytes(far.x), last.y + step.y * ray_bytes(far.y)),
        min(last.z + step.z * ray_bytes(far.z), vec4f(t_max)));
    let met = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), enter <= leave);
    var mask = (met.x | met.y | met.z | met.w) & (b.x >> RAY_PRESENT_SHIFT);

    // Children in the order of the halves that the ray comes to first.
    let axes = (vec3u(b.x) >> vec3u(0u, 2u, 4u)) & vec3u(3u);
    let upper = select(vec3u(1u), vec3u(0u), select(select(vec3<bool>(ray.near.x), vec3<bool>(ray.near.y),
        axes == vec3u(1u)), vec3<bool>(ray.near.z), axes == vec3u(2u)));
    mask = select(mask, (mask & 12u) | ((mask & 1u) << 1u) | ((mask & 2u) >> 1u), upper.y != 0u);
    mask = select(mask, (mask & 3u) | ((mask & 4u) << 1u) | ((mask & 8u) >> 1u), upper.z != 0u);
    mask = select(mask, ((mask & 3u) << 2u) | (mask >> 2u), upper.x != 0u);
    return node << 7u | upper.x << 4u | upper.y << 5u | upper.z << 6u | mask;
}

// The next child of a group.
fn ray_child(group: u32) -> u32 {
    let rank = select(select(select(3u, 2u, (group & 4u) != 0u), 1u, (group & 2u) != 0u), 0u, (group & 1u) != 0u);
    let half = (rank >> 1u) ^ ((group >> 4u) & 1u);
    let slot = half << 1u | ((rank & 1u) ^ ((group >> (5u + half)) & 1u));
    return row_of_ray_nodes(4u * (group >> 7u) + 3u)[slot];
}
