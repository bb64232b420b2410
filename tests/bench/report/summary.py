"""What the rounds amount to: medians, quartiles, ratios within a round, goals.

Disturbances of a shared machine hit all subjects of a round alike, and one round more than another:
so a ratio is taken inside each round, and the median over the rounds is told, with quartiles.
"""

import statistics
from collections import defaultdict
from dataclasses import dataclass

from .values import is_ours


@dataclass(frozen=True)
class Spread:
    """The middle of some rounds' values, and how far their middle half reaches."""

    median: float
    low: float  # first quartile
    high: float  # third quartile
    rounds: int

    def as_json(self):
        return {name: float(f"{value:.6g}") if isinstance(value, float) else value
                for name, value in vars(self).items()}

    def within(self, holds):
        """"yes", "no", or "unsure" where the quartiles disagree. holds: value -> bool"""
        if holds(self.low) and holds(self.high):
            return "yes"
        return "unsure" if holds(self.low) or holds(self.high) else "no"


def spread(values):
    """values: at least one, finite."""
    if len(values) == 1:
        return Spread(values[0], values[0], values[0], 1)
    low, median, high = statistics.quantiles(values, n=4, method="inclusive")
    return Spread(median, low, high, len(values))


class Summary:
    """All rounds, by (figure, case, quantity)."""

    def __init__(self, rounds):
        """rounds: [(round's number, [Value])]; a round may come in several parts."""
        raw = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
        self.units = {}
        for number, values in rounds:
            for v in values:
                key = (v.figure, v.case, v.quantity)
                raw[key][v.subject][number].append(v.value)
                self.units[key] = v.unit
        # Of a value that was told several times in one round, the median.
        self._table = {
            key: {
                subject: {number: statistics.median(told) for number, told in rounds_.items()}
                for subject, rounds_ in subjects.items()
            }
            for key, subjects in raw.items()
        }

    def figures(self):
        return list(dict.fromkeys(figure for figure, _, _ in self._table))

    def cases(self, figure, quantity=None):
        """In the order in which they were measured; numbers by size."""
        found = dict.fromkeys(
            c for f, c, q in self._table if f == figure and quantity in (None, q))
        try:
            return sorted(found, key=lambda case: float(case or 0))
        except ValueError:
            return list(found)

    def quantities(self, figure, case):
        return [q for f, c, q in self._table if f == figure and c == case]

    def subjects(self, figure, case, quantity):
        """Ours first."""
        found = self._table.get((figure, case, quantity), {})
        return sorted(found, key=lambda subject: not is_ours(subject))

    def peers(self, figure, case, quantity):
        return [s for s in self.subjects(figure, case, quantity) if not is_ours(s)]

    def value(self, figure, case, quantity, subject="gyrotwin"):
        """Spread over the rounds, or None."""
        rounds = self._table.get((figure, case, quantity), {}).get(subject)
        return spread(list(rounds.values())) if rounds else None

    def ratio(self, figure, case, quantity, peer, subject="gyrotwin"):
        """Ours over theirs, or None."""
        table = self._table.get((figure, case, quantity), {})
        ours, theirs = table.get(subject, {}), table.get(peer, {})
        ratios = [ours[n] / theirs[n] for n in ours if n in theirs and theirs[n] != 0]
        return spread(ratios) if ratios else None

    def as_json(self):
        """One entry a (figure, case, quantity)."""
        entries = []
        for key in self._table:
            subjects = self.subjects(*key)
            ratios = []
            for ours in filter(is_ours, subjects):
                for peer in self.peers(*key):
                    found = self.ratio(*key, peer, ours)
                    if found:
                        ratios.append({"subject": ours, "peer": peer} | found.as_json())
            entries.append({
                "figure": key[0], "case": key[1], "quantity": key[2], "unit": self.units[key],
                "values": {s: self.value(*key, s).as_json() for s in subjects},
                "ratios": ratios,
            })
        return entries


@dataclass(frozen=True)
class Judged:
    """A goal of a figure, in one case, beside what was measured."""

    goal: object  # figures.Goal
    case: str
    found: Spread
    unit: str  # of `found`; "ratio" where it is ours over a peer's
    reached: str  # "yes", "no", "unsure"


def judge(summary, figure):
    """The goals of a figure that can be told from what was measured."""
    judged = []
    for goal in figure.goals:
        for case in summary.cases(figure.name, goal.quantity):
            if goal.case is not None and case != goal.case:
                continue
            if goal.peer:
                found = summary.ratio(figure.name, case, goal.quantity, goal.peer, goal.subject)
                unit = "ratio"
            else:
                found = summary.value(figure.name, case, goal.quantity, goal.subject)
                unit = summary.units[(figure.name, case, goal.quantity)]
            if found:
                judged.append(Judged(goal, case, found, unit, found.within(goal.holds)))
    return judged
