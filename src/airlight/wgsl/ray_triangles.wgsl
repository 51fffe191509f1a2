
// Rays against triangles, and against the holes in their materials (rays/words.py, rays/masks.py).

const RAY_SHARED = 0x40000000u;
const RAY_HOLES = 0x80000000u;
const RAY_OWN_INSTANCE = 0x3fffffffu;

struct RayFound {
    hit: RayHit,
    is_doubtful: bool,      // whether it is new, and may lie in a hole of its material
}

// `hit`, or the triangle where it is nearer. Edges that two triangles share belong to both: what rounding can do to
// the areas beside them is allowed for (Woop2013, in a basis around the ray), and no ray slips between.
fn ray_nearer(hit: RayHit, ray: RayIn, triangle: u32, instance: u32, t_min: f32) -> RayFound {
    let p = bitcast<vec4f>(row_of_ray_triangles(4u * triangle));
    let q = bitcast<vec4f>(row_of_ray_triangles(4u * triangle + 1u));
    let last = row_of_ray_triangles(4u * triangle + 2u).xy;
    // In the ray's basis the ray is the z axis: areas of the corners' projections say whether it goes through.
    let a = p.xyz - ray.origin;
    let b = vec3f(p.w, q.xy) - ray.origin;
    let c = vec3f(q.zw, bitcast<f32>(last.x)) - ray.origin;
    let x = vec3f(dot(a, ray.x), dot(b, ray.x), dot(c, ray.x));
    let y = vec3f(dot(a, ray.y), dot(b, ray.y), dot(c, ray.y));
    let one = x.zxy * y.yzx;
    let two = x.yzx * y.zxy;
    let area = one - two;
    let slack = (abs(one) + abs(two)) * 5e-7;
    // From the front all areas are positive, from the back all negative; their shares are the barycentric coordinates.
    let is_front = all(area >= -slack);
    let is_back = all(area <= slack);
    let inside = select(max(-area, vec3f(0.0)), max(area, vec3f(0.0)), is_front);
    let whole = inside.x + inside.y + inside.z;
    let share = inside / max(whole, 1e-37);
    let t = dot(share, vec3f(dot(a, ray.z), dot(b, ray.z), dot(c, ray.z)));
    let is_met = (is_front || is_back) && whole > 0.0 && t >= t_min && t < hit.t;
    let own = last.y & RAY_OWN_INSTANCE;
    let row = select(own, instance, (last.y & RAY_SHARED) != 0u);
    return RayFound(RayHit(select(hit.t, t, is_met), select(hit.triangle, triangle, is_met),
        select(hit.instance, row, is_met), select(hit.bary, share.yz, is_met)), is_met && last.y >= RAY_HOLES);
}

// Texture coordinates at a place of a triangle, by the last two of its rows.
fn ray_uv(third: vec4u, fourth: vec4u, bary: vec2f) -> vec2f {
    return bitcast<vec2f>(third.zw) + bary.x * unpack2x16float(fourth.x) + bary.y * unpack2x16float(fourth.y);
}

// A texel of a mask from the word `first` on, 0 to 255.
fn ray_mask_texel(first: u32, size: vec2u, at: vec2f, wrap: vec2u) -> f32 {
    let s = vec2f(size);
    let mirrored = s - 0.5 - abs(at + 0.5 - 2.0 * s * floor((at + 0.5) / (2.0 * s)) - s);
    var p = select(at - s * floor(at / s), mirrored, wrap == vec2u(1u));
    p = select(p, at, wrap == vec2u(2u));
    let cell = vec2u(clamp(p, vec2f(0.0), s - 1.0));
    let index = cell.y * size.x + cell.x;
    let word = first + (index >> 2u);
    return f32((row_of_ray_instances(word >> 2u)[word & 3u] >> (8u * (index & 3u))) & 255u);
}

// A number from 0 to 1 for a hit, none like its neighbours' (Jarzynski2020, pcg).
fn ray_chance(hit: RayHit) -> f32 {
    let bits = bitcast<vec3u>(vec3f(hit.bary, hit.t));
    let state = (bits.x ^ (bits.y * 0x9e3779b9u) ^ (bits.z * 0x85ebca6bu) ^ hit.triangle) * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

override RAYS_MEET_TRANSLUCENT: bool = true;    // else they pass, as if nothing were there

// Whether a material is there at a hit, as the alpha of its instance's mask says, and, where it is translucent, chance.
fn ray_is_there(hit: RayHit) -> bool {
    let at = RAY_INSTANCE_ROWS * hit.instance;
    let mask = row_of_ray_instances(at + 6u);
    let first = mask.z;
    let limit = row_of_ray_instances(at + 8u);
    let met = bitcast<f32>(limit.w);
    if (!RAYS_MEET_TRANSLUCENT && met > 0.0) { return false; }
    if (first == 0u) { return met == 0.0 || ray_chance(hit) < met; }
    // Alpha of the mask, bilinear between its texels.
    let uv = ray_uv(row_of_ray_triangles(4u * hit.triangle + 2u), row_of_ray_triangles(4u * hit.triangle + 3u), hit.bary);
    let size = vec2u(mask.w & 0xffffu, mask.w >> 16u);
    let wrap = vec2u(limit.y & 3u, limit.y >> 2u);
    let scale = bitcast<vec4f>(row_of_ray_instances(at + 7u));
    let p = (uv * scale.xy + scale.zw) * vec2f(size) - 0.5;
    let corner = floor(p);
    let share = p - corner;
    let low = mix(ray_mask_texel(first, size, corner, wrap),
        ray_mask_texel(first, size, corner + vec2f(1.0, 0.0), wrap), share.x);
    let high = mix(ray_mask_texel(first, size, corner + vec2f(0.0, 1.0), wrap),
        ray_mask_texel(first, size, corner + 1.0, wrap), share.x);
    let alpha = mix(low, high, share.y) / 255.0;
    // Alpha cuts holes, of glass too; as coverage it thins the rest.
    let chance = met * select(1.0, alpha, row_of_ray_instances(at + 9u).x != 0u);
    return alpha >= bitcast<f32>(limit.x) && (met == 0.0 || ray_chance(hit) < chance);
}
