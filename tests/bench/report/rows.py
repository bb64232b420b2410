"""Plots that are a list of rows: a label, a mark on a common axis, a value. Drawn twice: for a wide
page and for a phone."""

from dataclasses import dataclass

from .figures import Ratios, figure_of
from .svg import Drawing, LinearAxis, LogAxis, text_width
from .text import digits, is_time, measured, seconds, time_unit
from .values import is_ours

WIDTHS = {"wide": 760, "narrow": 350}
_ROW, _HEAD, _THICK = 22, 24, 12


@dataclass
class Row:
    label: str
    value: str  # as text, at the right
    kind: str  # ours, peer, or worse: its colour
    main: float
    low: float = None  # quartiles, or the least and largest
    high: float = None
    far: float = None  # a thin line from `high` to there
    goal: float = None
    title: str = ""  # shown by a pointer that rests on it
    second: str = ""  # one more text, before `value`


def both(draw):
    """draw: width -> Drawing or None. As HTML, for wide and narrow pages."""
    drawings = {kind: draw(width) for kind, width in WIDTHS.items()}
    return "".join(drawing.svg(kind) for kind, drawing in drawings.items() if drawing)


def _lay_out(width, about, groups, axis_of, mark, caption, tick_text, strong=None):
    """groups: [(heading or "", [Row])]; axis_of: (left, right) -> axis; mark: draws a row's mark;
    caption: one text below the axis, or three."""
    drawing = Drawing(width, about)
    rows = [row for _, rows in groups for row in rows]
    left = max(text_width(row.label) for row in rows) + 10
    second = width - max(text_width(row.value) for row in rows) - 14
    widest = max(text_width(row.second) for row in rows)
    right = second - widest - (14 if widest else 0)
    axis = axis_of(left + 4, right)
    heads = sum(1 for heading, _ in groups if heading)
    bottom = 8.0 + _HEAD * heads + _ROW * len(rows)

    for tick in axis.ticks():
        x = axis.at(tick)
        drawing.line(x, 4, x, bottom, "strong" if tick == strong else "grid")
        drawing.text(x, bottom + 14, tick_text(tick), "tick", "middle")
    captions = (("", caption, "") if isinstance(caption, str) else caption)
    for x, text, anchor in zip((left, (left + right) / 2, right), captions,
                               ("start", "middle", "end")):
        drawing.text(x, bottom + 32, text, "caption", anchor)

    y = 4.0
    for heading, members in groups:
        if heading:
            y += _HEAD
            drawing.text(0, y - 7, heading, "head")
        for row in members:
            middle = y + _ROW / 2
            drawing.text(left - 4, middle + 4, row.label, "label", "end")
            drawing.text(second, middle + 4, row.second, "number", "end")
            drawing.text(width, middle + 4, row.value, "number", "end")
            mark(drawing, axis, row, middle)
            if row.goal is not None:
                x = axis.at(row.goal)
                drawing.line(x, y + 2, x, y + _ROW - 2, "goal")
            y += _ROW
    return drawing


def _bar_from(origin):
    def mark(drawing, axis, row, middle):
        drawing.bar(axis.at(origin), axis.at(row.main), middle - _THICK / 2, _THICK, row.kind,
                    row.title)
        if row.low is not None and row.low != row.high:
            drawing.line(axis.at(row.low), middle, axis.at(row.high), middle, "whisker")
            for end in (row.low, row.high):
                drawing.line(axis.at(end), middle - 3, axis.at(end), middle + 3, "whisker")
    return mark


def _ratio_row(label, main, low, high, wide, goal=None, title="", unsure=False):
    """unsure: the rounds do not agree who is faster."""
    faster = main <= 1
    times = digits(1 / main if faster else main) if main > 0 else "∞"
    return Row(label, "about the same" if unsure else f"{times} × {'faster' if faster else 'slower'}",
               "ours" if faster else "worse", main, low, high, goal=goal, title=title,
               second=digits(main) if wide else "")


def _draw_ratios(width, groups, about):
    rows = [row for _, rows in groups for row in rows if row.main > 0]
    if not rows:
        return None
    ends = [v for row in rows for v in (row.main, row.low, row.high, row.goal) if v]
    least, largest = min([*ends, 0.8]), max([*ends, 1.25])
    caption = ("← gyrotwin is faster", "gyrotwin / peer", "slower →")
    if width < 500:
        caption = "gyrotwin / peer, ← faster"
    return _lay_out(width, about, groups, lambda l, r: LogAxis(least, largest, l, r),
                    _bar_from(1.0), caption, digits, strong=1)


def ratios(summary, figure, plot):
    """Ours over each peer's, for the quantities of the plot."""

    def goal_for(quantity, case, subject, peer):
        for goal in figure.goals:
            if (goal.quantity == quantity and goal.case in (None, case) and goal.subject == subject
                    and goal.peer == peer):
                return goal.limit
        return None

    def groups(wide):
        found = []
        for case in summary.cases(figure.name):
            for quantity in plot.quantities:
                subjects = [s for s in summary.subjects(figure.name, case, quantity)
                            if s in plot.subjects]
                for ours in subjects:
                    spreads = {peer: summary.ratio(figure.name, case, quantity, peer, ours)
                               for peer in summary.peers(figure.name, case, quantity)}
                    spreads = {peer: s for peer, s in spreads.items() if s}
                    rows = [
                        _ratio_row(peer, s.median, s.low, s.high, wide,
                                   goal_for(quantity, case, ours, peer),
                                   f"{ours} / {peer}: {digits(s.median)}, quartiles "
                                   f"{digits(s.low)} to {digits(s.high)}, {s.rounds} rounds",
                                   unsure=s.low < 1 < s.high)
                        for peer, s in sorted(spreads.items(), key=lambda item: item[1].median)]
                    name = ours if len(subjects) > 1 else ""
                    heading = ", ".join(filter(None, (
                        case, quantity if len(plot.quantities) > 1 else "", name)))
                    if rows:
                        found.append((heading, rows))
        return found

    return both(lambda width: _draw_ratios(
        width, groups(width > 500), f"{figure.title}: time of gyrotwin over time of each peer"))


def overview(summary):
    """One row a figure and peer: the middle of its cases' median ratios, from least to largest."""
    groups = []
    for name in summary.figures():
        figure = figure_of(name)
        quantities = [plot.quantities[0] for plot in figure.plots
                      if isinstance(plot, Ratios) and plot.beside_peers][:1]
        found = {}
        for quantity in quantities:
            for case in summary.cases(name, quantity):
                for peer in summary.peers(name, case, quantity):
                    ratio = summary.ratio(name, case, quantity, peer)
                    if ratio and ratio.median > 0:
                        found.setdefault(peer, []).append(ratio.median)
        middles = {peer: sorted(all_)[len(all_) // 2] for peer, all_ in found.items()}
        if found:
            groups.append((f"{figure.title}, {quantities[0]}", [
                (peer, middle, min(found[peer]), max(found[peer]))
                for peer, middle in sorted(middles.items(), key=lambda item: item[1])]))
    if not groups:
        return ""
    return both(lambda width: _draw_ratios(
        width, [(heading, [_ratio_row(*row, width > 500) for row in rows])
                for heading, rows in groups], "Time of gyrotwin over time of each peer"))


def distribution(summary, figure, _plot):
    """p50 to p99, and to the largest, for every subject."""
    groups, unit = [], None
    for case in summary.cases(figure.name, "p50"):
        unit = summary.units[(figure.name, case, "p50")]
        rows = []
        for subject in summary.subjects(figure.name, case, "p50"):
            told = {q: summary.value(figure.name, case, q, subject) for q in ("p50", "p99", "max")}
            told = {q: seconds(v.median, unit) for q, v in told.items() if v and is_time(unit)}
            if told.get("p50", 0) <= 0:
                continue
            rows.append(Row(subject, " / ".join(measured(v, "s") for q, v in told.items()
                                                if q != "max"),
                            "ours" if is_ours(subject) else "peer", told["p50"],
                            high=told.get("p99"), far=told.get("max"),
                            title=", ".join(f"{q} {measured(v, 's')}" for q, v in told.items())))
        if rows:
            groups.append((case, rows))
    if not groups:
        return ""
    rows = [row for _, rows in groups for row in rows]
    ends = [v for row in rows for v in (row.main, row.high, row.far) if v]
    has_p99 = any(row.high for row in rows)

    def mark(drawing, axis, row, middle):
        if row.far:
            drawing.line(axis.at(row.main), middle, axis.at(row.far), middle, "far")
            drawing.line(axis.at(row.far), middle - 3, axis.at(row.far), middle + 3, "far")
        if row.high:
            drawing.bar(axis.at(row.main), axis.at(row.high), middle - 4, 8, f"{row.kind} soft",
                        row.title)
        drawing.dot(axis.at(row.main), middle, 5, row.kind, row.title)

    parts = ["dot p50"] + ["bar to p99"] * has_p99 + ["line to max"] * any(r.far for r in rows)
    return both(lambda width: _lay_out(
        width, f"{figure.title}: distribution for each subject", groups,
        lambda l, r: LogAxis(min(ends), max(ends), l, r), mark, ", ".join(parts),
        lambda t: measured(t, "s")))


def bars(summary, figure, plot):
    """A bar for every case and subject, from zero."""
    rows, key = [], None
    percent = plot.quantity in figure.percent
    for case in summary.cases(figure.name, plot.quantity):
        key = (figure.name, case, plot.quantity)
        subjects = summary.subjects(*key)
        for subject in subjects:
            found = summary.value(*key, subject)
            goals = [g.limit for g in figure.goals if g.quantity == plot.quantity and not g.peer
                     and g.subject == subject and g.case in (None, case)]
            label = " ".join(filter(None, (case, subject if len(subjects) > 1 else "")))
            rows.append(Row(label or subject, measured(found.median, summary.units[key], percent),
                            "ours" if is_ours(subject) else "peer", found.median, found.low,
                            found.high, goal=goals[0] if goals else None))
    if not rows:
        return ""
    unit = summary.units[key]
    largest = max(v for row in rows for v in (row.main, row.high, row.goal) if v is not None)
    scale, name = 1.0, "" if unit in ("1", "ratio") else unit
    if is_time(unit) and largest > 0:
        name, size = time_unit(seconds(largest, unit))
        scale = seconds(1.0, unit) / size
    if percent:
        scale, name = 100.0, "%"
    for row in rows:
        row.main, row.low, row.high = scale * row.main, scale * row.low, scale * row.high
        row.goal = None if row.goal is None else scale * row.goal
    caption = figure.words.get(plot.quantity, plot.quantity) + (f" [{name}]" if name else "")
    return both(lambda width: _lay_out(
        width, f"{figure.title}: {caption}", [("", rows)],
        lambda l, r: LinearAxis(scale * largest, l, r, 5 if width > 500 else 3), _bar_from(0.0),
        caption, digits))
