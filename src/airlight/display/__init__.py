"""From layers of radiance to a surface: combined, metered, tone mapped; nothing is read back.

layers -> combine -> one image -> meter (exposure) -> tone (curve, sRGB) -> show on a surface
                                  presenter: all of it, for one window or tab
"""
