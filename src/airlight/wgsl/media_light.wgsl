// How media attenuate light on its path from a light to a point. The including pass declares LightData too.
//! use media
//! use path_lists
//! use sized_light
//! needs fn light_columns_size() -> vec3f
//! needs fn light_columns_texel(at: vec3f) -> vec4f

// Mean density from a point on or in the box of grid m towards light `light`. Its part of the texture holds four
// lights a texel, stacked along z; texels lie on the box's borders too.
fn media_light_density(m: u32, light: u32, uvw: vec3f) -> f32 {
    let size = light_columns_size();
    var count = vec3f(size.xy, size.z / LIGHT_GROUPS);
    var first = vec3f(0.0);
    if (GRID_COUNT > 1u) {
        count = row_of_media(m).columns_count;
        first = row_of_media(m).columns_first;
    }
    let texel = saturate(uvw) * (count - 1.0) + 0.5 + first;
    let slab = f32(light / 4u) * count.z;
    let at = vec3f(texel.xy, texel.z + slab) / size;
    return light_columns_texel(at)[light % 4u];
}

// From p: the direction to a light, and its distance, m.
fn media_light_path(light: LightData, p: vec3f) -> vec4f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return vec4f(-light.direction, MEDIUM_FAR);
    }
    let delta = light.position - p;
    let reach = length(delta);
    let direction = delta / max(reach, 1e-12);
    if (has_size(light)) {
        return vec4f(direction, sized_reach(light, -delta));
    }
    return vec4f(direction, reach);
}

// Integral of medium m's density along that path, m; `index`: the light's row of the table.
fn media_light_column(m: u32, index: u32, p: vec3f, path: vec4f) -> f32 {
    let span = medium_interval(m, p, path.xyz);
    let a = max(span.x, 0.0);
    let b = min(span.y, path.w);
    if (a >= b) {
        return 0.0;
    }
    var column = b - a;
    if (GRID_COUNT > 0u && row_of_media(m).kind == MEDIUM_GRID) {
        column *= media_light_density(m, index, medium_coordinates(m, p + a * path.xyz));
    }
    return column;
}

// Optical depth between p and a light: `index` its row of the table.
fn media_light_depth(light: LightData, index: u32, p: vec3f) -> vec3f {
    let path = media_light_path(light, p);
    var sum = vec3f(0.0);
    var walk = walk_towards(index, p, path);
    loop {
        if (walk.medium != NO_MEDIUM) {
            let m = walk.medium;
            sum += row_of_media(m).sigma_t * media_light_column(m, index, p, path);
        }
        continuing {
            step_towards(&walk);
            break if walk.is_done;
        }
    }
    return sum;
}

// Transmittance of all media between a light and p, for light far from where it starts.
fn media_light_transmittance(light: LightData, index: u32, p: vec3f) -> vec3f {
    return transmittance_from_within(media_light_depth(light, index, p), light.inner_depth);
}
