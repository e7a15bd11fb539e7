#!/bin/bash
# livez.sh BINARY: how long /livez takes while the service works at full load. Prints milliseconds; asserts nothing.
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
orbis=$(readlink -f "$1")
work=$(mktemp -d)
models="$work/models"
. "$here/../e2e/lib.sh"
OWN_SERVICE=""
trap 'end_own_service; rm -rf "$work"' EXIT
node "$here/../e2e/make_models.mjs" "$models"

start_service data
for _ in $(seq "$(($(nproc) + 1))"); do submit "$models/egg-327680.glb"; done
last=$JOB
# One connection for all requests, as a load balancer's probe has it.
while [ "$(get "$last"; json .state)" = queued ]; do
  curl --silent --output /dev/null --write-out '%{time_total}\n' "$URL/livez?[1-50]"
done | grep -E '^[0-9.]+$' | sort -n | awk '
  { ms[NR] = $1 * 1000 }
  END { printf "/livez under load, %d requests: median %.1f ms, p99 %.1f ms, slowest %.1f ms\n",
          NR, ms[int((NR + 1) / 2)], ms[int(NR * 0.99 + 0.5)], ms[NR] }'
stop_service
