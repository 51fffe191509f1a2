// A cell's two bands as they are stored between steps: a byte a coefficient. See lpv.storage.
// The first byte holds the logarithm of a, the others b / 3a. Half a step of the logarithm is 6 %: over a lattice of
// cells it averages out.

alias State = u32;

const FAINTEST = -18.0;     // log2 of |a|; what is below is nothing
const BRIGHTEST = 4.0;
const FIRST = 1.0 / 127.0;  // the code of the faintest; 0 is none

fn unpacked(v: State) -> vec4f {
    let s = unpack4x8snorm(v);
    let level = (abs(s.x) - FIRST) / (1.0 - FIRST);
    let a = sign(s.x) * exp2(mix(FAINTEST, BRIGHTEST, level));
    return a * vec4f(1.0, 3.0 * s.yzw);
}

fn packed(v: vec4f) -> State {
    let a = abs(v.x);
    let level = saturate((log2(max(a, 1e-30)) - FAINTEST) / (BRIGHTEST - FAINTEST));
    let code = select(0.0, mix(FIRST, 1.0, level), a >= exp2(FAINTEST));
    return pack4x8snorm(vec4f(sign(v.x) * code, v.yzw / (3.0 * select(1.0, v.x, a > 0.0))));
}
