"""The rules of the house as tests: who may import whom, no hidden randomness, no clock, no pickle, small modules.

Every rule reads the syntax trees of all modules and names file and line. Every rule is also shown a few bad lines, so
that none of them can pass by finding nothing.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ROOMS = {
    "scenegen": "scenegen",
    "scenegen_render": "render",
    "scenegen_flythrough": "flythrough",
    "scenegen_datasets": "datasets",
    "scenegen_trainers": "trainers",
    "scenegen_cli": "cli",
}
"""Packages and their folders, from the ground up: each may import itself and what stands before it."""

LONGEST_MODULE = 350
WALL_CLOCK_ALLOWED = {"scenegen_datasets.run_log"}
"""Modules that may know what time it is: the log of a run, which stands outside everything that is hashed."""

TORCH_ADAPTERS = 1
"""Modules of `scenegen_datasets` that may import torch."""


@dataclass(frozen=True)
class Module:
    """One source file: dotted name, path for messages, text and syntax tree."""

    name: str
    path: str
    text: str

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text, self.path)

    @property
    def room(self) -> str:
        return self.name.partition(".")[0]


Finding = tuple[int, str]
Rule = Callable[[Module], Iterator[Finding]]


@cache
def modules() -> tuple[Module, ...]:
    """All modules of all rooms, in a fixed order."""
    found = []
    for room, folder in ROOMS.items():
        for path in sorted((ROOT / folder / room).rglob("*.py")):
            parts = path.relative_to(ROOT / folder).with_suffix("").parts
            name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            found.append(Module(name, str(path.relative_to(ROOT)), path.read_text("utf-8")))
    return tuple(found)


def imports(module: Module) -> Iterator[Finding]:
    """Every imported dotted name; what is imported from a module counts as a part of it. Lazy imports count too."""
    package = module.name if module.path.endswith("__init__.py") else module.name.rpartition(".")[0]
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = ".".join(
                    [*package.split(".")[: len(package.split(".")) - node.level + 1], base]
                ).rstrip(".")
            yield from ((node.lineno, f"{base}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            yield from ((node.lineno, str(a.value)) for a in node.args[:1] if isinstance(a, ast.Constant))


def uses(module: Module) -> Iterator[tuple[ast.AST, int, str]]:
    """Every name and attribute chain that is read, with the aliases of the module's imports resolved."""
    tree = module.tree
    known: dict[str, str] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            known |= {
                a.asname or a.name.partition(".")[0]: a.name if a.asname else a.name.partition(".")[0]
                for a in node.names
            }
        elif isinstance(node, ast.ImportFrom) and node.module:
            known |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute | ast.Name):
            root, *rest = ast.unparse(node).split(".")
            yield node, node.lineno, ".".join([known.get(root, root), *rest])


def below(name: str, *tops: str) -> bool:
    return any(name == top or name.startswith(top + ".") for top in tops)


def _is_false(node: ast.expr | None) -> bool:
    return isinstance(node, ast.Constant) and node.value is False


def arrows_go_down_only(module: Module) -> Iterator[Finding]:
    order = list(ROOMS)
    for line, name in imports(module):
        target = name.partition(".")[0]
        if target in ROOMS and order.index(target) > order.index(module.room):
            yield line, f"{module.room} stands below {target} and may not import it"
        if (
            below(module.name, "scenegen.foundation")
            and target in ROOMS
            and not below(name, "scenegen.foundation")
        ):
            yield line, f"the foundation imports nothing of ours, not {name}"


def the_renderer_stays_behind_its_door(module: Module) -> Iterator[Finding]:
    for line, name in imports(module):
        if below(name, "mitsuba", "drjit") and module.room != "scenegen_render":
            yield line, f"{name} is imported only in scenegen_render"


def the_sensor_knows_no_renderer(module: Module) -> Iterator[Finding]:
    if below(module.name, "scenegen_render.sensor"):
        for line, name in imports(module):
            if below(
                name,
                "mitsuba",
                "drjit",
                "scenegen_render.backend",
                "scenegen_render.scene",
                "scenegen_render.trace",
            ):
                yield line, f"the sensor is numpy only and may not import {name}"


def torch_stays_with_the_trainers(module: Module) -> Iterator[Finding]:
    for line, name in imports(module):
        if below(name, "torch") and module.room not in ("scenegen_trainers", "scenegen_datasets"):
            yield line, "torch is imported only in scenegen_trainers and one adapter of scenegen_datasets"


def randomness_is_passed_in(module: Module) -> Iterator[Finding]:
    for line, name in imports(module):
        if below(name, "random", "secrets", "uuid"):
            yield line, f"{name} draws from hidden state; take a numpy Generator as an argument"
    for _, line, name in uses(module):
        last = name.rpartition(".")[2]
        if below(name, "numpy.random") and name != "numpy.random" and not last[0].isupper():
            yield line, f"{name}: generators come from scenegen.foundation.rng.stream or from the caller"
        if name in ("os.urandom", "os.getrandom"):
            yield line, f"{name} differs from run to run"


def nothing_asks_for_the_time(module: Module) -> Iterator[Finding]:
    clocks = (
        "time.time",
        "time.time_ns",
        "time.localtime",
        "time.gmtime",
        "time.ctime",
        "time.strftime",
        "time.asctime",
    )
    dates = ("datetime.now", "datetime.utcnow", "datetime.today", "date.today")
    if module.name not in WALL_CLOCK_ALLOWED:
        for _, line, name in uses(module):
            if name in clocks or (below(name, "datetime") and name.endswith(dates)):
                yield line, f"{name}: what reaches data may not depend on when it was made"


def nothing_is_pickled(module: Module) -> Iterator[Finding]:
    for line, name in imports(module):
        if below(name, "pickle", "cPickle", "dill", "cloudpickle", "marshal", "shelve", "joblib"):
            yield line, f"{name} runs code from files; write arrays and JSON"
    for node in ast.walk(module.tree):
        if isinstance(node, ast.keyword) and node.arg == "allow_pickle" and not _is_false(node.value):
            yield node.value.lineno, "allow_pickle runs code from files"


def scenes_are_loaded_as_described(module: Module) -> Iterator[Finding]:
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in (
            "load_dict",
            "load_file",
            "load_string",
        ):
            given = {k.arg: k.value for k in node.keywords}
            if not _is_false(given.get("optimize")):
                yield node.lineno, "without optimize=False shapes are merged in the order of their addresses"


def only_the_front_door_prints(module: Module) -> Iterator[Finding]:
    if module.room != "scenegen_cli":
        for node in ast.walk(module.tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                yield node.lineno, "print belongs to scenegen_cli; return the value or raise"


def modules_stay_small(module: Module) -> Iterator[Finding]:
    lines = module.text.count("\n")
    if lines > LONGEST_MODULE:
        yield lines, f"{lines} lines; more than {LONGEST_MODULE} are two ideas, give each its file"


RULES: dict[Rule, tuple[str, str, tuple[int, ...]]] = {
    arrows_go_down_only: (
        "scenegen.foundation.bad",
        "import scenegen.world\nimport numpy\nfrom scenegen_render import camera\n"
        "from ..foundation import rng\nfrom .. import world\n",
        (1, 3, 5),
    ),
    the_renderer_stays_behind_its_door: (
        "scenegen_datasets.bad",
        "def f():\n    import drjit as dr\n    from mitsuba import Thread\n"
        "    importlib.import_module('mitsuba')\nimport mitsubashi\n",
        (2, 3, 4),
    ),
    the_sensor_knows_no_renderer: (
        "scenegen_render.sensor.bad",
        "from scenegen_render.backend import Backend\nfrom scenegen_render.camera import Camera\nimport drjit\n",
        (1, 3),
    ),
    torch_stays_with_the_trainers: (
        "scenegen_flythrough.bad",
        "import torch\nfrom torch.nn import Module\nimport torchlike\n",
        (1, 2),
    ),
    randomness_is_passed_in: (
        "scenegen.bad",
        "import random\nimport numpy as np\nx = np.random.normal()\ny = np.random.Generator(np.random.PCG64(3))\n"
        "from numpy.random import default_rng as make\nz = make()\nfrom uuid import uuid4\nimport os\nos.urandom(3)\n"
        "from numpy import random as r\nr.seed(4)\n",
        (1, 3, 6, 7, 9, 11),
    ),
    nothing_asks_for_the_time: (
        "scenegen.bad",
        "import time\nimport datetime\nfrom datetime import datetime as dt\na = time.time()\nb = time.monotonic()\n"
        "c = datetime.datetime.now(datetime.UTC)\nd = dt.now()\ne = datetime.date(2021, 1, 1)\n"
        "f = datetime.date.today()\n",
        (4, 6, 7, 9),
    ),
    nothing_is_pickled: (
        "scenegen.bad",
        "import pickle\nfrom joblib import dump\nnp.load('x', allow_pickle=True)\nnp.load('x', allow_pickle=False)\n",
        (1, 2, 3),
    ),
    scenes_are_loaded_as_described: (
        "scenegen_render.bad",
        "mi.load_dict(d)\nmi.load_dict(d, optimize=False)\nload_dict(d, optimize=True)\nmi.load_file('x')\n",
        (1, 3, 4),
    ),
    only_the_front_door_prints: ("scenegen.bad", "print('x')\nx.print('y')\n", (1,)),
    modules_stay_small: ("scenegen.bad", "\n" * (LONGEST_MODULE + 1), (LONGEST_MODULE + 1,)),
}
"""Each rule with a bad module and the lines it must point at, no more and no fewer."""


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_rule_holds_everywhere(rule: Rule) -> None:
    broken = [f"{m.path}:{line}: {what}" for m in modules() for line, what in sorted(set(rule(m)))]
    assert not broken, "\n" + "\n".join(broken)


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_rule_sees_what_is_bad(rule: Rule) -> None:
    name, text, lines = RULES[rule]
    found = {line for line, _ in rule(Module(name, name.replace(".", "/") + ".py", text))}
    assert found == set(lines)


def test_all_rooms_are_read() -> None:
    names = {module.name for module in modules()}
    for room in ROOMS:
        assert room in names
    assert {"scenegen.foundation.rng", "scenegen_render.camera", "scenegen_flythrough.trajectory"} <= names
    assert not [str(p) for folder in ROOMS.values() for p in (ROOT / folder).glob("*.py")], (
        "no module beside a package"
    )


def test_torch_has_one_adapter_in_datasets() -> None:
    adapters = {
        m.path for m in modules() if m.room == "scenegen_datasets" for _, n in imports(m) if below(n, "torch")
    }
    assert len(adapters) <= TORCH_ADAPTERS, sorted(adapters)


def test_exceptions_to_the_clock_rule_exist_and_need_it() -> None:
    """An allowance nobody uses is a hole in the fence."""
    known = {module.name: module for module in modules()}
    for name in sorted(WALL_CLOCK_ALLOWED):
        twin = Module(name + "_", known[name].path, known[name].text)
        assert list(nothing_asks_for_the_time(twin)), (
            f"{name} no longer asks for the time; take it off the list"
        )
