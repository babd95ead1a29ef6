"""The same digest from serial runs, two threads, Dask and Ray, with a worker killed in each.

    python tests/check.py path/to/toolroom path/to/study.toml

An engine that is not installed is skipped and named; exit code 1 where digests differ.
"""

import importlib.util
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from toolroom.shards import merge, plan, run_dask, run_ray, run_serial

SHARDS = 12
# Folder of this run, by which its processes are told from others.
SCRATCH = Path()


def killed_dask(path, out, toolroom):
    """Runs the plan on a local cluster whose first worker is killed while it works."""
    from distributed import Client, LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        victim = next(iter(client.run(os.getpid).values()))
        threading.Timer(0.5, os.kill, (victim, signal.SIGKILL)).start()
        done = run_dask(path, out, client=client, toolroom=toolroom)
        return done


def killed_ray(path, out, toolroom):
    """Runs the plan on a local Ray one of whose workers is killed while it works."""
    import ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        kill = threading.Thread(target=kill_a_child_of_ray, args=(toolroom,))
        kill.start()
        done = run_ray(path, out, toolroom=toolroom)
        kill.join()
        return done
    finally:
        ray.shutdown()


def kill_a_child_of_ray(toolroom):
    """Kills the first Ray worker that runs a shard: the parent of a toolroom process of ours."""
    for _ in range(200):
        for process in Path("/proc").glob("[0-9]*"):
            try:
                words = (process / "cmdline").read_bytes().split(b"\0")
                if words[:2] == [toolroom.encode(), b"shard"] and str(SCRATCH).encode() in b" ".join(words):
                    parent = int((process / "stat").read_text().rsplit(")", 1)[1].split()[1])
                    if parent != os.getpid():
                        os.kill(parent, signal.SIGKILL)
                        return
            except (OSError, ValueError):
                continue
        time.sleep(0.02)


def main(toolroom, study):
    global SCRATCH
    toolroom = str(Path(toolroom).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        SCRATCH = Path(scratch)
        path = plan(study, SCRATCH / "plan.json", SHARDS, toolroom)
        digests = {}

        def take(name, run):
            parts = SCRATCH / name
            started = time.time()
            assert run(path, parts, toolroom=toolroom) == list(range(SHARDS))
            digests[name] = merge(parts, SCRATCH / f"{name}-out", toolroom)["digest"]
            print(f"{name:12} {digests[name]}  {time.time() - started:.1f} s", flush=True)

        take("serial", run_serial)
        take("two-threads", lambda path, parts, toolroom: run_serial(path, parts, toolroom, threads=2))
        for engine, module, run in [("dask", "distributed", killed_dask), ("ray", "ray", killed_ray)]:
            if importlib.util.find_spec(module) is None:
                print(f"{engine}: skipped, {module} is not installed")
            else:
                take(engine, run)
        if len(set(digests.values())) != 1:
            sys.exit(f"digests differ: {digests}")


if __name__ == "__main__":
    main(*sys.argv[1:])
