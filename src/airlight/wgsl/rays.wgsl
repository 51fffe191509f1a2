//! use octahedron

// Rays against the triangles of a scene, through hierarchies laid out by rays/words.py: one of the instances, whose
// leaves lead to those of meshes. Who uses it binds RAY_SLOTS (rays/rays.py).

override RAYS_MEET_MASKS: bool = true;      // whether any instance has holes

const NO_HIT = 0xffffffffu;
const RAY_LEAF = 0x80000000u;
const RAY_INDEX = 0x0fffffffu;
const RAY_LEVELS = 24u;                     // of nodes, of instances and of a mesh together
const RAY_NO_INSTANCE = 0xffffffffu;
const RAY_INSTANCE_ROWS = 8u;

// `instance` is its row in the scene's order; `bary` are the shares of the second and of the third corner.
struct RayHit {
    t: f32,
    triangle: u32,
    instance: u32,
    bary: vec2f,
}

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
    let a = ray_nodes[4u * node];
    let b = ray_nodes[4u * node + 1u];
    let c = ray_nodes[4u * node + 2u];
    let children = ray_nodes[4u * node + 3u];

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
    let met = select(vec4u(0u), vec4u(1u, 2u, 4u, 8u), (enter <= leave) & (children != vec4u(0u)));
    var mask = met.x | met.y | met.z | met.w;

    // Children in the order of the halves that the ray comes to first.
    let axes = (vec3u(b.x) >> vec3u(0u, 2u, 4u)) & vec3u(3u);
    let upper = select(vec3u(1u), vec3u(0u), select(select(vec3<bool>(ray.near.x), vec3<bool>(ray.near.y),
        axes == vec3u(1u)), vec3<bool>(ray.near.z), axes == vec3u(2u)));
    mask = select(mask, (mask & 12u) | ((mask & 1u) << 1u) | ((mask & 2u) >> 1u), upper.y != 0u);
    mask = select(mask, (mask & 3u) | ((mask & 4u) << 1u) | ((mask & 8u) >> 1u), upper.z != 0u);
    mask = select(mask, ((mask & 3u) << 2u) | (mask >> 2u), upper.x != 0u);
    return node << 7u | upper.x << 4u | upper.y << 5u | upper.z << 6u | mask;
}

// The next child of a group, which has one.
fn ray_child(group: u32) -> u32 {
    let rank = firstTrailingBit(group);
    let half = (rank >> 1u) ^ ((group >> 4u) & 1u);
    let slot = half << 1u | ((rank & 1u) ^ ((group >> (5u + half)) & 1u));
    return ray_nodes[4u * (group >> 7u) + 3u][slot];
}

// `hit`, or the triangle where it is nearer. Edges that two triangles share belong to both: what rounding can do to
// the areas beside them is allowed for (Woop2013, in a basis around the ray), and no ray slips between.
fn ray_nearer(hit: RayHit, ray: RayIn, triangle: u32, instance: u32, t_min: f32) -> RayHit {
    let p = bitcast<vec4f>(ray_triangles[4u * triangle]);
    let q = bitcast<vec4f>(ray_triangles[4u * triangle + 1u]);
    let r = bitcast<f32>(ray_triangles[4u * triangle + 2u].x);
    let a = p.xyz - ray.origin;
    let b = vec3f(p.w, q.xy) - ray.origin;
    let c = vec3f(q.zw, r) - ray.origin;
    let x = vec3f(dot(a, ray.x), dot(b, ray.x), dot(c, ray.x));
    let y = vec3f(dot(a, ray.y), dot(b, ray.y), dot(c, ray.y));
    let one = x.zxy * y.yzx;
    let two = x.yzx * y.zxy;
    let area = one - two;
    let slack = (abs(one) + abs(two)) * 5e-7;
    let is_front = all(area >= -slack);
    let is_back = all(area <= slack);
    let inside = select(max(-area, vec3f(0.0)), max(area, vec3f(0.0)), is_front);
    let whole = inside.x + inside.y + inside.z;
    let share = inside / whole;
    let t = dot(share, vec3f(dot(a, ray.z), dot(b, ray.z), dot(c, ray.z)));
    if ((is_front || is_back) && whole > 0.0 && t >= t_min && t < hit.t) {
        let found = RayHit(t, triangle, instance, share.yz);
        if (!RAYS_MEET_MASKS || ray_is_there(found)) {
            return found;
        }
    }
    return hit;
}

// Whether a hit lies on a part of its material that is there, as its alpha says.
fn ray_is_there(hit: RayHit) -> bool {
    return true;
}

fn ray_in_instance(instance: u32, origin: vec3f, direction: vec3f) -> RayIn {
    let row = RAY_INSTANCE_ROWS * instance;
    let x = bitcast<vec4f>(ray_instances[row]);
    let y = bitcast<vec4f>(ray_instances[row + 1u]);
    let z = bitcast<vec4f>(ray_instances[row + 2u]);
    let point = vec4f(origin, 1.0);
    return ray_in(vec3f(dot(x, point), dot(y, point), dot(z, point)),
        vec3f(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)));
}

fn ray_traced(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, is_any: bool) -> RayHit {
    var hit = RayHit(t_max, NO_HIT, RAY_NO_INSTANCE, vec2f(0.0));
    var ray = ray_in(origin, direction);
    var stack: array<u32, RAY_LEVELS>;
    var depth = 0u;
    var entered = 0u;       // the depth at which the ray is the world's again
    var instance = RAY_NO_INSTANCE;
    var group = ray_group(0u, ray, t_min, t_max);
    loop {
        if ((group & 15u) == 0u) {
            if (depth == 0u) { break; }
            if (instance != RAY_NO_INSTANCE && depth == entered) {
                ray = ray_in(origin, direction);
                instance = RAY_NO_INSTANCE;
            }
            depth -= 1u;
            group = stack[depth];
        }
        let child = ray_child(group);
        group &= group - 1u;
        if (child >= RAY_LEAF && instance != RAY_NO_INSTANCE) {
            let first = child & RAY_INDEX;
            let end = first + ((child >> 28u) & 7u);
            for (var triangle = first; triangle <= end; triangle++) {
                hit = ray_nearer(hit, ray, triangle, instance, t_min);
            }
            if (is_any && hit.triangle != NO_HIT) { break; }
            continue;
        }
        if ((group & 15u) != 0u) {
            stack[depth] = group;
            depth += 1u;
        }
        var node = child;
        if (child >= RAY_LEAF) {
            instance = child & RAY_INDEX;
            entered = depth;
            ray = ray_in_instance(instance, origin, direction);
            node = ray_instances[RAY_INSTANCE_ROWS * instance + 6u].x;
        }
        group = ray_group(node, ray, t_min, hit.t);
    }
    return hit;
}

// The nearest triangle that origin + t * direction meets with t_min <= t < t_max, from whichever side; NO_HIT as
// its triangle where there is none.
fn nearest_hit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> RayHit {
    return ray_traced(origin, direction, t_min, t_max, false);
}

// Whether it meets any.
fn any_hit(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> bool {
    return ray_traced(origin, direction, t_min, t_max, true).triangle != NO_HIT;
}

// Where a ray meets a surface, in the world.
struct Surface {
    position: vec3f,
    geometric_normal: vec3f,    // unit, out of the front; not turned towards the ray
    shading_normal: vec3f,      // interpolated, no map in it
    uv: vec2f,
    material: u32,              // its row in the scene's materials
}

fn ray_corner_normal(word: u32) -> vec3f {
    return octahedron_decode(unpack2x16snorm(word));
}

fn ray_uv(r: vec4u, s: u32, bary: vec2f) -> vec2f {
    return bitcast<vec2f>(r.yz) + bary.x * unpack2x16float(r.w) + bary.y * unpack2x16float(s);
}

// What lies at a hit, which has found something.
fn hit_point(hit: RayHit) -> Surface {
    let p = bitcast<vec4f>(ray_triangles[4u * hit.triangle]);
    let q = bitcast<vec4f>(ray_triangles[4u * hit.triangle + 1u]);
    let r = ray_triangles[4u * hit.triangle + 2u];
    let s = ray_triangles[4u * hit.triangle + 3u];
    let a = p.xyz;
    let edge_1 = vec3f(p.w, q.xy) - a;
    let edge_2 = vec3f(q.zw, bitcast<f32>(r.x)) - a;
    let shares = vec3f(1.0 - hit.bary.x - hit.bary.y, hit.bary);
    let row = RAY_INSTANCE_ROWS * hit.instance;
    let point = vec4f(a + hit.bary.x * edge_1 + hit.bary.y * edge_2, 1.0);
    let shading = mat3x3f(ray_corner_normal(s.y), ray_corner_normal(s.z), ray_corner_normal(s.w)) * shares;

    // Normals turn by the inverse transpose.
    let x = bitcast<vec4f>(ray_instances[row]).xyz;
    let y = bitcast<vec4f>(ray_instances[row + 1u]).xyz;
    let z = bitcast<vec4f>(ray_instances[row + 2u]).xyz;
    let normals = mat3x3f(x, y, z);
    var made: Surface;
    made.position = vec3f(dot(bitcast<vec4f>(ray_instances[row + 3u]), point),
        dot(bitcast<vec4f>(ray_instances[row + 4u]), point), dot(bitcast<vec4f>(ray_instances[row + 5u]), point));
    made.geometric_normal = normalize(normals * normalize(cross(edge_1, edge_2)));
    made.shading_normal = normalize(normals * shading);
    made.uv = ray_uv(r, s.x, hit.bary);
    made.material = ray_instances[row + 6u].y;
    return made;
}
