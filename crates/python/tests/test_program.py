"""The program that the wheel puts on the path."""

import os
import signal
import subprocess
import sys
import time

import pytest


def run(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, **options)


def test_it_runs_by_its_name_and_as_a_module(program):
    by_name = run(program, "--version")
    as_module = run(sys.executable, "-m", "a3_simulator", "--version")
    assert by_name.returncode == 0
    assert by_name.stdout.startswith("a3 ")
    assert by_name.stdout == as_module.stdout


def test_it_starts_without_numpy(program):
    code = "import sys; sys.argv[1:] = ['--version']; import a3_simulator._program as p; p.main(); " \
        "assert 'numpy' not in sys.modules"
    assert run(sys.executable, "-c", code).returncode == 0


@pytest.mark.parametrize(
    "arguments, code, words",
    [
        (["--sceen", "flag"], 2, "did you mean --scene?"),
        (["simulate", "--scene", "flagg", "--until", "1", "--output", "x.csv"], 2, "did you mean flag?"),
        (["simulate", "e", "1", "--until", "5", "--output", "x.csv"], 1, "blew up"),
    ],
)
def test_errors_are_one_line_with_the_exit_code_of_the_program(program, tmp_path, arguments, code, words):
    ended = run(program, *arguments, cwd=tmp_path)
    assert ended.returncode == code
    assert words in ended.stderr
    assert ended.stderr.count("\n") == 1 and ended.stderr.startswith("error: ")
    assert not list(tmp_path.iterdir())


def test_a_name_that_is_not_utf_8_is_one_error(program):
    ended = subprocess.run([program.encode(), b"--scene", b"\xff.toml"], capture_output=True)
    assert ended.returncode == 2
    assert b"is not UTF-8" in ended.stderr and ended.stderr.count(b"\n") == 1


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_ctrl_c_ends_it_with_130(program, tmp_path):
    child = subprocess.Popen(
        [program, "simulate", "rk4", "0.0001", "--until", "1000", "--output", "x.json"],
        cwd=tmp_path, stderr=subprocess.PIPE, text=True,
    )
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    _, words = child.communicate(timeout=10)
    assert child.returncode == 130
    assert "interrupted" in words and "Traceback" not in words
    assert not list(tmp_path.iterdir())
