"""Pages: what goes in is escaped, what comes out is whole, and charts put values where they belong."""

from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest

from scenegen_datasets.pages.axes import Frame, Scale, even_ticks, log_ticks, tick_words
from scenegen_datasets.pages.charts import (
    Bars,
    Curve,
    curves,
    histogram,
    interval_bar,
    key,
    share_bar,
    stacked_bar,
)
from scenegen_datasets.pages.document import document
from scenegen_datasets.pages.markup import Html, element, folded, join, picture, text
from scenegen_datasets.pages.tables import Column, number, table

EVIL = "<script>alert('x')</script>"


class Tags(HTMLParser):
    """Checks that what is opened is closed."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_words_are_escaped_and_markup_is_not() -> None:
    assert "<script>" not in text(EVIL)
    assert text(Html("<b>x</b>")) == "<b>x</b>"
    assert join(["a<b", Html("<i>c</i>")]) == "a&lt;b<i>c</i>"
    assert element("p", EVIL, class_='"x') == f'<p class="&quot;x">{text(EVIL)}</p>'


@pytest.mark.parametrize(
    "piece",
    [
        table([EVIL, Column(EVIL, EVIL)], [[EVIL, EVIL]]),
        histogram([Bars(EVIL, (0.0, 1.0), (1,)), Bars(EVIL, (0.0, 1.0), (1,))], EVIL, mark=(0.5, EVIL)),
        curves([Curve(EVIL, (0.0, 1.0), (0.0, 1.0))], EVIL, (0.0, 1.0), (0.0, 1.0), unit=EVIL),
        stacked_bar([(0.5, "red", EVIL)]),
        key([("red", EVIL)]),
        folded(EVIL, EVIL),
        picture(b"x", "webp", EVIL, 1, 1),
    ],
)
def test_nothing_a_dataset_says_can_break_a_page(piece: Html) -> None:
    assert "<script>" not in piece
    page = document(EVIL, piece)
    tags = Tags()
    tags.feed(page)
    assert not tags.open and "<script>" not in page


def test_columns_carry_their_kind() -> None:
    drawn = ElementTree.fromstring(table(["a", number("b")], [["x", 3]]))
    assert [cell.get("class") for cell in drawn.iter("td")] == [None, "number"]


def test_heads_say_what_they_head_and_bars_need_none() -> None:
    (head,) = ElementTree.fromstring(table(["a", Column("", "wide")], [["x", "y"]])).iter("thead")
    assert [(cell.tag, cell.get("scope")) for cell in head[0]] == [("th", "col"), ("td", None)]
    assert "<thead>" not in table(["", number("")], [["x", 3]])


def test_a_table_with_a_short_row_is_refused() -> None:
    with pytest.raises(ValueError, match="zip"):
        table(["a", "b"], [["x"]])


def test_ticks_are_round_and_inside() -> None:
    assert even_ticks(0.0, 24.0, 6) == [0.0, 5.0, 10.0, 15.0, 20.0]
    assert even_ticks(-60.0, 65.0, 5) == [-50.0, 0.0, 50.0]
    assert log_ticks(3.0, 2500.0) == [10.0, 100.0, 1000.0]
    assert log_ticks(3.0, 30.0) == [5.0, 10.0, 20.0]
    assert [tick_words(x, True) for x in (1e-6, 0.01, 20.0, 10_000.0)] == ["10⁻⁶", "0.01", "20", "10,000"]


def test_scales_are_linear_and_logarithmic() -> None:
    even, log = Scale(10.0, 1000.0, 0.0, 200.0), Scale(10.0, 1000.0, 0.0, 200.0, log=True)
    assert (even(10.0), even(505.0), even(1000.0)) == (0.0, 100.0, 200.0)
    assert log(100.0) == pytest.approx(100.0)
    assert even(2000.0) == 200.0  # what lies outside stays at the end


def test_bars_are_as_high_as_their_share() -> None:
    chart = histogram([Bars("", (0.0, 1.0, 2.0, 3.0), (1, 3, 0))], "x")
    bars = [float(e.get("height", 0)) for e in ElementTree.fromstring(chart).iter("rect")]
    assert len(bars) == 2 and bars[1] == pytest.approx(3 * bars[0], rel=0.01)


def test_curves_go_through_their_points() -> None:
    frame = Frame(300, 200, 40, 10, 10, 40)
    chart = curves([Curve("a", (0.0, 2.0), (0.0, 50.0))], "x", (0.0, 2.0), (0.0, 100.0), frame=frame)
    (way,) = [e.get("d") for e in ElementTree.fromstring(chart).iter("path") if e.get("class") == "line"]
    assert way == "M40.0 160.0L290.0 85.0"


def test_shares_side_by_side_are_told_to_those_who_cannot_see_them() -> None:
    bar = ElementTree.fromstring(
        stacked_bar([(0.75, "red", "hit: 3"), (0.25, "blue", "far: 1"), (0, "", "lost: 0")])
    )
    assert bar.get("role") == "img" and bar.get("aria-label") == "hit: 3; far: 1"


def test_shares_stay_on_their_track() -> None:
    full = ElementTree.fromstring(share_bar(7.0))
    assert [e.get("width") for e in full.iter("rect")] == ["300", "300.0"]
    interval = ElementTree.fromstring(interval_bar(0.5, 0.4, 0.7))
    assert [e.get("width") for e in interval.iter("rect")] == ["300", "150.0", "90.0"]
