"""The web application: the page, and the pictures it asks for."""

from __future__ import annotations

from nicegui import app, ui
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.responses import Response

from scenegen.foundation.errors import ScenegenError
from scenegen_datasets.view.gallery import ROUTE, Gallery
from scenegen_datasets.view.page import Page

_PATIENCE_S = 30.0
"""A busy machine may be slow to answer; a page that is given up starts from its first frame again."""


def run(gallery: Gallery, host: str, port: int, *, show: bool) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    gallery : Gallery
    host : str
        Address to bind to, and the only name, beside ``localhost``, that is answered to.
    port : int
    show : bool
        Open a browser.
    """
    app.add_middleware(TrustedHostMiddleware, allowed_hosts=[host, "localhost"])

    # Not a thread of its own: what the gallery keeps is touched by one task at a time.
    async def picture(clip: int, frame: int, layer: str, gain: str, palette: str) -> Response:
        try:
            data = gallery.asked(clip, frame, layer, gain, palette)
        except ScenegenError as error:
            return Response(str(error), status_code=404, media_type="text/plain")
        return Response(data, media_type="image/png", headers={"Cache-Control": "private, max-age=600"})

    app.add_api_route(ROUTE, picture)

    def page() -> None:
        Page(gallery)

    ui.run(
        page,
        host=host,
        port=port,
        title=f"{gallery.library.root.name} - thermal-scenegen",
        show=show,
        reload=False,
        reconnect_timeout=_PATIENCE_S,
        show_welcome_message=False,
    )
