#include "core/steps/tangent_frames.h"

#include <algorithm>
#include <cmath>

#include "core/steps/material_sources.h"

namespace orbis {
namespace {

using asset::Attribute;

Attribute& float_attribute(asset::NewPrimitive& p, std::string_view name, std::uint32_t components) {
  std::erase_if(p.attributes, [&](const Attribute& a) { return a.name == name; });
  Attribute out{std::string(name), asset::ComponentType::f32, false, components, {}};
  out.data.resize(p.attributes.front().count() * components * sizeof(float));
  p.attributes.push_back(std::move(out));
  return p.attributes.back();
}

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }

Vec3f unit(const Vec3d& v) {
  const double length = norm(v);
  return length > 0 ? Vec3f(v * (1 / length)) : Vec3f{0, 0, 1};
}

void set_vector(Attribute& attribute, std::size_t v, const Vec3f& value) {
  attribute.set(v, 0, double{value.x});
  attribute.set(v, 1, double{value.y});
  attribute.set(v, 2, double{value.z});
}

Vec3f get_vector(const Attribute& attribute, std::size_t v) {
  return {static_cast<float>(attribute.get(v, 0)), static_cast<float>(attribute.get(v, 1)),
          static_cast<float>(attribute.get(v, 2))};
}

void add_smooth_normals(const Surface& surface, const texture::CutMesh& cut, const std::vector<bool>& lacking,
                        Delivery& delivery) {
  if (std::ranges::find(lacking, true) == lacking.end()) return;
  for (std::size_t p = 0; p < lacking.size(); ++p) {
    if (!lacking[p]) continue;
    Attribute& normal = float_attribute(delivery.primitives[p], "NORMAL", 3);
    for (std::size_t v = 0; v < normal.count(); ++v) set_vector(normal, v, {0, 0, 1}); // of triangles that ride along
  }
  const std::vector<Vec3d> normals = smooth_normals(surface.mesh);
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    if (!lacking[o.primitive]) continue;
    const Vec3d normal = texture::interpolated(normals, surface.mesh.triangles, cut.vertices[v]);
    set_vector(*delivery.primitives[o.primitive].find("NORMAL"), o.vertex, unit(normal));
  }
}

void drop_tangent_targets(const asset::Primitive& input, asset::NewPrimitive& primitive, Report& report) {
  bool dropped = false;
  for (auto& target : primitive.targets) {
    dropped = std::erase_if(target, [](const Attribute& a) { return a.name == "TANGENT"; }) > 0 || dropped;
  }
  if (!dropped) return;
  report.notes.push_back({"tangent-targets-dropped",
                          "morph targets lost their TANGENT differences, which belonged to the old texture coordinates",
                          pointer_to(input)});
}

} // namespace

std::vector<Vec3d> smooth_normals(const mesh::TriangleMesh& mesh) {
  std::vector<Vec3d> sum(mesh.positions.size());
  for (const mesh::Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p(mesh.positions[t[k]]);
      const Vec3d a = Vec3d(mesh.positions[t[(k + 1) % 3]]) - p, b = Vec3d(mesh.positions[t[(k + 2) % 3]]) - p;
      const Vec3d n = cross(a, b);
      if (const double length = norm(n); length > 0) sum[t[k]] += n * (angle_between(a, b) / length);
    }
  }
  for (Vec3d& n : sum) {
    const double length = norm(n);
    n = length > 0 ? n * (1 / length) : Vec3d{0, 0, 1};
  }
  return sum;
}

TangentFrames add_tangent_frames(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                                 const std::vector<bool>& wanted, Delivery& delivery, Report& report) {
  std::vector<bool> lacking(wanted.size());
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    lacking[p] = wanted[p] && delivery.primitives[p].find("NORMAL") == nullptr;
  }
  add_smooth_normals(surface, cut, lacking, delivery);

  TangentFrames out;
  out.normals.resize(cut.vertices.size());
  out.tangents.resize(cut.vertices.size());
  std::vector<Vec3f> positions(cut.vertices.size());
  std::vector<Vec2f> uv(cut.vertices.size());
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    if (!wanted[o.primitive]) continue;
    out.normals[v] = get_vector(*delivery.primitives[o.primitive].find("NORMAL"), o.vertex);
    positions[v] = get_vector(*delivery.primitives[o.primitive].find("POSITION"), o.vertex);
    uv[v] = cut.vertices[v].uv;
  }
  std::vector<mesh::Triangle> triangles;
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    if (wanted[surface.primitive_of[cut.parent[t]]]) triangles.push_back(cut.triangles[t]);
  }
  const auto corners = texture::corner_tangents(positions, out.normals, uv, triangles);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) out.tangents[triangles[t][k]] = corners[t][k];
  }

  std::vector<Attribute*> attributes(wanted.size());
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    if (!wanted[p]) continue;
    attributes[p] = &float_attribute(delivery.primitives[p], "TANGENT", 4);
    // Vertices of triangles that only ride along have no place of their own on the surface: any frame will do.
    for (std::size_t v = 0; v < attributes[p]->count(); ++v) {
      set_vector(*attributes[p], v, {1, 0, 0});
      attributes[p]->set(v, 3, 1);
    }
    drop_tangent_targets(asset.primitives[p], delivery.primitives[p], report);
  }
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    if (!wanted[o.primitive]) continue;
    const texture::Tangent& t = out.tangents[v];
    set_vector(*attributes[o.primitive], o.vertex, {t.x, t.y, t.z});
    attributes[o.primitive]->set(o.vertex, 3, double{t.w});
  }
  return out;
}

void set_frame(asset::NewPrimitive& primitive, std::size_t vertex, const texture::VertexFrame& frame) {
  set_vector(*primitive.find("NORMAL"), vertex, frame.normal);
  Attribute& tangent = *primitive.find("TANGENT");
  set_vector(tangent, vertex, {frame.tangent.x, frame.tangent.y, frame.tangent.z});
  tangent.set(vertex, 3, double{frame.tangent.w});
}

} // namespace orbis
