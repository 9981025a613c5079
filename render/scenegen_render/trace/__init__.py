"""From a lit world and a pose to a frame: own rays, one launch, no film, no random bounce."""

from scenegen_render.trace.lit import Lit
from scenegen_render.trace.tracer import Tracer

__all__ = ["Lit", "Tracer"]
