// Checkpoints: where a long computation leaves its state, and finds what an interrupted run of the same one has left.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace orbis {

// Implementations say how often; the computation says where it can go on from. Used from one thread at a time.
class Checkpoints {
public:
  virtual ~Checkpoints() = default;
  // Whether the last one is so old that another is worth its bytes.
  [[nodiscard]] virtual bool due() const = 0;
  // Replaces the last one.
  virtual void keep(std::span<const std::byte> state) = 0;
  // What an interrupted run kept last: of the same program on the same input with the same options. Empty: nothing.
  [[nodiscard]] virtual std::span<const std::byte> kept() const = 0;
};

// For callers that want none.
class NoCheckpoints final : public Checkpoints {
public:
  [[nodiscard]] bool due() const override { return false; }
  void keep(std::span<const std::byte>) override {}
  [[nodiscard]] std::span<const std::byte> kept() const override { return {}; }
};

// A state as bytes: values one behind the other, as they lie in memory. It is read by the program that wrote it.
class StateWriter {
public:
  template <class T> void value(const T& value) { values(std::span<const T>(&value, 1)); }
  template <class T> void values(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + values.size_bytes());
    if (!values.empty()) std::memcpy(bytes_.data() + at, values.data(), values.size_bytes());
  }
  [[nodiscard]] const std::vector<std::byte>& bytes() const { return bytes_; }

private:
  std::vector<std::byte> bytes_;
};

// Reads in the order in which they were written. What does not lie in the bytes is not read, and ok() says so.
class StateReader {
public:
  explicit StateReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T> [[nodiscard]] T value() {
    T out{};
    values(std::span<T>(&out, 1));
    return out;
  }
  template <class T> void values(std::span<T> out) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> from = take(out.size_bytes());
    if (!from.empty()) std::memcpy(out.data(), from.data(), from.size());
  }
  // The next bytes, as many as that; none where there are fewer.
  [[nodiscard]] std::span<const std::byte> take(std::size_t bytes) {
    ok_ = ok_ && bytes <= bytes_.size();
    if (!ok_) return {};
    const std::span<const std::byte> out = bytes_.first(bytes);
    bytes_ = bytes_.subspan(bytes);
    return out;
  }
  [[nodiscard]] bool ok() const { return ok_; }

private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

} // namespace orbis
