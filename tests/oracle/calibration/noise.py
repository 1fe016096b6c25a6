"""Variances of several sources of noise by a dense restricted likelihood: the oracle of crates/identify/src/noise/reml.rs.

`noise.py --out FILE` writes a few problems as JSON, each with the variances at which scipy finds the likelihood largest, and the ends
of the profile's 95 % intervals. The computation is simple on purpose: V is one dense matrix of all values, its inverse and determinants are numpy's, and
scipy's BFGS maximises over the logarithms of the variances.
"""

import argparse
import json
import pathlib

import numpy as np
from scipy.optimize import brentq, minimize

ROWS = 60
# Rise of the deviance at the ends of a 95 % interval: chi-squared with one degree of freedom.
RISE = 3.841458820694124


def rotation(rng):
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.diag(r))


def problem(seed, pose):
    """Rows of a tracker that sees a target on an arm of four joints: position, or position and orientation."""
    rng = np.random.default_rng(seed)
    height = 6 if pose else 3
    columns = 12
    scale = {"level": 1.0, "turn": 1.0, "range": 0.8, "angle": 0.3}
    truth = [1.0] + ([1.0] if pose else []) + [1.5, 0.6, 0.9, 0.7]
    rows, dense = [], []
    beta = rng.normal(size=columns) * 0.5
    for _ in range(ROWS):
        x = rng.normal(size=(height, columns))
        sight = rng.normal(size=3) + np.array([3.0, 0.0, 0.0])
        distance = np.linalg.norm(sight)
        along = sight / distance
        across = np.linalg.qr(np.column_stack([along, rng.normal(size=(3, 2))]))[0][:, 1:]
        pad = np.zeros((height - 3, 1))
        factors = [np.eye(height)[:, :3]]
        if pose:
            factors.append(np.eye(height)[:, 3:])
        factors.append(np.vstack([along[:, None] * scale["range"], pad]))
        factors.append(np.vstack([across * distance * scale["angle"], np.repeat(pad, 2, axis=1)]))
        for _ in range(2):
            factors.append(rng.normal(size=(height, 1)))
        noise = sum(np.sqrt(t) * b @ rng.normal(size=b.shape[1]) for t, b in zip(truth, factors))
        y = x @ beta + noise
        rows.append({"residual": y.tolist(), "columns": x.T.tolist(), "factors": [b.T.tolist() for b in factors]})
        dense.append((y, x, factors))
    half = rng.normal(size=(columns, 4))
    prior = half @ half.T
    pull = prior @ (0.1 * rng.normal(size=columns))
    return rows, dense, prior, pull


class Dense:
    """The deviance with one matrix of all values."""

    def __init__(self, dense, prior, pull):
        self.y = np.concatenate([y for y, _, _ in dense])
        self.x = np.vstack([x for _, x, _ in dense])
        self.prior, self.pull = prior, pull
        n, count = len(self.y), len(dense[0][2])
        self.sources = [np.zeros((n, n)) for _ in range(count)]
        at = 0
        for y, _, factors in dense:
            own = slice(at, at + len(y))
            for source, b in zip(self.sources, factors):
                source[own, own] = b @ b.T
            at += len(y)

    def deviance(self, variances):
        """The deviance and its derivatives."""
        v = sum(t * source for t, source in zip(variances, self.sources))
        inverse = np.linalg.inv(v)
        a = self.x.T @ inverse @ self.x + self.prior
        g = self.x.T @ inverse @ self.y + self.pull
        beta = np.linalg.solve(a, g)
        whole = inverse - inverse @ self.x @ np.linalg.solve(a, self.x.T @ inverse)
        left = inverse @ (self.y - self.x @ beta)
        slope = np.array([np.sum(whole * source) - left @ source @ left for source in self.sources])
        value = np.linalg.slogdet(v)[1] + np.linalg.slogdet(a)[1] + self.y @ inverse @ self.y - g @ beta
        return value, slope

    def likeliest(self, start, held=None):
        """Variances and deviance; `held`: index and value of a fixed variance."""
        free = [k for k in range(len(start)) if held is None or k != held[0]]

        def full(z):
            variances = np.array(start, dtype=float)
            variances[free] = np.exp(z)
            if held is not None:
                variances[held[0]] = held[1]
            return variances

        def cost(z):
            variances = full(z)
            value, slope = self.deviance(variances)
            return value, (slope * variances)[free]

        z = np.log(np.maximum(np.array(start)[free], 1e-3))
        found = minimize(cost, z, jac=True, method="BFGS", options={"gtol": 1e-6})
        return full(found.x), found.fun

    def ends(self, best, lowest, which):
        def over(log_value):
            return self.likeliest(best, (which, np.exp(log_value)))[1] - lowest - RISE

        at = np.log(best[which])
        low, high = at - 0.5, at + 0.5
        while over(low) < 0 and low > -12:
            low -= 1.0
        while over(high) < 0:
            high += 0.5
        lower = np.exp(brentq(over, low, at, xtol=1e-5)) if over(low) > 0 else 0.0
        return [lower, np.exp(brentq(over, at, high, xtol=1e-5))]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    problems = []
    for seed, pose in [(1, False), (2, False), (3, True)]:
        rows, dense, prior, pull = problem(seed, pose)
        model = Dense(dense, prior, pull)
        variances, deviance = model.likeliest([1.0] * len(model.sources))
        found = {"variances": variances.tolist(), "deviance": deviance}
        if not pose:
            found["interval_of_last"] = model.ends(variances, deviance, len(variances) - 1)
        problems.append({"rows": rows, "prior": prior.tolist(), "pull": pull.tolist(), **found})
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(json.dumps(problems))
    print(f"oracle: {len(problems)} problems of noise in {arguments.out}")


if __name__ == "__main__":
    main()
