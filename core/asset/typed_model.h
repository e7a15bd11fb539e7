// The geometry of a checked document as tinygltf's typed model: the one place where tinygltf is run.
#pragma once

#include "core/asset/json.h"
#include "core/asset/tinygltf_apart.h"

namespace orbis::asset {

// tinygltf parses a copy that holds nothing but buffer views, accessors and meshes: no buffer, URI, image or extension,
// so that it opens and decodes nothing (it would open "../../x", and dies on some URIs and depths). Accessors without a
// buffer view, which it would refuse, refer to one beyond the document's: see has_no_view.
// `document` has passed check_document.
[[nodiscard]] tinygltf::Model typed_model(const Json& document);

// True for an accessor that starts as zeros.
[[nodiscard]] bool has_no_view(const tinygltf::Model& model, const tinygltf::Accessor& accessor);

} // namespace orbis::asset
