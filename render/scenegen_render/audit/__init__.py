"""Does anything float, lie buried or stand in something else? An audit of a world by its triangles and ray casts."""

from scenegen_render.audit.audit import Audit, audit
from scenegen_render.audit.things import GROUND, Finding

__all__ = ["GROUND", "Audit", "Finding", "audit"]
