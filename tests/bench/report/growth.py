"""A quantity over a count: how it grows. Drawn once, small; a wide page has several in a row."""

from .svg import Drawing, LinearAxis, text_width
from .text import digits, is_time, seconds, time_unit
from .values import is_ours

_WIDTH, _HEIGHT, _TOP, _BOTTOM, _MARGIN = 350, 210, 26, 36, 22


def growth(summary, figure, plot):
    key_cases = [c for c in summary.cases(figure.name, plot.quantity) if _is_number(c)]
    curves = {}
    for case in key_cases:
        for subject in summary.subjects(figure.name, case, plot.quantity):
            found = summary.value(figure.name, case, plot.quantity, subject)
            curves.setdefault(subject, []).append((float(case), found))
    if not curves or not key_cases:
        return ""
    scale, unit = _scale(summary.units[(figure.name, key_cases[0], plot.quantity)],
                         plot.quantity in figure.percent, curves)
    what = figure.words.get(plot.quantity, plot.quantity) + (f" [{unit}]" if unit else "")
    return _draw(curves, plot, scale, what, f"{figure.title}: {what} over {plot.across}").svg("small")


def _is_number(case):
    try:
        float(case)
    except ValueError:
        return False
    return True


def _scale(unit, percent, curves):
    """(factor, unit) in which the values are drawn."""
    if percent:
        return 100.0, "%"
    if is_time(unit):
        largest = max(seconds(found.high, unit) for points in curves.values() for _, found in points)
        name, size = time_unit(largest)
        return seconds(1.0, unit) / size, name
    return 1.0, "" if unit == "1" else unit


def _draw(curves, plot, scale, what, about):
    drawing = Drawing(_WIDTH, about)
    points = [point for curve in curves.values() for point in curve]
    last_x = max(x for x, _ in points)
    reference = _reference(curves.get("gyrotwin", next(iter(curves.values()))), plot.reference, last_x)
    largest = max([found.high for _, found in points] + [y for _, y in reference])
    bottom = _HEIGHT - _BOTTOM
    # Room for the tick's texts, which the axis itself decides.
    left = max(text_width(digits(t)) for t in LinearAxis(scale * largest, 0, 1).ticks()) + 8
    y_axis = LinearAxis(scale * largest, bottom, _TOP)
    x_axis = LinearAxis(last_x, left, _WIDTH - _MARGIN)

    drawing.text(0, 13, what, "head")
    for tick in y_axis.ticks():
        drawing.line(left, y_axis.at(tick), _WIDTH - _MARGIN, y_axis.at(tick), "grid")
        drawing.text(left - 5, y_axis.at(tick) + 4, digits(tick), "tick", "end")
    for tick in x_axis.ticks():
        drawing.line(x_axis.at(tick), bottom, x_axis.at(tick), bottom + 4, "grid")
        drawing.text(x_axis.at(tick), bottom + 16, digits(tick), "tick", "middle")
    drawing.text((left + _WIDTH - _MARGIN) / 2, bottom + 32, plot.across, "caption", "middle")

    if reference:
        drawing.path([(x_axis.at(x), y_axis.at(scale * y)) for x, y in reference], "reference")
    for subject, curve in curves.items():
        kind = "ours" if is_ours(subject) else "peer"
        drawing.path([(x_axis.at(x), y_axis.at(scale * s.median)) for x, s in curve], f"curve {kind}")
        for x, s in curve:
            at = x_axis.at(x)
            drawing.line(at, y_axis.at(scale * s.low), at, y_axis.at(scale * s.high), "whisker")
            drawing.dot(at, y_axis.at(scale * s.median), 3.5, kind,
                        f"{subject}, {digits(x)} {plot.across}: {digits(scale * s.median)}")
    if len(curves) > 1:
        _name(drawing, curves, x_axis, y_axis, scale)
    elif reference:
        drawing.text(_WIDTH - _MARGIN, 13, f"- - {plot.reference}", "tick", "end")
    return drawing


def _reference(curve, kind, last_x):
    """What the first value would lead to."""
    x, found = curve[0]
    if kind == "flat":
        return [(0.0, found.median), (last_x, found.median)]
    if kind == "proportional" and x > 0:
        return [(0.0, 0.0), (last_x, found.median * last_x / x)]
    return []


def _name(drawing, curves, x_axis, y_axis, scale):
    """Names beside the curves' ends, moved apart where they would touch."""
    ends = sorted(((y_axis.at(scale * curve[-1][1].median), subject, curve[-1][0])
                   for subject, curve in curves.items()), reverse=True)
    least = None
    for y, subject, x in ends:
        y = y - 8 if least is None else min(y - 8, least - 15)
        least = y
        kind = "ours" if is_ours(subject) else "peer"
        drawing.text(x_axis.at(x), y, subject, f"name {kind}", "end")
