"""WGSL of what a cell gathers from its 26 neighbours, unrolled from maths.lattice26.hops().

Weights are literals and neighbours are named values: the CPU adapter reads a table ten times
slower. Neighbour j of a cell stands at hops().offsets[j]; it is where the cell's own hop j goes,
and its light arrives by the opposite hop.
"""

from __future__ import annotations

from functools import cache

from ..maths.lattice26 import RHO, hops
from ..maths.lattice26_walls import REFLECTED_TRACK, SPLIT_FLOOR, face_numbers, returned_sharpness

COUNT = 26
KINDS = (range(6), range(6, 18), range(18, COUNT))
"""The hops of each kind."""
_AXES = "yzw"  # of a state vec4f: Bx, By, Bz


@cache
def offsets() -> tuple[tuple[int, int, int], ...]:
    """(dx, dy, dz) of each neighbour."""
    return tuple((int(x), int(y), int(z)) for x, y, z in hops().offsets.tolist())


def kind(j: int) -> int:
    """0 across a face, 1 across an edge, 2 across a corner."""
    return sum(abs(k) for k in offsets()[j]) - 1


@cache
def opposite(j: int) -> int:
    """The number of the hop that goes the other way."""
    x, y, z = offsets()[j]
    return offsets().index((-x, -y, -z))


def literal(value: float) -> str:
    """A WGSL float with all of float32's digits."""
    return f"{value:.9e}".replace("e+00", "")


def signed_sum(value: str, j: int, sign: int = 1) -> str:
    """The components of `value` along offset j, added: `v.y - v.w`."""
    text = ""
    for component, step in zip(_AXES, offsets()[j], strict=True):
        if step:
            text += f" {'+' if step * sign > 0 else '-'} {value}.{component}"
    return text.removeprefix(" + ").strip()


def offset_vector(j: int, sign: int = 1) -> str:
    """`vec3f` of the offset, not normalised."""
    return "vec3f({:.1f}, {:.1f}, {:.1f})".format(*(sign * k for k in offsets()[j]))


def constants() -> str:
    """Per kind of hop: weight, length in cells, and what the lobes are."""
    table = hops()
    lines = [
        f"const RHO = {literal(RHO)};",
        f"const RETURNED = {literal(returned_sharpness())};",
        f"const REFLECTED_TRACK = {literal(REFLECTED_TRACK)};",
    ]
    for k, j in enumerate((0, 6, 18)):
        lines.append(f"const WEIGHT_{k} = {literal(float(table.weights[j]))};")
        lines.append(f"const LENGTH_{k} = {literal(float(table.lengths[j]))};")
    return "\n".join(lines)


def mean_track() -> str:
    """`way_m(sigma_t, cell)`: track, m, of isotropic light per hop, in all three channels.

    maths.lattice26_levels.mean_track is its NumPy twin.
    """
    terms = [
        f"{count:.1f} * WEIGHT_{k} * LENGTH_{k} * "
        f"mean_transmittance_rgb(sigma_t * (cell * LENGTH_{k}))"
        for k, count in enumerate((6, 12, 8))
    ]
    return (
        "//! use medium\nfn way_m(sigma_t: vec3f, cell: f32) -> vec3f {\n    return cell * ("
        + " + ".join(terms)
        + ");\n}"
    )


def opened(pack: str, j: int) -> str:
    """The open share of hop j in a pack of two vec4u."""
    word, byte = divmod(j, 4)
    half, component = divmod(word, 4)
    return f"unpack4x8unorm({pack}{half}.{'xyzw'[component]}).{'xyzw'[byte]}"


def gathered() -> str:
    """`gathered(own, n0, ..., n25, ...)`: one step of a homogeneous medium, free of walls."""
    states = ", ".join(f"n{j}: vec4f" for j in range(COUNT))
    lines = [f"fn gathered(c: StepCoefficients, own: vec4f, {states}) -> vec4f {{"]
    lines += _arriving(is_blocked=False)
    lines += ["    return vec4f(even + c.even.w * own.x, direct + c.direct.w * own.yzw);", "}"]
    return "\n".join(lines)


def gathered_blocked() -> str:
    """The same among walls: visibility packs of incoming and outgoing hops, and reflectance."""
    states = ", ".join(f"n{j}: vec4f" for j in range(COUNT))
    lines = [
        f"fn gathered_blocked(c: StepCoefficients, own: vec4f, {states}, in0: vec4u, in1: vec4u, "
        "out0: vec4u, out1: vec4u, channel: u32) -> vec4f {"
    ]
    lines += _arriving(is_blocked=True)
    lines += ["    let white = unpack4x8unorm(out1.w)[channel];"]
    lines += leaving_shares()
    for j in range(COUNT):
        scale = literal(RHO / float(hops().lengths[j]))
        lines += [
            f"    let q{j} = own.x + {scale} * ({signed_sum('own', j)});",
            f"    let m{j} = q{j} * o{j};",
            f"    let t{j} = q{j} - m{j};",
            f"    let r{j} = t{j} * select(white, max(white, c.kept_even.w), q{j} < 0.0);",
        ]
    for k, span in enumerate(KINDS):
        lines += [
            f"    even += c.kept_even[{k}] * ({total('m', span)}) + c.stopped_even[{k}] * "
            f"({total('t', span)}) + c.returned_even[{k}] * ({total('r', span)});",
            f"    direct += c.kept_direct[{k}] * {along('m', span)} + c.stopped_direct[{k}] * "
            f"{along('t', span)};",
            *returned(k, f"c.returned_direct[{k}]"),
        ]
    lines += ["    return vec4f(even, direct);", "}"]
    return "\n".join(lines)


def total(name: str, span: range) -> str:
    """The sum of `{name}{j}`."""
    return " + ".join(f"{name}{j}" for j in span)


def along(name: str, span: range) -> str:
    """The sum times offsets."""
    axes = []
    for axis in range(3):
        signed = ((offsets()[j][axis], j) for j in span)
        terms = [f"{'+' if step > 0 else '-'} {name}{j}" for step, j in signed if step]
        axes.append(" ".join(terms).removeprefix("+ "))
    return f"vec3f({', '.join(axes)})"


def returned(k: int, gain: str) -> list[str]:
    """`direct` plus what walls send back of hops of kind k, r{j}, times `gain`, along `normal`s.

    By face, so that a hop takes one division.
    """
    span = KINDS[k]
    if k == 0:
        return [f"    direct -= {gain} * {along('r', span)};"]
    lines = []
    faces: dict[int, list[int]] = {}
    for j in span:
        numbers = [n for n in face_numbers()[j] if n >= 0]
        lines.append(f"    let d{j} = r{j} / ({' + '.join(f's{n}' for n in numbers)});")
        for n in numbers:
            faces.setdefault(n, []).append(j)
    axes = []
    for axis in range(3):
        terms = [
            f"{'-' if offsets()[n][axis] > 0 else '+'} s{n} * ({' + '.join(f'd{j}' for j in seen)})"
            for n, seen in sorted(faces.items())
            if offsets()[n][axis]
        ]
        axes.append(" ".join(terms).removeprefix("+ "))
    return [*lines, f"    direct += {gain} * vec3f({', '.join(axes)});"]


def leaving_shares() -> list[str]:
    """`o0` .. `o25`: visibility of the cell's own hops; `s0` .. `s5`: how closed its faces are."""
    lines = [f"    let o{j} = {opened('out', j)};" for j in range(COUNT)]
    floor = literal(SPLIT_FLOOR)
    return lines + [f"    let s{j} = 1.0 - o{j} + {floor};" for j in range(6)]


def normal(j: int) -> str:
    """The mean normal of what stops the cell's own hop j, from the shares s0 .. s5."""
    numbers = face_numbers()[j]
    parts = [
        "0.0" if n < 0 else f"{-step:.1f} * s{n}"
        for n, step in zip(numbers, offsets()[j], strict=True)
    ]
    total = " + ".join(f"s{n}" for n in numbers if n >= 0)
    return f"(vec3f({', '.join(parts)}) / ({total}))"


def _arriving(*, is_blocked: bool) -> list[str]:
    """Sums by kind of hop: `even`, `direct` of what the neighbours hand over."""
    lines = []
    for j in range(COUNT):
        # The neighbour's light travels against its offset.
        scale = literal(RHO / float(hops().lengths[j]))
        power = f"n{j}.x + {scale} * ({signed_sum(f'n{j}', j, -1)})"
        share = f"{opened('in', j)} * " if is_blocked else ""
        lines.append(f"    let p{j} = {share}({power});")
    for k, span in enumerate(KINDS):
        lines.append(f"    let even{k} = {' + '.join(f'p{j}' for j in span)};")
        axes = [_signed_terms(span, axis) for axis in range(3)]
        lines.append(f"    let direct{k} = vec3f({', '.join(axes)});")
    return [
        *lines,
        "    var even = dot(c.even.xyz, vec3f(even0, even1, even2));",
        "    var direct = c.direct.x * direct0 + c.direct.y * direct1 + c.direct.z * direct2;",
    ]


def _signed_terms(span: range, axis: int) -> str:
    text = ""
    for j in span:
        step = -offsets()[j][axis]
        if step:
            text += f" {'+' if step > 0 else '-'} p{j}"
    return text.removeprefix(" + ").strip()
