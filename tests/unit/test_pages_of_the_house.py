"""What the pages promise: every link leads somewhere, and every command they show has the flags they give it."""

from __future__ import annotations

import importlib
import re
from dataclasses import is_dataclass
from functools import cache
from pathlib import Path

import pytest

from scenegen_cli.main import COMMANDS
from scenegen_cli.parameters import parameters
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.resolve import leaves
from scenegen_trainers.campaign.recipe import flight_keys
from scenegen_trainers.training.recipe import TrainingRecipe

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "benchmarks").glob("*.md")])
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
COMMAND = re.compile(rf"(?<![\w/.-])scenegen ({'|'.join(COMMANDS)})((?: +[^\s`\"'#|&;)]+)*)")
FLAG = re.compile(r"--[A-Za-z][\w-]*(?:\.[\w-]+)*")


def anchors(page: str) -> set[str]:
    """What can stand behind the # of a link to a page, as GitHub makes it of headings."""
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in HEADING.findall(page)}


@cache
def recipe_flags() -> frozenset[str]:
    keys = (*leaves(Recipe), *flight_keys(), *leaves(TrainingRecipe))
    return frozenset(f"--{key.replace('_', '-')}" for key, _, _ in keys)


@cache
def flags_of(command: str) -> frozenset[str]:
    module = importlib.import_module(f"scenegen_cli.{command}")
    own = [kind for kind in vars(module).values() if getattr(kind, "__module__", "") == module.__name__]
    kinds = [kind for kind in own if isinstance(kind, type) and is_dataclass(kind)]
    return frozenset(one.label.partition(" ")[0] for kind in kinds for one in parameters(kind)) | {"--help"}


def test_pages_are_read() -> None:
    assert {"README.md", "ARCHITECTURE.md", "campaigns.md", "0001-six-source-roots.md"} <= {
        p.name for p in PAGES
    }


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for link in LINK.findall(page.read_text("utf-8")):
        path, _, anchor = link.partition("#")
        if "://" in link:
            continue
        target = page.parent / path if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target.read_text("utf-8")), link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_commands_have_the_flags_they_are_shown_with(page: Path) -> None:
    for command, words in COMMAND.findall(page.read_text("utf-8").replace("\\\n", " ")):
        unknown = set(FLAG.findall(words)) - flags_of(command) - recipe_flags()
        assert not unknown, f"scenegen {command}{words}"


def test_a_wrong_flag_would_be_seen() -> None:
    ((command, words),) = COMMAND.findall("`scenegen render --map city --pears 8`")
    assert set(FLAG.findall(words)) - flags_of(command) - recipe_flags() == {"--pears"}
