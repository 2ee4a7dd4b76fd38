"""The directive of a laboratory on a tiny book: with what ``make page`` builds, and with a picture in its place."""

import books
import pytest

pytest.importorskip("sphinx", reason="Sphinx is not installed")
PAGE = """
Book
====

.. laboratory:: closest
   :alt: three maps

   A caption.

See :laboratory:`the stiff penalty <bar:law=penalty&beta=10>`.
"""


@pytest.mark.parametrize("built", [False, True])
def test_a_laboratory_is_a_picture_in_a_book_without_make_page(tmp_path, built):
    folder, source = tmp_path / "page", tmp_path / "book"
    folder.mkdir()
    if built:
        (folder / "laboratory.js").write_text("// scripts")
    conf = f"extensions = ['drawn', 'laboratory']\nlaboratory_folder = {str(folder)!r}\n"
    books.write(source, {"conf.py": conf, "index.rst": PAGE})
    done = books.build(source, "-W", "-q", out=tmp_path / "out")
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "out" / "index.html").read_text()
    assert page.count("<svg") == 1 and 'data-laboratory="closest"' in page and "A caption." in page
    assert ("without the cross compiler" in page) != built
    assert ("laboratory/laboratory.js" in page) == built
    assert ('href="_static/laboratory/bar.html#bar:law=penalty&amp;beta=10"' in page) == built
    assert (tmp_path / "out" / "_static" / "laboratory" / "laboratory.js").exists() == built
