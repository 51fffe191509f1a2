// Light on surfaces by a cube of irradiances per cell. The including pass binds sky_cube (a 3D texture,
// its six faces one behind the other) and linear_clamp.

// The face of the ambient cube that looks along one axis: 0 +x, 1 -x, 2 +y ...
fn sky_face(uvw: vec3f, face: f32) -> vec3f {
    let z = (face + uvw.z) / 6.0;
    return textureSampleLevel(sky_cube, linear_clamp, vec3f(uvw.xy, z), 0.0).rgb;
}

fn sky_irradiance(uvw: vec3f, n: vec3f) -> vec3f {
    let s = n * n;
    return s.x * sky_face(uvw, select(1.0, 0.0, n.x > 0.0))
        + s.y * sky_face(uvw, select(3.0, 2.0, n.y > 0.0))
        + s.z * sky_face(uvw, select(5.0, 4.0, n.z > 0.0));
}
