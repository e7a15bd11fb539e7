#include "server/ulid.h"

#include <algorithm>
#include <string_view>

namespace orbis::server {
namespace {

constexpr std::string_view digits = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr std::size_t time_digits = 10, random_digits = 16;

// The next text in the order of the digits.
void increment(std::string& ulid) {
  auto place = ulid.find_last_not_of(digits.back());
  if (place == std::string::npos) place = 0; // the last identifier of all: the next millennium's concern
  ulid[place] = digits[(digits.find(ulid[place]) + 1) % digits.size()];
  std::fill(ulid.begin() + static_cast<std::ptrdiff_t>(place) + 1, ulid.end(), digits.front());
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
