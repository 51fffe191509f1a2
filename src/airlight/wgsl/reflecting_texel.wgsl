//! use light_texel

// A texel of a reflective shadow map as light for a medium. The including pass binds `params`
// (with resolution, and the medium's centre and radius in the world), views, depth, normal, flux.

struct Reflecting {
    point: vec3f,       // m
    normal: vec3f,
    flux: vec3f,        // W
    area: f32,          // m^2
    weight: f32,        // of its being taken: what arrives, about, in W m^-2
}

const DARK = Reflecting(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0);

fn reflecting(texel: vec2u, layer: u32) -> Reflecting {
    let d = textureLoad(depth, vec2i(texel), layer, 0);
    let power = row_of_views(layer).flux_unit * textureLoad(flux, vec2i(texel), layer, 0).rgb;
    if (d >= 1.0 || all(power <= vec3f(0.0))) {
        return DARK;
    }
    let view = row_of_views(layer);
    let centre = texel_centre(texel, params.resolution);
    let p = texel_point(view, centre, d);
    let n = normalize(textureLoad(normal, vec2i(texel), layer, 0).xyz);
    // The texel's solid angle from a local light, its area from a parallel one; times `spread` it is m^2 across the light.
    let measure = texel_measure(view, centre, params.resolution);
    let deep = (view.clip_from_world * vec4f(p, 1.0)).w;
    let tangent = centre * view.texel * f32(params.resolution) * 0.5;
    let spread = select(1.0, deep * deep * (1.0 + dot(tangent, tangent)), view.is_perspective == 1u);
    let away = params.centre - p;
    let r2 = dot(away, away);
    // Nothing of a medium wholly behind the surface is lit.
    let before = max(dot(n, away) + params.radius, 0.0) / (sqrt(r2) + params.radius);
    let bright = dot(power, vec3f(0.2126, 0.7152, 0.0722)) * measure;
    let weight = bright * before / (r2 + params.radius * params.radius);
    return Reflecting(p, n, power * measure, measure * spread, weight);
}
