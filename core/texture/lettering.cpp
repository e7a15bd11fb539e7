#include "core/texture/lettering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace orbis::texture {
namespace {

// Letters are drawn in a box 4 wide and 6 high, y down.
constexpr double letter_width = 4, letter_height = 6, spacing = 1.9, stroke = 0.95;

// Part of an ellipse; degrees, clockwise from the right. A straight line has no radius: it goes from (x, y) to (rx,
// ry).
struct Stroke {
  double x, y, rx, ry, from = 0, to = 0;
};

std::span<const Stroke> strokes_of(char letter) {
  static const Stroke plus[] = {{0.3, 3, 3.7, 3}, {2, 1.3, 2, 4.7}};
  static const Stroke minus[] = {{0.3, 3, 3.7, 3}};
  static const Stroke a[] = {{0, 6, 2, 0}, {2, 0, 4, 6}, {0.7, 4, 3.3, 4}};
  static const Stroke b[] = {{0.2, 0, 0.2, 6},
                             {0.2, 0, 2.2, 0},
                             {2.2, 1.45, 1.5, 1.45, -90, 90},
                             {0.2, 2.9, 2.3, 2.9},
                             {2.3, 4.45, 1.7, 1.55, -90, 90},
                             {0.2, 6, 2.3, 6}};
  static const Stroke c[] = {{2.2, 3, 2.2, 3, 50, 310}};
  static const Stroke d[] = {{0.2, 0, 0.2, 6}, {0.2, 0, 1.5, 0}, {1.5, 3, 2.5, 3, -90, 90}, {0.2, 6, 1.5, 6}};
  static const Stroke e[] = {{0.4, 0, 0.4, 6}, {0.4, 0, 3.8, 0}, {0.4, 3, 3.3, 3}, {0.4, 6, 3.8, 6}};
  static const Stroke f[] = {{0.4, 0, 0.4, 6}, {0.4, 0, 3.8, 0}, {0.4, 3, 3.3, 3}};
  static const Stroke g[] = {{2.2, 3, 2.2, 3, 8, 310}, {2.4, 3.4, 4.3, 3.4}};
  static const Stroke h[] = {{0.2, 0, 0.2, 6}, {3.8, 0, 3.8, 6}, {0.2, 3, 3.8, 3}};
  static const Stroke x[] = {{0.1, 0, 3.9, 6}, {3.9, 0, 0.1, 6}};
  static const Stroke y[] = {{0, 0, 2, 3}, {4, 0, 2, 3}, {2, 3, 2, 6}};
  static const Stroke z[] = {{0.1, 0, 3.9, 0}, {3.9, 0, 0.1, 6}, {0.1, 6, 3.9, 6}};
  static const Stroke one[] = {{0.7, 1.3, 2.2, 0}, {2.2, 0, 2.2, 6}, {0.7, 6, 3.7, 6}};
  static const Stroke two[] = {{2, 1.9, 1.9, 1.9, 180, 395}, {3.56, 2.99, 0.1, 6}, {0.1, 6, 3.9, 6}};
  static const Stroke three[] = {{1.9, 1.5, 1.7, 1.5, 200, 450}, {1.9, 4.5, 2, 1.5, 270, 520}};
  static const Stroke four[] = {{3, 6, 3, 0}, {3, 0, 0, 4.2}, {0, 4.2, 4, 4.2}};
  static const Stroke five[] = {{3.6, 0, 0.6, 0}, {0.6, 0, 0.37, 2.88}, {1.9, 4.1, 2, 1.9, 220, 520}};
  static const Stroke six[] = {{2, 4.1, 2, 1.9, 0, 360}, {3.4, 4.1, 3.4, 4.1, 180, 265}};
  static const Stroke seven[] = {{0.1, 0, 3.9, 0}, {3.9, 0, 1.4, 6}};
  static const Stroke eight[] = {{2, 1.5, 1.7, 1.5, 0, 360}, {2, 4.5, 2, 1.5, 0, 360}};
  switch (letter) {
  case '+':
    return plus;
  case '-':
    return minus;
  case 'A':
    return a;
  case 'B':
    return b;
  case 'C':
    return c;
  case 'D':
    return d;
  case 'E':
    return e;
  case 'F':
    return f;
  case 'G':
    return g;
  case 'H':
    return h;
  case 'X':
    return x;
  case 'Y':
    return y;
  case 'Z':
    return z;
  case '1':
    return one;
  case '2':
    return two;
  case '3':
    return three;
  case '4':
    return four;
  case '5':
    return five;
  case '6':
    return six;
  case '7':
    return seven;
  case '8':
    return eight;
  default:
    return {};
  }
}

struct Segment {
  double x0, y0, x1, y1;

  [[nodiscard]] double distance(double x, double y) const {
    const double dx = x1 - x0, dy = y1 - y0;
    const double length = dx * dx + dy * dy;
    const double t = length > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / length, 0.0, 1.0) : 0;
    return std::hypot(x - x0 - t * dx, y - y0 - t * dy);
  }
};

// A line with round ends, half_width to each side; all in texels. The mask keeps the larger coverage.
void draw(const Segment& s, double half_width, TextMask& mask) {
  const auto texel = [](double at, std::uint32_t end) {
    return static_cast<std::uint32_t>(std::clamp(at, 0.0, static_cast<double>(end)));
  };
  const double reach = half_width + 1;
  const std::uint32_t left = texel(std::min(s.x0, s.x1) - reach, mask.width);
  const std::uint32_t right = texel(std::max(s.x0, s.x1) + reach + 1, mask.width);
  const std::uint32_t top = texel(std::min(s.y0, s.y1) - reach, mask.height);
  const std::uint32_t bottom = texel(std::max(s.y0, s.y1) + reach + 1, mask.height);
  for (std::uint32_t y = top; y < bottom; ++y)
    for (std::uint32_t x = left; x < right; ++x) {
      const double covered = std::clamp(half_width - s.distance(x + 0.5, y + 0.5) + 0.5, 0.0, 1.0);
      std::uint8_t& before = mask.coverage[std::size_t{y} * mask.width + x];
      before = std::max(before, static_cast<std::uint8_t>(std::lround(255 * covered)));
    }
}

void append_segments(const Stroke& s, double left, std::vector<Segment>& segments) {
  if (s.from == s.to) {
    segments.push_back({left + s.x, s.y, left + s.rx, s.ry});
    return;
  }
  constexpr int parts = 20;
  const auto at = [&](int i) {
    const double angle = (s.from + (s.to - s.from) * i / parts) * std::numbers::pi / 180;
    return std::array{left + s.x + s.rx * std::cos(angle), s.y + s.ry * std::sin(angle)};
  };
  for (int i = 0; i < parts; ++i) segments.push_back({at(i)[0], at(i)[1], at(i + 1)[0], at(i + 1)[1]});
}

} // namespace

TextMask draw_text(std::string_view text, double height) {
  std::vector<Segment> segments;
  double left = 0;
  for (const char letter : text) {
    for (const Stroke& s : strokes_of(letter)) append_segments(s, left, segments);
    left += letter_width + spacing;
  }
  const double scale = height / letter_height; // texels per unit
  const double margin = stroke / 2 + 0.3;
  TextMask mask;
  mask.width = static_cast<std::uint32_t>(std::ceil((left - spacing + 2 * margin) * scale));
  mask.height = static_cast<std::uint32_t>(std::ceil((letter_height + 2 * margin) * scale));
  mask.coverage.resize(std::size_t{mask.width} * mask.height);
  const double half_width = std::max(stroke * scale, 1.0) / 2; // thinner than a texel it would fade
  const auto placed = [&](double at) { return (at + margin) * scale; };
  for (const Segment& s : segments) draw({placed(s.x0), placed(s.y0), placed(s.x1), placed(s.y1)}, half_width, mask);
  return mask;
}

} // namespace orbis::texture
