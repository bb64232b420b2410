"""A result as one HTML file: no network, no script, light and dark, wide and on a phone."""

from html import escape
from pathlib import Path

from . import rows
from .figures import Bars, Distribution, Growth, Precision, Ratios, figure_of
from .growth import growth
from .precision import precision
from .rounds import values_of
from .summary import Summary, judge
from .text import digits, limit, with_quartiles
from .values import is_ours

_STYLE = Path(__file__).with_name("style.css")
_ROWS = {Ratios: rows.ratios, Distribution: rows.distribution, Bars: rows.bars}
_SMALL = {Growth: growth, Precision: precision}
_ANSWERS = {"yes": "✓ reached", "no": "✗ missed", "unsure": "≈ unsure"}

_METHOD = """
<p>All programs run in turns, round after round, on one machine that nobody prepared. Subjects that
are compared take turns in small slices inside one program, so whatever disturbs the machine disturbs
all of them alike. A ratio is taken within each round; told are the median over the rounds and, as
thin lines and in brackets, the quartiles. A goal is <i>reached</i> or <i>missed</i> where both
quartiles say so, else <i>unsure</i>. Absolute times are this machine's and this hour's; the ratios
are what to compare.</p>
<p>Every value of every round is in <code>{file}</code>; <code>deploy/bench</code> measures again,
<code>tests/bench/README.md</code> says how each figure is made.</p>
"""


def page(result, file_name):
    """result: as rounds.run() gives it. Returns HTML."""
    summary = Summary(values_of(result))
    facts = result["machine"]
    parts = [_header(result, facts), _overview(summary), _goals(summary)]
    parts += [_figure(summary, figure_of(name)) for name in summary.figures()]
    parts += [_left_out(result), f"<h2>How it was measured</h2>{_METHOD.format(file=escape(file_name))}",
              _machine(facts)]
    return ("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
            f"<title>gyrotwin, measured {escape(facts['date'])}</title>"
            f"<style>{_STYLE.read_text()}</style></head><body><main>\n"
            + "\n".join(filter(None, parts)) + "\n</main></body></html>\n")


def _header(result, facts):
    count = max((part["round"] for part in result["rounds"]), default=0)
    changed = ", changed" if facts["changed"] else ""
    virtual = f", virtual ({facts['virtual']})" if facts["virtual"] else ""
    return (f"<h1>gyrotwin, measured</h1><p class=\"soft\">{escape(facts['date'])} on "
            f"{escape(facts['cpu'])}, {facts['cores']} cores{escape(virtual)}; "
            f"{count} round{'s' if count != 1 else ''}; "
            f"commit {escape(facts['commit'][:10])}{changed}</p>")


def _overview(summary):
    drawing = rows.overview(summary)
    if not drawing:
        return ""
    return (f"<h2>Beside its peers</h2><figure>{drawing}<figcaption>Where there are several cases: "
            "the middle one, and a line from the least to the largest.</figcaption></figure>")


def _goals(summary):
    lines = []
    for name in summary.figures():
        figure = figure_of(name)
        judged = judge(summary, figure)
        if judged:
            lines.append(f"<tr class=\"of\"><td colspan=\"5\"><a href=\"#{figure.name}\">"
                         f"{escape(figure.title)}</a></td></tr>")
        for j in judged:
            share = j.goal.quantity in figure.percent
            what = figure.words.get(j.goal.quantity, j.goal.quantity)
            detail = ", ".join(filter(None, (
                j.case, what, j.goal.subject if j.goal.subject != "gyrotwin" else "", j.goal.why)))
            lines.append(
                f"<tr><td>{escape(detail)}</td><td class=\"{j.reached}\">{_ANSWERS[j.reached]}</td>"
                f"<td class=\"n\" data-what=\"is\">{escape(with_quartiles(j.found, j.unit, share))}</td>"
                f"<td class=\"n\" data-what=\"goal\">{escape(limit(j.goal, j.unit, share))}</td>"
                f"<td class=\"n\" data-what=\"rounds\">{j.found.rounds}</td></tr>")
    if not lines:
        return ""
    return ("<h2>Goals</h2><table class=\"goals\"><thead><tr><th></th><th></th>"
            "<th class=\"n\">measured (quartiles)</th><th class=\"n\">goal</th>"
            "<th class=\"n\">rounds</th></tr></thead><tbody>"
            + "".join(lines) + "</tbody></table>")


def _figure(summary, figure):
    parts = [f"<h2 id=\"{figure.name}\">{escape(figure.title)}</h2>", f"<p>{_code(figure.what)}</p>"]
    smalls = [_SMALL[type(plot)](summary, figure, plot) for plot in figure.plots
              if type(plot) in _SMALL]
    if any(smalls):
        parts.append(f"<div class=\"smalls\">{''.join(smalls)}</div>")
    for plot in figure.plots:
        drawing = _ROWS[type(plot)](summary, figure, plot) if type(plot) in _ROWS else ""
        if drawing:
            marks = ["<span class=\"goalmark\"></span> goal"] * ('class="goal"' in drawing)
            marks += ["thin line: quartiles of the rounds"] * ('class="whisker"' in drawing)
            parts.append(f"<figure>{drawing}<figcaption>{'; '.join(marks)}</figcaption></figure>")
    return "\n".join(parts) + _numbers(summary, figure, drawn=len(parts) > 2)


def _code(text):
    """`word` as code."""
    pieces = escape(text).split("`")
    return "".join(f"<code>{p}</code>" if k % 2 else p for k, p in enumerate(pieces))


def _numbers(summary, figure, drawn):
    """All values of a figure as a table, open where nothing is drawn."""
    lines = []
    for case in summary.cases(figure.name):
        for quantity in summary.quantities(figure.name, case):
            key = (figure.name, case, quantity)
            share = quantity in figure.percent
            for subject in summary.subjects(*key):
                found = summary.value(*key, subject)
                ratio = None if is_ours(subject) else summary.ratio(*key, subject)
                what = figure.words.get(quantity, quantity)
                ratio_text = (f"{digits(ratio.median)} ({digits(ratio.low)} to {digits(ratio.high)})"
                              if ratio else "")
                lines.append(
                    f"<tr><td>{escape(case)}</td><td>{escape(what)}</td><td>{escape(subject)}</td>"
                    f"<td class=\"n\">{escape(with_quartiles(found, summary.units[key], share))}</td>"
                    f"<td class=\"n\">{ratio_text}</td></tr>")
    shown = "" if drawn else " open"
    return (f"<details{shown}><summary>All numbers</summary><div class=\"scroll\"><table><thead><tr>"
            "<th>case</th><th>what</th><th>who</th><th class=\"n\">median (quartiles)</th>"
            "<th class=\"n\">gyrotwin / it</th></tr></thead><tbody>" + "".join(lines)
            + "</tbody></table></div></details>")


def _left_out(result):
    malformed = [f"{part['program']}, round {part['round']}: {text}"
                 for part in result["rounds"] for text in part["malformed"]]
    items = [f"{name}: {why}" for name, why in result["left_out"].items()] + malformed
    if not items:
        return ""
    return ("<h2>Left out</h2><ul>" + "".join(f"<li>{escape(item)}</li>" for item in items) + "</ul>")


def _machine(facts):
    told = {
        "processor": f"{facts['cpu']}, {facts['cores']} cores",
        "virtual": facts["virtual"],
        "system": f"{facts['system']}, Linux {facts['kernel']}",
        "governor": facts["governor"],
        "clock": facts["clock_source"],
        "SCHED_FIFO": "granted" if facts["realtime"] else "refused: the loops ran without priority",
        "compiler": f"{facts['compiler']} {facts['flags']}",
        "commit": facts["commit"] + (", with changes" if facts["changed"] else ""),
        "load average": f"{facts['load_before']:.2f} before, {facts['load_after']:.2f} after",
        "packages": ", ".join(f"{name} {version}" for name, version in facts["packages"].items()),
    }
    return ("<h2>The machine</h2><dl>"
            + "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in told.items() if v)
            + "</dl>")
