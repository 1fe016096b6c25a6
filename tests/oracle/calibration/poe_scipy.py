"""Calibration as written by a user of numpy and scipy: python poe_scipy.py AXES.json TRAIN.csv TEST.csv lm|trf|2-point

A product of exponentials, vectorised over the rows, with its Jacobian in closed form (or by differences: 2-point). Four
numbers per axis, six for the tool; the instrument is estimated first, from a hundred rows, and then fixed: the axes absorb its error. Prints
JSON: errors and times. AXES.json: "axes" (direction and a point of each, base frame) and "home" (4x4).
"""

import json
import sys
import time

import numpy as np
from scipy.optimize import least_squares

NOISE = np.array([5e-5] * 3 + [5e-5] * 3)


def rotations(axis, angle):
    """Rodrigues: axes (3,) or (rows, 3) of length 1, angles (rows,)."""
    x, y, z = np.broadcast_to(axis, (len(angle), 3)).T
    zero = np.zeros_like(x)
    k = np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)
    return np.eye(3) + np.sin(angle)[:, None, None] * k + (1 - np.cos(angle))[:, None, None] * (k @ k)


def expm(v):
    angle = np.linalg.norm(v)
    return np.eye(3) if angle == 0 else rotations(v / angle, np.array([angle]))[0]


def logs(r):
    """Rotation vectors of small or moderate rotations (rows, 3, 3)."""
    v = 0.5 * np.stack([r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], -1)
    sine = np.linalg.norm(v, axis=1)
    angle = np.arctan2(sine, 0.5 * (np.trace(r, axis1=1, axis2=2) - 1))
    return v * np.where(sine > 1e-9, angle / np.maximum(sine, 1e-12), 1.0)[:, None]


def from_quaternions(q):
    x, y, z, w = (q / np.linalg.norm(q, axis=1)[:, None]).T
    return np.stack([np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1),
                     np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1),
                     np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)], -2)


class Model:
    """Axes and home of the drawn robot; `turned`: the tool's rotation, to which its three numbers add small turns."""

    turned = np.eye(3)

    def __init__(self, axes, home):
        self.directions, self.points = (np.array([axis[k] for axis in axes]) for k in (0, 1))
        self.home = np.array(home)
        self.across = []
        for u in self.directions:
            a = np.cross(u, np.eye(3)[np.argmin(np.abs(u))])
            a /= np.linalg.norm(a)
            self.across.append((a, np.cross(u, a)))
        self.n = len(axes)

    def axes(self, x):
        for i, (u, c, (a, b)) in enumerate(zip(self.directions, self.points, self.across)):
            t = x[4 * i:4 * i + 4]
            w = u + a * t[0] + b * t[1]
            yield w / np.linalg.norm(w), c + a * t[2] + b * t[3]

    def forward(self, x, q):
        """base_from_tip, and each axis at these values: direction and point before the joint's motion and after it."""
        turn, place, seen = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3)), []
        for i, (w, c) in enumerate(self.axes(x)):
            before = turn
            r = rotations(w, q[:, i])
            point = turn @ c + place
            place = np.einsum("nij,nj->ni", turn, c - r @ c) + place
            turn = turn @ r
            seen.append((before, turn, point))
        tool = self.home @ self.tool(x)
        return turn @ tool[:3, :3], turn @ tool[:3, 3] + place, turn, seen

    def tool(self, x):
        t = np.eye(4)
        t[:3, :3], t[:3, 3] = expm(x[-6:-3]) @ self.turned, x[-3:]
        return t

    def residual(self, x, q, places, turns):
        turn, place, *_ = self.forward(x, q)
        return (np.concatenate([place - places, -logs(turns @ turn.transpose(0, 2, 1))], axis=1) / NOISE).ravel()

    def jacobian(self, x, q, places, turns):
        turn, place, moved, seen = self.forward(x, q)
        columns = []
        for (a, b), (before, after, point) in zip(self.across, seen):
            arm = place - point
            for e in (b, -a):  # turns the axis towards a and towards b
                w = before @ e - after @ e
                columns.append(np.concatenate([np.cross(w, arm), w], axis=1))
            for e in (a, b):
                v = before @ e - after @ e
                columns.append(np.concatenate([v, np.zeros_like(v)], axis=1))
        tip = moved @ self.home[:3, :3]
        for k in range(3):
            columns.append(np.concatenate([np.zeros_like(place), tip[:, :, k]], axis=1))
        for k in range(3):
            columns.append(np.concatenate([tip[:, :, k], np.zeros_like(place)], axis=1))
        return np.stack([(column / NOISE).ravel() for column in columns], axis=1)


def kabsch(a, b):
    u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
    r = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return r, b.mean(0) - r @ a.mean(0)


def placed(model, q, places, turns):
    """Instrument (rotation, position) and tool in turn, on the nominal robot: each has a closed form given the other."""
    x = np.zeros(4 * model.n + 6)
    for _ in range(40):
        turn, place, moved, _ = model.forward(x, q)
        spread = np.einsum("nij,nkj->ik", turns, turn) + 30 * (places - places.mean(0)).T @ (place - place.mean(0))
        u, _, vt = np.linalg.svd(spread)
        r = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        p = (places - place @ r.T).mean(0)
        tip = moved @ model.home[:3, :3]
        origin = place - np.einsum("nij,j->ni", tip, x[-3:])
        x[-3:] = np.einsum("nji,nj->ni", tip, (places - p) @ r - origin).mean(0)
        u, _, vt = np.linalg.svd(np.einsum("nji,njk->ik", tip, r.T @ turns))
        model.turned = u @ vt
    return r, p, x


def main():
    axes, train, test, method = sys.argv[1:5]
    start = time.perf_counter()
    with open(axes, encoding="utf-8") as file:
        robot = json.load(file)
    model = Model(robot["axes"], robot["home"])
    n = model.n
    def load(path):
        table = np.loadtxt(path, delimiter=",", skiprows=1)
        return table[:, :n], table[:, n:n + 3], from_quaternions(table[:, n + 3:n + 7])
    q, places, turns = load(train)
    read = time.perf_counter()
    some = slice(None, None, max(1, len(q) // 100))
    r, p, x = placed(model, q[some], places[some], turns[some])
    def in_base(places, turns):
        return (places - p) @ r, r.T @ turns
    data = (q, *in_base(places, turns))
    jacobian = "2-point" if method == "2-point" else model.jacobian
    found = least_squares(model.residual, x, jacobian, method="trf" if method == "2-point" else method, args=data, x_scale="jac")
    fitted = time.perf_counter()
    tested = model.residual(found.x, *((lambda q, m, t: (q, *in_base(m, t)))(*load(test)))).reshape(-1, 6) * NOISE
    left = found.fun.reshape(-1, 6) * NOISE
    rms = lambda part: float(np.sqrt((part**2).sum(axis=1).mean()))
    json.dump({"method": method, "read_s": read - start, "fit_s": fitted - read, "evaluations": found.nfev,
               "train": [rms(left[:, :3]), rms(left[:, 3:])], "test": [rms(tested[:, :3]), rms(tested[:, 3:])]}, sys.stdout)


if __name__ == "__main__":
    main()
