# shellcheck shell=bash
# What else a sphere gives: remeshes and morphs.

test_a_model_comes_back_as_a_divided_icosahedron() {
  QUERY="$QUERY&remesh=icosahedral:3"
  submit "$models/egg.glb"
  outcome
  expect_textured remeshed
  get "$JOB/report"
  expect "the triangles of the remesh" "$(json .remesh.triangles)" 1280
  expect "the components that kept theirs" "$(json .remesh.kept_components)" 0
  expect "what is certified" "$(json .certificate.triangles)" 1280
  expect "it is close" "$(json '.remesh.hausdorff_distance < 1 and .remesh.mean_distance < 0.3')" true
}

test_what_cannot_be_remeshed_is_refused_with_its_reason() {
  QUERY="$QUERY&remesh=octahedral:2"
  submit "$models/torus.glb"
  outcome
  expect_problem 422 not-genus-zero handles
}

test_a_model_morphs_to_its_sphere() {
  QUERY="$QUERY&sphere_morph=true&lods=0.5"
  submit "$models/egg.glb"
  outcome
  expect_textured sphere-morph
}

# post_morph A B [QUERY]
post_morph() {
  request POST "/v1/morphs?$QUERY${3:+&$3}" --form "a=@$1" --form "b=@$2"
}

test_two_models_become_one_mesh_that_morphs() {
  post_morph "$models/egg.glb" "$models/tetrahedron.glb" 'remesh=icosahedral:3'
  accepted
  outcome
  expect_textured morph
  get "$JOB/report"
  expect "the triangles" "$(json .remesh.triangles)" 1280
  expect "the second model's" "$(json .morph.input_triangles)" 4
  expect "both ends are close" "$(json '.remesh.mean_distance < 0.5 and .morph.mean_distance < 0.5')" true
}

test_a_morph_takes_one_closed_surface_on_each_side() {
  post_morph "$models/egg.glb" "$models/torus.glb"
  outcome
  expect_problem 422 not-genus-zero 'second model'
  post_morph "$models/two-eggs.glb" "$models/egg.glb"
  outcome
  expect_problem 422 not-genus-zero 'first model has 2 components'
  request POST "/v1/morphs?$QUERY" --form "a=@$models/egg.glb"
  expect_problem 400 bad-request "'a' and 'b'"
}

test_the_command_line_morphs_too() {
  orbis_command morph "$models/egg.glb" "$models/tetrahedron.glb" -o "$outputs/morph-by-hand.glb" --texture-size 256 \
    --remesh octahedral:3 --report "$work/morph.json"
  expect "the triangles" "$(jq .remesh.triangles "$work/morph.json")" 512
}
