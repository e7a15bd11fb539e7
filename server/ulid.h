// Identifiers that sort by time (ULID: 48 bits of milliseconds, 80 random bits, Crockford's base 32).
#pragma once

#include <mutex>
#include <random>
#include <string>

#include "api/job.h"

namespace orbis::server {

// Thread-safe. Identifiers from one source strictly grow, even within a millisecond.
class UlidSource {
public:
  [[nodiscard]] std::string next(api::Time time);

private:
  std::mutex mutex_;
  std::random_device random_;
  std::string last_;
};

} // namespace orbis::server
