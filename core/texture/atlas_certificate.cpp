#include "core/texture/atlas_certificate.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/mesh/groups.h"
#include "core/texture/page_raster.h"
#include "core/texture/settle.h"

namespace orbis::texture {
namespace {

// A chart's rectangle on the grid of the texture coordinates.
struct Frame {
  std::int32_t left, top, right, bottom;

  [[nodiscard]] bool holds(const UvPoint& p) const {
    return p[0] >= left && p[0] <= right && p[1] >= top && p[1] <= bottom;
  }
  [[nodiscard]] bool has_on_one_side(const UvPoint& a, const UvPoint& b) const {
    return (a[0] == b[0] && (a[0] == left || a[0] == right)) || (a[1] == b[1] && (a[1] == top || a[1] == bottom));
  }
  [[nodiscard]] std::int64_t doubled_area() const {
    return 2 * (std::int64_t{right} - left) * (std::int64_t{bottom} - top);
  }
};

Frame frame_of(const Chart& chart, const Page& page) {
  const auto on_grid = [](std::uint32_t texel, std::uint32_t size) {
    return static_cast<std::int32_t>(std::llround(std::ldexp(static_cast<double>(texel) / size, uv_bits)));
  };
  return {on_grid(chart.x, page.width), on_grid(chart.y, page.height), on_grid(chart.x + chart.width, page.width),
          on_grid(chart.y + chart.height, page.height)};
}

class Certifier {
public:
  explicit Certifier(const CutMesh& mesh)
      : mesh_(mesh), doubled_area_(mesh.charts.size(), 0), is_open_(mesh.charts.size(), false) {
    for (const Chart& chart : mesh.charts) frames_.push_back(frame_of(chart, mesh.pages[chart.page]));
  }

  AtlasCertificate run() {
    out_.triangles = mesh_.triangles.size();
    out_.charts = mesh_.charts.size();
    read_grid();
    check_triangles();
    check_rectangles();
    find_open_charts();
    check_areas();
    if (out_.open_charts > 0) check_texels();
    out_.valid = out_.failure().empty();
    return out_;
  }

private:
  const CutMesh& mesh_;
  AtlasCertificate out_;
  std::vector<Frame> frames_;
  std::vector<UvPoint> points_;
  std::vector<std::int64_t> doubled_area_; // by chart
  std::vector<bool> is_open_;

  void read_grid() {
    constexpr double one = 1 << uv_bits;
    for (const CutVertex& v : mesh_.vertices) {
      const double x = one * double{v.uv.x}, y = one * double{v.uv.y};
      // Written so that NaN is refused too.
      const bool sound = x >= 0 && x <= one && y >= 0 && y <= one && x == std::rint(x) && y == std::rint(y);
      out_.off_grid += sound ? 0 : 1;
      points_.push_back(sound ? UvPoint{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)} : UvPoint{});
    }
  }

  void check_triangles() {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const UvPoint &a = points_[mesh_.triangles[t][0]], &b = points_[mesh_.triangles[t][1]],
                    &c = points_[mesh_.triangles[t][2]];
      const Frame& frame = frames_[mesh_.chart[t]];
      out_.folded += orientation(a, b, c) == 1 ? 0 : 1;
      out_.outside += frame.holds(a) && frame.holds(b) && frame.holds(c) ? 0 : 1;
      doubled_area_[mesh_.chart[t]] += doubled_area(a, b, c);
    }
  }

  // From left to right, so that only neighbours are compared.
  void check_rectangles() {
    std::vector<const Chart*> charts;
    for (const Chart& chart : mesh_.charts) charts.push_back(&chart);
    std::sort(charts.begin(), charts.end(),
              [](const Chart* a, const Chart* b) { return std::tie(a->page, a->x) < std::tie(b->page, b->x); });
    const std::uint32_t gap = 2 * mesh_.gutter;
    for (std::size_t i = 0; i < charts.size(); ++i)
      for (std::size_t j = i + 1; j < charts.size(); ++j) {
        const Chart &a = *charts[i], &b = *charts[j];
        if (b.page != a.page || b.x >= a.x + a.width + gap) break;
        out_.too_close += b.y < a.y + a.height + gap && a.y < b.y + b.height + gap ? 1 : 0;
      }
  }

  // An edge that one triangle of its chart has alone lies on a side, or the chart is open.
  void find_open_charts() {
    struct Side {
      std::uint32_t chart, low, high;
      mesh::Index a, b;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const mesh::Index a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
        const auto [low, high] = std::minmax(mesh_.vertices[a].point, mesh_.vertices[b].point);
        sides.push_back({mesh_.chart[t], low, high, a, b});
      }
    const auto same = [](const Side& a, const Side& b) {
      return std::tie(a.chart, a.low, a.high) == std::tie(b.chart, b.low, b.high);
    };
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return std::tie(a.chart, a.low, a.high, a.a, a.b) < std::tie(b.chart, b.low, b.high, b.a, b.b);
    });
    for (std::size_t i = 0; i < sides.size();) {
      std::size_t j = i + 1;
      while (j < sides.size() && same(sides[i], sides[j])) ++j;
      // Two triangles meet in an edge where they see it at one place.
      const bool inner = j == i + 2 && meet(sides[i].a, sides[i].b, sides[i + 1].a, sides[i + 1].b);
      for (std::size_t k = i; !inner && k < j; ++k)
        if (!frames_[sides[k].chart].has_on_one_side(points_[sides[k].a], points_[sides[k].b]))
          is_open_[sides[k].chart] = true;
      i = j;
    }
    for (const bool open : is_open_) ++(open ? out_.open_charts : out_.closed_charts);
  }

  [[nodiscard]] bool meet(mesh::Index a, mesh::Index b, mesh::Index c, mesh::Index d) const {
    return points_[a] == points_[d] && points_[b] == points_[c];
  }

  void check_areas() {
    for (std::size_t c = 0; c < frames_.size(); ++c)
      out_.not_filled += !is_open_[c] && doubled_area_[c] != frames_[c].doubled_area() ? 1 : 0;
  }

  // In a valid atlas no texel's centre lies in two triangles.
  void check_texels() {
    const mesh::Groups triangles(mesh_.triangles.size(), mesh_.pages.size(),
                                 [this](std::uint32_t t) { return mesh_.page_of(t); });
    for (std::size_t page = 0; page < mesh_.pages.size(); ++page) {
      const Page& size = mesh_.pages[page];
      std::vector<bool> taken(std::size_t{size.width} * size.height, false);
      const auto take = [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>&) {
        const std::size_t i = std::size_t{y} * size.width + x;
        out_.shared_texels += taken[i] ? 1 : 0;
        taken[i] = true;
      };
      for (const std::uint32_t t : triangles[page]) rasterize(in_page(mesh_, t), size.width, size.height, take);
    }
  }
};

} // namespace

AtlasCertificate certify_atlas(const CutMesh& mesh) { return Certifier(mesh).run(); }

std::string AtlasCertificate::failure() const {
  if (off_grid > 0) return std::to_string(off_grid) + " texture coordinates are not multiples of 2^-24 in [0, 1]";
  if (folded > 0) return std::to_string(folded) + " triangles are folded over in the atlas";
  if (outside > 0) return std::to_string(outside) + " triangles leave their chart";
  if (too_close > 0) return std::to_string(too_close) + " pairs of charts are closer than their gutters";
  if (not_filled > 0) return std::to_string(not_filled) + " charts are not filled exactly once";
  if (shared_texels > 0) return std::to_string(shared_texels) + " texels show two places of the surface";
  return {};
}

} // namespace orbis::texture
