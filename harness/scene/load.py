"""Read a scene file. Whatever is wrong with it becomes one line: file, place, expected, got, fix."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import msgspec

from harness.errors import InputError
from harness.scene import describe
from harness.scene.checks import first_fault
from harness.scene.fault import Fault, number_fault, path_text, printable, shorten, show
from harness.scene.files import read_text
from harness.scene.model import Scene
from harness.scene.resolve import known_system

LARGEST_FILE = 1_000_000
"""Bytes of a scene file; many bodies belong into a CSV file."""

def load_scene(path: Path | str) -> Scene:
    """Read, convert and check the scene in a TOML file, and the files that it names.

    A scene that loads can be run, as far as that can be known before a packing is made.

    Raises InputError for everything that is wrong with the file.
    """
    path = Path(path)
    data = _parse(path)
    try:
        scene = _convert(data, path)
    except RecursionError:
        raise Fault(place="", expected="a scene", got="tables nested too deeply").error(path) from None
    fault = first_fault(scene, path.parent)
    if fault:
        raise fault.error(path)
    known_system(scene, path)
    return scene


def files_of(path: Path) -> list[Path]:
    """Return a scene file and the file that it names, if any; of a file that is no scene, itself."""
    try:
        data = _parse(path)
    except InputError:
        return [path]
    names = [describe.value_at(data, keys) for keys in (["bodies_file"], ["particles", "packing"])]
    return [path, *(path.parent / name for name in names if isinstance(name, str) and name.isprintable())]


def _parse(path: Path) -> dict:
    text = read_text(path, what="a scene file (TOML)", largest=LARGEST_FILE)
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise Fault(place="", expected="a scene", got="arrays nested too deeply").error(path) from None
    except ValueError as error:
        raise _syntax_fault(str(error), text).error(path) from None


def _syntax_fault(message: str, text: str) -> Fault:
    """Turn tomllib's message, which names line and column, into a fault that shows the line."""
    found = re.search(r"\(at line (\d+), column \d+\)", message)
    reason = shorten(printable(re.sub(r"\s*\(at [^)]*\)$", "", message)))
    if not found:
        place = "last line" if "end of document" in message else ""
        return Fault(place=place, expected="TOML", got=f"an error: {reason}")
    number = int(found[1])
    line = text.split("\n")[number - 1].strip()
    return Fault(place=f"line {number}", expected="TOML", got=show(line), fix=reason)


def _convert(data: dict, path: Path) -> Scene:
    fault = next(_number_faults(data, []), None)
    if fault:
        raise fault.error(path)
    try:
        scene = msgspec.convert(data, Scene)
    except msgspec.ValidationError as error:
        raise _schema_fault(str(error), data).error(path) from None
    place = describe.missing_tag(data)
    if place:
        raise _missing(data, list(place)).error(path)
    return scene


def _number_faults(value: object, keys: list) -> Iterator[Fault]:
    if isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for key, inner in items:
            yield from _number_faults(inner, [*keys, key])
    else:
        fault = number_fault(value, path_text(keys))
        if fault:
            yield fault


def _schema_fault(message: str, data: dict) -> Fault:
    """Turn msgspec's message into ours; of it only the place and the kind of fault are used."""
    keys = _keys(message)
    if message.startswith("Object contains unknown field"):
        return _unknown_key(data, keys)
    missing = re.match(r"Object missing required field `(\w+)`", message)
    if missing:
        return _missing(data, [*keys, missing[1]])
    node, value = describe.type_at(data, keys), describe.value_at(data, keys)
    return Fault(place=path_text(keys), expected=describe.describe(node), got=show(value), fix=_fix(value, node))


def _fix(value: object, node) -> str:
    if not isinstance(value, str):
        return ""
    return describe.quoted(value, node) or describe.nearest(value, describe.choices(node))


def _missing(data: dict, keys: list) -> Fault:
    expected = describe.describe(describe.type_at(data, keys))
    return Fault(place=path_text(keys), expected=expected, got="nothing", fix=f"add {keys[-1]}")


def _unknown_key(data: dict, keys: list) -> Fault:
    table = describe.value_at(data, keys)
    known = describe.known_keys(describe.type_at(data, keys), table)
    key = next(k for k in table if k not in known)
    return Fault(
        place=path_text([*keys, key]), expected=f"one of {', '.join(known)}", got=f"the unknown key {show(key)}",
        fix=describe.elsewhere(key, data, keys) or describe.nearest(key, known),
    )


def _keys(message: str) -> list[str | int]:
    """Return the place that msgspec names, "- at `$.planes[2].motion`", as keys; no place is the root."""
    found = re.search(r" - at `\$([^`]*)`\Z", message)
    parts = re.findall(r"\.(\w+)|\[(\d+)\]", found[1]) if found else []
    return [name or int(index) for name, index in parts]
