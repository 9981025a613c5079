"""The page: choose a clip, scrub its frames, read numbers under the cursor, turn the scene in space.

One `Page` per open browser tab; it holds what that tab shows and nothing of the others.
"""

from __future__ import annotations

from typing import Any

from nicegui import ui

from scenegen.materials.table import materials
from scenegen_datasets.job import SPLITS
from scenegen_datasets.view.gallery import Gallery, Tone
from scenegen_datasets.view.library import Clip, Still
from scenegen_datasets.view.panels import GAINS, PALETTES
from scenegen_datasets.view.readout import readout
from scenegen_datasets.view.space import Space

_FIRST_SHOWN = ("thermal", "depth", "semantic", "flow")
_PLAY_INTERVAL_S = 0.12
_STYLE = """
:root { color-scheme: dark }
body { background: #14171c; color: #d8dde4 }
.picture img { image-rendering: pixelated; width: 100% }
.picture { width: 100%; cursor: crosshair }
.number { font-variant-numeric: tabular-nums; font-family: ui-monospace, monospace }
"""


class Page:
    """What one tab shows.

    Parameters
    ----------
    gallery : Gallery
    """

    def __init__(self, gallery: Gallery) -> None:
        self._gallery, self._library = gallery, gallery.library
        self._materials = {m.id: m.name for m in materials().values()}
        self._shown = [name for name in _FIRST_SHOWN if name in gallery.layers]
        self._tone = Tone()
        self._clip: Clip = self._library.clips[0]
        self._pixel: tuple[int, int] | None = None
        self._pictures: list[Any] = []
        self._captions: list[Any] = []
        self._build()
        self._choose_clip(self._clip)

    def _build(self) -> None:
        ui.add_css(_STYLE)
        ui.dark_mode(True)
        with ui.column().classes("w-full max-w-screen-2xl mx-auto gap-2"):
            with ui.row().classes("w-full items-baseline justify-between"):
                ui.label(self._library.root.name).classes("text-xl font-semibold").mark("name")
                self._words = ui.label().classes("text-sm opacity-80").mark("words")
            self._build_choices()
            self._build_scrubber()
            with ui.row().classes("w-full no-wrap items-start gap-4"):
                with ui.grid(columns=2).classes("grow gap-3"):
                    for slot in range(len(self._shown)):
                        self._build_panel(slot)
                self._numbers = ui.grid(columns="auto 1fr").classes("w-64 shrink-0 gap-x-3 gap-y-1 text-sm")
            self._space = Space()
        ui.keyboard(on_key=self._on_key)
        self._clock = ui.timer(_PLAY_INTERVAL_S, self._step, active=False)

    def _build_choices(self) -> None:
        clips = self._library.clips
        splits = [s for s in SPLITS if any(c.split == s for c in clips)]
        with ui.row().classes("items-center gap-4"):
            self._split = ui.select(
                ["all", *splits], value="all", label="split", on_change=self._list_clips
            ).classes("w-28")
            maps = sorted({c.map for c in clips})
            self._map = ui.select(
                ["all", *maps], value="all", label="map", on_change=self._list_clips
            ).classes("w-40")
            self._listed = ui.select(
                self._listing(),
                value=self._clip.position,
                label="clip",
                with_input=True,
                on_change=lambda e: self._choose_clip(clips[e.value]),
            ).classes("w-72")
            ui.select(
                dict(GAINS), value=self._tone.gain, label="thermal gain", on_change=self._set_gain
            ).classes("w-80")
            ui.select(
                list(PALETTES), value=self._tone.palette, label="palette", on_change=self._set_palette
            ).classes("w-32")

    def _build_scrubber(self) -> None:
        with ui.row().classes("w-full items-center no-wrap gap-3"):
            self._play = ui.button(icon="play_arrow", on_click=self._toggle).props("flat round").mark("play")
            self._frame = ui.slider(min=0, max=1, value=0, on_change=self._show).classes("grow").mark("frame")
            self._where = ui.label().classes("number w-64 text-right text-sm")

    def _build_panel(self, slot: int) -> None:
        with ui.column().classes("gap-1 w-full"):
            ui.select(
                list(self._gallery.layers),
                value=self._shown[slot],
                on_change=lambda e: self._set_layer(slot, e.value),
            ).props("dense borderless")
            picture = ui.interactive_image(events=["mousemove"], on_mouse=self._on_mouse).classes("picture")
            self._pictures.append(picture.mark(f"picture-{slot}"))
            self._captions.append(ui.label().classes("text-xs opacity-70"))

    def _listing(self) -> dict[int, str]:
        """Clips of the chosen split and map, by their position."""
        return {
            c.position: f"{c.split}  {c.map}  {c.label}"
            for c in self._library.clips
            if self._split.value in ("all", c.split) and self._map.value in ("all", c.map)
        }

    def _list_clips(self) -> None:
        """Offer the clips of the chosen split and map; stay where we are if that is one of them."""
        listed = self._listing()
        if not listed:
            ui.notify("no clip of this split on this map")
            return
        stay = self._clip.position in listed
        self._listed.set_options(listed, value=self._clip.position if stay else next(iter(listed)))

    def _choose_clip(self, clip: Clip) -> None:
        self._clip = clip
        self._words.text = self._library.words(clip.position)
        self._frame._props["max"] = clip.frames - 1
        self._frame.update()
        self._space.show_flight(self._library.path(clip.position))
        if self._frame.value == min(1, clip.frames - 1):
            self._show()
        else:
            self._frame.value = min(1, clip.frames - 1)  # shows it, too

    def _show(self) -> None:
        """Draw the frame that is chosen now."""
        still = self._still()
        for slot in range(len(self._pictures)):
            self._draw(slot)
        pair = "" if int(self._frame.value) else "  (before the first pair)"
        self._where.text = f"{int(self._frame.value)} / {self._clip.frames - 1}   {still.time_s:.3f} s{pair}"
        self._read(still)
        if self._clock.active:
            return  # points by the thousand at every step would hold up the film
        thermal = self._gallery.panel(*self._at, "thermal", self._tone)
        self._space.show_frame(still, thermal.picture)

    def _draw(self, slot: int) -> None:
        layer = self._shown[slot]
        self._pictures[slot].set_source(self._gallery.address(*self._at, layer, self._tone))
        self._captions[slot].text = self._gallery.panel(*self._at, layer, self._tone).caption

    def _read(self, still: Still) -> None:
        """Numbers of the pixel under the cursor, and the cross in all pictures."""
        self._numbers.clear()
        with self._numbers:
            if self._pixel is None:
                ui.label("Move over a picture to read it.").classes("col-span-2 opacity-70")
                return
            for name, value in readout(still, *self._pixel, self._materials).items():
                ui.label(name).classes("opacity-70")
                ui.label(value).classes("number").mark(f"read-{name}")
        x, y = self._pixel[0] + 0.5, self._pixel[1] + 0.5
        cross = f'<path d="M{x} 0V99999M0 {y}H99999" stroke="#ffb000" stroke-width="0.5" opacity="0.8"/>'
        for picture in self._pictures:
            picture.content = cross

    def _on_mouse(self, event: Any) -> None:
        still = self._still()
        rows, columns = still.counts.shape
        column, row = int(event.image_x), int(event.image_y)
        self._pixel = (min(max(column, 0), columns - 1), min(max(row, 0), rows - 1))
        self._read(still)

    def _on_key(self, event: Any) -> None:
        if not event.action.keydown:
            return
        if event.key == " ":
            self._toggle()
        elif event.key.arrow_right or event.key.arrow_left:
            self._step(1 if event.key.arrow_right else -1)

    def _step(self, by: int = 1) -> None:
        self._frame.value = (int(self._frame.value) + by) % self._clip.frames

    def _toggle(self) -> None:
        self._clock.active = not self._clock.active
        self._play.props(f"icon={'pause' if self._clock.active else 'play_arrow'}")
        self._show()

    def _set_gain(self, event: Any) -> None:
        self._tone = Tone(event.value, self._tone.palette)
        self._show()

    def _set_palette(self, event: Any) -> None:
        self._tone = Tone(self._tone.gain, event.value)
        self._show()

    def _set_layer(self, slot: int, layer: str) -> None:
        self._shown[slot] = layer
        self._draw(slot)

    @property
    def _at(self) -> tuple[int, int]:
        """Clip and frame that are shown."""
        return self._clip.position, int(self._frame.value)

    def _still(self) -> Still:
        return self._library.still(*self._at)
