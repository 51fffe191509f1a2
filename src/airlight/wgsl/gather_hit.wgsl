// What a ray of a gather meets, as a texel of an image of hits. The including pass binds what rays and hit_albedo need,
// and the images: hit_positions, hit_normals, hit_albedos.
//! use rays
//! use hit_albedo
//! use hit_code
//! use ray_surface

const FARTHEST = 1e30;      // m

struct GatherHit {
    position: vec4f,        // m, hit_code; where the ray left the scene its direction, 0
    normal: vec4f,          // w: what light from all around adds to the albedo
    albedo: vec4f,
}

// Where no ray is sent: as if one had left the scene.
fn no_ray() -> GatherHit {
    return GatherHit(vec4f(0.0, 1.0, 0.0, 0.0), vec4f(0.0, 1.0, 0.0, 1.0), vec4f(0.0));
}

fn gather_hit(origin: vec3f, direction: vec3f) -> GatherHit {
    var found = GatherHit(vec4f(direction, 0.0), vec4f(0.0, 1.0, 0.0, 1.0), vec4f(0.0));
    let hit = nearest_hit(origin, direction, 0.0, FARTHEST);
    if (hit.triangle != NO_HIT) {
        let surface = hit_point(hit);
        // Surfaces have two sides; relief does not turn a side away from the ray that met it.
        let is_behind = dot(surface.geometric_normal, direction) > 0.0;
        let side = select(1.0, -1.0, is_behind);
        let smooth_normal = side * surface.shading_normal;
        let flat_normal = side * surface.geometric_normal;
        let normal = select(flat_normal, smooth_normal, dot(smooth_normal, flat_normal) > 0.0);
        let albedo = hit_albedo(surface.material, surface.uv, is_behind);
        found = GatherHit(vec4f(surface.position, hit_code(surface.material, is_behind)),
            vec4f(normal, albedo.a), vec4f(albedo.rgb, 0.0));
    }
    return found;
}

fn keep_hit(texel: vec2u, hit: GatherHit) {
    textureStore(hit_positions, texel, hit.position);
    textureStore(hit_normals, texel, hit.normal);
    textureStore(hit_albedos, texel, hit.albedo);
}
