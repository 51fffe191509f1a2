// From where lights of the surface that a pixel shows are looked for, and where its rays start. Drawn triangles have
// their corners on 256ths of pixels, so that pixels along an edge may show points beyond the wall that stands there:
// outside of a room, in the light. Between eye and pixel nothing is in the way but that wall, so a little nearer to the
// eye they are inside.

const TO_EYE = 0.03125;     // of a pixel's width there: eight times what the grid is off, for walls seen aslant
const RAISED = 2e-4;        // of the distance to the eye, both towards it and above the surface

// A pixel's width a metre away, m, of an image so many pixels high.
fn pixel_width(world_from_clip: mat4x4f, height: f32) -> f32 {
    return 2.0 * length(world_from_clip[1].xyz) / height;
}

// `pixel`: its width a metre away, m.
fn shown_point(p: vec3f, eye: vec3f, pixel: f32) -> vec3f {
    return p + (RAISED + TO_EYE * pixel) * (eye - p);
}

fn ray_start(p: vec3f, n: vec3f, eye: vec3f, pixel: f32) -> vec3f {
    return shown_point(p, eye, pixel) + RAISED * distance(eye, p) * n;
}
