//! use footprint

// Maps of materials, read by passes that shade surfaces as they come.

override HAS_MAP_TRANSFORM: bool = true;      // whether any has a scale or an offset

struct MapCoordinates {
    uv: vec2f,
    dx: vec2f,
    dy: vec2f,
}

// Where a map is read, `transform` its scale and offset. Gradients come from the interpolated uv, and the scale
// goes on after: beside a triangle's edge some drivers read 0 from buffers in the lanes that only serve
// differences.
fn map_coordinates(uv: vec2f, transform: vec4f) -> MapCoordinates {
    let dx = dpdx(uv);
    let dy = dpdy(uv);
    if (HAS_MAP_TRANSFORM) {
        return MapCoordinates(uv * transform.xy + transform.zw, dx * transform.xy, dy * transform.xy);
    }
    return MapCoordinates(uv, dx, dy);
}

fn map_at(map: texture_2d<f32>, map_sampler: sampler, uv: vec2f, dx: vec2f, dy: vec2f) -> vec4f {
    let over = footprint(vec2f(textureDimensions(map)), uv, dx, dy);
    var sum = vec4f(0.0);
    var k = 0.0;
    loop {
        sum += textureSampleLevel(map, map_sampler, over.first + k * over.step, over.lod);
        k += 1.0;
        if (k >= over.probes) { break; }
    }
    return sum / over.probes;
}
