"""A user's script that mypy --strict reads without complaint; it runs, too."""

import numpy as np

import denavit as dn

robot = dn.load("robots/universal_robots/ur5e.urdf")
chain = robot.chain("base", "tool0")
Q = chain.sample(100, seed=0)
out = np.empty((100, 3))
tips = chain.tips(Q, out=out, threads=2)
reach: float = float(np.linalg.norm(tips, axis=1).max())
table = chain.table("distal")
offsets: list[float | None] = [row.d for row in table.rows]
same: bool = dn.diff(robot, "robots/universal_robots/ur5e_dh.csv").same
run = chain.simulate(60, seed=1, test=20)
fit = dn.calibrate(chain, run.data, test=run.test, effects=None)
rms: float = float(np.sqrt(np.mean(fit.residuals.distance**2)))
names: list[str] = [effect.kind for effect in fit.effects]
sure: list[float] = [parameter.sd for parameter in fit.parameters]
added = fit.curves["elbow_joint"](Q[:, 2])
commands = fit.compensate(chain.fk(Q[:2])).q
poses = chain.plan(12, spread=100).q
