"""What mouse, fingers and keys do, as `?` shows it."""

HELP = (
    ("left drag, one finger", "turn around what is seen; in a room without leaving it"),
    ("right or shift-left drag", "move sideways"),
    ("wheel, two fingers", "nearer; two fingers move, too"),
    ("w a s d q e, arrows", "fly; shift: faster. f: orbit or fly"),
    ("the mark of a light", "choose and move it; arrows: along an axis; dot: aim it"),
    ("control-drag, l and drag", "turn the chosen light"),
    ("control-z, control-y", "undo, redo"),
    ("a file, dropped", "open a scene or model; take a map as environment"),
    ("r", "camera back to the scene's"),
    ("tab", "hide or show the panel and the marks of lights"),
    ("?", "this list"),
)
