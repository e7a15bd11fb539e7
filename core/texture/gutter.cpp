#include "core/texture/gutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/texture/page_raster.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// From ring to ring outwards (brushfire): a texel takes the nearest of its neighbours' origins. That is the nearest
// covered texel but for rare ties of a fraction of a texel.
class Brushfire {
public:
  Brushfire(const CutMesh& mesh, std::uint32_t page)
      : width_(mesh.pages[page].width), height_(mesh.pages[page].height), origin_(std::size_t{width_} * height_, none) {
    rasterize_page(mesh, page, [&](std::uint32_t x, std::uint32_t y, std::uint32_t, const std::array<double, 3>&) {
      origin_[std::size_t{y} * width_ + x] = y * width_ + x;
    });
    for (std::uint32_t i = 0; i < origin_.size(); ++i)
      if (origin_[i] == i && has_open_neighbour(i)) front_.push_back(i);
  }

  template <class Found> void spread(Found found) {
    std::vector<std::uint32_t> next;
    while (!front_.empty()) {
      next.clear();
      for (const std::uint32_t i : front_)
        for_each_neighbour(i, [&](std::uint32_t j) {
          if (origin_[j] != none) return;
          origin_[j] = reached;
          next.push_back(j);
        });
      settle(next);
      for (const std::uint32_t i : next) found(i, origin_[i]);
      front_.swap(next);
    }
  }

private:
  static constexpr std::uint32_t reached = none - 1; // in the ring that is being settled
  std::uint32_t width_, height_;
  std::vector<std::uint32_t> origin_;
  std::vector<std::uint32_t> front_;

  template <class Visit> void for_each_neighbour(std::uint32_t i, Visit visit) const {
    const std::uint32_t x = i % width_, y = i / width_;
    for (std::uint32_t v = y - (y > 0 ? 1 : 0); v <= std::min(y + 1, height_ - 1); ++v)
      for (std::uint32_t u = x - (x > 0 ? 1 : 0); u <= std::min(x + 1, width_ - 1); ++u)
        if (u != x || v != y) visit(v * width_ + u);
  }

  [[nodiscard]] bool has_open_neighbour(std::uint32_t i) const {
    bool open = false;
    for_each_neighbour(i, [&](std::uint32_t j) { open = open || origin_[j] == none; });
    return open;
  }

  [[nodiscard]] std::int64_t squared_distance(std::uint32_t i, std::uint32_t j) const {
    const std::int64_t x = std::int64_t{i % width_} - j % width_, y = std::int64_t{i / width_} - j / width_;
    return x * x + y * y;
  }

  void settle(const std::vector<std::uint32_t>& ring) {
    std::vector<std::uint32_t> nearest(ring.size(), none);
    for (std::size_t k = 0; k < ring.size(); ++k)
      for_each_neighbour(ring[k], [&](std::uint32_t j) {
        const std::uint32_t from = origin_[j];
        if (from >= reached) return;
        if (nearest[k] == none || squared_distance(ring[k], from) < squared_distance(ring[k], nearest[k]))
          nearest[k] = from;
      });
    for (std::size_t k = 0; k < ring.size(); ++k) origin_[ring[k]] = nearest[k];
  }
};

} // namespace

Gutters::Gutters(const CutMesh& mesh, std::uint32_t page) {
  Brushfire(mesh, page).spread([this](std::uint32_t to, std::uint32_t from) { fills_.push_back({to, from}); });
}

void Gutters::fill(Image& image) const {
  const std::size_t channels = image.channels;
  for_each([&](std::uint32_t to, std::uint32_t from) {
    std::copy_n(image.pixels.data() + channels * from, channels, image.pixels.data() + channels * to);
  });
}

} // namespace orbis::texture
