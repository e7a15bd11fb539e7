# shellcheck shell=bash
# `orbis run`: the same job without a server.

# run_orbis INPUT [ARGUMENTS…]: sets EXIT; the result is $work/run.glb, the report $work/run.json, standard error
# $work/run.err.
run_orbis() {
  local input=$1
  shift
  rm -f "$work"/run.{glb,json,err}
  EXIT=0
  orbis_command run "$input" -o "$work/run.glb" --report "$work/run.json" "$@" 2>"$work/run.err" || EXIT=$?
}

test_run_writes_the_result_and_the_report() {
  run_orbis "$models/egg.glb" --texture-size 512
  expect "the exit status" "$EXIT" 0
  expect "the first bytes" "$(head -c 4 "$work/run.glb")" glTF
  expect "the certificate" "$(jq .certificate.valid "$work/run.json")" true
  expect "the texture's size" "$(jq .options.texture_size "$work/run.json")" 512
  cp "$work/run.glb" "$outputs/command-line.glb"
}

test_run_gives_the_same_bytes_as_the_service() {
  run_orbis "$models/egg.glb" --texture-size 256
  textured same-as-run "$models/egg.glb"
  cmp "$work/run.glb" "$outputs/same-as-run.glb" || fail "the two results differ"
}

test_run_refuses_a_torus_with_2_and_the_problem_document() {
  run_orbis "$models/torus.glb" --topology strict
  expect "the exit status" "$EXIT" 2
  expect "the problem" "$(jq --raw-output .type "$work/run.err")" /problems/not-genus-zero
  [ ! -e "$work/run.glb" ] || fail "there is a result all the same"
}

test_run_names_a_file_that_cannot_be_opened() {
  run_orbis "$work/no-such-file.glb"
  expect "the exit status" "$EXIT" 2
  expect "the problem" "$(jq --raw-output .type "$work/run.err")" /problems/missing-resource
  expect_match "the detail" "$(jq --raw-output .detail "$work/run.err")" 'no-such-file.glb'
  run_orbis "$models/egg.glb" --attach "$work/no-such-image.png"
  expect "the exit status" "$EXIT" 2
}

test_run_finds_the_files_that_a_model_names_beside_it() {
  local model
  for model in crate.gltf crate.obj; do
    run_orbis "$models/$model" --texture-size 64
    expect "the exit status of $model" "$EXIT" 0
    expect "what the atlas of $model shows" "$(jq --raw-output .atlas.source "$work/run.json")" base_color
  done
  # Alone in its directory it lacks them.
  mkdir -p "$work/alone"
  cp "$models/crate.gltf" "$work/alone/"
  run_orbis "$work/alone/crate.gltf"
  expect "the exit status" "$EXIT" 2
  expect_match "the detail" "$(jq --raw-output .detail "$work/run.err")" 'crate.bin'
}

test_run_dumps_its_stages() {
  run_orbis "$models/egg.glb" --texture-size 256 --dump-stages "$work/stages"
  expect "the exit status" "$EXIT" 0
  compgen -G "$work/stages/*.obj" >/dev/null || fail "there is no OBJ among: $(ls "$work/stages")"
  compgen -G "$work/stages/*.png" >/dev/null || fail "there is no PNG among: $(ls "$work/stages")"
}
