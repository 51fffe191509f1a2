// What the air takes from light on its way. The including pass declares LightData too.
//! use air
//! use lights

// Mean density from a place on or in a grid's box towards light `light`. The texture holds four
// lights a texel, stacked along z; its texels lie on the box's borders too.
fn air_light_density(grid: u32, light: u32, place: vec3f) -> f32 {
    let size = air_column_size(grid);
    let count = vec3f(vec3u(size.xy, size.z / AIR_LIGHT_GROUPS));
    let texel = saturate(place) * (count - 1.0) + 0.5;
    let slab = f32(light / 4u) * count.z;
    let uvw = vec3f(texel.xy, texel.z + slab) / vec3f(size);
    return air_columns(grid, uvw)[light % 4u];
}

// From p: the way to a light, and how far off it is.
fn air_light_way(light: LightData, p: vec3f) -> vec4f {
    if (light.kind == LIGHT_DIRECTIONAL) {
        return vec4f(-light.direction, MEDIUM_FAR);
    }
    let delta = light.position - p;
    let reach = length(delta);
    return vec4f(delta / max(reach, 1e-12), reach);
}

// Integral of medium m's density along that way, m; `index`: the light's row of the table.
fn air_light_column(m: u32, index: u32, p: vec3f, way: vec4f) -> f32 {
    let span = air_span(m, p, way.xyz);
    let a = max(span.x, 0.0);
    let b = min(span.y, way.w);
    if (a >= b) {
        return 0.0;
    }
    var column = b - a;
    if (AIR_GRIDS > 0u && air[m].kind == AIR_GRID) {
        column *= air_light_density(air[m].grid, index, air_place(m, p + a * way.xyz));
    }
    return column;
}

// Optical depth between p and a light: `index` its row of the table.
fn air_light_depth(light: LightData, index: u32, p: vec3f) -> vec3f {
    let way = air_light_way(light, p);
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        sum += air[m].sigma_t * air_light_column(m, index, p, way);
    }
    return sum;
}

// The share of a light that the air lets through to p.
fn air_light_transmittance(light: LightData, index: u32, p: vec3f) -> vec3f {
    return exp(-air_light_depth(light, index, p));
}
