"""Runs the shards of a toolroom plan on an existing engine.

A plan (``toolroom life`` or ``compare FILE --plan plan.json --shards N``) is cut into shards; each is one call of
the ``toolroom`` command that writes a part and its sidecar and does nothing where they are there
already. So a shard may be run twice, on another host, or again after its worker has died: the
merged result is the same, bit for bit.

    from toolroom.shards import run_dask, merge
    run_dask("plan.json", "parts", address="tcp://scheduler:8786")
    summary = merge("parts")
    print(summary["digest"])
"""

import json
import shutil
import subprocess
from pathlib import Path

__all__ = ["ShardFailed", "merge", "plan", "run_dask", "run_ray", "run_serial", "run_shard", "shards"]


class ShardFailed(RuntimeError):
    """The command refused a shard or died in it; the message is what it said."""

    def __init__(self, shard, code, said):
        super().__init__(f"shard {shard}: exit code {code}: {said.strip()}")
        self.shard, self.code, self.said = shard, code, said

    def __reduce__(self):
        return ShardFailed, (self.shard, self.code, self.said)


def _command(toolroom):
    found = shutil.which(toolroom)
    if found is None:
        raise FileNotFoundError(f"{toolroom} is not on this host's PATH; install the version that made the plan")
    return found


def plan(study, path, count, toolroom="toolroom", verb="life"):
    """Cuts a study into `count` shards and writes the plan; `verb` is "compare" for a shop."""
    said = subprocess.run(
        [_command(toolroom), verb, str(study), "--plan", str(path), "--shards", str(count)],
        capture_output=True,
        text=True,
    )
    if said.returncode != 0:
        raise ShardFailed("of the plan", said.returncode, said.stderr)
    return Path(path)


def shards(path):
    """Numbers of the shards of a plan."""
    return range(json.loads(Path(path).read_text())["shards"])


def run_shard(path, shard, out, toolroom="toolroom", threads=1):
    """Runs one shard; returns its number."""
    said = subprocess.run(
        [
            _command(toolroom), "shard", str(path), str(shard), "--out", str(out), "--threads", str(threads), "--quiet",
        ],
        capture_output=True,
        text=True,
    )
    if said.returncode != 0:
        raise ShardFailed(shard, said.returncode, said.stderr)
    return shard


def run_serial(path, out, toolroom="toolroom", threads=1):
    """Runs every shard one after the other."""
    return [run_shard(path, shard, out, toolroom, threads) for shard in shards(path)]


def run_dask(path, out, address=None, client=None, toolroom="toolroom", retries=3):
    """Runs every shard on a Dask cluster: a client, the address of a scheduler, or a local cluster.

    Tasks of a worker that dies are run again on another one; `retries` counts shards that fail.
    """
    from distributed import Client, as_completed

    own = None
    if client is None:
        client = own = Client(address) if address else Client(threads_per_worker=1)
    try:
        futures = client.map(
            lambda shard: run_shard(path, shard, out, toolroom), list(shards(path)), retries=retries, pure=False
        )
        return sorted(future.result() for future in as_completed(futures))
    finally:
        if own is not None:
            own.close()


def run_ray(path, out, address=None, toolroom="toolroom", retries=3):
    """Runs every shard on a Ray cluster, or on a local one where no address is given.

    Tasks of a worker that dies, and shards that fail, are run again `retries` times.
    """
    import ray

    own = not ray.is_initialized()
    if own:
        ray.init(address=address, include_dashboard=False, log_to_driver=False)
    try:
        task = ray.remote(max_retries=retries, retry_exceptions=True, num_cpus=1)(run_shard)
        return sorted(ray.get([task.remote(str(path), shard, str(out), toolroom) for shard in shards(path)]))
    finally:
        if own:
            ray.shutdown()


def merge(out, result=None, toolroom="toolroom"):
    """Merges the parts and returns the summary; `result` is the directory of the report."""
    arguments = [_command(toolroom), "merge", str(out), "--json"]
    if result is not None:
        arguments += ["--out", str(result)]
    said = subprocess.run(arguments, capture_output=True, text=True)
    if said.returncode != 0:
        raise ShardFailed("to be merged", said.returncode, said.stderr)
    return json.loads(said.stdout)
