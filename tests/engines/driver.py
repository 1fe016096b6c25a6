"""A process that runs the plant of the working directory on a Ray cluster: driver.py ADDRESS STORE. It may be killed."""

import json
import sys
from dataclasses import asdict

import denavit as dn
import ray

ray.init(address=sys.argv[1], log_to_driver=False)
done = dn.fleet.run("plant.csv", sys.argv[2], engine="ray")
print(json.dumps(asdict(done), default=str))
