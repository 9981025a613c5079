"""The page: choose a clip, scrub its frames, read numbers under the cursor, turn the scene in space.

One `Page` per open browser tab; it holds what that tab shows and nothing of the others.
"""

from __future__ import annotations

from typing import Any

from nicegui import ui

from scenegen.foundation.errors import ScenegenError
from scenegen.materials.table import materials
from scenegen_datasets.job import SPLITS
from scenegen_datasets.view.gallery import Gallery, Tone
from scenegen_datasets.view.library import Clip, Still
from scenegen_datasets.view.panels import GAINS, PALETTES
from scenegen_datasets.view.readout import readout
from scenegen_datasets.view.skin import KEYS, STAY, STYLE, caption
from scenegen_datasets.view.space import Space

_FIRST_SHOWN = ("thermal", "depth", "semantic", "flow")
_PLAY_INTERVAL_S = 0.12
_SETTLED_S = 0.2
_ALL = "all"


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
        self._points = "temperature" if "temperature" in gallery.layers else "thermal"
        self._tone = Tone()
        self._clip: Clip = self._library.clips[0]
        self._pixel: tuple[int, int] | None = None
        self._pictures: list[Any] = []
        self._captions: list[Any] = []
        self._settled: Any = None
        self._build()
        self._choose_clip(self._clip)

    def _build(self) -> None:
        ui.add_css(STYLE)
        ui.add_body_html(STAY)
        ui.dark_mode(True)
        with ui.column().classes("w-full max-w-screen-2xl mx-auto gap-2"):
            with ui.row().classes("w-full items-baseline justify-between gap-x-6 gap-y-0"):
                ui.label(self._library.root.name).classes("text-xl font-semibold").mark("name")
                self._words = ui.label().classes("text-sm opacity-80").mark("words")
            self._build_choices()
            self._build_scrubber()
            self._fault = ui.label().classes("fault").mark("fault")
            with ui.element("div").classes("stage"):
                with ui.element("div").classes("pictures"):
                    for slot in range(len(self._shown)):
                        self._build_panel(slot)
                with ui.element("div").classes("side") as self._side:
                    self._numbers = ui.element("div").classes("numbers")
                    self._space = Space()
                    self._colour = ui.select(
                        list(self._gallery.layers),
                        value=self._points,
                        label="colour of the points",
                        on_change=self._set_points,
                    ).props("dense")
        ui.keyboard(on_key=self._on_key)
        self._clock = ui.timer(_PLAY_INTERVAL_S, self._step, active=False)

    def _build_choices(self) -> None:
        clips = self._library.clips
        splits = [s for s in SPLITS if any(c.split == s for c in clips)]
        with ui.row().classes("items-center gap-x-4 gap-y-1"):
            self._split = ui.select(
                [_ALL, *splits], value=_ALL, label="split", on_change=self._list_maps
            ).classes("w-24")
            self._map = ui.select(
                self._maps(), value=_ALL, label="map", on_change=lambda _: self._list_clips()
            ).classes("w-36")
            self._listed = ui.select(
                self._listing(),
                value=self._clip.position,
                label="clip",
                with_input=True,
                on_change=lambda e: None if e.value is None else self._choose_clip(clips[e.value]),
            ).classes("w-72")
            ui.select(
                dict(GAINS), value=self._tone.gain, label="thermal gain", on_change=self._set_gain
            ).classes("w-80")
            ui.select(
                list(PALETTES), value=self._tone.palette, label="palette", on_change=self._set_palette
            ).classes("w-28")
            ui.label(KEYS).classes("text-xs opacity-70")

    def _build_scrubber(self) -> None:
        with ui.row().classes("w-full items-center no-wrap gap-3"):
            play = ui.button(icon="play_arrow", on_click=self._toggle).props('flat round aria-label="play"')
            self._play = play.mark("play")
            self._frame = ui.slider(min=0, max=1, value=0, on_change=self._show)
            self._frame.classes("grow").props('aria-label="frame"').mark("frame")
            self._where = ui.label().classes("number text-right text-sm").mark("where")

    def _build_panel(self, slot: int) -> None:
        with ui.element("div"):
            layer = ui.select(
                list(self._gallery.layers),
                value=self._shown[slot],
                on_change=lambda e: self._set_layer(slot, e.value),
            )
            layer.props(f'dense borderless role="group" aria-label="layer of picture {slot + 1}"')
            layer.mark(f"layer-{slot}")
            picture = ui.interactive_image(events=["mousemove"], on_mouse=self._on_mouse).classes("picture")
            picture.props('role="img"')
            self._pictures.append(picture.mark(f"picture-{slot}"))
            self._captions.append(ui.html("", sanitize=False).mark(f"caption-{slot}"))

    def _maps(self) -> list[str]:
        """Maps of the chosen split."""
        clips = self._library.clips
        return [_ALL, *sorted({c.map for c in clips if self._split.value in (_ALL, c.split)})]

    def _listing(self) -> dict[int, str]:
        """Clips of the chosen split and map, by their position."""
        return {
            c.position: f"{c.split}  {c.map}  {c.label}"
            for c in self._library.clips
            if self._split.value in (_ALL, c.split) and self._map.value in (_ALL, c.map)
        }

    def _list_maps(self) -> None:
        """Offer the maps of the chosen split, so that no choice is empty; then their clips."""
        maps = self._maps()
        self._map.set_options(maps, value=self._map.value if self._map.value in maps else _ALL)
        self._list_clips()

    def _list_clips(self) -> None:
        """Offer the clips of the chosen split and map; stay where we are if that is one of them."""
        listed = self._listing()
        stay = self._clip.position in listed
        self._listed.set_options(listed, value=self._clip.position if stay else next(iter(listed)))

    def _choose_clip(self, clip: Clip) -> None:
        self._clip = clip
        self._words.text = " · ".join(self._library.words(clip.position).split("   "))
        self._frame._props["max"] = clip.frames - 1
        self._frame.update()
        self._space.show_flight(self._library.path(clip.position))
        if self._frame.value == min(1, clip.frames - 1):
            self._show()
        else:
            self._frame.value = min(1, clip.frames - 1)  # shows it, too

    def _show(self) -> None:
        """Draw the frame that is chosen now; say so where it is damaged."""
        frame = int(self._frame.value)
        self._where.text = f"{frame} / {self._clip.frames - 1}"
        try:
            still = self._still()
            for slot in range(len(self._pictures)):
                self._draw(slot)
        except ScenegenError as error:
            self._say_fault(str(error))
            return
        self._fault.set_visibility(False)
        pair = "" if frame else "  (before the first pair)"
        self._where.text += f"   {still.time_s:.3f} s{pair}"
        self._read(still)
        if not self._clock.active:
            self._show_points_soon()

    def _say_fault(self, words: str) -> None:
        """Nothing is shown in place of what cannot be read."""
        self._fault.text = words
        self._fault.set_visibility(True)
        for picture, below in zip(self._pictures, self._captions, strict=True):
            picture.set_source("")
            below.content = ""
        self._numbers.clear()
        self._space.show_nothing()

    def _show_points_soon(self) -> None:
        """Points by the thousand would hold up scrubbing: they follow when it rests."""
        if self._settled is not None:
            self._settled.cancel()
        with self._side:
            self._settled = ui.timer(_SETTLED_S, self._show_points, once=True)

    def _show_points(self) -> None:
        try:
            colours = self._gallery.panel(*self._at, self._points, self._tone)
            self._space.show_frame(self._still(), colours.picture)
        except ScenegenError:
            self._space.show_nothing()  # the page has said why

    def _draw(self, slot: int) -> None:
        layer = self._shown[slot]
        drawn = self._gallery.panel(*self._at, layer, self._tone)
        self._pictures[slot].set_source(self._gallery.address(*self._at, layer, self._tone))
        self._pictures[slot].props(f'aria-label="{layer} of frame {self._at[1]}"')
        self._captions[slot].content = caption(drawn)

    def _read(self, still: Still) -> None:
        """Numbers of the pixel under the cursor, and the cross in all pictures."""
        self._numbers.clear()
        with self._numbers:
            if self._pixel is None:
                ui.label("Move over a picture to read it.").classes("all opacity-70")
                return
            for name, value in readout(still, *self._pixel, self._materials).items():
                ui.label(name).classes("opacity-70")
                ui.label(value).classes("number").mark(f"read-{name}")
        x, y = self._pixel[0] + 0.5, self._pixel[1] + 0.5
        cross = f'<path d="M{x} 0V99999M0 {y}H99999" stroke="#ffb000" stroke-width="0.5" opacity="0.8"/>'
        for picture in self._pictures:
            picture.content = cross

    def _on_mouse(self, event: Any) -> None:
        try:
            still = self._still()
        except ScenegenError:
            return  # there is nothing to read
        rows, columns = still.counts.shape
        column, row = int(event.image_x), int(event.image_y)
        self._pixel = (min(max(column, 0), columns - 1), min(max(row, 0), rows - 1))
        self._read(still)

    def _on_key(self, event: Any) -> None:
        if not event.action.keydown:
            return
        if event.key == " ":
            self._toggle()
        elif event.key in ("n", "p"):
            self._next_clip(1 if event.key == "n" else -1)
        elif event.key.arrow_right or event.key.arrow_left:
            self._step(1 if event.key.arrow_right else -1)

    def _next_clip(self, by: int) -> None:
        """The next of the listed clips, around the end."""
        listed = list(self._listing())
        self._listed.value = listed[(listed.index(self._clip.position) + by) % len(listed)]

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
        self._show()

    def _set_points(self, event: Any) -> None:
        self._points = event.value
        self._show_points_soon()

    @property
    def _at(self) -> tuple[int, int]:
        """Clip and frame that are shown."""
        return self._clip.position, int(self._frame.value)

    def _still(self) -> Still:
        return self._library.still(*self._at)
