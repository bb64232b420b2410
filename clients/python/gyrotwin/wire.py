"""One datagram: how it is laid out, judged and signed; no socket. Norm: messages/README.md."""

from __future__ import annotations

import hashlib
import hmac
import struct
from typing import Any, NamedTuple, Optional

from .command_t import command_t
from .forecast_t import forecast_t
from .health_t import health_t
from .link_t import link_t
from .reply_t import reply_t
from .request_t import request_t
from .sensors_t import sensors_t
from .state_t import state_t
from .status_t import status_t
from .truth_t import truth_t

MAC_SIZE = 32  # of the signature, the last field of every message [byte]
MAX_NAME = 63  # of a channel, prefix included [byte]
MAX_DATAGRAM = 1400  # [byte]

_SHORT, _FRAGMENT = b"LC02", b"LC03"
_PROLOGUE = 8  # magic and packet number [byte]
# In a payload: the fingerprint, then header_t.
_FINGERPRINT_SIZE = 8
_RIG_ID = struct.Struct(">i")
_RIG_ID_AT = 8
_EPOCH_AND_SEQUENCE = struct.Struct(">qq")
_EPOCH_AT = 16


class Channel(NamedTuple):
    """What one channel carries."""

    type: Any  # class that lcm-gen made
    size: int  # of every payload, fingerprint and signature included [byte]

    @property
    def fingerprint(self) -> bytes:
        """First 8 bytes of every payload."""
        return self.type._get_packed_fingerprint()


# Name behind `<prefix>/`. The order is the index of the per-channel counters in status_t.
CHANNELS = {
    "LIVE/STATE": Channel(state_t, 304),
    "LIVE/COMMAND": Channel(command_t, 160),
    "REQUEST": Channel(request_t, 448),
    "REPLY": Channel(reply_t, 288),
    "SIM/TRUTH": Channel(truth_t, 448),
    "INTEGRATOR/STATUS": Channel(status_t, 1088),
    "CONTROLLER/STATUS": Channel(status_t, 1088),
    "LIVE/SENSORS": Channel(sensors_t, 264),
    "HARDWARE/STATUS": Channel(status_t, 1088),
    "HARDWARE/LINK": Channel(link_t, 320),
    "MIRROR/STATUS": Channel(status_t, 1088),
    "TWIN/STATE": Channel(state_t, 304),
    "TWIN/HEALTH": Channel(health_t, 572),
    "TWIN/FORECAST": Channel(forecast_t, 176),
    "GATEWAY/STATUS": Channel(status_t, 1088),
}


def text(field: bytes) -> str:
    """A `byte[n]` that holds ASCII padded with NUL, e.g. `status.text`."""
    return bytes(field).split(b"\0", 1)[0].decode("ascii", "replace")


def signature(key: bytes, name: bytes, payload: bytes) -> bytes:
    """What the last 32 bytes of `payload` must be on the channel of this full name."""
    signed = hashlib.blake2b(name, key=key, digest_size=MAC_SIZE)
    signed.update(b"\0")
    signed.update(payload[:-MAC_SIZE])
    return signed.digest()


def signed_with(key: bytes, name: bytes, payload: bytes) -> bool:
    """Whether the payload ends with the signature of this key."""
    return hmac.compare_digest(signature(key, name, payload), payload[-MAC_SIZE:])


def rig_id_of(payload: bytes) -> int:
    """`header.rig_id` of a payload of any type but header_t itself."""
    return _RIG_ID.unpack_from(payload, _RIG_ID_AT)[0]


class Parsed(NamedTuple):
    """A datagram taken apart. The rest means something only when the verdict is `good`."""

    verdict: str  # good, or the counter it falls into: malformed, foreign, other_rig, unauthentic
    channel: str = ""
    epoch: int = 0
    sequence: int = 0
    payload: bytes = b""


class DatagramFormat:
    """LCM's short message as one rig writes it."""

    def __init__(self, prefix: str, rig_id: int, key: Optional[bytes]):
        """key: 32 bytes, or None on an unsigned rig."""
        self._names = {f"{prefix}/{channel}".encode("ascii"): channel for channel in CHANNELS}
        self._full = {channel: name for name, channel in self._names.items()}
        self._rig_id = rig_id
        self._key = key

    def parse(self, datagram: bytes) -> Parsed:
        """Judges any bytes, in the order of messages/README.md."""
        if len(datagram) < _PROLOGUE:
            return Parsed("malformed")
        if datagram[:4] == _FRAGMENT:
            return Parsed("foreign")
        name, nul, payload = datagram[_PROLOGUE:].partition(b"\0")
        if datagram[:4] != _SHORT or not nul or not 1 <= len(name) <= MAX_NAME:
            return Parsed("malformed")
        channel = self._names.get(name)
        if channel is None:
            return Parsed("foreign")
        spec = CHANNELS[channel]
        if len(payload) != spec.size or payload[:_FINGERPRINT_SIZE] != spec.fingerprint:
            return Parsed("malformed")
        if rig_id_of(payload) != self._rig_id:
            return Parsed("other_rig")
        epoch, sequence = _EPOCH_AND_SEQUENCE.unpack_from(payload, _EPOCH_AT)
        if epoch < 0 or sequence < 0:
            return Parsed("malformed")
        if self._key is not None and not signed_with(self._key, name, payload):
            return Parsed("unauthentic")
        return Parsed("good", channel, epoch, sequence, payload)

    def write(self, channel: str, message: Any, packet_number: int = 0) -> bytes:
        """The datagram of a message, signed where there is a key; sets its rig_id and mac."""
        message.header.rig_id = self._rig_id
        message.mac = bytes(MAC_SIZE)
        payload = message.encode()
        name = self._full[channel]
        if self._key is not None:
            message.mac = signature(self._key, name, payload)
            payload = payload[:-MAC_SIZE] + message.mac
        return _SHORT + struct.pack(">I", packet_number & 0xFFFFFFFF) + name + b"\0" + payload
