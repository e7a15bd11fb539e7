#include "core/asset/load_document.h"

#include <algorithm>

#include "core/asset/extensions.h"
#include "core/asset/meshopt_codec.h"
#include "core/asset/model_files.h"
#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

const Json* compressed_form(const Json& view) {
  for (const auto name : meshopt_extensions) {
    if (const Json* found = find_path(view, "extensions", name)) return found;
  }
  return nullptr;
}

// A compressed view is read from its extension's buffer; the buffer of the view itself is a fallback for others.
std::vector<bool> buffers_in_use(const Json& document) {
  std::vector<bool> used(array_size(document, "buffers"));
  const Json* views = find(document, "bufferViews");
  if (!views) return used;
  for (const Json& view : *views) {
    const Json* compressed = compressed_form(view);
    used[(compressed ? *compressed : view).at("buffer").get<std::size_t>()] = true;
  }
  return used;
}

Bytes decoded_uri(const std::string& uri, const std::string& where) {
  auto data = decode_data_uri(uri);
  if (!data) throw Error(ErrorCode::malformed, "the data URI is not valid base64", where);
  return std::move(data->bytes);
}

Bytes load_buffer(const Json& buffer, bool may_use_bin, std::optional<std::span<const std::byte>> bin,
                  const ModelFiles& files, const std::string& where) {
  const Json* member = find(buffer, "uri");
  if (!member) {
    if (!may_use_bin || !bin) throw Error(ErrorCode::malformed, "the buffer has neither a URI nor binary data", where);
    return {bin->begin(), bin->end()};
  }
  const auto& uri = member->get_ref<const std::string&>();
  if (is_data_uri(uri)) return decoded_uri(uri, where + "/uri");
  return files.require(uri, where + "/uri");
}

void load_buffers(Document& document, std::optional<std::span<const std::byte>> bin, const ModelFiles& files) {
  const std::vector<bool> used = buffers_in_use(document.json);
  document.buffers.resize(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    Json& json = document.json["buffers"][i];
    const std::string where = "/buffers/" + std::to_string(i);
    Bytes& bytes = document.buffers[i] = load_buffer(json, i == 0, bin, files, where);
    const auto length = json.at("byteLength").get<std::size_t>();
    if (bytes.size() < length) {
      throw Error(ErrorCode::malformed,
                  "the buffer should have " + std::to_string(length) + " bytes, but its data has " +
                      std::to_string(bytes.size()),
                  where);
    }
    if (Json* uri = find(json, "uri"); uri && is_data_uri(uri->get_ref<const std::string&>())) json.erase("uri");
  }
}

void decode_views(Document& document, const Limits& limits) {
  const Json* views = find(document.json, "bufferViews");
  if (!views) return;
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < views->size(); ++i) {
    const Json* json = compressed_form((*views)[i]);
    if (!json) continue;
    const std::string where = "/bufferViews/" + std::to_string(i);
    MeshoptView view{json->at("count").get<std::size_t>(), json->at("byteStride").get<std::size_t>(),
                     json->at("mode").get<std::string>(), json->value("filter", std::string("NONE"))};
    total += view.count * view.stride;
    if (total > max_decoded_bytes(limits)) {
      throw Error(ErrorCode::too_large,
                  "the decoded views are larger than the limit of " + std::to_string(max_decoded_bytes(limits)) +
                      " bytes",
                  where);
    }
    const Bytes& buffer = document.buffers[json->at("buffer").get<std::size_t>()];
    const auto data =
        std::span(buffer).subspan(json->value("byteOffset", std::size_t{0}), json->at("byteLength").get<std::size_t>());
    document.decoded_views.emplace(i, decode_meshopt(data, view, where));
  }
}

// Where an image may be missing (ModelFiles::find) its URI stays, and what needs it says so.
void load_images(Document& document, const ModelFiles& files) {
  for (std::size_t i = 0; i < array_size(document.json, "images"); ++i) {
    const Json* member = find(document.json["images"][i], "uri");
    if (!member) continue;
    const auto& uri = member->get_ref<const std::string&>();
    const std::string where = "/images/" + std::to_string(i) + "/uri";
    if (is_data_uri(uri)) {
      document.images.emplace(i, decoded_uri(uri, where));
    } else if (const Bytes* file = files.find(uri, where)) {
      document.images.emplace(i, *file);
    }
  }
}

} // namespace

std::uint64_t max_decoded_bytes(const Limits& limits) { return 128 * limits.max_vertices; }

Document load_document(Json json, std::optional<std::span<const std::byte>> bin, const ModelFiles& files,
                       const Limits& limits) {
  Document document;
  document.json = std::move(json);
  const auto used = extension_objects(document.json);
  document.keeps_numbers =
      !std::all_of(used.begin(), used.end(), [](const std::string& name) { return references_are_known(name); });
  load_buffers(document, bin, files);
  decode_views(document, limits);
  load_images(document, files);
  return document;
}

} // namespace orbis::asset
