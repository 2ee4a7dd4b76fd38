"""The book's own extensions, on tiny books: a good one builds, and each kind of broken link fails the build."""

import re
import textwrap
from html import unescape

import books
import pytest
from csource import Source, WeaveError

pytest.importorskip("sphinx", reason="Sphinx is not installed")

OPTIONS = ("-W", "--keep-going")

SPRING = r"""
#include "spring.h"
#define BRACES_IN_A_MACRO(x) do { if (x) { \
  (x)++; } while (0)

/* A comment with { a brace and ct_not_a_function(int x) { inside. */
static const char *TEXT = "a string with } and \" and // no comment";
static const double TABLE[2] = {1.0, 2.0};

typedef struct ct_spring {
  double k; // stiffness (eq:spring)
} ct_spring;

/* Elongation of a spring.
 * Second line. */
#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
static double
elongation(const char *format, double (*measure)(void), ...)
{
  char brace = '{', quote = '\'';
  return brace + quote + measure();
}

/* Force of a spring. */
double ct_spring_force(const ct_spring *spring, double u)
{
  if (u > 0) {
    // -- Pull
    u = u + 0;
  }
  // -- Hooke's law (eq:spring, eq:energy)
  double f = -spring->k * u;

  // -- Return it
  return f;
}

double ct_spring_energy(double k, double u)
{
  // -- Hooke's law (eq:energy)
  return 0.5 * k * u * u;
}
"""

HEADER = """
#ifdef __cplusplus
extern "C" {
#endif
/** The force, :eq:`spring`. */
CT_API double ct_spring_force(const ct_spring *spring, double u);
static inline int ct_spring_two(void) { return 2; }
#ifdef __cplusplus
}
#endif
"""

PAGE = r"""
Springs
=======

.. math::
   :label: spring

   f = -k u

.. math::
   :label: energy

   \Pi = \tfrac12 k u^2

"""


@pytest.fixture
def book(tmp_path):
    """A function that writes a book with a page and builds it: (exit status, messages, HTML of the page)."""

    def build(
        page, *options, sources=None, other_page="", extensions=("weave", "codepages"), clean=True
    ):
        files = {
            "docs/conf.py": f"extensions = {list(extensions)!r}\n"
            "cnames_headers = '../libcontact'\nhtml_theme = 'basic'\n"
            "hawkmoth_autoconf = []\n",  # as in conf.py: it would ask for clang
            "docs/index.rst": PAGE + textwrap.dedent(page),
            "docs/other.rst": ":orphan:\n\nOther\n=====\n\n" + textwrap.dedent(other_page),
            "libcontact/src/spring.c": SPRING,
            "libcontact/src/spring.h": HEADER,
            **(sources or {}),
        }
        books.write(tmp_path, files)
        options = (*OPTIONS, "-n", *options, *(["-E"] if clean else []))
        done = books.build(tmp_path, *options, source="docs", out="html")
        html = tmp_path / "html" / "index.html"
        return (
            done.returncode,
            done.stdout + done.stderr,
            html.read_text(encoding="utf-8") if html.exists() else "",
        )

    return build


def plain(html):
    """Text of a page without its tags."""
    return unescape(re.sub(r"<[^>]*>", "", html))


# -- The scanner


def test_scanner_finds_functions_among_strings_comments_macros_and_attributes():
    assert [f.name for f in Source(SPRING).functions] == [
        "elongation",
        "ct_spring_force",
        "ct_spring_energy",
    ]


def test_scanner_looks_inside_extern_c():
    assert [f.name for f in Source(HEADER).functions] == ["ct_spring_two"]


def test_function_spans_its_true_lines():
    span = Source(SPRING).function("ct_spring_force")
    lines = SPRING.splitlines()
    assert (
        lines[span.first - 1].startswith("double ct_spring_force") and lines[span.last - 1] == "}"
    )
    assert lines[Source(SPRING).doc_start(span) - 1] == "/* Force of a spring. */"


def test_fragment_ends_at_the_next_heading_and_at_its_block():
    source = Source(SPRING)
    shown = lambda title: [
        line.strip()
        for s in [source.fragment(title)]
        for line in source.lines[s.first - 1 : s.last]
    ]  # noqa: E731
    assert shown("Pull") == ["// -- Pull", "u = u + 0;"]
    assert shown("ct_spring_force: Hooke's law") == [
        "// -- Hooke's law (eq:spring, eq:energy)",
        "double f = -spring->k * u;",
    ]
    assert shown("Return it") == ["// -- Return it", "return f;"]


def test_labels_are_read_from_comments_only():
    source = Source(
        'const char *s = "eq:not-this"; // eq:this-one and :eq:`that`.\n/* (eq:a, eq:b-2) seq:no */'
    )
    assert [label for label, _, _ in source.labels()] == ["this-one", "that", "a", "b-2"]


def test_unbalanced_braces_are_reported():
    with pytest.raises(WeaveError, match="balance"):
        Source("void f(void) { if (1) { }")


# -- Good books


def test_good_book_builds_with_true_line_numbers_and_links(book):
    status, messages, html = book("""
        .. weave:: libcontact/src/spring.c ct_spring_force
           :doc:

        .. weave:: libcontact/src/spring.c "Pull"

        .. weave:: libcontact/src/spring.c "ct_spring_energy: Hooke's law"
        """)
    assert status == 0, messages
    first = next(
        i for i, line in enumerate(SPRING.splitlines(), 1) if line == "/* Force of a spring. */"
    )
    text = plain(html)
    assert f"libcontact/src/spring.c:{first} ct_spring_force(): (1), (2)" in text
    assert re.search(rf"^ *{first} */\* Force of a spring\. \*/$", text, re.MULTILINE)
    links = re.findall(r'class="reference internal" href="#equation-(\w+)"', html)
    assert links == ["spring", "energy", "energy"]
    assert f'href="_code/libcontact/src/spring.c.html#line-{first}"' in html


def test_equation_lists_where_it_is_computed_and_source_page_has_the_anchor(book, tmp_path):
    status, messages, html = book("")
    assert status == 0, messages
    line = next(
        i for i, text in enumerate(SPRING.splitlines(), 1) if "eq:spring, eq:energy" in text
    )
    assert (
        f'href="_code/libcontact/src/spring.c.html#line-{line}"' in html and "computed in" in html
    )
    assert f'id="line-{line}"' in (tmp_path / "html/_code/libcontact/src/spring.c.html").read_text(
        encoding="utf-8"
    )


def test_parallel_build_and_pages_that_quote(book, tmp_path):
    quote = ".. weave:: libcontact/src/spring.c ct_spring_energy\n"
    status, messages, _ = book(
        quote,
        "-j2",
        other_page=quote,
        extensions=("weave", "codepages", "cnames"),
        sources={"libcontact/src/spring.h": ""},
    )
    assert status == 0, messages
    page = plain((tmp_path / "html/_code/libcontact/src/spring.c.html").read_text(encoding="utf-8"))
    assert "Explained in: Springs, Other" in page


def test_changed_source_is_read_again(book, tmp_path):
    quote = ".. weave:: libcontact/src/spring.c ct_spring_energy\n"
    assert book("", other_page=quote)[0] == 0
    changed = "\n" + SPRING.replace("0.5 *", "0.25 *")
    status, messages, html = book(
        "", other_page=quote, clean=False, sources={"libcontact/src/spring.c": changed}
    )
    assert status == 0, messages
    line = next(i for i, text in enumerate(changed.splitlines(), 1) if "(eq:energy)" in text)
    assert f"spring.c:{line}" in plain(html), "the equation's page lists the old line"
    assert "0.25" in plain((tmp_path / "html/other.html").read_text(encoding="utf-8")), (
        "the quoting page shows the old code"
    )


# -- Broken books


@pytest.mark.parametrize(
    "page, message",
    [
        (".. weave:: libcontact/src/gone.c ct_spring_force", "No such file"),
        (".. weave:: libcontact/src/spring.c ct_gone", "has no function ct_gone"),
        ('.. weave:: libcontact/src/spring.c "Gone"', 'has no heading "Gone"'),
        ('.. weave:: libcontact/src/spring.c "Hooke\'s law"', "is ambiguous"),
        ('.. weave:: libcontact/src/spring.c "elongation: Hooke\'s law"', "has no heading"),
        (".. weave:: libcontact/src/spring.c", "argument"),
        (".. math::\n   :label: spring\n\n   1 = 1", "duplicate label of equation spring"),
        ("See :eq:`gone`.", "equation not found: gone"),
    ],
)
def test_broken_page_fails(book, page, message):
    status, messages, _ = book(page)
    assert status != 0 and message in messages, messages


@pytest.mark.parametrize(
    "text",
    [
        "// eq:nowhere\n",
        "/* the sum (eq:spring, eq:nowhere) */\n",
        "/** See :eq:`nowhere`. */\n",
        "#define A 1 /* eq:nowhere */\n",
    ],
)
def test_label_without_equation_fails_in_unquoted_files(book, text):
    status, messages, _ = book("", sources={"libcontact/include/contact/lone.h": "\n" + text})
    assert (
        status != 0
        and "libcontact/include/contact/lone.h:2: WARNING: weave: no page defines the equation nowhere"
        in messages
    )


def test_label_of_a_quoted_fragment_without_equation_fails_at_the_page_too(book):
    source = {"libcontact/src/one.c": "void f(void)\n{\n  // -- Step (eq:nowhere)\n  return;\n}\n"}
    status, messages, _ = book('.. weave:: libcontact/src/one.c "Step"', sources=source)
    assert status != 0 and "equation not found: nowhere" in messages


def test_function_defined_twice_fails(book):
    source = {"libcontact/src/twice.c": "void f(void) {}\nvoid f(void) {}\n"}
    status, messages, _ = book(".. weave:: libcontact/src/twice.c f", sources=source)
    assert status != 0 and "function f is ambiguous: it stands at lines 1, 2" in messages


def test_equation_that_leaves_its_page_fails_on_the_next_build(book, tmp_path):
    assert book("", clean=False)[0] == 0
    page = tmp_path / "docs/index.rst"
    page.write_text(
        page.read_text(encoding="utf-8").replace(":label: energy", ":label: moved"),
        encoding="utf-8",
    )
    done = books.build(tmp_path, *OPTIONS, source="docs", out="html")
    assert done.returncode != 0 and "no page defines the equation energy" in done.stderr


# -- Names


def test_public_function_without_manual_fails(book):
    status, messages, _ = book("", extensions=("weave", "codepages", "cnames"))
    assert status != 0 and "the manual lacks ct_spring_force" in messages


def test_comment_after_what_it_describes_fails(book):
    header = {"libcontact/src/spring.h": "typedef enum a {\n  A = 0 /**< the first */\n} a;\n"}
    status, messages, _ = book("", extensions=("weave", "codepages", "cnames"), sources=header)
    assert status != 0 and "src/spring.h:2: WARNING: a comment must stand before" in messages


def test_last_line_of_a_comment_is_text(book):
    """One of two lines would become a term with a list, one of three lines an error."""
    lines = (
        "/** The first line,\n * the second,\n * the third. */\ndouble ct_spring_force(double u);\n"
    )
    sources = {"libcontact/src/spring.h": lines, "docs/spring.h": lines}
    page = ".. c:autodoc:: spring.h\n"
    status, messages, html = book(
        page, extensions=("weave", "codepages", "cnames"), sources=sources
    )
    assert status == 0, messages
    assert "<p>The first line,\nthe second,\nthe third.</p>" in html


def test_name_in_backticks_is_a_link_and_must_exist(book):
    names = ("weave", "codepages", "cnames")
    known = ":cname:`ct_spring_force` and :cname:`count`\n\n.. c:function:: double ct_spring_force(double u)\n"
    status, messages, html = book(known, extensions=names)
    assert status == 0, messages
    assert 'href="#c.ct_spring_force"' in html
    status, messages, _ = book(known + "\n:cname:`ct_gone`\n", extensions=names)
    assert status != 0 and "ct_gone" in messages
