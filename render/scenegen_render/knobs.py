"""Recipe keys of the tracer."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field

from scenegen.foundation.section import Count, Section


def _centred(count: int) -> int:
    if count == 2:
        raise ValueError(
            "two sub-samples cannot be centred on the label ray, which is one of them; choose 1, 3 or more"
        )
    return count


class RenderKnobs(Section):
    """How a frame is traced and which optional layers it carries."""

    sub_samples: Annotated[Count, Field(ge=1, le=256), AfterValidator(_centred)] = 4
    """Rays per pixel for the radiance, 1 or 3 to 256. One is the pixel centre's, the source of all labels."""

    backward_flow: bool = False
    """Also store flow and covisibility towards the previous frame."""

    normals: bool = False
    """Also store surface normals in the camera frame."""
