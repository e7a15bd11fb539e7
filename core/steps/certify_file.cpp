#include <string>

#include "core/mesh/weld.h"
#include "core/sphere/certificate.h"
#include "core/steps/delivery.h"

namespace orbis {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::not_certified, "the result did not pass its proof, so it is not delivered: " + why);
}

// The primitive of the read-back file that stands where primitive p of the input stood.
const asset::Primitive& counterpart(const asset::Asset& file, const asset::Primitive& p) {
  for (const asset::Primitive& q : file.primitives) {
    if (q.mesh == p.mesh && q.primitive == p.primitive) return q;
  }
  refuse("a primitive is missing from the file");
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

struct ReadBack {
  std::vector<std::vector<Vec3f>> sphere, position; // by primitive
  std::vector<Vec3f> all_sphere;                    // in a row
  std::vector<mesh::Triangle> triangles;            // indices into the row
};

ReadBack read_back(std::span<const std::byte> glb, const asset::Asset& input) {
  Limits generous; // our own file: it is as large as it is
  generous.max_bytes = generous.max_triangles = generous.max_vertices = generous.max_image_pixels = UINT64_MAX / 64;
  const asset::Asset file = asset::read_asset(glb, {}, generous);
  ReadBack out;
  for (const asset::Primitive& p : input.primitives) {
    const asset::Primitive& q = counterpart(file, p);
    const auto first = static_cast<mesh::Index>(out.all_sphere.size());
    out.sphere.push_back(vectors(q, "_SPHERE"));
    out.position.push_back(q.positions());
    out.all_sphere.insert(out.all_sphere.end(), out.sphere.back().begin(), out.sphere.back().end());
    for (std::size_t i = 0; i + 2 < q.indices.size(); i += 3) {
      out.triangles.push_back({first + q.indices[i], first + q.indices[i + 1], first + q.indices[i + 2]});
    }
  }
  return out;
}

} // namespace

void certify_file(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                  const Delivery& delivery, Report& report) {
  const ReadBack file = read_back(glb, asset);

  std::vector<Vec3f> points;
  for (std::size_t v = 0; v < surface.mesh.positions.size(); ++v) {
    const OutputVertex o = delivery.of_surface_vertex[v];
    points.push_back(file.sphere[o.primitive].at(o.vertex));
    if (!(file.position[o.primitive].at(o.vertex) == surface.mesh.positions[v])) refuse("a vertex has moved");
  }
  report.certificate = sphere::certify(points, surface.mesh.triangles);
  if (!report.certificate.valid) refuse(report.certificate.failure());

  // One sphere point, one point of the surface: joined by equal _SPHERE, the delivered triangles must close up again.
  const mesh::Welded joined = mesh::weld(file.all_sphere, file.triangles);
  if (!joined.degenerate.empty()) refuse("a delivered triangle has no area on the sphere");
  report.cut_certificate = sphere::certify(joined.mesh.positions, joined.mesh.triangles);
  if (!report.cut_certificate.valid) refuse(report.cut_certificate.failure());

  report.output_triangles = file.triangles.size();
  report.output_vertices = file.all_sphere.size();
}

} // namespace orbis
