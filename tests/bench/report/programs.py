"""The measuring programs: how each is built, started, and how often.

A program is run once a round and prints values as JSON lines (values.py); words for people go to
stderr. It ends with 0, or with 2 and a sentence that says what is missing.
"""

import os
import signal
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
    file: str  # a program of the build by its bare name, or a path
    words: tuple = ()  # of its command line
    quick: tuple = ()  # the same for --quick
    targets: tuple = ()  # that CMake builds for it
    namespace: bool = False  # in a network namespace of its own
    rounds: int = 1000  # at most
    limit_s: int = 300


def _script(name):
    return str(ROOT / "tests/bench" / name)


def _measure(name, figures, **more):
    """One of the programs that measure the daemons and clients."""
    return Program(name, figures, _script(f"measure/{name}"), **more)


def _scale(name, figures, targets=("binaries",), **more):
    return _measure(name, figures, quick=("--quick",), targets=targets, namespace=True, **more)


PROGRAMS = (
    Program("plant", ("acceleration", "tick", "arithmetic"), "plant_bench", ("--seconds", "1"),
            ("--seconds", "0.2"), ("plant_bench",)),
    Program("instructions", ("acceleration",), "plant_bench", ("--instructions",),
            ("--instructions",), ("plant_bench",), rounds=1),
    Program("one core", ("round_trip",), "loop_bench", ("one_core", "8"), ("one_core", "2"),
            ("loop_bench",), namespace=True),
    Program("two cores", ("round_trip",), "loop_bench", ("two_cores", "4"), ("two_cores", "1"),
            ("loop_bench",), namespace=True),
    Program("system calls", ("round_trip",), "loop_bench", ("system_calls",), ("system_calls",),
            ("loop_bench",), namespace=True, rounds=1),
    Program("wakeup", ("wakeup",), "wakeup", ("10",), ("2",), ("wakeup",)),
    Program("loop", ("loop",), _script("loop/shipped_loop.sh"), (str(BIN), "10"), (str(BIN), "3"),
            ("binaries", "loop_latency"), rounds=3),
    _measure("mirror", ("mirror",), targets=("mirror_figures",)),
    _measure("start", ("start",), targets=("programs",), namespace=True, rounds=3),
    _measure("logger", ("logger",), quick=("--quick",), targets=("binaries", "log_sender"),
             namespace=True, rounds=3),
    _scale("ticks", ("gyros", "substeps")),
    _scale("sweep", ("sweep",), rounds=3),
    _scale("listeners", ("listeners",), rounds=3),
    _scale("rates", ("highest_rate",), targets=("binaries", "pauses"), rounds=3),
    _scale("rigs", ("rigs",), targets=("binaries", "pauses"), rounds=3, limit_s=600),
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
    file = program.file if "/" in program.file else str(BIN / program.file)
    if not Path(file).exists():
        raise Failed(f"{file} is not there")
    namespace = [str(ROOT / "tests/support/in_namespace")] * program.namespace
    return [*namespace, file, *(program.quick if quick else program.words)]


def measure(program, quick=False):
    """Runs a program once. Returns its values, what is wrong with its lines, and how long it took.
    Raises Failed where it gives none."""
    begin = time.monotonic()
    try:
        running = subprocess.Popen(command(program, quick), stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, start_new_session=True)
    except OSError as error:
        raise Failed(f"it does not start: {error.strerror}") from None
    with running:
        try:
            said, words = running.communicate(timeout=program.limit_s)
        except subprocess.TimeoutExpired:
            raise Failed(f"it was not done within {program.limit_s} s") from None
        finally:
            end(running)
    values, mistakes = parse_all(said)
    if running.returncode != 0:
        raise Failed(_end_of(words) or f"it ended with {running.returncode} and no word")
    if not values:
        raise Failed("; ".join(mistakes[:1]) or "it printed no value")
    return values, mistakes, time.monotonic() - begin


def end(running):
    """Ends a program that still runs, with all that it has started: some of it has realtime priority
    and would hold up everybody else for ever."""
    for number, patience_s in ((signal.SIGINT, 10), (signal.SIGKILL, None)):
        _take_realtime(running.pid)
        try:
            os.killpg(running.pid, number)
        except ProcessLookupError:
            return  # nobody is left
        try:
            running.wait(patience_s)
        except subprocess.TimeoutExpired:
            pass


def _take_realtime(group):
    """From every thread of a process group: a realtime thread that hangs gives nobody the processor
    in which it would be ended."""
    for stat in Path("/proc").glob("[0-9]*/task/[0-9]*/stat"):
        try:
            # pid (name) state ppid pgrp ...; the name may have anything in it.
            fields = stat.read_text().rpartition(")")[2].split()
            if int(fields[2]) == group:
                os.sched_setscheduler(int(stat.parent.name), os.SCHED_OTHER, os.sched_param(0))
        except (OSError, IndexError, ValueError):
            continue  # it is gone


def _end_of(text):
    return text.strip()[-_LAST_WORDS:]
