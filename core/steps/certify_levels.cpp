#include <algorithm>
#include <cmath>
#include <string>

#include "core/lod/uv_orientation.h"
#include "core/mesh/weld.h"
#include "core/sphere/certificate.h"
#include "core/steps/levels.h"

namespace orbis {
namespace {

[[noreturn]] void refuse(std::size_t level, const std::string& why) {
  throw Error(ErrorCode::not_certified, "level of detail " + std::to_string(level + 1) +
                                            " did not pass its proof, so it is not delivered: " + why);
}

// The triangles of one component as the file has them, not joined.
struct Piece {
  mesh::TriangleMesh on_sphere;
  std::uint64_t folded_in_atlas = 0;
};

// +1 or -1: how the triangles of the full surface lie in the atlas, all of them alike.
int atlas_orientation(const texture::CutMesh& cut) {
  double area = 0;
  for (const auto& [a, b, c] : cut.triangles) {
    const Vec2f &p = cut.vertices[a].uv, &q = cut.vertices[b].uv, &r = cut.vertices[c].uv;
    area += (double{q.x} - p.x) * (double{r.y} - p.y) - (double{r.x} - p.x) * (double{q.y} - p.y);
  }
  return area < 0 ? -1 : 1;
}

class LevelReader {
public:
  // first_mesh: where the meshes of the levels begin in the file.
  LevelReader(std::span<const std::byte> glb, const asset::Asset& asset, std::uint32_t first_mesh) : asset_(asset) {
    Limits generous; // our own file: it is as large as it is
    generous.max_bytes = generous.max_triangles = generous.max_vertices = generous.max_image_pixels = UINT64_MAX / 64;
    file_ = asset::read_asset(glb, {}, generous);
    while (next_ < file_.primitives.size() && file_.primitives[next_].mesh < first_mesh) ++next_;
  }

  // The levels' primitives stand behind the document's, in the order in which they were written.
  std::vector<Piece> next(std::size_t number, const DetailLevel& level, std::size_t components) {
    std::vector<Piece> pieces(components);
    const int orientation = atlas_orientation(level.level.mesh);
    for (std::size_t p = 0; p < asset_.primitives.size(); ++p) {
      const asset::NewPrimitive& written = level.delivery.primitives[p];
      if (written.indices.empty()) continue;
      const asset::Primitive& read = next_with_sphere(number);
      const asset::Attribute* uv = read.find("TEXCOORD_" + std::to_string(written.atlas_texcoord));
      const asset::Attribute& sphere = *read.find("_SPHERE");
      if (uv == nullptr || read.indices.size() != written.indices.size())
        refuse(number, "a primitive has not the triangles that were written");
      for (std::size_t t = 0; t < read.indices.size() / 3; ++t) {
        Piece& piece = pieces[level.delivery.component_of[p][t]];
        const auto first = static_cast<mesh::Index>(piece.on_sphere.positions.size());
        std::array<Vec2f, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = read.indices[3 * t + k];
          piece.on_sphere.positions.emplace_back(asset::vector_at(sphere, v));
          corner[k] = {static_cast<float>(uv->get(v, 0)), static_cast<float>(uv->get(v, 1))};
        }
        piece.on_sphere.triangles.push_back({first, first + 1, first + 2});
        if (lod::uv_orientation(corner[0], corner[1], corner[2]) != orientation) ++piece.folded_in_atlas;
      }
    }
    return pieces;
  }

private:
  const asset::Primitive& next_with_sphere(std::size_t number) {
    while (next_ < file_.primitives.size() && file_.primitives[next_].find("_SPHERE") == nullptr) ++next_;
    if (next_ == file_.primitives.size()) refuse(number, "a primitive is missing from the file");
    return file_.primitives[next_++];
  }

  const asset::Asset& asset_;
  asset::Asset file_;
  std::size_t next_ = 0;
};

struct LevelProof {
  std::uint64_t folded = 0;
  double degree = 1; // of the worst component
};

LevelProof prove(const std::vector<Piece>& pieces, const Surface& surface, std::size_t number) {
  LevelProof out;
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    const Piece& piece = pieces[c];
    if (piece.on_sphere.triangles.empty()) continue; // a component that the level had to leave out
    const mesh::Welded joined = mesh::weld(piece.on_sphere.positions, piece.on_sphere.triangles);
    const sphere::Certificate proof = sphere::certify(joined.mesh.positions, joined.mesh.triangles);
    out.folded += proof.folded + joined.degenerate.size() + piece.folded_in_atlas;
    if (out.folded > 0) refuse(number, std::to_string(out.folded) + " triangles are folded");
    if (surface.components[c].has_caps()) continue; // open: it covers its part of the sphere
    if (!proof.valid) refuse(number, proof.failure());
    if (std::abs(proof.degree - 1) > std::abs(out.degree - 1)) out.degree = proof.degree;
  }
  return out;
}

} // namespace

void certify_levels(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                    std::span<const DetailLevel> levels, Report& report) {
  if (levels.empty()) return;
  // Primitives are no measure: what was left out of a mesh stands behind it as one more.
  std::uint32_t meshes = 0;
  for (const asset::Primitive& p : asset.primitives) meshes = std::max(meshes, p.mesh + 1);
  LevelReader reader(glb, asset, meshes);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const LevelProof proof = prove(reader.next(i, levels[i], surface.components.size()), surface, i);
    report.levels[i].folded = proof.folded;
    report.levels[i].degree = proof.degree;
  }
}

void certify_level_file(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                        const DetailLevel& level, std::size_t number) {
  LevelReader reader(glb, asset, 0);
  static_cast<void>(prove(reader.next(number, level, surface.components.size()), surface, number));
}

} // namespace orbis
