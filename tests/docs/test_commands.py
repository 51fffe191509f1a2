"""Every command that a page names is one that there is, with options that it has.

`test_pages.py` runs what it can; here each line is parsed, also where running it needs a screen, a
path tracer or minutes, in examples that are not run, and within sentences.
"""

from __future__ import annotations

import re
import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

from airlight.app.cli import airlight as command_line

REPOSITORY = Path(__file__).parents[2]
PAGES = [
    *(REPOSITORY / name for name in ("README.md", "CONTRIBUTING.md", "examples/README.md")),
    *sorted((REPOSITORY / "docs").rglob("*.md")),
]
EXAMPLES = sorted((REPOSITORY / "examples").glob("*.py"))
_BLOCK = re.compile(r"^ *```sh\n(?P<text>.*?)^ *```$", re.DOTALL | re.MULTILINE)
_IN_SENTENCE = re.compile(r"`((?:airlight|python|pip install|\./run) [^`]+)`")


def lines(path: Path) -> list[str]:
    """The command lines of a page's blocks, and of an example's docstring."""
    text = path.read_text("utf-8")
    if path.suffix == ".py":
        return re.findall(r"^    (python .+)$", text, re.MULTILINE)
    whole = "".join(block["text"] for block in _BLOCK.finditer(text)).replace("\\\n", " ")
    return [line.strip() for line in whole.splitlines() if line.strip()]


def in_sentences(path: Path) -> list[str]:
    """What a page's prose names; a command may be broken over two lines."""
    prose = _BLOCK.sub("", path.read_text("utf-8"))
    return [re.sub(r"\s+", " ", found) for found in _IN_SENTENCE.findall(prose)]


def commands(words: list[str]) -> Iterator[list[str]]:
    """Words without what stands before a command (`NAME=value`), and without pipes."""
    while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
        words = words[1:]
    for divider in ("|", "&&", ";"):
        if divider in words:
            at = words.index(divider)
            yield from commands(words[:at])
            yield from commands(words[at + 1 :])
            return
    yield words


def parsed(words: list[str], *, values: bool) -> None:
    """Parse an airlight command line; `values`: check those of its options, too."""
    command: click.Command = command_line
    context = click.Context(command, info_name="airlight", **command.context_settings)
    while isinstance(command, click.Group) and words and not words[0].startswith("-"):
        found = command.get_command(context, words[0])
        assert found is not None, f"there is no command '{words[0]}'"
        command, words = found, words[1:]
        context = click.Context(command, info_name=command.name, parent=context)
    try:
        options, _, _ = command.make_parser(context).parse_args(list(words))
    except click.BadOptionUsage:
        assert not values, f"an option of '{' '.join(words)}' lacks its value"
        return  # as sentences name options
    for parameter in command.params if values else ():
        if isinstance(parameter, click.Option) and options.get(parameter.name) is not None:
            parameter.type_cast_value(context, options[parameter.name])


def known(line: str, *, values: bool) -> None:
    """Assert that there is what a line names; lines of other programs are left alone."""
    for words in commands(shlex.split(line, comments=True)):
        if words[:1] == ["./run"] and words[1:2] != ["airlight"]:
            name = words[1]
            assert re.search(rf"^    {name}\b.*\)", (REPOSITORY / "run").read_text(), re.MULTILINE)
        elif words[:1] == ["airlight"] or words[:2] == ["./run", "airlight"]:
            parsed(words[words.index("airlight") + 1 :], values=values)
        elif words and words[0].endswith("python") and words[1].endswith(".py"):
            assert (REPOSITORY / words[1]).is_file(), f"{words[1]} is not there"
        elif "install" in words[:2] and words[0].endswith("pip"):
            named = re.search(r"(?:airlight|\.)\[([\w,-]+)\]", line)
            assert not named or set(named[1].split(",")) <= extras(), line


def extras() -> set[str]:
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
    return set(project["optional-dependencies"])


@pytest.mark.parametrize("path", [*PAGES, *EXAMPLES], ids=lambda p: p.name)
def test_commands_and_their_options_are_there(path):
    wrong = []
    for line, values in [
        *((line, True) for line in lines(path)),
        *((line, False) for line in (in_sentences(path) if path.suffix == ".md" else ())),
    ]:
        try:
            known(line, values=values)
        except (click.ClickException, AssertionError, ValueError) as error:
            wrong.append(f"{line}\n    {error}")
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("airlight rendr a.obj", "there is no command 'rendr'"),
        ("airlight render a.obj --dnoise", "dnoise"),
        ("airlight render a.obj --samples few", "few"),
        ("python examples/gone.py", "gone.py is not there"),
    ],
)
def test_what_is_not_there_is_found(line, says):
    with pytest.raises((click.ClickException, AssertionError)) as found:
        known(line, values=True)
    assert says in str(found.value)
    for wrong in ("./run tests", "pip install '.[vew]'"):
        with pytest.raises(AssertionError):
            known(wrong, values=True)


def test_the_extra_all_is_every_extra_that_is_not_for_work_on_airlight_itself():
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
    (one,) = project["optional-dependencies"]["all"]
    named = set(one.removeprefix("airlight[").removesuffix("]").split(","))
    # `notebook` has `view` in it.
    assert named | {"view", "all", "docs", "test", "test-view"} == extras()
    installed = (REPOSITORY / "docs" / "install.md").read_text("utf-8")
    assert all(f"| `{name}` |" in installed for name in {*named, "view", "all"})
