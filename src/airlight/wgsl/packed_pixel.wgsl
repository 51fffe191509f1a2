// A pixel of an image in one word, as lists of pixels hold it.

fn packed_pixel(pixel: vec2u) -> u32 {
    return pixel.x | (pixel.y << 16u);
}

fn unpacked_pixel(word: u32) -> vec2u {
    return vec2u(word & 0xffffu, word >> 16u);
}
