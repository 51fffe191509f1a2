// What the sky's beams are multiplied by where they scatter towards `travel`, in the medium's frame;
// see maths/sky_phase.py. The including pass binds `sky_correction`, `sky_sampler` and `view`.

fn sky_correction_towards(travel: vec3f) -> vec3f {
    let d = -(view.sky_from_medium * vec4f(travel, 0.0)).xyz;
    let u = atan2(d.x, -d.z) / 6.283185307179586;
    let v = acos(clamp(d.y, -1.0, 1.0)) / 3.141592653589793;
    return textureSampleLevel(sky_correction, sky_sampler, vec2f(u - floor(u), v), 0.0).rgb;
}
