#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/mesh/weld.h"
#include "core/sphere/certificate.h"
#include "core/steps/delivery.h"

namespace orbis {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::not_certified, "the result did not pass its proof, so it is not delivered: " + why);
}

// The read-back file's primitives by their place: mesh, and primitive of the mesh.
using Places = std::map<std::pair<std::uint32_t, std::uint32_t>, const asset::Primitive*>;

Places places_of(const asset::Asset& file) {
  Places out;
  for (const asset::Primitive& q : file.primitives) out[{q.mesh, q.primitive}] = &q;
  return out;
}

// The one that stands where primitive p of the input stood.
const asset::Primitive& counterpart(const Places& places, const asset::Primitive& p) {
  const auto found = places.find({p.mesh, p.primitive});
  if (found == places.end()) refuse("a primitive is missing from the file");
  return *found->second;
}

std::vector<Vec3f> vectors(const asset::Primitive& primitive, std::string_view name) {
  const asset::Attribute* attribute = primitive.find(name);
  if (attribute == nullptr || attribute->components != 3) refuse("an attribute is missing from the file");
  std::vector<Vec3f> out(attribute->count());
  for (std::size_t v = 0; v < out.size(); ++v) {
    out[v] = {static_cast<float>(attribute->get(v, 0)), static_cast<float>(attribute->get(v, 1)),
              static_cast<float>(attribute->get(v, 2))};
  }
  return out;
}

void read_uv(const asset::Primitive& primitive, std::uint32_t texcoord, std::vector<Vec2f>& out) {
  const asset::Attribute* uv = primitive.find("TEXCOORD_" + std::to_string(texcoord));
  if (uv == nullptr || uv->components != 2) refuse("an attribute is missing from the file");
  for (std::size_t v = 0; v < uv->count(); ++v)
    out.push_back({static_cast<float>(uv->get(v, 0)), static_cast<float>(uv->get(v, 1))});
}

// A triangle may begin with another corner: EXT_meshopt_compression does not keep the first.
bool are_same_triangles(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  if (a.size() != b.size()) return false;
  for (std::size_t t = 0; t < a.size(); t += 3) {
    const auto begins_at = [&](std::size_t k) {
      return a[t] == b[t + k] && a[t + 1] == b[t + (k + 1) % 3] && a[t + 2] == b[t + (k + 2) % 3];
    };
    if (!begins_at(0) && !begins_at(1) && !begins_at(2)) return false;
  }
  return true;
}

// What the file says, all primitives in a row.
struct ReadBack {
  std::vector<std::uint32_t> first; // primitive of the input -> its first vertex in the row
  std::vector<Vec3f> sphere, position;
  std::vector<Vec2f> uv;                   // in the atlas
  std::vector<mesh::Triangle> triangles;   // indices into the row
  std::vector<std::uint32_t> component_of; // triangle -> component of the surface
};

ReadBack read_back(std::span<const std::byte> glb, const asset::Asset& input, const Delivery& delivery) {
  Limits generous; // our own file: it is as large as it is
  generous.max_bytes = generous.max_triangles = generous.max_vertices = generous.max_image_pixels = UINT64_MAX / 64;
  const asset::Asset file = asset::read_asset(glb, {}, generous);
  const Places places = places_of(file);
  ReadBack out;
  for (std::size_t i = 0; i < input.primitives.size(); ++i) {
    const auto first = static_cast<mesh::Index>(out.sphere.size());
    out.first.push_back(first);
    if (delivery.primitives[i].indices.empty()) continue;
    const asset::Primitive& q = counterpart(places, input.primitives[i]);
    const std::vector<Vec3f> sphere = vectors(q, "_SPHERE"), position = q.positions();
    out.sphere.insert(out.sphere.end(), sphere.begin(), sphere.end());
    out.position.insert(out.position.end(), position.begin(), position.end());
    const std::vector<std::uint32_t>& component = delivery.component_of[i];
    if (!are_same_triangles(q.indices, delivery.primitives[i].indices))
      refuse("a primitive has not the triangles that were written");
    read_uv(q, delivery.primitives[i].atlas_texcoord, out.uv);
    for (std::size_t t = 0; t < component.size(); ++t) {
      out.triangles.push_back({first + q.indices[3 * t], first + q.indices[3 * t + 1], first + q.indices[3 * t + 2]});
      out.component_of.push_back(component[t]);
    }
  }
  return out;
}

// The delivered triangles of each component on its sphere, not joined yet.
std::vector<mesh::TriangleMesh> by_component(const ReadBack& file, std::size_t components) {
  std::vector<mesh::TriangleMesh> out(components);
  std::vector<mesh::Index> place(file.sphere.size(), no_primitive); // no vertex serves two components
  for (std::size_t t = 0; t < file.triangles.size(); ++t) {
    if (file.component_of[t] == no_primitive) continue;
    mesh::TriangleMesh& piece = out[file.component_of[t]];
    mesh::Triangle placed{};
    for (std::size_t k = 0; k < 3; ++k) {
      mesh::Index& at = place[file.triangles[t][k]];
      if (at == no_primitive) {
        at = static_cast<mesh::Index>(piece.positions.size());
        piece.positions.push_back(file.sphere[file.triangles[t][k]]);
      }
      placed[k] = at;
    }
    piece.triangles.push_back(placed);
  }
  return out;
}

// One certificate for all components: counts are added up, and each property is that of the worst.
void add(const sphere::Certificate& one, bool first, sphere::Certificate& all) {
  if (first) {
    all = one;
    return;
  }
  all.closed = all.closed && one.closed;
  all.manifold = all.manifold && one.manifold;
  all.connected = all.connected && one.connected;
  if (one.euler_characteristic != 2) all.euler_characteristic = one.euler_characteristic;
  all.triangles += one.triangles;
  all.vertices += one.vertices;
  all.folded += one.folded;
  all.off_grid += one.off_grid;
  all.max_radius_error = std::max(all.max_radius_error, one.max_radius_error);
  if (std::abs(one.degree - 1) > std::abs(all.degree - 1)) all.degree = one.degree;
  all.valid = all.valid && one.valid;
}

// Every copy of an input vertex must be where the input has it, to the bit.
void check_positions(const asset::Asset& input, const Delivery& delivery, const ReadBack& file) {
  for (std::size_t p = 0; p < input.primitives.size(); ++p) {
    if (delivery.primitives[p].indices.empty()) continue;
    const std::vector<Vec3f> positions = input.primitives[p].positions();
    const std::vector<VertexSource>& sources = delivery.sources[p];
    for (std::size_t v = 0; v < sources.size(); ++v) {
      const int k = sources[v].copied();
      if (k < 0) continue;
      const Vec3f& wanted = positions[sources[v].corners[static_cast<std::size_t>(k)]];
      if (!(file.position.at(file.first[p] + v) == wanted)) refuse("a vertex has moved");
    }
  }
}

// The component's points: from the file where it has them, from memory for the caps.
std::vector<Vec3f> points_of(const Component& c, std::span<const sphere::GridPoint> points, const Delivery& delivery,
                             const ReadBack& file) {
  std::vector<Vec3f> out;
  out.reserve(c.vertices);
  for (std::uint32_t v = c.first_vertex; v < c.end_vertex(); ++v) {
    if (v >= c.first_vertex + c.input_vertices) {
      out.push_back(sphere::from_grid(points[v]));
      continue;
    }
    const OutputVertex o = delivery.of_surface_vertex[v];
    const std::size_t at = file.first[o.primitive] + o.vertex;
    out.push_back(file.sphere.at(at));
  }
  return out;
}

// The cut mesh with the texture coordinates that the file has.
texture::CutMesh as_delivered(texture::CutMesh cut, const Delivery& delivery, const ReadBack& file) {
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    cut.vertices[v].uv = file.uv.at(file.first[o.primitive] + o.vertex);
  }
  return cut;
}

} // namespace

void certify_file(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                  const CutSphere& sphere, const Delivery& delivery, Report& report) {
  const std::vector<sphere::GridPoint>& points = sphere.points;
  const ReadBack file = read_back(glb, asset, delivery);
  check_positions(asset, delivery, file);
  report.atlas_certificate = texture::certify_atlas(as_delivered(sphere.cut, delivery, file));
  if (!report.atlas_certificate.valid) refuse(report.atlas_certificate.failure());
  const std::vector<mesh::TriangleMesh> delivered = by_component(file, surface.components.size());
  for (std::size_t i = 0; i < surface.components.size(); ++i) {
    const Component& c = surface.components[i];
    const mesh::TriangleMesh closed = mesh_of(surface, c);
    const std::vector<Vec3f> on_sphere = points_of(c, points, delivery, file);
    const sphere::Certificate whole = sphere::certify(on_sphere, closed.triangles);
    if (!whole.valid) refuse(whole.failure());
    add(whole, i == 0, report.certificate);

    // One sphere point, one point of the surface: joined by equal _SPHERE, the delivered triangles must close up again.
    const mesh::Welded joined = mesh::weld(delivered[i].positions, delivered[i].triangles);
    if (!joined.degenerate.empty()) refuse("a delivered triangle has no area on the sphere");
    const auto caps = std::span(closed.triangles).subspan(c.input_triangles);
    const sphere::Certificate cut = c.has_caps() ? sphere::certify_pieces(joined.mesh.positions, joined.mesh.triangles,
                                                                          sphere::solid_angle_of(on_sphere, caps))
                                                 : sphere::certify(joined.mesh.positions, joined.mesh.triangles);
    if (!cut.valid) refuse(cut.failure());
    add(cut, i == 0, report.cut_certificate);
    report.components[c.number].certified = true;
  }
  report.output_triangles = file.triangles.size();
  for (const asset::NewPrimitive& p : delivery.primitives) report.output_triangles += p.left_out.size() / 3;
  report.output_vertices = file.sphere.size();
}

} // namespace orbis
