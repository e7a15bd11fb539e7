// Vectors in the four lanes of a register: where a million texels each need a few products, this is what they cost.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace orbis {

// Arithmetic is lane by lane, as the compilers' vector extension has it.
using Float4 [[gnu::vector_size(16)]] = float;

template <class T> Float4 float4(const Vec3<T>& v, float last = 0) {
  return Float4{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z), last};
}

// Of the first three lanes.
inline float dot3(const Float4& a, const Float4& b) {
  const Float4 p = a * b;
  return p[0] + p[1] + p[2];
}
inline float norm3(const Float4& a) { return std::sqrt(dot3(a, a)); }
inline Float4 cross3(const Float4& a, const Float4& b) {
  const auto next = [](const Float4& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); };
  return next(a * next(b) - next(a) * b);
}

} // namespace orbis
