#include <algorithm>

#include "core/asset/asset.h"
#include "core/asset/check_document.h"
#include "core/asset/extensions.h"
#include "core/asset/glb.h"
#include "core/asset/load_document.h"
#include "core/asset/mend_attributes.h"
#include "core/asset/read_draco_file.h"
#include "core/asset/read_obj.h"
#include "core/asset/read_ply.h"
#include "core/asset/read_primitives.h"
#include "core/asset/read_stl.h"
#include "core/asset/uri.h"
#include "core/asset/zip.h"

namespace orbis::asset {
namespace {

// KTX2 and AVIF go through as they are.
void note_foreign_image(std::span<const std::byte> image, std::size_t number, std::vector<Asset::Note>& notes) {
  const std::string_view type = image_type(image);
  if (type == "image/png" || type == "image/jpeg" || type == "image/webp") return;
  notes.push_back({"image-not-decoded",
                   "the image is " + (type.empty() ? "of an unknown kind" : std::string(type)) +
                       ", which is not decoded: it is kept as it is, and what it shows is not sampled anew",
                   "/images/" + std::to_string(number)});
}

void note_images(const Document& document, std::vector<Asset::Note>& notes) {
  for (std::size_t i = 0; i < array_size(document.json, "images"); ++i) {
    if (const auto image = document.image(i)) {
      note_foreign_image(*image, i, notes);
      continue;
    }
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

ModelFormat recognised(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const auto format = recognise(text, text.size())) return *format;
  throw Error(ErrorCode::unsupported_format, unrecognised(text, text.size()));
}

Asset read_gltf(std::span<const std::byte> bytes, const ModelFiles& files, const Limits& limits) {
  Asset asset;
  GlbChunks chunks{bytes, std::nullopt};
  asset.format = is_glb(bytes) ? ModelFormat::glb : ModelFormat::gltf;
  if (asset.format == ModelFormat::glb) chunks = split_glb(bytes);
  Json json = parse_json(chunks.json, limits);
  check_document(json, limits);
  check_nodes(json);
  auto document = std::make_shared<Document>(load_document(std::move(json), chunks.bin, files, limits));
  asset.primitives = read_primitives(*document, limits, asset.notes);
  note_images(*document, asset.notes);
  note_extensions(*document, asset.notes);
  asset.document = std::move(document);
  return asset;
}

// What another format says in the words of glTF, read like any glTF.
Asset read_converted(Converted converted, ModelFormat format, const Limits& limits) {
  const Attachments none;
  Asset asset = read_gltf(converted.glb, ModelFiles(none, false), limits);
  asset.format = format;
  asset.notes.insert(asset.notes.begin(), converted.notes.begin(), converted.notes.end());
  return asset;
}

Asset read_model(std::span<const std::byte> bytes, ModelFormat format, const ModelFiles& files, const Limits& limits) {
  switch (format) {
  case ModelFormat::glb:
  case ModelFormat::gltf:
    return read_gltf(bytes, files, limits);
  case ModelFormat::draco:
    return read_converted(read_draco_file(bytes, limits), format, limits);
  case ModelFormat::obj:
    return read_converted(read_obj(bytes, limits, files), format, limits);
  case ModelFormat::ply:
    return read_converted(read_ply(bytes, limits, files), format, limits);
  case ModelFormat::stl:
    return read_converted(read_stl(bytes, limits), format, limits);
  case ModelFormat::zip:
    break;
  }
  throw Error(ErrorCode::unsupported_format, "the model in the zip archive is itself a zip archive; send that one");
}

Asset read_zip(std::span<const std::byte> bytes, const Attachments& attachments, const Limits& limits) {
  ZippedModel zipped = unzip_model(bytes, limits);
  zipped.files.insert(attachments.begin(), attachments.end());
  return read_model(zipped.model, recognised(zipped.model), ModelFiles(zipped.files, true), limits);
}

} // namespace

Asset read_asset(std::span<const std::byte> bytes, const Attachments& attachments, const Limits& limits) {
  if (bytes.empty()) throw Error(ErrorCode::malformed, "the model is empty: no bytes came");
  if (bytes.size() > limits.max_bytes) {
    throw Error(ErrorCode::too_large, "the model has " + std::to_string(bytes.size()) +
                                          " bytes, more than the limit of " + std::to_string(limits.max_bytes));
  }
  const ModelFormat format = recognised(bytes);
  Asset asset = format == ModelFormat::zip
                    ? read_zip(bytes, attachments, limits)
                    : read_model(bytes, format, ModelFiles(attachments, !attachments.empty()), limits);
  for (Primitive& primitive : asset.primitives) {
    check_positions(primitive);
    mend_attributes(primitive, asset.notes);
  }
  const bool has_triangles = std::any_of(asset.primitives.begin(), asset.primitives.end(),
                                         [](const Primitive& primitive) { return !primitive.indices.empty(); });
  if (!has_triangles) {
    throw Error(ErrorCode::invalid_geometry, "the model has no triangles; a surface of triangles is needed");
  }
  return asset;
}

} // namespace orbis::asset
