//! use octahedron
//! use ray_triangles
//! needs fn ray_rows(pair: RayPair) -> RayRows

// Where a ray meets a surface, in the world.
struct Surface {
    position: vec3f,
    geometric_normal: vec3f,    // unit, out of the front; not turned towards the ray
    shading_normal: vec3f,      // interpolated, no map in it
    uv: vec2f,
    material: u32,              // its row in the scene's materials
}

// A normal from 2 x 10 bits.
fn ray_corner_normal(bits: u32) -> vec3f {
    return octahedron_decode(vec2f(vec2u(bits, bits >> 10u) & vec2u(1023u)) / 511.0 - 1.0);
}

// What lies at a hit, which has found something.
fn hit_point(hit: RayHit) -> Surface {
    let front = ray_rows(ray_triangles[2u * hit.triangle]);
    let back = ray_rows(ray_triangles[2u * hit.triangle + 1u]);
    // Position from the corner and two edges, normals and coordinates between the corners.
    let p = bitcast<vec4f>(front.first);
    let q = bitcast<vec4f>(front.second);
    let a = p.xyz;
    let edge_1 = vec3f(p.w, q.xy) - a;
    let edge_2 = vec3f(q.zw, bitcast<f32>(back.first.x)) - a;
    let at = a + hit.bary.x * edge_1 + hit.bary.y * edge_2;
    let n = back.second.zw;
    let shading = ray_corner_normal(n.x) * (1.0 - hit.bary.x - hit.bary.y)
        + ray_corner_normal(n.x >> 20u | n.y << 10u) * hit.bary.x + ray_corner_normal(n.y >> 10u) * hit.bary.y;
    let pair = RAY_INSTANCE_PAIRS * hit.instance;
    var made: Surface;
    made.uv = ray_uv(back, hit.bary);
    made.material = ray_rows(ray_instances[pair + 3u]).first.y;
    made.position = at;
    made.geometric_normal = normalize(cross(edge_1, edge_2));
    made.shading_normal = normalize(shading);
    if (RAYS_MEET_INSTANCES && (back.first.y & RAY_SHARED) != 0u) {
        // From the mesh's own space: normals turn by the inverse transpose.
        let u = ray_rows(ray_instances[pair]);
        let v = ray_rows(ray_instances[pair + 1u]);
        let w = ray_rows(ray_instances[pair + 2u]);
        let x = bitcast<vec4f>(u.first).xyz;
        let y = bitcast<vec4f>(u.second).xyz;
        let z = bitcast<vec4f>(v.first).xyz;
        let turns = mat3x3f(x, y, z);
        let point = vec4f(at, 1.0);
        made.position = vec3f(dot(bitcast<vec4f>(v.second), point), dot(bitcast<vec4f>(w.first), point),
            dot(bitcast<vec4f>(w.second), point));
        made.geometric_normal = normalize(turns * made.geometric_normal);
        made.shading_normal = normalize(turns * shading);
    }
    return made;
}
