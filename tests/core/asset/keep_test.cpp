// What is not about the primitives that were parametrized goes through orbis unchanged: the input's document and the
// output's are compared, with every reference replaced by what it leads to, so that numbers may differ and nothing
// else.
#include <doctest/doctest.h>

#include <filesystem>
#include <set>

#include "core/asset/document.h"
#include "core/asset/extensions.h"
#include "core/asset/references.h"
#include "support/gltf_builder.h"
#include "support/model_folder.h"
#include "support/unchanged.h"

using namespace orbis;
using namespace orbis::asset;
using Json = nlohmann::ordered_json;

namespace {

std::string digest(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::to_string(bytes.size()) + " bytes, hash " + std::to_string(std::hash<std::string_view>()(text));
}

// A document with its references replaced by what they lead to.
class Resolved {
public:
  explicit Resolved(const Document& document) : document_(document), json(document.json) {
    for_each_reference(json, [&](Kind kind, Json& slot) {
      if (is_kept_by_number(kind)) return;
      slot = contents(kind, slot.get<std::size_t>());
    });
    // What the numbers counted in.
    for (const auto array : {"accessors", "bufferViews", "buffers", "images", "textures", "samplers"})
      json.erase(array);
  }

private:
  // Nodes, meshes, materials and the like are never dropped: their numbers stay.
  static bool is_kept_by_number(Kind kind) {
    return kind == Kind::material || kind == Kind::mesh || kind == Kind::node || kind == Kind::skin ||
           kind == Kind::camera || kind == Kind::scene;
  }

  Json contents(Kind kind, std::size_t number) const {
    Json item = document_.json.at(std::string(array_of(kind))).at(number);
    switch (kind) {
    case Kind::texture:
      for (Json* owner : owners_of_source(item)) (*owner)["source"] = contents(Kind::image, (*owner)["source"]);
      if (item.contains("sampler")) item["sampler"] = contents(Kind::sampler, item["sampler"]);
      return item;
    case Kind::image:
      if (const auto bytes = document_.image(number)) {
        item["bytes"] = digest(*bytes);
        for (const auto key : {"uri", "bufferView", "mimeType"}) item.erase(key);
      }
      return item;
    case Kind::accessor:
      return accessor(item);
    case Kind::buffer_view:
      return digest(document_.view(number));
    default:
      return item;
    }
  }

  static std::vector<Json*> owners_of_source(Json& texture) {
    std::vector<Json*> owners;
    if (texture.contains("source")) owners.push_back(&texture);
    if (texture.contains("extensions")) {
      for (auto& [name, extension] : texture["extensions"].items()) {
        if (extension.contains("source")) owners.push_back(&extension);
      }
    }
    return owners;
  }

  // The view's bytes stand for the values: an accessor's place in it is kept.
  Json accessor(Json item) const {
    if (item.contains("bufferView")) item["bufferView"] = digest(document_.view(item["bufferView"]));
    if (item.contains("sparse")) {
      for (const auto part : {"indices", "values"}) {
        item["sparse"][part]["bufferView"] = digest(document_.view(item["sparse"][part]["bufferView"]));
      }
    }
    return item;
  }

  const Document& document_;

public:
  Json json;
};

// Takes out of both documents what orbis is there to change.
void forget_changes(Json& json, const Asset& asset) {
  json["asset"].erase("extras");
  for (const auto list : {"extensionsUsed", "extensionsRequired"}) json.erase(list);
  std::set<std::size_t> materials;
  for (const Primitive& p : asset.primitives) {
    Json& primitive = json["meshes"][p.mesh]["primitives"][p.primitive];
    if (primitive.contains("material")) materials.insert(primitive["material"].get<std::size_t>());
    for (const auto key : {"attributes", "indices", "targets", "mode", "material"}) primitive.erase(key);
    if (!primitive.contains("extensions")) continue;
    for (const auto name : {"KHR_draco_mesh_compression", "CESIUM_primitive_outline"})
      primitive["extensions"].erase(name);
    if (primitive["extensions"].empty()) primitive.erase("extensions");
  }
  for (Json& mesh : json["meshes"]) {
    if (!mesh.contains("extensions")) continue;
    mesh["extensions"].erase("EXT_mesh_manifold");
    if (mesh["extensions"].empty()) mesh.erase("extensions");
  }
  for (const std::size_t m : materials) {
    Json& material = json["materials"][m];
    if (material.contains("pbrMetallicRoughness")) material["pbrMetallicRoughness"].erase("baseColorTexture");
    if (material.contains("extensions") && material["extensions"].contains("KHR_materials_pbrSpecularGlossiness")) {
      material["extensions"]["KHR_materials_pbrSpecularGlossiness"].erase("diffuseTexture");
    }
    if (material.contains("pbrMetallicRoughness") && material["pbrMetallicRoughness"].empty())
      material.erase("pbrMetallicRoughness");
  }
}

// Materials that were added for a primitive come behind the input's.
void forget_new_materials(Json& after, const Json& before) {
  const std::size_t count = before.contains("materials") ? before["materials"].size() : 0;
  if (!after.contains("materials")) return;
  while (after["materials"].size() > count) after["materials"].erase(after["materials"].size() - 1);
  if (count == 0) after.erase("materials");
}

void check_kept(const Asset& before, Compression compression) {
  const Bytes glb = test::write_unchanged(before, compression);
  const Asset after = read_asset(glb, {}, Limits{});
  Json expected = Resolved(*before.document).json, found = Resolved(*after.document).json;
  forget_changes(expected, before);
  forget_changes(found, before);
  forget_new_materials(found, expected);
  // As unordered objects: a key that comes back stands in another place.
  const nlohmann::json difference = nlohmann::json::diff(nlohmann::json(expected), nlohmann::json(found));
  INFO(difference.dump(2).substr(0, 2000));
  CHECK(difference.empty());

  REQUIRE(after.primitives.size() == before.primitives.size());
  for (std::size_t p = 0; p < before.primitives.size(); ++p) {
    for (const Attribute& attribute : before.primitives[p].attributes) {
      const Attribute* kept = after.primitives[p].find(attribute.name);
      REQUIRE(kept);
      CHECK(kept->count() == attribute.count());
      if (compression == Compression::none) CHECK(kept->data == attribute.data);
    }
    CHECK(after.primitives[p].targets.size() == before.primitives[p].targets.size());
  }
}

} // namespace

TEST_CASE("of every model of the shared collection, what orbis does not touch is kept") {
  const std::filesystem::path root = ORBIS_SHARED_DATA;
  if (!std::filesystem::exists(root / "MANIFEST.tsv")) {
    MESSAGE("the shared data is not here; skipped");
    return;
  }
  std::size_t models = 0;
  for (const auto folder : {"ext", "anim", "multi", "closed0", "open", "genus", "nonmanifold"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".glb" && ending != ".gltf") continue;
      CAPTURE(entry.path().filename().string());
      Attachments files = test::neighbours(entry.path());
      try {
        check_kept(read_asset(test::contents(entry.path()), files, Limits{}), Compression::none);
        ++models;
      } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::missing_resource);
      }
    }
  }
  MESSAGE(models << " models compared");
  CHECK(models > 0);
}

TEST_CASE("scenes, cameras, lights, skins, instances, extras and unknown extensions go through as they came") {
  test::GltfBuilder b = test::tetrahedron();
  const auto moves = b.add_accessor(std::vector<float>{0, 0, 0, 1, 2, 3}, "VEC3", 3);
  const auto points = b.add_accessor(std::vector<float>{0, 0, 0, 1, 1, 1}, "VEC3", 3);
  const auto bind = b.add_accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
  b.json["nodes"][0].update(
      Json{{"name", "main"},
           {"scale", {-1, 1, 1}},
           {"extras", {{"id", 7}}},
           {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}}}});
  b.append("meshes", {{"name", "cloud"},
                      {"primitives", Json::array({{{"attributes", {{"POSITION", points}}}, {"mode", 0}},
                                                  {{"attributes", {{"POSITION", points}}}, {"mode", 1}}})}});
  b.append("nodes", {{"mesh", 1}, {"camera", 0}, {"rotation", {0, 0, 0, 1}}});
  b.append("nodes",
           {{"name", "lamp"}, {"skin", 0}, {"mesh", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.append("scenes", {{"name", "second"}, {"nodes", {1, 2}}, {"extras", "text"}});
  b.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.01}}}});
  b.append("skins", {{"joints", {1}}, {"inverseBindMatrices", bind}});
  b.json["extensions"] = {
      {"KHR_lights_punctual", {{"lights", Json::array({{{"type", "point"}, {"color", {1, 0.5, 0}}}})}}},
      {"EXAMPLE_of_ours", {{"numbers", {0, 1e300, -0.125}}}}};
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "EXAMPLE_of_ours", "EXT_mesh_gpu_instancing"};
  b.json["extras"] = {{"kept", true}};
  b.json["asset"]["copyright"] = "someone";
  const Asset asset = read_asset(b.glb(), {}, Limits{});
  for (const Compression compression : {Compression::none, Compression::draco, Compression::meshopt})
    check_kept(asset, compression);
}

TEST_CASE("the extensions that a document names stay named as long as they are in use") {
  test::GltfBuilder b = test::tetrahedron();
  b.json["extensionsUsed"] = {"EXAMPLE_of_ours", "KHR_materials_clearcoat"};
  b.json["extensions"] = {{"EXAMPLE_of_ours", Json::object()}};
  b.append("materials", {{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}}}});
  const Asset asset = read_asset(b.glb(), {}, Limits{});
  const Asset after = read_asset(test::write_unchanged(asset), {}, Limits{});
  CHECK(after.document->json["extensionsUsed"] == b.json["extensionsUsed"]);
}
