"""Edits checked by independent readers: every operation on some of the files of `edits.py`.

A refusal has a reason; an edit is right by yourdfpy, pinocchio and MuJoCo, and can be undone, by `denavit diff`.
"""

import pytest
from lxml import etree

import corpus
from edits import Robot

EVERY = 24
FILES = [path for source, path in corpus.files() if source == "robots"]
FILES += [path for source, path in corpus.files() if source != "robots"][::EVERY]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_operation_is_done_right_or_refused(path, tmp_path):
    try:
        robot = Robot(path, tmp_path)
        asked = robot.asked()
    except (etree.XMLSyntaxError, IndexError) as error:
        pytest.skip(f"skipped, because this file is no robot: {error}")
    results = [(case, robot.tried(case, index)) for index, case in enumerate(asked)]
    wrong = [(case.words, result.reason) for case, result in results if result.state == "wrong"]
    assert not wrong
    done = [(case, result) for case, result in results if result.state == "done"]
    assert done
    # No check is left out if a reader accepts the file.
    readers = set(robot.readers)
    assert all(set(result.checked) >= readers for case, result in done if case.actual is None)
    assert all(result.came_back for case, result in done if case.back)
