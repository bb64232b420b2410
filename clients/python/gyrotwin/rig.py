"""A rig file, as far as a client needs it: who the rig is, its network and its key."""

from __future__ import annotations

import functools
import os
import re
import shutil
import stat
from pathlib import Path
from typing import Any, Iterator, Optional, Union

from .errors import Error

try:
    import tomllib
except ImportError:  # before Python 3.11
    tomllib = None  # type: ignore[assignment]


class Rig:
    """One rig, read from its file. deploy/rigs/README.md lists every key."""

    name: str  # rig.name
    id: int  # rig.id, in every message
    prefix: str  # network.prefix, of the channel names
    group: str  # network.group, IPv4 multicast
    port: int  # network.port, UDP
    interface: str  # network.interface
    ttl: int  # network.ttl; 0: this host only
    sign: bool  # network.sign
    file: Path
    table: dict[str, Any]  # the whole file; keys have their units in their names

    def __init__(self, name_or_path: Union[str, Path, None] = None):
        """name_or_path: a shipped rig by its bare name, or a file by its path, with a / or ending
        in .toml; None: $GYROTWIN_RIG, else prototype_b.

        Raises Error when there is no such rig, or its file lacks what a client needs.
        """
        if tomllib is None:
            raise Error("a rig file needs Python 3.11 (tomllib) or newer; reading logs does not")
        self.file = _find(str(name_or_path or os.environ.get("GYROTWIN_RIG") or "prototype_b"))
        try:
            self.table = tomllib.loads(self.file.read_text("utf-8"))
        except OSError as error:
            raise Error(f"{self.file}: cannot be read: {error.strerror}") from None
        except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise Error(f"{self.file}: is not TOML: {error}") from None
        self.name = self._need("rig.name", str)
        self.id = self._need("rig.id", int)
        self.prefix = self._need("network.prefix", str)
        self.group = self._need("network.group", str)
        self.port = self._need("network.port", int)
        self.interface = self._need("network.interface", str)
        self.ttl = self._need("network.ttl", int)
        self.sign = self._need("network.sign", bool)
        if re.fullmatch("[A-Z0-9_]{1,31}", self.prefix) is None:
            raise Error(
                f"{self.file}: network.prefix is `{self.prefix}`; expected A-Z 0-9 _, at most 31"
            )
        if not self.sign and self.ttl != 0:
            raise Error(
                f"{self.file}: an unsigned rig must stay on this host: set network.sign = true, or "
                "network.ttl = 0"
            )

    @functools.cached_property
    def key(self) -> Optional[bytes]:
        """The rig's key, 32 bytes; None on an unsigned rig. Raises Error without a key to read."""
        return load_key(key_path(self.name)) if self.sign else None

    @property
    def reference_impulse_nms(self) -> float:
        """The rig's reference push about x [N m s]."""
        return float(self._need("disturbance.reference_impulse_nms", (int, float)))

    @property
    def impulse_duration_s(self) -> float:
        """How long the reference push takes [s]."""
        return float(self._need("disturbance.impulse_duration_s", (int, float)))

    def __repr__(self) -> str:
        return f"<Rig {self.name}, id {self.id}, {self.interface} {self.group}:{self.port}>"

    def _need(self, path: str, kind: Any) -> Any:
        table, key = path.split(".")
        section = self.table.get(table)
        value = section.get(key) if isinstance(section, dict) else None
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            kinds = kind if isinstance(kind, tuple) else (kind,)
            expected = " or ".join(one.__name__ for one in kinds)
            raise Error(f"{self.file}: {path} is {value!r}; expected {expected}")
        return value


def _find(name_or_path: str) -> Path:
    if "/" in name_or_path or name_or_path.endswith(".toml"):
        return Path(name_or_path)
    folder = rig_folder()
    own = _host_rigs(folder) / f"{name_or_path}.toml"
    if own.is_file():
        return own
    file = folder / f"{name_or_path}.toml"
    if not file.is_file():
        names = ", ".join(sorted(rig.stem for rig in folder.glob("*.toml")))
        raise Error(
            f"no shipped rig is called `{name_or_path}`: there are {names} (a file of your own is "
            "given by its path, with a / or ending in .toml)"
        )
    return file


def _host_rigs(folder: Path) -> Path:
    """Where a host has its own rigs, which come before those of an installation in `folder`."""
    if os.environ.get("GYROTWIN_RIGS") or folder.parts[-3:] != ("share", "gyrotwin", "rigs"):
        return Path(os.devnull)
    prefix = folder.parents[2]
    return (Path("/etc") if prefix == Path("/usr") else prefix / "etc") / "gyrotwin/rigs"


def rig_folder() -> Path:
    """Folder of the shipped rigs: $GYROTWIN_RIGS, or that of the tree in which this package, or the
    `gyrotwin` on the PATH, was built or installed. Raises Error where there is none."""
    named = os.environ.get("GYROTWIN_RIGS")
    if named:
        if Path(named).is_dir():
            return Path(named)
        raise Error(f"GYROTWIN_RIGS names `{named}`, which is no folder; correct it, or unset it")
    for folder in _surroundings():
        for rigs in (folder / "share/gyrotwin/rigs", folder / "deploy/rigs"):
            if rigs.is_dir():
                return rigs
    raise Error("no folder of shipped rigs is found; set GYROTWIN_RIGS to the folder of the files")


def _surroundings() -> Iterator[Path]:
    yield from Path(__file__).resolve().parents
    program = shutil.which("gyrotwin")
    if program:
        yield from Path(program).resolve().parents


def key_path(rig_name: str) -> Path:
    """Where the key of a rig is looked for."""
    file = f"{rig_name}.key"
    if os.environ.get("GYROTWIN_KEYS"):
        return Path(os.environ["GYROTWIN_KEYS"]) / file
    if os.environ.get("XDG_CONFIG_HOME"):
        return Path(os.environ["XDG_CONFIG_HOME"]) / "gyrotwin" / file
    return Path.home() / ".config" / "gyrotwin" / file


def load_key(path: Path) -> bytes:
    """A key of 32 bytes. Raises Error where there is none, or where others may read it."""
    make_it = f"`gyrotwin key new --rig {path.stem}`"
    try:
        # What is no regular file must not make it wait.
        with open(os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK), "rb") as file:
            mode = os.fstat(file.fileno()).st_mode
            if not stat.S_ISREG(mode):
                raise Error(f"{path}: expected a regular file")
            if mode & (stat.S_IRWXG | stat.S_IRWXO):
                raise Error(
                    f"{path}: others than its owner have access to this key; if nobody copied it: "
                    f"`chmod 600 {path}`, otherwise remove it and {make_it}"
                )
            content = file.read(66)
    except OSError as error:
        fix = f"; make one with {make_it}" if isinstance(error, FileNotFoundError) else ""
        raise Error(f"{path}: no key to read: {error.strerror}{fix}") from None
    if re.fullmatch(rb"[0-9a-fA-F]{64}\n", content) is None:
        raise Error(f"{path}: expected 64 hex digits and a newline; remove it and {make_it}")
    return bytes.fromhex(content.decode("ascii"))
