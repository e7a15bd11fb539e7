#include "core/asset/references.h"

#include "core/asset/extensions.h"

namespace orbis::asset {
namespace {

// J is Json or const Json: the same walk checks, marks and renumbers.
template <class J> class Walker {
public:
  explicit Walker(const std::function<void(Kind, J&)>& visit) : visit_(visit) {}

  void document(J& doc) const {
    slot(doc, "scene", Kind::scene);
    each(doc, "scenes", [&](J& scene) { slots(scene, "nodes", Kind::node); });
    each(doc, "nodes", [&](J& n) { node(n); });
    each(doc, "meshes", [&](J& mesh) { each(mesh, "primitives", [&](J& p) { primitive(p); }); });
    each(doc, "accessors", [&](J& a) { accessor(a); });
    each(doc, "bufferViews", [&](J& view) {
      slot(view, "buffer", Kind::buffer);
      for (const auto name : meshopt_extensions) extension_slot(view, name, "buffer", Kind::buffer);
    });
    each(doc, "animations", [&](J& a) { animation(a); });
    each(doc, "skins", [&](J& skin) {
      slot(skin, "inverseBindMatrices", Kind::accessor);
      slot(skin, "skeleton", Kind::node);
      slots(skin, "joints", Kind::node);
    });
    each(doc, "materials", [&](J& material) { texture_infos(material); });
    each(doc, "textures", [&](J& t) { texture(t); });
    each(doc, "images", [&](J& image) { slot(image, "bufferView", Kind::buffer_view); });
  }

private:
  template <class Visit> void each(J& parent, std::string_view key, const Visit& visit) const {
    J* items = find(parent, key);
    if (!items || !items->is_structured()) return;
    for (J& item : *items) visit(item);
  }
  void slot(J& parent, std::string_view key, Kind kind) const {
    if (J* found = find(parent, key)) visit_(kind, *found);
  }
  void slots(J& parent, std::string_view key, Kind kind) const {
    each(parent, key, [&](J& item) { visit_(kind, item); });
  }
  [[nodiscard]] J* extension(J& parent, std::string_view name) const { return find_path(parent, "extensions", name); }
  void extension_slot(J& parent, std::string_view name, std::string_view key, Kind kind) const {
    if (J* found = extension(parent, name)) slot(*found, key, kind);
  }

  void node(J& n) const {
    slots(n, "children", Kind::node);
    slot(n, "mesh", Kind::mesh);
    slot(n, "skin", Kind::skin);
    slot(n, "camera", Kind::camera);
    if (J* levels = extension(n, lod_extension)) slots(*levels, "ids", Kind::node);
    if (J* instancing = extension(n, "EXT_mesh_gpu_instancing")) slots(*instancing, "attributes", Kind::accessor);
  }

  void primitive(J& p) const {
    slots(p, "attributes", Kind::accessor);
    slot(p, "indices", Kind::accessor);
    slot(p, "material", Kind::material);
    each(p, "targets", [&](J& target) {
      if (!target.is_object()) return;
      for (J& item : target) visit_(Kind::accessor, item);
    });
    extension_slot(p, draco_extension, "bufferView", Kind::buffer_view);
    if (J* variants = extension(p, "KHR_materials_variants")) {
      each(*variants, "mappings", [&](J& mapping) { slot(mapping, "material", Kind::material); });
    }
  }

  void accessor(J& a) const {
    slot(a, "bufferView", Kind::buffer_view);
    for (const auto* part : {"indices", "values"}) {
      if (J* found = find_path(a, "sparse", part)) slot(*found, "bufferView", Kind::buffer_view);
    }
  }

  void animation(J& a) const {
    each(a, "channels", [&](J& channel) {
      if (J* target = find(channel, "target")) slot(*target, "node", Kind::node);
    });
    each(a, "samplers", [&](J& sampler) {
      slot(sampler, "input", Kind::accessor);
      slot(sampler, "output", Kind::accessor);
    });
  }

  // Textures are named by objects with an index, under keys that end in "Texture", in a material and all its
  // extensions.
  void texture_infos(J& value) const {
    if (!value.is_object()) return;
    for (auto& [key, item] : value.template get_ref<object_of<J>&>()) {
      if (key == "extras" || !item.is_object()) continue;
      if (key.size() >= 7 && key.compare(key.size() - 7, 7, "Texture") == 0) slot(item, "index", Kind::texture);
      texture_infos(item);
    }
  }

  void texture(J& t) const {
    slot(t, "sampler", Kind::sampler);
    slot(t, "source", Kind::image);
    for (const auto* name : {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
      extension_slot(t, name, "source", Kind::image);
    }
  }

  template <class T> using object_of = std::conditional_t<std::is_const_v<T>, const Json::object_t, Json::object_t>;

  const std::function<void(Kind, J&)>& visit_;
};

} // namespace

std::string_view array_of(Kind kind) {
  switch (kind) {
  case Kind::accessor:
    return "accessors";
  case Kind::buffer_view:
    return "bufferViews";
  case Kind::buffer:
    return "buffers";
  case Kind::image:
    return "images";
  case Kind::texture:
    return "textures";
  case Kind::sampler:
    return "samplers";
  case Kind::material:
    return "materials";
  case Kind::mesh:
    return "meshes";
  case Kind::node:
    return "nodes";
  case Kind::skin:
    return "skins";
  case Kind::camera:
    return "cameras";
  case Kind::scene:
    return "scenes";
  }
  return {};
}

void for_each_reference(const Json& document, const std::function<void(Kind, const Json&)>& visit) {
  Walker<const Json>(visit).document(document);
}

void for_each_reference(Json& document, const std::function<void(Kind, Json&)>& visit) {
  Walker<Json>(visit).document(document);
}

} // namespace orbis::asset
