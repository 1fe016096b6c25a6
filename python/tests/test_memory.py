"""Many configurations: no second copy of what goes in, and none of what comes out.

DENAVIT_CONFIGURATIONS=10000000 runs it with ten millions.
"""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

COUNT = int(os.environ.get("DENAVIT_CONFIGURATIONS", "4000000"))
"""Configurations of six joints: 48 bytes each in, 24 bytes out."""

# The process may take the joint values, the tips and some megabytes more than it has: a copy of either would not fit.
CODE = """
import resource, sys
import numpy as np
import denavit as dn
count = int(sys.argv[1])
chain = dn.load("robots/universal_robots/ur5e.urdf").chain()
chain.tips(chain.sample(1000), threads=2)
words = open("/proc/self/statm").read().split()
now = int(words[0]) * resource.getpagesize()
limit = now + count * (48 + 24) + (16 << 20) + int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
q = np.empty((count, 6))
q[:] = np.linspace(-1, 1, 6)
p = chain.tips(q)
assert p.shape == (count, 3)
out = p
assert chain.tips(q, out=out) is out
assert np.ptp(p, axis=0).max() == 0.0
print("done")
"""


def run(count: int, more: int) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-c", CODE, str(count), str(more)]
    return subprocess.run(words, capture_output=True, text=True, check=False)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="skipped, because limits of memory are Linux's")
def test_tips_of_many_configurations_need_no_second_copy() -> None:
    done = run(COUNT, 0)
    assert done.stdout == "done\n", done.stderr
    # The limit bites: with less than what the tips need there is no room.
    assert "MemoryError" in run(COUNT, -COUNT * 24 - (64 << 20)).stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="skipped, because limits of memory are Linux's")
def test_a_result_without_room_is_a_memory_error() -> None:
    # The joint values fit, the tips do not.
    failed = run(COUNT, -COUNT * 24)
    assert failed.returncode == 1
    said = failed.stderr.splitlines()[-1]
    assert "MemoryError" in said and f"({COUNT}, 3)" in said, failed.stderr
