"""What the figures were measured on."""

import os
import platform
import re
import subprocess
import sys
from datetime import datetime, timezone
from pathlib import Path

from .programs import BUILD, ROOT

PEERS = ("libmujoco-dev", "libdart-dev", "libsimbody-dev", "cyclonedds-dev", "libzmq3-dev",
         "liblcm-dev", "liblcm-bin", "rt-tests", "valgrind")
OURS = ("libsundials-dev", "libeigen3-dev")


def _said(*words):
    """First line that a command prints, or ""."""
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip().split("\n")[0] if done.returncode == 0 else ""


def _read(path):
    try:
        return Path(path).read_text(errors="replace").strip()
    except OSError:
        return ""


def _cpu_model():
    found = re.search(r"^model name\s*:\s*(.+)$", _read("/proc/cpuinfo"), re.MULTILINE)
    return found.group(1).strip() if found else platform.machine()


def _cached(name):
    """A variable of CMake's cache."""
    found = re.search(rf"^{name}:[A-Z]+=(.*)$", _read(BUILD / "CMakeCache.txt"), re.MULTILINE)
    return found.group(1) if found else ""


def _versions(packages):
    return {package: version for package in packages
            if (version := _said("dpkg-query", "-W", "-f", "${Version}", package))}


def _realtime():
    """Whether programs may ask for SCHED_FIFO here."""
    test = ("import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(80)); print('yes')")
    return _said(sys.executable, "-c", test) == "yes"


def running(prefix):
    """Programs whose names begin so, as "name (pid)"."""
    names = {}
    for process in Path("/proc").glob("[0-9]*"):
        words = _read(process / "cmdline").split("\0")
        name = Path(words[0]).name
        if name.startswith(prefix):
            names[int(process.name)] = name
    return [f"{name} ({pid})" for pid, name in sorted(names.items())]


def load_average():
    """Of the last minute."""
    return os.getloadavg()[0]


def facts():
    """By name; "" where the machine does not tell."""
    git = ("git", "-C", str(ROOT))
    virtual = [_said("systemd-detect-virt", kind) for kind in ("--vm", "--container")]
    return {
        "cpu": _cpu_model(),
        "cores": os.cpu_count(),
        "virtual": ", ".join(name for name in virtual if name not in ("", "none")),
        "kernel": platform.release(),
        "system": platform.freedesktop_os_release().get("PRETTY_NAME", ""),
        "governor": _read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"),
        "clock_source": _read("/sys/devices/system/clocksource/clocksource0/current_clocksource"),
        "realtime": _realtime(),
        "compiler": _said(_cached("CMAKE_CXX_COMPILER") or "c++", "--version"),
        "flags": " ".join(filter(None, (_cached("CMAKE_CXX_FLAGS_RELEASE"),
                                        _cached("CMAKE_CXX_FLAGS")))),
        "commit": _said(*git, "rev-parse", "HEAD"),
        "changed": bool(_said(*git, "status", "--porcelain", "--untracked-files=no")),
        "date": datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "packages": _versions(PEERS + OURS),
    }


def slug(cpu):
    """A CPU's name as part of a file's: "AMD EPYC 7B13 (64)" -> "amd-epyc-7b13-64"."""
    text = re.sub(r"\((R|TM|C)\)|\bCPU\b|\bProcessor\b|@.*$", " ", cpu, flags=re.IGNORECASE)
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:40] or "cpu"
