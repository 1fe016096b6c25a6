"""Corpora: files that are one mechanism, near-duplicates, and what each commit of a history did."""

import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import built  # noqa: E402

ROBOT = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"


def denavit(*words):
    run = subprocess.run([built.denavit(), *map(str, words)], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, f"{words}: exit code {run.returncode}\n{run.stdout}{run.stderr}"
    return run.stdout


def test_clusters_of_a_folder(tmp_path):
    text = ROBOT.read_text()
    (tmp_path / "deep").mkdir()
    (tmp_path / "one.urdf").write_text(text)
    (tmp_path / "renamed.urdf").write_text(text.replace("wrist_3", "flansch"))
    denavit("export", ROBOT, "-o", tmp_path / "deep" / "canonical.urdf")
    (tmp_path / "near.urdf").write_text(text.replace("-0.425", "-0.4252"))
    (tmp_path / "longer.urdf").write_text(text.replace("-0.425", "-0.435"))
    (tmp_path / "broken.urdf").write_text(text[: len(text) // 2])
    found = json.loads(denavit("fleet", "corpus", tmp_path, "--json"))
    assert found["schema"] == "denavit.fleet.corpus/1"
    names = [Path(file["file"]).name for file in found["files"]]
    sets = [{names[file] for file in mechanism} for mechanism in found["mechanisms"]]
    assert sets[0] == {"one.urdf", "renamed.urdf", "canonical.urdf"}
    assert sorted(map(sorted, sets[1:])) == [["longer.urdf"], ["near.urdf"]]
    (near,) = found["near"]
    assert {names[found["mechanisms"][m][0]] for m in near["mechanisms"]} & {"near.urdf"}
    assert len(near["mechanisms"]) == 2 and abs(near["tips_apart_m"] - 0.0002) < 1e-6
    errors = {name for name, file in zip(names, found["files"]) if "error" in file}
    assert errors == {"broken.urdf"}
    assert "6 files: 5 robots that move, 3 mechanisms, 1 without a robot" in denavit("fleet", "corpus", tmp_path)


def test_what_each_commit_of_a_history_did(tmp_path):
    def git(*words):
        name = ["-c", "user.name=T", "-c", "user.email=t@example.com"]
        subprocess.run(["git", *name, *words], cwd=tmp_path, check=True, capture_output=True)

    def commit(text, message):
        if text is None:
            git("rm", "-q", "arm, left.urdf")
        else:
            (tmp_path / "arm, left.urdf").write_text(text)
            git("add", ".")
        git("commit", "-q", "-m", message)

    text = ROBOT.read_text()
    git("init", "-q")
    commit(text, "begin")
    commit(text.replace("\n", "\n\n", 5), "white space")
    commit(text.replace("-0.425", "-0.426"), "longer")
    heavier = text.replace("-0.425", "-0.426").replace('mass value="', 'mass value="1', 1)
    assert heavier != text.replace("-0.425", "-0.426")
    commit(heavier, "heavier")
    commit(heavier[:300], "broken")
    commit(heavier, "mended")
    commit(None, "gone")
    found = json.loads(denavit("fleet", "corpus", f"git:{tmp_path}", "--json"))
    said = [(change["subject"], change["became"]) for change in found["changes"]]
    assert said == [("gone", "removed"), ("mended", "unreadable"), ("broken", "unreadable"), ("heavier", "matter"),
                    ("longer", "motion"), ("white space", "same"), ("begin", "new")]
    assert {change["path"] for change in found["changes"]} == {"arm, left.urdf"}
    assert "longer" in denavit("fleet", "corpus", f"git:{tmp_path}", "--revision", "HEAD~5..HEAD~4")
