#include "core/steps/morph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "core/lod/distance.h"
#include "core/remesh/fit.h"
#include "core/remesh/polyhedron.h"
#include "core/remesh/sphere_flow.h"
#include "core/remesh/sphere_tree.h"
#include "core/steps/embed.h"
#include "core/steps/interpolate.h"
#include "core/steps/tangent_frames.h"
#include "core/texture/alignment.h"

namespace orbis {
namespace {

using asset::Attribute;
using asset::vector_at;

// The second model's part of the work goes on behind the first one's.
class OnlyCancellation final : public Progress {
public:
  explicit OnlyCancellation(const Progress& whole) : whole_(whole) {}
  void report(Stage, std::uint64_t, std::uint64_t) override {}
  [[nodiscard]] bool cancelled() const override { return whole_.cancelled(); }

private:
  const Progress& whole_;
};

void check_is_one_sphere(const Surface& surface, const std::string& which) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::not_genus_zero,
                "the " + which + " model " + what +
                    "; a morph takes two models of one closed component of genus 0 each",
                "morph_to");
  };
  if (surface.components.size() != 1) refuse("has " + std::to_string(surface.components.size()) + " components");
  if (surface.components[0].has_caps()) refuse("has holes, handles or cracks");
  for (const std::uint32_t p : surface.primitive_of)
    if (p != surface.primitive_of[0]) refuse("has several primitives");
}

std::string stem_of(const std::string& file) {
  const std::string name = file.substr(file.rfind('/') + 1); // npos + 1 is 0
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

// The place on the sphere of the vertex nearest to a point in space.
Vec3d on_sphere(const Surface& surface, std::span<const Vec3d> points, const Vec3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  Vec3d out;
  for (std::size_t v = 0; v < points.size(); ++v) {
    const double d = squared_norm(Vec3d(surface.mesh.positions[v]) - p);
    if (d >= nearest) continue;
    nearest = d;
    out = points[v];
  }
  return out;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

double mean_degrees(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += degrees_between(a[i], b[i]);
  return a.empty() ? 0 : sum / static_cast<double>(a.size());
}

double most_degrees(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, degrees_between(a[i], b[i]));
  return most;
}

bool is_folded(std::span<const Vec3d> points, std::span<const mesh::Triangle> triangles) {
  return std::ranges::any_of(triangles, [&](const mesh::Triangle& t) {
    const Vec3d& p = points[t[0]];
    return !(dot(p, cross(points[t[1]] - p, points[t[2]] - p)) > 0);
  });
}

// Where the directions of the first model's sphere lie on the second one's.
class SphereMatch {
public:
  SphereMatch(const MorphEnd& end, const RemeshSource& source, Report& report)
      : features_(report.options.features), report_(report), pool_(report.options.threads) {
    for (const FeaturePair& pair : features_) {
      from_.push_back(on_sphere(source.surface, source.points, pair.from));
      to_.push_back(on_sphere(end.surface, end.points, pair.to));
    }
  }

  std::vector<Vec3d> run(const Surface& surface, std::span<const Vec3d> points) {
    std::vector<Vec3d> out(points.begin(), points.end());
    if (features_.empty()) return out;
    Report::Morph& facts = *report_.morph;
    facts.features = features_.size();
    facts.mean_angle_before = mean_degrees(from_, to_);
    turn(out);
    // A single pair leaves a turn about itself open, which best_rotation settles in some way: the flow alone is
    // gentler.
    const std::vector<Vec3d> flowed = remesh::carried(out, from_, to_, pool_);
    if (is_folded(flowed, surface.mesh.triangles)) {
      report_.notes.push_back({"morph-features-apart",
                               "the features were brought close by a rotation only: to make them meet, triangles would "
                               "have to fold",
                               "features"});
    } else {
      from_ = remesh::carried(from_, std::vector<Vec3d>(from_), to_, pool_);
      out = flowed;
    }
    facts.mean_angle = mean_degrees(from_, to_);
    facts.largest_angle = most_degrees(from_, to_);
    return out;
  }

private:
  // With fewer than three pairs the best rotation is not unique.
  void turn(std::vector<Vec3d>& points) {
    if (features_.size() < 3) return;
    const texture::Rotation r = texture::best_rotation(from_, to_, std::vector<double>(from_.size(), 1));
    for (Vec3d& p : points) p = r(p);
    for (Vec3d& p : from_) p = r(p);
  }

  const std::vector<FeaturePair>& features_;
  Report& report_;
  mesh::ThreadPool pool_;
  std::vector<Vec3d> from_, to_; // the features' directions on both spheres
};

// Where the vertices lie on the second model, near the directions given: put where they count, as on the first one.
std::vector<VertexSource> sources_on(const MorphEnd& end, remesh::SphereMesh sampling, mesh::ThreadPool& pool,
                                     Progress& progress) {
  const mesh::TriangleMesh& mesh = end.surface.mesh;
  const remesh::SphereTree tree(end.points, mesh.triangles);
  remesh::fit_to_surface(sampling, {end.points, mesh.positions, mesh.triangles}, tree, pool, progress);
  const std::vector<Vec3d>& directions = sampling.points;
  const std::uint32_t first = end.surface.first_vertex[end.surface.primitive_of[0]];
  std::vector<VertexSource> out(directions.size());
  pool.for_blocks(directions.size(), 1024, [&](std::size_t begin, std::size_t stop) {
    for (std::size_t v = begin; v < stop; ++v) {
      const remesh::Place place = tree.locate(directions[v]);
      const mesh::Triangle& c = end.surface.corners[place.triangle];
      out[v] = {{c[0] - first, c[1] - first, c[2] - first}, place.weights};
    }
  });
  return out;
}

const Attribute* find(std::span<const Attribute> attributes, std::string_view name) {
  const auto found = std::ranges::find(attributes, name, &Attribute::name);
  return found == attributes.end() ? nullptr : &*found;
}

// Differences from `before`, where the vertices of the surface are; zero at others.
Attribute differences(const Attribute& before, std::span<const Vec3d> after, std::span<const std::uint32_t> vertex_of) {
  Attribute out{before.name, asset::ComponentType::f32, false, 3, {}};
  out.data.resize(before.count() * sizeof(Vec3f));
  for (std::size_t v = 0; v < after.size(); ++v) {
    const Vec3d d = after[v] - vector_at(before, vertex_of[v]);
    out.set(vertex_of[v], 0, d.x);
    out.set(vertex_of[v], 1, d.y);
    out.set(vertex_of[v], 2, d.z);
  }
  return out;
}

double diagonal_of(std::span<const Vec3f> positions) {
  Vec3d low(positions[0]), high = low;
  for (const Vec3f& p : positions) {
    low = {std::min(low.x, double{p.x}), std::min(low.y, double{p.y}), std::min(low.z, double{p.z})};
    high = {std::max(high.x, double{p.x}), std::max(high.y, double{p.y}), std::max(high.z, double{p.z})};
  }
  return norm(high - low);
}

// Models in different units make a morph that grows by a hundred times: nothing is wrong with it, but it is hardly
// meant.
void note_sizes(const mesh::TriangleMesh& first, const mesh::TriangleMesh& second, Report& report) {
  constexpr double suspicious = 4;
  const double ratio = diagonal_of(second.positions) / diagonal_of(first.positions);
  if (ratio < suspicious && 1 / ratio < suspicious) return;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", ratio);
  report.notes.push_back(
      {"morph-sizes",
       "the second model is " + std::string(text.data()) + " times as large as the first: are both in the same units?",
       report.options.morph_to});
}

void measure(const MorphEnd& end, const mesh::TriangleMesh& shape, Report& report) {
  const auto positions_of = [](const mesh::TriangleMesh& mesh) {
    std::vector<Vec3d> out;
    for (const Vec3f& p : mesh.positions) out.emplace_back(p);
    return out;
  };
  const std::vector<Vec3d> full = positions_of(end.surface.mesh);
  mesh::ThreadPool pool(report.options.threads);
  const lod::Distances d =
      lod::distances_between(positions_of(shape), shape.triangles, full, end.surface.mesh.triangles, pool);
  const double diagonal = diagonal_of(end.surface.mesh.positions);
  report.morph->mean_distance = 100 * d.to_full / diagonal;
  report.morph->mean_distance_from_input = 100 * d.from_full / diagonal;
  report.morph->hausdorff_distance = 100 * d.hausdorff / diagonal;
}

} // namespace

std::optional<MorphEnd> read_morph_end(const Request& request, const Limits& limits, const Surface& first) {
  const std::string& file = request.options.morph_to;
  if (file.empty()) return std::nullopt;
  check_is_one_sphere(first, "first");
  MorphEnd end{stem_of(file), asset::read_asset(request.files.at(file), request.files, limits), {}, {}, {}};
  end.report.options = request.options;
  end.surface = make_surface(end.asset, end.report);
  check_is_one_sphere(end.surface, "second");
  return end;
}

void embed_morph_end(MorphEnd& end, Progress& progress, Report& report) {
  OnlyCancellation quiet(progress);
  NoCheckpoints none; // they are the first model's
  end.points = embed(end.surface, report.options, quiet, none, end.report);
  for (const asset::Asset::Note& note : end.asset.notes)
    report.notes.push_back({note.code, "the second model: " + note.message, note.where});
  for (const Note& note : end.report.notes)
    report.notes.push_back({note.code, "the second model: " + note.message, note.where});
  report.morph = Report::Morph{};
  report.morph->format = std::string(name_of(end.asset.format));
  report.morph->input_triangles = end.report.input_triangles;
}

RemeshTarget common_target(const Options& options, const Surface& first, const Surface& second) {
  if (options.remesh.base != RemeshTarget::Base::none) return options.remesh;
  RemeshTarget out{RemeshTarget::Base::icosahedral, 1};
  const std::size_t wanted = std::max(first.mesh.triangles.size(), second.mesh.triangles.size());
  while (out.times < most_remesh_times && remesh::triangles_of(out.base, out.times) < wanted) ++out.times;
  return out;
}

void add_morph_target(const MorphEnd& end, const RemeshSource& source, const Surface& surface,
                      std::span<const Vec3d> points, asset::Asset& asset, Progress& progress, Report& report) {
  note_sizes(surface.mesh, end.surface.mesh, report);
  mesh::ThreadPool pool(report.options.threads);
  std::vector<Vec3d> directions = SphereMatch(end, source, report).run(surface, points);
  const std::vector<VertexSource> sources =
      sources_on(end, {std::move(directions), surface.mesh.triangles}, pool, progress);
  const std::vector<Attribute> attributes =
      interpolate(end.asset.primitives[end.surface.primitive_of[0]].attributes, sources);
  const std::uint32_t p = surface.primitive_of[0];
  std::vector<std::uint32_t> vertex_of(points.size()); // vertex of the surface -> of the primitive
  for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      vertex_of[surface.mesh.triangles[t][k]] = surface.corners[t][k] - surface.first_vertex[p];

  mesh::TriangleMesh shape;
  shape.triangles = surface.mesh.triangles;
  std::vector<Vec3d> positions, normals;
  for (std::size_t v = 0; v < points.size(); ++v) {
    positions.push_back(vector_at(*find(attributes, "POSITION"), v));
    shape.positions.emplace_back(positions.back());
  }
  std::vector<Attribute> target{differences(*asset.primitives[p].find("POSITION"), positions, vertex_of)};
  if (const Attribute* before = asset.primitives[p].find("NORMAL")) {
    const Attribute* after = find(attributes, "NORMAL");
    if (after == nullptr) normals = smooth_normals(shape);
    for (std::size_t v = 0; after != nullptr && v < points.size(); ++v) normals.push_back(vector_at(*after, v));
    target.push_back(differences(*before, normals, vertex_of));
  }
  asset.primitives[p].targets.push_back(std::move(target));
  measure(end, shape, report);
}

void name_morph_target(const MorphEnd& end, Delivery& delivery) {
  for (asset::NewPrimitive& primitive : delivery.primitives)
    if (!primitive.indices.empty()) primitive.added_target = end.name;
}

} // namespace orbis
