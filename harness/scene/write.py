"""A scene as a TOML file that `harness.scene.load` reads back to the same scene."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path

import msgspec

from harness.runs.atomic import write_bytes_atomic, write_text_atomic
from harness.scene.model import Biaxial, Free, Scene


def scene_text(scene: Scene, *, about: str = "") -> str:
    """Return the TOML text; tables and numbers that are absent stay so. about: comment lines in front."""
    head = [f"# {line}".rstrip() for line in about.splitlines()]
    return "\n".join([*head, *[""] * bool(head), *_table(_present(msgspec.to_builtins(scene)), "")]) + "\n"


def write_scene(scene: Scene, source: Path, place: Path, *, about: str = "") -> None:
    """Write the scene at `place`, and beside it a copy of the file that it names, found beside `source`."""
    name = named_file(scene)
    if name is not None:
        copy = place.parent / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        write_bytes_atomic(copy, (source.parent / name).read_bytes())
    write_text_atomic(place, scene_text(scene, about=about))


def named_file(scene: Scene) -> str | None:
    """Return the name of the file with a scene's particles, None if they stand in the scene."""
    if isinstance(scene, Biaxial):
        return scene.particles.packing
    return scene.bodies_file if isinstance(scene, Free) else None


def _present(value: object) -> object:
    """Leave out what is absent: None, and empty lists, which is how absent lists are held."""
    if isinstance(value, Mapping):
        return {k: _present(v) for k, v in value.items() if v is not None and v != [] and v != ()}
    if isinstance(value, list | tuple):
        return [_present(v) for v in value]
    return value


def _table(table: Mapping, path: str) -> Iterator[str]:
    """Yield a table: its plain values first, then the tables below it."""
    inner = {k: v for k, v in table.items() if isinstance(v, Mapping)}
    lists = {k: v for k, v in table.items() if isinstance(v, list) and v and isinstance(v[0], Mapping)}
    for key, value in table.items():
        if key not in inner and key not in lists:
            yield f"{key} = {_value(value)}"
    for key, value in inner.items():
        yield from _headed(f"[{path}{key}]", value, f"{path}{key}.")
    for key, values in lists.items():
        for value in values:
            yield from _headed(f"[[{path}{key}]]", value, f"{path}{key}.")


def _headed(head: str, table: Mapping, path: str) -> Iterator[str]:
    yield ""
    yield head
    yield from _table(table, path)


def _value(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_value(v) for v in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value) if isinstance(value, str) else repr(value)
