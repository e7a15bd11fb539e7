# shellcheck shell=bash
# What cannot be done is refused with a problem document that says what is wrong and what to do. `request` checks the
# form of every one of them.

# refused FILE STATUS SLUG [REGEX]
refused() {
  post "$models/$1"
  outcome
  expect_problem "${@:2}"
}

# The same where nothing may be repaired.
refused_strictly() { QUERY="$QUERY&topology=strict" refused "$@"; }

test_an_empty_body_is_a_400() {
  request POST /v1/jobs --header 'Content-Type: model/gltf-binary' --data-binary ''
  expect_problem 400 bad-request
}

test_a_form_without_a_model_is_a_400() {
  post_parts 'options={}'
  expect_problem 400 bad-request model
}

test_options_that_are_not_json_are_a_400_or_422() {
  post_parts "model=@$models/egg.glb" 'options={texture_size'
  expect_match "the status" "$STATUS" '^4(00|22)$'
}

test_a_truncated_glb_is_malformed() { refused truncated.glb 400 malformed; }
test_a_truncated_gltf_is_malformed() { refused truncated.gltf 400 malformed; }
test_truncated_draco_is_malformed() { refused truncated.drc 400 malformed; }
test_an_index_out_of_range_is_malformed() { refused index-out-of-range.glb 400 malformed; }

test_8_mb_of_garbage_are_an_unsupported_format() { refused garbage.bin 415 unsupported-format; }

test_8_mb_of_garbage_after_a_glb_header_are_malformed() {
  { head -c 20 "$models/egg.glb"; cat "$models/garbage.bin"; } >"$work/dressed.glb"
  post "$work/dressed.glb"
  outcome
  expect_problem 400 malformed
}

test_8_mb_of_garbage_after_a_draco_header_are_malformed() {
  { head -c 11 "$models/egg.drc"; cat "$models/garbage.bin"; } >"$work/dressed.drc"
  post "$work/dressed.drc"
  outcome
  expect_problem 400 malformed
}

test_a_file_that_a_zip_lacks_is_named() { refused incomplete.zip 422 missing-resource "'crate%20colours.png'|'crate colours.png'"; }

test_a_file_that_a_form_lacks_is_named() {
  post_parts "model=@$models/crate.gltf" "bin=@$models/crate.bin"
  outcome
  expect_problem 422 missing-resource 'crate colours.png'
}

test_a_zip_whose_names_climb_out_is_malformed() { refused climbing.zip 400 malformed 'leads out of the archive'; }
test_a_zip_bomb_is_too_large() { refused bomb.zip 413 too-large '200 times'; }

test_an_unknown_path_is_a_404() {
  get /v1/nothing
  expect_problem 404 not-found
}

test_an_unknown_job_is_a_404() {
  local part
  for part in '' /result /report /atlas.png /preview.png /events; do
    get "/v1/jobs/01ARZ3NDEKTSV4RRFFQ69G5FAV$part"
    expect_problem 404 not-found
  done
}

test_a_path_that_climbs_out_is_a_404() {
  get '/v1/jobs/..%2f..%2f..%2fetc%2fpasswd/result' --path-as-is
  expect_match "the status" "$STATUS" '^40[04]$'
}

test_a_method_that_does_not_fit_is_a_405_which_says_what_does() {
  request PUT /v1/jobs --data ''
  expect_problem 405 method-not-allowed
  expect_match "the allowed methods" "$(header allow)" 'GET.*POST|POST.*GET'
  request POST /livez --data ''
  expect_problem 405 method-not-allowed
}

test_a_media_type_that_is_no_model_is_a_415() {
  request POST /v1/jobs --header 'Content-Type: text/plain' --data-binary @"$models/egg.glb"
  expect_problem 415 unsupported-media-type
}

test_a_picture_is_an_unsupported_format() { refused px.png 415 unsupported-format; }

test_an_unknown_option_is_a_422() {
  QUERY='texture_siez=512' post "$models/egg.glb"
  expect_problem 422 invalid-option texture_siez
}

test_an_option_out_of_range_is_a_422_that_names_it() {
  QUERY='texture_size=63' post "$models/egg.glb"
  expect_problem 422 invalid-option texture_size
  expect "the pointer" "$(json '.errors[0].pointer')" /texture_size
}

test_a_torus_is_refused_by_its_genus() { refused_strictly torus.glb 422 not-genus-zero 'genus 1|handle'; }
test_two_components_are_counted() { refused_strictly two-eggs.glb 422 not-genus-zero '2 (connected )?(components|parts)|two (components|parts)'; }
test_an_open_surface_is_refused_by_its_boundary() { refused_strictly bowl.glb 422 not-genus-zero 'boundar|open|loop'; }
test_an_edge_with_four_triangles_is_refused() { refused_strictly shared-edge.glb 422 not-genus-zero 'manifold'; }

test_what_strict_refuses_comes_back_repaired() {
  local model
  for model in torus two-eggs bowl shared-edge; do
    textured "repaired-$model" "$models/$model.glb"
    expect "the result of $model is whole" "$(json .partial)" false
  done
}

test_a_coordinate_that_is_no_number_is_refused() {
  post "$models/nan.glb"
  outcome
  expect_match "the problem" "$STATUS $(json .type)" '^(422 /problems/invalid-geometry|400 /problems/malformed)$'
}

test_a_required_extension_that_is_unknown_is_named() {
  refused required-extension.glb 422 unsupported-feature EXT_unheard_of
}

test_a_gltf_whose_files_did_not_come_is_refused_and_names_them() {
  refused crate.gltf 422 missing-resource 'crate'
}

test_files_of_this_machine_are_never_opened() {
  local uri
  for uri in /etc/passwd ../../../../etc/passwd file:///etc/passwd "http://127.0.0.1:${URL##*:}/livez"; do
    jq --compact-output --arg uri "$uri" '.buffers[0].uri = $uri' "$models/crate.gltf" >"$work/climbing.gltf"
    post "$work/climbing.gltf"
    outcome
    expect_match "the status for $uri" "$STATUS" '^4(00|22)$'
  done
}

test_a_failed_job_keeps_its_problem() {
  QUERY="$QUERY&topology=strict" submit "$models/torus.glb"
  await "$JOB"
  expect "the state" "$STATE" failed
  expect "the job's problem" "$(json .problem.type)" /problems/not-genus-zero
  expect "the progress' percent is below 100" "$(json '(.progress.percent // 0) < 100')" true
  get "$JOB/report"
  expect_match "the status of the report" "$STATUS" '^4'
}
