"""An operator: asks the owner of a rig for something, and has its answer."""

from __future__ import annotations

import secrets
from operator import index
from typing import Any, NamedTuple, Optional, Sequence, Union

from .bus import Bus
from .errors import NoAnswer, Refused
from .header_t import header_t
from .reply_t import reply_t
from .request_t import request_t
from .rig import Rig
from .status_t import status_t
from .wire import text

_OWNER_PATIENCE_S = 2.0  # for the owner's STATUS
_RESEND_S = 0.1  # a request without answer again
_TRIES = 20  # of one request
_OWNER_STATUS = ("INTEGRATOR/STATUS", "HARDWARE/STATUS")
# Not a caller's: who asks, whom, and what for.
_OWN_FIELDS = ("header", "verb", "kind", "owner_epoch", "writer", "counter", "mac")


class Reply(NamedTuple):
    """The owner has applied a request."""

    tick: int  # the first tick it acts in
    id: int  # number of a disturbance or fault, for cancel(); else 0
    text: str  # what was done


class Operator:
    """One operator on a rig, until close() or the end of `with`. Not thread-safe.

    Every verb sends one signed request, the same bytes again until the owner answers, and returns
    its Reply. It raises Refused with the owner's reason, or NoAnswer after about two seconds.
    A request is done once however often it is sent.
    """

    def __init__(self, rig: Union[Rig, str]):
        """rig: a Rig, or what Rig() takes. Raises Error naming what is missing (key, interface)."""
        self.bus = Bus(rig)
        self._epoch = secrets.randbits(63)
        self._writer = secrets.randbits(63)
        self._counter = 0
        self._owner_header: Optional[header_t] = None  # of what the owner said last

    def owner(self) -> status_t:
        """How the owner is: its next STATUS, within about 0.1 s of wall time. Raises NoAnswer."""
        self.bus.drain()
        for _, status in self.bus.listen(_OWNER_PATIENCE_S, _OWNER_STATUS):
            self._owner_header = status.header
            return status
        rig = self.bus.rig
        raise NoAnswer(
            f"no owner of rig {rig.name} is heard on {rig.interface}, {rig.group}:{rig.port}: "
            f"start it with `gyrotwin integrator --rig {rig.file}`{self._suspicion()}"
        )

    def arm(self) -> Reply:
        """Lets the held plant go: the controller's commands act."""
        return self._ask(request_t.ARM)

    def disarm(self) -> Reply:
        """Stops safely; reset() leads back to HELD."""
        return self._ask(request_t.DISARM)

    def pause(self) -> Reply:
        """Lets a simulated plant's time stand still."""
        return self._ask(request_t.PAUSE)

    def resume(self) -> Reply:
        """Lets time go on."""
        return self._ask(request_t.RESUME)

    def step(self, ticks: int = 1) -> Reply:
        """Runs so many ticks of a paused plant."""
        return self._ask(request_t.STEP, step_ticks=ticks)

    def reset(
        self, q: Optional[Sequence[float]] = None, v: Optional[Sequence[float]] = None
    ) -> Reply:
        """Back to HELD, a new run, at the rig file's initial state or at the one given.

        q: generalised coordinates in the machine's order, up to 6 [rad]; those left out are 0
        v: their rates [rad/s]
        """
        if q is None and v is None:
            return self._ask(request_t.RESET)
        return self._ask(
            request_t.RESET,
            initial_given=1,
            initial_q=() if q is None else q,
            initial_v=() if v is None else v,
        )

    def speed(self, factor: float) -> Reply:
        """Simulated over wall time [1], e.g. 0.5 is half as fast."""
        return self._ask(request_t.SPEED, speed_factor=factor)

    def spin_up(self) -> Reply:
        """Lets all flywheels spin up to their nominal speed."""
        return self._ask(request_t.ROTORS, request_t.SPIN_UP)

    def spin_down(self) -> Reply:
        """Lets all flywheels coast down."""
        return self._ask(request_t.ROTORS, request_t.SPIN_DOWN)

    def push(
        self, roll_nms: float = 0.0, pitch_nms: float = 0.0, duration_s: Optional[float] = None
    ) -> Reply:
        """A short push of the structure, world frame.

        roll_nms, pitch_nms: impulse about x and about y [N m s]; both 0: the rig's reference push
        duration_s: rounded to ticks, at least one [s]; None: the rig file's impulse_duration_s
        """
        rig = self.bus.rig
        if roll_nms == 0.0 and pitch_nms == 0.0:
            roll_nms = rig.reference_impulse_nms
        if duration_s is None:
            duration_s = rig.impulse_duration_s
        tick_ns = self.owner().tick_period_ns
        duration_ns = max(1, round(1e9 * duration_s / tick_ns)) * tick_ns
        moment_nm = [1e9 * impulse / duration_ns for impulse in (roll_nms, pitch_nms)]
        return self.disturb("LOAD", moment_nm=moment_nm, duration_ns=duration_ns)

    def disturb(self, kind: str, **fields: Any) -> Reply:
        """Schedules a disturbance: LOAD, SINE, CHIRP, GUST, WIND, TURN, DECELERATION, ADDED_MASS.

        fields: of request_t, e.g. `disturb("SINE", moment_nm=[0.5], frequency_hz=[2.0])`; what is
        left out is 0. messages/README.md says which a kind has.
        """
        return self._ask(request_t.DISTURB, _kind(_DISTURBANCES, kind), **fields)

    def fault(self, kind: str, **fields: Any) -> Reply:
        """Schedules a fault: SENSOR_STUCK, SENSOR_BIASED, SENSOR_NOISY, SENSOR_DROPPED,
        SENSOR_DELAYED, DRIVE_WEAK, ROTOR_LOSS, COMMAND_LOST.

        fields: of request_t, e.g. `fault("DRIVE_WEAK", target=-1, level=0.5)`; the others are 0.
        """
        return self._ask(request_t.FAULT, _kind(_FAULTS, kind), **fields)

    def cancel(self, id: int) -> Reply:
        """Ends the disturbance or fault of that number."""
        return self._ask(request_t.CANCEL, id=id)

    def clear(self) -> Reply:
        """Ends all disturbances and faults, also those to come."""
        return self._ask(request_t.CLEAR)

    def close(self) -> None:
        """Leaves the bus."""
        self.bus.close()

    def __enter__(self) -> Operator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _ask(self, verb: int, kind: int = 0, **fields: Any) -> Reply:
        request = request_t()
        for name, value in fields.items():
            _set(request, name, value)
        request.verb, request.kind = verb, kind
        if self._owner_header is None:
            self.owner()
        asked = self._owner_header.epoch
        reply = self._exchange(request)
        # Its epoch tells a run that ended before the request came from one that the request ended.
        if reply.result == reply_t.REFUSED and reply.header.epoch != asked:
            reply = self._exchange(request)
        if reply.result != reply_t.APPLIED:
            raise Refused(text(reply.text))
        return Reply(reply.applied_tick, reply.id, text(reply.text))

    def _exchange(self, request: request_t) -> reply_t:
        """Sends the same datagram until its answer comes."""
        self._counter += 1
        header = request.header
        header.source, header.epoch, header.sequence = header_t.OPERATOR, self._epoch, self._counter
        header.tick = self._owner_header.tick
        header.sim_time_ns = self._owner_header.sim_time_ns
        request.owner_epoch = self._owner_header.epoch
        request.writer, request.counter = self._writer, self._counter
        self.bus.drain()
        datagram = self.bus.send("REQUEST", request)
        for attempt in range(_TRIES):
            if attempt > 0:
                self.bus.send_again(datagram)
            for _, reply in self.bus.listen(_RESEND_S, "REPLY"):
                if (reply.request_writer, reply.request_counter) == (self._writer, self._counter):
                    self._owner_header = reply.header
                    return reply
        self._owner_header = None
        raise NoAnswer(
            f"the owner of rig {self.bus.rig.name} was heard, but does not answer; `gyrotwin ctl "
            f"status` shows whether it still lives{self._suspicion()}"
        )

    def _suspicion(self) -> str:
        heard = self.bus.counters
        if heard.unauthentic > 0:
            return (
                f"; {heard.unauthentic} messages came that the key of {self.bus.rig.name} did not "
                "sign: both sides need the same key"
            )
        if heard.other_rig + heard.foreign > 0:
            return (
                f"; {heard.other_rig + heard.foreign} messages of other rigs came on this address: "
                "is it the rig that runs?"
            )
        return ""


def _named(*names: str) -> dict[str, int]:
    return {name: getattr(request_t, name) for name in names}


_DISTURBANCES = _named(
    "LOAD", "SINE", "CHIRP", "GUST", "WIND", "TURN", "DECELERATION", "ADDED_MASS"
)
_FAULTS = _named(
    "SENSOR_STUCK", "SENSOR_BIASED", "SENSOR_NOISY", "SENSOR_DROPPED", "SENSOR_DELAYED",
    "DRIVE_WEAK", "ROTOR_LOSS", "COMMAND_LOST",
)  # fmt: skip


def _kind(kinds: dict[str, int], name: str) -> int:
    if name not in kinds:
        raise ValueError(f"no kind {name!r}: there are {', '.join(kinds)}")
    return kinds[name]


def _set(request: request_t, name: str, value: Any) -> None:
    """Sets a field; an array may be given shorter, the rest is 0."""
    if name not in request.__slots__ or name in _OWN_FIELDS:
        there = ", ".join(field for field in request.__slots__ if field not in _OWN_FIELDS)
        raise TypeError(f"request_t has no field {name!r} to set: there are {there}")
    default = getattr(request, name)
    if not isinstance(default, list):
        setattr(request, name, index(value) if isinstance(default, int) else float(value))
        return
    values = [float(x) for x in value]
    if len(values) > len(default):
        raise ValueError(f"{name} has {len(default)} numbers, not {len(values)}")
    setattr(request, name, values + [0.0] * (len(default) - len(values)))
