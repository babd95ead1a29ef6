"""``toolroom-shards plan.json parts --engine dask``"""

import argparse
import sys

from . import ShardFailed, merge, run_dask, run_ray, run_serial


def main():
    parser = argparse.ArgumentParser(prog="toolroom-shards", description="Run the shards of a toolroom plan.")
    parser.add_argument("plan", help="plan made by toolroom life FILE --plan")
    parser.add_argument("parts", help="directory of the parts, the same on every host")
    parser.add_argument("--engine", choices=["serial", "dask", "ray"], default="serial")
    parser.add_argument("--address", help="of a running scheduler; a local cluster if left out")
    parser.add_argument("--toolroom", default="toolroom", help="the command on every host")
    parser.add_argument("--result", help="directory of the merged result; not merged if left out")
    arguments = parser.parse_args()
    try:
        if arguments.engine == "dask":
            run_dask(arguments.plan, arguments.parts, address=arguments.address, toolroom=arguments.toolroom)
        elif arguments.engine == "ray":
            run_ray(arguments.plan, arguments.parts, address=arguments.address, toolroom=arguments.toolroom)
        else:
            run_serial(arguments.plan, arguments.parts, toolroom=arguments.toolroom)
        if arguments.result:
            print(merge(arguments.parts, arguments.result, arguments.toolroom)["digest"])
    except (ShardFailed, FileNotFoundError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
