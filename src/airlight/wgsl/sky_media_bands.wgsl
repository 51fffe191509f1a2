// Stores a cell's two bands by channel, and its mean radiance as a colour.
//! use sky_light

fn store_sky_media_bands(texel: vec3u, light: SkyLight) {
    let fluence = light.fluence;
    let flux = light.flux;
    textureStore(red, texel, stored(fluence.r, vec3f(flux[0].r, flux[1].r, flux[2].r)));
    textureStore(green, texel, stored(fluence.g, vec3f(flux[0].g, flux[1].g, flux[2].g)));
    textureStore(blue, texel, stored(fluence.b, vec3f(flux[0].b, flux[1].b, flux[2].b)));
    textureStore(mean, texel, vec4f(stored(fluence.r, vec3f(0.0)).x,
        stored(fluence.g, vec3f(0.0)).x, stored(fluence.b, vec3f(0.0)).x, 1.0));
}
