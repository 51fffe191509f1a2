"""Real-time light transport in air: fog, smoke, clouds and indirect light, on any GPU or none.

>>> import airlight as al
>>> image = al.render(al.scenes.cornell(), technique="lpv", size=(640, 360))
>>> image.save("cornell.png")
"""

from .errors import AirlightError

__version__ = "0.1.0"

__all__ = ["AirlightError"]
