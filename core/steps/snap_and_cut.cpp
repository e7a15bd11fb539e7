#include "core/steps/snap_and_cut.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "core/mesh/disjoint_sets.h"
#include "core/sphere/snap.h"
#include "core/steps/leave_out.h"
#include "core/texture/flat_charts.h"
#include "core/texture/place.h"
#include "core/texture/quality.h"

namespace orbis {
namespace {

constexpr int most_turns = 16, tries_a_turn = 2;
// Radians. The first turn moves a border by about a hundred texels of a usual atlas, the last to another side of the
// sphere: what is crowded into one place, or drawn out into needles, gets away from the borders.
constexpr double first_turn = 0.02;

double angle_of(int turns) { return first_turn * turns * turns; }

// Rodrigues' rotation about an axis that is in no special position to the cube.
Vec3d turned(const Vec3d& p, double angle) {
  const Vec3d axis = normalized(Vec3d{0.35, 0.57, 0.74});
  const double c = std::cos(angle), s = std::sin(angle);
  return c * p + s * cross(axis, p) + (1 - c) * dot(axis, p) * axis;
}

// Which page each component's charts go to. Per material: components that share one, directly or through others, share
// a page, since a component's charts do and a material has one image.
std::vector<std::uint32_t> pages_of(const asset::Asset& asset, const Surface& surface, AtlasPages wanted) {
  std::vector<std::uint32_t> page(surface.components.size(), 0);
  if (wanted == AtlasPages::single) return page;
  const auto components = static_cast<std::uint32_t>(page.size());
  std::uint32_t materials = 1; // the first stands for "none"
  for (const asset::Primitive& p : asset.primitives) materials = std::max(materials, p.material.value_or(0) + 2);
  mesh::DisjointSets sets(std::size_t{components} + materials);
  for (std::uint32_t i = 0; i < components; ++i) {
    const Component& c = surface.components[i];
    for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.input_triangles; ++t) {
      const auto material = asset.primitives[surface.primitive_of[t]].material;
      sets.unite(i, components + (material ? *material + 1 : 0));
    }
  }
  std::vector<std::uint32_t> number(components + materials, no_primitive);
  std::uint32_t pages = 0;
  for (std::uint32_t i = 0; i < components; ++i) {
    std::uint32_t& known = number[sets.find(i)];
    if (known == no_primitive) known = pages++;
    page[i] = known;
  }
  return page;
}

// One component on its way to the atlas.
class ComponentCharts {
public:
  ComponentCharts(const Surface& surface, const Component& c, std::span<const Vec3d> points, std::uint32_t page)
      : component_(c), mesh_(mesh_of(surface, c)), points_(points),
        corners_(std::span(surface.corners).subspan(c.first_triangle, c.input_triangles)), page_(page) {}

  // Snaps the sphere to the grid and lays the charts flat; again, with the sphere turned a little further, each time it
  // is called. Throws Error{not_certified} if no turn helps.
  void next(Progress& progress, mesh::ThreadPool& pool) {
    for (;;) {
      if (++tries_ >= tries_a_turn * most_turns)
        throw Error(ErrorCode::not_certified, "the map could not be delivered without a fold: " + failure_);
      try {
        attempt(progress, pool);
        // What may still go wrong with it.
        failure_ = "a triangle is too small for the numbers of the atlas";
        return;
      } catch (const Error& e) {
        if (e.code() != ErrorCode::not_certified) throw;
        failure_ = e.message();
      }
    }
  }

  [[nodiscard]] texture::AtlasComponent atlas_component() const {
    return {mesh_.triangles,
            corners_,
            sphere_,
            mesh_.positions,
            component_.input_triangles,
            component_.first_vertex,
            component_.first_triangle,
            page_,
            tries_ % tries_a_turn == 0 ? texture::Finish::newton : texture::Finish::sweeps};
  }
  [[nodiscard]] const texture::FlatCharts& charts() const { return charts_; }
  [[nodiscard]] const std::vector<sphere::GridPoint>& sphere() const { return sphere_; }
  [[nodiscard]] int turns() const { return tries_ / tries_a_turn; }
  [[nodiscard]] const Component& component() const { return component_; }

private:
  const Component& component_;
  mesh::TriangleMesh mesh_;
  std::span<const Vec3d> points_;
  std::span<const mesh::Triangle> corners_;
  std::uint32_t page_;
  int tries_ = -1; // the first of each turn with the best charts, the second with those that are easier to round
  std::string failure_;
  std::vector<sphere::GridPoint> sphere_;
  texture::FlatCharts charts_;

  void attempt(Progress& progress, mesh::ThreadPool& pool) {
    std::vector<Vec3d> rotated(points_.begin(), points_.end());
    const double angle = angle_of(turns());
    for (std::size_t v = 0; turns() > 0 && v < rotated.size(); ++v) rotated[v] = turned(points_[v], angle);
    sphere::Snapped snapped = sphere::snap(rotated, mesh_.triangles);
    if (snapped.folded > 0)
      throw Error(ErrorCode::not_certified,
                  std::to_string(snapped.folded) + " triangles are too small for the numbers of the result");
    sphere_ = std::move(snapped.points);
    // What did not do at first may be the chart without a cut, which no turn changes.
    const auto kinds = turns() == 0 ? texture::ChartKinds::all : texture::ChartKinds::faces;
    charts_ = texture::lay_flat(atlas_component(), kinds, progress, pool);
  }
};

void describe(const Surface& surface, const texture::CutMesh& cut, Report& report) {
  for (const texture::Page& page : cut.pages) report.atlas.pages.push_back({page.width, page.height});
  report.atlas.gutter = cut.gutter;
  report.atlas.utilisation = texture::utilisation(cut);
  report.atlas.quality = texture::measure_atlas(cut, surface.mesh);
  report.atlas.charts = cut.charts.size();
  report.atlas.cut_triangles = cut.cut_triangles;
  report.atlas.added_vertices = cut.points - surface.mesh.positions.size();
}

Note problem_of(const Component& c, const Error& e) {
  return {"not-deliverable", e.message(), "/meshes/" + std::to_string(c.mesh)};
}

class Atlas {
public:
  Atlas(const asset::Asset& asset, const Surface& surface, std::span<const Vec3d> points, const Options& options)
      : surface_(surface), size_{.width = options.texture_size, .texel_density = options.texel_density},
        pool_(options.threads) {
    const std::vector<std::uint32_t> pages = pages_of(asset, surface, options.atlas);
    components_.reserve(surface.components.size());
    for (std::size_t i = 0; i < surface.components.size(); ++i) {
      const Component& c = surface.components[i];
      components_.emplace_back(surface, c, points.subspan(c.first_vertex, c.vertices), pages[i]);
    }
  }

  // The components that no turn helps; where there are none, cut() is complete.
  Problems make(Progress& progress) {
    std::vector<std::uint32_t> all(components_.size());
    std::iota(all.begin(), all.end(), 0U);
    Problems problems = next(all, progress);
    while (problems.empty()) {
      std::vector<texture::AtlasComponent> inputs;
      std::vector<texture::FlatCharts> charts;
      for (const ComponentCharts& c : components_) {
        inputs.push_back(c.atlas_component());
        charts.push_back(c.charts());
      }
      placed_ = texture::place(inputs, charts, size_);
      if (placed_.folded.empty()) break;
      NoProgress quiet;
      problems = next(placed_.folded, quiet);
    }
    return problems;
  }

  CutSphere take(Report& report) {
    CutSphere out{{}, std::move(placed_.mesh)};
    for (const ComponentCharts& c : components_)
      out.points.insert(out.points.end(), c.sphere().begin(), c.sphere().end());
    note_turns(report);
    describe(surface_, out.cut, report);
    note_density(report);
    return out;
  }

private:
  void note_density(Report& report) const {
    constexpr double much = 1.25;
    const double asked = size_.texel_density;
    if (asked <= 0) return;
    const auto note = [&](const char* code, double density, const std::string& why) {
      report.notes.push_back({code,
                              "the atlas has " + std::to_string(density) + " texels per unit of length, not " +
                                  std::to_string(asked) + ": " + why,
                              "texel_density"});
    };
    if (const double density = std::sqrt(report.atlas.quality.texels_per_area); density > much * asked)
      note("texel-density-raised", density, "no chart can be smaller");
    if (placed_.texel_density < asked)
      note("texel-density-lowered", placed_.texel_density,
           "a page of " + std::to_string(texture::widest_page) + " texels holds no more");
  }

  // One note a mesh, which may have thousands of components.
  void note_turns(Report& report) const {
    std::map<std::uint32_t, std::pair<std::size_t, double>> turned; // mesh -> components, largest angle
    for (const ComponentCharts& c : components_) {
      if (c.turns() == 0) continue;
      auto& [count, most] = turned[c.component().mesh];
      ++count;
      most = std::max(most, angle_of(c.turns()));
    }
    for (const auto& [mesh, what] : turned) {
      std::string message = what.first == 1 ? "the sphere was turned by " : "";
      if (what.first > 1) message += std::to_string(what.first) + " components' spheres were turned by up to ";
      message += std::to_string(what.second) + " radians to keep every triangle resolvable";
      report.notes.push_back({"turned-sphere", message, "/meshes/" + std::to_string(mesh)});
    }
  }

  // Lays components flat, or turns them further where they are flat already.
  Problems next(std::span<const std::uint32_t> which, Progress& progress) {
    Problems problems;
    NoProgress quiet;
    for (std::size_t i = 0; i < which.size(); ++i) {
      progress.check();
      progress.report(Stage::atlas, i, which.size());
      try {
        components_[which[i]].next(quiet, pool_);
      } catch (const Error& e) {
        if (e.code() != ErrorCode::not_certified) throw;
        problems.emplace(which[i], problem_of(components_[which[i]].component(), e));
      }
    }
    return problems;
  }

  const Surface& surface_;
  texture::AtlasSize size_;
  mesh::ThreadPool pool_;
  std::vector<ComponentCharts> components_;
  texture::Placed placed_;
};

} // namespace

CutSphere snap_and_cut(const asset::Asset& asset, Surface& surface, std::vector<Vec3d>& points, const Options& options,
                       Progress& progress, Report& report) {
  NoProgress quiet;
  for (bool first = true;; first = false) {
    progress.check();
    Atlas atlas(asset, surface, points, options);
    const Problems problems = atlas.make(first ? progress : quiet);
    if (problems.empty()) {
      progress.report(Stage::atlas, surface.components.size(), surface.components.size());
      return atlas.take(report);
    }
    leave_out(problems, surface, points, report);
  }
}

} // namespace orbis
