"""Sections of the depth-leak audit and of label consistency."""

from __future__ import annotations

from scenegen_datasets.audits.histogram import Histogram, Spread
from scenegen_datasets.audits.labels import FLOW_BAR_PX, LabelConsistency
from scenegen_datasets.audits.leak import DepthLeak
from scenegen_datasets.pages.charts import LARGE, Curve, curves, histogram, key, share_bar
from scenegen_datasets.pages.markup import Html, element, folded
from scenegen_datasets.pages.sheet import SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.report.words import bars, card, cards, figures, note, plain, said

_REGRESSORS = (
    ("one_pixel", "counts of the pixel, any curve"),
    ("one_pixel_grey", "its grey level in the frame, any curve"),
    ("linear", "both, and mean and roughness around it, a plane"),
    ("row", "row of the pixel, any curve"),
    ("row_and_grey", "row and grey level, any function"),
)


def leak(found: DepthLeak) -> Html:
    """What simple guesses explain, and depth by grey level."""
    if found.explained is None or found.lookup is None or found.information is None:
        return said(found.verdict)
    rows = []
    for name, what in _REGRESSORS:
        score = getattr(found.explained, name)
        colour = SERIES[5] if name.startswith("row") else SERIES[0]
        rows.append((what, plain(score, 2), share_bar(score, colour)))
    guesses = table((Column("guess from"), number("R²"), Column("", "wide")), rows)
    curve, told = found.lookup, found.information
    line = Curve("depth by grey level", curve.grey, curve.mean_m, SERIES[0], curve.low_m, curve.high_m)
    span = (min(curve.low_m) * 0.8, max(curve.high_m) * 1.25)
    chart = curves(
        [line], "grey level in its frame, 0 black, 1 white", (0.0, 1.0), span, log_y=True, up="depth [m]"
    )
    information = table(
        (Column("knowing"), number("tells of depth"), number("another picture")),
        [
            ("grey level", _bit(told.grey), _bit(told.grey_unrelated)),
            ("row", _bit(told.row), _bit(told.row_unrelated)),
            ("grey level in a known row", _bit(told.grey_given_row), _bit(told.grey_given_row_unrelated)),
        ],
    )
    kept = f"{found.groups} {found.held_out}, each judged by fits that never saw it"
    how = note(
        f"{found.samples:,} pixels of {kept}. R² is the share of the scatter of log depth that is explained: 1 is a "
        "look-up table, 0 no better than one depth for all, below 0 worse. The line is the mean over all worlds, the "
        "band holds 68 % of the depths: a steep line with a thin band would be a leak. Of information, 5 bit would be "
        "everything; it is measured within the same worlds, so it counts as well what holds in one world only. What "
        "grey levels and rows of another picture seem to tell is chance: only what exceeds it says anything."
    )
    return Html(
        said(found.verdict)
        + cards(
            card("What simple guesses explain", guesses, element("h3", "Mutual information"), information),
            card("Depth by grey level", key([(SERIES[0], "mean, and 68 % of the pixels")]), chart, how),
            least_px=460,
        )
    )


def _bit(value: float) -> str:
    return f"{value:.2f}\u00a0bit"


def labels(found: LabelConsistency) -> Html:
    """Residuals of the four tests."""
    if found.flow_histogram is None or found.warped_histogram is None or found.still_histogram is None:
        return said(found.verdict)
    rows = [
        ("flow by depth and poses, what stands still", *figures(found.flow_px, unit=" px")),
        ("flow by poses, sky", *figures(found.sky_px, unit=" px")),
        ("depth by depth and poses", *_percents(found.depth_share)),
        ("flow forth and back", *figures(found.cycle_px, unit=" px")),
        ("brightness read where the flow points", *figures(found.warped_mK, unit=" mK")),
        ("the same, free of noise", *figures(found.clean_mK, unit=" mK")),
        ("brightness at the same pixel", *figures(found.still_mK, unit=" mK")),
        ("what the camera's noise alone would make", f"{found.noise_mK:.3g}\u00a0mK", "–", "–", "–"),
    ]
    columns = (Column("difference"), number("median"), number("95 %"), number("99 %"), number("pixels"))
    flow = histogram(
        [bars(found.flow_histogram)],
        "stored flow against depth and poses [px]",
        log=True,
        mark=(FLOW_BAR_PX, f"a fault beyond {FLOW_BAR_PX:g}\u00a0px"),
        up="% of the pixels",
        frame=LARGE,
    )
    heat = curves(
        [_below(found.still_histogram, SERIES[1]), _below(found.warped_histogram, SERIES[0])],
        "difference to the next frame [mK]",
        (found.still_histogram.edges[0], found.still_histogram.edges[-1]),
        (0.0, 100.0),
        log_x=True,
        up="% of the pixels",
    )
    words = key([(SERIES[0], "read where the flow points"), (SERIES[1], "read at the same pixel")])
    how = folded(
        "what was compared",
        note(
            "Surfaces that may move of themselves (vehicles, boats, people, plants) are left out where poses predict. "
            "Depth, forth and back, and brightness are read between pixels and therefore only where the neighbours "
            "show one surface. Brightness keeps the camera's noise, its lag and what is seen mirrored."
        ),
    )
    return Html(
        said(found.verdict)
        + table(columns, [row for row in rows if row[4] != "0"])
        + cards(
            card("Flow: how far off", key([(SERIES[0], "surfaces that stand still")]), flow),
            card("Brightness: pixels that differ by less", words, heat),
            least_px=420,
        )
        + how
    )


def _percents(spread: Spread) -> tuple[str, str, str, str]:
    shares = (spread.low, spread.median, spread.high, spread.top)
    low, median, high, top = (None if share is None else 100.0 * share for share in shares)
    return figures(Spread(low, median, high, top, spread.count), unit=" %")


def _below(found: Histogram, colour: str) -> Curve:
    """Share of the values [%] below each edge."""
    total, so_far, shares = sum(found.counts) or 1, 0, [0.0]
    for count in found.counts:
        so_far += count
        shares.append(100.0 * so_far / total)
    return Curve("", found.edges, shares, colour)
