// The orphan points of blocks of pixels. The including pass binds `orphans` (gather/orphans.py) and `params` with the
// blocks of the image, `reduced`.

const NO_ORPHAN = 0xffffffffu;
const BLOCK_BITS = 15u;

struct OrphanRun {
    first: u32,
    end: u32,
}

fn blocks_of_image() -> u32 {
    return params.reduced.x * params.reduced.y;
}

fn orphan_run(word: u32) -> OrphanRun {
    return OrphanRun(word >> 2u, (word >> 2u) + (word & 3u));
}

// Those of a block.
fn orphans_of(block: vec2u) -> OrphanRun {
    return orphan_run(orphans[block.y * params.reduced.x + block.x]);
}

// Where an orphan point's texel lies: in rows below those of the blocks.
fn orphan_texel(k: u32) -> vec2u {
    return vec2u(k % params.reduced.x, params.reduced.y + k / params.reduced.x);
}

// The block that a point's texel belongs to.
fn block_of(texel: vec2u) -> vec2u {
    if (texel.y < params.reduced.y) {
        return texel;
    }
    let word = orphans[texel.y * params.reduced.x + texel.x];
    let block = select(word & ((1u << BLOCK_BITS) - 1u), 0u, word == NO_ORPHAN);
    return vec2u(block % params.reduced.x, block / params.reduced.x);
}
