"""The report of a dataset: pictures, flights, audits, provenance and cost on one page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from scenegen.foundation.atomic import make_directories, write_atomic
from scenegen.foundation.words import counted, size
from scenegen_datasets.audits.run import QUESTIONS, Audits, Watch, audit
from scenegen_datasets.info import DatasetInfo, info
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element
from scenegen_datasets.report import depth_bar, drawn, gallery, judged, origin, seen, words
from scenegen_datasets.report.selection import select
from scenegen_datasets.source import open_source
from scenegen_datasets.store import read_lock

REPORT = "preview/report.html"
"""Where it goes unless one says otherwise; nothing below ``preview`` belongs to the data."""

_SECTIONS = ("moments", "flights", *QUESTIONS, "provenance", "cost")


@dataclass(frozen=True)
class Report:
    """A report that was written.

    Attributes
    ----------
    path : Path
    bytes : int
    audits : Audits
    """

    path: Path
    bytes: int
    audits: Audits


def write_report(root: Path, out: Path | None = None, watch: Watch | None = None) -> Report:
    """Write the report of a dataset, finished or growing; the same bytes for the same dataset.

    Parameters
    ----------
    root : Path
    out : Path, optional
        The file; by default ``preview/report.html`` in the dataset.
    watch : callable, optional
        Told how many of the audited steps are done and how many there are.

    Raises
    ------
    InputError
        If there is no dataset, nothing in it yet, or the file cannot be written.
    """
    path = out or root / REPORT
    open_source(root, allow_partial=True)  # nothing is made for what is no dataset
    make_directories(path.parent.parent, path.parent.name)
    page, audits = compose(root, watch)
    data = page.encode()
    write_atomic(path, data)
    return Report(path, len(data), audits)


def compose(root: Path, watch: Watch | None = None) -> tuple[str, Audits]:
    """The page as HTML, and the audits it is made from."""
    source = open_source(root, allow_partial=True)
    audits = audit(root, source, watch)
    chosen, found, lock = select(root, source), info(root), read_lock(root)
    bodies = {
        "draws": drawn.drawn(audits.draws),
        "contents": drawn.contents(audits.contents, lock["recipe"]),
        "leak": judged.leak(audits.leak),
        "labels": judged.labels(audits.labels),
        "edges": seen.edges(audits.edges),
        "flow": seen.flow(audits.flow),
    }
    sections = [words.section(name, question, bodies[name]) for name, question in QUESTIONS.items()]
    page = document(
        f"{found.name} {found.version}".strip(),
        _head(found, lock["recipe"], audits),
        _contents(),
        words.section("moments", "Moments", gallery.moments(chosen)),
        words.section("flights", "Flights", gallery.flights(chosen)),
        *sections,
        words.section("provenance", "Where it comes from", origin.provenance(found, lock)),
        words.section("cost", "What it cost", origin.cost(origin.read_log(root))),
        sheet=words.SHEET + depth_bar.SHEET + gallery.SHEET,
    )
    return page, audits


def _contents() -> Html:
    """Links to all sections; stays in sight."""
    return element(
        "nav",
        *(element("a", name.capitalize(), href=f"#{name}") for name in _SECTIONS),
        aria_label="sections",
    )


def _head(found: DatasetInfo, recipe: dict[str, object], audits: Audits) -> Html:
    camera = recipe["camera"]
    assert isinstance(camera, dict)
    maps = recipe["map"]
    assert isinstance(maps, list | tuple)
    splits = ", ".join(f"{count:,} {name}" for name, count in found.splits.items() if count)
    flights, worlds = counted(found.clips, "flight"), counted(found.worlds, "world")
    lead = (
        f"{counted(found.pairs, 'pair')} of thermal and depth ({splits}) in {flights} through {worlds}: "
        f"{', '.join(map(str, maps))}. {camera['width_px']} × {camera['height_px']} px, "
        f"{camera['hfov_deg']:g}° wide, {size(found.bytes)}."
    )
    state = "" if found.complete else " It is not complete."
    looked_at = f"{counted(audits.steps, 'step')} of {counted(audits.clips, 'flight')}"
    judged_by = f"Audits look at {looked_at}, always the same ones."
    links = [
        element(
            "a",
            words.sign(verdict),
            element("span", element("small", QUESTIONS[name]), verdict.headline),
            href=f"#{name}",
        )
        for name, verdict in audits.verdicts.items()
    ]
    return Html(
        element("h1", f"{found.name} {found.version}".strip())
        + element("p", words.tied(lead + state), class_="lead")
        + element("div", *links, class_="strip")
        + element("p", judged_by, class_="small")
    )
