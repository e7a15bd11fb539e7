#include "server/metrics.h"

#include <algorithm>
#include <cstdio>

namespace orbis::server {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

void head(std::string& text, std::string_view name, std::string_view type, std::string_view help) {
  text.append("# HELP ")
      .append(name)
      .append(" ")
      .append(help)
      .append("\n# TYPE ")
      .append(name)
      .append(" ")
      .append(type);
  text += '\n';
}

void sample(std::string& text, std::string_view name, std::string_view labels, double value) {
  text.append(name).append(labels).append(" ").append(number(value)).append("\n");
}

void gauge(std::string& text, std::string_view name, std::string_view help, double value) {
  head(text, name, "gauge", help);
  sample(text, name, "", value);
}

} // namespace

void Metrics::Histogram::add(double seconds) {
  const auto bucket = std::ranges::lower_bound(bounds, seconds) - bounds.begin();
  ++counts.at(static_cast<std::size_t>(bucket));
  sum += seconds;
}

void Metrics::append_histogram(std::string& text, std::string_view name, const Histogram& histogram) {
  const std::string base(name);
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    total += histogram.counts.at(i);
    const std::string bound = i < bounds.size() ? number(bounds.at(i)) : "+Inf";
    sample(text, base + "_bucket", "{le=\"" + bound + "\"}", static_cast<double>(total));
  }
  sample(text, base + "_sum", "", histogram.sum);
  sample(text, base + "_count", "", static_cast<double>(total));
}

void Metrics::job_accepted() {
  const std::scoped_lock lock(mutex_);
  ++accepted_;
}

void Metrics::job_refused() {
  const std::scoped_lock lock(mutex_);
  ++refused_;
}

void Metrics::job_cached() {
  const std::scoped_lock lock(mutex_);
  ++cached_;
}

void Metrics::job_finished(const api::Job& job) {
  const std::scoped_lock lock(mutex_);
  ++finished_[std::string(name_of(job.state))];
  if (job.timing.wall_ms) job_seconds_.add(*job.timing.wall_ms / 1e3);
  for (const api::StageTiming& stage : job.timing.stages) stage_seconds_[stage.name] += stage.wall_ms / 1e3;
}

void Metrics::request(std::string_view method, int status, double seconds) {
  const std::scoped_lock lock(mutex_);
  ++requests_[{std::string(method), status}];
  request_seconds_.add(seconds);
}

std::string Metrics::text(const Gauges& gauges) const {
  const std::scoped_lock lock(mutex_);
  std::string text;
  gauge(text, "orbis_jobs_queued", "Jobs that wait for a worker.", static_cast<double>(gauges.queued));
  gauge(text, "orbis_jobs_running", "Jobs that run.", static_cast<double>(gauges.running));
  gauge(text, "orbis_workers", "Jobs that may run at a time.", static_cast<double>(gauges.workers));
  gauge(text, "orbis_queue_limit", "Jobs that may wait.", static_cast<double>(gauges.queue_limit));
  gauge(text, "orbis_draining", "1 while the service shuts down.", gauges.draining ? 1 : 0);

  head(text, "orbis_jobs_accepted_total", "counter", "Jobs that were queued.");
  sample(text, "orbis_jobs_accepted_total", "", static_cast<double>(accepted_));
  head(text, "orbis_jobs_refused_total", "counter", "Jobs that were refused because the queue was full.");
  sample(text, "orbis_jobs_refused_total", "", static_cast<double>(refused_));
  head(text, "orbis_jobs_cached_total", "counter", "Jobs that were answered with the result of an earlier one.");
  sample(text, "orbis_jobs_cached_total", "", static_cast<double>(cached_));
  head(text, "orbis_jobs_finished_total", "counter", "Jobs by how they ended.");
  for (const auto& [state, count] : finished_) {
    sample(text, "orbis_jobs_finished_total", "{state=\"" + state + "\"}", static_cast<double>(count));
  }
  head(text, "orbis_job_seconds", "histogram", "Wall time of jobs, without the queue.");
  append_histogram(text, "orbis_job_seconds", job_seconds_);
  head(text, "orbis_stage_seconds_total", "counter", "Wall time of jobs by stage.");
  for (const auto& [stage, seconds] : stage_seconds_) {
    sample(text, "orbis_stage_seconds_total", "{stage=\"" + stage + "\"}", seconds);
  }
  head(text, "orbis_http_requests_total", "counter", "Requests by method and status.");
  for (const auto& [key, count] : requests_) {
    sample(text, "orbis_http_requests_total",
           "{method=\"" + key.first + "\",status=\"" + std::to_string(key.second) + "\"}", static_cast<double>(count));
  }
  head(text, "orbis_http_request_seconds", "histogram", "Time from a request's head to its answer.");
  append_histogram(text, "orbis_http_request_seconds", request_seconds_);
  return text;
}

} // namespace orbis::server
