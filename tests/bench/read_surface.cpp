#include "bench/read_surface.h"

#include <fstream>
#include <iterator>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace orbis::bench {

mesh::TriangleMesh read_surface(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  const asset::Asset asset = asset::read_asset(std::as_bytes(std::span(bytes)), {}, {});
  std::vector<Vec3f> positions;
  std::vector<mesh::Triangle> triangles;
  for (const asset::Primitive& p : asset.primitives) {
    const auto first = static_cast<mesh::Index>(positions.size());
    const std::vector<Vec3f> own = p.positions();
    positions.insert(positions.end(), own.begin(), own.end());
    for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3) {
      triangles.push_back({first + p.indices[i], first + p.indices[i + 1], first + p.indices[i + 2]});
    }
  }
  mesh::TriangleMesh mesh = mesh::weld(positions, triangles).mesh;
  const mesh::Topology topology = mesh::classify(mesh);
  if (!topology.is_sphere()) throw Error(ErrorCode::not_genus_zero, topology.refusal());
  static_cast<void>(mesh::orient_consistently(mesh));
  return mesh;
}

} // namespace orbis::bench
