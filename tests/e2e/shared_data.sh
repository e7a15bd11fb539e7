# shellcheck shell=bash
# The collection of real models beside the checkout, where it is there: every model comes back textured,
# and broken files do no harm.

# post_model FILE: with the external files that it names attached.
post_model() {
  local file=$1 uri parts=()
  while IFS= read -r uri; do
    local beside
    beside="$(dirname "$file")/$(printf '%b' "${uri//%/\\x}")"
    [ -r "$beside" ] && parts+=("file=@\"$beside\";filename=\"$uri\"")
  done < <(node "$here/external_uris.mjs" "$file" 2>/dev/null)
  if [ ${#parts[@]} -gt 0 ]; then post_parts "model=@$file" "${parts[@]}"; else post "$file"; fi
  outcome
}

is_textured() {
  local name
  name="shared-$(tr / - <<<"${1%.*}")"
  post_model "$shared_data/$1"
  expect_textured "$name"
  echo "$shared_data/$1" >"$outputs/$name.input"
}

is_refused() {
  post_model "$shared_data/$1"
  expect_match "the status" "$STATUS" "$2"
}

# A model that was damaged on purpose may be repaired or refused, but it gets a plain answer.
is_answered() {
  post_model "$shared_data/$1"
  expect_match "the status" "$STATUS" '^(200|4[0-9][0-9])$'
}

no_collection() { skip "there is no collection of models at ../shared/data"; }

if [ -r "$shared_data/MANIFEST.tsv" ]; then
  while IFS=$'\t' read -r path _ _ _ _ class triangles notes; do
    case $class:$path:$notes in
      # 15,894 loose triangles, three charts each and more: too many for the small atlas of these tests, which is said.
      *:made/cat-soup-jitter*) it "$path gets a plain answer" is_answered "$path" ;;
      *:made/hand-*) it "$path gets a plain answer" is_answered "$path" ;;
      *$'\tmissing '*) it "$path is refused: it came without some of its files" is_refused "$path" '^422$' ;;
      ERROR:* | EMPTY:*) it "$path is refused as broken" is_refused "$path" '^4(00|13|15|22)$' ;;
      *)
        # The few larger ones are for ./dev bench.
        [ "$triangles" -gt 250000 ] || it "$path ($triangles triangles) comes back textured" is_textured "$path" ;;
    esac
  done < <(tail -n +2 "$shared_data/MANIFEST.tsv")
else
  it "the collection of real models" no_collection
fi
