"""What the schema asks for at a place of the scene, in words; read off the msgspec types."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from typing import NamedTuple

from msgspec import inspect as types

from harness.scene.model import Scene

Key = str | int

ASIDE = "expect"
"""The table of hard cases: no key of it is what a misplaced key of another scene was meant for."""

MOST_PLACES = 3
"""Places that a message names."""

NUMBER = re.compile(r"[+-]?[0-9]{1,20}(\.[0-9]{1,20})?([eE][+-]?[0-9]{1,3})?")
"""What TOML reads as a number, and what a message can repeat."""


class Home(NamedTuple):
    """A place of the schema, arrays as []; field and tag (`kind`, `cosine`) if only some tables there have it."""

    path: str
    field: str
    tag: str


@cache
def scene_type() -> types.Type:
    """Return the schema of a scene as msgspec sees it."""
    return types.type_info(Scene)


def type_at(data: object, keys: Sequence[Key]) -> types.Type:
    """Follow `keys` from the root; `data` decides which of several tagged tables is meant."""
    node = scene_type()
    for key in keys:
        node = _step(node, data, key)
        data = value_at(data, [key])
    return node


def value_at(data: object, keys: Sequence[Key]) -> object:
    """Return the value at `keys`, None where there is none."""
    for key in keys:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def known_keys(node: types.Type, data: object) -> list[str]:
    """Return the keys of the table that `node` describes, its tag first."""
    table = _table(node, data)
    tag = [table.tag_field] if table.tag_field else []
    return tag + [f.encode_name for f in table.fields]


def missing_tag(data: object, node: types.Type | None = None, keys: tuple[Key, ...] = ()) -> tuple[Key, ...] | None:
    """Return the place of a tag (`kind`, `law`) that valid data leave out; None if all are there.

    msgspec lets a tag be absent where only one kind exists so far; a scene has to say it.
    """
    node = node or scene_type()
    if isinstance(data, dict):
        table = _table(node, data)
        if table.tag_field and table.tag_field not in data:
            return (*keys, table.tag_field)
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    inner = (missing_tag(v, _step(node, data, k), (*keys, k)) for k, v in items if isinstance(v, dict | list))
    return next((place for place in inner if place), None)


def describe(node: types.Type) -> str:
    """Say what is expected: "a number > 0", '"sphere" or "disc"', "an array of 2 numbers"."""
    if isinstance(node, types.Metadata):
        return (node.extra_json_schema or {}).get("description") or describe(node.type)
    if isinstance(node, types.UnionType):
        return _describe_union(node)
    if isinstance(node, types.LiteralType):
        return either(f'"{v}"' if isinstance(v, str) else str(v) for v in node.values)
    if isinstance(node, types.StructType):
        return "a table" if node.tag is None else f'a table with {node.tag_field} = "{node.tag}"'
    if isinstance(node, types.VarTupleType | types.TupleType):
        return _describe_array(node)
    return _SCALARS[type(node)] + _bounds(node)


def choices(node: types.Type) -> list[str]:
    """Return the words allowed at `node`, empty if it is not a choice of words."""
    parts = node.types if isinstance(node, types.UnionType) else (node,)
    return [v for p in parts if isinstance(p, types.LiteralType) for v in p.values if isinstance(v, str)]


def quoted(word: str, node: types.Type) -> str:
    """Return "write it without quotes: ..." for a word that `node` would take as a number or true or false; else ""."""
    parts = _unwrap(node)
    taken = {str(v).lower() for p in parts if isinstance(p, types.LiteralType) for v in p.values}
    if any(isinstance(p, types.BoolType) for p in parts):
        taken |= {"true", "false"}
    number = any(isinstance(p, types.FloatType | types.IntType) for p in parts) and NUMBER.fullmatch(word)
    return f"write it without quotes: {word}" if number or word in taken else ""


def nearest(word: object, known: Iterable[str]) -> str:
    """Return "did you mean ...?" for a word close to a known one, else ""."""
    match = difflib.get_close_matches(str(word)[:80], list(known), n=1, cutoff=0.5)
    return f"did you mean {match[0]}?" if match else ""


def elsewhere(key: str, data: object, keys: Sequence[Key]) -> str:
    """Return "did you mean ...?" with the places that have this very key, which the table at `keys` has not; else "".

    Places in a scene of the kind of `data` come first; a table that has the key under another `kind` or
    `law` is named with it.
    """
    chosen = _table(scene_type(), data)
    others = [t for t in _unwrap(scene_type()) if t is not chosen]
    for root, note in [(chosen, ""), *((t, f" of a scene with {t.tag_field} = \"{t.tag}\"") for t in others)]:
        homes = [h for h in _homes(root, "") if h.path.rpartition(".")[2] == key]
        here = "".join("[]" if isinstance(k, int) else f".{k}" for k in [*keys, key]).lstrip(".")
        places = dict.fromkeys(h.path for h in homes if h.path == here) or dict.fromkeys(h.path for h in homes)
        words = [p + _with_tags([h for h in homes if h.path == p]) for p in places]
        if words:
            return f"did you mean {either(words[:MOST_PLACES])}{note}?"
    return ""


def either(words: Iterable[str]) -> str:
    """Join words: "a, b or c"."""
    words = list(words)
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


_SCALARS = {
    types.FloatType: "a number",
    types.IntType: "an integer",
    types.StrType: "a text",
    types.BoolType: "true or false",
}


def _bounds(node: types.Type) -> str:
    signs = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
    given = {sign: getattr(node, name, None) for name, sign in signs.items()}
    text = " and ".join(f"{sign} {bound}" for sign, bound in given.items() if bound is not None)
    return f" {text}" if text else ""


def _describe_union(node: types.UnionType) -> str:
    parts = [t for t in node.types if not isinstance(t, types.NoneType)]
    if len(parts) > 1 and all(isinstance(t, types.StructType) for t in parts):
        tags = either(f'"{t.tag}"' for t in parts)
        return f"a table with {parts[0].tag_field} = {tags}"
    return either(describe(t) for t in parts)


def _describe_array(node: types.VarTupleType | types.TupleType) -> str:
    if isinstance(node, types.TupleType):
        words = any(isinstance(t, types.StrType) for item in node.item_types for t in _unwrap(item))
        return f"an array of {len(node.item_types)} {'words' if words else 'numbers'}"
    item = node.item_type
    if not isinstance(item, types.FloatType):
        return "an array of tables"
    length = f"{node.min_length} or {node.max_length} " if node.min_length else ""
    return f"an array of {length}numbers{_bounds(item)}"


def _step(node: types.Type, data: object, key: Key) -> types.Type:
    inner = _unwrap(node)
    structs = [t for t in inner if isinstance(t, types.StructType)]
    if structs and key == structs[0].tag_field:
        return types.LiteralType(tuple(t.tag for t in structs))
    if structs:
        table = _table(node, data)
        return next(f.type for f in table.fields if f.encode_name == key)
    array = next(t for t in inner if isinstance(t, types.VarTupleType | types.TupleType))
    return array.item_type if isinstance(array, types.VarTupleType) else array.item_types[key]


def _table(node: types.Type, data: object) -> types.StructType:
    structs = [t for t in _unwrap(node) if isinstance(t, types.StructType)]
    tagged = [t for t in structs if t.tag is not None and value_at(data, [t.tag_field]) == t.tag]
    return (tagged or structs)[0]


def _homes(node: types.Type, path: str) -> Iterator[Home]:
    """Yield every key at and below a place of the schema."""
    inner = _unwrap(node)
    structs = [t for t in inner if isinstance(t, types.StructType)]
    for struct in structs:
        for field in (f for f in struct.fields if f.encode_name != ASIDE):
            name = field.encode_name
            place = f"{path}.{name}".lstrip(".")
            everywhere = all(name in [f.encode_name for f in t.fields] for t in structs)
            yield Home(place, "" if everywhere else struct.tag_field, "" if everywhere else struct.tag)
            yield from _homes(field.type, place)
    for array in (t for t in inner if isinstance(t, types.VarTupleType)):
        yield from _homes(array.item_type, f"{path}[]")


def _with_tags(homes: list[Home]) -> str:
    tags = dict.fromkeys(f'"{h.tag}"' for h in homes if h.tag)
    return f" with {homes[0].field} = {either(tags)}" if tags else ""


def _unwrap(node: types.Type) -> list[types.Type]:
    if isinstance(node, types.Metadata):
        return _unwrap(node.type)
    if isinstance(node, types.UnionType):
        return [inner for t in node.types for inner in _unwrap(t)]
    return [node]
