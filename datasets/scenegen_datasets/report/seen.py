"""Sections of the edge map and of the flow that can be had from the pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenegen_datasets.audits.edges import EdgeMap
from scenegen_datasets.audits.flow_quality import ORDERED, FlowQuality, FlowScore
from scenegen_datasets.audits.histogram import Histogram, even_edges, log_edges
from scenegen_datasets.pages.charts import LARGE, Bars, Curve, curves, histogram, key
from scenegen_datasets.pages.markup import Html, element
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.report.words import card, cards, note, plain, said


def edges(found: EdgeMap) -> Html:
    """The mean profile across silhouettes."""
    if not found.profile:
        return said(found.verdict)
    lines = [Curve("camera", found.places_px, found.profile, SERIES[0])]
    legend = [(SERIES[0], "what the camera reports")]
    if found.clean_profile:
        lines.append(Curve("radiance", found.places_px, found.clean_profile, SERIES[1]))
        legend.append((SERIES[1], "noise-free radiance, mean over the pixel"))
    reach = -found.places_px[0]
    chart = curves(
        lines,
        "pixels from the edge of depth; the near side is on the left",
        (-reach, reach),
        (-0.05, 1.05),
        up="share of the near side's heat",
    )
    rows = [
        ("pixels that touch a silhouette", f"{100 * found.silhouette_share:.1f} %"),
        ("pixels that mix near and far", f"{100 * (found.mixed_share or 0):.1f} %"),
        ("such pixels across one silhouette", f"{found.mixed_pixels or 0:.1f}"),
        ("width of the edge, 10 to 90 %", _px(found.width_px)),
        ("offset across upright edges", _px(found.offset_right_px)),
        ("offset across level edges", _px(found.offset_down_px)),
        ("silhouettes that were read", f"{found.edges:,}"),
    ]
    how = note(
        "Depth and ids come from the ray through a pixel's centre and jump from one pixel to the next; heat is "
        "gathered over the pixel and blurred by the lens. Read across silhouettes that stand alone and have 2 K of "
        "contrast."
    )
    return Html(
        said(found.verdict)
        + cards(
            card("Heat across a silhouette", key(legend), chart),
            card("In figures", table((Column(""), number("")), rows)),
            least_px=420,
        )
        + how
    )


def flow(found: FlowQuality) -> Html:
    """Estimators against the truth."""
    if not found.groups:
        return said(found.verdict)
    rows = [
        (
            group.estimator,
            group.frames,
            f"{group.count}",
            _px(group.error_px),
            _px(group.true_px),
            _two(group.order),
            _two(group.true_order),
            _two(group.heading),
            element(
                "span",
                f"{100 * group.inverted_share:.0f} %",
                class_="bad" if group.inverted_share > 0.1 else "good",
            ),
        )
        for group in found.groups
    ]
    columns = (
        Column("method", "name"),
        Column("frames", "name"),
        number("number"),
        number("error"),
        number("true length"),
        number("order"),
        number("order of the truth"),
        number("heading"),
        number("inverted"),
    )
    legend = key([(SERIES[k], name) for k, name in enumerate(found.scores)])
    how = note(
        "Medians over frames. Order is Spearman's correlation of the length of flow with 1/depth: near things should "
        "flow furthest. It falls below 0 where flow says near where it is far: such a frame is inverted, and so is one "
        "whose flow points backwards on the whole (heading, the mean cosine against the truth, below 0). Both methods "
        "see two frames under one gain, black and white at 1 and 99 %, with the parameters networks are trained with."
    )
    return Html(
        said(found.verdict)
        + table(columns, rows)
        + cards(
            card("Order of near and far, frames in which the truth shows it", legend, _orders(found.scores)),
            card("Error against the length of the true flow", legend, _errors(found.scores)),
            least_px=420,
        )
        + how
    )


def _orders(scores: dict[str, Sequence[FlowScore]] | object) -> Html:
    assert isinstance(scores, dict)
    drawn = []
    for k, (name, found) in enumerate(scores.items()):
        values = np.array([s.order for s in found if s.order is not None and (s.true_order or 0.0) > ORDERED])
        spread = Histogram.of(values, even_edges(-1.0, 1.0, 25))
        drawn.append(Bars(name, spread.edges, spread.counts, SERIES[k]))
    return histogram(
        drawn,
        "Spearman's correlation of the length of flow and 1/depth",
        mark=(0.0, "inverted below"),
        up="% of the frames",
        frame=LARGE,
    )


def _errors(scores: dict[str, Sequence[FlowScore]] | object) -> Html:
    assert isinstance(scores, dict)
    every = [score for found in scores.values() for score in found]
    across = _decades([score.true_px for score in every])
    up = _decades([score.error_px for score in every])
    lines = [
        Curve(
            name,
            [max(score.true_px, across[0]) for score in found],
            [max(score.error_px, up[0]) for score in found],
            SERIES[k],
            dots=True,
        )
        for k, (name, found) in enumerate(scores.items())
    ]
    return curves(
        lines,
        "median length of the true flow [px]",
        across,
        up,
        log_x=True,
        log_y=True,
        up="median error [px]",
    )


def _decades(values: Sequence[float]) -> tuple[float, float]:
    low, high = max(min(values), 1e-3), max(*values, 2e-3)
    return log_edges(low * 0.8, high * 1.25, 1)[0], log_edges(low * 0.8, high * 1.25, 1)[1]


def _px(value: float | None) -> str:
    return "–" if value is None else f"{plain(value, 2)}\u00a0px"


def _two(value: float | None) -> str:
    return "–" if value is None else plain(value, 2)
