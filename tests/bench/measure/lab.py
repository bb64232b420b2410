"""Rigs as processes, for who measures them: the build's programs, keys and a folder of our own.

Every rig has its own integrator and controller, prefix, id and port. Meant for a network namespace
(tests/support/in_namespace). A program prints values as JSON lines; words for people go to stderr.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FIRST_PORT = 17000
READY_S = 60  # of wall time: a busy machine starts twenty rigs slowly
ASKED_AT_MOST = 3  # times
SKIPPED_AT_MOST = 5e-3  # of the ticks, beyond what the machine withholds
LOOP_PROCESSORS = min(2, os.cpu_count())  # that a loop of two processes waits for
TRIES = 2
FAILED_AT_MOST = 2  # levels in a row


class Missing(Exception):
    """What a program needs is not there; the text says what."""


def emit(figure, case, quantity, unit, value, subject="gyrotwin"):
    """One value, as a JSON line."""
    line = {"figure": figure, "case": str(case), "subject": subject, "quantity": quantity}
    print(json.dumps(line | {"unit": unit, "value": value}), flush=True)


def say(text):
    """To people."""
    print(text, file=sys.stderr, flush=True)


def arguments(about):
    """The options that all these programs share."""
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="programs")
    parser.add_argument("--quick", action="store_true", help="fewer cases, shorter")
    return parser


def run_program(body):
    """Runs `body` to its exit code: 2 and a sentence when something is missing."""
    try:
        sys.exit(body())
    except Missing as missing:
        say(f"{Path(sys.argv[0]).name}: {missing}")
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)


def climb(unit, levels, holds):
    """The highest level that is held, 0: none. Ends where two in a row are not: who holds more
    would hold less as well, so one alone was the machine's doing. Raises Missing where nothing was
    held for want of something."""
    highest, failed, why = 0, 0, None
    for level in levels:
        try:
            held = holds(level)
        except Missing as missing:
            held, why = False, missing
            say(f"{level} {unit}: not held, it does not even start: {missing}")
        highest, failed = (level, 0) if held else (highest, failed + 1)
        if failed == FAILED_AT_MOST:
            break
    if why and not highest:
        raise why
    return highest


def cpu_s(pid):
    """CPU time of a process since its start, all its threads [s]; exact, not in clock ticks."""
    threads = Path(f"/proc/{pid}/task").glob("*/schedstat")
    return 1e-9 * sum(int(thread.read_text().split()[0]) for thread in threads)


def stolen_s():
    """CPU time that a hypervisor has kept for others since the start, of all processors [s]."""
    return int(Path("/proc/stat").read_text().split()[8]) / os.sysconf("SC_CLK_TCK")


def children_s():
    """CPU time of all programs that this one has started and seen end [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass
class Pair:
    """One rig: integrator and controller."""

    words: list  # --rig and --set of all its programs
    integrator: subprocess.Popen
    controller: subprocess.Popen

    def cpu_s(self):
        return cpu_s(self.integrator.pid) + cpu_s(self.controller.pid)


@dataclass
class Seen:
    """What the rigs had done at one instant, summed over them."""

    ticks: int = 0
    skipped: int = 0
    running: int = 0  # rigs
    lateness_p99_ns: list = field(default_factory=list)  # of the last second, one a rig

    @property
    def skipped_share(self):
        """Ticks that wall time has overtaken, over all."""
        return self.skipped / max(1, self.ticks + self.skipped)


class Lab:
    """Starts rigs, and ends all that it has started."""

    def __init__(self, bin_folder):
        self.bin = Path(bin_folder)
        if not (self.bin / "gyrotwin-integrator").exists():
            raise Missing(f"{self.bin} has no gyrotwin-integrator; deploy/build binaries makes it")
        self._folder = tempfile.TemporaryDirectory(prefix="gyrotwin-bench-")
        self.folder = Path(self._folder.name)
        os.environ["GYROTWIN_KEYS"] = self._folder.name
        os.environ["GYROTWIN_RIGS"] = str(ROOT / "deploy/rigs")
        self._started, self._keys, self._rigs = [], set(), 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end(self._started)
        self._folder.cleanup()

    def start(self, program, *words):
        """A program of the build, its output in the lab's folder."""
        output = open(self.folder / f"{len(self._started)}-{program}.txt", "w")
        command = [self.bin / f"gyrotwin-{program}", *words]
        with output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        self._started.append(process)
        return process

    def run(self, program, *words):
        """A client from start to end. Returns what it printed; raises Missing when it fails."""
        command = [self.bin / f"gyrotwin-{program}", *words]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=2 * READY_S)
        except subprocess.TimeoutExpired:
            raise Missing(f"gyrotwin {program} was not done within {2 * READY_S} s") from None
        if done.returncode != 0:
            said = (done.stderr or done.stdout).strip()[-200:]
            raise Missing(f"gyrotwin {program} {' '.join(words)}: {said}")
        return done.stdout

    @staticmethod
    def end(processes):
        """SIGTERM to all, and SIGKILL to who does not go."""
        for process in processes:
            if process.poll() is None:
                process.terminate()
        for process in processes:
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def pair(self, rig="prototype_b", *overrides):
        """Starts one more rig; it is HELD."""
        if rig not in self._keys:
            self.run("key", "new", "--rig", rig)
            self._keys.add(rig)
        self._rigs += 1
        own = [f"network.prefix=BENCH{self._rigs}", f"network.port={FIRST_PORT + self._rigs}"]
        words = ["--rig", rig]
        for key in [*own, f"rig.id={self._rigs}", *overrides]:
            words += ["--set", key]
        return Pair(words, self.start("integrator", *words), self.start("controller", *words))

    def arm(self, pairs):
        """Waits until all can be armed, and arms them."""
        for pair in pairs:
            self.run("ctl", "wait", "ready", "--timeout", str(READY_S), *pair.words)
        for pair in pairs:
            self.run("ctl", "arm", *pair.words)

    def owner(self, pair):
        """The owner's part of `gyrotwin ctl status --json`; asked again where all are too busy."""
        for left in reversed(range(ASKED_AT_MOST)):
            try:
                return json.loads(self.run("ctl", "status", "--json", *pair.words))["owner"]
            except Missing:
                if left == 0:
                    raise

    def look(self, pairs):
        seen = Seen()
        for pair in pairs:
            owner = self.owner(pair)
            seen.ticks += owner["tick"]
            seen.skipped += owner["skipped_ticks"]
            seen.running += owner["mode"] == "RUNNING"
            seen.lateness_p99_ns.append(owner["lateness_ns"]["p99"])
        return seen

    def judge(self, figure, case, pairs, seconds, rate_hz):
        """Watches rigs of that rate, beside what the machine withholds, and emits what they skipped,
        how late they were and the CPUs that they took. Returns whether they kept real time, how many
        still run, and the CPUs. Where all do but some were late there is a second try: what others
        did to the machine just then is chance."""
        for _ in range(TRIES):
            seen, cpu, withheld = self._watch_beside_pauses(pairs, seconds, rate_hz)
            all_run = seen.running == len(pairs)
            held = all_run and seen.skipped_share <= SKIPPED_AT_MOST + withheld
            say(f"{figure} {case}: {100 * seen.skipped_share:.3f} % of the ticks skipped, "
                f"{100 * withheld:.3f} % withheld, {len(pairs) - seen.running} stopped, "
                f"{cpu / seconds:.2f} CPUs: {'held' if held else 'not held'}")
            if held or not all_run:
                break
        emit(figure, case, "skipped", "1", seen.skipped_share)
        emit(figure, case, "withheld", "1", withheld)
        emit(figure, case, "late_p99", "us", 1e-3 * statistics.median(seen.lateness_p99_ns))
        emit(figure, case, "cpu", "1", cpu / seconds)
        return held, seen.running, cpu / seconds

    def _watch_beside_pauses(self, pairs, seconds, rate_hz):
        """watch(), and the share of the ticks that the machine withheld from a loop: that a thread
        with nothing to do missed too, of the time that a hypervisor says it has stolen."""
        program = self.bin / "pauses"
        if not program.exists():
            raise Missing(f"{self.bin} has no pauses; deploy/build pauses makes it")
        pauses = subprocess.Popen([program, str(rate_hz)], stdout=subprocess.PIPE, text=True)
        self._started.append(pauses)
        pauses.stdout.readline()  # it is at it, or not allowed to be
        stolen, begin = stolen_s(), time.monotonic()
        seen, cpu = self.watch(pairs, seconds)
        stolen = (stolen_s() - stolen) / (time.monotonic() - begin) / os.cpu_count()
        pauses.terminate()
        said, _ = pauses.communicate()
        missed = float(said) if pauses.returncode == 0 else 0.0
        return seen, cpu, LOOP_PROCESSORS * min(missed, stolen)

    def watch(self, pairs, seconds):
        """Lets armed rigs run. Returns what they did meanwhile, and the CPU time of it [s]."""
        before = self.look(pairs)
        used = [pair.cpu_s() for pair in pairs]
        begin = time.monotonic()
        time.sleep(seconds)
        cpu = sum(pair.cpu_s() for pair in pairs) - sum(used)
        cpu *= seconds / (time.monotonic() - begin)
        after = self.look(pairs)
        after.ticks -= before.ticks
        after.skipped -= before.skipped
        return after, cpu
