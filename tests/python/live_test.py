"""A rig that runs, with the daemons of the build under test in $GYROTWIN_BIN: heard, pushed,
recorded, and read back. In a network namespace of its own (tests/support/in_namespace)."""

import json
import os
import re
import secrets
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import gyrotwin
from gyrotwin.wire import DatagramFormat

ROOT = Path(__file__).resolve().parents[2]
RIG = "double_brennan"
PATIENCE_S = 60  # of wall time, on a busy machine
SPEED = 0.25  # slowed down, so that a busy machine's pauses are short in the owner's time


class Live(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        os.environ["GYROTWIN_KEYS"] = folder.name
        os.environ["GYROTWIN_RIGS"] = str(ROOT / "deploy/rigs")
        cls.run_program("key", "new")
        cls.start("integrator")
        cls.start("controller")
        cls.run_program("ctl", "wait", "ready", "--timeout", str(PATIENCE_S))
        cls.rig = gyrotwin.Rig(RIG)

    @classmethod
    def words(cls, program, *arguments):
        return [f"{os.environ['GYROTWIN_BIN']}/gyrotwin-{program}", *arguments]

    @classmethod
    def start(cls, program, *arguments):
        said = open(cls.folder / f"{program}.txt", "w+")
        cls.addClassCleanup(said.close)
        words = cls.words(program, *arguments, "--rig", RIG)
        process = subprocess.Popen(words, stdout=said, stderr=subprocess.STDOUT)
        cls.addClassCleanup(process.wait)
        cls.addClassCleanup(process.terminate)
        return process

    @classmethod
    def run_program(cls, program, *arguments):
        words = cls.words(program, *arguments, "--rig", RIG)
        done = subprocess.run(words, capture_output=True, text=True, timeout=2 * PATIENCE_S)
        if done.returncode != 0:
            raise AssertionError(f"{' '.join(words)}: {done.stdout}{done.stderr}")
        return done.stdout

    def setUp(self):
        self.operator = gyrotwin.Operator(self.rig)
        self.addCleanup(self.operator.close)
        self.bus = gyrotwin.Bus(self.rig)
        self.addCleanup(self.bus.close)

    def balance(self):
        self.operator.reset()
        self.operator.clear()
        self.operator.speed(SPEED)
        self.run_program("ctl", "wait", "ready", "--timeout", str(PATIENCE_S))
        self.operator.arm()
        self.run_program("ctl", "wait", "balanced", "--timeout", str(PATIENCE_S))

    def owner_mode(self):
        return self.operator.owner().mode

    def status(self):
        return json.loads(self.run_program("ctl", "status", "--json"))

    def test_everything_that_is_said_is_heard_and_authentic(self):
        self.balance()
        heard = set()
        for channel, message in self.bus.listen(PATIENCE_S):
            self.assertEqual(message.header.rig_id, self.rig.id)
            heard.add(channel)
            if heard >= {
                "LIVE/STATE", "LIVE/COMMAND", "LIVE/SENSORS", "SIM/TRUTH", "INTEGRATOR/STATUS",
                "CONTROLLER/STATUS",
            }:  # fmt: skip
                break
        counters = self.bus.counters
        self.assertEqual(counters.malformed + counters.unauthentic + counters.other_rig, 0)
        self.assertEqual(set(counters.received), heard)

    def test_listening_ends_in_time_and_names_are_checked(self):
        self.assertEqual(list(self.bus.listen(0.0)), [])
        self.assertEqual({c for c, _ in self.bus.listen(0.5, "REQUEST")}, set())
        with self.assertRaisesRegex(ValueError, "there are LIVE/STATE"):
            next(self.bus.listen(1.0, "LIVE/STAT"))

    def test_a_push_is_felt_recorded_and_read_back(self):
        self.balance()
        owner = self.operator.owner()
        record = self.folder / "push.lcm"
        recorder = self.start("log", "record", str(record))
        while "recording rig" not in (self.folder / "log.txt").read_text():
            self.assertIsNone(recorder.poll(), (self.folder / "log.txt").read_text())
        tilts = {}
        reply = None
        self.bus.drain()
        for _, state in self.bus.listen(PATIENCE_S, "LIVE/STATE"):
            if reply is None:
                reply = self.operator.push(roll_nms=1.0)
            tilts[state.header.tick] = state.tilt_rad[0]
            if state.header.tick > reply.tick + 200:
                break
        recorder.terminate()
        recorder.wait(PATIENCE_S)
        self.assertEqual(self.operator.owner().mode, owner.MODE_RUNNING)
        self.assertRegex(reply.text, f"ticks {reply.tick} to {reply.tick + 9}")  # 20 ms at 500 Hz
        after = [tilt for tick, tilt in tilts.items() if tick > reply.tick]
        self.assertGreater(max(map(abs, after)), 0.03)  # measured 0.0482
        self.assertLess(max(map(abs, after)), 0.07)
        before = [tilt for tick, tilt in tilts.items() if tick <= reply.tick]
        self.assertLess(max(map(abs, before)), 0.017)  # balanced: within 1 deg
        self.compare_with_log_cat(record)

        # The log has what was heard live, the request and its answer.
        log = gyrotwin.Log(record)
        logged = {m.header.tick: m.tilt_rad[0] for _, _, m in log.read("LIVE/STATE")}
        both = logged.keys() & tilts.keys()
        self.assertGreater(len(both), 150)
        self.assertEqual([logged[tick] for tick in both], [tilts[tick] for tick in both])
        (_, _, request), = log.read("REQUEST")
        self.assertAlmostEqual(request.moment_nm[0] * 1e-9 * request.duration_ns, 1.0)
        (_, _, answer), = log.read("REPLY")
        self.assertEqual((answer.applied_tick, answer.id), (reply.tick, reply.id))
        self.assertIn('name = "double_brennan"', log.rig_text)
        self.read_damaged(record)

    def compare_with_log_cat(self, record):
        """Every message, field by field, as the programs read it."""
        log = gyrotwin.Log(record)
        words = self.words("log", "cat", "--json", str(record))
        cat = subprocess.run(words, capture_output=True, text=True, check=True)
        lines = [json.loads(line) for line in cat.stdout.splitlines()]
        rows = list(log)
        self.assertTrue(log.signatures_checked)
        self.assertFalse(log.damage)
        self.assertEqual(len(rows), len(lines))
        self.assertGreater(len(rows), 500)
        for (time, channel, message), line in zip(rows, lines):
            self.assertEqual(f"{self.rig.prefix}/{channel}", line["channel"])
            self.assertEqual(type(message).__name__, line["type"])
            self.assertAlmostEqual(time, line["seconds"], places=6)
            self.assertEqual(plain(message), line["message"])

    def read_damaged(self, record):
        """The same events are lost to this package and to `gyrotwin log`."""
        broken = bytearray(record.read_bytes())
        for part in (0.3, 0.5, 0.7):
            broken[int(part * len(broken))] ^= 0x40
        cut = int(0.8 * len(broken))
        del broken[cut : cut + 500]
        path = self.folder / "broken.lcm"
        path.write_bytes(broken)
        log = gyrotwin.Log(path)
        ours = [message.header.sequence for _, _, message in log]
        words = self.words("log", "info", "--json", str(path))
        info = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
        self.assertEqual(len(ours), info["messages"])
        self.assertTrue(log.damage)
        for name in ("bytes_lost", "events_lost", "wrong_shape", "wrong_signature"):
            self.assertEqual(getattr(log.damage, name), info["damage"][name], name)

    def test_every_verb_is_done_or_refused_with_a_reason(self):
        operator = self.operator
        self.balance()
        modes = gyrotwin.status_t
        with self.assertRaisesRegex(gyrotwin.Refused, "not possible in RUNNING"):
            operator.arm()
        operator.pause()
        self.assertEqual(self.owner_mode(), modes.MODE_PAUSED)
        before = operator.owner().header.tick
        operator.step(3)
        self.assertEqual(operator.owner().header.tick, before + 3)
        operator.resume()
        self.assertEqual(self.owner_mode(), modes.MODE_RUNNING)

        sine = operator.disturb(
            "SINE", moment_nm=[0.1], frequency_hz=[2.0], duration_ns=10**10, rise_ns=10**9
        )
        fault = operator.fault("DRIVE_WEAK", target=-1, level=0.9)
        self.assertEqual((sine.id, fault.id), (1, 2))
        owner = operator.owner()
        self.assertEqual((owner.disturbances, owner.faults), (1, 1))
        operator.cancel(sine.id)
        with self.assertRaises(gyrotwin.Refused):
            operator.cancel(sine.id)
        operator.clear()
        self.assertEqual(operator.owner().faults, 0)

        operator.disarm()
        self.assertEqual(self.owner_mode(), modes.MODE_SAFE_STOP)
        epoch = operator.owner().header.epoch
        operator.reset(q=[0.02, -0.01])
        self.assertEqual(self.owner_mode(), modes.MODE_HELD)
        self.assertNotEqual(operator.owner().header.epoch, epoch)
        self.bus.drain()
        _, state = next(self.bus.listen(PATIENCE_S, "LIVE/STATE"))
        self.assertEqual(tuple(state.tilt_rad), (0.02, -0.01))
        with self.assertRaisesRegex(gyrotwin.Refused, "moment_nm"):
            operator.disturb("LOAD", start_tick=1, moment_nm=[float("nan")])

    def test_what_cannot_be_meant_is_not_sent(self):
        for wrong in (
            lambda: self.operator.disturb("SHAKE"),
            lambda: self.operator.disturb("LOAD", moment=[1.0]),
            lambda: self.operator.disturb("LOAD", writer=1),
            lambda: self.operator.disturb("LOAD", moment_nm=[1.0, 2.0, 3.0, 4.0]),
            lambda: self.operator.disturb("LOAD", duration_ns=0.5),
        ):
            with self.assertRaises((TypeError, ValueError)):
                wrong()

    def test_an_operator_is_understood_after_somebody_else_began_a_new_run(self):
        self.operator.reset()
        self.run_program("ctl", "reset")
        self.assertEqual(self.operator.speed(SPEED).tick, 0)

    def test_a_request_that_is_not_signed_or_by_another_key_does_nothing(self):
        self.balance()
        request = gyrotwin.request_t()
        request.verb = request.DISARM
        request.owner_epoch = self.operator.owner().header.epoch
        request.header.source = request.header.OPERATOR
        request.header.epoch = request.writer = secrets.randbits(63)
        request.counter = 1
        before = self.operator.owner().unauthentic
        for key in (None, bytes(32)):
            forged = DatagramFormat(self.rig.prefix, self.rig.id, key).write("REQUEST", request)
            self.bus.send_again(forged)
        for _, status in self.bus.listen(PATIENCE_S, "INTEGRATOR/STATUS"):
            if status.unauthentic >= before + 2:
                break
        self.assertEqual(status.unauthentic, before + 2)
        self.assertEqual(status.mode, status.MODE_RUNNING)

    def test_a_wrong_key_hears_nobody_and_says_so(self):
        other = gyrotwin.Rig(RIG)
        other.key = bytes(32)
        with gyrotwin.Operator(other) as stranger:
            with self.assertRaisesRegex(gyrotwin.NoAnswer, "both sides need the same key"):
                stranger.arm()
            self.assertGreater(stranger.bus.counters.unauthentic, 0)

    def test_a_rig_that_does_not_run_does_not_answer(self):
        file = self.folder / "alone.toml"
        text = (ROOT / "deploy/rigs/double_brennan.toml").read_text()
        file.write_text(text.replace("239.255.71.3", "239.255.71.99"))
        with gyrotwin.Operator(gyrotwin.Rig(file)) as operator:
            with self.assertRaisesRegex(gyrotwin.NoAnswer, "no owner of rig double_brennan"):
                operator.arm()
        file.write_text(text.replace('interface = "lo"', 'interface = "no_such0"'))
        with self.assertRaisesRegex(gyrotwin.Error, "this host has: lo"):
            gyrotwin.Bus(gyrotwin.Rig(file))

    def test_the_example_draws_a_push(self):
        self.balance()
        example = ROOT / "clients/python/examples/plot_push.py"
        picture = self.folder / "push.svg"
        words = [sys.executable, example, "--rig", RIG, "--seconds", "0.5", picture]
        done = subprocess.run(words, capture_output=True, text=True, timeout=2 * PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        peak = float(re.search(r"largest tilt ([\d.]+) deg", done.stdout)[1])
        self.assertGreater(peak, 3.0)  # measured 4.2
        self.assertEqual(picture.read_text().count("<polyline"), 2)


def plain(value):
    """As `gyrotwin log cat --json` writes it."""
    if isinstance(value, bytes):
        words = value.rstrip(b"\0")
        return value.hex() if len(value) == 32 and not words.isascii() else gyrotwin.text(value)
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    return value


if __name__ == "__main__":
    unittest.main()
