"""How the page looks: its style, its captions, and what the browser does without asking the server."""

from __future__ import annotations

from scenegen_datasets.pages.markup import Html, element, join
from scenegen_datasets.view.panels import Panel

STYLE = """
:root { color-scheme: dark }
body { background: #14171c; color: #d8dde4 }
.nicegui-content { padding: 12px 16px }
.stage { display: grid; grid-template-columns: minmax(0, 1fr); gap: 14px 20px; width: 100% }
@media (min-width: 1100px) { .stage { grid-template-columns: minmax(0, 1.35fr) minmax(360px, 1fr) } }
.pictures { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 6px 12px; align-content: start }
.pictures > div { min-width: 0 }
.picture { width: 100%; cursor: crosshair }
.picture img { image-rendering: pixelated; width: 100% }
.side { display: flex; flex-direction: column; gap: 12px; min-width: 0 }
.numbers { display: grid; grid-template-columns: repeat(2, max-content minmax(0, 1fr)); gap: 2px 14px; font-size: 14px;
  min-height: 9.6em; align-content: start; background: #1a1f27; border-radius: 8px; padding: 12px 14px }
.numbers .all { grid-column: 1 / -1 }
.number { font-variant-numeric: tabular-nums; font-family: ui-monospace, monospace; white-space: nowrap }
.space { width: 100% !important; height: clamp(320px, 52vh, 620px) !important; border-radius: 8px; overflow: hidden }
.space canvas { border-radius: 8px }
.caption { font-size: 12px; color: #9aa4b1; line-height: 1.45; min-height: 2.9em }
.caption .ramp { display: flex; gap: 6px; align-items: center; white-space: nowrap; color: #c3cbd5 }
.caption .ramp i { flex: 1; height: 8px; border-radius: 2px; box-shadow: inset 0 0 0 1px #ffffff22 }
.caption .key span { display: inline-block; margin-right: 10px; white-space: nowrap }
.caption .key i { display: inline-block; width: 9px; height: 9px; border-radius: 2px; margin-right: 4px }
.fault { background: #5b1f1f; color: #ffd9d6; border-radius: 8px; padding: 10px 14px; width: 100% }
@media (max-width: 640px) {
  .nicegui-content { padding: 8px }
  .numbers { grid-template-columns: max-content minmax(0, 1fr); min-height: 18em }
  .caption { font-size: 11px }
}
"""

KEYS = "← → frame · space play · n p clip"
"""Of the keyboard."""

STAY = """<script>
document.addEventListener('keydown', event => {
  if (event.key === ' ' && event.target === document.body) event.preventDefault();
});
</script>"""
"""The space bar plays; it does not scroll the page as well."""


def caption(panel: Panel) -> Html:
    """What the colours of a panel mean, as markup."""
    parts = []
    if panel.ramp is not None:
        bar = element("i", style=f"background:{panel.ramp.css}")
        parts.append(element("div", panel.ramp.low, bar, panel.ramp.high, class_="ramp"))
    if panel.key:
        swatches = (
            element("span", element("i", style=f"background:rgb({r},{g},{b})"), name)
            for (r, g, b), name in panel.key
        )
        parts.append(element("div", *swatches, class_="key"))
    else:
        parts.append(element("div", panel.caption))
    return element("div", join(parts), class_="caption")
