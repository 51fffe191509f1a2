"""The device and how to talk to it; the only importer of wgpu.

device     which adapter, and why; limits; one queue          frame    what is encoded and submitted
layout     uniforms declared once: NumPy dtype and WGSL       slots    what a shader binds
source     WGSL files, `//! use`, errors at the real line     memory   textures and buffers
scope      who gives memory back
compute    a compute pass                                     raster   a render pass
failures   what is refused, said once               process, one_thread    who may ask
"""
