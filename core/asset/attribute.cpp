#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "core/asset/asset.h"

namespace orbis::asset {
namespace {

template <class T> double load(const Bytes& data, std::size_t i) {
  T value{};
  std::memcpy(&value, data.data() + i * sizeof(T), sizeof(T));
  return static_cast<double>(value);
}

// The nearest integer of the type; a value that is no number becomes 0.
template <class T> void store_integer(Bytes& data, std::size_t i, double value) {
  using Range = std::numeric_limits<T>;
  const double rounded =
      std::isnan(value) ? 0.0 : std::clamp(std::round(value), double{Range::lowest()}, double{Range::max()});
  const T stored = static_cast<T>(rounded);
  std::memcpy(data.data() + i * sizeof(T), &stored, sizeof(T));
}

// The integer that stands for 1 in a normalized type.
double one_of(ComponentType type) {
  switch (type) {
  case ComponentType::i8:
    return 127;
  case ComponentType::u8:
    return 255;
  case ComponentType::i16:
    return 32767;
  case ComponentType::u16:
    return 65535;
  case ComponentType::u32:
    return 4294967295.0;
  case ComponentType::f32:
    return 1;
  }
  return 1;
}

const Attribute* find_in(const std::vector<Attribute>& attributes, std::string_view name) {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

} // namespace

double Attribute::get(std::size_t v, std::uint32_t c) const {
  const std::size_t i = v * components + c;
  double value = 0;
  switch (type) {
  case ComponentType::i8:
    value = load<std::int8_t>(data, i);
    break;
  case ComponentType::u8:
    value = load<std::uint8_t>(data, i);
    break;
  case ComponentType::i16:
    value = load<std::int16_t>(data, i);
    break;
  case ComponentType::u16:
    value = load<std::uint16_t>(data, i);
    break;
  case ComponentType::u32:
    value = load<std::uint32_t>(data, i);
    break;
  case ComponentType::f32:
    return load<float>(data, i);
  }
  return normalized ? std::max(value / one_of(type), -1.0) : value;
}

void Attribute::set(std::size_t v, std::uint32_t c, double value) {
  const std::size_t i = v * components + c;
  const double scaled = normalized ? value * one_of(type) : value;
  switch (type) {
  case ComponentType::i8:
    return store_integer<std::int8_t>(data, i, scaled);
  case ComponentType::u8:
    return store_integer<std::uint8_t>(data, i, scaled);
  case ComponentType::i16:
    return store_integer<std::int16_t>(data, i, scaled);
  case ComponentType::u16:
    return store_integer<std::uint16_t>(data, i, scaled);
  case ComponentType::u32:
    return store_integer<std::uint32_t>(data, i, scaled);
  case ComponentType::f32: {
    const auto stored = static_cast<float>(value);
    std::memcpy(data.data() + i * sizeof(float), &stored, sizeof(float));
  }
  }
}

const Attribute* Primitive::find(std::string_view name) const { return find_in(attributes, name); }
const Attribute* NewPrimitive::find(std::string_view name) const { return find_in(attributes, name); }
Attribute* NewPrimitive::find(std::string_view name) {
  return const_cast<Attribute*>(std::as_const(*this).find(name)); // NOLINT: it is one of our own
}

void negate_handedness(Attribute& tangent) {
  for (std::size_t v = 0; v < tangent.count(); ++v) tangent.set(v, 3, -tangent.get(v, 3));
}

std::size_t Primitive::vertex_count() const { return attributes.empty() ? 0 : attributes.front().count(); }

std::vector<Vec3f> Primitive::positions() const {
  const Attribute* position = find("POSITION");
  std::vector<Vec3f> out(position ? position->count() : 0);
  for (std::size_t v = 0; v < out.size(); ++v) {
    out[v] = {static_cast<float>(position->get(v, 0)), static_cast<float>(position->get(v, 1)),
              static_cast<float>(position->get(v, 2))};
  }
  return out;
}

} // namespace orbis::asset
