// A reduced image at full size, by joint bilateral interpolation with depth as the guide (Kopf2007).
//! use upsample_weight
//! needs fn base_at(pixel: vec2i) -> vec4f

@fragment fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    // Four texels around the pixel, by nearness on the image and in depth.
    let own = own_distance(position.xy);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let one = upsampled(position.xy, own, k);
        sum += one.weight * textureLoad(reduced, one.texel, 0);
        total += one.weight;
    }
    return sum / total + base_at(vec2i(position.xy));
}
