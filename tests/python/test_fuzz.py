"""A few of the scenes and files that ``make fuzz`` changes at random."""

import re
from pathlib import Path

import pytest

fuzz_scenes = pytest.importorskip("fuzz_scenes")
fuzz_meshes = pytest.importorskip("fuzz_meshes")


@pytest.mark.parametrize("program, words", [("api", "CALLS"), ("optimisations", "PAIRS")])
def test_the_counts_that_make_fuzz_reads_are_printed(program, words):
    import run_fuzz

    text = (Path(run_fuzz.__file__).parent / f"fuzz_{program}.c").read_text()
    told = re.findall(r"(\w+) %l", text[text.index('printf("seeds') :].split(";")[0])
    assert set(getattr(run_fuzz, words)) <= set(told)


def test_scenes_and_files_changed_at_random_are_refused_or_run(tmp_path):
    counts = fuzz_scenes.campaign(0.0, 1, tmp_path, rounds=2)
    assert counts["refused"] > 200 and counts["run"] > 50
    assert counts.get("file refused", 40) >= 10


def test_mesh_files_changed_at_random_are_refused_or_read(tmp_path):
    counts = fuzz_meshes.campaign(30, 1, tmp_path)
    for form in ("msh", "inp", "vtu", "exodus", "vtkhdf"):
        found = {
            kind: counts.get(f"{form} {kind}", 0)
            for kind in ("read", "refused", "refused with a line")
        }
        ended = counts.get("ended by HDF5", 0) if form in ("exodus", "vtkhdf") else 0
        assert (
            sum(found.values()) + 30 * ended >= 30
            and found["refused"] + found["refused with a line"] > 5
        )
        # Of a text file, nearly all errors name the line.
        assert form not in ("msh", "inp") or found["refused with a line"] > 15
