"""What a person runs: one module per command, each with a click command named `command`.

cli          finds the commands, turns errors into messages and exit codes
render       a scene in, an image out       scenes, info, validate     look before rendering
doctor       adapters and what is missing
"""
