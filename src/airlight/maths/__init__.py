"""The formulas of the package as NumPy float64 truths; no GPU, nothing of ours imported.

sh           spherical harmonics          solid_angle   polygons seen from a point
lattice6     6-neighbour propagation      lattice26     26-neighbour propagation with scattering
phase        Henyey-Greenstein            medium        transmittance, ray intervals
airlight     single scattering on a ray   octahedron    directions on a square
sampling     sequences and hashes         latlong       environment-map orientation
colour       sRGB, luminance              tone          tone mapping, exposure

Where a shader needs the same formula, a WGSL function of the same name stands in `wgsl/` and a
test holds the two together.
"""
