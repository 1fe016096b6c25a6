"""Round trips through another format without the sidecar, compared by `denavit diff --through`.

`python back.py` prints the counts in docs/formats.md; `python back.py FILE…` prints the differences in each file.
"""

import collections
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import built  # noqa: E402
import corpus  # noqa: E402
import mjcf  # noqa: E402
import sdf  # noqa: E402

ENDING = {"urdf": ".urdf", "mjcf": ".xml", "sdf": ".sdf"}


def run(*arguments):
    return subprocess.run([built.denavit(), *map(str, arguments)], capture_output=True, text=True)


def exported(source, target, to):
    """Warnings of an export without a sidecar; raises with its message."""
    fix = ["--fix-inertia"] if to == "mjcf" and source.suffix != ".xml" else []
    done = run("export", source, "--to", to, "-o", target, *fix)
    if done.returncode:
        raise ValueError((done.stderr.strip() or done.stdout.strip()).splitlines()[0][:300])
    Path(f"{target}.denavit.json").unlink(missing_ok=True)
    return done.stderr.splitlines()


def there_and_back(path, own, other, folder):
    """(verdict, differences, losses) of a file after a round trip through another format."""
    between, back = folder / f"between{ENDING[other]}", folder / f"back{ENDING[own]}"
    lost = exported(path, between, other)
    exported(between, back, own)
    found = run("diff", path, back, "--through", other, "--exact", "--samples", 64)
    if found.returncode > 1:
        raise ValueError(found.stderr.strip().splitlines()[0][:300])
    return ("same", "different")[found.returncode], found.stdout, lost


def kind_of(said, lost):
    """Why the robot differs, by the listed losses."""
    if any("its inertia" in line and "MuJoCo refuses" in line for line in lost):
        return "an inertia that MuJoCo refuses, changed by choice"
    if any("<mimic>" in line for line in lost):
        return "a mimic of a joint that is not there"
    lines = [re.sub(r'"[^"]*"|[-+]?\d[\d.e+-]*', "…", line.strip()) for line in said.splitlines()[1:3]]
    return "not explained: " + " | ".join(lines)


def report(title, files, own, other):
    kinds, verdicts, refused, shown = collections.Counter(), collections.Counter(), [], []
    with tempfile.TemporaryDirectory() as folder:
        for path in files:
            try:
                verdict, said, lost = there_and_back(path, own, other, Path(folder))
            except Exception as why:  # noqa: BLE001
                refused.append(f"{path.parent.name}/{path.name}: {why}")
                continue
            verdicts[verdict] += 1
            if verdict == "different":
                kind = kind_of(said, lost)
                kinds[kind] += 1
                if kind.startswith("not explained"):
                    shown.append(f"{path.parent.name}/{path.name}: {kind}")
    print(f"{title}: {len(files)} files, {verdicts['same']} the same, {verdicts['different']} different, {len(refused)} not converted")
    print(*(f"  {count:4} different by {kind}" for kind, count in kinds.most_common()), sep="\n")
    print(*(f"    {line}" for line in [*shown, *refused]), sep="\n")
    return verdicts, kinds, refused


def main(files):
    if files:
        with tempfile.TemporaryDirectory() as folder:
            for path in map(Path, files):
                own = {"urdf": "urdf", "xml": "mjcf", "sdf": "sdf"}[path.suffix.lstrip(".").lower()]
                for other in ("mjcf", "sdf") if own == "urdf" else ("urdf",):
                    verdict, said, lost = there_and_back(path, own, other, Path(folder))
                    print(path, "through", other, verdict, said if verdict == "different" else "", sep="\n  ")
        return
    urdfs = [path for _, path in corpus.files()]
    report("URDF -> MJCF -> URDF", urdfs, "urdf", "mjcf")
    report("URDF -> SDF -> URDF", urdfs, "urdf", "sdf")
    report("MJCF -> URDF -> MJCF", mjcf.models(), "mjcf", "urdf")
    folder = corpus.SHARED / "vendor/sdf"
    report("SDF -> URDF -> SDF", sorted(folder.rglob("*.sdf")) if folder.is_dir() else [], "sdf", "urdf")


if __name__ == "__main__":
    main(sys.argv[1:])
