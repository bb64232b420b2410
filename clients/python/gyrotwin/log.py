"""Reading logs: of `gyrotwin log record`, or of lcm-logger; damaged ones too."""

from __future__ import annotations

import hashlib
import json
import mmap
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, List, NamedTuple, Optional, Tuple, Union

from .errors import Error
from .rig import key_path, load_key
from .wire import CHANNELS, MAX_NAME, rig_id_of, signed_with

_SYNC = b"\xed\xa1\xda\x01"
_HEADER = struct.Struct(">4sqqII")  # sync word, number, time, lengths of channel and data
_LARGEST_DATA = 64 << 20  # that is believed [byte]
_CLOCK_SLACK_US = 1_000_000  # clocks of several cores may disagree, and a clock may be set
_VISIBLE = re.compile(rb"[ -~]+")

_OWN = b"gyrotwin/log/"  # channels of the opening events
_SUM_SIZE = 17  # their first line, 16 hex digits and a newline [byte]
_ABOUT_KEYS = {"rig", "prefix", "rig_id", "key", "channels"}  # that are needed here

_TYPES = {channel.fingerprint: channel for channel in CHANNELS.values()}

# What is known of an event besides that it has the form of one.
_UNKNOWN, _RIGHT_SHAPE, _AUTHENTIC, _WRONG_SHAPE, _WRONG_SIGNATURE = range(5)


@dataclass
class Damage:
    """What a log has lost. False when nothing is."""

    bytes_lost: int = 0  # of no event that was read
    events_lost: int = 0  # as far as event numbers tell; the next two are among them
    wrong_shape: int = 0  # not of their channel's type or size
    wrong_signature: int = 0  # altered, or of somebody else
    times_repaired: int = 0  # read with the time of the event before

    def __bool__(self) -> bool:
        return self.bytes_lost + self.events_lost + self.times_repaired > 0


class _Event(NamedTuple):
    """Bytes that have the form of an event."""

    begin: int
    end: int
    number: int
    time_us: int
    name: bytes
    data: bytes


class Log:
    """One log file. Iterating yields (time, channel, message), each time from the start:

    time: when the kernel had it, since the log's first message [s]
    channel: behind the rig's prefix, `LIVE/STATE`, as Bus.listen() has it; whole where it is not
        one of the rig's
    message: of the channel's type; bytes where this package has no such type
    """

    about: dict  # who recorded which rig: program, host, rig, prefix, rig_id ...; may be empty
    rig_text: str  # the rig file in effect, overrides applied; empty when the log has none
    damage: Damage  # of the reading so far; complete when it has come to the end
    signatures_checked: bool  # the key of the record is on this host

    def __init__(self, path: Union[str, Path]):
        """Raises Error when the file cannot be read. A damaged one can: see `damage`."""
        self.path = Path(path)
        self.about, self.rig_text = {}, ""
        self.damage = Damage()
        self._key: Optional[bytes] = None
        try:
            with open(self.path, "rb") as file:
                empty = file.seek(0, 2) == 0  # which cannot be mapped
                self._all = b"" if empty else mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        except (OSError, ValueError) as error:
            why = getattr(error, "strerror", None) or error
            raise Error(f"{self.path}: cannot be read: {why}") from None
        for event in self._events():
            if not event.name.startswith(_OWN):
                break
            self._take_opening(event)
        self.signatures_checked = self._key is not None
        self.damage = Damage()

    @property
    def channels(self) -> dict[str, str]:
        """Channels that the rig has, with their types: `{"LIVE/STATE": "state_t"}`."""
        there = self.about.get("channels", {})
        if not there:
            return {name: channel.type.__name__ for name, channel in CHANNELS.items()}
        return {name.partition("/")[2]: channel["type"] for name, channel in there.items()}

    def __iter__(self) -> Iterator[Tuple[float, str, Any]]:
        return self.read()

    def read(self, *channels: str) -> Iterator[Tuple[float, str, Any]]:
        """As iterating, of these channels alone: quicker, for the others are not decoded."""
        begin_us = None
        for event in self._events():
            if event.name.startswith(_OWN):
                continue
            if begin_us is None:
                begin_us = event.time_us
            name = self._name(event.name)
            if channels and name not in channels:
                continue
            known = _TYPES.get(event.data[:8])
            message = known.type.decode(event.data) if known else event.data
            yield 1e-6 * (event.time_us - begin_us), name, message

    def _name(self, full: bytes) -> str:
        prefix, _, name = full.decode("ascii").partition("/")
        of_rig = prefix == self.about["prefix"] if self.about else name in CHANNELS
        return name if of_rig else full.decode("ascii")

    def _events(self) -> Iterator[_Event]:
        """Every event in which nothing speaks for damage; counts what lies between."""
        damage = self.damage = Damage()
        at = search = 0  # where the next event should begin, and where it may
        expected, time_us = 0, None
        while True:
            event = self._find(search)
            if event is None:
                break
            if not self._is_sound(event):
                search = event.begin + 1
                continue
            damage.bytes_lost += event.begin - at
            at = search = event.end
            behind = self._event_at(at)

            # A number that the next event does not confirm is taken for damaged.
            confirmed = behind.number == event.number + 1 if behind else at == len(self._all)
            if confirmed and event.number > expected:
                damage.events_lost += event.number - expected
            expected = event.number + 1 if confirmed else expected + 1

            # An event between two that are in order is in order too.
            if time_us is not None and behind and time_us <= behind.time_us:
                low, high = time_us - _CLOCK_SLACK_US, behind.time_us + _CLOCK_SLACK_US
                if not low <= event.time_us <= high:
                    damage.times_repaired += 1
                    event = event._replace(time_us=time_us)
            time_us = event.time_us
            yield event
        if at < len(self._all):  # at least one was there, and one for every sync word
            damage.bytes_lost += len(self._all) - at
            damage.events_lost += max(1, self._all[at:].count(_SYNC))

    def _find(self, search: int) -> Optional[_Event]:
        """The first bytes from `search` on that have the form of an event."""
        while True:
            search = self._all.find(_SYNC, search)
            if search < 0:
                return None
            event = self._event_at(search)
            if event is not None:
                return event
            search += 1

    def _event_at(self, begin: int) -> Optional[_Event]:
        name_at = begin + _HEADER.size
        if name_at > len(self._all):
            return None
        sync, number, time_us, name_size, data_size = _HEADER.unpack_from(self._all, begin)
        data_at = name_at + name_size
        end = data_at + data_size
        if sync != _SYNC or not 1 <= name_size <= MAX_NAME or data_size > _LARGEST_DATA:
            return None
        if end > len(self._all):
            return None
        name = self._all[name_at:data_at]
        if _VISIBLE.fullmatch(name) is None:
            return None
        return _Event(begin, end, number, time_us, name, self._all[data_at:end])

    def _is_sound(self, event: _Event) -> bool:
        found = self._examine(event)
        if found == _AUTHENTIC:
            return True
        followed = event.end == len(self._all) or self._all[event.end : event.end + 4] == _SYNC
        if found == _WRONG_SHAPE:
            self.damage.wrong_shape += followed
        elif found == _WRONG_SIGNATURE:
            self.damage.wrong_signature += followed
        elif found == _RIGHT_SHAPE:  # where bytes are missing it reaches into another
            return followed or _SYNC not in event.data
        else:
            return followed
        return False

    def _examine(self, event: _Event) -> int:
        name, data = event.name, event.data
        if name.startswith(_OWN):
            return _AUTHENTIC if data[:_SUM_SIZE] == _sum(name, data) else _WRONG_SHAPE
        channel = self.about.get("channels", {}).get(name.decode("ascii"))
        if channel is not None:
            if len(data) != channel["size"] or data[:8].hex() != channel["fingerprint"]:
                return _WRONG_SHAPE
            if rig_id_of(data) != self.about["rig_id"]:
                return _WRONG_SHAPE
            if self._key is None:
                return _RIGHT_SHAPE
            return _AUTHENTIC if signed_with(self._key, name, data) else _WRONG_SIGNATURE
        known = _TYPES.get(data[:8])
        if known is None:
            return _UNKNOWN
        if len(data) != known.size:
            return _WRONG_SHAPE
        # The rig's messages are on its channels: here the name is damaged.
        of_rig = self.about and rig_id_of(data) == self.about["rig_id"]
        return _WRONG_SHAPE if of_rig else _RIGHT_SHAPE

    def _take_opening(self, event: _Event) -> None:
        content = event.data[_SUM_SIZE:].decode("utf-8", "replace")
        if event.name == _OWN + b"rig":
            self.rig_text = content
        elif event.name == _OWN + b"about":
            about = json.loads(content)
            if _ABOUT_KEYS <= set(about):
                self.about = about
                self._key = self._key_at_hand()

    def _key_at_hand(self) -> Optional[bytes]:
        try:
            key = load_key(key_path(self.about["rig"]))
        except Error:
            return None
        # A key made anew since cannot tell right from wrong here.
        digits = _digest(key)
        print_of_key = "-".join(digits[at : at + 4] for at in range(0, 16, 4))
        return key if print_of_key == self.about["key"] else None


def _digest(data: bytes) -> str:
    return hashlib.blake2b(data, digest_size=32).hexdigest()[:16]


def _sum(name: bytes, data: bytes) -> bytes:
    return _digest(name + b"\0" + data[_SUM_SIZE:]).encode("ascii") + b"\n"


def series(log: Log, channel: str, field: str) -> Tuple[List[float], List[Any]]:
    """One number of a channel over time: (times [s] as Log has them, values in the field's unit).

    field: `tilt_rad[0]`, `header.sim_time_ns`

    Raises Error when the log has no message on the channel, or its type no such field.
    """
    if re.fullmatch(r"\w+(\.\w+|\[\d+\])*", field) is None:
        raise Error(f"`{field}` is no field; expected e.g. `tilt_rad[0]` or `header.tick`")
    path = re.findall(r"(\w+)|\[(\d+)\]", field)
    times, values = [], []
    for time, _, message in log.read(channel):
        try:
            for name, index in path:
                message = getattr(message, name) if name else message[int(index)]
        except (AttributeError, IndexError, TypeError):
            names = getattr(message, "__slots__", ())
            known = f"; there are {', '.join(names)}" if names else ""
            raise Error(f"{channel} has no `{field}`{known}") from None
        times.append(time)
        values.append(message)
    if not times:
        there = sorted({name for _, name, _ in log})
        raise Error(f"{log.path}: no message on {channel!r}; channels are {', '.join(there)}")
    return times, values
