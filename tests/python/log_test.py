"""Logs that are whole, damaged, signed by somebody else, or not by gyrotwin at all."""

import hashlib
import json
import os
import random
import struct
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import gyrotwin
from gyrotwin.wire import CHANNELS, DatagramFormat

KEY = bytes(range(32))
EVENTS = 60
RIG_TEXT = '[rig]\nname = "demo"\n'


def digest(data):
    return hashlib.blake2b(data, digest_size=32).hexdigest()[:16]


def event(number, time_us, channel, data):
    name = channel.encode()
    header = struct.pack(">IqqII", 0xEDA1DA01, number, time_us, len(name), len(data))
    return header + name + data


def opening(channel, content):
    data = content.encode()
    return digest(channel.encode() + b"\0" + data).encode() + b"\n" + data


def about(key):
    digits = digest(KEY)
    channels = {
        f"DEMO/{name}": {
            "type": channel.type.__name__,
            "fingerprint": channel.fingerprint.hex(),
            "size": channel.size,
        }
        for name, channel in CHANNELS.items()
    }
    fingerprint = "-".join(digits[at : at + 4] for at in range(0, 16, 4)) if key else ""
    return json.dumps(
        {"rig": "demo", "prefix": "DEMO", "rig_id": 7, "key": fingerprint, "channels": channels}
    )


def state_payload(sequence, key=KEY):
    state = gyrotwin.state_t()
    state.header.epoch, state.header.sequence = 5, sequence
    state.tilt_rad = [0.01 * sequence, 0.0]
    datagram = DatagramFormat("DEMO", 7, key).write("LIVE/STATE", state)
    return datagram[datagram.index(b"\0", 8) + 1 :]


def write_events(key=KEY):
    """Opening events and STATEs at 1 kHz, as a list of their bytes."""
    events = [
        event(0, 0, "gyrotwin/log/about", opening("gyrotwin/log/about", about(key))),
        event(1, 0, "gyrotwin/log/rig", opening("gyrotwin/log/rig", RIG_TEXT)),
    ]
    for k in range(EVENTS):
        time_us = 1_700_000_000_000_000 + 1000 * k
        events.append(event(2 + k, time_us, "DEMO/LIVE/STATE", state_payload(k, key)))
    return events


class LogTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        environment = mock.patch.dict(os.environ, {"GYROTWIN_KEYS": folder.name})
        environment.start()
        self.addCleanup(environment.stop)
        self.put_key(KEY)

    def put_key(self, key):
        file = self.folder / "demo.key"
        file.write_text(key.hex() + "\n")
        file.chmod(0o600)

    def log(self, content):
        path = self.folder / "log.lcm"
        path.write_bytes(content)
        return gyrotwin.Log(path)

    def sequences(self, log):
        return [message.header.sequence for _, _, message in log]

    def test_a_whole_log_is_read_whole(self):
        log = self.log(b"".join(write_events()))
        rows = list(log)
        self.assertEqual([row[2].header.sequence for row in rows], list(range(EVENTS)))
        self.assertEqual({row[1] for row in rows}, {"LIVE/STATE"})
        self.assertAlmostEqual(rows[-1][0], 1e-3 * (EVENTS - 1), places=9)
        self.assertEqual(log.rig_text, RIG_TEXT)
        self.assertEqual(log.about["rig"], "demo")
        self.assertEqual(log.channels["SIM/TRUTH"], "truth_t")
        self.assertTrue(log.signatures_checked)
        self.assertFalse(log.damage)

    def test_series_has_one_field(self):
        log = self.log(b"".join(write_events()))
        times, tilt = gyrotwin.series(log, "LIVE/STATE", "tilt_rad[0]")
        self.assertEqual(tilt, [0.01 * k for k in range(EVENTS)])
        self.assertEqual(len(times), EVENTS)
        _, ids = gyrotwin.series(log, "LIVE/STATE", "header.rig_id")
        self.assertEqual(set(ids), {7})

    def test_series_says_what_there_is(self):
        log = self.log(b"".join(write_events()))
        for channel, field, told in [
            ("LIVE/STATE", "tilt", "there are header, mode"),
            ("LIVE/STATE", "tilt_rad[2]", "no `tilt_rad"),
            ("LIVE/STATE", "tilt_rad[0", "is no field"),
            ("LIVE/STAT", "tilt_rad[0]", "channels are LIVE/STATE"),
        ]:
            with self.assertRaisesRegex(gyrotwin.Error, told):
                gyrotwin.series(log, channel, field)

    def test_a_log_that_is_cut_anywhere_gives_what_is_whole(self):
        events = write_events()
        whole = b"".join(events)
        for cut in random.Random(1).sample(range(len(events[0]), len(whole)), 80):
            log = self.log(whole[:cut])
            fits, at = -2, 0
            for one in events:
                at += len(one)
                fits += at <= cut
            self.assertEqual(self.sequences(log), list(range(max(fits, 0))), cut)

    def test_a_changed_byte_costs_one_event_at_most(self):
        events = write_events()
        whole = b"".join(events)
        first = len(events[0]) + len(events[1])
        randomness = random.Random(2)
        for _ in range(200):
            at = randomness.randrange(first, len(whole))
            changed = bytearray(whole)
            changed[at] ^= 1 << randomness.randrange(8)
            log = self.log(bytes(changed))
            heard = self.sequences(log)
            self.assertEqual(heard, sorted(set(heard)), at)
            self.assertGreaterEqual(len(heard), EVENTS - 1, at)
            if len(heard) < EVENTS:
                self.assertEqual(log.damage.events_lost, 1, at)
                self.assertEqual(log.damage.bytes_lost, len(events[-1]), at)

    def test_bytes_missing_or_put_in_cost_what_they_touch(self):
        # Without signatures one event made of two halves has the right shape now and then.
        for key, made_of_halves in ((KEY, 0), (None, 1)):
            events = write_events(key)
            whole = b"".join(events)
            first = len(events[0]) + len(events[1])
            randomness = random.Random(3)
            for _ in range(100):
                at, size = randomness.randrange(first, len(whole)), randomness.randrange(1, 400)
                for broken in (
                    whole[:at] + whole[at + size :],
                    whole[:at] + randomness.randbytes(size) + whole[at:],
                ):
                    heard = self.sequences(self.log(broken))
                    right = [k for k in heard if k in range(EVENTS)]
                    self.assertEqual(right, sorted(set(right)), (key, at, size))
                    self.assertGreaterEqual(len(right), EVENTS - 3, (key, at, size))
                    self.assertLessEqual(len(heard) - len(right), made_of_halves, (key, at, size))

    def test_a_wrong_time_is_that_of_the_event_before(self):
        events = write_events()
        broken = bytearray(events[30])
        broken[12] ^= 0x10
        events[30] = bytes(broken)
        log = self.log(b"".join(events))
        times = [time for time, _, _ in log]
        self.assertEqual(len(times), EVENTS)
        self.assertLess(max(times), 1.0)
        self.assertEqual(log.damage.times_repaired, 1)

    def test_what_somebody_else_signed_is_left_out(self):
        events = write_events()
        events[10] = event(10, 0, "DEMO/LIVE/STATE", state_payload(8, bytes(32)))
        log = self.log(b"".join(events))
        self.assertEqual(self.sequences(log), [k for k in range(EVENTS) if k != 8])
        self.assertEqual(log.damage.wrong_signature, 1)

    def test_without_the_key_of_the_record_shape_is_all_that_is_checked(self):
        self.put_key(bytes(32))
        log = self.log(b"".join(write_events()))
        self.assertFalse(log.signatures_checked)
        self.assertEqual(len(self.sequences(log)), EVENTS)

    def test_a_log_of_lcm_logger_is_read_too(self):
        events = [event(k, 1000 * k, "DEMO/LIVE/STATE", state_payload(k)) for k in range(3)]
        events.append(event(3, 3000, "WEATHER", b"\x01\x02"))
        log = self.log(b"".join(events))
        self.assertEqual([row[1] for row in log], ["LIVE/STATE"] * 3 + ["WEATHER"])
        self.assertEqual(list(log)[-1][2], b"\x01\x02")
        self.assertEqual(log.rig_text, "")

    def test_nothing_and_rubbish_have_no_messages(self):
        self.assertEqual(list(self.log(b"")), [])
        log = self.log(random.Random(4).randbytes(5000))
        self.assertEqual(list(log), [])
        self.assertEqual(log.damage.bytes_lost, 5000)
        with self.assertRaisesRegex(gyrotwin.Error, "No such file"):
            gyrotwin.Log(self.folder / "none.lcm")
        with self.assertRaisesRegex(gyrotwin.Error, "cannot be read"):
            gyrotwin.Log(self.folder)


if __name__ == "__main__":
    unittest.main()
