"""Numbers for people."""

_SCALES = {"ns": ("ns", 1e-9), "us": ("us", 1e-6), "ms": ("ms", 1e-3), "s": ("s", 1.0)}
_TIMES = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9))


def digits(value, significant=3):
    """Plain digits, as many as say something: 0.0413, 7.2, 153, 12,400."""
    if value == 0:
        return "0"
    if abs(value) < 1e-4:
        return f"{value:.2g}"
    if abs(value) >= 10 ** (significant - 1):
        return f"{value:,.0f}"
    text = f"{value:#.{significant}g}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def time_unit(largest_s):
    """(unit's name, seconds in it) for values up to this."""
    for name, scale in _TIMES:
        if largest_s >= scale:
            return name, scale
    return _TIMES[-1]


def is_time(unit):
    return unit in _SCALES


def seconds(value, unit):
    return value * _SCALES[unit][1]


def measured(value, unit, percent=False):
    """A value with its unit: "12.3 µs", "0.4 %", "15"."""
    if percent:
        return f"{digits(100 * value)} %"
    if is_time(unit):
        name, scale = time_unit(abs(seconds(value, unit)))
        return f"{digits(seconds(value, unit) / scale)} {name}"
    return digits(value) if unit in ("1", "ratio") else f"{digits(value)} {unit}"


def with_quartiles(found, unit, percent=False):
    """A summary.Spread: "12.3 µs (11.9 µs to 14 µs)"."""
    text = measured(found.median, unit, percent)
    if found.rounds > 1 and found.low != found.high:
        low, high = measured(found.low, unit, percent), measured(found.high, unit, percent)
        if low.split(" ")[1:] == high.split(" ")[1:] == text.split(" ")[1:]:
            low, high = low.split(" ")[0], high.split(" ")[0]
        text += f" ({low} to {high})"
    return text


def limit(goal, unit, percent=False):
    """A figures.Goal: "≤ 0.45 liblcm", "≥ 15"."""
    peer = f" of {goal.peer}" if goal.peer else ""
    return f"{'≥' if goal.at_least else '≤'} {measured(goal.limit, unit, percent)}{peer}"
