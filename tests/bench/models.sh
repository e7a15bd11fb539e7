#!/bin/bash
# models.sh BINARY: time and quality over the closed genus-0 models of the collection beside the checkout, both
# objectives. One row per run; the columns are the report's.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
orbis=$(readlink -f "$1")
shared_data=$(readlink -m "$here/../../../shared/data")
[ -r "$shared_data/MANIFEST.tsv" ] || { echo "there is no collection of models at ../shared/data"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

printf '%-32s %9s %-16s %8s %8s %8s %8s %8s %8s %8s\n' model triangles objective t1_ms t2_ms t3_ms wall_ms cpu_ms minimum dirichlet
while IFS=$'\t' read -r path _ _ _ _ class triangles _; do
  [ "$class" = SINGLE-CLOSED0 ] && [ "$triangles" -ge 5000 ] || continue
  for objective in isometric shape-preserving; do
    "$orbis" run "$shared_data/$path" -o "$work/out.glb" --report "$work/report.json" --objective $objective \
      2>"$work/error" || { printf '%-32s %9s %-16s %s\n' "$(basename "$path")" "$triangles" $objective "$(head -c 200 "$work/error")"; continue; }
    jq --raw-output --arg model "$(basename "$path")" --arg triangles "$triangles" --arg objective $objective '
      [$model, $triangles, $objective, (.embedding | .t1_ms, .t2_ms, .t3_ms), .timing.wall_ms, .timing.cpu_ms,
       .embedding.minimum, .distortion.symmetric_dirichlet] | @tsv' "$work/report.json" |
      awk -F'\t' '{ printf "%-32s %9d %-16s %8.0f %8.0f %8.0f %8.0f %8.0f %8.2f %8.3f\n", $1, $2, $3, $4, $5, $6, $7, $8, $9, $10 }'
  done
done < <(tail -n +2 "$shared_data/MANIFEST.tsv" | sort --field-separator=$'\t' --key=7n)
