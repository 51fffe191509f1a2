// Texels of an image of `params.size` pixels. The including pass binds `image_sampler`, which takes the
// nearest one.

// CPU adapters sample the nearest texel in two thirds of the time of a load.
override IS_SAMPLED: bool = false;

fn image_texel(image: texture_2d<f32>, pixel: vec2u) -> vec4f {
    if (IS_SAMPLED) {
        let uv = (vec2f(vec2i(pixel)) + 0.5) / vec2f(params.size);
        return textureSampleLevel(image, image_sampler, uv, 0.0);
    }
    return textureLoad(image, pixel, 0);
}

fn depth_texel(image: texture_depth_2d, pixel: vec2u) -> f32 {
    if (IS_SAMPLED) {
        let uv = (vec2f(vec2i(pixel)) + 0.5) / vec2f(params.size);
        return textureSampleLevel(image, image_sampler, uv, 0);
    }
    return textureLoad(image, pixel, 0);
}
