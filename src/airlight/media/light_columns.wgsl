// The mean densities of a grid towards four lights.
//! use media
//! use lights

// The mean density from a point of the box to the light, or to where its path enters the box.
fn mean_density_towards(light: LightData, p: vec3f) -> f32 {
    var towards = -light.direction;
    var reach = MEDIUM_FAR;
    if (light.kind != LIGHT_DIRECTIONAL) {
        let delta = light.position - p;
        reach = length(delta);
        towards = delta / max(reach, 1e-12);
    }
    // On the border the path may have no length: then the density there is the mean.
    let shortest = 0.01 * media[params.medium].voxel;
    let end = max(min(medium_interval(params.medium, p, towards).y, reach), shortest);
    return medium_column(params.medium, p, towards, 0.0, end) / end;
}

@compute @workgroup_size(WX, WY, WZ) fn main(@builtin(global_invocation_id) id: vec3u) {
    let slabs = (params.light_count + 3u) / 4u;
    if (any(id >= vec3u(params.count.xy, params.count.z * slabs))) {
        return;
    }
    // The columns' box is the unit cube of the volume's own space; texels reach from border to border.
    let inside = vec3f(vec3u(id.xy, id.z % params.count.z)) / vec3f(params.count - 1u);
    let world = world_from_volume(inside);
    // A slab of texels for four lights.
    let first = 4u * (id.z / params.count.z);
    var means = vec4f(0.0);
    for (var k = 0u; k < 4u; k++) {
        if (first + k < params.light_count) {
            means[k] = mean_density_towards(lights[first + k], world);
        }
    }
    textureStore(columns, params.first + id, means);
}

// The inverse of the affine volume_from_world, by cofactors.
fn world_from_volume(p: vec3f) -> vec3f {
    let m = media[params.medium].volume_from_world;
    let a = m[0].xyz;
    let b = m[1].xyz;
    let c = m[2].xyz;
    let q = p - m[3].xyz;
    return vec3f(dot(q, cross(b, c)), dot(q, cross(c, a)), dot(q, cross(a, b)))
        / dot(a, cross(b, c));
}
