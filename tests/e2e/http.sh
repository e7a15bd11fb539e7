# shellcheck shell=bash
# The conventions of HTTP that scripts rely on.

# done_job: a finished job in JOB, made once.
done_job() {
  post "$models/egg.glb"
  expect "the status" "$STATUS" 202
  JOB=$(header location)
  await "$JOB"
  expect "the state" "$STATE" succeeded
}

test_a_post_answers_202_with_the_job_and_where_it_is() {
  post "$models/egg.glb"
  expect "the status" "$STATUS" 202
  expect "the location" "$(header location)" "$(json .links.self)"
  expect_match "Retry-After" "$(header retry-after)" '^[0-9]+$'
  expect_match "the state" "$(json .state)" '^(queued|running|succeeded)$'
  expect "the input's bytes" "$(json .input.bytes)" "$(stat --format %s "$models/egg.glb")"
  expect "the input's hash" "$(json .input.sha256)" "$(sha256sum <"$models/egg.glb" | cut -d' ' -f1)"
}

test_prefer_wait_answers_a_post_with_the_glb_itself() {
  post "$models/egg.glb" --header 'Prefer: wait=60'
  expect "the status" "$STATUS" 200
  expect "the media type" "$(header content-type)" model/gltf-binary
  expect_match "Preference-Applied" "$(header preference-applied)" '^wait'
  expect "the first bytes" "$(head -c 4 "$BODY")" glTF
  JOB=$(header location)
  expect_textured prefer-wait
}

test_prefer_wait_answers_a_post_with_the_problem_itself() {
  QUERY="$QUERY&topology=strict" post "$models/torus.glb" --header 'Prefer: wait=60'
  expect_problem 422 not-genus-zero
}

test_prefer_wait_gives_202_when_the_time_is_too_short() {
  post "$models/egg-327680.glb" --header 'Prefer: wait=0'
  accepted
  request DELETE "$JOB"
}

test_the_result_has_a_strong_tag_that_is_its_hash() {
  done_job
  get "$JOB/result"
  expect "the status" "$STATUS" 200
  expect "the tag" "$(header etag)" "\"$(sha256sum <"$BODY" | cut -d' ' -f1)\""
  expect_match "Content-Disposition" "$(header content-disposition)" '^attachment; filename=".*\.glb"$'
  expect_match "Server-Timing" "$(header server-timing)" 'dur='
}

test_a_known_tag_gives_304_without_a_body() {
  done_job
  get "$JOB/result"
  get "$JOB/result" --header "If-None-Match: $(header etag)"
  expect "the status" "$STATUS" 304
  expect "the body's size" "$(stat --format %s "$BODY")" 0
  get "$JOB"
  get "$JOB" --header "If-None-Match: $(header etag)"
  expect "the job's status" "$STATUS" 304
}

test_one_range_gives_that_part() {
  done_job
  get "$JOB/result"
  local size whole="$work/whole"
  size=$(stat --format %s "$BODY")
  cp "$BODY" "$whole"
  get "$JOB/result" --range 4-11
  expect "the status" "$STATUS" 206
  expect "Content-Range" "$(header content-range)" "bytes 4-11/$size"
  cmp "$BODY" <(tail -c +5 "$whole" | head -c 8) || fail "the part differs from the whole"
  get "$JOB/result" --range -16
  expect "the status" "$STATUS" 206
  cmp "$BODY" <(tail -c 16 "$whole") || fail "the tail differs from the whole"
}

test_a_range_beyond_the_end_is_a_416() {
  done_job
  get "$JOB/result" --range 999999999-
  expect_problem 416 range-not-satisfiable
  expect_match "Content-Range" "$(header content-range)" '^bytes \*/[0-9]+$'
}

test_head_gives_the_headers_alone() {
  done_job
  get "$JOB/result"
  local size
  size=$(stat --format %s "$BODY")
  request HEAD "$JOB/result"
  expect "the status" "$STATUS" 200
  expect "Content-Length" "$(header content-length)" "$size"
}

test_the_report_and_the_job_tell_the_same_times() {
  done_job
  expect "the stages" "$(json '.timing.stages | map(.name) | index("simplify") < index("refine") and index("refine") < index("optimise")')" true
  expect "the triangles" "$(json .input.triangles)" 1280
  get "$JOB/report"
  expect "the input's triangles" "$(json .input.triangles)" 1280
  expect "the report has t1, t2 and t3" "$(json '.embedding | [.t1_ms, .t2_ms, .t3_ms] | all(. >= 0)')" true
}

test_the_probes_answer() {
  local probe
  for probe in livez readyz metrics; do
    get "/$probe"
    expect "the status of /$probe" "$STATUS" 200
  done
  grep -q '^# TYPE orbis_' "$BODY" || fail "the metrics name nothing of orbis"
}

test_the_contract_is_served() {
  get /openapi.json
  expect "the status" "$STATUS" 200
  expect_match "the version of OpenAPI" "$(json .openapi)" '^3\.1'
}

test_every_problem_type_has_a_page() {
  get /problems/not-genus-zero
  expect "the status" "$STATUS" 200
  expect "the problem's status" "$(json .status)" 422
}

test_events_tell_the_job_to_its_end() {
  submit "$models/egg-81920.glb"
  curl --silent --max-time 60 "$URL$JOB/events" >"$work/events"
  grep -q '^event: progress' "$work/events" || fail "there is no progress event"
  expect "the last state" "$(grep '^data: ' "$work/events" | tail -n 1 | cut -c7- | jq --raw-output .state)" succeeded
  grep '^id: ' "$work/events" | cut -c5- | sort --check --numeric-sort || fail "an id falls"
}
