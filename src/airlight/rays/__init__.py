"""Rays against the triangles of a scene, on the device.

sweep      where a hierarchy is divided        hierarchy  four children to a node, on the host
words      nodes and triangles as shaders      mesh_tree  the hierarchy of one mesh
           read them
rays       RayScene: the buffers that a pass binds to call `wgsl/rays.wgsl`
"""
