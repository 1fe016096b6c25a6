"""Edits compared by readers that are not ours: every operation on a slice of the files that `edits.py` takes whole.

What is refused has a reason; what is done is right by yourdfpy, pinocchio and MuJoCo, and comes back by `denavit diff`.
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
    # No check is left out where a reader takes the file.
    readers = set(robot.readers)
    assert all(set(result.checked) >= readers for case, result in done if case.actual is None)
    assert all(result.came_back for case, result in done if case.back)
