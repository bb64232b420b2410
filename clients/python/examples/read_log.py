#!/usr/bin/env python3
"""What a log holds: messages a channel, the largest tilt, damage.

usage: read_log.py LOG
"""

import collections
import math
import sys

import gyrotwin


def main(path: str) -> None:
    log = gyrotwin.Log(path)
    counts: collections.Counter = collections.Counter()
    seconds = tilt = tilt_at = 0.0
    for seconds, channel, message in log:
        counts[channel] += 1
        if channel == "LIVE/STATE" and math.hypot(*message.tilt_rad) > tilt:
            tilt, tilt_at = math.hypot(*message.tilt_rad), seconds

    rig = log.about.get("rig", "unknown")
    checked = "checked" if log.signatures_checked else "not checked"
    print(f"{path}: rig {rig}, {seconds:.3f} s, signatures {checked}")
    for channel, count in sorted(counts.items()):
        print(f"  {channel:<20} {count:>8}")
    print(f"largest tilt {math.degrees(tilt):.2f} deg, at {tilt_at:.3f} s")
    if log.damage:
        print(f"damaged: {log.damage}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        main(sys.argv[1])
    except gyrotwin.Error as error:
        sys.exit(f"read_log: error: {error}")
