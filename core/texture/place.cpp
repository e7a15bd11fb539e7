#include "core/texture/place.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/texture/settle.h"
#include "core/texture/skyline.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t smallest_page = 64, smallest_chart = 2;
constexpr std::uint32_t least_gutter = 2;
constexpr double most_for_gutters = 0.1; // of all pages
constexpr int bisections = 12;
constexpr std::size_t many_charts = 60; // of one page: they fill one shape as well as another

std::uint32_t multiple_of_4(double texels) { return static_cast<std::uint32_t>(std::ceil(texels / 4)) * 4; }

// The charts that share a page, with their places at some density.
class PagePacker {
public:
  // chart: its number in the whole atlas.
  void add(std::uint32_t chart, const FlatCharts::Size& size) {
    charts_.push_back(chart);
    sizes_.push_back(size);
    area_ += size.width * size.height;
  }

  [[nodiscard]] double area() const { return area_; }
  [[nodiscard]] std::span<const std::uint32_t> charts() const { return charts_; }

  [[nodiscard]] Extent texels(std::size_t i, double density) const {
    const auto whole = [density](double length) {
      return std::max(smallest_chart, static_cast<std::uint32_t>(std::lround(std::min(density * length, 1e6))));
    };
    return {whole(sizes_[i].width), whole(sizes_[i].height)};
  }

  // The texels that gutters of this width take.
  [[nodiscard]] double texels_of_gutters(double density, std::uint32_t gutter) const {
    double sum = 0;
    for (std::size_t i = 0; i < charts_.size(); ++i) {
      const Extent e = texels(i, density);
      sum += 2.0 * gutter * (e.width + e.height) + 4.0 * gutter * gutter;
    }
    return sum;
  }

  // The page needs no gutter at its own border: reads are clamped there.
  [[nodiscard]] std::optional<std::vector<Placement>> fit(const Extent& page, double density,
                                                          std::uint32_t gutter) const {
    std::vector<Extent> padded;
    for (std::size_t i = 0; i < charts_.size(); ++i) {
      const Extent e = texels(i, density);
      padded.push_back({e.width + 2 * gutter, e.height + 2 * gutter});
    }
    return pack(padded, {page.width + 2 * gutter, page.height + 2 * gutter});
  }

  // The highest density that was found to fit; 0 where nothing fits.
  [[nodiscard]] double highest_density(const Extent& page, std::uint32_t gutter) const {
    double high = std::sqrt(static_cast<double>(page.width) * page.height / area_), low = 0;
    if (!fit(page, low, gutter)) return 0;
    for (int i = 0; i < bisections; ++i) {
      const double middle = 0.5 * (low + high);
      (fit(page, middle, gutter) ? low : high) = middle;
    }
    return low;
  }

  // The smallest page found that holds the charts at this density.
  [[nodiscard]] std::optional<Extent> smallest(double density, std::uint32_t gutter, std::uint32_t widest) const {
    double side = std::max<double>(smallest_page, density * std::sqrt(area_));
    for (;; side = std::max(side + 4, 1.02 * side)) {
      const std::uint32_t width = std::min(multiple_of_4(side), widest);
      if (fit({width, width}, density, gutter)) return reshaped({width, width}, density, gutter, widest);
      if (width == widest) return std::nullopt;
    }
  }

private:
  std::vector<std::uint32_t> charts_;
  std::vector<FlatCharts::Size> sizes_;
  double area_ = 0;

  // Other widths than a square's that fits, each as low as it gets while it takes less.
  [[nodiscard]] Extent reshaped(const Extent& square, double density, std::uint32_t gutter,
                                std::uint32_t widest) const {
    Extent best = square;
    const auto area_of = [](const Extent& e) { return std::uint64_t{e.width} * e.height; };
    for (int percent = 80; percent <= 150; percent += charts_.size() < many_charts ? 2 : 20) {
      const std::uint32_t width = std::min(multiple_of_4(square.width * percent / 100.0), widest);
      const auto lower = [&](std::uint64_t area) { return static_cast<std::uint32_t>(area / width / 4 * 4); };
      std::uint32_t high = std::min(lower(area_of(best) - 1), widest);
      if (high < smallest_page || width < smallest_page || !fit({width, high}, density, gutter)) continue;
      std::uint32_t low = std::max(lower(static_cast<std::uint64_t>(density * density * area_)), smallest_page);
      while (low + 4 < high) {
        const std::uint32_t middle = (low + high) / 8 * 4;
        (fit({width, middle}, density, gutter) ? high : low) = middle;
      }
      best = {width, high};
    }
    return best;
  }
};

class Placer {
public:
  Placer(std::span<const AtlasComponent> components, std::span<const FlatCharts> charts)
      : components_(components), charts_(charts) {
    std::uint32_t pages = 0;
    for (const AtlasComponent& c : components) pages = std::max(pages, c.page + 1);
    packers_.resize(pages);
    for (std::uint32_t i = 0; i < components.size(); ++i)
      for (std::uint32_t c = 0; c < charts[i].sizes.size(); ++c) {
        chart_of_.push_back(none);
        if (!charts[i].is_shown[c]) continue;
        chart_of_.back() = static_cast<std::uint32_t>(out_.mesh.charts.size());
        packers_[components[i].page].add(chart_of_.back(), charts[i].sizes[c]);
        out_.mesh.charts.push_back({i, components[i].page, 0, 0, 0, 0});
      }
  }

  Placed run(const AtlasSize& size) {
    width_ = size.width;
    if (size.texel_density > 0 && !take_density(size.texel_density)) width_ = widest_page;
    if (density_ <= 0) choose_density();
    out_.texel_density = density_;
    turned_.resize(out_.mesh.charts.size());
    for (std::uint32_t p = 0; p < packers_.size(); ++p) place_page(p);
    out_.mesh.points = 0;
    for (const AtlasComponent& c : components_) out_.mesh.points += c.sphere.size();
    std::size_t first = 0; // chart
    for (std::uint32_t i = 0; i < components_.size(); ++i) {
      append(i, std::span(chart_of_).subspan(first, charts_[i].sizes.size()));
      first += charts_[i].sizes.size();
    }
    return std::move(out_);
  }

private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::span<const AtlasComponent> components_;
  std::span<const FlatCharts> charts_;
  std::uint32_t width_ = 0;             // of the page with most surface, or about that
  std::vector<std::uint32_t> chart_of_; // charts of all components in a row -> chart of the atlas
  std::vector<PagePacker> packers_;     // one per page
  std::vector<Extent> pages_;
  double density_ = 0; // texels per unit of length
  std::vector<bool> turned_;
  Placed out_;

  [[nodiscard]] std::size_t largest_page() const {
    return static_cast<std::size_t>(
        std::max_element(packers_.begin(), packers_.end(),
                         [](const PagePacker& a, const PagePacker& b) { return a.area() < b.area(); }) -
        packers_.begin());
  }

  // Pages for a density that was asked for; false, with density_ 0, where one would have to be too wide.
  bool take_density(double density) {
    const PagePacker& packer = packers_[largest_page()];
    const double side = density * std::sqrt(packer.area());
    if (side > widest_page) return false;
    width_ = std::max(multiple_of_4(side), smallest_page);
    out_.mesh.gutter = gutter_for(packer);
    pages_.clear();
    for (const PagePacker& each : packers_) {
      const auto page = each.smallest(density, out_.mesh.gutter, widest_page);
      if (!page) return false;
      pages_.push_back(*page);
    }
    density_ = density;
    return true;
  }

  // The page with the largest surface decides, in the shape that wastes least; the others follow.
  void choose_density() {
    const std::size_t largest = largest_page();
    const PagePacker& packer = packers_[largest];
    out_.mesh.gutter = gutter_for(packer);
    double best = 0;
    Extent shape;
    for (const Extent& page : shapes(packer.charts().size())) {
      const double density = packer.highest_density(page, out_.mesh.gutter);
      const double used = density * density * packer.area() / (static_cast<double>(page.width) * page.height);
      if (used <= best) continue;
      best = used;
      density_ = density;
      shape = page;
    }
    if (density_ <= 0)
      throw Error(ErrorCode::invalid_option,
                  "the surface has " + std::to_string(packer.charts().size()) +
                      " charts, too many for an atlas of this size: ask for a larger texture_size",
                  "texture_size");
    while (!follow(largest, shape)) density_ *= 0.98;
  }

  // Pages for the density; false where one of them would have to be larger than the largest.
  bool follow(std::size_t largest, const Extent& shape) {
    pages_.assign(packers_.size(), shape);
    for (std::size_t p = 0; p < packers_.size(); ++p) {
      if (p == largest) continue;
      const auto page = packers_[p].smallest(density_, out_.mesh.gutter, width_);
      if (!page) return false;
      pages_[p] = *page;
    }
    return packers_[largest].fit(shape, density_, out_.mesh.gutter).has_value();
  }

  // As wide as they come while those of all pages leave enough for the charts.
  [[nodiscard]] std::uint32_t gutter_for(const PagePacker& largest) const {
    const double density = 0.9 * width_ / std::sqrt(largest.area());
    const auto share = [&](std::uint32_t gutter) {
      double gutters = 0, area = 0;
      for (const PagePacker& packer : packers_) {
        gutters += packer.texels_of_gutters(density, gutter);
        area += packer.area();
      }
      return gutters * largest.area() / (area * width_ * width_);
    };
    std::uint32_t gutter = std::bit_floor(std::max(width_ / 128, least_gutter));
    while (gutter > least_gutter && share(gutter) > most_for_gutters) gutter /= 2;
    return gutter;
  }

  // A few charts may fit a lower page better, and a single one may be a band; many fill a square as well.
  [[nodiscard]] std::vector<Extent> shapes(std::size_t charts) const {
    constexpr int shapes_at_most = 64, lowest_of_many = 32, lowest_of_few = 4;
    constexpr std::size_t few_charts = 8;
    const int lowest = charts < few_charts ? lowest_of_few : charts < many_charts ? lowest_of_many : shapes_at_most;
    std::vector<Extent> out{{width_, width_ / 4 * 4}};
    for (int part = shapes_at_most - 1; part >= lowest; --part)
      out.push_back({width_, multiple_of_4(width_ * part / double{shapes_at_most})});
    return out;
  }

  void place_page(std::uint32_t p) {
    const PagePacker& packer = packers_[p];
    const std::vector<Placement> placements = packer.fit(pages_[p], density_, out_.mesh.gutter).value();
    out_.mesh.pages.push_back({pages_[p].width, pages_[p].height});
    for (std::size_t i = 0; i < placements.size(); ++i) {
      Chart& chart = out_.mesh.charts[packer.charts()[i]];
      const Extent size = packer.texels(i, density_);
      chart.x = placements[i].x;
      chart.y = placements[i].y;
      chart.width = placements[i].turned ? size.height : size.width;
      chart.height = placements[i].turned ? size.width : size.height;
      turned_[packer.charts()[i]] = placements[i].turned;
    }
  }

  // Where each chart of a component lies; in the whole of [0, 1] where it is not shown.
  [[nodiscard]] std::vector<ChartFrame> frames(std::span<const std::uint32_t> chart_of) const {
    std::vector<ChartFrame> out;
    for (const std::uint32_t c : chart_of) {
      out.emplace_back();
      if (c != none) out.back() = {out_.mesh.charts[c], out_.mesh.pages[out_.mesh.charts[c].page], turned_[c]};
    }
    return out;
  }

  // A component's delivered triangles, with the whole surface's numbers for its own. Added points are numbered behind
  // all vertices of the surface.
  void append(std::uint32_t i, std::span<const std::uint32_t> chart_of) {
    const AtlasComponent& component = components_[i];
    const CutMesh& part = charts_[i].mesh;
    const Settled settled = settle(charts_[i], frames(chart_of));
    if (settled.folded > 0) out_.folded.push_back(i);
    std::vector<mesh::Index> number(part.vertices.size(), none);
    const auto given = static_cast<std::uint32_t>(component.sphere.size());
    const auto added = static_cast<std::uint32_t>(out_.mesh.points);
    const auto vertex = [&](mesh::Index v) {
      if (number[v] != none) return number[v];
      number[v] = static_cast<mesh::Index>(out_.mesh.vertices.size());
      CutVertex copy = part.vertices[v];
      copy.triangle += component.first_triangle;
      copy.point = copy.point < given ? copy.point + component.first_vertex : copy.point - given + added;
      copy.uv = to_uv(settled.points[charts_[i].place_of[v]]);
      out_.mesh.vertices.push_back(copy);
      return number[v];
    };
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      const auto& [a, b, c] = part.triangles[t];
      const mesh::Index p = vertex(a), q = vertex(b), r = vertex(c);
      out_.mesh.triangles.push_back({p, q, r});
      out_.mesh.parent.push_back(component.first_triangle + part.parent[t]);
      out_.mesh.chart.push_back(chart_of[part.chart[t]]);
    }
    out_.mesh.cut_triangles += part.cut_triangles;
    out_.mesh.points += part.points - given;
  }
};

} // namespace

Placed place(std::span<const AtlasComponent> components, std::span<const FlatCharts> charts, const AtlasSize& size) {
  if (size.width < smallest_page || size.width > widest_page)
    throw Error(ErrorCode::invalid_option, "the atlas must be 64 to 8192 texels wide", "texture_size");
  return Placer(components, charts).run(size);
}

} // namespace orbis::texture
