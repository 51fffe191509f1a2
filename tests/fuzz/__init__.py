"""A fuzzer for everything that reads a user's file: `./run fuzz --help`.

    mutate_bytes    damage to bytes: flips, lengths, numbers, splices
    mutate_tree     damage to documents: values, keys, nesting, paths
    texts           TOML, JSON and XML as such documents, and back to text
    seeds           tiny good files of every format, made here
    targets         loader -> how one of its inputs is made, and which files it may open
    trial           one input tried: what counts as a failure
    child           many inputs in a process of limited memory and time
    shrink          a failing input made smaller, as long as it fails alike
    finds           failures grouped, and printed with the command that repeats them

Input number k of a loader under a seed is the same on every run and every machine: its random
numbers start from (seed, loader, k) alone.

Why neither Hypothesis nor Atheris: Hypothesis runs its examples in the process of the test, where
one crash, endless loop or terabyte ends the run, and it replays from a database rather than from a
number; Atheris needs a Python extension of its own, which is not built for every Python that
airlight runs on, and what is to be covered is in Pillow, OpenEXR, expat and NumPy as much as in
Python. What both would bring beside it, a grammar of documents, is two short modules here.
"""
