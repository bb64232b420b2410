"""gyrotwin for Python: reads logs, listens to a running rig, asks its owner.

Standard library only. The message types (`state_t` ... `truth_t`) are what lcm-gen makes of
messages/*.lcm; their fields are named with their units, and those files explain each.

World frame: x forward, y left, z up, origin at the ground pivot; a push about x is roll, about y
pitch.
"""

# First: the generated modules find each other's classes in this package.
from .beat_t import beat_t
from .command_t import command_t
from .forecast_t import forecast_t
from .header_t import header_t
from .health_t import health_t
from .link_t import link_t
from .reply_t import reply_t
from .request_t import request_t
from .sensors_t import sensors_t
from .state_t import state_t
from .status_t import status_t
from .truth_t import truth_t

from .asker import Operator, Reply
from .bus import Bus, Counters
from .errors import Error, NoAnswer, Refused
from .log import Damage, Log, series
from .rig import Rig
from .wire import CHANNELS, text

__all__ = [
    "beat_t", "command_t", "forecast_t", "header_t", "health_t", "link_t", "reply_t", "request_t",
    "sensors_t", "state_t", "status_t", "truth_t",
    "Bus", "CHANNELS", "Counters", "Damage", "Error", "Log", "NoAnswer", "Operator", "Refused",
    "Reply", "Rig", "series", "text",
]
