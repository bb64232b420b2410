"""A rig's bus: hears what is sound and signed, counts the rest, and sends."""

from __future__ import annotations

import errno
import select
import socket
import struct
import time
from collections import Counter, OrderedDict
from dataclasses import dataclass, field
from typing import Any, Iterable, Iterator, Optional, Tuple, Union

from .errors import Error
from .rig import Rig
from .wire import CHANNELS, MAX_DATAGRAM, DatagramFormat, Parsed

# Linux; Python does not name them.
_IP_MULTICAST_ALL = 49
_SO_MEMINFO = 55
_MEMINFO_DROPS = 8  # of its nine numbers

_RECEIVE_BUFFER = 4 << 20  # that is asked for; the kernel grants up to net.core.rmem_max [byte]
_LEAST_BUFFERED = 512  # that the kernel counts for one datagram [byte]
_REMEMBERED_EPOCHS = 16


@dataclass
class Counters:
    """What a bus has heard, as in status_t; the last four count by channel."""

    malformed: int = 0  # not a short LCM message, or of the wrong size or type for its channel
    foreign: int = 0  # other channels, fragments
    other_rig: int = 0  # header.rig_id of somebody else
    unauthentic: int = 0  # signature missing or wrong
    kernel_dropped: int = 0  # lost because this program did not listen in time
    received: Counter = field(default_factory=Counter)
    gaps: Counter = field(default_factory=Counter)  # sequence numbers that never came
    repeats: Counter = field(default_factory=Counter)  # the newest sequence number once more
    reordered: Counter = field(default_factory=Counter)  # older than the newest, dropped


class Bus:
    """One rig's bus, open until close() or the end of `with`. Not thread-safe.

    What arrives between two calls waits in the kernel's buffer, some hundred messages; more are
    lost, and counted as `kernel_dropped`.
    """

    def __init__(self, rig: Union[Rig, str]):
        """rig: a Rig, or what Rig() takes. Raises Error naming what is missing (key, interface)."""
        self.rig = rig if isinstance(rig, Rig) else Rig(rig)
        self._counters = Counters()
        self._format = DatagramFormat(self.rig.prefix, self.rig.id, self.rig.key)
        self._newest: dict[str, OrderedDict[int, int]] = {c: OrderedDict() for c in CHANNELS}
        self._packets = 0
        self._kernel_drops = 0
        self._receiver, self._sender = _open(self.rig)
        self._own = self._sender.getsockname()

    @property
    def counters(self) -> Counters:
        """What was heard so far. Asks the kernel what it has dropped, while the bus is open."""
        if self._receiver.fileno() >= 0:
            told = self._receiver.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 36)
            drops = struct.unpack("=9I", told)[_MEMINFO_DROPS]
            self._counters.kernel_dropped += (drops - self._kernel_drops) & 0xFFFFFFFF
            self._kernel_drops = drops
        return self._counters

    def listen(
        self, seconds: Optional[float] = None, channels: Union[str, Iterable[str], None] = None
    ) -> Iterator[Tuple[str, Any]]:
        """Yields (channel, message) as they come: `("LIVE/STATE", state_t)`.

        seconds: of wall time; None: for ever
        channels: one or more of CHANNELS, the others are heard and counted; None: all

        A message that is repeated is yielded again; one older than what was heard is not.
        """
        wanted = _names(channels)
        end = None if seconds is None else time.monotonic() + seconds
        while True:
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0.0:
                return
            heard = self._hear(left)
            if heard is not None and heard.channel in wanted:
                yield heard.channel, CHANNELS[heard.channel].type.decode(heard.payload)

    def drain(self) -> None:
        """Takes what has arrived so far out of the kernel's buffer, and counts it."""
        for _ in range(_RECEIVE_BUFFER // _LEAST_BUFFERED):  # not for ever where a flood goes on
            if not select.select([self._receiver], [], [], 0.0)[0]:
                return
            self._hear(0.0)

    def send(self, channel: str, message: Any) -> bytes:
        """Sends a message, signed; returns the datagram, for send_again().

        Sets header.rig_id, header.sender_mono_ns and mac; all else, header.source, epoch and
        sequence too, is the caller's.
        """
        message.header.sender_mono_ns = time.monotonic_ns()
        datagram = self._format.write(channel, message, self._packets)
        self._packets += 1
        self.send_again(datagram)
        return datagram

    def send_again(self, datagram: bytes) -> None:
        """Sends the same bytes once more. Raises Error when the kernel does not take them."""
        try:
            self._sender.send(datagram)
        except OSError as error:
            raise Error(f"{self.rig.interface} takes no datagram: {error.strerror}") from None

    def close(self) -> None:
        """Leaves the bus."""
        self._receiver.close()
        self._sender.close()

    def __enter__(self) -> Bus:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _hear(self, timeout_s: Optional[float]) -> Optional[Parsed]:
        """One datagram; None when none came in time, or it was not for us."""
        if not select.select([self._receiver], [], [], timeout_s)[0]:
            return None
        datagram, sender = self._receiver.recvfrom(MAX_DATAGRAM + 1)
        if sender == self._own:
            return None
        parsed = self._format.parse(datagram)
        if parsed.verdict != "good":
            count = getattr(self._counters, parsed.verdict)
            setattr(self._counters, parsed.verdict, count + 1)
            return None
        return parsed if self._in_order(parsed) else None

    def _in_order(self, heard: Parsed) -> bool:
        counters, channel = self._counters, heard.channel
        senders = self._newest[channel]
        newest = senders.get(heard.epoch)
        if newest is not None and heard.sequence < newest:
            senders.move_to_end(heard.epoch)
            counters.reordered[channel] += 1
            return False
        if heard.sequence == newest:
            counters.repeats[channel] += 1
        elif newest is not None and heard.sequence > newest + 1:
            counters.gaps[channel] += heard.sequence - newest - 1
        senders[heard.epoch] = heard.sequence
        senders.move_to_end(heard.epoch)
        if len(senders) > _REMEMBERED_EPOCHS:
            senders.popitem(last=False)
        counters.received[channel] += 1
        return True


def _names(channels: Union[str, Iterable[str], None]) -> frozenset[str]:
    if channels is None:
        return frozenset(CHANNELS)
    names = frozenset([channels] if isinstance(channels, str) else channels)
    unknown = sorted(names - frozenset(CHANNELS))
    if unknown:
        raise ValueError(f"no channel is called {unknown[0]!r}: there are {', '.join(CHANNELS)}")
    return names


def _open(rig: Rig) -> Tuple[socket.socket, socket.socket]:
    """Receiver and sender; the sender speaks from the interface's own address."""
    try:
        index = socket.if_nametoindex(rig.interface)
    except OSError:
        there = ", ".join(name for _, name in socket.if_nameindex())
        raise Error(
            f"{rig.file}: network.interface is `{rig.interface}`, which does not exist; this host "
            f"has: {there}"
        ) from None
    receiver = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        group = socket.inet_aton(rig.group)
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        receiver.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER)
        receiver.bind((rig.group, rig.port))
        on_interface = struct.pack("=4s4si", group, bytes(4), index)
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, on_interface)
        on_interface = struct.pack("=4s4si", bytes(4), bytes(4), index)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, on_interface)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, rig.ttl)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        sender.connect((rig.group, rig.port))
    except OSError as error:
        receiver.close()
        sender.close()
        fix = f": `ip link set {rig.interface} up`" if error.errno == errno.ENETUNREACH else ""
        raise Error(
            f"{rig.file}: no bus on {rig.interface}, {rig.group}:{rig.port}: "
            f"{error.strerror or error}{fix}"
        ) from None
    return receiver, sender
