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
