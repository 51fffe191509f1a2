"""WGSL of what a cell gathers from its 26 neighbours where the air varies, summed by kind of hop.

As propagate_varied's, which visits neighbour by neighbour: what depends on the cell's own air alone
is taken out of the sums. Half hops `q`, `u`, `w` are vectors over the three kinds; see the shader.
"""

from __future__ import annotations

from ..maths.lattice26 import RHO, hops
from .hop_wgsl import (
    COUNT,
    KINDS,
    along,
    kind,
    leaving_shares,
    literal,
    opened,
    returned,
    signed_sum,
    total,
)


def gathered_varied(*, is_track: bool, is_blocked: bool) -> str:
    """`gathered(own, n0, ..., n25, ...)`: the next state, or the track.

    Among walls it takes visibility packs, too; `u`, `w` are times sigma_s where it is the state.
    """
    cells = ", ".join(f"n{j}: Cell" for j in range(COUNT))
    packs = "in0: vec4u, in1: vec4u, out0: vec4u, out1: vec4u, " if is_blocked else ""
    lines = [f"fn gathered(own: Cell, {cells}, {packs}channel: u32) -> vec4f {{"]
    if is_blocked:
        lines += ["    let white = unpack4x8unorm(out1.w)[channel];", *leaving_shares()]
    for j in range(COUNT):
        lines += _hop(j, is_blocked)
    lines += ["    let a = own.air;", "    var even = 0.0;", "    var direct = vec3f(0.0);"]
    for k, span in enumerate(KINDS):
        lines += _kind(k, span, is_track)
        lines += _stopped(k, span, is_track) if is_blocked else []
    return "\n".join([*lines, "    return vec4f(even, direct);", "}"])


def _hop(j: int, is_blocked: bool) -> list[str]:
    """What neighbour j sends that its half leaves (x) and deposits (y), what the cell sends it (m)
    and what of that is deposited there (z); and what is stopped (t) and reflected (r)."""
    k, scale = kind(j), literal(RHO / float(hops().lengths[j]))
    share = f"{opened('in', j)} * " if is_blocked else ""
    lines = [
        # The neighbour's light travels against its offset.
        f"let p{j} = {share}(n{j}.v.x + {scale} * ({signed_sum(f'n{j}.v', j, -1)}));",
        f"let x{j} = p{j} * n{j}.air.q[{k}];",
        f"let y{j} = p{j} * n{j}.air.u[{k}];",
        f"let q{j} = own.v.x + {scale} * ({signed_sum('own.v', j)});",
        f"let m{j} = q{j}{f' * o{j}' if is_blocked else ''};",
        f"let z{j} = m{j} * n{j}.air.w[{k}];",
    ]
    if is_blocked:
        lines += [
            f"let t{j} = q{j} - m{j};",
            f"let r{j} = t{j} * select(white, max(white, params.deficit), q{j} < 0.0);",
        ]
    return [f"    {line}" for line in lines]


def _kind(k: int, span: range, is_track: bool) -> list[str]:
    """What arrives by hops of kind k and what the cell keeps of its own, into even and direct."""
    ahead = f"(2.0 * a.u[{k}] + a.w[{k}]" + (")" if is_track else f" + a.q[{k}])")
    kept = f"(a.u[{k}] + 2.0 * a.w[{k}])"
    lines = [
        f"even += WEIGHT_{k} * ({total('y', span)} + {ahead} * ({total('x', span)})"
        f" + {kept} * ({total('m', span)}) + a.q[{k}] * ({total('z', span)}));"
    ]
    if is_track:
        lines.append(
            f"direct += WEIGHT_{k} * RHO / LENGTH_{k} * ({kept} * {along('m', span)}"
            f" + a.q[{k}] * {along('z', span)}"
            f" - {along('y', span)} - {ahead} * {along('x', span)});"
        )
    else:
        lines.append(
            f"direct -= WEIGHT_{k} * 3.0 * params.straight / LENGTH_{k} * a.q[{k}]"
            f" * {along('x', span)};"
        )
    return [f"    {line}" for line in lines]


def _stopped(k: int, span: range, is_track: bool) -> list[str]:
    """What walls stop of the cell's own hops of kind k, and what they send back."""
    way = f"(2.0 * (a.u[{k}] + a.w[{k}]))"
    back = f"{way}" if is_track else f"({way} + a.q[{k}])"
    sharp = f"REFLECTED_TRACK * {way}" if is_track else f"RETURNED * a.q[{k}]"
    lines = [
        f"even += WEIGHT_{k} * ({way} * ({total('t', span)})"
        f" + a.q[{k}] * {back} * ({total('r', span)}));",
    ]
    if is_track:
        lines.append(f"direct += WEIGHT_{k} * RHO / LENGTH_{k} * {way} * {along('t', span)};")
    lines += returned(k, f"WEIGHT_{k} * a.q[{k}] * {sharp}")
    return [f"    {line}" for line in lines]
