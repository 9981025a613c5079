"""The one door to the renderer: finds a usable LLVM, loads Mitsuba and Dr.Jit, keeps the thread count safe.

Nothing else in the project imports ``mitsuba`` or ``drjit``. The door exists because the first import decides
everything: Dr.Jit reads ``DRJIT_LIBLLVM_PATH`` once, silently ignores later changes, and aborts the whole process (no
exception) when it compiles with LLVM 15 or 16, which is what Debian 12 ships.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import importlib.metadata
import os
import platform
import re
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, UInt32

from scenegen.foundation import cpu
from scenegen.foundation.errors import BackendError

OLDEST_LLVM = 17
_NEWEST_LLVM = 23
_WHEEL = "karellen-llvm-core"
LLVM_ADVICE = (
    "install one of LLVM 17 to 23 ('pip install karellen-llvm-core', 'apt install libllvm19' or 'brew install llvm')"
    " or point DRJIT_LIBLLVM_PATH to its libLLVM file"
)
_RENDER_PACKAGES = ("mitsuba", "drjit", "numpy", "opencv-python-headless", "OpenEXR")


@dataclass(frozen=True)
class Backend:
    """What renders here.

    Attributes
    ----------
    variant : str
        Mitsuba variant.
    llvm_path : str
        Library file Dr.Jit was pointed to; empty if Dr.Jit searched by itself or LLVM is not used.
    llvm_version : str
        ``"major.minor.patch"``; empty on CUDA.
    cpu_model : str
    cpu_class : str
        Instruction set level and vendor: the part of a CPU that can change floating-point bytes.
    threads : int
        Threads one launch uses.
    versions : tuple of (str, str)
        Package name and version, sorted by name; everything that can change a rendered or encoded byte.
    """

    variant: str
    llvm_path: str
    llvm_version: str
    cpu_model: str
    cpu_class: str
    threads: int
    versions: tuple[tuple[str, str], ...]

    def fingerprint(self) -> dict[str, str]:
        """What two machines must share for rendered bytes to be identical (paths, model and threads may differ)."""
        own = {"variant": self.variant, "llvm": self.llvm_version, "cpu_class": self.cpu_class}
        return {**own, **dict(self.versions)}


def modules() -> tuple[ModuleType, ModuleType]:
    """Return ``(mitsuba, drjit)`` with a variant set, ready for use.

    The CPU is used (``llvm_ad_mono``, one thread) unless :func:`use_cuda` was called before.

    Raises
    ------
    BackendError
        If no usable LLVM (or no CUDA device, when asked for) is found.
    """
    mi, dr, _ = _start(_Choice.variant)
    return mi, dr


def use_cuda() -> None:
    """Render on an NVIDIA GPU from now on; must be called before anything is rendered.

    Raises
    ------
    BackendError
        If the renderer was already started on the CPU.
    """
    if _start.cache_info().currsize and _Choice.variant != "cuda_ad_mono":
        raise BackendError(
            "the renderer already runs on the CPU; choose CUDA before the first frame of the process"
        )
    _Choice.variant = "cuda_ad_mono"


def set_threads(requested: int) -> int:
    """Set how many threads one launch may use and return the number in force.

    Never more than the CPU affinity allows: Embree corrupts the heap otherwise. Call before a world is loaded.
    """
    _, dr = modules()
    granted = max(1, min(requested, affinity()))
    dr.set_thread_count(granted)
    return granted


def upload(
    values: Float32[np.ndarray, "*shape"] | UInt32[np.ndarray, "*shape"] | Bool[np.ndarray, "*shape"],
) -> Any:
    """Copy an array to the device, flattened: float32 to `mitsuba.Float`, uint32 to `mitsuba.UInt`, bool to `Bool`.

    Always a copy: handed a numpy array, Dr.Jit would only map its memory, whose alignment differs from run to run,
    compile another kernel for each alignment, and read it element by element where it is not aligned.
    """
    mi, dr = modules()
    kind = {"f": mi.Float, "u": mi.UInt, "b": mi.Bool}[values.dtype.kind]
    return dr.opaque(kind(np.ascontiguousarray(values).reshape(-1)))


def affinity() -> int:
    """CPUs this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def describe() -> Backend:
    """Backend, CPU and versions of this process; starts the renderer if need be."""
    _, dr = modules()
    _, _, llvm_path = _start(_Choice.variant)
    on_cpu = _Choice.variant.startswith("llvm")
    return Backend(
        variant=_Choice.variant,
        llvm_path=llvm_path,
        llvm_version=".".join(map(str, dr.detail.llvm_version())) if on_cpu else "",
        cpu_model=cpu.described("model name", platform.processor() or platform.machine()),
        cpu_class=cpu_class(),
        threads=int(dr.thread_count()),
        versions=tuple((name, _version(name)) for name in sorted(_RENDER_PACKAGES)),
    )


def cpu_class() -> str:
    """Instruction set level and vendor, such as ``"x86_64-v4 AuthenticAMD"``.

    The vendor counts because approximate reciprocals (used inside Embree) differ between vendors at one level.
    """
    return f"{cpu.level()} {cpu.described('vendor_id', platform.system())}"


class _Choice:
    """The variant of this process; only `use_cuda` writes it, and only before the start."""

    variant = "llvm_ad_mono"


@cache
def _start(variant: str) -> tuple[ModuleType, ModuleType, str]:
    """Load both modules once; returns them and the LLVM file in use."""
    path = _point_to_llvm() if variant.startswith("llvm") else ""
    import drjit as dr

    dr.set_log_level(dr.LogLevel.Error)
    import mitsuba as mi

    mi.set_log_level(mi.LogLevel.Error)
    try:
        mi.set_variant(variant)
    except ImportError as error:
        advice = LLVM_ADVICE if path or variant.startswith("llvm") else "it needs an NVIDIA GPU and driver"
        raise BackendError(f"the renderer cannot start '{variant}' here; {advice}") from error
    if variant.startswith("llvm") and dr.detail.llvm_version()[0] < OLDEST_LLVM:
        found = ".".join(map(str, dr.detail.llvm_version()))
        raise BackendError(f"LLVM {found} is too old for the renderer; {LLVM_ADVICE}")
    dr.set_thread_count(1)
    return mi, dr, path


def _point_to_llvm() -> str:
    """Choose libLLVM and tell Dr.Jit by its environment variable; the user's own value wins."""
    own = os.environ.get("DRJIT_LIBLLVM_PATH", "")
    if own:
        if not Path(own).is_file():
            raise BackendError(f"DRJIT_LIBLLVM_PATH points to '{own}', which is not a file; {LLVM_ADVICE}")
        _loadable(Path(own))
        return own
    if "drjit" in sys.modules:
        return ""  # too late to choose: the version check after the start still protects us
    found = next((p for p in (_wheel_llvm(), *_system_llvms()) if p is not None and _loadable(p)), None)
    if found is None:
        return ""  # let Dr.Jit search (macOS, Windows, unusual systems)
    os.environ["DRJIT_LIBLLVM_PATH"] = str(found)
    return str(found)


def _wheel_llvm() -> Path | None:
    """Library inside the LLVM wheel, if that is installed."""
    files = _wheel_files()
    names = sorted(name for name in files if re.fullmatch(r"libLLVM\.so\.\d+\.\d+", name))
    return files[names[-1]] if names else None


@cache
def _wheel_files() -> dict[str, Path]:
    """Libraries of the LLVM wheel by file name."""
    try:
        listed = importlib.metadata.files(_WHEEL) or []
    except importlib.metadata.PackageNotFoundError:
        return {}
    libraries = {p.name: Path(str(p.locate())).resolve() for p in listed if ".so" in p.name}
    return {name: path for name, path in libraries.items() if path.is_file()}


def _system_llvms() -> list[Path]:
    """LLVM libraries of the system that are new enough, newest first."""
    roots = [
        Path(p) for p in ("/usr/lib", "/usr/lib64", "/usr/local/lib", "/lib", "/opt/homebrew/opt/llvm/lib")
    ]
    roots += sorted(Path("/usr/lib").glob("*-linux-gnu")) + sorted(Path("/usr/lib").glob("llvm-*/lib"))
    found: dict[int, Path] = {}
    for path in (p for root in roots if root.is_dir() for p in sorted(root.glob("libLLVM*.so*"))):
        version = re.search(r"libLLVM(?:-(\d+)\.so|\.so\.(\d+))", path.name)
        major = int(version[1] or version[2]) if version else 0
        if OLDEST_LLVM <= major <= _NEWEST_LLVM:
            found.setdefault(major, path)
    return [found[major] for major in sorted(found, reverse=True)]


def _loadable(library: Path) -> bool:
    """Whether the dynamic loader accepts the file, helping it to the wheel's own C++ runtime if that is missing."""
    try:
        ctypes.CDLL(str(library))
    except OSError:
        try:
            for name in ("libc++abi.so.1", "libc++.so.1"):
                if name in _wheel_files():
                    ctypes.CDLL(str(_wheel_files()[name]), mode=ctypes.RTLD_GLOBAL)
            ctypes.CDLL(str(library))
        except OSError:
            return False
    return True


def _version(package: str) -> str:
    """Installed version, or "absent"."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "absent"
