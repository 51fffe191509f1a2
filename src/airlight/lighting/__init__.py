"""How surfaces are lit by everything that was solved.

lights      shadow maps, the light table, the environment      sky       skylight and its bounce
lighting    the pass that adds it all up                       view      a camera's textures
accumulate  the mean of jittered images                       places    lookups that are kept
"""
