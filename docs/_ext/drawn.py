"""Pictures that are drawn when the book is built: ``.. drawn:: figures/contact.py wedge``.

The file, named from the folder of the book, has a function of that name, without arguments, that returns a matplotlib
figure. The text under the directive is the caption, the option ``:alt:`` says what is seen. Below it stands a link to
the picture's data (``figuredata.py``). A book that is built without the package says so in place of the picture. The
program of a chapter has the name of the chapter; what several of them need lies in ``figures/shared``.

With ``:animation: name`` one stands above the picture, where a reader has not asked for reduced motion; on paper there
is the picture alone. The function ``name`` returns a figure, the seconds of one round, and a dictionary from artists
(lines and polygons) to their points in each frame, an array of frames, points and two coordinates.

``.. moving::`` is the same as ``drawn`` for a function that returns pictures of Pillow and the milliseconds of each. On
paper, and for readers who want no motion, the last one stands alone. The page holds them itself.
"""

from __future__ import annotations

import base64
import io
import re
import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective
from svg import FIGURES, STYLE, call, svg

DATA = "_data"  # the folder of the pictures' data


def animation(made: tuple[Any, float, dict[Any, Any]], name: str, alt: str) -> str:
    """An SVG element whose lines and polygons move on and on; a click halts them."""
    figure, seconds, frames = made
    figure.set_dpi(72)  # as an SVG is drawn, in points
    for number, artist in enumerate(frames):
        artist.set_gid(f"{name}-{number}")
    drawing = svg(figure, name, f"{alt} A click stops the animation.", tight=False)
    height = 72 * figure.get_figheight()
    for artist, points in frames.items():
        shown = artist.axes.transData.transform(points.reshape(-1, 2)).reshape(points.shape)
        shown[..., 1] = height - shown[..., 1]
        paths = ";".join("M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in frame) for frame in shown)
        animate = f'<animate attributeName="d" dur="{seconds}s" repeatCount="indefinite" values="{paths}"/>'
        pattern = rf'(<g id="{artist.get_gid()}">\s*<path [^>]*)/>'
        drawing, found = re.subn(pattern, rf"\1>{animate}</path>", drawing)
        assert found == 1, f"{name} shows {artist} {found} times"
    pause = "this.animationsPaused() ? this.unpauseAnimations() : this.pauseAnimations()"
    return drawing.replace("<svg ", f'<svg class="moving" onclick="{pause}" ', 1)


def webp(pictures: list[Any], **options: Any) -> str:
    """Pictures as the address of an image that needs no file."""
    data = io.BytesIO()
    pictures[0].save(data, "WEBP", append_images=pictures[1:], quality=80, **options)
    return f"data:image/webp;base64,{base64.b64encode(data.getvalue()).decode()}"


def movie(made: tuple[list[Any], list[int]], alt: str) -> str:
    """An element that shows pictures one after the other, again and again."""
    pictures, times = made
    width, height = pictures[0].size
    return (
        f'<picture><source media="print, (prefers-reduced-motion: reduce)" srcset="{webp(pictures[-1:])}">'
        f'<img width="{width}" height="{height}" alt="{alt}" src="{webp(pictures, save_all=True, duration=times, loop=0)}">'
        "</picture>"
    )


class Drawn(SphinxDirective):
    required_arguments = 2
    has_content = True
    option_spec = {
        "alt": lambda text: " ".join(directives.unchanged_required(text).split()),
        "animation": directives.unchanged_required,
    }

    def run(self) -> list[nodes.Node]:
        path, name = Path(self.env.srcdir) / self.arguments[0], self.arguments[1]
        for program in (path, STYLE, *sorted((FIGURES / "shared").glob("*.py"))):
            self.env.note_dependency(str(program))
        caption = self.parse_content_to_nodes()
        try:
            text, data = self.show(path, name)
            import libcontact._core
        except ImportError as error:
            return self.parse_text_to_nodes(
                f"(This book was built without the Python package, so a picture is missing here: {error}.)\n"
            )
        self.env.note_dependency(libcontact._core.__file__)
        picture = nodes.figure("", nodes.raw("", text, format="html"), drawn=name)
        picture += nodes.caption("", "", *caption[0].children)
        picture += data
        return [picture]

    def show(self, path: Path, name: str) -> tuple[str, list[nodes.Node]]:
        """The picture, and the link to its data."""
        alt, second = self.options["alt"], self.options.get("animation")
        figure = call(path, name)
        text = svg(figure, name, alt)
        if second:
            text = animation(call(path, second), second, alt) + text
        return text, self.data(figure, f"{path.stem}-{name}.csv")

    def data(self, figure: Any, name: str) -> list[nodes.Node]:
        """A link to the data of a picture, which are kept beside the doctrees until the book is written."""
        import figuredata

        if not (text := figuredata.table(figure)):
            return []
        folder = Path(self.env.doctreedir) / DATA
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
        up = "../" * self.env.docname.count("/")
        link = nodes.reference("", "data of this picture (CSV)", refuri=f"{up}{DATA}/{name}")
        return [nodes.legend("", nodes.paragraph("", "", link), classes=["figure-data"])]


class Moving(Drawn):
    def show(self, path: Path, name: str) -> tuple[str, list[nodes.Node]]:
        return movie(call(path, name), self.options["alt"]), []


def write_data(app, error) -> None:
    folder = Path(app.doctreedir) / DATA
    if app.builder.format == "html" and not error and folder.exists():
        shutil.copytree(folder, Path(app.outdir) / DATA, dirs_exist_ok=True)


def setup(app):
    app.add_directive("drawn", Drawn)
    app.add_directive("moving", Moving)
    app.connect("build-finished", write_data)
    return {"version": "2", "parallel_read_safe": True, "parallel_write_safe": True}
