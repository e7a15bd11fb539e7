#include "core/steps/interpolate.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/steps/skin_weights.h"

namespace orbis {
namespace {

using asset::Attribute;
using asset::ComponentType;

bool starts_with(const Attribute& a, std::string_view prefix) { return a.name.starts_with(prefix); }

bool is_float(const Attribute& a) { return a.type == ComponentType::f32; }

Attribute empty_like(const Attribute& a, std::size_t count) {
  Attribute out{a.name, a.type, a.normalized, a.components, {}};
  out.data.resize(count * a.components * size_of(a.type));
  return out;
}

Attribute as_floats(const Attribute& a) {
  Attribute out{a.name, ComponentType::f32, false, a.components, {}};
  out.data.resize(a.count() * a.components * sizeof(float));
  for (std::size_t v = 0; v < a.count(); ++v) {
    for (std::uint32_t c = 0; c < a.components; ++c) out.set(v, c, a.get(v, c));
  }
  return out;
}

void copy_vertex(const Attribute& from, std::size_t v, Attribute& to, std::size_t w) {
  const std::size_t bytes = from.components * size_of(from.type);
  std::memcpy(to.data.data() + w * bytes, from.data.data() + v * bytes, bytes);
}

double blend(const Attribute& a, const VertexSource& s, std::uint32_t c) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    // A corner without weight has no say, whatever it holds.
    if (s.weights[k] > 0) sum += s.weights[k] * a.get(s.corners[k], c);
  }
  return sum;
}

std::uint32_t nearest_corner(const VertexSource& s) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (s.weights[k] > s.weights[nearest]) nearest = k;
  }
  return s.corners[nearest];
}

void blend_vertex(const Attribute& a, const VertexSource& s, Attribute& out, std::size_t w) {
  for (std::uint32_t c = 0; c < a.components; ++c) out.set(w, c, blend(a, s, c));
}

// The first three components as a direction. Where the corners' directions cancel out, the nearest corner's is taken.
void blend_direction(const Attribute& a, const VertexSource& s, Attribute& out, std::size_t w) {
  const Vec3d sum{blend(a, s, 0), blend(a, s, 1), blend(a, s, 2)};
  const double length = norm(sum);
  copy_vertex(a, nearest_corner(s), out, w);
  if (!(length > 1e-6)) return;
  out.set(w, 0, sum.x / length);
  out.set(w, 1, sum.y / length);
  out.set(w, 2, sum.z / length);
}

enum class Rule { linear, direction, nearest };

Rule rule_of(const Attribute& a) {
  if ((a.name == "NORMAL" || a.name == "TANGENT") && a.components >= 3) return Rule::direction;
  const bool number = is_float(a) || a.normalized || a.name == "POSITION" || starts_with(a, "TEXCOORD_");
  return number ? Rule::linear : Rule::nearest;
}

Attribute apply(const Attribute& a, std::span<const VertexSource> sources, Rule rule) {
  Attribute out = empty_like(a, sources.size());
  for (std::size_t w = 0; w < sources.size(); ++w) {
    const VertexSource& s = sources[w];
    if (const int k = s.copied(); k >= 0) {
      copy_vertex(a, s.corners[static_cast<std::size_t>(k)], out, w);
    } else if (rule == Rule::direction) {
      blend_direction(a, s, out, w);
    } else if (rule == Rule::linear) {
      blend_vertex(a, s, out, w);
    } else {
      copy_vertex(a, nearest_corner(s), out, w);
    }
  }
  return out;
}

bool has_blends(std::span<const VertexSource> sources) {
  return std::ranges::any_of(sources, [](const VertexSource& s) { return s.copied() < 0; });
}

bool needs_floats(const Attribute& a) { return a.name == "POSITION" && !is_float(a); }

} // namespace

int VertexSource::copied() const {
  for (int k = 0; k < 3; ++k) {
    if (weights[static_cast<std::size_t>(k)] == 1) return k;
  }
  return -1;
}

std::vector<Attribute> interpolate(std::span<const Attribute> attributes, std::span<const VertexSource> sources) {
  const bool blends = has_blends(sources);
  std::vector<Attribute> out;
  for (const Attribute& a : attributes) {
    out.push_back(blends && needs_floats(a) ? apply(as_floats(a), sources, Rule::linear)
                                            : apply(a, sources, rule_of(a)));
  }
  if (blends) merge_skin_weights(attributes, sources, out);
  return out;
}

std::vector<Attribute> interpolate_target(std::span<const Attribute> attributes,
                                          std::span<const VertexSource> sources) {
  const bool blends = has_blends(sources);
  std::vector<Attribute> out;
  for (const Attribute& a : attributes) {
    out.push_back(apply(blends && needs_floats(a) ? as_floats(a) : a, sources, Rule::linear));
  }
  return out;
}

} // namespace orbis
