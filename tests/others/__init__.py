"""Files that others wrote: which load and give an image, which are refused and with which words.

`list.tsv` names them with checksums, by the public repository that has them; none of them is here.
`./run others FOLDER` tries those that lie below a folder as OWNER+NAME/PATH, a clone of each
repository that the list names, and says what came out otherwise than the list has it.
"""
