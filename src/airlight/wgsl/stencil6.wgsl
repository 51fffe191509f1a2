// What a step of the 6-neighbour stencil takes (Kaplanyan2010 section 3.3): a cell's light and that of its neighbours,
// and what blocks between them. Schemes give `stepped` (step6_centroid.wgsl, step6_paper.wgsl); kernels call it.

override IS_BLOCKED: bool = true;       // faces block; else all are open
override IS_REFLECTING: bool = false;   // blocked light bounces

const BOUNCE_LOBE = 2.0;                // |b| / a of a cosine lobe off a face

// The light of the cell and of its neighbours in red, green and blue: (a, b) a column each.
struct Stencil {
    here: mat3x4f, west: mat3x4f, east: mat3x4f, south: mat3x4f, north: mat3x4f, below: mat3x4f, above: mat3x4f,
}

// Faces as lattice.blockers.Blockers.faces: for hops +x -x +y -y | +z -z what blocks light that leaves (reflectance
// and share in 8 bits), then in `rest.zw` the open shares of light that enters.
struct Faces { side: vec4u, rest: vec4u }

// The stencil as it enters through the open shares of the faces.
fn entering(s: Stencil, faces: Faces) -> Stencil {
    let xy = unpack4x8unorm(faces.rest.z);
    let z = unpack4x8unorm(faces.rest.w);
    return Stencil(s.here, xy.x * s.west, xy.y * s.east, xy.z * s.south, xy.w * s.north, z.x * s.below, z.y * s.above);
}
