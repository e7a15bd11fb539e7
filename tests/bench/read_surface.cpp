#include "bench/read_surface.h"

#include <fstream>
#include <iterator>
#include <vector>

#include "core/asset/asset.h"
#include "core/mesh/topology.h"
#include "core/mesh/weld.h"

namespace orbis::bench {

std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

mesh::TriangleMesh read_surface(const std::string& path) {
  const asset::Asset asset = asset::read_asset(bytes_of(path), {}, {});
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
