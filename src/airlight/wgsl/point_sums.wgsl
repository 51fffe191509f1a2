// `PointSums` of points in an image (gather/sums.py): a texel for each point, a layer for each row of four floats.

fn sums_at(image: texture_2d_array<f32>, texel: vec2u) -> PointSums {
    let near = textureLoad(image, texel, 0, 0);
    let near_flux = textureLoad(image, texel, 1, 0);
    let far = textureLoad(image, texel, 2, 0);
    let far_flux = textureLoad(image, texel, 3, 0);
    let later = textureLoad(image, texel, 4, 0);
    let later_flux = textureLoad(image, texel, 5, 0);
    let sky = textureLoad(image, texel, 6, 0);
    let sky_flux = textureLoad(image, texel, 7, 0);
    let squares = textureLoad(image, texel, 8, 0);
    let products = textureLoad(image, texel, 9, 0);
    let sides = textureLoad(image, texel, 10, 0).xyz;
    return PointSums(near.xyz, near.w, near_flux.xyz, near_flux.w, far.xyz, far.w, far_flux.xyz, far_flux.w,
        later.xyz, later.w, later_flux.xyz, later_flux.w, sky.xyz, sky.w, sky_flux.xyz, sky_flux.w,
        squares.xyz, squares.w, products.xyz, products.w, sides);
}
