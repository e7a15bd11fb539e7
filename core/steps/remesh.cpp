#include "core/steps/remesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/lod/distance.h"
#include "core/remesh/fit.h"
#include "core/remesh/overlay.h"
#include "core/remesh/polyhedron.h"
#include "core/remesh/sphere_tree.h"
#include "core/steps/interpolate.h"
#include "core/steps/remesh_plan.h"

namespace orbis {
namespace {

constexpr std::size_t samples_a_block = 1024;

// A component on its way: the polyhedron, and where its vertices lie on the component.
struct Remade {
  remesh::SphereMesh sphere;
  std::vector<remesh::Place> places; // triangles of the component
};

// Takes a surface apart and puts the new one together.
class Remesher {
public:
  Remesher(const RemeshSource& from, const RemeshTarget& target, Report& report)
      : from_(from), target_(target), report_(report), pool_(report.options.threads) {}

  void choose(const Limits& limits) {
    RemeshPlan plan = plan_remesh(from_.surface, target_, limits);
    times_ = std::move(plan.times);
    report_.notes.insert(report_.notes.end(), plan.kept.begin(), plan.kept.end());
  }

  void sample(Progress& progress) {
    remade_.resize(times_.size());
    for (std::size_t i = 0; i < times_.size(); ++i) {
      progress.check();
      if (times_[i] > 0) sample(i, progress);
    }
  }

  // The new asset. Vertices of a primitive that are still needed stay in front.
  asset::Asset make_asset() {
    find_needed_primitives();
    asset::Asset out = from_.asset;
    new_first_.clear();
    std::uint32_t first = 0;
    for (std::uint32_t p = 0; p < out.primitives.size(); ++p) {
      const asset::Primitive& old = from_.asset.primitives[p];
      asset::Primitive& primitive = out.primitives[p];
      const std::vector<VertexSource> sources = sources_of(p);
      new_first_.push_back(first);
      first += static_cast<std::uint32_t>(sources.size());
      primitive.attributes = interpolate(old.attributes, sources);
      for (std::size_t i = 0; i < old.targets.size(); ++i)
        primitive.targets[i] = interpolate_target(old.targets[i], sources);
    }
    return out;
  }

  Surface make_surface(const asset::Asset& asset, std::vector<Vec3d>& points) {
    points.clear();
    out_ = {};
    out_.first_vertex = new_first_;
    triangle_.assign(from_.surface.mesh.triangles.size(), no_primitive);
    vertex_.assign(from_.surface.mesh.positions.size(), no_primitive);
    std::vector<std::uint32_t> next = kept_vertices_; // primitive -> its next new vertex
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (times_[i] > 0) {
        add_remade(i, asset, next, points);
      } else {
        add_kept(from_.surface.components[i], points);
      }
    }
    add_riders();
    return std::move(out_);
  }

  void measure(const Surface& surface) {
    Report::Remesh facts;
    std::vector<mesh::Triangle> before, after;
    for (std::size_t i = 0; i < times_.size(); ++i) {
      if (times_[i] == 0) {
        ++facts.kept_components;
        continue;
      }
      ++facts.components;
      const Component &from = from_.surface.components[i], &to = surface.components[i];
      facts.triangles += to.triangles;
      facts.vertices += to.vertices;
      ComponentReport& component = report_.components[to.number];
      component.remesh_triangles = to.triangles;
      component.remesh_vertices = to.vertices;
      const auto append = [](const Surface& s, const Component& c, std::vector<mesh::Triangle>& list) {
        list.insert(list.end(), s.mesh.triangles.begin() + c.first_triangle,
                    s.mesh.triangles.begin() + c.end_triangle());
      };
      append(from_.surface, from, before);
      append(surface, to, after);
    }
    const auto [full, diagonal] = used_positions(from_.surface, before);
    const auto [remade, ignored] = used_positions(surface, after);
    const lod::Distances d = lod::distances_between(remade, after, full, before, pool_);
    facts.mean_distance = 100 * d.to_full / diagonal;
    facts.mean_distance_from_input = 100 * d.from_full / diagonal;
    facts.hausdorff_distance = 100 * d.hausdorff / diagonal;
    report_.remesh = facts;
  }

private:
  void sample(std::size_t i, Progress& progress) {
    const Component& c = from_.surface.components[i];
    const mesh::TriangleMesh mesh = mesh_of(from_.surface, c);
    const auto points = std::span(from_.points).subspan(c.first_vertex, c.vertices);
    const remesh::SphereTree tree(points, mesh.triangles);
    Remade& out = remade_[i];
    out.sphere = remesh::subdivided(target_.base, times_[i]);
    remesh::fit_to_surface(out.sphere, {points, mesh.positions, mesh.triangles}, tree, pool_, progress);
    out.places.resize(out.sphere.points.size());
    pool_.for_blocks(out.places.size(), samples_a_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) out.places[v] = tree.locate(out.sphere.points[v]);
    });
  }

  [[nodiscard]] std::uint32_t primitive_of(std::size_t component) const {
    return from_.surface.primitive_of[from_.surface.components[component].first_triangle];
  }

  // Primitives whose own vertices are still needed: by components that stay, and by riders.
  void find_needed_primitives() {
    kept_vertices_.assign(from_.asset.primitives.size(), 0);
    const auto keep = [&](std::uint32_t p) {
      kept_vertices_[p] = static_cast<std::uint32_t>(from_.asset.primitives[p].vertex_count());
    };
    for (std::size_t i = 0; i < times_.size(); ++i) {
      const Component& c = from_.surface.components[i];
      for (std::uint32_t t = c.first_triangle; times_[i] == 0 && t < c.end_triangle(); ++t)
        if (!from_.surface.is_cap(t)) keep(from_.surface.primitive_of[t]);
    }
    for (const Rider& rider : from_.surface.riders) keep(rider.primitive);
  }

  [[nodiscard]] std::vector<VertexSource> sources_of(std::uint32_t p) const {
    std::vector<VertexSource> sources;
    for (std::uint32_t v = 0; v < kept_vertices_[p]; ++v) sources.push_back({{v, v, v}, {1, 0, 0}});
    const std::uint32_t first = from_.surface.first_vertex[p];
    for (std::size_t i = 0; i < remade_.size(); ++i) {
      if (times_[i] == 0 || primitive_of(i) != p) continue;
      for (const remesh::Place& place : remade_[i].places) {
        const mesh::Triangle& corners =
            from_.surface.corners[from_.surface.components[i].first_triangle + place.triangle];
        sources.push_back({{corners[0] - first, corners[1] - first, corners[2] - first}, place.weights});
      }
    }
    return sources;
  }

  Component& begin_component(const Component& old) {
    Component c;
    c.first_vertex = static_cast<std::uint32_t>(out_.mesh.positions.size());
    c.first_triangle = static_cast<std::uint32_t>(out_.mesh.triangles.size());
    c.mesh = old.mesh;
    c.number = old.number;
    return out_.components.emplace_back(c);
  }

  void add_remade(std::size_t i, const asset::Asset& asset, std::vector<std::uint32_t>& next,
                  std::vector<Vec3d>& points) {
    const Remade& remade = remade_[i];
    const std::uint32_t p = primitive_of(i), first = next[p];
    Component& c = begin_component(from_.surface.components[i]);
    c.vertices = c.input_vertices = static_cast<std::uint32_t>(remade.sphere.points.size());
    c.triangles = c.input_triangles = static_cast<std::uint32_t>(remade.sphere.triangles.size());
    next[p] += c.vertices;
    const asset::Attribute& position = *asset.primitives[p].find("POSITION");
    for (std::uint32_t v = first; v < first + c.vertices; ++v) {
      out_.mesh.positions.emplace_back(static_cast<float>(position.get(v, 0)), static_cast<float>(position.get(v, 1)),
                                       static_cast<float>(position.get(v, 2)));
    }
    points.insert(points.end(), remade.sphere.points.begin(), remade.sphere.points.end());
    const std::uint32_t in_row = new_first_[p] + first;
    for (const auto& [a, b, d] : remade.sphere.triangles) {
      out_.mesh.triangles.push_back({c.first_vertex + a, c.first_vertex + b, c.first_vertex + d});
      out_.corners.push_back({in_row + a, in_row + b, in_row + d});
      out_.primitive_of.push_back(p);
    }
  }

  [[nodiscard]] mesh::Triangle in_new_row(const mesh::Triangle& corners, std::uint32_t p) const {
    if (p == no_primitive) return corners;
    mesh::Triangle out{};
    for (std::size_t k = 0; k < 3; ++k) out[k] = corners[k] - from_.surface.first_vertex[p] + new_first_[p];
    return out;
  }

  void add_kept(const Component& old, std::vector<Vec3d>& points) {
    Component& c = begin_component(old);
    c.vertices = old.vertices;
    c.input_vertices = old.input_vertices;
    c.triangles = old.triangles;
    c.input_triangles = old.input_triangles;
    for (std::uint32_t v = old.first_vertex; v < old.end_vertex(); ++v) {
      vertex_[v] = static_cast<std::uint32_t>(out_.mesh.positions.size());
      out_.mesh.positions.push_back(from_.surface.mesh.positions[v]);
      points.push_back(from_.points[v]);
    }
    for (std::uint32_t t = old.first_triangle; t < old.end_triangle(); ++t) {
      triangle_[t] = static_cast<std::uint32_t>(out_.mesh.triangles.size());
      const auto& [a, b, d] = from_.surface.mesh.triangles[t];
      out_.mesh.triangles.push_back({vertex_[a], vertex_[b], vertex_[d]});
      out_.corners.push_back(in_new_row(from_.surface.corners[t], from_.surface.primitive_of[t]));
      out_.primitive_of.push_back(from_.surface.primitive_of[t]);
    }
  }

  void add_riders() {
    std::uint64_t gone = 0;
    for (const Rider& old : from_.surface.riders) {
      Rider rider{old.primitive, in_new_row(old.corners, old.primitive)};
      bool stays = old.twin == no_primitive || triangle_[old.twin] != no_primitive;
      if (stays && old.twin != no_primitive) rider.twin = triangle_[old.twin];
      for (std::size_t k = 0; k < 3; ++k) {
        if (old.vertices[k] == no_primitive) continue;
        rider.vertices[k] = vertex_[old.vertices[k]];
        stays = stays && rider.vertices[k] != no_primitive;
      }
      if (stays) {
        out_.riders.push_back(rider);
      } else {
        ++gone;
      }
    }
    if (gone == 0) return;
    report_.notes.push_back({"remesh-dropped",
                             std::to_string(gone) + " triangles are gone that had no area or lay on others of a "
                                                    "component that was remeshed",
                             ""});
  }

  // The surface's vertices without those of no listed triangle, and the diagonal of their box; the triangles are
  // renumbered.
  static std::pair<std::vector<Vec3d>, double> used_positions(const Surface& surface,
                                                              std::vector<mesh::Triangle>& triangles) {
    std::vector<std::uint32_t> number(surface.mesh.positions.size(), no_primitive);
    std::vector<Vec3d> out;
    Vec3d low, high;
    for (mesh::Triangle& triangle : triangles) {
      for (mesh::Index& v : triangle) {
        if (number[v] == no_primitive) {
          number[v] = static_cast<std::uint32_t>(out.size());
          const Vec3d p(surface.mesh.positions[v]);
          low = out.empty() ? p : Vec3d{std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
          high = out.empty() ? p : Vec3d{std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
          out.push_back(p);
        }
        v = number[v];
      }
    }
    return {std::move(out), norm(high - low)};
  }

  const RemeshSource& from_;
  RemeshTarget target_;
  Report& report_;
  mesh::ThreadPool pool_;
  std::vector<std::uint32_t> times_;                     // by component; 0: it stays as it is
  std::vector<Remade> remade_;                           // by component
  std::vector<std::uint32_t> kept_vertices_, new_first_; // by primitive
  std::vector<std::uint32_t> triangle_, vertex_;         // of the old surface -> of the new one
  Surface out_;
};

// The asset's triangles are those of its surface now.
void set_indices(const Surface& surface, asset::Asset& asset) {
  for (asset::Primitive& p : asset.primitives) p.indices.clear();
  const auto add = [&](std::uint32_t p, const mesh::Triangle& corners) {
    for (const mesh::Index corner : corners) asset.primitives[p].indices.push_back(corner - surface.first_vertex[p]);
  };
  for (std::size_t t = 0; t < surface.corners.size(); ++t)
    if (!surface.is_cap(t)) add(surface.primitive_of[t], surface.corners[t]);
  for (const Rider& rider : surface.riders) add(rider.primitive, rider.corners);
}

// Coordinates of the input's own textures jump at its seams; the new triangles know nothing of those.
void note_texture_coordinates(const asset::Asset& asset, Report& report) {
  for (const asset::Primitive& p : asset.primitives) {
    if (p.find("TEXCOORD_0") == nullptr) continue;
    report.notes.push_back({"remesh-texture-coordinates",
                            "the input's texture coordinates are kept vertex by vertex, and smear where triangles "
                            "cross their seams; what is baked into the atlas does not use them",
                            ""});
    return;
  }
}

} // namespace

std::optional<RemeshSource> resample(asset::Asset& asset, Surface& surface, std::vector<Vec3d>& points,
                                     const RemeshTarget& target, const Limits& limits, Progress& progress,
                                     Report& report) {
  if (target.base == RemeshTarget::Base::none) return std::nullopt;
  RemeshSource from{std::move(asset), std::move(surface), std::move(points)};
  Remesher remesher(from, target, report);
  remesher.choose(limits);
  remesher.sample(progress);
  asset = remesher.make_asset();
  surface = remesher.make_surface(asset, points);
  set_indices(surface, asset);
  remesher.measure(surface);
  note_texture_coordinates(from.asset, report);
  return from;
}

texture::CutMesh source_in_atlas(const RemeshSource& source, const Surface& surface, std::span<const Vec3d> points,
                                 const texture::CutMesh& cut, std::uint32_t threads) {
  mesh::ThreadPool pool(threads);
  std::vector<Vec3d> directions;
  directions.reserve(cut.vertices.size());
  for (const texture::CutVertex& v : cut.vertices)
    directions.push_back(normalized(texture::interpolated(points, surface.mesh.triangles, v)));
  std::map<std::uint32_t, const Component*> by_number;
  for (const Component& c : source.surface.components) by_number[c.number] = &c;

  std::vector<std::vector<mesh::Triangle>> triangles; // by component, numbered from 0
  std::vector<remesh::OverlayPair> pairs;
  std::uint32_t piece = 0;
  for (const Component& c : surface.components) {
    const Component& from = *by_number.at(c.number);
    triangles.push_back(mesh_of(source.surface, from).triangles);
    remesh::OverlayPair& pair = pairs.emplace_back();
    pair.source_points = std::span(source.points).subspan(from.first_vertex, from.vertices);
    pair.first_source_triangle = from.first_triangle;
    pair.first_piece = piece;
    while (piece < cut.triangles.size() && cut.parent[piece] < c.end_triangle()) ++piece;
    pair.end_piece = piece;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].source_triangles = triangles[i];
  return remesh::overlay(cut, directions, pairs, pool);
}

} // namespace orbis
