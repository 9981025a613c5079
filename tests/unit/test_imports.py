"""What an import costs: each door opens only the rooms it needs. Probed in fresh interpreters."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def loaded_by(statement: str) -> set[str]:
    """Top-level packages outside the standard library that a fresh interpreter loads for a statement."""
    code = (
        "import json, sys\nbefore = set(sys.modules)\n"
        f"{statement}\n"
        "tops = {name.partition('.')[0] for name in set(sys.modules) - before}\n"
        "print(json.dumps(sorted(tops - set(sys.stdlib_module_names))), file=sys.__stdout__)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, cwd=ROOT / "tests"
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.strip().splitlines()[-1]))


def test_reading_a_dataset_needs_numpy_only() -> None:
    assert loaded_by("import scenegen_datasets") <= {"numpy", "scenegen", "scenegen_datasets"}


def test_importing_every_room_below_the_renderer_leaves_the_renderer_alone() -> None:
    heavy = {"mitsuba", "drjit", "torch"}
    rooms = (
        "scenegen.world",
        "scenegen_render.camera",
        "scenegen_flythrough.fly",
        "scenegen_trainers.metrics",
    )
    assert not loaded_by("import " + ", ".join(rooms)) & heavy
    assert "pydantic" in loaded_by(
        "import scenegen_flythrough.knobs"
    )  # the probe does see third-party packages


def loaded_by_command(*arguments: str) -> set[str]:
    call = f"from scenegen_cli.main import main\ntry:\n    main({list(arguments)!r})\nexcept SystemExit:\n    pass"
    return loaded_by(call)


def test_help_loads_nothing_but_the_front_door_and_its_foundation() -> None:
    assert loaded_by_command("--help") == {"scenegen", "scenegen_cli"}


@pytest.mark.parametrize("command", ["render", "fly", "maps", "demo", "verify", "info"])
def test_help_of_a_command_waits_for_no_renderer_and_no_geometry(command: str) -> None:
    heavy = {"mitsuba", "drjit", "torch", "pvlib", "scipy", "shapely", "trimesh", "cv2"}
    assert not loaded_by_command(command, "--help") & heavy
