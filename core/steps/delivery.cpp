#include "core/steps/delivery.h"

#include <string>

#include "core/steps/riders.h"

namespace orbis {
namespace {

using asset::Attribute;
using asset::ComponentType;

std::string texcoord(std::uint32_t n) { return "TEXCOORD_" + std::to_string(n); }

std::uint32_t free_texcoord(const asset::Primitive& primitive, std::uint32_t from) {
  while (primitive.find(texcoord(from)) != nullptr) ++from;
  return from;
}

Attribute float_attribute(std::string name, std::uint32_t components, std::size_t count) {
  Attribute out{std::move(name), ComponentType::f32, false, components, {}};
  out.data.resize(count * components * sizeof(float));
  return out;
}

// Numbers the cut vertices within their primitives, in the order of the triangles that use them.
class Numbering {
public:
  Numbering(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut)
      : surface_(surface), cut_(cut), seen_(cut.vertices.size(), false) {
    out_.primitives.resize(asset.primitives.size());
    out_.sources.resize(asset.primitives.size());
    out_.component_of.resize(asset.primitives.size());
    out_.page_of.resize(asset.primitives.size());
    out_.of_cut_vertex.resize(cut.vertices.size());
    out_.of_surface_vertex.resize(surface.mesh.positions.size());
  }

  Delivery run() {
    std::uint32_t component = 0;
    for (std::size_t t = 0; t < cut_.triangles.size(); ++t) {
      while (cut_.parent[t] >= surface_.components[component].end_triangle()) ++component;
      const std::uint32_t primitive = surface_.primitive_of[cut_.parent[t]];
      out_.component_of[primitive].push_back(component);
      for (const mesh::Index v : cut_.triangles[t]) {
        if (!seen_[v]) add(v, primitive);
        out_.primitives[primitive].indices.push_back(out_.of_cut_vertex[v].vertex);
      }
      out_.page_of[primitive] = cut_.page_of(t);
    }
    return std::move(out_);
  }

private:
  void add(mesh::Index v, std::uint32_t primitive) {
    seen_[v] = true;
    const texture::CutVertex& vertex = cut_.vertices[v];
    const mesh::Triangle& corners = surface_.corners[vertex.triangle];
    const std::uint32_t first = surface_.first_vertex[primitive];
    std::vector<VertexSource>& sources = out_.sources[primitive];
    out_.of_cut_vertex[v] = {primitive, static_cast<std::uint32_t>(sources.size())};
    if (vertex.point < out_.of_surface_vertex.size()) out_.of_surface_vertex[vertex.point] = out_.of_cut_vertex[v];
    sources.push_back({{corners[0] - first, corners[1] - first, corners[2] - first}, vertex.barycentric});
  }

  const Surface& surface_;
  const texture::CutMesh& cut_;
  std::vector<bool> seen_;
  Delivery out_;
};

} // namespace

Delivery make_delivery(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                       RiderPolicy riders) {
  Delivery out = Numbering(asset, surface, cut).run();
  std::vector<ExtraVertex> extra;
  if (riders == RiderPolicy::deliver) extra = add_riders(surface, cut, out);
  std::vector<Attribute> uv, sphere;
  for (std::size_t p = 0; p < out.primitives.size(); ++p) {
    const asset::Primitive& input = asset.primitives[p];
    asset::NewPrimitive& primitive = out.primitives[p];
    const std::size_t count = out.sources[p].size();
    primitive.attributes = interpolate(input.attributes, out.sources[p]);
    for (const auto& target : input.targets) primitive.targets.push_back(interpolate_target(target, out.sources[p]));
    // A set that a texture reads and the input lacks is no place for the atlas: renderers read zeros there, so do ours.
    primitive.atlas_texcoord = free_texcoord(input, asset::named_texture_sets(asset, input));
    for (std::uint32_t n = 0; n < primitive.atlas_texcoord; ++n)
      if (input.find(texcoord(n)) == nullptr) primitive.attributes.push_back(float_attribute(texcoord(n), 2, count));
    uv.push_back(float_attribute(texcoord(primitive.atlas_texcoord), 2, count));
    sphere.push_back(float_attribute("_SPHERE", 3, count));
  }
  const auto place = [&](const OutputVertex& o, const Vec3f& on_sphere, const Vec2f& in_atlas) {
    uv[o.primitive].set(o.vertex, 0, double{in_atlas.x});
    uv[o.primitive].set(o.vertex, 1, double{in_atlas.y});
    sphere[o.primitive].set(o.vertex, 0, double{on_sphere.x});
    sphere[o.primitive].set(o.vertex, 1, double{on_sphere.y});
    sphere[o.primitive].set(o.vertex, 2, double{on_sphere.z});
  };
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    place(out.of_cut_vertex[v], sphere::from_grid(cut.vertices[v].sphere), cut.vertices[v].uv);
  }
  for (const ExtraVertex& v : extra) place(v.at, v.sphere, v.uv);
  for (std::size_t p = 0; p < out.primitives.size(); ++p) {
    std::erase_if(out.primitives[p].attributes, [](const Attribute& a) { return a.name == "_SPHERE"; });
    out.primitives[p].attributes.push_back(std::move(uv[p]));
    out.primitives[p].attributes.push_back(std::move(sphere[p]));
  }
  return out;
}

} // namespace orbis
