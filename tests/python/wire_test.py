"""The wire as this package has it, against the golden messages and the page that is the norm."""

import re
import unittest
from pathlib import Path

import gyrotwin
from gyrotwin.wire import CHANNELS, DatagramFormat, signature

ROOT = Path(__file__).resolve().parents[2]
KEY = bytes(range(32))


def golden():
    """Type's name: (size, fingerprint, a message whose every field has its own value)."""
    for row in (ROOT / "tests/data/wire.lock").read_text().splitlines():
        name, size, fingerprint, message = row.split()
        yield name, int(size), bytes.fromhex(fingerprint), bytes.fromhex(message)


def demo_command():
    """The message of `a datagram, byte by byte` in messages/README.md."""
    command = gyrotwin.command_t()
    header = command.header
    header.rig_id, header.source = 7, header.CONTROLLER
    header.epoch, header.sequence = 81985529216486895, 41
    header.tick, header.sim_time_ns, header.sender_mono_ns = 40, 40_000_000, 1_000_000_000
    command.mode, command.valid_ticks, command.value = command.TORQUE_NM, 5, [-0.5, 0.0, 0.0, 0.0]
    command.for_tick, command.owner_epoch = 40, 1234567890123456789
    command.writer, command.counter = 1311768467463790320, 42
    return command


def published_datagram():
    """The listing of that section."""
    page = (ROOT / "messages/README.md").read_text()
    listing = page.split("## A datagram, byte by byte")[1].split("```")[1]
    rows = re.findall(r"^[0-9a-f]{4} ((?: [0-9a-f]{2})+)", listing, re.MULTILINE)
    return bytes.fromhex("".join(rows))


class Types(unittest.TestCase):
    def test_every_golden_message_comes_back_as_it_was(self):
        names = set()
        for name, size, fingerprint, message in golden():
            with self.subTest(name):
                decoded = getattr(gyrotwin, name).decode(message)
                self.assertEqual(message[:8], fingerprint)
                self.assertEqual(len(message), size)
                self.assertEqual(decoded.encode(), message)
                names.add(name)
        self.assertGreaterEqual(names, {channel.type.__name__ for channel in CHANNELS.values()})

    def test_channels_have_the_locked_sizes_and_fingerprints(self):
        locked = {name: (size, fingerprint) for name, size, fingerprint, _ in golden()}
        for name, channel in CHANNELS.items():
            with self.subTest(name):
                expected = locked[channel.type.__name__]
                self.assertEqual((channel.size, channel.fingerprint), expected)

    def test_channels_are_those_of_the_page_in_its_order(self):
        page = (ROOT / "messages/README.md").read_text()
        rows = re.findall(r"\| (\d+) \| `<RIG>/([A-Z/]+)` \| `(\w+)` \| (\d+) \|", page)
        ours = [
            (str(index), name, channel.type.__name__, str(channel.size))
            for index, (name, channel) in enumerate(CHANNELS.items())
        ]
        self.assertEqual(ours, rows)

    def test_text_ends_at_the_first_nul(self):
        self.assertEqual(gyrotwin.text(b"held\0\0rest"), "held")
        self.assertEqual(gyrotwin.text(b"full"), "full")


class Datagram(unittest.TestCase):
    def setUp(self):
        self.format = DatagramFormat("DEMO", 7, KEY)
        self.datagram = published_datagram()

    def verdict(self, datagram, key=KEY):
        return DatagramFormat("DEMO", 7, key).parse(datagram).verdict

    def test_is_the_published_one(self):
        self.assertEqual(self.format.write("LIVE/COMMAND", demo_command(), 3), self.datagram)

    def test_of_an_unsigned_rig_ends_with_zeros(self):
        unsigned = DatagramFormat("DEMO", 7, None).write("LIVE/COMMAND", demo_command(), 3)
        self.assertEqual(unsigned, self.datagram[:-32] + bytes(32))

    def test_published_one_is_good(self):
        parsed = self.format.parse(self.datagram)
        self.assertEqual(
            parsed[:4], ("good", "LIVE/COMMAND", 81985529216486895, 41)
        )
        self.assertEqual(gyrotwin.command_t.decode(parsed.payload).value[0], -0.5)

    def test_every_changed_byte_that_is_signed_is_noticed(self):
        for at in range(8, len(self.datagram)):
            changed = bytearray(self.datagram)
            changed[at] ^= 1
            self.assertNotEqual(self.verdict(bytes(changed)), "good", at)

    def test_packet_number_is_not_signed(self):
        self.assertEqual(self.verdict(b"LC02" + bytes(4) + self.datagram[8:]), "good")

    def test_every_cut_is_malformed(self):
        for size in range(len(self.datagram)):
            self.assertEqual(self.verdict(self.datagram[:size]), "malformed", size)
        self.assertEqual(self.verdict(self.datagram + b"\0"), "malformed")

    def test_what_is_not_for_us_is_told_apart(self):
        head = b"LC02" + bytes(4)
        other_rig = demo_command()
        negative = demo_command()
        negative.header.epoch = -1
        for verdict, datagram in {
            "foreign": b"LC03" + bytes(100),
            "malformed": b"LC01" + self.datagram[4:],
        }.items():
            self.assertEqual(self.verdict(datagram), verdict)
        self.assertEqual(self.verdict(head + b"LCM_SELF_TEST\0"), "foreign")
        self.assertEqual(self.verdict(head + b"\0" + bytes(20)), "malformed")
        self.assertEqual(self.verdict(head + b"A" * 64 + b"\0"), "malformed")
        self.assertEqual(self.verdict(self.datagram.replace(b"DEMO", b"DEMI")), "foreign")
        from_other = DatagramFormat("DEMO", 8, KEY).write("LIVE/COMMAND", other_rig)
        self.assertEqual(self.verdict(from_other), "other_rig")
        self.assertEqual(self.verdict(self.format.write("LIVE/COMMAND", negative)), "malformed")

    def test_another_key_or_none_is_not_authentic(self):
        self.assertEqual(self.verdict(self.datagram, key=bytes(32)), "unauthentic")
        self.assertEqual(self.verdict(self.datagram[:-32] + bytes(32)), "unauthentic")
        self.assertEqual(self.verdict(self.datagram[:-32] + bytes(32), key=None), "good")

    def test_signature_is_worth_nothing_on_another_channel(self):
        payload = self.datagram[self.datagram.index(b"\0", 8) + 1 :]
        self.assertNotEqual(
            signature(KEY, b"DEMO/LIVE/COMMAND", payload), signature(KEY, b"DEMO/REQUEST", payload)
        )


if __name__ == "__main__":
    unittest.main()
