#include "core/asset/ply_values.h"

#include <bit>
#include <cmath>

namespace orbis::asset {
namespace {

double decoded(std::uint64_t bits, PlyType type) {
  switch (type) {
  case PlyType::i8:
    return static_cast<std::int8_t>(bits);
  case PlyType::i16:
    return static_cast<std::int16_t>(bits);
  case PlyType::i32:
    return static_cast<std::int32_t>(bits);
  case PlyType::f32:
    return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
  case PlyType::f64:
    return std::bit_cast<double>(bits);
  default:
    return static_cast<double>(bits);
  }
}

} // namespace

double PlyValues::next(PlyType type) {
  if (form_ == PlyForm::text) return text_.number<double>(text_.word_over_lines());
  const std::size_t size = size_of(type);
  if (bytes_.size() < size) text_.fail("the data ends too early; the file is truncated");
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const auto byte = static_cast<unsigned char>(bytes_[form_ == PlyForm::big_endian ? i : size - 1 - i]);
    bits = bits << 8 | byte;
  }
  bytes_.remove_prefix(size);
  return decoded(bits, type);
}

std::uint64_t PlyValues::next_index(PlyType type, std::uint64_t end, const char* what) {
  const double value = next(type);
  if (!(value >= 0) || value >= static_cast<double>(end) || value != std::floor(value)) {
    text_.fail(std::string(what) + " is out of range; there are " + std::to_string(end));
  }
  return static_cast<std::uint64_t>(value);
}

std::uint64_t PlyValues::next_length(const PlyProperty& list) {
  return next_index(list.count_type.value_or(PlyType::u32), std::uint64_t{1} << 32, "the length of a list");
}

void PlyValues::skip(const PlyProperty& property) {
  const std::uint64_t count = property.count_type ? next_length(property) : 1;
  for (std::uint64_t i = 0; i < count; ++i) (void)next(property.type);
}

void PlyValues::check_count(const PlyElement& element) const {
  std::uint64_t row = 0;
  for (const PlyProperty& property : element.properties) {
    row += form_ == PlyForm::text ? 2 : size_of(property.count_type.value_or(property.type));
  }
  if (row > 0 && element.count > (bytes_.size() + 1) / row) {
    text_.fail("the header promises " + std::to_string(element.count) + " rows of " + TextReader::quoted(element.name) +
               ", but the file is too short for them; it is truncated");
  }
}

bool PlyValues::holds_floats(const PlyProperty& property) const {
  return form_ != PlyForm::text && property.type != PlyType::f64 && property.type != PlyType::i32 &&
         property.type != PlyType::u32;
}

} // namespace orbis::asset
