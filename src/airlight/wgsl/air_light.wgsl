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

// Optical depth between p and a light: `index` its row of the table.
fn air_light_depth(light: LightData, index: u32, p: vec3f) -> vec3f {
    var way = -light.direction;
    var reach = MEDIUM_FAR;
    if (light.kind != LIGHT_DIRECTIONAL) {
        let delta = light.position - p;
        reach = length(delta);
        way = delta / max(reach, 1e-12);
    }
    var sum = vec3f(0.0);
    for (var m = 0u; m < AIR_COUNT; m++) {
        let span = air_span(m, p, way);
        let a = max(span.x, 0.0);
        let b = min(span.y, reach);
        if (a < b) {
            var column = b - a;
            if (AIR_GRIDS > 0u && air[m].kind == AIR_GRID) {
                column *= air_light_density(air[m].grid, index, air_place(m, p + a * way));
            }
            sum += air[m].sigma_t * column;
        }
    }
    return sum;
}

// The share of a light that the air lets through to p.
fn air_light_transmittance(light: LightData, index: u32, p: vec3f) -> vec3f {
    return exp(-air_light_depth(light, index, p));
}
