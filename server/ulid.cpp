#include "server/ulid.h"

#include <string_view>

namespace orbis::server {
namespace {

constexpr std::string_view digits = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr std::size_t time_digits = 10, random_digits = 16;

// The next text in the order of the digits.
void increment(std::string& ulid) {
  for (auto digit = ulid.rbegin(); digit != ulid.rend(); ++digit) {
    const auto value = digits.find(*digit);
    *digit = digits[(value + 1) % digits.size()];
    if (value + 1 < digits.size()) return;
  }
}

} // namespace

std::string UlidSource::next(api::Time time) {
  const std::scoped_lock lock(mutex_);
  auto milliseconds = static_cast<std::uint64_t>(time.time_since_epoch().count());
  std::string ulid(time_digits + random_digits, '0');
  for (std::size_t i = time_digits; i-- > 0; milliseconds /= digits.size())
    ulid[i] = digits[milliseconds % digits.size()];
  for (std::size_t i = time_digits; i < ulid.size(); ++i) ulid[i] = digits[random_() % digits.size()];
  if (ulid.compare(0, time_digits, last_, 0, time_digits) <= 0 && !last_.empty()) {
    ulid = last_; // the same millisecond, or a clock that went back
    increment(ulid);
  }
  last_ = ulid;
  return ulid;
}

} // namespace orbis::server
