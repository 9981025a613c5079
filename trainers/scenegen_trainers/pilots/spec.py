"""What the word after ``--pilot`` means: a name, the file of a network, or ``module:attribute``."""

from __future__ import annotations

import importlib
import inspect
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from scenegen.foundation.canonical import digest
from scenegen.foundation.errors import InputError, nearest
from scenegen_datasets.manifest import file_sha256
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.pilot import Pilot
from scenegen_flythrough.loop.pilots import ConstantDepth, DepthPilot, DepthSource, TrueDepth
from scenegen_flythrough.planners.registry import planner, plugged_in
from scenegen_render.camera import Camera
from scenegen_trainers.campaign.names import slug
from scenegen_trainers.pilots.box import BoxedSource

BUILT_IN = {"oracle": TrueDepth, "blind": ConstantDepth}
"""Pilots by name: sources of depth that need no file."""

TORCH_ENDINGS, ONNX_ENDING = (".pt", ".pth"), ".onnx"


@dataclass(frozen=True)
class PilotSpec:
    """A pilot as plain data.

    Attributes
    ----------
    kind : "name", "file" or "module"
    word : str
        Name, absolute path or ``module:attribute``.
    planner : str
        Of `scenegen_flythrough.planners.registry`, or ``module:attribute``. A plug-in that flies by itself has none.
    sha256 : str
        Of the file, or of the sources of plug-ins; empty for names.
    """

    kind: Literal["name", "file", "module"]
    word: str
    planner: str
    sha256: str = ""

    @property
    def name(self) -> str:
        """What people call it: name, file stem or attribute."""
        if self.kind == "name":
            return self.word
        return Path(self.word).stem if self.kind == "file" else self.word.rpartition(":")[2]

    @property
    def slug(self) -> str:
        """Its directory in a campaign. Another file of the same name is another pilot."""
        identity = {k: v for k, v in asdict(self).items() if k != "word" or self.kind == "module"}
        mark = f"+{digest(identity)[:8]}" if self.sha256 else ""
        return slug(f"{self.name[:60]}+{self.planner[:40]}") + mark

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def parse_pilot(word: str, planner_name: str) -> PilotSpec:
    """Understand what a user wrote.

    Parameters
    ----------
    word : str
    planner_name : str

    Raises
    ------
    InputError
        If it is no pilot: names the nearest right thing.
    """
    planner_hash = _source_hash(planner_name, "planner") if ":" in planner_name else ""
    if word in BUILT_IN:
        return PilotSpec("name", word, planner_name, planner_hash)
    path = Path(word)
    if path.suffix.lower() in (*TORCH_ENDINGS, ONNX_ENDING):
        if not path.is_file():
            raise InputError(f"--pilot {word}: no such file")
        return PilotSpec("file", str(path.resolve()), planner_name, _sha256(path) + planner_hash)
    if ":" in word:
        return PilotSpec("module", word, planner_name, _source_hash(word, "pilot") + planner_hash)
    if path.exists():
        raise InputError(f"--pilot {word}: a network is a file that ends in .pt, .pth or .onnx")
    raise InputError(
        f"--pilot {word}: unknown pilot{nearest(word, BUILT_IN)}; or give a .pt or .onnx file, or module:attribute"
    )


def raise_pilot(spec: PilotSpec, loop: LoopKnobs, camera: Camera, *, boxed: bool = False) -> Pilot:
    """Build a pilot, ready to be told of flights.

    Parameters
    ----------
    spec : PilotSpec
    loop : LoopKnobs
    camera : Camera
        Whose frames it will be shown.
    boxed : bool
        Keep a source of depth that is not ours in a process of its own; see `scenegen_trainers.pilots.box`.

    Raises
    ------
    InputError
        If its file or module does not hold what it should.
    """
    if spec.kind == "module":
        made = _made(spec.word)
        if hasattr(made, "act"):
            flier: Pilot = _checked(made, spec.word, ("name", "needs", "begin", "act"))
            return flier
    source = raise_source(spec, camera)
    if boxed and spec.kind != "name":
        source = BoxedSource(source.name, frozenset(source.needs), spec.to_json(), camera)
    return DepthPilot(source, planner(spec.planner, loop))


def raise_source(spec: PilotSpec, camera: Camera) -> DepthSource:
    """Build the source of depth of a pilot that has one.

    Raises
    ------
    InputError
        If its file or module does not hold what it should.
    """
    if spec.kind == "module":
        source: DepthSource = _checked(_made(spec.word), spec.word, ("name", "needs", "estimate"))
        return source
    if spec.kind == "file":
        return _network(Path(spec.word), camera)
    built_in: DepthSource = BUILT_IN[spec.word]()
    return built_in


def _network(path: Path, camera: Camera) -> DepthSource:
    if path.suffix.lower() == ONNX_ENDING:
        from scenegen_trainers.pilots.onnx import OnnxDepth

        return OnnxDepth(path, camera)
    from scenegen_trainers.pilots.checkpoint import TorchDepth

    return TorchDepth(path, camera)


def _made(word: str) -> Any:
    """What a plug-in returns when it is called."""
    factory = plugged_in(word, "pilot")
    try:
        return factory()
    except Exception as error:  # foreign code: whatever it raises is its author's to know
        raise InputError(f"pilot '{word}': calling it raised {type(error).__name__}: {error}") from None


def _checked(made: Any, word: str, parts: tuple[str, ...]) -> Any:
    missing = [part for part in parts if not hasattr(made, part)]
    if missing:
        raise InputError(
            f"pilot '{word}' is a {type(made).__name__} without {', '.join(missing)}; "
            "a pilot has name, needs, begin, act, a source of depth name, needs, estimate"
        )
    return made


def _sha256(path: Path) -> str:
    try:
        return file_sha256(path)
    except OSError as error:
        raise InputError(f"--pilot {path}: cannot be read: {error.strerror}") from None


def _source_hash(word: str, what: str) -> str:
    """SHA-256 of the module's source, so that flights of an edited plug-in are not mixed with those before."""
    plugged_in(word, what)
    source = inspect.getsourcefile(importlib.import_module(word.partition(":")[0]))
    return _sha256(Path(source)) if source is not None else ""
