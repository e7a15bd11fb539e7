// What the routes need from whoever runs the jobs.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "api/http.h"
#include "api/job.h"

namespace orbis::api {

// What a client asks for, checked and complete.
struct Submission {
  Part model;
  std::vector<Part> files; // further parts, by file name
  Options options;
  std::string idempotency_key; // "" for none
};

struct JobQuery {
  std::optional<JobState> state;
  std::size_t limit = 20;
  std::string cursor; // the id after which the page starts (newest first); "" for the first page
};

struct JobPage {
  std::vector<Job> items;
  std::string next_cursor; // "" on the last page
};

enum class JobFile { result, report, atlas, preview };

struct StoredFile {
  std::filesystem::path path;
  std::uint64_t bytes = 0;
  std::string sha256;
};

// Thread-safe. Unknown ids give nothing.
class JobService {
public:
  virtual ~JobService() = default;

  // Takes over the spooled files. Throws Refused: queue_full, draining, key_reused.
  [[nodiscard]] virtual Job submit(Submission submission) = 0;
  [[nodiscard]] virtual std::optional<Job> find(std::string_view id) = 0;
  // Blocks until the job's version differs from `version`, or the timeout has passed, or the service stops.
  [[nodiscard]] virtual std::optional<Job> wait(std::string_view id, std::uint64_t version,
                                                std::chrono::milliseconds timeout) = 0;
  [[nodiscard]] virtual JobPage list(const JobQuery& query) = 0;
  // Queued jobs are canceled at once, running ones within a second; final ones stay as they are.
  [[nodiscard]] virtual std::optional<Job> cancel(std::string_view id) = 0;
  // A file of a job that has succeeded and not expired.
  [[nodiscard]] virtual std::optional<StoredFile> file(std::string_view id, JobFile kind) = 0;
  // One of the job's maps, by its file name; nothing for any other name.
  [[nodiscard]] virtual std::optional<StoredFile> map(std::string_view id, std::string_view name) = 0;

  // Whether an upload is worth reading: there is a place in the queue, or a job with this Idempotency-Key is known.
  [[nodiscard]] virtual bool has_room(std::string_view idempotency_key) = 0;
  // These answer from memory, whatever the load.
  [[nodiscard]] virtual bool draining() const = 0; // takes no more jobs; those that run may still end
  [[nodiscard]] virtual bool stopped() const = 0;  // no job changes any more
  // An upload was refused because has_room() said no.
  virtual void note_refusal() = 0;
  [[nodiscard]] virtual std::chrono::seconds retry_after() const = 0; // when a slot in the queue may be free
  [[nodiscard]] virtual std::string metrics() const = 0;              // Prometheus text format
};

} // namespace orbis::api
