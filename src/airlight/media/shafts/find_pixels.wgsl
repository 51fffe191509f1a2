// Upsamples a reduced image, and lists the pixels that cannot be interpolated between its texels.
//! use pixel_list
//! use upsample_corner

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    // Joint bilateral interpolation, and between which colours it is.
    let own = own_distance(position.xy);
    var sum = vec3f(0.0);
    var total = 0.0;
    var least = vec3f(3e38);
    var most = vec3f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let corner = corner_of(position.xy, k);
        let texel = textureLoad(reduced, corner.texel, 0);   // a: how far its ray goes, m
        let likeness = depth_weight(texel.a, own);
        let weight = corner_weight(corner.share, likeness);
        sum += weight * texel.rgb;
        total += weight;
        if (likeness > SAME_DEPTH) {
            least = min(least, texel.rgb);
            most = max(most, texel.rgb);
        }
    }
    // Between colours that differ too much none is right: the pixel is drawn by itself.
    if (is_redrawn(least, most, redrawn.contrast)) {
        list_pixel(vec2u(position.xy), vec3f(0.0), redrawn.group);
    }
    return vec4f(sum / total, 1.0);
}
