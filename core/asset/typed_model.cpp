#include "core/asset/typed_model.h"

#include <initializer_list>
#include <limits>
#include <string>

namespace orbis::asset {
namespace {

void copy_members(const Json& from, Json& to, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (const Json* found = find(from, key)) to[key] = *found;
  }
}

Json reduced_primitive(const Json& primitive) {
  Json out = Json::object();
  copy_members(primitive, out, {"attributes", "indices", "mode", "material", "targets"});
  return out;
}

Json reduced_views(const Json& document) {
  Json out = Json::array();
  for (std::size_t i = 0; i < array_size(document, "bufferViews"); ++i) {
    copy_members(document["bufferViews"][i], out.emplace_back(Json::object()),
                 {"buffer", "byteOffset", "byteLength", "byteStride"});
  }
  out.push_back(Json{{"buffer", 0}, {"byteLength", 4}}); // the one for accessors that have none
  return out;
}

Json reduced_accessors(const Json& document, std::size_t no_view) {
  Json out = Json::array();
  for (std::size_t i = 0; i < array_size(document, "accessors"); ++i) {
    copy_members(document["accessors"][i], out.emplace_back(Json{{"bufferView", no_view}}),
                 {"bufferView", "byteOffset", "componentType", "count", "type", "normalized", "sparse"});
  }
  return out;
}

Json reduced_meshes(const Json& document) {
  Json out = Json::array();
  for (std::size_t i = 0; i < array_size(document, "meshes"); ++i) {
    Json primitives = Json::array();
    for (const Json& primitive : document["meshes"][i]["primitives"]) {
      primitives.push_back(reduced_primitive(primitive));
    }
    out.push_back(Json{{"primitives", std::move(primitives)}});
  }
  return out;
}

Json reduced_copy(const Json& document) {
  return Json{{"asset", {{"version", "2.0"}}},
              {"bufferViews", reduced_views(document)},
              {"accessors", reduced_accessors(document, array_size(document, "bufferViews"))},
              {"meshes", reduced_meshes(document)}};
}

// Later versions of tinygltf have one callback more.
template <class Callbacks> Callbacks refusing_callbacks() {
  Callbacks fs{};
  fs.FileExists = [](const std::string&, void*) { return false; };
  fs.ExpandFilePath = [](const std::string&, void*) { return std::string(); };
  fs.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; };
  fs.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
  if constexpr (requires { fs.GetFileSizeInBytes; }) {
    fs.GetFileSizeInBytes = [](size_t*, std::string*, const std::string&, void*) { return false; };
  }
  return fs;
}

bool is_complete(const tinygltf::Model& model, const Json& reduced) {
  if (model.accessors.size() != reduced["accessors"].size() || model.meshes.size() != reduced["meshes"].size() ||
      model.bufferViews.size() != reduced["bufferViews"].size()) {
    return false;
  }
  for (std::size_t i = 0; i < model.meshes.size(); ++i) {
    if (model.meshes[i].primitives.size() != reduced["meshes"][i]["primitives"].size()) return false;
  }
  return true;
}

} // namespace

tinygltf::Model typed_model(const Json& document) {
  const Json reduced = reduced_copy(document);
  const std::string text = reduced.dump();
  if (text.size() > std::numeric_limits<unsigned>::max()) {
    throw Error(ErrorCode::too_large, "the JSON is larger than 4 GiB");
  }
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(refusing_callbacks<tinygltf::FsCallbacks>());
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return false; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const bool loaded = loader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                                 static_cast<unsigned>(text.size()), std::string());
  if (!loaded || !is_complete(model, reduced)) {
    throw Error(ErrorCode::malformed, "the meshes, accessors and buffer views of the document do not fit together");
  }
  return model;
}

bool has_no_view(const tinygltf::Model& model, const tinygltf::Accessor& accessor) {
  return static_cast<std::size_t>(accessor.bufferView) + 1 == model.bufferViews.size();
}

} // namespace orbis::asset
