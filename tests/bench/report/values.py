"""What a measuring program says: one value a line, as JSON."""

import json
import math
import re
from dataclasses import dataclass

_FIGURE = re.compile(r"[a-z][a-z_]*")
_UNITS = ("1", "ns", "us", "s", "Hz", "1/s", "rad")


@dataclass(frozen=True)
class Value:
    """One measured value of one round."""

    figure: str  # a-z_
    case: str  # a rig's name, a count, a rate, or ""
    subject: str  # "gyrotwin", "gyrotwin signed" ..., or a peer's plain name
    quantity: str  # p50, p99, max, share ...
    unit: str  # of _UNITS
    value: float


def is_ours(subject):
    return subject == "gyrotwin" or subject.startswith("gyrotwin ")


def parse(line):
    """One line. Raises ValueError saying what is wrong with it."""
    try:
        fields = json.loads(line)
    except json.JSONDecodeError:
        raise ValueError("not JSON") from None
    if not isinstance(fields, dict):
        raise ValueError("not a JSON object")
    wanted = list(Value.__dataclass_fields__)
    missing = [name for name in wanted if name not in fields]
    if missing:
        raise ValueError(f"no `{missing[0]}`")
    unknown = sorted(set(fields) - set(wanted))
    if unknown:
        raise ValueError(f"`{unknown[0]}` is not a field: {', '.join(wanted)} are")
    for name in wanted[:-1]:
        if not isinstance(fields[name], str):
            raise ValueError(f"`{name}` is not a text")
    if not _FIGURE.fullmatch(fields["figure"]):
        raise ValueError("`figure` is not made of a-z and _")
    if fields["unit"] not in _UNITS:
        raise ValueError(f"`{fields['unit']}` is not a unit: {', '.join(_UNITS)} are")
    value = fields["value"]
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError("`value` is not a finite number")
    return Value(**fields)


def parse_all(text):
    """A program's whole output. Returns its values, and what is wrong with which line."""
    values, mistakes = [], []
    for number, line in enumerate(text.splitlines(), 1):
        try:
            values.append(parse(line))
        except ValueError as error:
            mistakes.append(f"line {number}: {error}: {line[:80]}")
    return values, mistakes
