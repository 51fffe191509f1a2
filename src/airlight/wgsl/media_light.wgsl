// How media attenuate light on its path from a light to a point. The including pass declares LightData too.
//! use media
//! use lights
//! needs fn light_columns_size(grid: u32) -> vec3u
//! needs fn light_columns_texel(grid: u32, uvw: vec3f) -> vec4f

// Mean density from a point on or in a grid's box towards light `light`. The texture holds four lights a texel,
// stacked along z; its texels lie on the box's borders too.
fn media_light_density(grid: u32, light: u32, uvw: vec3f) -> f32 {
    let size = light_columns_size(grid);
    let count = vec3f(vec3u(size.xy, size.z / LIGHT_GROUPS));
    let texel = saturate(uvw) * (count - 1.0) + 0.5;
    let slab = f32(light / 4u) * count.z;
    let at = vec3f(texel.xy, texel.z + slab) / vec3f(size);
    return light_columns_texel(grid, at)[light % 4u];
}

// From p: the direction to a light, and its distance, m.
fn media_light_path(light: LightData, p: vec3f) -> vec4f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return vec4f(-light.direction, MEDIUM_FAR);
    }
    let delta = light.position - p;
    let reach = length(delta);
    return vec4f(delta / max(reach, 1e-12), reach);
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
    if (GRID_COUNT > 0u && media[m].kind == MEDIUM_GRID) {
        column *= media_light_density(media[m].grid, index, medium_coordinates(m, p + a * path.xyz));
    }
    return column;
}

// Optical depth between p and a light: `index` its row of the table.
fn media_light_depth(light: LightData, index: u32, p: vec3f) -> vec3f {
    let path = media_light_path(light, p);
    var sum = vec3f(0.0);
    for (var m = 0u; m < MEDIA_COUNT; m++) {
        sum += media[m].sigma_t * media_light_column(m, index, p, path);
    }
    return sum;
}

// Transmittance of all media between a light and p.
fn media_light_transmittance(light: LightData, index: u32, p: vec3f) -> vec3f {
    return exp(-media_light_depth(light, index, p));
}
