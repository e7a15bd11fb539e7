#include "core/steps/preview.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "core/asset/image_codec.h"
#include "core/asset/materials.h"
#include "core/asset/placement.h"
#include "core/texture/preview.h"

namespace orbis {
namespace {

constexpr std::uint32_t preview_width = 1024, preview_height = 512;
constexpr std::size_t most_copied_triangles = 1'000'000; // of meshes that are shown more than once; some 250 bytes each

using asset::Placement;

// Whether float32 holds a place, as it would have to for a renderer.
bool is_finite(const Vec3d& p) { return norm(p) <= double{std::numeric_limits<float>::max()}; }

// The normal at a vertex as the input has it; zero where it has none.
Vec3d own_normal(const asset::Asset& asset, const Surface& surface, const texture::CutVertex& v) {
  const std::uint32_t primitive = surface.primitive_of[v.triangle];
  const asset::Attribute* normal = asset.primitives[primitive].find("NORMAL");
  if (normal == nullptr) return {};
  Vec3d sum;
  for (std::size_t k = 0; k < 3; ++k) {
    if (v.barycentric[k] == 0) continue;
    const std::uint32_t i = surface.corners[v.triangle][k] - surface.first_vertex[primitive];
    sum += asset::vector_at(*normal, i) * v.barycentric[k];
  }
  return sum;
}

// Normals go by the cofactors of a linear map, (A^-1)^T but for a factor. It is negative where A mirrors.
Vec3d turned_normal(const asset::Matrix3& a, const Vec3d& n) {
  const Vec3d x{a[0][0], a[1][0], a[2][0]}, y{a[0][1], a[1][1], a[2][1]}, z{a[0][2], a[1][2], a[2][2]};
  const Vec3d turned = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
  return asset::mirrors(a) ? -turned : turned;
}

// What a primitive of the asset looks like on the atlas. Without NORMAL it is flat to a glTF renderer; a normal map
// that was baked of it shows the same.
texture::Material material_of(const asset::Asset& asset, const asset::Primitive& primitive,
                              const asset::NewPrimitive& delivered) {
  texture::Material out;
  if (!delivered.plain_base_color) out.factor = asset::base_color_factor(asset, primitive);
  out.alpha = asset::alpha_of(asset, primitive);
  out.is_double_sided = asset::shows_back_faces(asset, primitive);
  out.is_flat = primitive.find("NORMAL") == nullptr;
  return out;
}

// The cut mesh where the scene shows it: each mesh at its first node, then the copies at its other ones.
class Scene {
public:
  Scene(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut, const Delivery& delivery)
      : surface_(surface), placements_(asset::placements_of(asset)), mesh_(cut), shape_{mesh_, {}, {}, {}, {}} {
    find_meshes(cut);
    shape_.positions.reserve(cut.vertices.size());
    for (const texture::CutVertex& v : cut.vertices)
      shape_.positions.push_back(texture::interpolated(surface.mesh.positions, surface.mesh.triangles, v));
    shape_.normals = texture::smooth_normals(cut, shape_.positions);
    for (std::size_t v = 0; v < cut.vertices.size(); ++v)
      if (const Vec3d n = own_normal(asset, surface, cut.vertices[v]); norm(n) > 0) shape_.normals[v] = normalized(n);
    for (std::size_t p = 0; p < asset.primitives.size(); ++p)
      shape_.materials.push_back(material_of(asset, asset.primitives[p], delivery.primitives[p]));
    for (const std::uint32_t parent : cut.parent) shape_.material_of.push_back(surface.primitive_of[parent]);
    place();
  }

  [[nodiscard]] const texture::Shape& shape() const { return shape_; }

private:
  const Surface& surface_;
  std::vector<std::vector<Placement>> placements_; // by mesh of the document
  texture::CutMesh mesh_;
  texture::Shape shape_;
  std::vector<std::uint32_t> mesh_of_vertex_;
  std::vector<std::vector<std::uint32_t>> triangles_of_; // mesh of the document -> its triangles
  std::vector<mesh::Index> copy_of_;                     // vertex -> its latest copy

  void find_meshes(const texture::CutMesh& cut) {
    mesh_of_vertex_.resize(cut.vertices.size());
    triangles_of_.resize(placements_.size());
    for (std::uint32_t t = 0; t < cut.triangles.size(); ++t) {
      const std::uint32_t mesh = surface_.components[cut.charts[cut.chart[t]].component].mesh;
      triangles_of_[mesh].push_back(t);
      for (const mesh::Index v : cut.triangles[t]) mesh_of_vertex_[v] = mesh;
    }
  }

  void place() {
    const std::vector<Vec3d> positions = shape_.positions, normals = shape_.normals;
    std::size_t copied = 0;
    for (std::size_t m = 0; m < placements_.size(); ++m) {
      drop_beyond_numbers(m, positions);
      copied += (placements_[m].size() - 1) * triangles_of_[m].size();
    }
    copy_of_.resize(positions.size());
    for (std::size_t m = 0; m < placements_.size() && copied <= most_copied_triangles; ++m)
      for (std::size_t i = 1; i < placements_[m].size(); ++i) add_copy(m, placements_[m][i], positions, normals);
    for (std::size_t v = 0; v < positions.size(); ++v) put(v, placements_[mesh_of_vertex_[v]].front());
    for (std::size_t m = 0; m < placements_.size(); ++m)
      for (const std::uint32_t t : triangles_of_[m]) turn_as(placements_[m].front(), mesh_.triangles[t]);
  }

  // Where all places of a mesh are beyond what numbers hold, it stays where it is.
  void drop_beyond_numbers(std::size_t mesh, std::span<const Vec3d> positions) {
    const std::array<Vec3d, 8> corners = box_around(mesh, positions);
    std::erase_if(placements_[mesh], [&](const Placement& placement) {
      return !std::ranges::all_of(corners, [&](const Vec3d& p) { return is_finite(placement(p)); });
    });
    if (placements_[mesh].empty()) placements_[mesh].emplace_back();
  }

  // The corners of a mesh's bounding box.
  [[nodiscard]] std::array<Vec3d, 8> box_around(std::size_t mesh, std::span<const Vec3d> positions) const {
    std::array<Vec3d, 8> corners{};
    if (triangles_of_[mesh].empty()) return corners;
    Vec3d low = positions[mesh_.triangles[triangles_of_[mesh].front()][0]], high = low;
    for (const std::uint32_t t : triangles_of_[mesh])
      for (const mesh::Index v : mesh_.triangles[t]) {
        const Vec3d& p = positions[v];
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
    for (std::size_t i = 0; i < corners.size(); ++i)
      corners[i] = {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z};
    return corners;
  }

  // Where a mesh is mirrored, its triangles go the other way around.
  static void turn_as(const Placement& placement, mesh::Triangle& triangle) {
    if (asset::mirrors(placement.linear)) std::swap(triangle[1], triangle[2]);
  }

  void put(std::size_t v, const Placement& placement) {
    shape_.positions[v] = placement(shape_.positions[v]);
    shape_.normals[v] = turned_normal(placement.linear, shape_.normals[v]);
    if (const double length = norm(shape_.normals[v]); length > 0) shape_.normals[v] *= 1 / length;
  }

  void add_copy(std::size_t mesh, const Placement& placement, std::span<const Vec3d> positions,
                std::span<const Vec3d> normals) {
    const auto first = static_cast<mesh::Index>(mesh_.vertices.size());
    for (const std::uint32_t t : triangles_of_[mesh]) {
      mesh::Triangle triangle = mesh_.triangles[t];
      for (mesh::Index& v : triangle) {
        mesh::Index& copy = copy_of_[v];
        if (copy < first) {
          copy = static_cast<mesh::Index>(mesh_.vertices.size());
          mesh_.vertices.push_back(mesh_.vertices[v]);
          shape_.positions.push_back(positions[v]);
          shape_.normals.push_back(normals[v]);
          put(copy, placement);
        }
        v = copy;
      }
      turn_as(placement, triangle);
      mesh_.triangles.push_back(triangle);
      mesh_.chart.push_back(mesh_.chart[t]);
      shape_.material_of.push_back(shape_.material_of[t]);
    }
  }
};

} // namespace

std::vector<std::byte> preview(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                               const Delivery& delivery, std::span<const texture::Image> pages, std::uint32_t threads) {
  const Scene scene(asset, surface, cut, delivery);
  mesh::ThreadPool pool(threads);
  const texture::Image picture =
      texture::draw_side_by_side(cut, scene.shape(), pages, preview_width, preview_height, pool);
  return asset::encode_png(picture, texture::Encoding::srgb, threads);
}

} // namespace orbis
