"""How much a scene file may ask for. Beyond these it is refused, before or while it is read."""

FORMATS = (".glb", ".gltf", ".obj", ".ply")
"""Endings of scene files."""

MAX_FILE_BYTES = 256 << 20
MAX_SIDECAR_BYTES = 1 << 20

MAX_FACES = 2_000_000
"""Triangles, instances counted; what a world costs grows with them."""

MAX_VERTICES = 3 * MAX_FACES

MAX_PIECES = 20_000
"""Nodes that carry triangles, times the materials of each."""

MAX_REACH_M = 5_000.0
"""Half the largest extent [m]: beyond, float32 coordinates and far shadows lose their meaning."""

MIN_SIZE_M = 1.0
"""Smallest extent [m]; what is smaller was most likely drawn in another unit."""

READING_BYTES = 6 << 30
"""Address space of the process that reads the file."""

READING_CPU_S = 120
"""CPU time of the process that reads the file [s]."""

READING_WALL_S = 300.0
"""How long its parent waits [s]."""
