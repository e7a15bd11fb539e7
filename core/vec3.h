// Three-component vectors: the few operations the geometry needs, nothing more.
#pragma once

#include <cmath>

namespace orbis {

template <class T> struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <class U>
  constexpr explicit Vec3(const Vec3<U>& v) : x(static_cast<T>(v.x)), y(static_cast<T>(v.y)), z(static_cast<T>(v.z)) {}

  constexpr Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  constexpr Vec3& operator-=(const Vec3& b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  constexpr Vec3& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class T> constexpr Vec3<T> operator+(Vec3<T> a, const Vec3<T>& b) { return a += b; }
template <class T> constexpr Vec3<T> operator-(Vec3<T> a, const Vec3<T>& b) { return a -= b; }
template <class T> constexpr Vec3<T> operator-(const Vec3<T>& a) { return {-a.x, -a.y, -a.z}; }
template <class T> constexpr Vec3<T> operator*(Vec3<T> a, T s) { return a *= s; }
template <class T> constexpr Vec3<T> operator*(T s, Vec3<T> a) { return a *= s; }

template <class T> constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
template <class T> constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T> constexpr T squared_norm(const Vec3<T>& a) { return dot(a, a); }
template <class T> T norm(const Vec3<T>& a) { return std::sqrt(dot(a, a)); }
// a / |a|. A zero vector gives NaN: callers rule it out.
template <class T> Vec3<T> normalized(const Vec3<T>& a) { return a * (T(1) / norm(a)); }

struct Vec2f {
  float x{}, y{};
  friend constexpr bool operator==(const Vec2f&, const Vec2f&) = default;
};

} // namespace orbis
