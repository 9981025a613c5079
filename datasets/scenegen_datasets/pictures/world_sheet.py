"""The sheet of one world: three views, each as heat, classes and objects; below, what was counted."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence

import numpy as np

from scenegen.classes import Semantic
from scenegen.foundation.words import counted
from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_datasets.census import ClassCount, count_classes, count_objects
from scenegen_datasets.pictures import colour, words
from scenegen_datasets.pictures.canvas import FAINT, Canvas
from scenegen_datasets.pictures.scales import Tone
from scenegen_datasets.pictures.views import VIEW_PX, View, photograph
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.stage import set_stage
from scenegen_datasets.stopwatch import Stopwatch

MARGIN_PX = 24
GAP_PX = 10
HEAD_PX = 122
BAR_PX = 22
LINE_PX = 20
LEGEND_COLUMNS = 4

_LIGHT = np.array([-0.35, -0.75, -0.56])
_AMBIENT = 0.62


def draw_world(recipe: Recipe, map: str, index: int) -> tuple[World, bytes]:
    """Build world `index` of a map as a dataset of this recipe would, and draw it.

    Returns
    -------
    world : World
    png : bytes
    """
    stage = set_stage(recipe, map, index, Stopwatch())
    state, views = photograph(stage, recipe, map, index)
    world = stage.world
    canvas = world_sheet(world, state, views, f"{map}   seed {recipe.seed}   world {index}")
    stage.release()
    file = io.BytesIO()
    canvas.image.save(file, "PNG", compress_level=6)
    return world, file.getvalue()


def world_sheet(world: World, state: ThermalState, views: Sequence[View], title: str) -> Canvas:
    """Lay the sheet out.

    Parameters
    ----------
    world : World
    state : ThermalState
        In which it was photographed.
    views : sequence of View
        One column each.
    title : str
        First line.
    """
    counts = count_classes(world)
    rows = math.ceil(len(counts) / LEGEND_COLUMNS)
    width = 2 * MARGIN_PX + len(views) * VIEW_PX + (len(views) - 1) * GAP_PX
    foot = HEAD_PX + 3 * VIEW_PX + BAR_PX + 2 * GAP_PX
    canvas = Canvas(width, foot + 40 + rows * LINE_PX + MARGIN_PX)
    end = canvas.text(MARGIN_PX, 38, title, 22)
    canvas.text(end + 18, 38, _weather(state), 13, FAINT)
    for k, line in enumerate(in_numbers(world)):
        canvas.text(MARGIN_PX, 62 + k * LINE_PX, line, 13, FAINT)
    for k, view in enumerate(views):
        _column(canvas, MARGIN_PX + k * (VIEW_PX + GAP_PX), view)
    _legend(canvas, foot + 30, width, counts)
    return canvas


def in_numbers(world: World) -> tuple[str, str]:
    """Two lines: triangles, sites, objects and classes; and what the map itself counts."""
    return (
        f"{len(world.mesh.faces):,} triangles   {len(world.sites.area):,} thermal sites   "
        f"{count_objects(world):,} objects   {len(count_classes(world))} classes",
        "   ".join(f"{name} {count:,}" for name, count in world.counts),  # right for one viaduct, too
    )


def _column(canvas: Canvas, x: int, view: View) -> None:
    end = canvas.text(x, HEAD_PX - 12, view.title, 15)
    canvas.text(end + 12, HEAD_PX - 12, view.caption, 12, FAINT)
    tone = Tone.of(view.shot)
    y = HEAD_PX
    canvas.picture(x, y, tone.picture(view.shot.counts))
    canvas.tone_bar(x, y + VIEW_PX + 4, VIEW_PX - 150, tone)
    what = "seen by the camera" if view.sees_air else "of the surfaces"
    canvas.text(x + VIEW_PX, y + VIEW_PX + 13, what, 11, FAINT, "rs")
    y += VIEW_PX + BAR_PX
    canvas.picture(x, y, shaded(colour.semantic(view.frame.semantic), view))
    canvas.picture(x, y + VIEW_PX + GAP_PX, shaded(colour.instance(view.frame.instance), view))


def shaded(picture: colour.Picture, view: View) -> colour.Picture:
    """Darken faces that look away from a light behind the viewer's left shoulder, so that ids show shape."""
    normal = view.frame.normal
    assert normal is not None
    lit = np.clip(normal @ (_LIGHT / np.linalg.norm(_LIGHT)), 0.0, 1.0)
    share = np.where(view.frame.instance > 0, _AMBIENT + (1.0 - _AMBIENT) * lit, 1.0)
    return np.asarray(np.rint(picture * share[..., None]), np.uint8)


def _legend(canvas: Canvas, y: int, width: int, counts: Sequence[ClassCount]) -> None:
    rows = math.ceil(len(counts) / LEGEND_COLUMNS)
    pitch = (width - 2 * MARGIN_PX) // LEGEND_COLUMNS
    for k, count in enumerate(counts):
        column, row = divmod(k, rows)
        x, line = MARGIN_PX + column * pitch, y + row * LINE_PX
        fill = count.kind.colour if count.kind.id != Semantic.SKY else colour.SKY_COLOUR
        canvas.swatch(x, line - 11, 12, fill)
        end = canvas.text(x + 20, line, count.kind.name.replace("_", " "), 13)
        said = f"{count.triangles:,} triangles"
        if count.kind.thing:
            said = f"{counted(count.objects, 'object')}, {said}"
        canvas.text(end + 10, line, said, 11, FAINT)


def _weather(state: ThermalState) -> str:
    return "   ".join(
        (
            words.time_of_day(state.hour),
            words.date(state.season.month, state.season.day),
            words.latitude(state.season.latitude_deg),
            words.sky(state.weather.cloud_fraction),
            words.wind(state.weather.wind_mps),
            f"air {words.celsius(state.atmosphere.air_K)}",
        )
    )
