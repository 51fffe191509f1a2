// The light of a pixel, or of a hit: emission and lights, then lattices and sky; the background where nothing is.
//! use surface_reflection
//! needs fn surface_depth(pixel: vec2u) -> f32
//! needs fn surface_point(position: vec2f, d: f32) -> vec3f
//! needs fn background(direction: vec3f) -> vec3f
//! needs fn direct_light(r: Reflector, p: vec3f, n: vec3f, v: vec3f) -> vec3f
//! needs fn list_glossy(pixel: vec2u, direct: vec3f, indirect: vec3f, share: f32)
//! needs fn lit_of(pixel: vec2u) -> vec4f
//! needs fn gathered(position: vec2f, d: f32, p: vec3f, r: Reflector, n: vec3f, v: vec3f) -> Gathered

override HAS_SURFACES: bool = true;
override HAS_LIGHTS: bool = true;       // else `lit` has their light
override HAS_LATTICES: bool = true;

struct Lit {
    @location(0) direct: vec4f,
    @location(1) indirect: vec4f,
}

// What lattices give, W m^-2 sr^-1, whether what the surface mirrors is left to a list, and which share of that.
struct Gathered {
    direct: vec3f,
    indirect: vec3f,
    mirrored: f32,
    is_listed: bool,
}

@fragment fn fragment(@builtin(position) position: vec4f) -> Lit {
    let pixel = vec2u(position.xy);
    let d = surface_depth(pixel);
    var out: Lit;
    out.indirect = vec4f(0.0, 0.0, 0.0, 1.0);
    let p = surface_point(position.xy, d);
    let v = normalize(params.eye - p);
    // Where there is no surface, the background.
    if (!HAS_SURFACES || d <= 0.0) {
        if (HAS_LIGHTS) {
            out.direct = vec4f(background(-v) + textureLoad(emission, pixel, 0).rgb, 0.0);
        } else {
            out.direct = lit_of(pixel);
        }
        return out;
    }
    // The surface: its reflectances, its lobe, its normal.
    let base = textureLoad(albedo, pixel, 0);
    let normal_roughness = textureLoad(normal, pixel, 0);
    let emission_specular = textureLoad(emission, pixel, 0);
    let n = normalize(normal_roughness.xyz);
    let r = reflector(base.rgb, base.a, normal_roughness.w, emission_specular.a);
    // Emission and direct light, from lights or from the part that has drawn them.
    var found = Gathered(vec3f(0.0), vec3f(0.0), 1.0, false);
    var direct = vec3f(0.0);
    if (HAS_LIGHTS) {
        direct = emission_specular.rgb + direct_light(r, p, n, v);
    } else {
        direct = lit_of(pixel).rgb;
    }
    // Indirect light, of lattices and sky.
    if (HAS_LATTICES && params.has_lattice != 0u) {
        found = gathered(position.xy, d, p, r, n, v);
    }
    direct += found.direct;
    out.indirect = vec4f(found.indirect, 1.0);
    out.direct = vec4f(direct, 1.0);
    // Glossy pixels follow their mirrored ray in a pass of their own.
    if (found.is_listed) {
        list_glossy(pixel, direct, found.indirect, found.mirrored);
    }
    return out;
}
