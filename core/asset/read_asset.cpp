#include <algorithm>

#include "core/asset/asset.h"
#include "core/asset/check_document.h"
#include "core/asset/draco_decoder.h"
#include "core/asset/extensions.h"
#include "core/asset/glb.h"
#include "core/asset/load_document.h"
#include "core/asset/read_draco_file.h"
#include "core/asset/read_primitives.h"
#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

// JSON begins with a bracket, after white space and perhaps a byte order mark.
bool is_json(std::span<const std::byte> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 1024));
  const std::size_t mark = head.substr(0, 3) == "\xEF\xBB\xBF" ? 3 : 0;
  const std::size_t first = head.find_first_not_of(" \t\r\n", mark);
  return first != std::string_view::npos && (head[first] == '{' || head[first] == '[');
}

void note_images(const Document& document, std::vector<Asset::Note>& notes) {
  for (std::size_t i = 0; i < array_size(document.json, "images"); ++i) {
    if (document.image(i)) continue;
    const Json* uri = find(document.json["images"][i], "uri");
    notes.push_back({"image-missing",
                     uri ? "the image '" + shown(uri->get_ref<const std::string&>()) +
                               "' did not come with the request; the result refers to it as the input did"
                         : "the image has neither a URI nor a buffer view",
                     "/images/" + std::to_string(i)});
  }
}

void note_extensions(const Document& document, std::vector<Asset::Note>& notes) {
  for (const std::string& name : extension_objects(document.json)) {
    if (references_are_known(name)) continue;
    notes.push_back({"extension-unknown",
                     "the extension " + shown(name) + " is not understood; its data is carried over as it is", ""});
  }
}

Asset read_gltf(std::span<const std::byte> bytes, const Attachments& attachments, const Limits& limits) {
  Asset asset;
  GlbChunks chunks{bytes, std::nullopt};
  asset.format = is_glb(bytes) ? Format::glb : Format::gltf;
  if (asset.format == Format::glb) chunks = split_glb(bytes);
  Json json = parse_json(chunks.json, limits);
  check_document(json, limits);
  check_nodes(json);
  auto document = std::make_shared<Document>(load_document(std::move(json), chunks.bin, attachments, limits));
  asset.primitives = read_primitives(*document, limits, asset.notes);
  note_images(*document, asset.notes);
  note_extensions(*document, asset.notes);
  asset.document = std::move(document);
  return asset;
}

} // namespace

Asset read_asset(std::span<const std::byte> bytes, const Attachments& attachments, const Limits& limits) {
  if (bytes.empty()) throw Error(ErrorCode::malformed, "the model is empty: no bytes came");
  if (bytes.size() > limits.max_bytes) {
    throw Error(ErrorCode::too_large, "the model has " + std::to_string(bytes.size()) +
                                          " bytes, more than the limit of " + std::to_string(limits.max_bytes));
  }
  if (!is_glb(bytes) && !is_draco(bytes) && !is_json(bytes)) {
    throw Error(ErrorCode::unsupported_format,
                "the model is neither GLB, glTF JSON nor Draco; convert it to one of these");
  }
  Asset asset = is_draco(bytes) ? read_draco_file(bytes, limits) : read_gltf(bytes, attachments, limits);
  for (const Primitive& primitive : asset.primitives) check_positions(primitive);
  const bool has_triangles = std::any_of(asset.primitives.begin(), asset.primitives.end(),
                                         [](const Primitive& primitive) { return !primitive.indices.empty(); });
  if (!has_triangles) {
    throw Error(ErrorCode::invalid_geometry, "the model has no triangles; a surface of triangles is needed");
  }
  return asset;
}

} // namespace orbis::asset
