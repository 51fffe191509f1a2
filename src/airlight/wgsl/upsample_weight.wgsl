//! use upsample_corner

// The same, where the texels' depths are in `picked`, which the including pass binds.

struct Upsampled {
    texel: vec2i,
    weight: f32,
}

// The k-th of four texels around a pixel that sees `own` metres far.
fn upsampled(position: vec2f, own: f32, k: u32) -> Upsampled {
    let corner = corner_of(position, k);
    let distance = textureLoad(picked, corner.texel, 0).x;
    return Upsampled(corner.texel, corner_weight(corner.share, depth_weight(distance, own)));
}
