// Rays from points in the air, by lobe_density or towards lit patches. The including pass binds `lit_patches`, and is
// FROM_AIR. Twins: maths.light_guide.
//! use gather
//! use light_guide

struct AirRay {
    direction: vec3f,
    density: f32,           // sr^-1, at which both kinds together choose it (Veach1995, the balance heuristic)
}

// `axis`: where light is scattered to, against which rays find it, and the mean cosine.
fn air_ray(place: vec3f, axis: vec4f, numbers: vec2f) -> AirRay {
    var out: AirRay;
    out.direction = lobe_direction(-axis.xyz, axis.w, numbers);
    // Towards a lit patch instead, for the part of rays that are led there.
    var led_density = 0.0;
    var part = 0.0;
    if (has_guide()) {
        var cones: PatchCones;
        let choice = guide_choice(place, -axis.w * axis.xyz, numbers.x, &cones);
        let one = led(choice, numbers.y);
        part = one.part;
        out.direction = lobe_direction(-axis.xyz, axis.w, vec2f(numbers.x, one.rest));
        if (one.is_led) {
            out.direction = cone_direction(choice.chosen.along, choice.chosen.height, vec2f(choice.number, one.rest));
        }
        led_density = density_of_cones(&cones, choice.total, out.direction);
    }
    // Either kind may have chosen the direction.
    let by_lobe = lobe_density(-dot(out.direction, axis.xyz), axis.w);
    out.density = (1.0 - part) * by_lobe + part * led_density;
    return out;
}
