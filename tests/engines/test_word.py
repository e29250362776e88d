"""How engines are called: words taken apart, places that are wrong, versions told apart."""

import ast
import os
import subprocess
import sys

import pytest

from harness.engines.registry import LAMMPS, LIGGGHTS, choose_alone, choose_engines, find_engine, kernel_of, word_of
from harness.engines.word import Word, code_of, named, parse_word
from harness.errors import InputError


@pytest.mark.parametrize(("word", "code", "place", "ranks"), [
    ("lammps", "lammps", "", None),
    ("kernel:talk", "kernel:talk", "", None),
    ("lammps:ranks=4", "lammps", "", 4),
    ("lammps@env/bin/python", "lammps", "env/bin/python", None),
    ("liggghts@a b/l:x@y:ranks=2", "liggghts", "a b/l:x@y", 2),
])
def test_a_word_is_taken_apart_and_put_together(word, code, place, ranks):
    assert parse_word(word, "--engine") == Word(code=code, place=place, ranks=ranks)
    assert named(code, place, ranks or 1) == word
    assert code_of(word) == code


@pytest.mark.parametrize("word", ["lammps@", "lammps@:ranks=2", "lammps:ranks=", "lammps:ranks=0", "lammps:ranks=two",
                                  "lammps:ranks=1025", "lammps@a\nb"])
def test_a_wrong_word_is_one_line(word):
    with pytest.raises(InputError) as error:
        parse_word(word, "--engine")
    assert "\n" not in str(error.value)
    assert str(error.value).startswith("--engine: expected ")


@pytest.fixture
def program(tmp_path):
    """program(text) is an executable file."""

    def make(text: str, mode: int = 0o755):
        file = tmp_path / f"program{len(list(tmp_path.iterdir()))}"
        file.write_text(text)
        file.chmod(mode)
        return file

    return make


@pytest.mark.parametrize("code", ["lammps", "liggghts"])
def test_places_that_are_none(code, program, tmp_path):
    for place, got in (
        (tmp_path / "nowhere", "is not there"), (tmp_path, "is a folder"),
        (program("#!/bin/sh\n", 0o644), "cannot be executed"),
    ):
        with pytest.raises(InputError, match=f"{code}@.*{got}"):
            find_engine(f"{code}@{place}")


def test_a_folder_with_an_interpreter_is_corrected(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python").symlink_to(sys.executable)
    with pytest.raises(InputError, match=f"name lammps@{tmp_path}/bin/python"):
        find_engine(f"lammps@{tmp_path}")


SHELL = "#!/bin/sh\n"


@pytest.mark.parametrize("text", [f"{SHELL}exit 0", f"{SHELL}echo nonsense", f"{SHELL}kill -9 $$", "no program"])
def test_programs_that_are_something_else(text, program):
    with pytest.raises(InputError, match="lacks everything"):
        find_engine(f"lammps@{program(text)}")
    with pytest.raises(InputError, match="does not print a version of LIGGGHTS"):
        find_engine(f"liggghts@{program(text)}")


def test_a_python_without_lammps_is_told_what_it_lacks(tmp_path):
    """-S takes its site-packages away."""
    bare = tmp_path / "python"
    bare.write_text(f"#!/bin/sh\nexec {os.path.realpath(sys.executable)} -I -S \"$@\"\n")
    bare.chmod(0o755)
    with pytest.raises(InputError, match="lacks lammps and numpy; .* -m pip install lammps numpy"):
        find_engine(f"lammps@{bare}")


def test_the_kernel_has_no_place_and_one_process():
    for word, said in (("kernel@x", "part of grainproof"), ("kernel:ranks=2", "one process"),
                       ("kernel:talk:ranks=2", "one process")):
        with pytest.raises(InputError, match=said):
            choose_engines([word])
    with pytest.raises(InputError, match="the kernel has one process"):
        find_engine("kernel", ranks=2)
    with pytest.raises(InputError, match="--ranks: .*the kernel has one process"):
        choose_engines(["kernel"], ranks=2)


def test_ranks_go_to_the_codes_that_do_not_say_themselves():
    chosen = choose_engines(["lammps:ranks=3", "liggghts", "kernel:talk"], ranks=2)
    assert [e.name for e in chosen] == ["lammps:ranks=3", "liggghts:ranks=2", "kernel:talk"]
    assert choose_engines(["lammps"], ranks=1) == (LAMMPS,)
    with pytest.raises(InputError, match="laws are proven body by body"):
        choose_alone(["lammps:ranks=2"])


def test_here_twice_is_one_engine_and_its_kernel_comes_once():
    here = f"lammps@{sys.executable}"
    version = LAMMPS.probe().version
    chosen = choose_engines(["lammps", here, "kernel"])
    assert [e.name for e in chosen] == ["lammps", f"lammps@{version}", "kernel:lammps"]
    assert word_of(chosen[1]) == here
    assert chosen[1].probe().version.startswith(f"{version}+")
    assert kernel_of(chosen[1].name) == "kernel:lammps"


def test_one_build_under_two_names_is_refused(tmp_path):
    twin = tmp_path / "python"
    twin.write_text(f"#!/bin/sh\nexec {sys.executable} \"$@\"\n")
    twin.chmod(0o755)
    with pytest.raises(InputError, match="the same to the last byte"):
        choose_engines([f"lammps@{sys.executable}", f"lammps@{twin}"])


@pytest.mark.skipif(not LIGGGHTS.probe().available, reason="no LIGGGHTS")
def test_liggghts_at_a_place_is_told_from_another_build():
    import shutil

    there = find_engine(f"liggghts@{shutil.which('liggghts')}")
    assert there.name.startswith("liggghts@3.")
    assert there.probe().version.startswith(there.name.removeprefix("liggghts@") + "+")


def test_a_child_elsewhere_imports_nothing_but_what_that_python_has():
    """Of this environment only `harness` is known there, and of that only what needs no other library."""
    probe = "import sys, harness.engines.lammps.child, harness.engines.lammps.prescribed, harness.engines.lammps.look\n"
    probe += "print(sorted({m.split('.')[0] for m in sys.modules} - set(sys.stdlib_module_names)))"
    done = subprocess.run([sys.executable, "-c", probe], capture_output=True, text=True, timeout=60, check=True)
    foreign = {m for m in ast.literal_eval(done.stdout) if not m.startswith("_")}
    assert foreign == {"harness", "numpy"}
