"""Marching of solved fields along eye rays: multiple scattering, and single scattering of the sky.

fields of solvers -> marched_light -> march; kernel: its variants by what fields there are;
                     kernel_wgsl: their WGSL
forward_source  light near its beam, light by light
half_space      light of an endless medium beyond the lattices
"""
