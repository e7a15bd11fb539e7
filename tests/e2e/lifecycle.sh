# shellcheck shell=bash
# The service's life: restart, drain, a full queue, limits.

test_jobs_and_results_survive_a_restart() {
  local finished queued hash
  start_service restart --workers 1
  submit "$models/egg.glb"
  finished=$JOB
  await "$finished"
  hash=$(json .result.sha256)
  submit "$models/egg-327680.glb"
  submit "$models/tetrahedron.glb"
  queued=$JOB
  signal_service KILL # no chance to tidy up
  await_exit

  start_service restart --workers 1
  get "$finished/result"
  expect "the status of the result" "$STATUS" 200
  expect "its hash" "$(sha256sum <"$BODY" | cut -d' ' -f1)" "$hash"
  await "$queued"
  expect "the queued job's state" "$STATE" succeeded
  stop_service
}

test_sigterm_drains_what_runs_finishes_and_new_jobs_get_503() {
  start_service drain --workers 1 --drain 120
  submit "$models/egg-81920.glb"
  local running=$JOB i
  await_state "$running" 'running|succeeded'
  signal_service TERM
  for ((i = 0; i < 100; ++i)); do
    get /readyz
    [ "$STATUS" = 200 ] || break
    sleep 0.05
  done
  # It may have ended already where the machine is fast; while it answers, it refuses.
  post "$models/tetrahedron.glb"
  if [[ $STATUS != no* ]]; then
    expect_problem 503 draining
    expect_match "Retry-After" "$(header retry-after)" '^[0-9]+$'
  fi
  await_exit
  expect "the exit status" "$EXIT" 0
  start_service drain
  get "$running"
  expect "the state of the job that was running" "$(json .state)" succeeded
  stop_service
}

test_a_full_queue_is_a_429_that_says_when_to_come_back() {
  start_service full --workers 1 --queue 1
  local i
  for i in 1 2 3; do post "$models/egg-327680.glb"; done
  expect_problem 429 queue-full
  expect_match "Retry-After" "$(header retry-after)" '^[0-9]+$'
  get /readyz
  expect "the service is ready all the same" "$STATUS" 200
  signal_service KILL
  await_exit
}

test_a_body_above_the_limit_is_a_413_that_says_the_limit() {
  start_service small --max-bytes 100000
  post "$models/egg-81920.glb"
  expect_problem 413 too-large 100000
  textured small "$models/egg.glb"
  stop_service
}

test_a_job_above_its_time_limit_fails_alone() {
  start_service slow --workers 1 --job-seconds 5
  QUERY='objective=shape-preserving&threshold=0.9999' post "$models/egg-327680.glb"
  outcome
  expect_problem 422 out-of-time
  textured after-slow "$models/tetrahedron.glb"
  stop_service
}

test_a_job_above_its_memory_limit_fails_alone() {
  start_service narrow --workers 1 --job-memory 300M
  QUERY='texture_size=4096' post "$models/egg-327680.glb"
  outcome
  expect_problem 422 out-of-memory
  textured after-narrow "$models/tetrahedron.glb"
  stop_service
}

test_with_keys_set_a_request_without_one_is_a_401_and_with_a_wrong_one_a_403() {
  start_service keys --keys open-sesame,second-key
  post "$models/tetrahedron.glb"
  expect_problem 401 unauthorized
  expect "WWW-Authenticate" "$(header www-authenticate)" Bearer
  post "$models/tetrahedron.glb" --header 'Authorization: Bearer open-barley'
  expect_problem 403 forbidden
  post "$models/tetrahedron.glb" --header 'Authorization: Bearer second-key'
  accepted
  get /livez
  expect "the probe needs no key" "$STATUS" 200
  stop_service
}

test_an_unknown_setting_is_refused_at_the_start() {
  EXIT=0
  orbis_command serve --no-such-setting 1 >/dev/null 2>"$work/start.err" || EXIT=$?
  expect_match "the exit status" "$EXIT" '^[12]$'
  grep -q no-such-setting "$work/start.err" || fail "the message does not name it: $(cat "$work/start.err")"
}

test_a_data_directory_that_another_service_holds_is_refused_by_name() {
  [ -z "${ORBIS_IMAGE:-}" ] || skip "two containers see different directories"
  start_service held
  local exit=0
  "$orbis" serve --port 0 --data "$work/held" 2>"$work/second.err" || exit=$?
  expect "the exit status" "$exit" 2
  expect "the problem" "$(jq --raw-output .type "$work/second.err")" /problems/invalid-option
  expect_match "the detail" "$(jq --raw-output .detail "$work/second.err")" "another orbis serves.*$work/held"
  stop_service
}
