"""Rig files and keys: found as the daemons find them, and refused with a fix."""

import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import gyrotwin
from gyrotwin.rig import key_path, load_key

RIGS = Path(__file__).resolve().parents[2] / "deploy/rigs"
HEX = bytes(range(32)).hex()


@unittest.skipIf(sys.version_info < (3, 11), "tomllib")
class RigTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        given = {"GYROTWIN_KEYS": folder.name, "GYROTWIN_RIGS": str(RIGS)}
        environment = mock.patch.dict(os.environ, given)
        environment.start()
        self.addCleanup(environment.stop)
        os.environ.pop("GYROTWIN_RIG", None)

    def put_key(self, content, mode=0o600):
        file = self.folder / "double_brennan.key"
        file.write_text(content)
        file.chmod(mode)

    def changed(self, old, new):
        text = (RIGS / "double_brennan.toml").read_text()
        self.assertIn(old, text)
        file = self.folder / "mine.toml"
        file.write_text(text.replace(old, new))
        return file

    def test_every_shipped_rig_is_read(self):
        names = sorted(file.stem for file in RIGS.glob("*.toml"))
        self.assertIn("prototype_b", names)
        for name in names:
            rig = gyrotwin.Rig(name)
            self.assertEqual(rig.name, name)
            self.assertGreater(rig.impulse_duration_s, 0.0)

    def test_the_default_is_that_of_the_programs(self):
        self.assertEqual(gyrotwin.Rig().name, "prototype_b")
        os.environ["GYROTWIN_RIG"] = "double_brennan"
        rig = gyrotwin.Rig()
        self.assertEqual((rig.name, rig.id, rig.prefix), ("double_brennan", 3, "DOUBLE_BRENNAN"))
        self.assertEqual((rig.group, rig.port), ("239.255.71.3", 7673))
        self.assertEqual(rig.reference_impulse_nms, 1.5)

    def test_shipped_rigs_are_found_beside_the_program_on_the_path(self):
        del os.environ["GYROTWIN_RIGS"]
        program = self.folder / "bin/gyrotwin"
        program.parent.mkdir()
        program.write_text("")
        program.chmod(0o755)
        rigs = self.folder / "share/gyrotwin/rigs"
        rigs.mkdir(parents=True)
        self.changed("double_brennan", "installed").rename(rigs / "installed.toml")
        with mock.patch("gyrotwin.rig.__file__", "/nowhere/gyrotwin/rig.py"):
            with mock.patch.dict(os.environ, {"PATH": str(program.parent)}):
                self.assertEqual(gyrotwin.Rig("installed").name, "installed")
                own = self.folder / "etc/gyrotwin/rigs"
                own.mkdir(parents=True)
                self.changed("double_brennan", "own").rename(own / "installed.toml")
                self.assertEqual(gyrotwin.Rig("installed").name, "own")
            with mock.patch.dict(os.environ, {"PATH": "/nowhere"}):
                with self.assertRaisesRegex(gyrotwin.Error, "set GYROTWIN_RIGS"):
                    gyrotwin.Rig("installed")

    def test_what_is_wrong_is_named(self):
        for make, told in [
            (lambda: "no_such", "no shipped rig is called `no_such`: there are brennan_monorail"),
            (lambda: "./no_such.toml", "cannot be read: No such file"),
            (lambda: self.changed("[network]", "[network"), "is not TOML"),
            (lambda: self.changed("port = 7673", 'port = "7673"'), "network.port is '7673'"),
            (lambda: self.changed("port = 7673", "port = true"), "network.port is True"),
            (lambda: self.changed('prefix = "D', 'prefix = "d'), "expected A-Z"),
            (lambda: self.changed("sign = true", ""), "network.sign is None"),
            (lambda: self.changed("ttl = 0\nsign = true", "ttl = 1\nsign = false"), "must stay"),
        ]:
            with self.subTest(told), self.assertRaisesRegex(gyrotwin.Error, told):
                gyrotwin.Rig(make())

    def test_a_key_is_read_and_only_where_its_owner_alone_may(self):
        rig = gyrotwin.Rig("double_brennan")
        with self.assertRaisesRegex(gyrotwin.Error, "make one with `gyrotwin key new --rig double"):
            rig.key
        self.put_key(HEX + "\n", 0o640)
        with self.assertRaisesRegex(gyrotwin.Error, "chmod 600"):
            rig.key
        self.put_key(HEX + "\n")
        self.assertEqual(rig.key, bytes(range(32)))
        for wrong in (HEX, HEX + "\n\n", HEX[:-1] + "x\n", ""):
            self.put_key(wrong)
            with self.assertRaisesRegex(gyrotwin.Error, "expected 64 hex digits"):
                load_key(key_path("double_brennan"))

    def test_a_pipe_is_no_key_and_does_not_block(self):
        os.mkfifo(self.folder / "double_brennan.key", 0o600)
        with self.assertRaisesRegex(gyrotwin.Error, "expected a regular file"):
            load_key(key_path("double_brennan"))

    def test_keys_are_looked_for_where_the_programs_do(self):
        with mock.patch.dict(os.environ, {"XDG_CONFIG_HOME": "/x", "HOME": "/h"}):
            self.assertEqual(key_path("r"), self.folder / "r.key")
            del os.environ["GYROTWIN_KEYS"]
            self.assertEqual(key_path("r"), Path("/x/gyrotwin/r.key"))
            del os.environ["XDG_CONFIG_HOME"]
            self.assertEqual(key_path("r"), Path("/h/.config/gyrotwin/r.key"))

    def test_an_unsigned_rig_needs_no_key(self):
        self.assertIsNone(gyrotwin.Rig(self.changed("sign = true", "sign = false")).key)


@unittest.skipIf(sys.version_info >= (3, 11), "has tomllib")
class OldPython(unittest.TestCase):
    def test_says_what_a_rig_file_needs(self):
        with self.assertRaisesRegex(gyrotwin.Error, "needs Python 3.11"):
            gyrotwin.Rig("double_brennan")


if __name__ == "__main__":
    unittest.main()
