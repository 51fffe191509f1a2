// Whose mirrored ray a pixel shows, as `gather/mirror_list.wgsl` writes it: none, its own, or that of one pixel of its
// block of 2 x 2, each of which has its turn in another sample. The including pass binds `params` (MirrorParams).

const WIDE = 0.1;           // of alpha: pixels of rougher surfaces share a ray
const NEXT_BLOCK = 2.0;     // px, at least so far lie rays that such a pixel takes
const BY_NONE = 0u;
const BY_OWN = 1u;
const BY_BLOCK = 2u;

// The pixel of a block that sends a ray in this sample.
fn pixel_of_block(pixel: vec2u) -> vec2u {
    let turn = params.sample & 3u;
    let step = vec2u((turn & 1u) ^ (turn >> 1u), turn & 1u);
    return min((pixel & vec2u(~1u)) + step, vec2u(params.size) - 1u);
}
