// Counters for Prometheus.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "api/job.h"

namespace orbis::server {

// What is true now, as opposed to what has been counted.
struct Gauges {
  std::uint64_t queued = 0, running = 0, workers = 0, queue_limit = 0;
  bool draining = false;
};

// Thread-safe; its lock is held for microseconds only.
class Metrics {
public:
  void job_accepted();
  void job_refused(); // the queue was full
  void job_cached();  // answered with the result of an earlier one
  void job_finished(const api::Job& job);
  void request(std::string_view method, int status, double seconds);

  // Prometheus text format, version 0.0.4.
  [[nodiscard]] std::string text(const Gauges& gauges) const;

private:
  // Upper bounds in seconds; the last bucket is +Inf.
  static constexpr std::array<double, 10> bounds{0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 120, 600};
  struct Histogram {
    std::array<std::uint64_t, bounds.size() + 1> counts{};
    double sum = 0;
    void add(double seconds);
  };
  static void append_histogram(std::string& text, std::string_view name, const Histogram& histogram);

  mutable std::mutex mutex_;
  std::uint64_t accepted_ = 0, refused_ = 0, cached_ = 0;
  std::map<std::string, std::uint64_t> finished_; // by state
  std::map<std::string, double> stage_seconds_;
  std::map<std::pair<std::string, int>, std::uint64_t> requests_; // by method and status
  Histogram job_seconds_, request_seconds_;
};

} // namespace orbis::server
