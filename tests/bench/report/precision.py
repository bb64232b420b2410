"""What accuracy costs: error over time, both on logarithmic axes, one small plot a case."""

from .svg import Drawing, LogAxis
from .text import digits, measured, seconds
from .values import is_ours

_WIDTH, _HEIGHT, _TOP, _BOTTOM, _LEFT, _RIGHT = 350, 230, 26, 40, 44, 22
_LINE = 18  # of the legend


def precision(summary, figure, plot):
    """One plot a case; the subjects have the same numbers in all of them."""
    numbers, drawings = {}, []
    for case in summary.cases(figure.name, plot.error):
        points = []
        for subject in summary.subjects(figure.name, case, plot.error):
            error = summary.value(figure.name, case, plot.error, subject)
            time = summary.value(figure.name, case, plot.time, subject)
            if time and error.median > 0 and time.median > 0:
                unit = summary.units[(figure.name, case, plot.time)]
                number = numbers.setdefault(subject, len(numbers) + 1)
                points.append((number, subject, seconds(time.median, unit), error.median))
        if points:
            unit = summary.units[(figure.name, case, plot.error)]
            drawings.append(_draw(figure, case, points, unit).svg("small"))
    return "".join(drawings)


def _draw(figure, case, points, unit):
    drawing = Drawing(_WIDTH, f"{figure.title}, {case}: error over time")
    bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
    times, errors = [t for _, _, t, _ in points], [e for _, _, _, e in points]
    x_axis = LogAxis(min(times) / 1.3, max(times) * 1.3, _LEFT, right)
    y_axis = LogAxis(min(errors) / 3, max(errors) * 3, bottom, _TOP)
    drawing.text(0, 13, f"{case}: off by [{unit}]", "head")
    for tick in y_axis.ticks(24):
        drawing.line(_LEFT, y_axis.at(tick), right, y_axis.at(tick), "grid")
        drawing.text(_LEFT - 5, y_axis.at(tick) + 4, f"{tick:.0e}", "tick", "end")
    for tick in x_axis.ticks():
        drawing.line(x_axis.at(tick), _TOP, x_axis.at(tick), bottom, "grid")
        drawing.text(x_axis.at(tick), bottom + 16, measured(tick, "s"), "tick", "middle")
    drawing.text((_LEFT + right) / 2, bottom + 32, "time of a tick, median; ↙ is better", "caption",
                 "middle")

    y = _HEIGHT + 4.0
    for number, subject, time, error in points:
        kind = "ours" if is_ours(subject) else "peer"
        told = f"{measured(time, 's')}, {digits(error)}"
        _numbered(drawing, x_axis.at(time), y_axis.at(error), number, kind)
        y += _LINE
        _numbered(drawing, 8, y - 4, number, kind)
        drawing.text(22, y, subject)
        drawing.text(_WIDTH, y, f"{told} {unit}", "number", "end")
    return drawing


def _numbered(drawing, x, y, number, kind):
    drawing.dot(x, y, 7.5, kind)
    drawing.text(x, y + 3.7, str(number), "mark", "middle")
