"""A process that runs the plant of the working directory on a Ray cluster: driver.py ADDRESS STORE RESULT.

It may be killed. The result goes to a file, as Ray may write to standard output.
"""

import json
import sys
from dataclasses import asdict
from pathlib import Path

import denavit as dn
import ray

ray.init(address=sys.argv[1], log_to_driver=False)
done = dn.fleet.run("plant.csv", sys.argv[2], engine="ray")
Path(sys.argv[3]).write_text(json.dumps(asdict(done), default=str), encoding="utf-8")
