"""``evaluation.html``: an evaluation on one page that needs no other file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from scenegen.foundation.canonical import pretty
from scenegen_datasets.pages.charts import LARGE, Bars, Curve, curves, histogram, key
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element, folded, join, picture
from scenegen_datasets.pages.sheet import FAINT, SERIES
from scenegen_datasets.pages.tables import Column, number, table
from scenegen_datasets.pictures import colour
from scenegen_datasets.report.depth_bar import SHEET as DEPTH_SHEET
from scenegen_datasets.report.depth_bar import css, depth_bar
from scenegen_datasets.report.media import webp
from scenegen_datasets.report.words import card, cards
from scenegen_trainers.evaluation import words
from scenegen_trainers.evaluation.answers import Answer
from scenegen_trainers.evaluation.evaluate import NETWORK, Evaluation, Judged
from scenegen_trainers.evaluation.judge import PAINTED, WHOLE
from scenegen_trainers.evaluation.pictures import (
    COLUMNS,
    NEAR_M,
    RIGHT,
    TOO_FAR,
    TOO_NEAR,
    WORST_RATIO,
    tiles,
)
from scenegen_trainers.evaluation.scores import HEADS, head_of

Shown = Sequence[tuple[Judged, Answer]]
"""Images with what the network answered."""

SHEET = """
.answer{margin:18px 0 0}
.answer .head{font-size:13px;margin:0 0 6px;color:var(--faint);max-width:none;overflow-wrap:anywhere}
.answer b{color:var(--ink);font-weight:600;margin-right:10px}
.tiles{display:grid;grid-template-columns:repeat(4,minmax(0,1fr));gap:8px;max-width:1080px}
.tiles img{width:100%;image-rendering:pixelated}
.tiles .small{display:block;margin-top:4px;font-size:12px}
td .small{font-weight:400}
@media(max-width:760px){.tiles{grid-template-columns:repeat(2,minmax(0,1fr))}}
@media print{.answer{break-inside:avoid}.tiles{grid-template-columns:repeat(4,minmax(0,1fr))}}
"""

_CLASS = {"better": "good", "worse": "bad", "open": "faint"}


def page(evaluation: Evaluation, best: Shown, worst: Shown) -> str:
    """The page as HTML.

    Parameters
    ----------
    evaluation : Evaluation
    best, worst : sequence of (Judged, Answer)
        Images to show.
    """
    cap_m = evaluation.valid.furthest_m
    return document(
        words.title(evaluation),
        element("h1", words.title(evaluation)),
        element("p", words.about(evaluation), class_="lead"),
        *(element("p", said, class_="bad") for said in words.warnings(evaluation)),
        cards(*_figures(evaluation), least_px=300),
        element("p", words.note(evaluation), class_="small"),
        element("h2", "Answers by true depth"),
        _charts(evaluation),
        element("h2", "In every way of counting, beside trivial answers"),
        _answers(evaluation),
        *_strata(evaluation),
        element("h2", "Best answers"),
        element("p", words.shown(evaluation), class_="small"),
        _scales(cap_m),
        *(_answer(*shown, cap_m) for shown in best),
        element("h2", "Worst answers"),
        *(_answer(*shown, cap_m) for shown in worst),
        element("h2", "How the network came to be"),
        folded("record of its training", element("pre", pretty(dict(evaluation.record)).decode())),
        sheet=DEPTH_SHEET + SHEET,
    )


def _figures(evaluation: Evaluation) -> Iterator[Html]:
    """A card for each score that is told, held against the trivial answer that is hardest to beat."""
    for name in words.TOLD:
        parts = [_figure(evaluation, stratum, name) for stratum in (WHOLE, PAINTED)]
        said = [element("p", what, class_="small") for what in ("sky left out", "sky as cap")]
        yield card(head_of(name), said[0], parts[0], said[1], parts[1])


def _figure(evaluation: Evaluation, stratum: str, name: str) -> Html:
    span = words.interval_words(evaluation.network[stratum].interval[name], name)
    return join(
        [
            element("div", words.value_of(evaluation.network, stratum, name), class_="figure"),
            element("div", f"95 %: {span}", class_="small"),
            _against(evaluation, stratum, name),
        ]
    )


def _against(evaluation: Evaluation, stratum: str, name: str) -> Html:
    """What the hardest trivial answer scores there, and whether the network is better."""
    rival = words.rival_of(evaluation, stratum)
    if rival is None:
        return Html("")
    theirs = words.value_of(evaluation.baselines[rival], stratum, name)
    margin = evaluation.margins[rival][stratum][name]
    verdict = words.verdict(margin)
    lead = f"better by {words.interval_words(margin, name)} (95 %)"
    said = f"{words.AGAINST[verdict]} {rival} {theirs}"
    return element("div", said, class_=f"small {_CLASS[verdict]}", title=lead)


def _charts(evaluation: Evaluation) -> Html:
    far = evaluation.valid.furthest_m
    near = max(evaluation.valid.nearest_m, 0.9 * min(evaluation.trends[NETWORK].truth_m))
    lines = [Curve("what is right", (near, far), (near, far), FAINT)]
    named_lines = [(FAINT, "what is right")]
    for (name, trend), ink in zip(evaluation.trends.items(), SERIES, strict=False):
        if name == NETWORK:
            lines.append(Curve(name, trend.truth_m, trend.median_m, ink, trend.low_m, trend.high_m))
            named_lines.append((ink, "network, median and 10 to 90 % of pixels"))
        elif name == words.rival_of(evaluation, WHOLE):
            lines.append(Curve(name, trend.truth_m, trend.median_m, ink))
            named_lines.append((ink, f"{name}, median"))
    drawn = curves(lines, "true depth [m]", (near, far), (near, far), log_x=True, log_y=True, up="answer [m]")
    return cards(
        card("What is answered to pixels of one true depth", key(named_lines), drawn),
        card("Images by their Rel", _spread(evaluation)),
        least_px=460,
    )


def _spread(evaluation: Evaluation) -> Html:
    """How different images are: their Rel."""
    found = [image.scores.rel for image in evaluation.images]
    edges = np.geomspace(min(found) * 0.98, max(found) * 1.02, 25)
    counts = np.histogram(found, edges)[0]
    bars = Bars("images", edges.tolist(), counts.tolist())
    middle = float(np.median(found))
    mark = (middle, f"median {middle:.2f}")
    return histogram([bars], "Rel of an image", log=True, mark=mark, up="% of the images", frame=LARGE)


def _answers(evaluation: Evaluation) -> Html:
    columns = (Column("counted"), Column("answer", "name"), *map(number, HEADS), number("pixels"))
    return table(columns, words.answer_rows(evaluation))


def _strata(evaluation: Evaluation) -> Iterator[Html]:
    columns = (Column("", "name"), number("pixels"), *(number(head_of(name)) for name in words.TOLD))
    for heading, names in words.families(evaluation):
        yield element("h2", heading)
        yield table(columns, [_stratum(evaluation, name, said) for name, said in names.items()])


def _stratum(evaluation: Evaluation, name: str, said: str) -> list[object]:
    standing = evaluation.network[name]
    share = words.pixels(evaluation, name) / words.pixels(evaluation, WHOLE)
    cells = [
        join(
            [
                element("b", words.value_of(evaluation.network, name, score)),
                element("span", f" {words.interval_words(standing.interval[score], score)}", class_="small"),
                _against(evaluation, name, score),
            ]
        )
        for score in words.TOLD
    ]
    return [
        said,
        f"{100.0 * share:.1f} %" if share >= 5e-4 else f"{words.pixels(evaluation, name):,}",
        *cells,
    ]


def _answer(judged: Judged, answer: Answer, cap_m: float) -> Html:
    scores = judged.scores
    head = element(
        "p",
        element("b", judged.key),
        f"RMSE {scores.rmse_m:.1f} m · Rel {scores.rel:.2f} · δ1 {scores.delta[0]:.2f}",
        class_="head",
    )
    drawn = []
    for name, tile in zip(COLUMNS, tiles(answer, cap_m), strict=True):
        high, wide = tile.shape[:2]
        image = picture(webp(tile, exact=True), "webp", f"{name} of {judged.key}", wide, high)
        drawn.append(element("div", image, element("span", name, class_="small")))
    return element("div", head, element("div", *drawn, class_="tiles"), class_="answer")


def _scales(cap_m: float) -> Html:
    """What the colours of depth and error mean."""
    said = (
        (TOO_NEAR, f"{WORST_RATIO:g} times too near"),
        (RIGHT, "right"),
        (TOO_FAR, f"{WORST_RATIO:g} times too far"),
        (colour.SKY_COLOUR, "sky, or beyond the cap"),
    )
    inks = key([(css(ink), what) for ink, what in said])
    return element("div", depth_bar(NEAR_M, cap_m), inks, class_="scales")
