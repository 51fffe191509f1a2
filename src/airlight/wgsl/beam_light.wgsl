//! use ordinate_light
//! use surrounding_medium
//! needs fn inter_medium_irradiance(n: u32, cell: u32) -> vec3f

// An ordinate's light in a cell, attenuated by surfaces and a medium around this one. The including pass binds the
// resources of wgsl/ordinate_light.wgsl, `passed` (pop/light/paths.py)
// and those of wgsl/one_medium_beams.wgsl or mixed_media_beams.wgsl.
fn beam_light(n: u32, cell: u32, point: vec3f) -> OrdinateLight {
    var light = ordinate_light(n, point);
    light.irradiance *= passed[(params.ordinate_count + n) * params.cells + cell]
        * inter_medium_irradiance(n, cell) * passed_surrounding(point, light.travel, light.distance);
    return light;
}
