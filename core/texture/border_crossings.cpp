// Along the chord a + t (b - a) each of the six coordinates s_f(t) = s_f(a) + t (s_f(b) - s_f(a)) is linear, and the
// face at t is the one with the largest: the faces along an edge are the upper envelope of six lines. With 25-bit
// integers at the ends every comparison of two crossings is exact in 64 bits, so the order of the crossings is exact,
// also where an edge passes close to a corner of the cube.
#include "core/texture/border_crossings.h"

#include <algorithm>
#include <cmath>

namespace orbis::texture {
namespace {

using sphere::GridPoint;

// t = numerator / denominator, denominator > 0.
struct Fraction {
  std::int64_t numerator = 1, denominator = 1;
  friend bool operator<(const Fraction& a, const Fraction& b) {
    return a.numerator * b.denominator < b.numerator * a.denominator;
  }
  friend bool operator==(const Fraction& a, const Fraction& b) {
    return a.numerator * b.denominator == b.numerator * a.denominator;
  }
};

struct Envelope {
  const GridPoint& a;
  const GridPoint& b;

  [[nodiscard]] std::int64_t slope(Face f) const { return std::int64_t{along(b, f)} - along(a, f); }

  // The largest coordinate just after a.
  [[nodiscard]] Face first() const {
    Face best = 0;
    for (Face f = 1; f < face_count; ++f)
      if (along(a, f) > along(a, best) || (along(a, f) == along(a, best) && slope(f) > slope(best))) best = f;
    return best;
  }

  // The face that overtakes f first, and where; f itself if none does before b.
  [[nodiscard]] Face next(Face f, Fraction& where) const {
    Face best = f;
    where = {};
    for (Face g = 0; g < face_count; ++g) {
      if (slope(g) <= slope(f)) continue;
      const Fraction t{std::int64_t{along(a, f)} - along(a, g), slope(g) - slope(f)};
      const bool steeper = best != f && t == where && slope(g) > slope(best);
      if (t < where || steeper) {
        where = t;
        best = g;
      }
    }
    return best;
  }
};

// The nearest grid point that lies exactly on the plane between the two faces.
GridPoint place_on_border(const GridPoint& a, const GridPoint& b, double t, Face from, Face to) {
  std::array<double, 3> p{};
  for (std::size_t i = 0; i < 3; ++i) p[i] = (1 - t) * a[i] + t * b[i];
  const double scale = std::ldexp(1.0, sphere::grid_bits) / std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  const double towards = (from & 1U) != 0 ? -p[axis_of(from)] : p[axis_of(from)];
  const double onwards = (to & 1U) != 0 ? -p[axis_of(to)] : p[axis_of(to)];
  const auto shared = static_cast<std::int32_t>(std::lround(0.5 * (towards + onwards) * scale));
  const std::size_t third = 3 - axis_of(from) - axis_of(to);
  GridPoint result{};
  result[axis_of(from)] = (from & 1U) != 0 ? -shared : shared;
  result[axis_of(to)] = (to & 1U) != 0 ? -shared : shared;
  result[third] = static_cast<std::int32_t>(std::lround(p[third] * scale));
  return result;
}

std::vector<BorderCrossing> all_crossings(const GridPoint& a, const GridPoint& b) {
  const Envelope envelope{a, b};
  std::vector<BorderCrossing> crossings;
  Fraction where;
  for (Face from = envelope.first();;) {
    const Face to = envelope.next(from, where);
    if (to == from) return crossings;
    BorderCrossing c;
    c.t = static_cast<double>(where.numerator) / static_cast<double>(where.denominator);
    c.from = from;
    c.to = to;
    c.sphere = place_on_border(a, b, c.t, from, to);
    c.faces = static_cast<FaceMask>(faces_at(c.sphere) | bit_of(from) | bit_of(to));
    crossings.push_back(c);
    from = to;
  }
}

} // namespace

FaceMask faces_at(const GridPoint& p) {
  const std::int32_t largest = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  FaceMask faces = 0;
  for (Face f = 0; f < face_count; ++f)
    if (along(p, f) >= largest - border_tolerance) faces = static_cast<FaceMask>(faces | bit_of(f));
  return faces;
}

std::vector<BorderCrossing> border_crossings(const GridPoint& a, const GridPoint& b) {
  // A crossing is needed only where no later point shares a face with the last one: ends within the tolerance of a
  // border and passages close to a corner of the cube have crossings that would leave parts too small for the grid.
  FaceMask here = faces_at(a);
  const FaceMask there = faces_at(b);
  std::vector<BorderCrossing> needed;
  if ((here & there) != 0) return needed;
  const std::vector<BorderCrossing> all = all_crossings(a, b);
  for (auto next = all.begin(); (here & there) == 0 && next != all.end();) {
    auto last = next;
    for (auto c = next; c != all.end(); ++c)
      if ((c->faces & here) != 0) last = c;
    needed.push_back(*last);
    here = last->faces;
    next = last + 1;
  }
  return needed;
}

} // namespace orbis::texture
