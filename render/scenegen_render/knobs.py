"""Recipe keys of the tracer."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from scenegen.foundation.section import Count, Section


class RenderKnobs(Section):
    """How a frame is traced and which optional layers it carries."""

    sub_samples: Annotated[Count, Field(ge=1, le=64)] = 4
    """Rays per pixel for the radiance. Labels always come from the ray through the pixel centre."""

    backward_flow: bool = False
    """Also store flow and covisibility towards the previous frame."""

    normals: bool = False
    """Also store surface normals in the camera frame."""
