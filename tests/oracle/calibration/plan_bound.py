"""How good are the poses that `denavit plan` chooses? python plan_bound.py DENAVIT

For each arm, 1000 candidates; the gain in O1 over the mean of 50 random choices of the same number of poses: by the plan, by an
exchange algorithm in numpy (best of four random starts), and the upper bound for every choice, that of a design
with weights instead of whole poses (Kiefer and Wolfowitz 1960, by Titterington's multiplicative steps). Derivatives are
pinocchio's (`runs.py`).
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin

from arms import ARMS, to_urdf
from body import Body
from runs import Case, Stand, told

CANDIDATES = 1000
SPOT, ANCHOR = np.array([0.1, 0.0, 0.1]), np.array([0.8, 0.7, 0.1])


def rows_of(arm, measure, rng):
    """Candidates, and their derivatives by the identifiable numbers: (candidates, values, numbers)."""
    stand = Stand(Case(arm, measure, 1, CANDIDATES), 1)
    stand.body, stand.tools, stand.anchor = Body(ARMS[arm]), [pin.SE3(np.eye(3), SPOT)], ANCHOR
    lower, upper = (np.array([joint.limits[k] for joint in ARMS[arm].joints]) for k in (0, 1))
    inset = 0.02 * (upper - lower)
    q = np.round(rng.uniform(lower + inset, upper - inset, (CANDIDATES, len(lower))), 9)
    columns = stand.columns(stand.place(q))
    _, size, _, directions = told(columns)
    return q, columns / size @ directions.T


def log_det(matrix):
    return np.linalg.slogdet(matrix)[1]


def information(rows, weights=None):
    return np.einsum("nhi,nhj->ij", rows, rows) if weights is None else np.einsum("n,nhi,nhj->ij", weights, rows, rows)


def exchanged(rows, chosen):
    """Exchanges each pose in turn for the best other one, until no exchange helps."""
    chosen, matrix = list(chosen), information(rows[chosen])
    for _ in range(30):
        changed = False
        for place, out in enumerate(list(chosen)):
            without = matrix - rows[out].T @ rows[out]
            # A small multiple of the trace keeps the matrix without one pose invertible.
            held = np.linalg.inv(without + 1e-9 * np.trace(matrix) * np.eye(len(matrix)))
            gain = np.linalg.slogdet(rows @ held @ rows.transpose(0, 2, 1) + np.eye(rows.shape[1]))[1]
            gain[[index for index in chosen if index != out]] = -np.inf
            best = int(gain.argmax())
            if gain[best] > gain[out] + 1e-9:
                chosen[place], matrix, changed = best, without + rows[best].T @ rows[best], True
        if not changed:
            break
    return chosen


def bound(rows, count):
    weights = np.full(len(rows), 1 / len(rows))
    for _ in range(400):
        inverse = np.linalg.inv(information(rows, weights))
        weights *= np.einsum("nhi,ij,nhj->n", rows, inverse, rows) / rows.shape[2]
    # The dual value at these weights: a bound even before the steps converge.
    inverse = np.linalg.inv(information(rows, weights))
    most = np.einsum("nhi,ij,nhj->n", rows, inverse, rows).max() / rows.shape[2]
    return log_det(information(rows, weights) * count) + rows.shape[2] * np.log(most)


def planned(denavit, arm, measure, count, q, folder):
    urdf, candidates = folder / "arm.urdf", folder / "candidates.csv"
    urdf.write_text(to_urdf(ARMS[arm], inertials=False))
    names = ",".join(joint.name for joint in ARMS[arm].joints)
    np.savetxt(candidates, q, delimiter=",", fmt="%.9f", header=names, comments="")
    out = subprocess.run([denavit, "plan", urdf, "--base", "base", "--tip", "tip", "--count", str(count), "--measure", f"{measure}s",
                          "--candidates", candidates], check=True, capture_output=True, text=True).stdout
    poses = np.loadtxt([line for line in out.splitlines() if not line.startswith("#")][1:], delimiter=",")
    return [int(np.abs(q - pose).max(axis=1).argmin()) for pose in poses]


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("denavit")
    denavit = p.parse_args().denavit
    rng = np.random.default_rng(5)
    print("| robot | measured | poses | plan | exchange in numpy | bound |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for arm in ARMS:
            for measure in ("pose", "position"):
                q, rows = rows_of(arm, measure, rng)
                for count in (20, 40):
                    def some():
                        return rng.choice(len(q), count, replace=False)
                    usual = np.mean([log_det(information(rows[some()])) for _ in range(50)])
                    def gain(value):
                        return f"{100 * (np.exp((value - usual) / rows.shape[2] / 2) - 1):.1f} %"
                    ours = log_det(information(rows[planned(denavit, arm, measure, count, q, Path(folder))]))
                    theirs = max(log_det(information(rows[exchanged(rows, some())])) for _ in range(4))
                    print(f"| {arm} | {measure}s | {count} | {gain(ours)} | {gain(theirs)} | {gain(bound(rows, count))} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
