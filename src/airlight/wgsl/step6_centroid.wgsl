// One step of a cell among blockers, in all channels: what its six neighbours send through the open shares of the
// faces, and what its own closed faces return (Kaplanyan2010 sections 3.3 and 7). maths.lattice6.hops("centroid") is
// the NumPy twin. The including pass binds `params` (lpv.step.StepParams).
//! use hops6
//! use stencil6

// What a face returns of the power p that goes to it. The two-band light of a stream has the wrong sign behind it:
// such power is handed back whole, so that energy does not grow. What was handed back is negative all over, and
// surfaces absorb it like the light that it takes back: stored for ever, it would end up as a dark fog (`mean` has the
// sign of the light).
fn returned(p: vec3f, mean: vec3f, face: u32) -> vec3f {
    let shares = unpack4x8unorm(face);
    let reflected = select(vec3f(0.0), shares.rgb, IS_REFLECTING);
    return p * select(vec3f(shares.w * params.handed_back), reflected, p * mean > vec3f(0.0));
}

// Light that leaves towards closed faces comes back into its own cell, as cosine lobes off them.
fn bounced(v: mat3x4f, faces: Faces) -> mat3x4f {
    let side = faces.side;
    let rest = faces.rest;
    // Power towards each face.
    let mean = MEAN_TO_MEAN * vec3f(v[0].x, v[1].x, v[2].x);
    let x = FLUX_TO_MEAN * vec3f(v[0].y, v[1].y, v[2].y);
    let y = FLUX_TO_MEAN * vec3f(v[0].z, v[1].z, v[2].z);
    let z = FLUX_TO_MEAN * vec3f(v[0].w, v[1].w, v[2].w);
    let plus = mat3x3f(returned(mean + x, mean, side.x), returned(mean + y, mean, side.z),
        returned(mean + z, mean, rest.x));
    let minus = mat3x3f(returned(mean - x, mean, side.y), returned(mean - y, mean, side.w),
        returned(mean - z, mean, rest.y));
    // Power and net direction of what returns.
    let a = plus[0] + plus[1] + plus[2] + minus[0] + minus[1] + minus[2];
    let b = BOUNCE_LOBE * (minus - plus);
    return mat3x4f(a.r, b[0].r, b[1].r, b[2].r, a.g, b[0].g, b[1].g, b[2].g, a.b, b[0].b, b[1].b, b[2].b);
}

fn all_received(s: Stencil) -> mat3x4f {
    return mat3x4f(
        received_x(s.west[0], s.east[0]) + received_y(s.south[0], s.north[0]) + received_z(s.below[0], s.above[0]),
        received_x(s.west[1], s.east[1]) + received_y(s.south[1], s.north[1]) + received_z(s.below[1], s.above[1]),
        received_x(s.west[2], s.east[2]) + received_y(s.south[2], s.north[2]) + received_z(s.below[2], s.above[2]));
}

// The cell's light after the step.
fn stepped(s: Stencil, faces: Faces) -> mat3x4f {
    if (!IS_BLOCKED) {
        return all_received(s);
    }
    return bounced(s.here, faces) + all_received(entering(s, faces));
}
