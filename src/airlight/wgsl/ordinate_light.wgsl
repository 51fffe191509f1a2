//! use ordinate_kind

// An ordinate's light in a cell; see maths/delta_beam.py and maths/point_light_beam.py. The including pass
// binds `params` (MediumParams) and `ordinates` (OrdinateData).

struct OrdinateLight {
    travel: vec3f,      // unit
    irradiance: vec3f,  // at normal incidence, not attenuated
    distance: f32,      // m to the local light
}

// 1/r^2 averaged over a cell: eight parts, each to second order.
fn mean_inverse_square(away: vec3f) -> f32 {
    let half = 0.5 * (params.cell.x + params.cell.y + params.cell.z) / 3.0;
    let h2 = half * half;
    var total = 0.0;
    for (var part = 0u; part < 8u; part++) {
        let side = vec3f(vec3u(part, part >> 1u, part >> 2u) & vec3u(1u)) - 0.5;
        let sample = away + 0.5 * side * params.cell;
        let r2 = max(dot(sample, sample), 0.1 * h2);
        total += (1.0 + h2 / (12.0 * r2)) / r2;
    }
    return total / 8.0;
}

// A piece of surface; see pop/virtual/lights.py. Its own width and the cell's blunt the fall-off.
fn reflected_light(n: u32, away: vec3f) -> OrdinateLight {
    let o = ordinates[n];
    let r2 = dot(away, away);
    let travel = away / max(sqrt(r2), 1e-9);
    let cosine = max(dot(travel, o.direction.xyz), 0.0);
    let blunt = r2 + o.spot.x + dot(params.cell, params.cell) / 12.0;
    return OrdinateLight(travel, o.irradiance.rgb * cosine / blunt, sqrt(r2));
}

// A block of another medium; see pop/exchange/irradiance.py, which knows what arrives of it.
fn block_light(n: u32, away: vec3f) -> OrdinateLight {
    let distance = max(length(away), 1e-9);
    return OrdinateLight(away / distance, vec3f(1.0), distance);
}

fn ordinate_light(n: u32, point: vec3f) -> OrdinateLight {
    let o = ordinates[n];
    if (o.position.w == BLOCK) {
        return block_light(n, point - o.position.xyz);
    }
    if (o.position.w == DISTANT) {
        return OrdinateLight(o.direction.xyz, o.irradiance.rgb, 1e30);
    }
    let away = point - o.position.xyz;
    if (o.position.w == VIRTUAL || o.position.w == VIRTUAL_GRID) {
        return reflected_light(n, away);
    }
    let distance = max(length(away), 1e-9);
    let travel = away / distance;
    let fade = smoothstep(o.spot.y, o.spot.x, dot(travel, o.direction.xyz));
    return OrdinateLight(travel, o.irradiance.rgb * fade * mean_inverse_square(away), distance);
}
