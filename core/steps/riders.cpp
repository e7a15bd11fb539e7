#include "core/steps/riders.h"

#include <algorithm>
#include <map>
#include <utility>

namespace orbis {
namespace {

class RiderWriter {
public:
  RiderWriter(const Surface& surface, const texture::CutMesh& cut, Delivery& delivery)
      : surface_(surface), cut_(cut), delivery_(delivery) {}

  std::vector<ExtraVertex> run() {
    for (const Rider& rider : surface_.riders) {
      if (rider.twin != no_primitive) ride_on_twin(rider);
    }
    find_copies();
    for (const Rider& rider : surface_.riders) {
      if (rider.twin != no_primitive || delivery_.primitives[rider.primitive].indices.empty()) continue;
      if (has_place(rider)) {
        ride_alone(rider);
      } else {
        leave_out(rider);
      }
    }
    return std::move(extra_);
  }

private:
  static bool has_place(const Rider& rider) {
    return std::ranges::any_of(rider.vertices, [](mesh::Index v) { return v != no_primitive; });
  }

  void leave_out(const Rider& rider) {
    const mesh::Triangle corners = in_primitive(rider);
    std::vector<std::uint32_t>& left_out = delivery_.primitives[rider.primitive].left_out;
    left_out.insert(left_out.end(), corners.begin(), corners.end());
  }

  OutputVertex add(std::uint32_t primitive, const VertexSource& source, const Vec3f& sphere, const Vec2f& uv) {
    std::vector<VertexSource>& sources = delivery_.sources[primitive];
    const OutputVertex at{primitive, static_cast<std::uint32_t>(sources.size())};
    sources.push_back(source);
    extra_.push_back({at, sphere, uv});
    return at;
  }

  void add_triangle(std::uint32_t primitive, const mesh::Triangle& vertices) {
    std::vector<std::uint32_t>& indices = delivery_.primitives[primitive].indices;
    indices.insert(indices.end(), vertices.begin(), vertices.end());
    delivery_.component_of[primitive].push_back(no_primitive);
  }

  [[nodiscard]] mesh::Triangle in_primitive(const Rider& rider) const {
    const std::uint32_t first = surface_.first_vertex[rider.primitive];
    return {rider.corners[0] - first, rider.corners[1] - first, rider.corners[2] - first};
  }

  void ride_on_twin(const Rider& rider) {
    const bool same_vertices =
        rider.corners == surface_.corners[rider.twin] && rider.primitive == surface_.primitive_of[rider.twin];
    delivery_.page_of[rider.primitive] = delivery_.page_of[surface_.primitive_of[rider.twin]];
    const auto [begin, end] = std::equal_range(cut_.parent.begin(), cut_.parent.end(), rider.twin);
    for (auto piece = begin; piece != end; ++piece) {
      mesh::Triangle vertices{};
      const mesh::Triangle& pieces_vertices = cut_.triangles[static_cast<std::size_t>(piece - cut_.parent.begin())];
      for (std::size_t k = 0; k < 3; ++k) {
        const mesh::Index v = pieces_vertices[k];
        vertices[k] = same_vertices ? delivery_.of_cut_vertex[v].vertex : copy_on_rider(rider, v);
      }
      add_triangle(rider.primitive, vertices);
    }
  }

  std::uint32_t copy_on_rider(const Rider& rider, mesh::Index v) {
    const texture::CutVertex& vertex = cut_.vertices[v];
    const VertexSource source{in_primitive(rider), texture::weights_on(rider.twin, surface_.mesh.triangles, vertex)};
    return add(rider.primitive, source, sphere::from_grid(vertex.sphere), vertex.uv).vertex;
  }

  // The first copy of each input vertex that a rider needs and that is delivered already.
  void find_copies() {
    for (const Rider& rider : surface_.riders) {
      if (rider.twin != no_primitive) continue;
      for (const mesh::Index corner : rider.corners) copies_.try_emplace(corner, no_primitive);
    }
    if (copies_.empty()) return;
    for (std::uint32_t p = 0; p < delivery_.sources.size(); ++p) {
      const std::vector<VertexSource>& sources = delivery_.sources[p];
      for (std::uint32_t v = 0; v < sources.size(); ++v) {
        const int k = sources[v].copied();
        if (k < 0) continue;
        const auto found = copies_.find(surface_.first_vertex[p] + sources[v].corners[static_cast<std::size_t>(k)]);
        if (found != copies_.end() && found->second == no_primitive) found->second = v;
      }
    }
  }

  void ride_alone(const Rider& rider) {
    mesh::Triangle vertices{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& copy = copies_.at(rider.corners[k]);
      if (copy == no_primitive) copy = place(rider, k);
      vertices[k] = copy;
    }
    add_triangle(rider.primitive, vertices);
  }

  std::uint32_t place(const Rider& rider, std::size_t k) {
    const mesh::Triangle corners = in_primitive(rider);
    const VertexSource source{{corners[k], corners[k], corners[k]}, {1, 0, 0}};
    const texture::CutVertex& there = cut_.vertices[cut_vertex_of(place_of(rider, k))];
    return add(rider.primitive, source, sphere::from_grid(there.sphere), there.uv).vertex;
  }

  // Where the corner lies, or else one of the others: an end that sticks out is taken back to the surface.
  static mesh::Index place_of(const Rider& rider, std::size_t k) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (rider.vertices[(k + i) % 3] != no_primitive) return rider.vertices[(k + i) % 3];
    }
    throw Error(ErrorCode::internal, "a triangle without area has no place on the surface");
  }

  mesh::Index cut_vertex_of(mesh::Index surface_vertex) {
    if (cut_vertex_.empty()) {
      cut_vertex_.assign(surface_.mesh.positions.size(), 0);
      for (std::uint32_t v = 0; v < cut_.vertices.size(); ++v) {
        if (cut_.vertices[v].point < cut_vertex_.size()) cut_vertex_[cut_.vertices[v].point] = v;
      }
    }
    return cut_vertex_[surface_vertex];
  }

  const Surface& surface_;
  const texture::CutMesh& cut_;
  Delivery& delivery_;
  std::map<mesh::Index, std::uint32_t> copies_; // input vertex -> output vertex of its primitive, or no_primitive
  std::vector<mesh::Index> cut_vertex_;         // of each vertex of the surface, the last; made when needed
  std::vector<ExtraVertex> extra_;
};

} // namespace

std::vector<ExtraVertex> add_riders(const Surface& surface, const texture::CutMesh& cut, Delivery& delivery) {
  if (surface.riders.empty()) return {};
  return RiderWriter(surface, cut, delivery).run();
}

} // namespace orbis
