#!/usr/bin/env bash
# One shard of a plan per task of a Slurm array, on a file system that every node sees:
#
#   toolroom life study.toml --plan plan.json --shards 256
#   job=$(sbatch --parsable --array=0-255 toolroom-array.sh plan.json parts)
#   sbatch --dependency=afterok:$job --wrap "toolroom merge parts --out out/study"
#
# A task that is requeued, or submitted again after a node has died, finds the parts that are
# complete and runs nothing twice.
#SBATCH --job-name=toolroom
#SBATCH --cpus-per-task=1
#SBATCH --mem=512M
#SBATCH --requeue
set -euo pipefail
exec toolroom shard "$1" "${SLURM_ARRAY_TASK_ID:?run as a job array}" --out "$2" \
  --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet
