// Writes `PointSums` to the image `sums_after`, which the including pass binds; point_sums.wgsl reads them.

fn store_sums(texel: vec2u, sums: PointSums) {
    textureStore(sums_after, texel, 0, vec4f(sums.near, sums.far_share));
    textureStore(sums_after, texel, 1, vec4f(sums.near_flux, sums.open));
    textureStore(sums_after, texel, 2, vec4f(sums.far, sums.far_rays));
    textureStore(sums_after, texel, 3, vec4f(sums.far_flux, sums.far_inverse_m));
    textureStore(sums_after, texel, 4, vec4f(sums.later, sums.later_rays));
    textureStore(sums_after, texel, 5, vec4f(sums.later_flux, sums.far_begins));
    textureStore(sums_after, texel, 6, vec4f(sums.sky, sums.sky_variance));
    textureStore(sums_after, texel, 7, vec4f(sums.sky_flux, sums.frames));
    textureStore(sums_after, texel, 8, vec4f(sums.squares, sums.met_rays));
    textureStore(sums_after, texel, 9, vec4f(sums.products, sums.brightest));
    textureStore(sums_after, texel, 10, vec4f(sums.sides, 0.0));
}
