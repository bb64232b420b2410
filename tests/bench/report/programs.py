"""The measuring programs: how each is built, started, and how often.

A program is run once a round and prints values as JSON lines (values.py); words for people go to
stderr. It ends with 0, or with 2 and a sentence that says what is missing.
"""

import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from .values import parse_all

ROOT = Path(__file__).resolve().parents[3]
BUILD = ROOT / "build/release"
BIN = BUILD / "bin"
_LAST_WORDS = 300  # characters of a program's stderr that are kept where it fails


@dataclass(frozen=True)
class Program:
    name: str
    figures: tuple  # that it measures
    words: tuple  # command line; a program of the build by its bare name
    quick: tuple = ()  # further words for --quick
    targets: tuple = ()  # that CMake builds for it
    namespace: bool = False  # in a network namespace of its own
    rounds: int = 1000  # at most
    limit_s: int = 300


def _script(name):
    return str(ROOT / "tests/bench" / name)


PROGRAMS = (
    Program("plant", ("acceleration", "tick", "arithmetic"), ("plant_bench",),
            targets=("plant_bench",)),
    Program("loop", ("round_trip", "loop"), ("loop_bench",), targets=("loop_bench",),
            namespace=True),
    Program("wakeup", ("wakeup",), ("wakeup",), targets=("wakeup",)),
    Program("mirror", ("mirror",), (_script("mirror/times"),), targets=("mirror_figures",)),
    Program("start", ("start",), (_script("start/start"),), targets=("programs",),
            namespace=True, rounds=3),
    Program("logger", ("logger",), (_script("logger/logger"),), ("--quick",),
            ("programs", "log_sender"), namespace=True, rounds=3),
    Program("ticks", ("gyros", "substeps"), (_script("scale/ticks"),), ("--quick",),
            ("programs",), namespace=True),
    Program("sweep", ("sweep",), (_script("scale/sweep"),), ("--quick",), ("programs",),
            namespace=True, rounds=3),
    Program("listeners", ("listeners",), (_script("scale/listeners"),), ("--quick",),
            ("programs",), namespace=True, rounds=3),
    Program("rates", ("highest_rate",), (_script("scale/rates"),), ("--quick",), ("programs",),
            namespace=True, rounds=2),
    Program("rigs", ("rigs",), (_script("scale/rigs"),), ("--quick",), ("programs",),
            namespace=True, rounds=2),
)


class Failed(Exception):
    """Why a program has no values."""


def build(program):
    """Builds what a program needs. Raises Failed with the compiler's last words."""
    for target in program.targets:
        done = subprocess.run(["cmake", "--build", BUILD, "--target", target],
                              capture_output=True, text=True)
        if done.returncode != 0:
            said = done.stdout + done.stderr
            errors = [line for line in said.splitlines() if "error" in line.lower()]
            raise Failed(f"{target} is not built: {_end_of((errors or [said])[0])}")


def command(program, quick):
    words = list(program.words)
    if "/" not in words[0]:
        words[0] = str(BIN / words[0])
    if not Path(words[0]).exists():
        raise Failed(f"{words[0]} is not there")
    if program.namespace:
        words.insert(0, str(ROOT / "tests/support/in_namespace"))
    return words + list(program.quick if quick else ())


def measure(program, quick=False):
    """Runs a program once. Returns its values, what is wrong with its lines, and how long it took.
    Raises Failed where it gives none."""
    begin = time.monotonic()
    try:
        done = subprocess.run(command(program, quick), stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=program.limit_s)
    except subprocess.TimeoutExpired:
        raise Failed(f"it was not done within {program.limit_s} s") from None
    except OSError as error:
        raise Failed(f"it does not start: {error.strerror}") from None
    values, mistakes = parse_all(done.stdout)
    if done.returncode != 0:
        raise Failed(_end_of(done.stderr) or f"it ended with {done.returncode} and no word")
    if not values:
        raise Failed("; ".join(mistakes[:1]) or "it printed no value")
    return values, mistakes, time.monotonic() - begin


def _end_of(text):
    return text.strip()[-_LAST_WORDS:]
