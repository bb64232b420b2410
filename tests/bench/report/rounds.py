"""All programs, round after round, into one result."""

import json
from dataclasses import astuple

from . import machine
from .figures import figure_of
from .programs import Failed, build, measure
from .summary import Summary, judge
from .text import limit, measured, with_quartiles
from .values import Value, is_ours

FORMAT = 1  # of the JSON file


def say(text=""):
    print(text, flush=True)


def built(programs):
    """Builds for all programs. Returns those that can run, and why the others cannot."""
    ready, left_out = [], {}
    for program in programs:
        try:
            build(program)
            ready.append(program)
        except Failed as failed:
            left_out[program.name] = str(failed)
            say(f"left out: {program.name}: {failed}")
    return ready, left_out


def run(programs, left_out, count, quick):
    """Runs the programs in turns, `count` rounds or until Ctrl-C. A program that fails in its first
    round is left out from then on. Returns the result as it is written to a file."""
    facts = machine.facts() | {"load_before": machine.load_average()}
    rounds, running = [], list(programs)
    try:
        for number in range(1, count + 1):
            for program in [p for p in running if number <= p.rounds]:
                try:
                    values, mistakes, took_s = measure(program, quick)
                except Failed as failed:
                    left_out[program.name] = f"round {number}: {failed}"
                    if number == 1:
                        running.remove(program)
                    say(f"left out: {program.name}: {failed}")
                    continue
                for mistake in mistakes:
                    say(f"{program.name}: {mistake}")
                say(f"round {number} of {count}: {program.name}, {len(values)} values "
                    f"in {took_s:.0f} s")
                rounds.append((number, program.name, values, mistakes))
    except KeyboardInterrupt:
        left_out["the rest"] = f"interrupted in round {number}"
    facts["load_after"] = machine.load_average()
    summary = Summary([(number, values) for number, _, values, _ in rounds])
    return {
        "format": FORMAT,
        "machine": facts,
        "quick": quick,
        "left_out": left_out,
        "columns": ", ".join(Value.__dataclass_fields__),
        "rounds": [
            {"round": number, "program": name, "malformed": mistakes,
             "values": [[*astuple(value)[:-1], float(f"{value.value:.6g}")] for value in values]}
            for number, name, values, mistakes in rounds
        ],
        "summary": summary.as_json(),
    }


def as_text(result):
    """A result as JSON that differs line by line: one for each entry of a list."""
    lines = []
    for key, value in result.items():
        if isinstance(value, list):
            entries = ",\n  ".join(json.dumps(entry) for entry in value)
            lines.append(f"{json.dumps(key)}: [\n  {entries}\n ]")
        else:
            lines.append(f"{json.dumps(key)}: {json.dumps(value)}")
    return "{\n " + ",\n ".join(lines) + "\n}\n"


def values_of(result):
    """[(round, [Value])] of a result, for Summary."""
    return [(part["round"], [Value(*fields) for fields in part["values"]])
            for part in result["rounds"]]


def report(summary):
    """Ratios, single values and goals as lines of text."""
    lines = []
    for name in summary.figures():
        figure = figure_of(name)
        lines += ["", figure.title]
        lines += _values(summary, figure) + _ratios(summary, figure)
        for j in judge(summary, figure):
            share = j.goal.quantity in figure.percent
            what = [j.case, figure.words.get(j.goal.quantity, j.goal.quantity)]
            what += [j.goal.subject] * (j.goal.subject != "gyrotwin")
            answer = {"yes": "reached", "no": "MISSED", "unsure": "unsure"}[j.reached]
            lines.append(f"  {answer:8} {', '.join(filter(None, what))}: "
                         f"{with_quartiles(j.found, j.unit, share)}; "
                         f"goal {limit(j.goal, j.unit, share)}")
    return lines


def _values(summary, figure):
    """What has no peer: a line a quantity, with all its cases."""
    told = {}
    for case in summary.cases(figure.name):
        for quantity in summary.quantities(figure.name, case):
            if summary.peers(figure.name, case, quantity):
                continue
            for ours in summary.subjects(figure.name, case, quantity):
                found = summary.value(figure.name, case, quantity, ours)
                unit = summary.units[(figure.name, case, quantity)]
                value = measured(found.median, unit, quantity in figure.percent)
                told.setdefault((ours, quantity), []).append(f"{case}: {value}" if case else value)
    several = len({ours for ours, _ in told}) > 1
    return [f"           {ours + ', ' if several else ''}{figure.words.get(quantity, quantity)}: "
            + ", ".join(values) for (ours, quantity), values in told.items()]


def _ratios(summary, figure):
    """Ours over each peer's, a line each."""
    lines = []
    for case in summary.cases(figure.name):
        for quantity in summary.quantities(figure.name, case):
            key = (figure.name, case, quantity)
            unit, share = summary.units[key], quantity in figure.percent
            what = ", ".join(filter(None, (case, figure.words.get(quantity, quantity))))
            for ours in filter(is_ours, summary.subjects(*key)):
                found = summary.value(*key, ours)
                for peer in summary.peers(*key):
                    theirs = summary.value(*key, peer)
                    ratio = summary.ratio(*key, peer, ours)
                    text = (f"{measured(found.median, unit, share)} / "
                            f"{measured(theirs.median, unit, share)}")
                    text += f" = {with_quartiles(ratio, 'ratio')}" if ratio else ""
                    lines.append(f"           {what}: {ours} / {peer} = {text}")
    return lines
