# shellcheck shell=bash
# Each input format comes back as a textured, certified GLB.

test_a_glb_comes_back_textured() { QUERY='' textured egg-glb "$models/egg.glb"; }

test_a_gltf_with_data_uris_comes_back_textured() { textured egg-gltf "$models/egg.gltf" --header 'Content-Type: model/gltf+json'; }

test_raw_draco_comes_back_textured() {
  textured egg-drc "$models/egg.drc" --header 'Content-Type: application/vnd.draco'
  expect "the format" "$(json .format)" draco
}

test_draco_inside_gltf_comes_back_textured() { textured egg-draco "$models/egg-draco.glb"; }

test_quantized_positions_come_back_textured() { textured egg-quantized "$models/egg-quantized.glb"; }

test_a_triangle_strip_without_indices_comes_back_textured() { textured strip "$models/strip.glb"; }

test_sparse_positions_come_back_textured() { textured sparse "$models/sparse.glb"; }

test_the_format_is_recognised_by_content_whatever_the_media_type_says() {
  textured mislabelled "$models/egg.drc" --header 'Content-Type: model/gltf-binary'
}

test_a_gltf_with_attached_files_comes_back_textured() {
  post_parts "model=@$models/crate.gltf" "bin=@$models/crate.bin" "image=@$models/crate colours.png"
  outcome
  expect_textured crate-attached
  expect "the atlas' source" "$(json .atlas.source)" base_color
}

test_a_models_own_base_colour_is_resampled_into_the_atlas() {
  textured crate "$models/crate.glb"
  expect "the atlas' source" "$(json .atlas.source)" base_color
}

test_seams_are_welded_for_the_topology() {
  textured crate-welded "$models/crate.glb"
  expect "the surface's vertices" "$(json .topology.vertices)" 8
  expect "the surface's triangles" "$(json .topology.triangles)" 12
}

test_obj_ply_and_stl_come_back_textured() {
  local kind
  for kind in obj ply stl; do
    textured "egg-$kind" "$models/egg.$kind" --header "Content-Type: $(media_type $kind)"
    expect "the format" "$(json .format)" $kind
    expect "the surface's triangles" "$(json .topology.triangles)" 1280
  done
}
media_type() { case $1 in obj) echo model/obj ;; ply) echo application/ply ;; stl) echo model/stl ;; esac; }

test_an_obj_with_its_library_and_image_comes_back_with_its_colours() {
  post_parts "model=@$models/crate.obj" "file=@$models/crate.mtl" "file=@$models/crate colours.png"
  outcome
  expect_textured crate-obj
  expect "the atlas' source" "$(json .atlas.source)" base_color
}

test_a_zip_holds_a_model_with_its_files() {
  local kind
  for kind in gltf obj; do
    textured "crate-$kind-zip" "$models/crate-$kind.zip" --header 'Content-Type: application/zip'
    expect "the format" "$(json .format)" $kind
    expect "the atlas' source" "$(json .atlas.source)" base_color
  done
}

test_names_and_extras_survive() {
  post "$models/crate.glb"
  outcome
  expect "the status" "$STATUS" 200
  local document
  document=$(node -e 'const b = require("fs").readFileSync(process.argv[1]); console.log(b.toString("utf8", 20, 20 + b.readUInt32LE(12)))' "$BODY")
  expect "the node's name" "$(jq --raw-output '.nodes[0].name' <<<"$document")" crate
  expect "the node's extras" "$(jq --raw-output '.nodes[0].extras.owner' <<<"$document")" tests
  jq --exit-status '[.meshes[].primitives[].attributes] | all(has("_SPHERE") and has("TEXCOORD_0"))' <<<"$document" >/dev/null ||
    fail "the result lacks _SPHERE or TEXCOORD_0"
}

test_six_uploaded_images_become_the_texture() {
  local face parts=()
  for face in px nx py ny pz nz; do parts+=("$face=@$models/$face.png"); done
  post_parts "model=@$models/egg.glb" 'options={"texture":"cubemap"}' "${parts[@]}"
  outcome
  expect_textured cubemap
  expect "the atlas' source" "$(json .atlas.source)" cubemap
}

test_one_equirectangular_image_becomes_the_texture() {
  post_parts "model=@$models/egg.glb" 'options={"texture":"cubemap"}' \
    "equirectangular=@$models/equirectangular.png"
  outcome
  expect_textured equirectangular
  expect "the atlas' source" "$(json .atlas.source)" cubemap
}

test_the_papers_objective_certifies_too() {
  QUERY='objective=shape-preserving&texture_size=256' textured shape-preserving "$models/egg.glb"
  expect "the objective" "$(json .options.objective)" shape-preserving
  jq --exit-status '.embedding.minimum > 5 and .embedding.minimum < 30' "$BODY" >/dev/null ||
    fail "Eq. 3 gives $(json .embedding.minimum), far from an even triangulation's 14.5"
}

test_the_texture_can_be_a_jpeg() { QUERY='texture_format=jpeg&jpeg_quality=80&texture_size=256' textured jpeg "$models/egg.glb"; }

test_draco_can_come_out_and_go_in_again() {
  QUERY='compression=draco&texture_size=256' textured draco-out "$models/egg.glb"
  local triangles
  triangles=$(json .output.triangles)
  textured draco-again "$outputs/draco-out.glb"
  expect "the surface's triangles" "$(json .topology.triangles)" "$triangles"
}

test_meshopt_can_come_out_and_go_in_again() {
  local triangles compression
  for compression in meshopt quantized; do
    QUERY="compression=$compression&texture_size=256&maps=base_color,normal" textured "$compression-out" "$models/egg.glb"
    triangles=$(json .output.triangles)
    textured "$compression-again" "$outputs/$compression-out.glb"
    expect "the surface's triangles" "$(json .topology.triangles)" "$triangles"
  done
}

test_a_result_can_be_textured_again() {
  textured once "$models/egg.glb"
  textured twice "$outputs/once.glb"
  expect "the genus" "$(json .topology.genus)" 0
}

test_the_pictures_are_png() {
  submit "$models/egg.glb"
  await "$JOB"
  local picture
  for picture in atlas preview; do
    get "$JOB/$picture.png"
    expect "the status" "$STATUS" 200
    expect "the media type" "$(header content-type)" image/png
    expect "the first bytes" "$(head -c 4 "$BODY" | tail -c 3)" PNG
  done
}

test_the_same_request_gives_the_same_bytes() {
  local first
  # A second service with an empty data directory, so that nothing is answered from memory.
  textured determinism "$models/crate.glb"
  first=$(sha256sum <"$outputs/determinism.glb")
  start_service determinism --workers 1
  textured determinism-again "$models/crate.glb"
  stop_service
  expect "the second result's hash" "$(sha256sum <"$outputs/determinism-again.glb")" "$first"
}
