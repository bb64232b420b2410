#!/usr/bin/env python3
"""Pushes a rig that runs, and draws how its tilt answers: one SVG file.

usage: plot_push.py [--rig NAME|FILE] [--roll NMS] [--seconds S] FILE.svg
"""

import argparse
import math
import sys
from typing import List, Tuple

import gyrotwin

BEFORE_S = 0.5  # shown before the push, in the owner's time
WIDTH, HEIGHT, LEFT, BOTTOM, MARGIN = 720, 360, 60, 45, 20  # [px]
COLORS = ("#1f6fb4", "#d2691e")

Point = Tuple[float, ...]  # time since the push [s], roll and pitch [deg]


def record(rig: gyrotwin.Rig, roll_nms: float, seconds: float) -> Tuple[List[Point], str]:
    """Tilt from BEFORE_S before the push to `seconds` after it, and what the owner said to it."""
    rows: List[Point] = []
    with gyrotwin.Operator(rig) as operator, gyrotwin.Bus(rig) as bus:
        owner = operator.owner()
        if owner.mode != owner.MODE_RUNNING:
            raise gyrotwin.Error(f"rig {rig.name} does not run: `gyrotwin ctl arm`")
        reply, pushed_s = None, math.inf
        # Wall time may be much longer than the owner's; a rig that stops is not waited for.
        for _, state in bus.listen(60.0, "LIVE/STATE"):
            now_s = 1e-9 * state.header.sim_time_ns
            rows.append((now_s, *map(math.degrees, state.tilt_rad)))
            if reply is None and now_s >= rows[0][0] + BEFORE_S:
                reply = operator.push(roll_nms=roll_nms)
                pushed_s = 1e-9 * reply.tick * owner.tick_period_ns
            if now_s >= pushed_s + seconds or state.mode != owner.MODE_RUNNING:
                break
        if reply is None:
            raise gyrotwin.Error(f"rig {rig.name} stopped before it was pushed")
    return [(t - pushed_s, *tilt) for t, *tilt in rows], reply.text


def nice_step(span: float) -> float:
    """1, 2 or 5 times a power of ten: about five of them in the span."""
    decade = 10.0 ** math.floor(math.log10(span / 5.0))
    return next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= span / 5.0)


def ticks(low: float, high: float) -> List[float]:
    step = nice_step(high - low)
    first, last = math.ceil(low / step), math.floor(high / step)
    return [step * k for k in range(first, last + 1)]


def svg(rows: List[Point], title: str) -> str:
    """The picture: roll and pitch over time."""
    begin, end = rows[0][0], max(rows[-1][0], rows[0][0] + 1e-3)
    reach = 1.1 * max(0.1, max(abs(x) for _, *tilt in rows for x in tilt))

    def x_of(t: float) -> float:
        return LEFT + (t - begin) / (end - begin) * (WIDTH - LEFT - MARGIN)

    def y_of(tilt: float) -> float:
        return 2 * MARGIN + (reach - tilt) / (2 * reach) * (HEIGHT - BOTTOM - 2 * MARGIN)

    def label(x: float, y: float, anchor: str, text: str, color: str = "#222") -> str:
        text = text.replace("&", "&amp;").replace("<", "&lt;")
        return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}">{text}</text>'

    def line(x1: float, y1: float, x2: float, y2: float, color: str) -> str:
        return f'<path d="M{x1:.1f} {y1:.1f}L{x2:.1f} {y2:.1f}" stroke="{color}"/>'

    top, floor = y_of(reach), y_of(-reach)
    parts = [label((LEFT + WIDTH) / 2, 22, "middle", title)]
    for t in ticks(begin, end):
        parts.append(line(x_of(t), top, x_of(t), floor, "#ddd"))
        parts.append(label(x_of(t), floor + 16, "middle", f"{t:g}"))
    for tilt in ticks(-reach, reach):
        parts.append(line(LEFT, y_of(tilt), WIDTH - MARGIN, y_of(tilt), "#ddd"))
        parts.append(label(LEFT - 6, y_of(tilt) + 4, "end", f"{tilt:g}"))
    parts.append(line(x_of(0.0), top, x_of(0.0), floor, "#888"))
    parts.append(label((LEFT + WIDTH) / 2, HEIGHT - 8, "middle", "time since the push [s]"))
    parts.append(label(8, 22, "start", "tilt [deg]"))
    for k, (name, color) in enumerate(zip(("roll", "pitch"), COLORS)):
        points = " ".join(f"{x_of(row[0]):.1f},{y_of(row[1 + k]):.2f}" for row in rows)
        parts.append(f'<polyline points="{points}" stroke="{color}" stroke-width="1.5"/>')
        parts.append(label(WIDTH - MARGIN, 18 + 15 * k, "end", name, color))
    size = f'width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}"'
    style = 'fill="none" font-family="sans-serif" font-size="12"'
    back = f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>'
    body = "\n".join([back, *parts])
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} {style}>\n{body}\n</svg>\n'


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rig", help="rig file, or the name of a shipped rig")
    roll = "impulse about x [N m s]; default: the rig's reference push"
    parser.add_argument("--roll", type=float, default=0.0, metavar="NMS", help=roll)
    seconds = "shown after the push, in the owner's time"
    parser.add_argument("--seconds", type=float, default=4.0, metavar="S", help=seconds)
    parser.add_argument("file", help="the picture, FILE.svg")
    options = parser.parse_args()
    try:
        rig = gyrotwin.Rig(options.rig)
        roll_nms = options.roll or rig.reference_impulse_nms
        rows, answer = record(rig, roll_nms, options.seconds)
    except gyrotwin.Error as error:
        sys.exit(f"plot_push: error: {error}")
    push = f"{rig.name}, pushed by {roll_nms:g} N m s about x"
    with open(options.file, "w", encoding="utf-8") as file:
        file.write(svg(rows, push))
    peak = max(math.hypot(roll, pitch) for t, roll, pitch in rows if t >= 0.0)
    print(f"{push} ({answer}); largest tilt {peak:.2f} deg; {options.file}")


if __name__ == "__main__":
    main()
