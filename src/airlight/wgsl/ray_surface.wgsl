//! use octahedron
//! use ray_triangles

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
    let row = 4u * hit.triangle;
    let third = row_of_ray_triangles(row + 2u);
    let fourth = row_of_ray_triangles(row + 3u);
    // Position from the corner and two edges, normals and coordinates between the corners.
    let p = bitcast<vec4f>(row_of_ray_triangles(row));
    let q = bitcast<vec4f>(row_of_ray_triangles(row + 1u));
    let a = p.xyz;
    let edge_1 = vec3f(p.w, q.xy) - a;
    let edge_2 = vec3f(q.zw, bitcast<f32>(third.x)) - a;
    let at = a + hit.bary.x * edge_1 + hit.bary.y * edge_2;
    let n = fourth.zw;
    let shading = ray_corner_normal(n.x) * (1.0 - hit.bary.x - hit.bary.y)
        + ray_corner_normal(n.x >> 20u | n.y << 10u) * hit.bary.x + ray_corner_normal(n.y >> 10u) * hit.bary.y;
    let at_instance = RAY_INSTANCE_ROWS * hit.instance;
    var made: Surface;
    made.uv = ray_uv(third, fourth, hit.bary);
    made.material = row_of_ray_instances(at_instance + 6u).y;
    made.position = at;
    made.geometric_normal = normalize(cross(edge_1, edge_2));
    made.shading_normal = normalize(shading);
    if (RAYS_MEET_INSTANCES && (third.y & RAY_SHARED) != 0u) {
        // From the mesh's own space: normals turn by the inverse transpose.
        let x = bitcast<vec4f>(row_of_ray_instances(at_instance)).xyz;
        let y = bitcast<vec4f>(row_of_ray_instances(at_instance + 1u)).xyz;
        let z = bitcast<vec4f>(row_of_ray_instances(at_instance + 2u)).xyz;
        let turns = mat3x3f(x, y, z);
        let point = vec4f(at, 1.0);
        made.position = vec3f(dot(bitcast<vec4f>(row_of_ray_instances(at_instance + 3u)), point),
            dot(bitcast<vec4f>(row_of_ray_instances(at_instance + 4u)), point),
            dot(bitcast<vec4f>(row_of_ray_instances(at_instance + 5u)), point));
        made.geometric_normal = normalize(turns * made.geometric_normal);
        made.shading_normal = normalize(turns * shading);
    }
    return made;
}
