"""The command line: one module or folder per command, each with a click command `command`.

    words -> cli -> a command: options, checked -> scene_argument: a Scene -> what it renders,
    solves or counts -> outputs; progress and warnings on stderr

cli       finds the commands, turns errors into messages and exit codes
render    a scene in, an image out            sequence/   frames, videos, clusters
turntable a model turns once around           view/       the viewer
compare/  techniques beside a reference       figure      figures of the papers
bench/    frames timed, costs measured
scenes, info, validate, convert, doctor, export_lattice
scene_options, scene_argument   which scene a command takes, and how it is read
options, outputs, progress, streams: what commands share
"""
