"""Everything about inputs and targets that the paper leaves open, each as a key with its default explained."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenegen.foundation.section import Count, Number, Section, Share

FlowSource = Literal["none", "farneback", "dis", "truth"]


class InputKnobs(Section):
    """What a network is shown of a pair of thermal frames."""

    frames: Literal[1, 2] = 1
    """Thermal frames stacked as channels: 1 as in the paper, 2 adds the previous frame."""
    gain: Literal["percentile", "minmax", "clahe"] = "percentile"
    """From 14-bit counts to 8-bit grey: stretched between two percentiles, between least and most (minmax), or between
    those and then equalised tile by tile (clahe: clip limit 2, 8x8 tiles). The paper's frames were 8-bit from the
    start; percentiles keep a few hot pixels from taking the whole range."""
    gain_percent: Share = (0.01, 0.99)
    """Shares of the pixels that become black and white under `gain` percentile."""
    gain_shared: bool = True
    """One gain for both frames of a pair. With a gain of their own, brightness constancy breaks and flow suffers."""
    flow: FlowSource = "farneback"
    """Source of the flow that is embedded: farneback with OpenCV's sample parameters (the paper names the method only),
    dis (preset medium), truth (the renderer's own, layer flow_back: an upper bound), or none, the conventional
    method."""
    flow_grid: Literal["current", "previous"] = "current"
    """Whose pixels the flow belongs to: of the current frame towards the previous one, so that it lies on the thermal
    image it is embedded in; or of the previous one towards the current, as OpenCV's samples call it. Unknown in the
    paper."""
    simplified: Literal["value", "luma"] = "value"
    """The "luminance" of the flow picture: V of its HSV form (value), or its grey value (luma), which mixes in
    direction: of two points moving alike, one to the right and one down, one would seem nearer."""
    flow_scale: Literal["minmax", "x4", "full"] = "minmax"
    """Pixels of displacement to 8-bit V: frame by frame from least to most (minmax) as OpenCV's tutorial does, four
    levels a pixel (x4) as its sample does, or evenly up to `flow_full_px` (full). The first loses speed; the others
    keep it."""
    flow_full_px: Annotated[Number, Field(gt=0.0, le=1000.0)] = 8.0
    """Displacement that becomes white under `flow_scale` full [px]."""
    flow_shown: Literal["embedded", "channel"] = "embedded"
    """The simplified depth image inside the thermal one, Eq. (1) (embedded), or whole in a channel of its own."""
    interval: Annotated[Count, Field(ge=1, le=1000)] = 5
    """Every how many rows and columns a pixel of the simplified depth image is embedded, Eq. (1): 5 in the paper. 1
    replaces all."""

    @model_validator(mode="after")
    def _percent_is_a_range(self) -> InputKnobs:
        if not self.gain_percent[0] < self.gain_percent[1]:
            raise ValueError("gain_percent needs two different shares, such as 0.01 0.99")
        if self.flow == "truth" and self.flow_grid == "previous":
            raise ValueError(
                "flow truth is stored on the grid of the current frame; leave flow_grid at current"
            )
        return self

    @property
    def channels(self) -> int:
        """Of the network's input."""
        return self.frames + int(self.flow != "none" and self.flow_shown == "channel")


class TargetKnobs(Section):
    """What a network is asked for."""

    cap_m: Annotated[Number, Field(gt=1.0, le=10000.0)] = 100.0
    """Depth that becomes white [m]; AirSim's depth pictures end at 100 m."""
    near_m: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.5
    """Depth that becomes black under `scale` log [m]."""
    scale: Literal["linear", "log"] = "linear"
    """Grey value over depth: linear from 0 to `cap_m` as depth pictures are, or logarithmic (log) from `near_m`."""
    sky: Literal["cap", "ignore"] = "cap"
    """Pixels at or beyond `cap_m`, sky included: painted as `cap_m` and learned (cap), as in depth pictures and because
    a planner has to know that sky is far, or left out of the loss (ignore)."""
