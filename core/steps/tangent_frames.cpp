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

FrameFinder::FrameFinder(const Surface& surface, const texture::CutMesh& cut) : surface_(surface), cut_(cut) {
  frames_.normals.resize(cut.vertices.size());
  frames_.tangents.resize(cut.vertices.size());
}

Vec3f FrameFinder::smooth_normal(const texture::CutVertex& v) {
  if (!smooth_) smooth_ = smooth_normals(surface_.mesh);
  return unit(texture::interpolated(*smooth_, surface_.mesh.triangles, v));
}

// Ascending.
std::vector<mesh::Index> FrameFinder::vertices_of(std::span<const std::uint32_t> part) const {
  std::vector<mesh::Index> out;
  out.reserve(3 * part.size());
  for (const std::uint32_t t : part) out.insert(out.end(), cut_.triangles[t].begin(), cut_.triangles[t].end());
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

TangentFrames& FrameFinder::find(std::span<const std::uint32_t> part, const Delivery& delivery) {
  const std::vector<mesh::Index> vertices = vertices_of(part);
  std::vector<Vec3f> positions(vertices.size()), normals(vertices.size());
  std::vector<Vec2f> uv(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const OutputVertex o = delivery.of_cut_vertex[vertices[i]];
    const asset::NewPrimitive& primitive = delivery.primitives[o.primitive];
    const Attribute* normal = primitive.find("NORMAL");
    normals[i] = normal != nullptr ? get_vector(*normal, o.vertex) : smooth_normal(cut_.vertices[vertices[i]]);
    positions[i] = get_vector(*primitive.find("POSITION"), o.vertex);
    uv[i] = cut_.vertices[vertices[i]].uv;
    frames_.normals[vertices[i]] = normals[i];
  }
  std::vector<mesh::Triangle> triangles(part.size());
  for (std::size_t t = 0; t < part.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      triangles[t][k] =
          static_cast<mesh::Index>(std::ranges::lower_bound(vertices, cut_.triangles[part[t]][k]) - vertices.begin());
  const auto corners = texture::corner_tangents(positions, normals, uv, triangles);
  for (std::size_t t = 0; t < part.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) frames_.tangents[cut_.triangles[part[t]][k]] = corners[t][k];
  return frames_;
}

void FrameAttributes::set(std::size_t vertex, const texture::VertexFrame& frame) const {
  set_vector(*normal, vertex, frame.normal);
  set_tangent(vertex, frame.tangent);
}

void FrameAttributes::set_tangent(std::size_t vertex, const texture::Tangent& t) const {
  set_vector(*tangent, vertex, {t.x, t.y, t.z});
  tangent->set(vertex, 3, double{t.w});
}

std::vector<FrameAttributes> add_frame_attributes(const asset::Asset& asset, const std::vector<bool>& wanted,
                                                  Delivery& delivery, Report& report) {
  std::vector<FrameAttributes> out(wanted.size());
  for (std::size_t p = 0; p < wanted.size(); ++p) {
    if (!wanted[p]) continue;
    asset::NewPrimitive& primitive = delivery.primitives[p];
    out[p].normal_is_new = primitive.find("NORMAL") == nullptr;
    if (out[p].normal_is_new) float_attribute(primitive, "NORMAL", 3);
    out[p].tangent = &float_attribute(primitive, "TANGENT", 4);
    out[p].normal = primitive.find("NORMAL");
    for (std::size_t v = 0; v < out[p].tangent->count(); ++v) {
      if (out[p].normal_is_new) set_vector(*out[p].normal, v, {0, 0, 1});
      out[p].set_tangent(v, {1, 0, 0, 1});
    }
    drop_tangent_targets(asset.primitives[p], primitive, report);
  }
  return out;
}

} // namespace orbis
