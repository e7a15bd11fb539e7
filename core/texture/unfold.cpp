#include "core/texture/unfold.h"

#include <algorithm>
#include <array>

#include "core/error.h"

namespace orbis::texture {
namespace {

using sphere::GridPoint;

// Moves along the border (and the radius, which the border's plane holds too), nearest first.
constexpr std::int32_t reach = 3;
struct Move {
  std::int32_t shared, third; // steps of the two equal coordinates, and of the other one
};
std::vector<Move> moves() {
  std::vector<Move> all;
  for (std::int32_t s = -reach; s <= reach; ++s)
    for (std::int32_t t = -reach; t <= reach; ++t)
      if (s != 0 || t != 0) all.push_back({s, t});
  std::stable_sort(all.begin(), all.end(), [](const Move& a, const Move& b) {
    return a.shared * a.shared + a.third * a.third < b.shared * b.shared + b.third * b.third;
  });
  return all;
}

GridPoint moved(const AddedPoint& point, const Move& move) {
  GridPoint p = point.sphere;
  for (const Face f : {point.from, point.to}) p[axis_of(f)] += (f & 1U) != 0 ? -move.shared : move.shared;
  p[3 - axis_of(point.from) - axis_of(point.to)] += move.third;
  return p;
}

class Unfolder {
public:
  Unfolder(std::span<const mesh::Triangle> pieces, std::span<const GridPoint> sphere, std::vector<AddedPoint>& added)
      : pieces_(pieces), sphere_(sphere), added_(added), star_(added.size()) {
    for (std::uint32_t i = 0; i < pieces.size(); ++i)
      for (const mesh::Index p : pieces[i])
        if (is_added(p)) star_[p - sphere.size()].push_back(i);
  }

  // Returns whether no piece is folded any more.
  bool pass() {
    bool done = true;
    for (const mesh::Triangle& piece : pieces_) {
      if (!folded(piece)) continue;
      for (const mesh::Index p : piece)
        if (is_added(p) && folded(piece)) improve(p);
      done = done && !folded(piece);
    }
    return done;
  }

private:
  std::span<const mesh::Triangle> pieces_;
  std::span<const GridPoint> sphere_;
  std::vector<AddedPoint>& added_;
  std::vector<std::vector<std::uint32_t>> star_; // the pieces around an added point
  std::vector<Move> moves_ = moves();

  [[nodiscard]] bool is_added(mesh::Index p) const { return p >= sphere_.size(); }
  [[nodiscard]] const GridPoint& place(mesh::Index p) const {
    return is_added(p) ? added_[p - sphere_.size()].sphere : sphere_[p];
  }
  [[nodiscard]] bool folded(const mesh::Triangle& t) const {
    return sphere::orientation(place(t[0]), place(t[1]), place(t[2])) <= 0;
  }
  [[nodiscard]] auto folded_around(mesh::Index p) const {
    const auto& star = star_[p - sphere_.size()];
    return std::count_if(star.begin(), star.end(), [this](std::uint32_t i) { return folded(pieces_[i]); });
  }

  // Takes the first move that leaves fewer folded pieces around p.
  void improve(mesh::Index p) {
    AddedPoint& point = added_[p - sphere_.size()];
    if (point.from == point.to) return;
    const AddedPoint before = point;
    const auto folds = folded_around(p);
    for (const Move& move : moves_) {
      point.sphere = moved(before, move);
      if (folded_around(p) < folds) return;
    }
    point = before;
  }
};

} // namespace

void unfold(std::span<const mesh::Triangle> pieces, std::span<const GridPoint> sphere, std::vector<AddedPoint>& added) {
  Unfolder unfolder(pieces, sphere, added);
  // A move is taken only where it leaves fewer folds, so passes cannot undo each other.
  constexpr int passes = 4;
  for (int i = 0; i < passes; ++i)
    if (unfolder.pass()) return;
  throw Error(ErrorCode::not_certified, "a triangle that crosses a border of the cube's faces is too thin to be cut "
                                        "exactly");
}

} // namespace orbis::texture
