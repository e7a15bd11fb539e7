# shellcheck shell=bash disable=SC2034 # STATUS, JOB and others are for the test files
# What the end-to-end tests are written in. Sourced by `run`, which sets $work (a directory of its own), $models (the
# generated models) and $outputs (every GLB that the service returned, for the validator).
#
# A test is a function test_…; its name is the sentence it proves. It runs in a subshell of its own and ends at the
# first expectation that does not hold.

fail() {
  printf '    %s\n' "$@"
  exit 1
}

skip() {
  printf '    %s\n' "$@"
  exit 77
}

# expect WHAT ACTUAL EXPECTED
expect() { [ "$2" = "$3" ] || fail "$1 is '$2', expected '$3'" "last answer: $STATUS $(describe_body)"; }

# expect_match WHAT ACTUAL REGEX
expect_match() { [[ $2 =~ $3 ]] || fail "$1 is '$2', expected to match '$3'"; }

describe_body() { head -c 600 "$BODY" | tr -c '[:print:]\n' '.'; }

# orbis_command ARGUMENTS…: the program itself; in a container of its own where an image is tested.
orbis_command() {
  if [ -n "${ORBIS_IMAGE:-}" ]; then
    "$DOCKER" run --rm --network none --read-only --tmpfs /tmp --cap-drop ALL --user "$(id -u):$(id -g)" \
      --volume "$work:$work" "$ORBIS_IMAGE" "$@"
  else
    "$orbis" "$@"
  fi
}

# --- the service -----------------------------------------------------------------------------------------------------

free_port() { node -e 'const s = require("net").createServer().listen(0, "127.0.0.1", () => { console.log(s.address().port); s.close(); })'; }

# start_service DATA [ARGUMENTS…]: `orbis serve` on a free port, ready for requests. DATA names its data directory, the
# same one for the same name. Results are made anew for each test, unless the arguments turn the cache on. Sets URL and SERVICE, which the functions below take from here. With $ORBIS_IMAGE set the
# service is that image in a container, locked down as docker/compose.yaml has it.
start_service() {
  local data=$1 port attempt
  shift
  [[ $* == *--cache* ]] || set -- --cache off "$@"
  port=$(free_port)
  URL="http://127.0.0.1:$port"
  SERVICE_LOG="$work/service-$port.log"
  if [ -n "${ORBIS_IMAGE:-}" ]; then
    SERVICE="orbis-test-$port"
    "$DOCKER" run --detach --name "$SERVICE" --network host --read-only --tmpfs /tmp --cap-drop ALL \
      --security-opt no-new-privileges --volume "orbis-test-$$-$data:/data" "$ORBIS_IMAGE" \
      serve --host 127.0.0.1 --port "$port" --data /data "$@" >/dev/null
  else
    "$orbis" serve --port "$port" --data "$work/$data" "$@" >"$SERVICE_LOG" 2>&1 &
    SERVICE=$!
  fi
  OWN_SERVICE=$SERVICE
  for ((attempt = 0; attempt < 150; ++attempt)); do
    [ "$(curl --silent --output /dev/null --write-out '%{http_code}' "$URL/readyz")" = 200 ] && return
    sleep 0.1
  done
  fail "the service does not get ready; its log says:" "$(service_log | tail -n 20)"
}

service_log() { if [ -n "${ORBIS_IMAGE:-}" ]; then "$DOCKER" logs "$SERVICE" 2>&1; else cat "$SERVICE_LOG"; fi; }

# signal_service NAME: TERM or KILL.
signal_service() {
  if [ -n "${ORBIS_IMAGE:-}" ]; then "$DOCKER" kill --signal "$1" "$SERVICE" >/dev/null; else kill -"$1" "$SERVICE"; fi
}

# Waits for the service to end; sets EXIT to its status.
await_exit() {
  if [ -n "${ORBIS_IMAGE:-}" ]; then
    EXIT=$("$DOCKER" wait "$SERVICE")
    "$DOCKER" rm "$SERVICE" >/dev/null
  else
    EXIT=0
    wait "$SERVICE" || EXIT=$?
  fi
  OWN_SERVICE=""
}

stop_service() {
  signal_service TERM
  await_exit
}

# Ends the service that this shell has started and not stopped: what a failed test leaves behind.
end_own_service() {
  [ -n "$OWN_SERVICE" ] || return 0
  if [ -n "${ORBIS_IMAGE:-}" ]; then "$DOCKER" rm --force "$OWN_SERVICE" >/dev/null; else kill -KILL "$OWN_SERVICE"; fi
}

# --- requests --------------------------------------------------------------------------------------------------------

# request METHOD PATH [CURL ARGUMENTS…]: sets STATUS; the answer's header and body are the files $HEADER and $BODY.
request() {
  local method=$1 path=$2
  shift 2
  HEADER="$work/header-$BASHPID" BODY="$work/body-$BASHPID"
  : >"$BODY"
  [ "$method" = HEAD ] && set -- --head "$@"
  STATUS=$(curl --silent --show-error --max-time 120 --request "$method" --dump-header "$HEADER" --output "$BODY" \
    --write-out '%{http_code}' "$@" "$URL$path") || STATUS="no answer (curl $?)"
  case $STATUS in [45]*) check_problem ;; esac
}

get() { request GET "$@"; }

# The query of POSTs. Small textures, for speed: a test that wants other options says so.
QUERY='texture_size=256'

# post FILE [CURL ARGUMENTS…]: POSTs a model.
post() {
  local file=$1
  shift
  request POST "/v1/jobs?$QUERY" --header 'Content-Type: application/octet-stream' --data-binary @"$file" "$@"
}

# post_parts PART…: POSTs multipart/form-data; each PART as curl's --form has it.
post_parts() {
  local part parts=()
  for part in "$@"; do parts+=(--form "$part"); done
  request POST "/v1/jobs?$QUERY" "${parts[@]}"
}

header() { tr -d '\r' <"$HEADER" | sed -n "s/^$1: *//Ip" | tail -n 1; }
json() { jq --raw-output "$@" "$BODY"; }

# Every answer from 400 on is a problem document which says the same status and tells nothing about the machine.
check_problem() {
  [[ ${BODY_EXPECTED:-yes} == no ]] && return
  expect_match "the content type of a $STATUS" "$(header content-type)" '^application/problem\+json'
  jq --exit-status --argjson status "$STATUS" '.status == $status and (.type | startswith("/problems/")) and
    (.title | length > 0) and (.detail | length > 0)' "$BODY" >/dev/null || fail "not a problem document: $(describe_body)"
  grep -qE '/tmp/|/data/|/home/|std::|terminate|exception' "$BODY" && fail "the problem leaks internals: $(describe_body)"
  return 0
}

# expect_problem STATUS SLUG [REGEX OF THE DETAIL]
expect_problem() {
  expect "the status" "$STATUS" "$1"
  expect "the problem's type" "$(json .type)" "/problems/$2"
  [ $# -lt 3 ] || expect_match "the detail" "$(json .detail)" "$3"
}

# --- jobs ------------------------------------------------------------------------------------------------------------

# submit FILE [CURL ARGUMENTS…]: POSTs a model that must be taken; sets JOB to the job's path.
submit() {
  post "$@"
  accepted
}

accepted() {
  expect "the status of the POST" "$STATUS" 202
  JOB=$(header location)
  expect_match "the job's address" "$JOB" '^/v1/jobs/[0-9A-HJKMNP-TV-Z]{26}$'
}

# await JOB: waits until the job is final; sets STATE; $BODY is the job.
await() {
  local patience
  for ((patience = 0; patience < 150; ++patience)); do
    get "$1" --header 'Prefer: wait=2'
    expect "the status of the job" "$STATUS" 200
    STATE=$(json .state)
    case $STATE in queued | running) sleep 0.05 ;; *) return ;; esac
  done
  fail "the job does not end"
}

# await_state JOB REGEX: waits until the job's state matches.
await_state() {
  local patience
  for ((patience = 0; patience < 1000; ++patience)); do
    get "$1"
    STATE=$(json .state)
    [[ $STATE =~ ^($2)$ ]] && return
    sleep 0.1
  done
  fail "the job is $STATE and does not become $2"
}

# outcome: of the POST just made, leaves what the caller gets in the end in STATUS and $BODY: the GLB or a problem.
outcome() {
  [ "$STATUS" = 202 ] || return 0
  JOB=$(header location)
  await "$JOB"
  get "$JOB/result"
}

# expect_textured NAME: the last answer is a GLB, which is kept for the validator, with a valid certificate in the report.
expect_textured() {
  expect "the status" "$STATUS" 200
  expect "the first bytes" "$(head -c 4 "$BODY")" glTF
  cp "$BODY" "$outputs/$1.glb"
  get "$JOB/report"
  expect "the status of the report" "$STATUS" 200
  jq --exit-status '.certificate | .valid and .closed and .manifold and .connected and .euler_characteristic == 2 and
    .folded == 0 and .off_grid == 0' "$BODY" >/dev/null || fail "the certificate is not valid: $(json .certificate)"
  jq --exit-status '.cut_certificate.valid' "$BODY" >/dev/null || fail "the cut surface is not certified"
}

# textured NAME FILE [CURL ARGUMENTS…]: the whole job; $BODY is the report then.
textured() {
  local name=$1
  shift
  post "$@"
  outcome
  expect_textured "$name"
}
