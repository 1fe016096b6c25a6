"""Canonical URDFs of every available robot compared with the originals: by yourdfpy, by pinocchio, and element by element."""

import multiprocessing
import os
import subprocess
from collections import Counter

import pytest
from same_robot import examine, quiet

import built
import corpus


def files():
    """The corpus without files that are generated from others."""
    return [path for source, path in corpus.files() if source != "vendor/xacro"]


@pytest.fixture(scope="session")
def export_urdf():
    """The program that exports; built if not given."""
    given = os.environ.get("DENAVIT_EXPORT_URDF")
    if given:
        return given
    build = ["cargo", "build", "--quiet", "--workspace", "--example", "export_urdf"]
    subprocess.run(build, cwd=corpus.WORKSPACE, check=True)
    return str(built.target() / "debug/examples/export_urdf")


def export(program, flags, folder, originals):
    """The exported files and the program's reasons for the files that it refused."""
    folder.mkdir()
    exported = [folder / f"{index}.urdf" for index in range(len(originals))]
    words = [str(word) for pair in zip(originals, exported, strict=True) for word in pair]
    done = subprocess.run([program, *flags, *words], capture_output=True, text=True, check=False)
    assert done.returncode in (0, 2), done.stderr
    return exported, done.stderr


def test_exports_are_the_same_robot(export_urdf, tmp_path):
    originals = files()
    replaced, refused = export(export_urdf, ["--as-written"], tmp_path / "replaced", originals)
    kept, refused_keeping = export(export_urdf, ["--as-written", "--keep"], tmp_path / "kept", originals)
    tasks = [(original, [(one, False), (other, True)]) for original, one, other in zip(originals, replaced, kept, strict=True)]
    with multiprocessing.Pool(2, initializer=quiet) as pool:
        of_replaced, of_kept = zip(*pool.map(examine, tasks, chunksize=1), strict=True)
    print("link frames replaced:")
    are_the_same(of_replaced, refused)
    print("link frames kept:")
    are_the_same(of_kept, refused_keeping)


def are_the_same(results, refusals):
    for result in results:
        if result.get("refused"):
            assert result["file"] in refusals, result["file"]
    poses = sorted((result["yourdfpy"][0], result["file"]) for result in results if "yourdfpy" in result)
    tensors = sorted((result["yourdfpy"][1], result["file"]) for result in results if "yourdfpy" in result)
    matrices = sorted((result["pinocchio"][0], result["file"]) for result in results if result.get("pinocchio") is not None)
    torques = sorted((result["pinocchio"][1], result["file"]) for result in results if result.get("pinocchio") is not None)
    print(
        f"{len(results)} files, {sum('refused' in r for r in results)} refused; yourdfpy: {len(poses)} files, "
        f"poses {poses[-1]}, tensors {tensors[-1]}; pinocchio: {len(matrices)} files, "
        f"mass matrix {matrices[-1]}, gravity torque {torques[-1]}"
    )
    for program in ("yourdfpy", "pinocchio"):
        skipped = Counter(result[f"{program} skipped"][:100] for result in results if f"{program} skipped" in result)
        print(f"{program} does not take {sum(skipped.values())} files: {dict(skipped)}")
    assert poses[-1][0] < 1e-12, poses[-5:]
    assert tensors[-1][0] < 1e-12, tensors[-5:]
    assert all(result["yourdfpy"][2] == 0 for result in results if "yourdfpy" in result)
    assert matrices[-1][0] < 1e-10, matrices[-5:]
    assert torques[-1][0] < 1e-10, torques[-5:]
    different = {result["file"]: result["elements"][:5] for result in results if result.get("elements")}
    assert not different
