#include "core/texture/skyline.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

namespace orbis::texture {
namespace {

// Of orders that are tried for few rectangles; each takes about the square of their number of steps.
constexpr std::size_t tries_at_most = 48, work = 6000;

// The upper outline of what has been placed: steps from left to right that fill the page's width.
class Skyline {
public:
  explicit Skyline(const Extent& page) : page_(page), steps_{{0, page.width, 0}} {}

  // Puts a rectangle where its top ends lowest, then where it wastes least. Returns false where it does not fit.
  bool place(const Extent& rectangle, Placement& placement) {
    Candidate best;
    consider(rectangle, false, best);
    if (rectangle.width != rectangle.height) consider({rectangle.height, rectangle.width}, true, best);
    if (best.top == none) return false;
    placement = {steps_[best.step].x, best.y, best.turned};
    raise(best);
    return true;
  }

  struct Step {
    std::uint32_t x, width, y;
  };
  // The lowest step, and how high the page goes on above it.
  [[nodiscard]] std::size_t lowest() const {
    return static_cast<std::size_t>(
        std::min_element(steps_.begin(), steps_.end(), [](const Step& a, const Step& b) { return a.y < b.y; }) -
        steps_.begin());
  }
  [[nodiscard]] const Step& step(std::size_t i) const { return steps_[i]; }
  [[nodiscard]] std::uint32_t room_above(std::size_t i) const { return page_.height - steps_[i].y; }

  // Puts a rectangle on a step that is as wide or wider, beside the higher of its two neighbours.
  void place_on(std::size_t i, const Extent& rectangle, Placement& placement) {
    const Step step = steps_[i];
    const std::uint32_t left = height_beside(i, -1), right = height_beside(i, 1);
    placement.x = left >= right ? step.x : step.x + step.width - rectangle.width;
    placement.y = step.y;
    std::vector<Step> parts;
    if (placement.x > step.x) parts.push_back({step.x, placement.x - step.x, step.y});
    parts.push_back({placement.x, rectangle.width, step.y + rectangle.height});
    const std::uint32_t end = placement.x + rectangle.width;
    if (end < step.x + step.width) parts.push_back({end, step.x + step.width - end, step.y});
    const auto at = steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(i));
    steps_.insert(at, parts.begin(), parts.end());
    join_level_steps();
  }

  // Gives a step up to the lower of its neighbours. Returns false where it has none.
  bool give_up(std::size_t i) {
    if (steps_.size() == 1) return false;
    steps_[i].y = std::min(height_beside(i, -1), height_beside(i, 1));
    join_level_steps();
    return true;
  }

private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Candidate {
    std::size_t step = 0;
    std::uint32_t width = 0, y = 0, top = none;
    std::uint64_t wasted = 0;
    bool turned = false;
  };

  Extent page_;
  std::vector<Step> steps_;

  // The page's border counts as higher than anything.
  [[nodiscard]] std::uint32_t height_beside(std::size_t i, int side) const {
    if (side < 0) return i == 0 ? none : steps_[i - 1].y;
    return i + 1 == steps_.size() ? none : steps_[i + 1].y;
  }

  void consider(const Extent& r, bool turned, Candidate& best) const {
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + r.width <= page_.width; ++i) {
      const std::uint32_t end = steps_[i].x + r.width;
      std::uint32_t y = 0;
      for (std::size_t j = i; j < steps_.size() && steps_[j].x < end; ++j) y = std::max(y, steps_[j].y);
      if (y + r.height > page_.height || y + r.height > best.top) continue;
      std::uint64_t wasted = 0;
      for (std::size_t j = i; j < steps_.size() && steps_[j].x < end; ++j)
        wasted += std::uint64_t{y - steps_[j].y} * (std::min(steps_[j].x + steps_[j].width, end) - steps_[j].x);
      if (y + r.height == best.top && wasted >= best.wasted) continue;
      best = {i, r.width, y, y + r.height, wasted, turned};
    }
  }

  void raise(const Candidate& c) {
    const Step raised{steps_[c.step].x, c.width, c.top};
    const std::uint32_t end = raised.x + raised.width;
    auto last = steps_.begin() + static_cast<std::ptrdiff_t>(c.step);
    while (last != steps_.end() && last->x + last->width <= end) ++last;
    if (last != steps_.end() && last->x < end) {
      last->width -= end - last->x;
      last->x = end;
    }
    const auto first = steps_.begin() + static_cast<std::ptrdiff_t>(c.step);
    steps_.insert(steps_.erase(first, last), raised);
    join_level_steps();
  }

  void join_level_steps() {
    std::size_t kept = 0;
    for (std::size_t i = 1; i < steps_.size(); ++i) {
      if (steps_[i].y == steps_[kept].y)
        steps_[kept].width += steps_[i].width;
      else
        steps_[++kept] = steps_[i];
    }
    steps_.resize(kept + 1);
  }
};

using Placements = std::optional<std::vector<Placement>>;

// Each rectangle in turn, where the skyline rises least.
Placements pack_in_order(std::span<const Extent> rectangles, std::span<const std::uint32_t> order, const Extent& page) {
  Skyline skyline(page);
  std::vector<Placement> placements(rectangles.size());
  for (const std::uint32_t i : order)
    if (!skyline.place(rectangles[i], placements[i])) return std::nullopt;
  return placements;
}

// Step after step from the lowest, each with the widest rectangle that fits on it (Burke, Kendall, Whitwell: A new
// placement heuristic for the orthogonal stock-cutting problem, 2004).
Placements pack_by_steps(std::span<const Extent> rectangles, const Extent& page) {
  struct Side { // a rectangle standing on this side
    std::uint32_t width, height, rectangle;
    bool turned;
    bool operator<(const Side& o) const {
      return std::tie(width, height, rectangle, turned) < std::tie(o.width, o.height, o.rectangle, o.turned);
    }
  };
  std::set<Side> sides;
  for (std::uint32_t i = 0; i < rectangles.size(); ++i) {
    sides.insert({rectangles[i].width, rectangles[i].height, i, false});
    sides.insert({rectangles[i].height, rectangles[i].width, i, true});
  }
  Skyline skyline(page);
  std::vector<Placement> placements(rectangles.size());
  while (!sides.empty()) {
    const std::size_t i = skyline.lowest();
    auto fitting = sides.lower_bound({skyline.step(i).width + 1, 0, 0, false});
    while (fitting != sides.begin() && std::prev(fitting)->height > skyline.room_above(i)) --fitting;
    if (fitting == sides.begin()) {
      if (!skyline.give_up(i)) return std::nullopt;
      continue;
    }
    const Side side = *std::prev(fitting);
    placements[side.rectangle].turned = side.turned;
    skyline.place_on(i, {side.width, side.height}, placements[side.rectangle]);
    sides.erase(side);
    sides.erase({side.height, side.width, side.rectangle, !side.turned});
  }
  return placements;
}

// The numbers of the rectangles, those with the largest `size` first.
template <class Size> std::vector<std::uint32_t> ordered(std::span<const Extent> rectangles, Size size) {
  std::vector<std::uint32_t> order(rectangles.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, std::greater<>(), [&](std::uint32_t i) { return size(rectangles[i]); });
  return order;
}

// Few rectangles in other orders, near a good one; the same ones every time.
Placements pack_in_some_order(std::span<const Extent> rectangles, std::vector<std::uint32_t> order,
                              const Extent& page) {
  const std::size_t count = order.size(), tries = std::min<std::size_t>(tries_at_most, work / (count * count));
  std::mt19937 random(1);
  for (std::size_t i = 0; i < tries; ++i) {
    std::swap(order[random() % count], order[random() % count]);
    if (auto placements = pack_in_order(rectangles, order, page)) return placements;
  }
  return std::nullopt;
}

} // namespace

Placements pack(std::span<const Extent> rectangles, const Extent& page) {
  if (rectangles.empty()) return std::vector<Placement>{};
  std::uint64_t area = 0;
  for (const Extent& r : rectangles) area += std::uint64_t{r.width} * r.height;
  if (area > std::uint64_t{page.width} * page.height) return std::nullopt;
  if (auto placements = pack_by_steps(rectangles, page)) return placements;
  const auto by_long_side = ordered(rectangles, [](const Extent& r) { return std::max(r.width, r.height); });
  const auto by_area = ordered(rectangles, [](const Extent& r) { return std::uint64_t{r.width} * r.height; });
  const auto by_perimeter = ordered(rectangles, [](const Extent& r) { return r.width + r.height; });
  const auto by_short_side = ordered(rectangles, [](const Extent& r) { return std::min(r.width, r.height); });
  for (const auto* order : {&by_long_side, &by_area, &by_perimeter, &by_short_side})
    if (auto placements = pack_in_order(rectangles, *order, page)) return placements;
  return pack_in_some_order(rectangles, by_long_side, page);
}

} // namespace orbis::texture
