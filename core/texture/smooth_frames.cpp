#include "core/texture/smooth_frames.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace orbis::texture {
namespace {

// Along each side of a chart. More follow the surface more closely, so that fewer texels of the map lean below the
// horizon of their frame; fewer are followed more closely by coarse levels (docs/baking.md).
constexpr std::uint32_t most_cells = 4;
constexpr std::uint32_t samples_a_side = 96; // of a chart
constexpr double least_length = 0.1;         // of a mean of unit vectors that still counts as a direction

// The four basis functions that are not 0 in a cell, at the part t of it.
std::array<double, 4> basis(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
}

// Where a place in [0, 1] of a chart's side lies among `cells`.
struct Along {
  std::uint32_t cell = 0;
  std::array<double, 4> weights{};

  Along(double part, std::uint32_t cells) {
    const double x = std::clamp(part, 0.0, 1.0) * cells;
    cell = std::min(static_cast<std::uint32_t>(x), cells - 1);
    weights = basis(x - cell);
  }
};

// visit(control point, weight) for the sixteen that matter at (x, y), in parts of the chart's sides.
template <class Visit> void for_control_points(double x, double y, std::uint32_t cells, Visit visit) {
  const Along across(x, cells), down(y, cells);
  for (std::uint32_t j = 0; j < 4; ++j) {
    for (std::uint32_t i = 0; i < 4; ++i)
      visit(std::size_t{down.cell + j} * (cells + 3) + across.cell + i, across.weights[i] * down.weights[j]);
  }
}

Vec3d value(const std::vector<Vec3d>& controls, std::uint32_t cells, double x, double y) {
  if (cells == 0) return controls.front();
  Vec3d sum;
  for_control_points(x, y, cells, [&](std::size_t c, double w) { sum += controls[c] * w; });
  return sum;
}

Vec3d perpendicular_part(const Vec3d& v, const Vec3d& normal) {
  return v - normal * (dot(v, normal) / dot(normal, normal));
}

} // namespace

// The surface's frame at a texel.
struct SmoothFrames::Sample {
  double x = 0, y = 0; // in parts of the chart's sides
  Vec3d normal, tangent;
  double handedness = 1;
};

SmoothFrames::SmoothFrames(const CutMesh& cut, std::span<const std::uint32_t> charts, const FrameField& field)
    : cut_(cut), charts_(charts), splines_(charts.size()) {
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const std::vector<Sample> samples = samples_of(cut.charts[charts[i]], field);
    std::uint32_t cells = most_cells;
    do {
      splines_[i] = fitted(samples, cells);
      cells /= 2;
    } while (splines_[i].cells > 0 && !is_regular(splines_[i]));
  }
}

VertexFrame SmoothFrames::at(std::uint32_t chart, const Vec2f& uv) const {
  const Chart& c = cut_.charts[chart];
  const Page& page = cut_.pages[c.page];
  const double x = (double{uv.x} * page.width - c.x) / c.width, y = (double{uv.y} * page.height - c.y) / c.height;
  const auto number = std::ranges::lower_bound(charts_, chart) - charts_.begin();
  const Spline& spline = splines_[static_cast<std::size_t>(number)];
  const Vec3d n = normalized(value(spline.normals, spline.cells, x, y));
  const Vec3d t = normalized(perpendicular_part(value(spline.tangents, spline.cells, x, y), n));
  return {Vec3f(n),
          {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z),
           static_cast<float>(spline.handedness)}};
}

std::vector<SmoothFrames::Sample> SmoothFrames::samples_of(const Chart& chart, const FrameField& field) {
  std::vector<Sample> out;
  const std::uint32_t across = std::min(chart.width, samples_a_side), down = std::min(chart.height, samples_a_side);
  for (std::uint32_t j = 0; j < down; ++j) {
    for (std::uint32_t i = 0; i < across; ++i) {
      const std::uint32_t x = chart.x + (2 * i + 1) * chart.width / (2 * across);
      const std::uint32_t y = chart.y + (2 * j + 1) * chart.height / (2 * down);
      if (!field.map->covered(x, y)) continue;
      const std::uint32_t t = field.map->triangle(x, y);
      const std::array<double, 3> w = field.map->place(t).weights(x + 0.5, y + 0.5);
      Sample sample{(x + 0.5 - chart.x) / chart.width, (y + 0.5 - chart.y) / chart.height, {}, {}, 1};
      for (std::size_t k = 0; k < 3; ++k) {
        const mesh::Index v = field.triangles[t][k];
        const Tangent& tangent = field.tangents[v];
        sample.normal += Vec3d(field.normals[v]) * w[k];
        sample.tangent += Vec3d{double{tangent.x}, double{tangent.y}, double{tangent.z}} * w[k];
        sample.handedness = double{tangent.w};
      }
      out.push_back(sample);
    }
  }
  return out;
}

// cells: 0 for the mean, or where there is none any direction.
SmoothFrames::Spline SmoothFrames::fitted(const std::vector<Sample>& samples, std::uint32_t cells) {
  Spline out;
  Vec3d normal, tangent;
  for (const Sample& s : samples) {
    normal += s.normal;
    tangent += s.tangent;
    out.handedness = s.handedness;
  }
  if (!(norm(normal) > 0)) normal = {0, 0, 1};
  if (!(norm(perpendicular_part(tangent, normal)) > 0))
    tangent = perpendicular_part(std::abs(normal.x) < std::abs(normal.y) ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}, normal);
  out.cells = cells;
  if (cells == 0) {
    out.normals = {normal};
    out.tangents = {tangent};
    return out;
  }
  const std::size_t controls = std::size_t{cells + 3} * (cells + 3);
  std::vector<double> weights(controls);
  out.normals.resize(controls);
  out.tangents.resize(controls);
  for (const Sample& s : samples) {
    for_control_points(s.x, s.y, cells, [&](std::size_t c, double w) {
      weights[c] += w;
      out.normals[c] += s.normal * w;
      out.tangents[c] += s.tangent * w;
    });
  }
  const double share = samples.empty() ? 0 : 1 / static_cast<double>(samples.size());
  for (std::size_t c = 0; c < controls; ++c) {
    out.normals[c] = weights[c] > 0 ? out.normals[c] * (1 / weights[c]) : normal * share;
    out.tangents[c] = weights[c] > 0 ? out.tangents[c] * (1 / weights[c]) : tangent * share;
  }
  return out;
}

// Whether normals and tangents have a direction everywhere.
bool SmoothFrames::is_regular(const Spline& spline) {
  const std::uint32_t steps = 4 * spline.cells;
  for (std::uint32_t j = 0; j <= steps; ++j) {
    for (std::uint32_t i = 0; i <= steps; ++i) {
      const double x = static_cast<double>(i) / steps, y = static_cast<double>(j) / steps;
      const Vec3d n = value(spline.normals, spline.cells, x, y), t = value(spline.tangents, spline.cells, x, y);
      if (norm(n) < least_length || norm(perpendicular_part(t, n)) < least_length) return false;
    }
  }
  return true;
}

} // namespace orbis::texture
