#!/bin/bash
# The embedding alone, on the closed genus-0 models of a folder of models that lies beside the project; without it, nothing to measure.
#   tests/bench/embedding.sh build/orbis [MODELS]
set -euo pipefail
build=$(dirname "$1")
models=${2:-$(dirname "$0")/../../../shared/data}
[ -d "$models" ] || { echo "no models at $models: nothing to measure" >&2; exit 0; }
cmake --build "$build" --target bench_embedding >&2
cd "$models"
chosen=(closed0/spot-textured.glb closed0/horse-textured-10k.glb closed0/cat-15k.drc closed0/hand-closed-16k.glb
  closed0/nefertiti-70k-draco.glb closed0/lion-100k.drc closed0/scorpion-100k.glb made/nefertiti-loop2-1120k.drc)
echo "isometric"
"$OLDPWD/$build/bench_embedding" --threads 1 "${chosen[@]}"
echo
echo "isometric, two threads"
"$OLDPWD/$build/bench_embedding" --threads 2 "${chosen[@]}"
echo
echo "shape-preserving"
"$OLDPWD/$build/bench_embedding" --objective shape-preserving --runs 1 "${chosen[@]:0:7}"
