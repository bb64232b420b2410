"""A drawing and its axes. Colours are the page's: elements only have classes (style.css)."""

import math
from html import escape

_CHARACTER_PX = 6.6  # a little more than the middle of a 12 px sans serif: labels must not touch


def text_width(text):
    """About, and rather too much [px]."""
    return _CHARACTER_PX * len(text)


class Drawing:
    def __init__(self, width, about):
        """about: the drawing in a sentence, for who cannot see it."""
        self.width, self.about, self.height = width, about, 0.0
        self._parts = []

    def _add(self, y, part):
        self.height = max(self.height, y)
        self._parts.append(part)

    def text(self, x, y, text, kind="", anchor="start"):
        """y: of the baseline."""
        if text:
            self._add(y + 4, f'<text x="{x:.1f}" y="{y:.1f}" class="{kind}" text-anchor="{anchor}">'
                             f"{escape(text)}</text>")

    def line(self, x1, y1, x2, y2, kind):
        self._add(max(y1, y2), f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
                               f'class="{kind}"/>')

    def bar(self, x1, x2, y, height, kind, title=""):
        """Horizontal, from x1 to x2; never thinner than can be seen."""
        left, width = min(x1, x2), max(abs(x2 - x1), 1.0)
        self._add(y + height, f'<rect x="{left:.1f}" y="{y:.1f}" width="{width:.1f}" '
                              f'height="{height:.1f}" rx="2" class="{kind}">{_title(title)}</rect>')

    def dot(self, x, y, radius, kind, title=""):
        self._add(y + radius, f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" class="{kind}">'
                              f"{_title(title)}</circle>")

    def path(self, points, kind):
        at = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self._add(max(y for _, y in points), f'<polyline points="{at}" class="{kind}"/>')

    def svg(self, kind=""):
        return (f'<svg class="{kind}" viewBox="0 0 {self.width} {math.ceil(self.height + 2)}" '
                f'role="img" aria-label="{escape(self.about)}">{"".join(self._parts)}</svg>')


def _title(text):
    return f"<title>{escape(text)}</title>" if text else ""


class LinearAxis:
    """From 0 to a little beyond the largest value."""

    def __init__(self, largest, at_zero, at_end, ticks=4):
        self.step = _nice_step(largest / ticks) if largest > 0 else 1.0
        self.end = self.step * max(1, math.ceil(largest / self.step - 1e-9))
        self._zero, self._scale = at_zero, (at_end - at_zero) / self.end

    def at(self, value):
        return self._zero + value * self._scale

    def ticks(self):
        return [k * self.step for k in range(round(self.end / self.step) + 1)]


def _nice_step(rough):
    decade = 10.0 ** math.floor(math.log10(rough))
    return next(m * decade for m in (1, 2, 2.5, 5, 10) if m * decade >= rough * (1 - 1e-9))


class LogAxis:
    """From below the least to above the largest value; all are positive."""

    def __init__(self, least, largest, at_begin, at_end):
        self.low, self.high = math.log10(least / 1.15), math.log10(largest * 1.15)
        self._begin, self._scale = at_begin, (at_end - at_begin) / (self.high - self.low)

    def at(self, value):
        position = math.log10(value) if value > 0 else self.low
        return self._begin + (max(position, self.low) - self.low) * self._scale

    def ticks(self, apart_px=46):
        """1 2 5 10 20 50 ... where there is room, else 1 10 100, or every other decade."""
        decade_px = abs(self._scale)
        if decade_px >= 3.4 * apart_px:
            steps, each = (1, 2, 5), 1
        else:
            steps, each = (1,), max(1, math.ceil(apart_px / decade_px))
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        found = [m * 10.0**d for d in decades if d % each == 0 for m in steps]
        return [t for t in found if self.low <= math.log10(t) <= self.high]
