#include "core/mesh/spatial_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace orbis::mesh {
namespace {

constexpr std::uint32_t bits = 13; // a side; three sides make one digit of the sort each
constexpr std::size_t grain = 8192;

using Cell = std::array<std::uint32_t, 3>;

// The place of a cell on the curve (Skilling, Programming the Hilbert curve, 2004): the axes are turned into the
// transposed index, bit by bit from the top, then Gray-decoded and interleaved.
std::uint64_t hilbert_index(Cell x) {
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1U) {
    const std::uint32_t below = q - 1;
    for (std::uint32_t& axis : x) {
      if ((axis & q) != 0) {
        x[0] ^= below;
      } else {
        const std::uint32_t t = (x[0] ^ axis) & below;
        x[0] ^= t;
        axis ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t parity = 0;
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1U) {
    if ((x[2] & q) != 0) parity ^= q - 1;
  }
  std::uint64_t index = 0;
  for (std::uint32_t bit = bits; bit-- > 0;) {
    for (const std::uint32_t axis : x) index = index << 1U | ((axis ^ parity) >> bit & 1U);
  }
  return index;
}

struct Entry {
  std::uint64_t key;
  Index vertex;
};

// Stable, by one digit of the key (radix sort).
void sort_by_digit(const std::vector<Entry>& in, std::vector<Entry>& out, std::uint32_t digit) {
  std::vector<std::uint32_t> place((1U << bits) + 1);
  const auto digit_of = [&](const Entry& e) {
    return static_cast<std::uint32_t>(e.key >> digit * bits) & ((1U << bits) - 1);
  };
  for (const Entry& e : in) ++place[digit_of(e) + 1];
  for (std::size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
  for (const Entry& e : in) out[place[digit_of(e)]++] = e;
}

} // namespace

std::vector<Index> hilbert_order(std::span<const Vec3d> positions, ThreadPool& pool) {
  std::vector<Entry> entries(positions.size()), sorted(positions.size());
  pool.for_blocks(positions.size(), grain, [&](std::size_t begin, std::size_t end) {
    constexpr double cells = 1U << bits;
    const auto cell = [](double x) { return static_cast<std::uint32_t>(std::clamp(x * cells, 0.0, cells - 1)); };
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3d& p = positions[v];
      entries[v] = {hilbert_index({cell(p.x), cell(p.y), cell(p.z)}), static_cast<Index>(v)};
    }
  });
  for (std::uint32_t digit = 0; digit < 3; ++digit) {
    sort_by_digit(entries, sorted, digit);
    std::swap(entries, sorted);
  }
  std::vector<Index> order(positions.size());
  std::ranges::transform(entries, order.begin(), &Entry::vertex);
  return order;
}

std::vector<Triangle> renumbered(std::span<const Triangle> triangles, std::span<const Index> order, ThreadPool& pool) {
  std::vector<Index> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = static_cast<Index>(i);
  std::vector<std::uint32_t> first(order.size() + 1); // by lowest vertex; a row's end first, then its begin
  std::vector<Triangle> turned(triangles.size()), out(triangles.size());
  pool.for_blocks(triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Triangle t{number[triangles[i][0]], number[triangles[i][1]], number[triangles[i][2]]};
      std::rotate(t.begin(), std::ranges::min_element(t), t.end());
      turned[i] = t;
    }
  });
  for (const Triangle& t : turned) ++first[t[0]];
  std::uint32_t end = 0;
  for (std::uint32_t& f : first) f = end += f;
  for (const Triangle& t : turned) out[--first[t[0]]] = t;
  pool.for_blocks(order.size(), grain, [&](std::size_t from, std::size_t to) {
    for (std::size_t v = from; v < to; ++v) std::sort(out.begin() + first[v], out.begin() + first[v + 1]);
  });
  return out;
}

} // namespace orbis::mesh
