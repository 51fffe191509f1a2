// What a cell of principal ordinates scatters towards the eye, stored twice: `whole` for the rays of a gather and exports,
// `emission` for marching, beside which shafts may draw what local lights scatter once: as sharp as their fall-off is.
// The including pass binds view, emission and whole.

const HALF_MAX = 65504.0;

// `local`: single scattering of local lights.
fn store_emission(cell: vec3u, light: vec3f, local: vec3f) {
    let all = vec4f(min(light + local, vec3f(HALF_MAX)), 1.0);
    let rest = vec4f(min(light, vec3f(HALF_MAX)), 1.0);
    textureStore(emission, cell, select(all, rest, view.has_local_shafts == 1u));
    if (view.has_local_shafts == 1u) {
        textureStore(whole, cell, all);
    }
}
