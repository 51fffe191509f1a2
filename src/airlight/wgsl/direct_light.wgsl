// What local lights, directional lights and the background send, and how much of it arrives. The including pass
// binds the lights with their shadow maps and the environment, and declares `light_transmittance` and
// `panes_passed`.
//! use lights
//! use shadow
//! use surface_reflection
//! needs fn light_transmittance(index: u32, p: vec3f) -> vec3f
//! needs fn panes_passed(light: LightData, p: vec3f, n: vec3f, in: Incoming) -> vec3f
//! needs fn looking_point(p: vec3f) -> vec3f
//! needs fn arriving_share(lit: f32, p: vec3f, n: vec3f, in: Incoming) -> f32

override HAS_DIRECTIONAL: bool = true;
override HAS_LOCAL: bool = true;
override IS_ONE_DIRECTIONAL: bool = false;      // the only light

fn background(direction: vec3f) -> vec3f {
    let u = atan2(direction.x, -direction.z) / (2.0 * PI)
        + params.environment_rotation / (2.0 * PI);
    var v = acos(clamp(direction.y, -1.0, 1.0)) / PI;
    // Where there is a horizon, sky and ground do not blend: each is read to its own last row.
    if (direction.y > 0.0) {
        v = min(v, 0.5 - params.horizon);
    } else {
        v = max(v, 0.5 + params.horizon);
    }
    let texel = textureSampleLevel(environment, environment_sampler, vec2f(u, v), 0.0);
    let far = texel.rgb + texel.a * params.map_sun_colour;
    let is_disk = direction.y > 0.0 && dot(direction, params.towards_sun) > params.sun_cosine;
    return far + select(vec3f(0.0), params.sun_radiance, is_disk);
}

fn light_visibility(light: LightData, p: vec3f, n: vec3f, in: Incoming) -> f32 {
    if (IS_ONE_DIRECTIONAL) {
        return lit_share(parallel_shadows, shadow_compare, first_parallel_views(), 0u, p, n,
            in.to_light, 1.0);
    }
    let view = view_of(light, in.to_light);
    if (HAS_DIRECTIONAL && (!HAS_LOCAL || light.kind == LIGHT_DIRECTIONAL)) {
        return lit_share(parallel_shadows, shadow_compare, row_of_parallel_views(view), view, p, n,
            in.to_light, 1.0);
    }
    return lit_share(local_shadows, shadow_compare, row_of_local_views(view), view, p, n, in.to_light,
        in.distance);
}

fn light_at(i: u32) -> LightData {
    if (IS_ONE_DIRECTIONAL) {
        return first_lights();
    }
    return row_of_lights(i);
}

fn arriving_from(light: LightData, p: vec3f) -> Incoming {
    if (!HAS_LOCAL) {
        return Incoming(-light.direction, light.color, 1e30);
    }
    return incoming(light, p);
}

fn direct_light(r: Reflector, p: vec3f, n: vec3f, v: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    if (!HAS_DIRECTIONAL && !HAS_LOCAL) {
        return sum;
    }
    let from_here = looking_point(p);
    // CPU adapters run a loop's body once more than a test at its head would let them, and both
    // sides of every branch: loops end with their test.
    var i = 0u;
    loop {
        let light = light_at(i);
        let in = arriving_from(light, p);
        let cosine = dot(n, in.to_light);
        if (cosine > 0.0 && any(in.irradiance > vec3f(0.0))) {
            let lit = arriving_share(light_visibility(light, from_here, n, in), from_here, n, in);
            if (lit > 0.0) {
                let passed = light_transmittance(i, p) * panes_passed(light, p, n, in);
                let arriving = in.irradiance * passed * cosine * lit;
                sum += reflection(r, n, in.to_light, v) * arriving;
            }
        }
        i++;
        if (IS_ONE_DIRECTIONAL || i >= params.light_count) {
            break;
        }
    }
    return sum;
}
