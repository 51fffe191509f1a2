//! use ordinate_light

// An ordinate's light in a cell, less what surfaces keep from it. The including pass binds what
// wgsl/ordinate_light.wgsl asks for, and `passed` (pop/paths.py).
fn beam_light(n: u32, cell: u32, point: vec3f) -> OrdinateLight {
    var light = ordinate_light(n, point);
    light.irradiance *= passed[(params.ordinate_count + n) * params.cells + cell];
    return light;
}
