# shellcheck shell=bash
# Jobs: list, cancel, repeat, many at a time.

test_the_list_pages_through_all_jobs_newest_first() {
  local i path="/v1/jobs?limit=2" page ids=()
  for i in 1 2 3 4 5; do submit "$models/tetrahedron.glb"; done
  for ((page = 0; page < 3; ++page)); do
    get "$path"
    expect "the status" "$STATUS" 200
    expect "the items on a page" "$(json '.items | length')" 2
    mapfile -t -O ${#ids[@]} ids < <(json '.items[].id')
    path=$(header link | sed -n 's/^<\(.*\)>; *rel="\{0,1\}next"\{0,1\}.*$/\1/p')
    expect_match "the link to the next page" "$path" '^/v1/jobs\?'
  done
  expect "the first id is the last job's" "/v1/jobs/${ids[0]}" "$JOB"
  expect "the ids fall" "$(printf '%s\n' "${ids[@]}")" "$(printf '%s\n' "${ids[@]}" | sort --reverse --unique)"
}

test_the_list_can_be_narrowed_to_a_state() {
  submit "$models/torus.glb"
  await "$JOB"
  get '/v1/jobs?state=failed&limit=100'
  expect "all of them failed" "$(json '[.items[].state] | unique | join(" ")')" failed
  get '/v1/jobs?state=asleep'
  expect_problem 400 bad-request state
}

test_a_running_job_is_canceled_and_its_place_is_free_again() {
  start_service cancel --workers 1
  submit "$models/egg-327680.glb"
  local long=$JOB
  await_state "$long" running
  request DELETE "$long"
  expect "the status" "$STATUS" 200
  await "$long"
  expect "the state" "$STATE" canceled
  get "$long/result"
  expect_problem 409 canceled
  request DELETE "$long"
  expect "the status of a second DELETE" "$STATUS" 200
  expect "the state after it" "$(json .state)" canceled
  textured after-cancel "$models/tetrahedron.glb"
  stop_service
}

test_a_queued_job_is_canceled_at_once() {
  start_service cancel-queued --workers 1
  submit "$models/egg-327680.glb"
  local running=$JOB
  submit "$models/egg-81920.glb"
  get "$JOB"
  expect "the state" "$(json .state)" queued
  expect "its place in the queue" "$(json .queue_position)" 1
  request DELETE "$JOB"
  expect "the state" "$(json .state)" canceled
  request DELETE "$running"
  stop_service
}

test_an_unfinished_result_is_a_409() {
  start_service unfinished --workers 1
  submit "$models/egg-327680.glb"
  get "$JOB/result"
  expect_problem 409 not-finished
  request DELETE "$JOB"
  stop_service
}

test_deleting_a_finished_job_leaves_it_as_it_is() {
  submit "$models/tetrahedron.glb"
  await "$JOB"
  request DELETE "$JOB"
  expect "the status" "$STATUS" 200
  expect "the state" "$(json .state)" succeeded
}

test_progress_never_falls() {
  start_service progress --workers 1
  submit "$models/egg-81920.glb"
  local last=0 percent
  while
    get "$JOB"
    STATE=$(json .state)
    [[ $STATE =~ ^(queued|running)$ ]]
  do
    percent=$(json '.progress.percent // 0')
    expect "$percent is not below $last" "$(jq --null-input "$percent >= $last")" true
    last=$percent
  done
  expect "the state" "$STATE" succeeded
  expect "there was progress in between" "$(jq --null-input "$last > 0")" true
  stop_service
}

test_many_jobs_at_a_time_all_succeed() {
  start_service many --workers 2
  local i jobs=() option=(objective=isometric objective=shape-preserving texture_format=jpeg compression=draco)
  for i in {0..11}; do
    QUERY="${option[i % 4]}&texture_size=$((128 + i))" submit "$models/egg.glb"
    jobs+=("$JOB")
  done
  for JOB in "${jobs[@]}"; do
    await "$JOB"
    expect "the state" "$STATE" succeeded
    get "$JOB/result"
    expect_textured "many-$(basename "$JOB")"
  done
  stop_service
}

test_a_key_used_again_gives_the_same_job() {
  submit "$models/egg.glb" --header 'Idempotency-Key: breakfast'
  local first=$JOB
  submit "$models/egg.glb" --header 'Idempotency-Key: breakfast'
  expect "the second job" "$JOB" "$first"
  post "$models/crate.glb" --header 'Idempotency-Key: breakfast'
  expect_problem 422 key-reused
}

test_a_request_that_was_answered_before_is_answered_at_once() {
  start_service cached --cache on
  submit "$models/egg.glb"
  await "$JOB"
  expect "the first job's mark" "$(json .cached)" false
  local first=$JOB sha256
  sha256=$(json .result.sha256)
  submit "$models/egg.glb"
  get "$JOB"
  expect "the state" "$(json .state)" succeeded
  expect "the mark" "$(json .cached)" true
  expect "the result" "$(json .result.sha256)" "$sha256"
  [ "$JOB" != "$first" ] || fail "the job is not one of its own"
  get "$JOB/report"
  expect "the status of the report" "$STATUS" 200
  stop_service
}
